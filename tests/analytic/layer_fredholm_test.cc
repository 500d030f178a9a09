#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "layer_reference.h"
#include "softfinger/layer/circular_contact.h"
#include "softfinger/layer/elliptic_contact.h"
#include "softfinger/layer/layer_kernel.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

const PressureModel& fredholm() { return *find_pressure_model("layer_fredholm"); }

/// E* = E / (1 - nu²) in pascals, R, h: none of them one, so that no unit is forgotten.
constexpr double kModulus_Pa = 3e5, kThickness_m = 2e-3, kRadius_m = 0.3;

ContactProblem round_contact(double nu, double load_N) {
  return {{kRadius_m, kRadius_m}, {kThickness_m, kModulus_Pa * (1 - nu * nu), nu}, {load_N, 0.7}};
}

TEST(LayerFredholm, SaysWhichOfTwoLayersIsPressedThrough) {
  // Both layers of one material: the thin one takes the share of its thickness, if nu is small.
  ContactProblem problem = round_contact(0, 1);
  problem.object_layer = problem.layer;
  problem.object_layer.thickness_m = kThickness_m / 10;
  problem.object_layer.youngs_modulus_Pa /= 50;
  const auto strain = [](const Prediction& prediction) {
    for (const ValidityCheck& check : prediction.validity)
      if (std::string(check.check) == "small_strain") return check.value;
    return -1.;
  };
  // Columns: u = p h/E, the thin soft layer is strained fifty times as much as the other one.
  const Prediction gentle = fredholm().predict(problem);
  ASSERT_TRUE(gentle.has_answer);
  const double share = 5. / 6;
  EXPECT_NEAR(strain(gentle) / (share * gentle.indentation_m / problem.object_layer.thickness_m), 1,
              0.02)
      << "a/h = " << gentle.a_m / kThickness_m;
  while (problem.load.normal_force_N < 1e4 && fredholm().predict(problem).has_answer)
    problem.load.normal_force_N *= 1.5;
  const Prediction pressed = fredholm().predict(problem);
  ASSERT_FALSE(pressed.has_answer);
  EXPECT_STREQ(pressed.validity.begin()->check, "not_pressed_through");
}

TEST(LayerKernel, EqualsItsFormulaAndItsLimits) {
  for (const double nu : {0.0, 0.2, 0.45, 0.4999, 0.5}) {
    const LayerKernel kernel(nu);
    const long double kappa = 3 - 4 * (long double)nu;
    for (const double x : {0.3, 0.99, 1.0, 1.7, 4.0, 12.0}) {
      const long double y = x;
      const double w = double((2 * kappa * std::sinh(2 * y) - 4 * y) /
                              (2 * kappa * std::cosh(2 * y) + 4 * y * y + 1 + kappa * kappa));
      EXPECT_NEAR(kernel.compliance(x) / w, 1, 1e-14) << nu << " " << x;
      EXPECT_NEAR(kernel.compliance(x) + kernel.stiffening(x), 1, 1e-15) << nu << " " << x;
    }
    // Next term: of relative order x².
    const double x = 1e-4, thin = nu == 0.5 ? 2 * x * x * x / 3
                                            : x * (1 - 2 * nu) / (2 * (1 - nu) * (1 - nu)) +
                                                  2 * x * x * x / 3;
    EXPECT_NEAR(kernel.compliance(x) / thin, 1, 3 * x * x) << nu;
    EXPECT_EQ(kernel.compliance(1e3), 1);
    EXPECT_LT(kernel.stiffening(kLargestLayerWaveNumber), 2e-15);
  }
}

TEST(LayerFredholm, EqualsPublishedSolutions) {
  constexpr double kTolerance = 2e-8;  // the reference's 1e-8 in P, and the same again in the rest
  double worst = 0;
  for (const testing::CircularRow& row : testing::kCircularRows) {
    const double a = row.s * kThickness_m;
    const double P = row.load * kModulus_Pa * a * a * a / kRadius_m;
    const ContactProblem problem = round_contact(row.nu, P);
    const Prediction prediction = fredholm().predict(problem);
    ASSERT_TRUE(prediction.has_answer);
    const double errors[] = {
        prediction.a_m / a - 1,
        prediction.b_m / a - 1,
        prediction.indentation_m / (row.indentation * a * a / kRadius_m) - 1,
        prediction.torque_arm_exact_m / (row.arm * a) - 1,
        prediction.peak_pressure_Pa / (row.peak * kModulus_Pa * a / kRadius_m) - 1,
        fredholm().pressure_Pa(problem, prediction, 0.3 * a, 0.4 * a) /
                (row.at_half * kModulus_Pa * a / kRadius_m) -
            1};
    for (const double error : errors) {
      EXPECT_NEAR(error, 0, kTolerance) << "s " << row.s << " nu " << row.nu;
      worst = std::max(worst, std::abs(error));
    }
  }
  std::printf("layer_fredholm: largest relative error against published solutions %.1e\n", worst);
}

TEST(LayerFredholm, AgreesWithTheSpectralMethodForThinLayers) {
  // Two methods with nothing in common but the kernel; both lose digits as w falls to 1e-6.
  for (const double nu : {0.0, 0.45, 0.5}) {
    const double s = 40;
    const auto fredholm = circular_layer_contact(s, 1, {{LayerKernel(nu), 1, 1}});
    const auto spectral = elliptic_layer_contact(s, s, LayerKernel(nu), {50, 0});
    EXPECT_NEAR(fredholm.load_over_modulus_m2 / spectral.load, 1, 1e-6) << nu;
    EXPECT_NEAR(fredholm.indentation_m / spectral.indentation, 1, 2e-6) << nu;
    EXPECT_NEAR(fredholm.torque_arm_m / spectral.torque_arm, 1, 1e-6) << nu;
  }
}

TEST(LayerFredholm, TwoLikeLayersAreOneWithHalfOfTheGap) {
  ContactProblem two = round_contact(0.4, 2);
  two.object_layer = two.layer;
  ContactProblem one = round_contact(0.4, 2);
  one.radii = {2 * kRadius_m, 2 * kRadius_m};
  const Prediction of_two = fredholm().predict(two), of_one = fredholm().predict(one);
  EXPECT_NEAR(of_two.a_m / of_one.a_m, 1, 1e-12);  // the tolerance of the load, 1e-13, and rounding
  EXPECT_NEAR(of_two.indentation_m / (2 * of_one.indentation_m), 1, 1e-12);
  EXPECT_NEAR(of_two.peak_pressure_Pa / of_one.peak_pressure_Pa, 1, 1e-12);
}

TEST(LayerFredholm, AThickLayerOnTheObjectIsAHalfSpaceInSeries) {
  ContactProblem problem = round_contact(0.3, 1);
  problem.layer.thickness_m = problem.object_layer.thickness_m = 1e3;
  problem.object_layer.youngs_modulus_Pa = 1e5;
  problem.object_layer.poisson_ratio = 0.5;
  const double compliance = 1 / problem.layer.plane_strain_modulus_Pa() +
                            1 / problem.object_layer.plane_strain_modulus_Pa();
  const double a = std::cbrt(0.75 * compliance * kRadius_m);
  const Prediction prediction = fredholm().predict(problem);
  // The indentation feels the base to first order in a/h.
  EXPECT_NEAR(prediction.a_m / a, 1, 1e-12);
  EXPECT_NEAR(prediction.indentation_m / (a * a / kRadius_m), 1, 3 * a / 1e3);
}

TEST(LayerFredholm, RefusesInWordsWhatItCannotSolve) {
  ContactProblem problem = round_contact(0.4, 2);
  problem.radii.major_m *= 1.01;
  const Prediction elliptic = fredholm().predict(problem);
  EXPECT_FALSE(elliptic.has_answer);
  EXPECT_EQ(std::string(elliptic.validity.begin()->check), "round");
  problem = round_contact(0.4, 2);
  problem.layer.thickness_m = 1e-6;
  const Prediction thin = fredholm().predict(problem);
  EXPECT_FALSE(thin.has_answer);
  EXPECT_EQ(std::string(thin.validity.begin()->check), "solvable");
}

}  // namespace
}  // namespace softfinger
