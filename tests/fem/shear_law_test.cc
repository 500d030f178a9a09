// Friction of every shear law on a layer so thick that its pressure is Hertz'.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "fem/friction/friction_bound.h"
#include "fem/program/reference_solver.h"
#include "softfinger/friction/shear_surface.h"

namespace softfinger::fem {
namespace {

using Kind = ShearLaw::Kind;

void quiet(const std::string&) {}

Problem thick_layer(Kind law) {
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.02, 0.01, 0}, {0.02, 2e5, 0.4}, {0.05, 0.3}};
  problem.friction.torsion = true;
  problem.friction.increments = 6;
  problem.friction.limit_surface = 8;
  problem.shear_law = law;
  // About half of mu p_0, with p_0 about 14 kPa.
  if (law != Kind::coulomb) problem.shear_strength_Pa = 2e3;
  return problem;
}

/// Relative deviation of the layer from a half-space and of its pressure from (1 - s²)^(1/2).
constexpr double kNotHertz = 0.01;

class ShearLawOnThickLayer : public testing::TestWithParam<Kind> {};

TEST_P(ShearLawOnThickLayer, HasItsForceTorqueAndLimitSurface) {
  const Problem problem = thick_layer(GetParam());
  const Result result = solve(problem, quiet);
  const LevelResult& found = result.finest;
  const PressedEllipse contact{found.a_m, found.b_m, 0.5, found.load_N};
  const ShearSurface exact(problem.friction_law(), contact);
  const double ellipse = result.error.a + result.error.b + kNotHertz;
  std::printf("%s: torque %+.4f (stated %.4f), at full slip %+.4f (%.4f), force %+.4f\n",
              problem.friction_law().name(), found.max_torque_Nm / exact.max_torque_Nm() - 1,
              result.error.max_torque, result.torsion->full_slip_Nm / exact.max_torque_Nm() - 1,
              result.torsion->full_slip_error, found.max_force_N / exact.max_force_N() - 1);
  EXPECT_NEAR(found.max_force_N / exact.max_force_N(), 1, ellipse);
  EXPECT_NEAR(found.max_torque_Nm / exact.max_torque_Nm(), 1, result.error.max_torque + kNotHertz);
  EXPECT_NEAR(result.torsion->full_slip_Nm / exact.max_torque_Nm(), 1,
              result.torsion->full_slip_error + kNotHertz);
  EXPECT_NEAR(result.torsion->increments.back().wrench.torque_Nm / result.torsion->full_slip_Nm, 1,
              1e-3)
      << "the twist ends in full slip";
  ASSERT_EQ(result.limit_surface.size(), 8u);
  for (const LimitPoint& point : result.limit_surface)
    EXPECT_NEAR(
        exact.utilisation({point.wrench.force_x_N, point.wrench.force_y_N, point.wrench.torque_Nm}),
        1, result.limit_surface_error + kNotHertz);
}

INSTANTIATE_TEST_SUITE_P(All, ShearLawOnThickLayer,
                         testing::Values(Kind::coulomb, Kind::shear_strength, Kind::limited,
                                         Kind::adhesive_shear),
                         [](const auto& tested) {
                           return std::string(kShearLawNames[std::size_t(tested.param)]);
                         });

// Pressed hardly at all, the contact is small and carries little; Coulomb's law is proportional to
// the load, a strength to the area.
TEST(ShearLaw, StrengthCarriesWhatTheAreaDoesWhateverTheLoad) {
  Problem problem = thick_layer(Kind::shear_strength);
  problem.friction = {};
  const Result light = solve(problem, quiet);
  problem.contact.load.normal_force_N *= 8;
  const Result heavy = solve(problem, quiet);
  const double area = heavy.finest.area_projected_m2 / light.finest.area_projected_m2;
  EXPECT_NEAR(area, 4, 4 * (light.error.area + heavy.error.area + kNotHertz)) << "P^(2/3)";
  EXPECT_NEAR(heavy.finest.max_force_N / light.finest.max_force_N / area, 1, 1e-9);
  EXPECT_NEAR(heavy.finest.max_torque_Nm / light.finest.max_torque_Nm / std::pow(area, 1.5), 1,
              light.error.max_torque + heavy.error.max_torque);
}

TEST(ShearLaw, NodesThatTouchHaveTheContactsAreaTogether) {
  const ShearLaw law{Kind::shear_strength, 0, 1};
  Eigen::VectorXd force(5), area(5), radius(5);
  force << 3, 2, 1, 0, 0;
  area << 1, 2, 2, 2, 2;
  radius << 0, 0.5, 0.95, 1.2, 1.5;
  const Eigen::VectorXd share = strength_share(law, {force, area, radius, 0.1, 4.5});
  EXPECT_NEAR(share.dot(area), 4.5, 1e-12);
  EXPECT_EQ(share[1], 1);
  EXPECT_EQ(share[2], 0.75);
  EXPECT_EQ(share[3], 0);
  // With no touching node at the ellipse's edge, all nodes count alike.
  radius *= 0.5;
  const Eigen::VectorXd inside = strength_share(law, {force, area, radius, 0.1, 4.5});
  EXPECT_NEAR(inside.dot(area), 4.5, 1e-12);
  EXPECT_EQ(inside[0], inside[2]);
}

TEST(ShearLaw, IsReachedAtFiniteStrainToo) {
  Problem problem = thick_layer(Kind::adhesive_shear);
  problem.friction.limit_surface = 2;
  const Result linear = solve(problem, quiet);
  problem.finite_strain.emplace();
  const Result finite = solve(problem, quiet);
  // Strains are small here, so that the two agree.
  EXPECT_NEAR(finite.finest.max_force_N / linear.finest.max_force_N, 1, 0.02);
  EXPECT_NEAR(finite.torsion->full_slip_Nm / linear.torsion->full_slip_Nm, 1,
              linear.torsion->full_slip_error + finite.torsion->full_slip_error);
  for (std::size_t i = 0; i < linear.limit_surface.size(); ++i)
    EXPECT_NEAR(finite.limit_surface[i].wrench.torque_Nm / linear.limit_surface[i].wrench.torque_Nm,
                1, linear.limit_surface_error + finite.limit_surface_error);
}

}  // namespace
}  // namespace softfinger::fem
