// Checks whether finite-element answers lie within the theory they were solved with.
#include "comparisons/reference/theory_limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "comparisons/judgement/atlas/error_atlas.h"
#include "comparisons/judgement/reference_bound.h"
#include "comparisons/reference/full_reference.h"

namespace softfinger {
namespace {

input::Case limited_case(const std::string& geometry, double poisson_ratio,
                         const std::string& fem) {
  return input::parse_case("id = \"x\"\n[geometry]\n" + geometry +
                               "\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
                               "poisson_ratio = " +
                               std::to_string(poisson_ratio) +
                               "\n[contact]\nload_N = 1\nfriction_coefficient = 0.5\n[fem]\n" + fem,
                           "x.toml");
}

reference::ReferenceResult result_with(double a_m, double b_m, double indentation_m) {
  reference::ReferenceResult result;
  result.load_N = 1;
  result.a_m = a_m;
  result.b_m = b_m;
  result.indentation_m = indentation_m;
  result.error.a = result.error.b = result.error.indentation = result.error.area =
      result.error.peak_pressure = result.error.max_torque = 0.01;
  return result;
}

constexpr const char* kRadii = "relative_radii_mm = [20, 10]";

Validity limits(const input::Case& solved, const reference::ReferenceResult& result) {
  return reference::theory_limits(
      solved, prediction::GeometryResolver(solved).resolve(result.load_N), result);
}

TEST(TheoryLimits, EndLinearTheoryAtLargeStrainsAndSlopes) {
  const input::Case linear = limited_case(kRadii, 0.45, "kinematics = \"linear\"\n");
  EXPECT_TRUE(limits(linear, result_with(2e-3, 1e-3, 0.4e-3)).holds());
  const Validity strained = limits(linear, result_with(2e-3, 1e-3, 1.9e-3));
  EXPECT_FALSE(strained.holds());
  EXPECT_STREQ(strained.begin()->check, "small_strain");
  EXPECT_DOUBLE_EQ(strained.begin()->value, 0.95);
  EXPECT_DOUBLE_EQ(strained.begin()->limit, 0.3);
  EXPECT_EQ(reference::beyond_limits_in_words(strained),
            "beyond linear theory: small_strain 0.95, holds below 0.3");
  EXPECT_FALSE(limits(linear, result_with(2e-3, 5e-3, 0.4e-3)).holds()) << "b/R'' = 0.5";
  const input::Case foam = limited_case(kRadii, 0, "kinematics = \"linear\"\n");
  EXPECT_FALSE(limits(foam, result_with(2e-3, 1e-3, 0.4e-3)).holds()) << "of less strain";
  const input::Case finite = limited_case(kRadii, 0.45, "kinematics = \"finite\"\n");
  EXPECT_TRUE(limits(finite, result_with(2e-3, 5e-3, 1.5e-3)).holds());
}

TEST(TheoryLimits, ShareTheIndentationOfTwoLayers) {
  input::Case two = limited_case(kRadii, 0.45, "kinematics = \"linear\"\n");
  two.object_layer = two.layer;
  const auto strain = [&] { return limits(two, result_with(2e-3, 1e-3, 0.4e-3)).begin()->value; };
  EXPECT_DOUBLE_EQ(strain(), 0.5 * 0.4e-3 / two.layer.thickness_m) << "two that are alike";
  // A layer that is 1e9 times as hard takes some 1e-9 of the indentation.
  two.object_layer.youngs_modulus_Pa *= 1e9;
  EXPECT_NEAR(strain(), 0.4e-3 / two.layer.thickness_m, 1e-8) << "a hard one takes none of it";
  two.object_layer.youngs_modulus_Pa *= 1e-18;
  two.object_layer.thickness_m *= 2;
  EXPECT_NEAR(strain(), 0.4e-3 / two.object_layer.thickness_m, 1e-8) << "a soft one takes all";
}

TEST(TheoryLimits, LeaveOutEveryRunOfTheAtlasInWhichLinearTheoryIsOffByFivePercent) {
  using prediction::Quantity;
  const judgement::AtlasFile& atlas = judgement::finite_strain_atlas().file();
  const auto& linear_errors = atlas.errors.at("fem_linear");
  constexpr double h_m = 2e-3;
  int beyond = 0, within = 0;
  for (std::size_t i = 0; i < atlas.runs.size(); ++i) {
    const judgement::AtlasRun& run = atlas.runs[i];
    if (!judgement::is_finite_strain(run.kind)) continue;
    const double radius_mm = 1e3 * h_m / run.thickness_over_radius;
    const double stretch = std::sqrt(run.radii_ratio);
    const input::Case solved =
        limited_case("relative_radii_mm = [" + std::to_string(radius_mm * stretch) + ", " +
                         std::to_string(radius_mm / stretch) + "]",
                     run.poisson_ratio, "kinematics = \"linear\"\n");
    const auto answer = [&](Quantity q) { return h_m * run.answer[std::size_t(q)]; };
    const bool holds = limits(solved, result_with(answer(Quantity::a), answer(Quantity::b),
                                                  answer(Quantity::indentation)))
                           .holds();
    double error = 0;
    for (const Quantity q : {Quantity::a, Quantity::b, Quantity::area, Quantity::max_torque})
      error = std::max(error, std::abs(linear_errors[i][std::size_t(q)]));
    if (error > 0.05) {
      EXPECT_FALSE(holds) << "run " << i << " is off by " << error;
      ++beyond;
    }
    if (error > 0 && error < 0.01) {
      EXPECT_TRUE(holds) << "run " << i << " is off by " << error << " only";
      ++within;
    }
  }
  EXPECT_GT(beyond, 5);
  EXPECT_GT(within, 30);
}

TEST(ReferenceBound, OfTheFullReferenceIsTheElementsAndTheScansTogether) {
  const input::Case solved = limited_case(kRadii, 0.45, "kinematics = \"finite\"\n");
  const prediction::LocalGeometry geometry = prediction::GeometryResolver(solved).resolve(1);
  reference::ReferenceResult result = result_with(2e-3, 1e-3, 0.4e-3);
  const auto bound = [&](bool is_full, bool within_theory) {
    return judgement::bound_of({solved, geometry, result, is_full, within_theory, false}).bound;
  };
  const auto of_elements = bound(true, true);
  ASSERT_TRUE(of_elements);
  for (const double one : *of_elements) EXPECT_EQ(one, 0.01);
  result.geometry_error = result.error;
  const auto with_scan = bound(true, true);
  ASSERT_TRUE(with_scan);
  for (const double one : *with_scan) EXPECT_EQ(one, 0.02);
  EXPECT_FALSE(bound(false, true)) << "nobody knows a flat layer at finite strain";
  EXPECT_FALSE(bound(true, false));
  result.geometry_error.reset();
  result.is_geometry_unknown = true;
  EXPECT_FALSE(bound(true, true));
}

TEST(ReferenceBound, OfAFlatLayerInLinearTheoryHasItsDistanceToTheFinger) {
  const input::Case solved =
      limited_case("finger.radii_mm = [20, 10]\nobject.radii_mm = [inf, inf]", 0.45,
                   "geometry = \"flat\"\nkinematics = \"linear\"\n");
  const prediction::LocalGeometry geometry = prediction::GeometryResolver(solved).resolve(1);
  const reference::ReferenceResult result = result_with(2e-3, 1e-3, 0.4e-3);
  const judgement::ReferenceBound found =
      judgement::bound_of({solved, geometry, result, false, true, false});
  ASSERT_TRUE(found.bound) << found.evidence;
  for (const double one : *found.bound) {
    EXPECT_GT(one, 0.01) << "more than the elements' own";
    EXPECT_LT(one, 0.3);
  }
  EXPECT_FALSE(judgement::bound_of({solved, geometry, result, false, true, true}).bound)
      << "at a given approach";
}

}  // namespace
}  // namespace softfinger
