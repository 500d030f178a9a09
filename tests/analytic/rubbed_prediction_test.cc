#include "softfinger/pressure/rubbed_prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "softfinger/friction/max_torque.h"
#include "softfinger/pressure/arm_exponent.h"
#include "tests/analytic/rubbed_reference.h"

namespace softfinger {
namespace {

constexpr double kThickness_m = 2e-3, kRadius_m = 0.2, kYoungs_Pa = 3e5;

/// The contact of a row in SI units.
ContactProblem problem_of(const RubbedReference& row) {
  ContactProblem problem;
  problem.layer = {kThickness_m, kYoungs_Pa, row.nu};
  problem.radii = {kRadius_m, kRadius_m, 0};
  problem.load.normal_force_N =
      row.load * problem.layer.plane_strain_modulus_Pa() * std::pow(kThickness_m, 3) / kRadius_m;
  return problem;
}

TEST(RubbedPrediction, AgreesWithIndependentSolutions) {
  const PressureModel& model = *find_pressure_model("bonded_layer");
  for (const RubbedReference& row : kRubbedReferences) {
    SCOPED_TRACE("nu " + std::to_string(row.nu) + ", s " + std::to_string(row.s) + ", mu " +
                 std::to_string(row.mu));
    const ContactProblem problem = problem_of(row);
    const Prediction pressed = rubbed(model, model.predict(problem), problem, row.mu);
    // The ratios' stated 0.5 % and those of bonded_layer itself; the peak follows the arm's form.
    EXPECT_NEAR(pressed.a_m / kThickness_m / row.a, 1, 0.01);
    EXPECT_NEAR(pressed.indentation_m * kRadius_m / std::pow(kThickness_m, 2) / row.indentation, 1,
                0.015);
    EXPECT_NEAR(pressed.torque_arm_exact_m / kThickness_m / row.arm, 1, 0.01);
    EXPECT_NEAR(pressed.peak_pressure_Pa * kRadius_m /
                    (problem.layer.plane_strain_modulus_Pa() * kThickness_m) / row.peak,
                1, 0.05);
  }
}

TEST(RubbedPrediction, AgreesWithSpheresThatStickAtFiniteStrain) {
  const PressureModel& model = *find_pressure_model("fingertip_layer");
  for (const StuckAtFiniteStrain& row : kStuckAtFiniteStrain) {
    SCOPED_TRACE("d/h " + std::to_string(row.indentation));
    ContactProblem problem;
    problem.layer = {1, 1 - 0.49 * 0.49, 0.49};
    problem.radii = {5, 5, 0};
    problem.is_object_spherical = true;
    problem.load = {row.load, 0.8};
    const Prediction pressed = rubbed(model, model.predict(problem), problem, kAllSticks);
    // The model's own range for a and d (2 and 3 %), which ends at the largest of these
    // indentations.
    EXPECT_NEAR(pressed.a_m / row.a, 1, 0.02);
    EXPECT_NEAR(pressed.indentation_m / row.indentation, 1, 0.03);
  }
}

TEST(RubbedPrediction, OfCompressibleLayersFollowsTheFiniteElements) {
  // Level 2 in linear elasticity, friction against none under one load: d, a and the pressed arm.
  struct Row {
    double nu, s, mu, indentation, size, arm;
  };
  const std::vector<Row> rows = {{0, 0.04, kAllSticks, 0.9658, 0.93945, 0.90899},
                                 {0, 0.3, 0.25, 0.98117, 0.97081, 0.94331},
                                 {0, 2, 0.7, 0.98862, 0.97145, 0.96965},
                                 {0.12, 0.04, 0.25, 0.98443, 0.97694, 0.95234},
                                 {0.12, 0.8, kAllSticks, 0.98289, 0.96803, 0.95542},
                                 {0.22, 0.3, 0.08, 0.99557, 0.99281, 0.98636},
                                 {0.22, 2, 0.25, 0.99845, 0.99241, 0.99444},
                                 {0.3, 0.04, 0.7, 0.98875, 0.98033, 0.97248},
                                 {0.4, 0.3, 0.25, 0.99759, 0.9946, 0.99281},
                                 {0.4, 2, 0.08, 0.99322, 0.99743, 0.9973}};
  for (const Row& row : rows) {
    SCOPED_TRACE("nu " + std::to_string(row.nu) + ", s " + std::to_string(row.s) + ", mu " +
                 std::to_string(row.mu));
    const RubbedRatios ratios = rubbed_ratios(row.nu, row.s, row.mu);
    EXPECT_NEAR(ratios.indentation / row.indentation, 1, 0.003);
    EXPECT_NEAR(ratios.size / row.size, 1, 0.005);
    EXPECT_NEAR(ratios.torque_arm / row.arm, 1, 0.007);
  }
}

TEST(RubbedPrediction, IsTheFrictionlessOneWithoutFriction) {
  const ContactProblem problem = problem_of(kRubbedReferences.back());
  const PressureModel& model = *find_pressure_model("bonded_layer");
  const Prediction frictionless = model.predict(problem);
  const Prediction pressed = rubbed(model, frictionless, problem, 0);
  EXPECT_EQ(pressed.a_m, frictionless.a_m);
  EXPECT_EQ(pressed.indentation_m, frictionless.indentation_m);
  EXPECT_EQ(pressed.torque_arm_exact_m, frictionless.torque_arm_exact_m);
  EXPECT_EQ(pressed.peak_pressure_Pa, frictionless.peak_pressure_Pa);
}

TEST(ArmExponent, IsThatOfTheArm) {
  for (const double exponent : {-0.99, -0.5, 0., 0.3, 0.5, 1., 2., 7., 40., 1000.})
    // The stated 2e-8 of its formula, and at large exponents the rounding of the arm.
    EXPECT_NEAR(exponent_plus_one(torque_arm_exact_m(1, 1, exponent)), exponent + 1,
                2e-8 + 1e-14 * exponent * exponent)
        << exponent;
}

TEST(RubbedRatios, StayBetweenNoneAndOneForAnyContact) {
  for (const double nu : {0.0, 0.3, 0.37, 0.45, 0.499, 0.5})
    for (const double s : {0.0, 1e-300, 1e-9, 1e-3, 1.0, 1e3, 1e9, 1e300})
      for (const double mu : {0.0, 1e-300, 1e-3, 0.3, 1e9, kAllSticks}) {
        const RubbedRatios ratios = rubbed_ratios(nu, s, mu);
        for (const double ratio : {ratios.size, ratios.indentation, ratios.torque_arm}) {
          EXPECT_GT(ratio, 0.5) << nu << " " << s << " " << mu;
          EXPECT_LE(ratio, 1) << nu << " " << s << " " << mu;
        }
      }
}

TEST(RubbedRatios, FallWithFriction) {
  for (const double nu : {0.3, 0.49}) {
    double before = 1;
    for (const double mu : {0.01, 0.05, 0.1, 0.3, 1.0}) {
      const double ratio = rubbed_ratios(nu, 2, mu).indentation;
      EXPECT_LE(ratio, before) << nu << " " << mu;
      before = ratio;
    }
  }
}

}  // namespace
}  // namespace softfinger
