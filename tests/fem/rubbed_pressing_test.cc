#include "fem/friction/rubbed_pressing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fem/problem/check_problem.h"
#include "fem/program/reference_solver.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "softfinger/input/errors.h"
#include "tests/analytic/rubbed_reference.h"

namespace softfinger::fem {
namespace {

const Progress quiet = [](const std::string&) {};

constexpr double thickness_m = 2e-3, radius_m = 0.2, youngs_Pa = 3e5;

Problem problem_of(const RubbedReference& row) {
  Problem problem;
  problem.contact.layer = {thickness_m, youngs_Pa, row.nu};
  problem.contact.radii = {radius_m, radius_m, 0};
  const double modulus_Pa = problem.contact.layer.plane_strain_modulus_Pa();
  problem.contact.load = {row.load * modulus_Pa * std::pow(thickness_m, 3) / radius_m,
                          std::isfinite(row.mu) ? row.mu : 0.8};
  problem.pressing = std::isfinite(row.mu) ? PressingFriction::coulomb : PressingFriction::stuck;
  return problem;
}

TEST(RubbedPressing, AgreesWithIndependentSolutionsInsideItsStatedErrors) {
  // The increments of the reference, and three digits of it.
  constexpr double of_reference = 1e-3;
  for (const RubbedReference& row : kRubbedReferences) {
    SCOPED_TRACE("nu " + std::to_string(row.nu) + ", s " + std::to_string(row.s) + ", mu " +
                 std::to_string(row.mu));
    const Problem problem = problem_of(row);
    const Result result = solve(problem, quiet);
    const double modulus_Pa = problem.contact.layer.plane_strain_modulus_Pa();
    const auto expect_inside = [&](double value, double truth, double stated, const char* what) {
      EXPECT_NEAR(value / truth, 1, stated + of_reference) << what;
    };
    expect_inside(result.finest.a_m / thickness_m, row.a, result.error.a, "a");
    expect_inside(result.finest.indentation_m * radius_m / std::pow(thickness_m, 2),
                  row.indentation, result.error.indentation, "d");
    expect_inside(result.finest.peak_pressure_Pa * radius_m / (modulus_Pa * thickness_m), row.peak,
                  result.error.peak_pressure, "peak");
    // The arm has no error of its own: the approach's stands for it.
    expect_inside(result.finest.pressure_arm_m / thickness_m, row.arm,
                  std::max(result.error.indentation, result.error.max_torque) + of_reference,
                  "arm");
    EXPECT_LT(result.error.indentation, 5e-3) << "an error that excuses everything";
  }
}

TEST(RubbedPressing, LeavesTheTorqueAtFullSlipAsItIs) {
  for (const RubbedReference& row : {kRubbedReferences[4], kRubbedReferences[12]}) {
    Problem problem = problem_of(row);
    problem.level = 1;
    problem.friction.torsion = true;
    problem.friction.increments = 8;
    const Result result = solve(problem, quiet);
    problem.pressing = PressingFriction::none;
    const Result frictionless = solve(problem, quiet);
    // Both meshes are made for contacts of their own size: 0.3 % of level 1's stated error.
    EXPECT_NEAR(result.torsion->full_slip_Nm / frictionless.torsion->full_slip_Nm, 1,
                result.torsion->full_slip_error);
    EXPECT_NEAR(result.finest.max_torque_Nm / frictionless.finest.max_torque_Nm, 1,
                result.error.max_torque);
    // Nodes whose friction is used up by pressing slip sooner: less torque at the same angle, but
    // for what two meshes of different size make of it.
    EXPECT_LT(result.torsion->increments[4].wrench.torque_Nm,
              frictionless.torsion->increments[4].wrench.torque_Nm * (1 + 1e-3));
  }
}

TEST(RubbedPressing, ToAnApproachIsThatToItsLoad) {
  Problem problem = problem_of(kRubbedReferences[13]);
  problem.level = 1;
  const Result by_load = solve(problem, quiet);
  problem.approach_m = by_load.finest.indentation_m;
  const Result by_approach = solve(problem, quiet);
  // A secant's 1e-7 in the approach, what pressure and friction settle to, and meshes for sizes
  // that are rounded to 0.1 %.
  constexpr double settled = 2e-4;
  EXPECT_NEAR(by_approach.finest.load_N / by_load.finest.load_N, 1, settled);
  EXPECT_NEAR(by_approach.finest.torque_arm_m / by_load.finest.torque_arm_m, 1, settled);
}

TEST(RubbedPressing, IsTheSameOnAWholeLayer) {
  Problem problem = problem_of(kRubbedReferences[13]);
  problem.level = 1;
  const Result quarter = solve(problem, quiet);
  ASSERT_TRUE(quarter.planes.both());
  // Two equal radii at an angle are no angle at all, but the mesh does not know.
  problem.fingertip.pad = meshes::paraboloid_pad(2 * radius_m, 2 * radius_m, 0.3);
  problem.fingertip.object = meshes::quadric_object(2 * radius_m, 2 * radius_m, 0.3);
  problem.fingertip.symmetric_object = false;
  const Result whole = solve(problem, quiet);
  ASSERT_FALSE(whole.planes.any());
  // The finger's own curvature, a/R = 0.015, changes d by less than the elements' error.
  EXPECT_NEAR(whole.finest.indentation_m / quarter.finest.indentation_m, 1,
              whole.error.indentation + quarter.error.indentation);
  EXPECT_NEAR(whole.finest.pressure_arm_m / quarter.finest.pressure_arm_m, 1,
              whole.error.indentation + quarter.error.indentation);
}

TEST(RubbedPressing, OfALongContactKeepsItsTwoMirrorPlanes) {
  Problem problem = problem_of(kRubbedReferences[13]);
  problem.level = 1;
  problem.contact.radii = {2 * radius_m, radius_m, 0};
  const Result rubbed = solve(problem, quiet);
  problem.pressing = PressingFriction::none;
  const Result frictionless = solve(problem, quiet);
  EXPECT_LT(rubbed.finest.indentation_m, frictionless.finest.indentation_m);
  EXPECT_LT(rubbed.finest.a_m, frictionless.finest.a_m);
  EXPECT_GT(rubbed.finest.stick_share, 0);
  EXPECT_LT(rubbed.finest.stick_share, 1);
}

Problem problem_of(const StuckAtFiniteStrain& row) {
  Problem problem;
  problem.contact.layer = {thickness_m, youngs_Pa, 0.49};
  const double sphere_m = 5 * thickness_m;
  problem.contact.radii = {sphere_m, sphere_m, 0};
  problem.sphere_radius_m = sphere_m;
  problem.contact.load = {
      row.load * problem.contact.layer.plane_strain_modulus_Pa() * thickness_m * thickness_m, 0.8};
  problem.finite_strain.emplace();
  problem.pressing = PressingFriction::stuck;
  return problem;
}

TEST(RubbedPressing, AtFiniteStrainAgreesWithAnIndependentSolution) {
  // Three digits of the reference.
  constexpr double of_reference = 1e-3;
  for (const StuckAtFiniteStrain& row : kStuckAtFiniteStrain) {
    SCOPED_TRACE("d/h " + std::to_string(row.indentation));
    const Problem problem = problem_of(row);
    const Result result = solve(problem, quiet);
    EXPECT_NEAR(result.finest.a_m / thickness_m / row.a, 1, result.error.a + of_reference);
    EXPECT_NEAR(result.finest.indentation_m / thickness_m / row.indentation, 1,
                result.error.indentation + of_reference);
    EXPECT_NEAR(result.finest.pressure_arm_m / thickness_m / row.arm, 1,
                result.error.indentation + of_reference);
    EXPECT_NEAR(result.finest.torque_arm_m / thickness_m / row.frictionless_arm, 1,
                result.error.max_torque + of_reference);
    EXPECT_LT(result.error.indentation, 5e-3) << "an error that excuses everything";
    EXPECT_GT(result.finest.stick_share, 0.99);
  }
}

TEST(RubbedPressing, OfSmallStrainIsThatOfLinearElasticity) {
  // A small contact on a blunt object: strain and slope are below a thousandth, and change d by as
  // much.
  constexpr double of_strain = 1e-3;
  Problem problem = problem_of(kRubbedReferences[1]);
  problem.contact.radii = {50 * radius_m, 50 * radius_m, 0};
  problem.contact.load.normal_force_N /= 50;
  problem.level = 1;
  const Result linear = solve(problem, quiet);
  problem.finite_strain.emplace();
  const Result finite = solve(problem, quiet);
  EXPECT_NEAR(finite.finest.indentation_m / linear.finest.indentation_m, 1,
              linear.error.indentation + of_strain);
  EXPECT_NEAR(finite.finest.pressure_arm_m / linear.finest.pressure_arm_m, 1,
              linear.error.indentation + of_strain);
  // Level 1 has eight nodes along the semi-axis: the ring of nodes between stick and slip, at 0.9
  // of it, is 2 x 0.9 / 8 = 0.22 of the area. Less than half of its nodes may stick in one and slip
  // in the other.
  constexpr double of_ring = 0.1;
  EXPECT_NEAR(finite.finest.stick_share, linear.finest.stick_share, of_ring);
}

TEST(RubbedPressing, AtFiniteStrainIsTheSameOnAWholeLayerAndByItsApproach) {
  Problem problem = problem_of(kStuckAtFiniteStrain[1]);
  problem.level = 1;
  problem.pressing = PressingFriction::coulomb;
  problem.contact.load.friction_coefficient = 0.3;
  problem.sphere_radius_m = std::numeric_limits<double>::infinity();
  const Result quarter = solve(problem, quiet);
  ASSERT_TRUE(quarter.planes.both());
  const double radius = problem.contact.radii.major_m;
  problem.fingertip.pad = meshes::paraboloid_pad(1e3 * radius, 1e3 * radius, 0.3);
  problem.fingertip.object = meshes::quadric_object(radius, radius, 0.3);
  problem.fingertip.symmetric_object = false;
  problem.approach_m = quarter.finest.indentation_m;
  const Result whole = solve(problem, quiet);
  ASSERT_FALSE(whole.planes.any());
  // The finger's own curvature is a thousandth of the object's, and so is its effect on the load.
  EXPECT_NEAR(whole.finest.load_N / quarter.finest.load_N, 1,
              whole.error.load + 2 * quarter.error.indentation + 1e-3);
  EXPECT_NEAR(whole.finest.pressure_arm_m / quarter.finest.pressure_arm_m, 1,
              whole.error.load + quarter.error.indentation);
}

TEST(RubbedPressing, ToAnApproachOfACurvedFingerIsThatToItsLoad) {
  // The side wall is near, and is told apart by contacts without friction.
  Problem problem;
  problem.contact.layer = {2e-3, 3e5, 0.49};
  problem.contact.radii = {0.02, 0.012, 0};
  problem.contact.load = {23, 0.8};
  problem.fingertip.pad = meshes::paraboloid_pad(0.02, 0.012, 0);
  problem.fingertip.object = meshes::quadric_object(std::numeric_limits<double>::infinity(),
                                                    std::numeric_limits<double>::infinity(), 0);
  problem.finite_strain.emplace();
  problem.pressing = PressingFriction::coulomb;
  problem.level = 1;
  const Result by_load = solve(problem, quiet);
  problem.approach_m = by_load.finest.indentation_m;
  const Result by_approach = solve(problem, quiet);
  EXPECT_NEAR(by_approach.finest.indentation_m / problem.approach_m, 1, 1e-12)
      << "a given approach is no result: round-off alone";
  // The load goes with the square of d, whose error the one has and the other does not.
  EXPECT_NEAR(by_approach.finest.load_N / 23, 1,
              by_approach.error.load + 2 * by_load.error.indentation);
}

TEST(RubbedPressing, IsRefusedWhereItIsNotKnown) {
  Problem problem = problem_of(kRubbedReferences[13]);
  EXPECT_NO_THROW(check_problem(problem));
  problem.shear_law = ShearLaw::Kind::limited;
  problem.shear_strength_Pa = 1e4;
  EXPECT_THROW(check_problem(problem), InputError);
}

}  // namespace
}  // namespace softfinger::fem
