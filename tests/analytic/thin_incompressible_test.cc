#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "quadrature.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

Prediction thin_incompressible(const ContactProblem& problem) {
  return find_pressure_model("thin_incompressible")->predict(problem);
}

/// Incompressible, G = 0.1 MPa, 0.1 mm thick.
ContactProblem thin_problem(double R1_m, double R2_m, double load_N) {
  return {{R1_m, R2_m}, {1e-4, 3e5, 0.5}, {load_N, 0.5}};
}

const ValidityCheck* find_thin_check(const Prediction& prediction, const std::string& name) {
  for (const ValidityCheck& check : prediction.validity)
    if (check.check == name) return &check;
  return nullptr;
}

TEST(ThinIncompressible, EqualsTheClosedFormForSpheres) {
  const double R = 0.5, P = 2, h = 1e-4, G = 1e5;
  const Prediction contact = thin_incompressible(thin_problem(R, R, P));
  const double a = std::pow(32 * h * h * h * R * P / (kPi * G), 1.0 / 6);
  const double tolerance = 3e-15;  // a handful of roundings
  EXPECT_NEAR(contact.a_m / a, 1, tolerance);
  EXPECT_NEAR(contact.b_m / a, 1, tolerance);
  EXPECT_NEAR(contact.indentation_m / (a * a / (4 * R)), 1, tolerance);
  EXPECT_NEAR(contact.peak_pressure_Pa / (3 * P / (kPi * a * a)), 1, tolerance);
  EXPECT_NEAR(contact.torque_arm_exact_m / (16.0 / 35 * a), 1, tolerance);
}

// (h³/3G) laplacian p = -(d - x²/(2R') - y²/(2R'')), with the laplacian by differences: of a
// polynomial of fourth order they are exact but for the fourth derivatives, which Richardson's
// extrapolation removes.
TEST(ThinIncompressible, SolvesItsDifferentialEquation) {
  const PressureModel& model = *find_pressure_model("thin_incompressible");
  testing::WorstError worst("differential equation of the thin incompressible layer");
  for (const double ratio : {1.0, 1.5, 4.0, 30.0, 1e3}) {
    const ContactProblem problem = thin_problem(0.2 * ratio, 0.2, 3);
    const Prediction contact = model.predict(problem);
    ASSERT_TRUE(contact.has_answer);
    const double h = problem.layer.thickness_m, G = problem.layer.shear_modulus_Pa();
    for (const double u : {0.0, 0.2, 0.5})
      for (const double v : {0.0, 0.3, 0.6}) {
        const double x = u * contact.a_m, y = v * contact.b_m;
        const auto p = [&](double dx, double dy) {
          return model.pressure_Pa(problem, contact, x + dx, y + dy);
        };
        const auto second = [&](double dx, double dy, double step) {
          return (p(dx, dy) - 2 * p(0, 0) + p(-dx, -dy)) / (step * step);
        };
        const auto laplacian = [&](double step) {
          const double dx = step * contact.a_m, dy = step * contact.b_m;
          return second(dx, 0, dx) + second(0, dy, dy);
        };
        const double step = 0.05, displacement = -h * h * h / (3 * G) *
                                                 (4 * laplacian(step / 2) - laplacian(step)) / 3;
        const double gap =
            x * x / (2 * problem.radii.major_m) + y * y / (2 * problem.radii.minor_m);
        // Rounding of the pressure, 1e-16, over the square of the step, 4/0.025² times four.
        EXPECT_NEAR(displacement / contact.indentation_m, 1 - gap / contact.indentation_m, 1e-11)
            << ratio << " " << u << " " << v;
        worst.of(1 + displacement / contact.indentation_m, 2 - gap / contact.indentation_m);
      }
  }
}

TEST(ThinIncompressible, PressureAndItsSlopeVanishAtTheEdge) {
  const PressureModel& model = *find_pressure_model("thin_incompressible");
  const ContactProblem problem = thin_problem(0.4, 0.1, 1);
  const Prediction contact = model.predict(problem);
  const double inside = 1e-6;
  // (1 - (1 - e)²)² = 4 e² to leading order.
  EXPECT_NEAR(model.pressure_Pa(problem, contact, contact.a_m * (1 - inside), 0) /
                  (4 * inside * inside * contact.peak_pressure_Pa),
              1, 2 * inside);
  EXPECT_EQ(model.pressure_Pa(problem, contact, 0, contact.b_m * 1.000001), 0);
}

TEST(ThinIncompressible, AspectFollowsTheQuadraticForAllRatiosOfRadii) {
  for (const double ratio : {1.0, 2.0, 1e2, 1e5, 1e8}) {
    const Prediction contact = thin_incompressible(thin_problem(0.1 * ratio, 0.1, 1));
    const double t = std::pow(contact.a_m / contact.b_m, 2);
    EXPECT_NEAR((t + 3 * t * t) / (3 + t) / ratio, 1, 1e-14) << ratio;
  }
}

// Between the two the true layer lies; the exact solution for a circle with compressibility
// (modified Bessel functions) gives -9.9 % in area and -6.2 % in torque at the limit.
TEST(ThinIncompressible, IsValidWhereTheLayerFlowsOnly) {
  const ContactProblem wide = thin_problem(2, 2, 100);
  const Prediction contact = thin_incompressible(wide);
  const double s = contact.a_m / wide.layer.thickness_m;
  ASSERT_GT(s, 30);
  EXPECT_TRUE(contact.valid());
  EXPECT_EQ(find_thin_check(contact, "incompressible")->value, 0);

  ContactProblem compressible = wide;
  compressible.layer.poisson_ratio = 0.45;
  const Prediction wrong = thin_incompressible(compressible);
  EXPECT_TRUE(wrong.has_answer);
  EXPECT_FALSE(wrong.valid());
  const ValidityCheck& check = *find_thin_check(wrong, "incompressible");
  const double G_over_M = 0.1 / (2 * 0.55);
  EXPECT_NEAR(check.value / (3 * std::pow(wrong.a_m / 1e-4, 2) * G_over_M), 1, 1e-12);
  EXPECT_NE(std::string(check.message).find("compressible"), std::string::npos);

  const Prediction thick = thin_incompressible(thin_problem(0.01, 0.01, 0.01));
  EXPECT_TRUE(thick.has_answer);
  EXPECT_FALSE(find_thin_check(thick, "thin_for_flow")->holds());
}

TEST(ThinIncompressible, AddsTheFlowOfACompliantObjectsLayer) {
  ContactProblem problem = thin_problem(0.4, 0.1, 1);
  const Prediction one = thin_incompressible(problem);
  problem.object_layer = problem.layer;
  const Prediction two = thin_incompressible(problem);
  EXPECT_NEAR(two.a_m / one.a_m, std::pow(2, 1.0 / 6), 1e-15);
  // h³/G: a layer twice as thick and eight times as stiff is the same layer.
  problem.object_layer.thickness_m *= 2;
  problem.object_layer.youngs_modulus_Pa *= 8;
  EXPECT_NEAR(thin_incompressible(problem).a_m / two.a_m, 1, 1e-15);
  EXPECT_EQ(find_thin_check(thin_incompressible(problem), "thin_for_flow")->value,
            std::sqrt(two.a_m) * std::sqrt(two.b_m) / problem.object_layer.thickness_m);
}

}  // namespace
}  // namespace softfinger
