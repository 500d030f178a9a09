#include "softfinger/layer/bonded_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "layer_reference.h"
#include "softfinger/input/constants.h"
#include "softfinger/layer/elliptic_contact.h"
#include "softfinger/layer/layer_limits.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

const PressureModel& model(const char* name = "bonded_layer") { return *find_pressure_model(name); }

/// Layer of thickness 1 with E* = 1 under a quadric with sqrt(R' R'') = 1.
BondedLayerContact unit_contact(double load, double radii_ratio, double compressibility) {
  const double nu = 0.5 * (1 - compressibility), k = std::sqrt(radii_ratio);
  return bonded_layer_contact({k, 1 / k}, {1, 1 - nu * nu, nu}, load);
}

/// Relative errors, in the order of their names.
using Errors = std::array<double, 5>;
constexpr const char* kErrorNames[] = {"a", "b", "torque arm", "indentation", "peak"};

Errors errors_against(const EllipticLayerContact& truth, double compressibility) {
  const BondedLayerContact contact = unit_contact(truth.load, truth.radii_ratio, compressibility);
  return {contact.a_m / truth.a - 1, contact.b_m / truth.b - 1,
          contact.torque_arm_exact_m / truth.torque_arm - 1,
          contact.indentation_m / truth.indentation - 1,
          contact.peak_pressure_Pa / truth.peak_pressure - 1};
}

void keep_worst(const Errors& errors, Errors* worst) {
  for (std::size_t i = 0; i < errors.size(); ++i)
    (*worst)[i] = std::isfinite(errors[i]) ? std::max((*worst)[i], std::abs(errors[i])) : 1e300;
}

void print(const char* what, const Errors& worst) {
  std::printf("bonded_layer: largest relative error, %s:", what);
  for (std::size_t i = 0; i < worst.size(); ++i) std::printf(" %s %.1e", kErrorNames[i], worst[i]);
  std::printf("\n");
}

/// Twice what was measured when the table was made (about 1,000 points): the table's error must not
/// grow. A tenth of the stated accuracy: 0.5 % in axes and torque, 1 % in the indentation.
constexpr Errors kStated = {3e-4, 3e-4, 5e-4, 1e-3, 1.5e-3};

void expect_stated(const Errors& worst) {
  for (std::size_t i = 0; i < worst.size(); ++i) EXPECT_LT(worst[i], kStated[i]) << kErrorNames[i];
}

EllipticLayerContact truth(double size, double log_aspect, double compressibility) {
  const double a = size * std::exp(0.5 * log_aspect), b = size * std::exp(-0.5 * log_aspect);
  return elliptic_layer_contact(a, b, LayerKernel(LayerKernel::Compressibility{compressibility}),
                                sufficient_resolution(a, b));
}

TEST(BondedLayer, EqualsPublishedRoundSolutions) {
  Errors worst{};
  for (const testing::CircularRow& row : testing::kCircularRows) {
    const double s = row.s;
    const BondedLayerContact contact = unit_contact(row.load * s * s * s, 1, 1 - 2 * row.nu);
    keep_worst(
        {contact.a_m / s - 1, contact.b_m / s - 1, contact.torque_arm_exact_m / (row.arm * s) - 1,
         contact.indentation_m / (row.indentation * s * s) - 1,
         contact.peak_pressure_Pa / (row.peak * s) - 1},
        &worst);
  }
  print("published round contacts", worst);
  expect_stated(worst);
}

TEST(BondedLayer, EqualsPublishedEllipticSolutions) {
  Errors worst{};
  for (const testing::EllipticRow& row : testing::kEllipticRows) {
    const BondedLayerContact contact = unit_contact(row.load, row.radii_ratio, 1 - 2 * row.nu);
    keep_worst(
        {contact.a_m / row.a - 1, contact.b_m / row.b - 1,
         contact.torque_arm_exact_m * row.load / row.torque - 1,
         contact.indentation_m / row.indentation - 1, contact.peak_pressure_Pa / row.peak - 1},
        &worst);
  }
  print("published elliptic contacts", worst);
  expect_stated(worst);
}

// The table was made with this solver, and the tests below compare the table with it. Here the
// solver itself is compared with the publication.
TEST(EllipticLayerContact, EqualsPublishedSolutions) {
  for (const testing::EllipticRow& row : testing::kEllipticRows) {
    const EllipticLayerContact contact = elliptic_layer_contact(
        row.a, row.b, LayerKernel(row.nu), sufficient_resolution(row.a, row.b));
    // The publication's precision: 1.3e-4 in a and b, to which the ratio of radii answers with a
    // power up to 2; the rest 1e-5, and what a and b make of it.
    EXPECT_NEAR(contact.radii_ratio / row.radii_ratio, 1, 2.6e-4);
    EXPECT_NEAR(contact.load / row.load, 1, 1e-4);
    EXPECT_NEAR(contact.indentation / row.indentation, 1, 1e-4);
    EXPECT_NEAR(contact.torque_arm * contact.load / row.torque, 1, 1e-4);
    EXPECT_NEAR(contact.peak_pressure / row.peak, 1, 1e-4);
  }
}

TEST(EllipticLayerContact, MeetsAGivenLoad) {
  const LayerKernel kernel(0.47);
  const EllipticLayerContact known =
      elliptic_layer_contact(2, 0.8, kernel, sufficient_resolution(2, 0.8));
  const EllipticLayerContact found =
      elliptic_layer_contact_at_load(known.load, known.radii_ratio, kernel, 2.2, 0.7);
  // The residual is 1e-7 in load and ratio, whose powers are 1/3 to 1/2.
  EXPECT_NEAR(found.a / 2, 1, 1e-7);
  EXPECT_NEAR(found.b / 0.8, 1, 1e-7);
}

TEST(BondedLayer, KeepsItsStatedErrorOverADenseGrid) {
  Errors worst{};
  for (double size = 0.01; size < 101; size *= 1.9307)  // 0.01 to 100 in 14 steps
    for (const double compressibility : {1.0, 0.6, 0.3, 0.1, 0.02, 2e-3, 2e-4, 0.0})
      for (const double log_aspect : {0.0, 0.35, 1.1}) {
        const EllipticLayerContact contact = truth(size, log_aspect, compressibility);
        keep_worst(errors_against(contact, compressibility), &worst);
      }
  print("dense grid", worst);
  expect_stated(worst);
}

TEST(BondedLayer, KeepsItsStatedErrorAtRandomPoints) {
  std::mt19937_64 random(20070322);
  std::uniform_real_distribution<double> uniform(0, 1);
  Errors worst{};
  for (int i = 0; i < 300; ++i) {
    const double size = std::pow(10, -2 + 4 * uniform(random));
    const double compressibility = i % 2 ? uniform(random) : std::pow(10, -6 * uniform(random));
    const EllipticLayerContact contact =
        truth(size, (size < 1 ? 3 : 2.2) * uniform(random), compressibility);
    if (contact.radii_ratio > 100 || contact.radii_ratio < 1) continue;
    keep_worst(errors_against(contact, compressibility), &worst);
  }
  print("random points", worst);
  expect_stated(worst);
}

TEST(BondedLayer, TendsToTheExactLimits) {
  for (const double ratio : {1.0, 7.0, 100.0}) {
    ContactProblem problem{{0.01 * ratio, 0.01}, {1, 3e5, 0.45}, {1e-6, 0.5}};
    // a/h is below 1e-3; the indentation feels the base to first order in it.
    Prediction one = model().predict(problem), limit = model("hertz").predict(problem);
    const double thick = limit.a_m / problem.layer.thickness_m;
    EXPECT_NEAR(one.a_m / limit.a_m, 1, thick);
    EXPECT_NEAR(one.b_m / limit.b_m, 1, thick);
    EXPECT_NEAR(one.torque_arm_exact_m / limit.torque_arm_exact_m, 1, thick);
    EXPECT_NEAR(one.indentation_m / limit.indentation_m, 1, 3 * thick);

    // Thin: corrections of order h/b, with factors up to 10 for the incompressible layer.
    problem.layer.thickness_m = 1e-9;
    for (const double nu : {0.2, 0.5}) {
      problem.layer.poisson_ratio = nu;
      one = model().predict(problem);
      limit = model(nu == 0.5 ? "thin_incompressible" : "winkler").predict(problem);
      const double thin = 10 * problem.layer.thickness_m / limit.b_m;
      ASSERT_LT(thin, 0.05);
      EXPECT_NEAR(one.a_m / limit.a_m, 1, thin) << nu << " " << ratio;
      EXPECT_NEAR(one.b_m / limit.b_m, 1, thin) << nu << " " << ratio;
      EXPECT_NEAR(one.torque_arm_exact_m / limit.torque_arm_exact_m, 1, thin);
      EXPECT_NEAR(one.indentation_m / limit.indentation_m, 1, 2 * thin);
    }
  }
}

TEST(BondedLayer, GrowsWithLoadAndShrinksWithStiffnessEverywhere) {
  for (const double ratio : {1.0, 4.0, 100.0, 1e4})
    for (const double compressibility : {1.0, 0.3, 0.02, 1e-4, 0.0}) {
      BondedLayerContact last = unit_contact(1e-8, ratio, compressibility);
      for (double load = 1.05e-8; load < 1e14; load *= 1.05) {
        const BondedLayerContact next = unit_contact(load, ratio, compressibility);
        ASSERT_GT(next.a_m, last.a_m) << load;
        ASSERT_GT(next.b_m, last.b_m) << load;
        ASSERT_GT(next.torque_arm_exact_m, last.torque_arm_exact_m) << load;
        ASSERT_GT(next.indentation_m, last.indentation_m) << load;
        ASSERT_GT(next.peak_pressure_Pa, last.peak_pressure_Pa) << load;
        last = next;
      }
    }
  // At given E*, towards nu = 1/2 the layer only gets stiffer.
  for (const double ratio : {1.0, 4.0, 100.0})
    for (double load = 1e-6; load < 1e9; load *= 10) {
      BondedLayerContact last = unit_contact(load, ratio, 1);
      for (double compressibility = 0.99; compressibility > 0; compressibility -= 0.01) {
        const BondedLayerContact next = unit_contact(load, ratio, compressibility);
        ASSERT_LT(next.a_m * next.b_m, last.a_m * last.b_m * (1 + 1e-6)) << load << " " << ratio;
        ASSERT_LT(next.indentation_m, last.indentation_m * (1 + 1e-6)) << load << " " << ratio;
        last = next;
      }
    }
}

TEST(BondedLayer, IsContinuousAcrossTheEdgesOfItsTable) {
  for (const double ratio : {1.0, 3.0, kTableRadiiRatioMax})
    for (const double compressibility : {1.0, 0.02, 0.0}) {
      const LimitShapes shapes = limit_shapes(ratio);
      for (const double edge : {kTableLogSizeMin, kTableLogSizeMax}) {
        double lower = -100, upper = 100;
        for (int i = 0; i < 100; ++i) {
          const double middle = 0.5 * (lower + upper);
          (layer_blend(shapes, middle, compressibility)[kSize] < edge ? lower : upper) = middle;
        }
        const double step = 1e-11;
        const auto below = unit_contact(std::exp(lower - step), ratio, compressibility);
        const auto above = unit_contact(std::exp(lower + step), ratio, compressibility);
        // No exponent of the load exceeds one.
        const double tolerance = 2 * step + 1e-13;
        EXPECT_NEAR(above.a_m / below.a_m, 1, tolerance);
        EXPECT_NEAR(above.b_m / below.b_m, 1, tolerance);
        EXPECT_NEAR(above.torque_arm_exact_m / below.torque_arm_exact_m, 1, tolerance);
        EXPECT_NEAR(above.indentation_m / below.indentation_m, 1, tolerance);
        EXPECT_NEAR(above.peak_pressure_Pa / below.peak_pressure_Pa, 1, tolerance);
      }
      const auto inside = unit_contact(1, kTableRadiiRatioMax * (1 - 1e-11), compressibility);
      const auto outside = unit_contact(1, kTableRadiiRatioMax * (1 + 1e-11), compressibility);
      // The ratio changes by 2e-11, and no exponent of it exceeds one; the rest is round-off.
      EXPECT_NEAR(inside.a_m / outside.a_m, 1, 2e-11 + 1e-13);
      EXPECT_NEAR(inside.indentation_m / outside.indentation_m, 1, 2e-11 + 1e-13);
    }
}

TEST(BondedLayer, SensitivityIsTheDerivativeOfTheContact) {
  for (const double ratio : {1.0, 2.5, 60.0, 1e5})
    for (const double nu : {0.0, 0.4, 0.499, 0.5})
      for (double load = 1e-7; load < 1e12; load *= 7) {
        const double k = std::sqrt(ratio);
        const RelativeRadii radii{0.01 * k, 0.01 / k};
        const ElasticLayer layer{0.002, 2e5, nu};
        const double step = 1e-4;
        const BondedLayerContact lower = bonded_layer_contact(radii, layer, load * (1 - step)),
                                 upper = bonded_layer_contact(radii, layer, load * (1 + step)),
                                 middle = bonded_layer_contact(radii, layer, load);
        const BondedLayerSensitivity slope = bonded_layer_sensitivity(radii, layer, load);
        // Central difference: step² times the third derivative, and where the step crosses an edge
        // of the table half of the jump of the slope there.
        const double tolerance = 2e-3;
        const double scale = 1 / (2 * step * load);
        const double area = middle.a_m * middle.b_m;
        EXPECT_NEAR(slope.area_m2_per_N * load / area,
                    kPi * (upper.a_m * upper.b_m - lower.a_m * lower.b_m) * scale * load / area,
                    tolerance);
        EXPECT_NEAR(
            slope.indentation_m_per_N * load / middle.indentation_m,
            (upper.indentation_m - lower.indentation_m) * scale * load / middle.indentation_m,
            tolerance);
        EXPECT_NEAR(slope.torque_arm_m_per_N * load / middle.torque_arm_exact_m,
                    (upper.torque_arm_exact_m - lower.torque_arm_exact_m) * scale * load /
                        middle.torque_arm_exact_m,
                    tolerance);
      }
}

TEST(BondedLayer, TwoLikeLayersAreOneWithHalfOfTheGap) {
  ContactProblem two{{0.02, 0.01}, {0.002, 3e5, 0.45}, {1, 0.5}};
  ContactProblem one = two;
  one.radii = {0.04, 0.02};
  two.object_layer = two.layer;
  const Prediction of_two = model().predict(two), of_one = model().predict(one);
  EXPECT_EQ(of_two.a_m, of_one.a_m);
  EXPECT_EQ(of_two.indentation_m, 2 * of_one.indentation_m);
  two.object_layer.poisson_ratio = 0.4;
  const Prediction different = model().predict(two);
  EXPECT_FALSE(different.has_answer);
  EXPECT_EQ(std::string(different.validity.begin()->check), "single_layer");
}

TEST(BondedLayer, SaysWhereItsTableEnds) {
  const auto holds = [](const ContactProblem& problem, const std::string& name) {
    for (const ValidityCheck& check : model().predict(problem).validity)
      if (check.check == name) return check.holds();
    return false;
  };
  ContactProblem problem{{10, 0.1}, {0.002, 3e5, 0.45}, {1, 0.5}};
  EXPECT_TRUE(holds(problem, "table_radii_ratio"));
  EXPECT_TRUE(holds(problem, "table_size"));
  problem.radii.major_m = 11;
  EXPECT_FALSE(holds(problem, "table_radii_ratio"));
  problem.layer.thickness_m = 1e-6;
  EXPECT_FALSE(holds(problem, "table_size"));
}

// The pressure field of the model against the exact one, over the peak.
TEST(BondedLayer, PressureFollowsTheExactOne) {
  double worst = 0;
  for (const testing::CircularRow& row : testing::kCircularRows) {
    const double s = row.s;
    const ContactProblem problem{
        {1, 1}, {1, 1 - row.nu * row.nu, row.nu}, {row.load * s * s * s, 0.5}};
    const Prediction prediction = model().predict(problem);
    const double p = model().pressure_Pa(problem, prediction, 0.3 * s, 0.4 * s);
    worst = std::max(worst, std::abs(p - row.at_half * s) / (row.peak * s));
  }
  std::printf("bonded_layer: largest error of the pressure at r = a/2 over the peak %.1e\n", worst);
  EXPECT_LT(worst, 0.01);
}

}  // namespace
}  // namespace softfinger
