// Properties that RapidCheck can shrink to a small counter-example, and tables of limits.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>

#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/friction/max_torque.h"
#include "tests/analytic/finite_prediction.h"
#include "tests/extremes/extreme_problem.h"

namespace softfinger {
namespace {

/// Any bit pattern of a double: denormals, infinities and NaN included.
rc::Gen<double> any_double() {
  return rc::gen::map(rc::gen::arbitrary<std::uint64_t>(), [](std::uint64_t bits) {
    double value;
    static_assert(sizeof value == sizeof bits);
    std::memcpy(&value, &bits, sizeof value);
    return value;
  });
}

RC_GTEST_PROP(AnyBits, GiveAnAnswerOrAReason, ()) {
  ContactProblem problem;
  for (double* field :
       {&problem.radii.major_m, &problem.radii.minor_m, &problem.layer.thickness_m,
        &problem.layer.youngs_modulus_Pa, &problem.load.normal_force_N,
        &problem.load.friction_coefficient, &problem.options.power_law.radius_coefficient,
        &problem.options.power_law.radius_exponent, &problem.options.power_law.pressure_exponent})
    *field = *any_double();
  problem.layer.poisson_ratio = *rc::gen::element(0.0, 0.3, 0.5);
  if (*rc::gen::arbitrary<bool>()) problem.object_layer.thickness_m = *any_double();
  for (const PressureModel* model : all_pressure_models()) {
    if (!model->card().hot_path) continue;
    const Prediction prediction = model->predict(problem);
    RC_ASSERT(testing::is_sound(prediction));
    const double pressure_Pa = model->pressure_Pa(problem, prediction, *any_double(), 0);
    RC_ASSERT(pressure_Pa >= 0 && std::isfinite(pressure_Pa));
  }
}

RC_GTEST_PROP(AnyBits, GiveAFiniteLimitSurface, ()) {
  const LimitSurface surface(*any_double(), *any_double(), *any_double(), *any_double());
  const LimitWrench wrench =
      surface.wrench_for_twist({*any_double(), *any_double(), *any_double()});
  RC_ASSERT(!std::isnan(wrench.force_x_N) && !std::isnan(wrench.force_y_N) &&
            !std::isnan(wrench.torque_Nm));
}

RC_GTEST_PROP(TorqueArm, FallsWithTheExponentAndLiesBetweenTheCircles, ()) {
  constexpr int kSteps = 1 << 20;
  const auto fraction = [&] { return *rc::gen::inRange(0, kSteps + 1) / double(kSteps); };
  const double b = std::pow(10, -12 + 15 * fraction()), a = b * std::pow(10, 8 * fraction());
  const double n = -0.5 + 50.5 * fraction();
  const double arm = torque_arm_exact_m(a, b, n);
  RC_ASSERT(torque_arm_exact_m(a, b, n + 0.01) < arm);
  // Inscribed and circumscribed circle.
  RC_ASSERT(arm >= torque_arm_exact_m(b, b, n) * (1 - 1e-15));
  RC_ASSERT(arm <= torque_arm_exact_m(a, a, n) * (1 + 1e-15));
}

// Next to the exponents that are written out, and where the series takes over from the gamma
// function, the arm must not jump: its logarithmic slope is below one.
TEST(TorqueArm, IsContinuousInTheExponent) {
  for (const double n : {0.0, 0.5, 1.0, 2.0, 98.0})
    for (const double step : {1e-9, -1e-9})
      EXPECT_NEAR(torque_arm_exact_m(2, 1, n + step) / torque_arm_exact_m(2, 1, n), 1, 2e-9) << n;
}

// A simulator's loads fade to nothing: the answer fades with them, or is refused, and the ellipsoid
// made of either is finite.
TEST(FadingLoad, IsCarriedToTheSmallestNumber) {
  for (const PressureModel* model : all_pressure_models()) {
    if (!model->card().hot_path) continue;
    double previous_m = 1;
    for (double P = 1; P > 0; P /= 1024) {
      ContactProblem problem{{0.02, 0.01}, {0.002, 3e5, 0.45}, {P, 0.8}};
      problem.options.power_law = {0.003, 0.3, 2};
      const Prediction prediction = model->predict(problem);
      ASSERT_TRUE(testing::is_finite_and_consistent(prediction)) << model->card().name << P;
      if (!prediction.has_answer) continue;
      EXPECT_LT(prediction.a_m, previous_m);
      previous_m = prediction.a_m;
      const FrictionEllipsoid ellipsoid{0.8 * P, prediction.torque_arm_exact_m};
      EXPECT_FALSE(std::isnan(ellipsoid.utilisation(P, 0, P * prediction.a_m)));
    }
    EXPECT_LT(previous_m, 1e-4) << model->card().name;
  }
}

}  // namespace
}  // namespace softfinger
