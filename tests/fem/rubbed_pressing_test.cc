#include "fem/friction/rubbed_pressing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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
  // Both have one mesh: a secant's 1e-7 in the approach, and what pressure and friction settle to.
  constexpr double settled = 3e-5;
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

TEST(RubbedPressing, IsRefusedWhereItIsNotKnown) {
  Problem problem = problem_of(kRubbedReferences[13]);
  problem.finite_strain.emplace();
  EXPECT_THROW(check_problem(problem), InputError);
  problem.finite_strain.reset();
  problem.shear_law = ShearLaw::Kind::limited;
  problem.shear_strength_Pa = 1e4;
  EXPECT_THROW(check_problem(problem), InputError);
}

}  // namespace
}  // namespace softfinger::fem
