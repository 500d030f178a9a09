// Series, asymptotes, table edges, special cases: where a model switches between them, its numbers
// must not jump.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <utility>
#include <vector>

#include "softfinger/friction/limit_surface.h"
#include "softfinger/friction/six_patch_surface.h"
#include "softfinger/input/constants.h"
#include "tests/extremes/extreme_problem.h"
#include "tests/extremes/jumps.h"

namespace softfinger {
namespace {

using testing::ExtremeProblems;
using testing::kNumbers;
using testing::largest_jump;
using testing::Numbers;

/// Hertz with a jump at one load, as a switch between series leaves one.
class Jumping final : public PressureModel {
 public:
  explicit Jumping(double jump) : jump_(jump) {}
  const ModelCard& card() const noexcept override { return hertz_.card(); }
  Prediction predict(const ContactProblem& problem) const noexcept override {
    Prediction prediction = hertz_.predict(problem);
    // Curved, so that the jump has to be distinguished from the curvature.
    const double s = prediction.a_m / problem.layer.thickness_m;
    prediction.indentation_m *= (1 + s / (1 + s)) * (s > 0.7071 ? 1 + jump_ : 1);
    return prediction;
  }
  double pressure_Pa(const ContactProblem&, const Prediction&, double,
                     double) const noexcept override {
    return 0;
  }

 private:
  const PressureModel& hertz_ = *find_pressure_model("hertz");
  double jump_;
};

TEST(Continuity, TestFindsAJump) {
  for (const double jump : {1e-4, 1e-6, 1e-8, 2e-9}) {
    const Jumping model(jump);
    const double found = largest_jump(
        model,
        [](double t) {
          return ContactProblem{{0.02, 0.01}, {0.002, 3e5, 0.3}, {std::pow(10, 12 * t - 6), 0.8}};
        },
        2000);
    EXPECT_NEAR(found / jump, 1, 0.01) << jump;
  }
}

class SwitchesOf : public ::testing::TestWithParam<const PressureModel*> {};

TEST_P(SwitchesOf, DoNotMakeNumbersJump) {
  const PressureModel& model = *GetParam();
  if (!model.card().hot_path)
    GTEST_SKIP() << "discretised: as continuous as its stated accuracy, checked in its own tests";
  ExtremeProblems problems(8);
  // A path is 12 decades long or less: over the final 1e-13 of it a smooth logarithm changes by
  // 3e-12 and its rounding; a jump of the table's or a series' error would be far larger.
  const double tolerance = 1e-9;
  double worst = 0;
  int failures = 0;
  const auto check = [&](const char* what, const ContactProblem& base, int samples,
                         const std::function<ContactProblem(double)>& path) {
    const double jump = largest_jump(model, path, samples);
    worst = std::max(worst, jump);
    EXPECT_LT(jump, tolerance) << what << ": " << testing::in_words(base);
    failures += jump >= tolerance;
  };
  for (int line = 0; line < 60 && failures < 5; ++line)
    for (const testing::Path& path : testing::draw_paths(problems, line))
      check(path.what, path.base, path.samples, path.problem);
  std::printf("%-20s largest jump %.1e\n", std::string(model.card().name).c_str(), worst);
}

/// Wrench that a contact of this shape transmits, as fractions of the largest force and torque, and
/// the logarithm of another wrench's utilisation; last the torque of the six patches.
Numbers friction(double a_over_b, double exponent, const Twist& slip) {
  const LimitSurface surface(a_over_b, 1, exponent, 1);
  const double arm = surface.eccentricity_m();
  const LimitWrench wrench = surface.wrench_for_twist(slip);
  const SixPatchSurface patches(a_over_b, 1, exponent, 1);
  return {wrench.force_x_N, wrench.force_y_N, wrench.torque_Nm / arm,
          std::log(surface.utilisation({slip.velocity_x_m_per_s, slip.velocity_y_m_per_s,
                                        slip.angular_velocity_rad_per_s * arm * arm})),
          patches.wrench_for_twist(slip).torque_Nm / arm};
}

/// Paths across the switches between the series of a circle, the two quadratures and the named
/// exponents.
TEST(LimitSurfaceSwitches, DoNotMakeWrenchesJump) {
  ExtremeProblems random(11);
  double worst = 0;
  const auto check = [&](const char* what, int samples,
                         const std::function<Numbers(double)>& path) {
    const double jump = largest_jump(path, samples);
    worst = std::max(worst, jump);
    EXPECT_LT(jump, 1e-9) << what;
  };
  for (int line = 0; line < 6; ++line) {
    const double n = line % 2 ? random.uniform(-0.5, 4) : std::array{0.0, 0.5, 1.0}[line / 2];
    const double ratio = line % 3 ? random.log_uniform(1, 1e4) : 1;
    const double heading = random.uniform(0, 2 * kPi);
    const auto turning_at = [heading](double distance) {
      return Twist{distance * std::sin(heading), -distance * std::cos(heading), 1};
    };
    check("distance of the centre of rotation", 1000, [&](double t) {
      return friction(ratio, n, turning_at(ratio * std::pow(10, 6 * t - 3)));
    });
    check("distance around the edge", 1000,
          [&](double t) { return friction(ratio, n, turning_at(std::cbrt(ratio) * (0.5 + t))); });
    check("ratio of the axes", 1000, [&](double t) {
      return friction(std::pow(10, 4 * t), n, turning_at(std::pow(10, 3 * t)));
    });
    check("ratio next to one", 300,
          [&](double t) { return friction(1 + std::pow(10, -16 + 13 * t), n, turning_at(0.6)); });
    check("exponent", 1000,
          [&](double t) { return friction(ratio, -0.5 + 50.5 * t * t, turning_at(0.6 * ratio)); });
    // Each named exponent is a switch of its own, between the exponents next to it.
    for (const double named : {0.0, 0.5, 1.0, 2.0, 3.0}) {
      const Numbers at = friction(ratio, named, turning_at(0.6));
      const Numbers beside = friction(ratio, named + 1e-13, turning_at(0.6));
      for (int k = 0; k < kNumbers; ++k) EXPECT_NEAR(at[k], beside[k], 1e-11) << named;
    }
  }
  std::printf("%-20s largest jump %.1e\n", "limit surface", worst);
}

INSTANTIATE_TEST_SUITE_P(Of, SwitchesOf, ::testing::ValuesIn(all_pressure_models()),
                         testing::model_test_name);

}  // namespace
}  // namespace softfinger
