// Layers on both bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "fem/problem/check_problem.h"
#include "fem/program/reference_solver.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::fem {
namespace {

const Progress quiet = [](const std::string&) {};

Problem two_layers(const ElasticLayer& finger, const ElasticLayer& object, double load_N,
                   RelativeRadii radii = {0.02, 0.02, 0}) {
  Problem problem;
  problem.contact.radii = radii;
  problem.contact.layer = finger;
  problem.contact.object_layer = object;
  problem.contact.load = {load_N, 0.8};
  problem.level = 1;
  return problem;
}

Problem swapped(Problem problem) {
  std::swap(problem.contact.layer, problem.contact.object_layer);
  return problem;
}

TEST(TwoLayers, AgreeWithTheSumOfTheirKernels) {
  const PressureModel& exact = *find_pressure_model("layer_fredholm");
  const struct {
    ElasticLayer finger, object;
    double load_N;
  } contacts[] = {
      {{2e-3, 5e5, 0.49}, {1e-3, 1e5, 0.4}, 2},    // the finger's is the stiffer one
      {{2e-3, 5e5, 0.3}, {30e-3, 5e5, 0.45}, 5},   // on a soft block that is thick
      {{5e-3, 3e5, 0.45}, {0.5e-3, 1e6, 0}, 1},    // a thin film on the object
      {{1e-3, 2e5, 0.499}, {1e-3, 2e5, 0.499}, 4}  // two that are alike
  };
  for (const auto& contact : contacts) {
    SCOPED_TRACE("nu " + std::to_string(contact.finger.poisson_ratio) + " and " +
                 std::to_string(contact.object.poisson_ratio));
    Problem problem = two_layers(contact.finger, contact.object, contact.load_N);
    problem.level = 2;
    const Prediction truth = exact.predict(problem.contact);
    ASSERT_TRUE(truth.has_answer);
    const Result found = solve(problem, quiet);
    EXPECT_NEAR(found.finest.a_m / truth.a_m, 1, found.error.a);
    EXPECT_NEAR(found.finest.indentation_m / truth.indentation_m, 1, found.error.indentation);
    EXPECT_NEAR(found.finest.peak_pressure_Pa / truth.peak_pressure_Pa, 1,
                found.error.peak_pressure);
    EXPECT_NEAR(found.finest.max_torque_Nm / (0.8 * contact.load_N * truth.torque_arm_exact_m), 1,
                found.error.max_torque);
    EXPECT_LT(found.error.a, 0.01) << "an error that excuses everything";
    EXPECT_LT(found.error.indentation, 0.005);
  }
}

TEST(TwoLayers, ThatAreAlikeAreOneOfHalfTheModulus) {
  const ElasticLayer layer{2e-3, 4e5, 0.47};
  const Result two = solve(two_layers(layer, layer, 3, {0.03, 0.01, 0.2}), quiet);
  ElasticLayer half = layer;
  half.youngs_modulus_Pa /= 2;
  const Result one = solve(two_layers(half, {}, 3, {0.03, 0.01, 0.2}), quiet);
  // Trial meshes begin from another guess, so that the last ones may differ a little.
  EXPECT_NEAR(two.finest.a_m / one.finest.a_m, 1, one.error.a);
  EXPECT_NEAR(two.finest.b_m / one.finest.b_m, 1, one.error.a);
  EXPECT_NEAR(two.finest.indentation_m / one.finest.indentation_m, 1, one.error.indentation);
}

TEST(TwoLayers, ThatAreAlikeDoNotRub) {
  const ElasticLayer layer{2e-3, 4e5, 0.45};
  Problem problem = two_layers(layer, layer, 3);
  const Result frictionless = solve(problem, quiet);
  problem.pressing = PressingFriction::stuck;
  const Result stuck = solve(problem, quiet);
  // Both surfaces are sheared alike, so that no friction acts; 1e-6 is left of two solvers.
  EXPECT_NEAR(stuck.finest.indentation_m / frictionless.finest.indentation_m, 1, 1e-6);
  EXPECT_NEAR(stuck.finest.peak_pressure_Pa / frictionless.finest.peak_pressure_Pa, 1, 1e-6);
}

TEST(TwoLayers, AreTheSameSeenFromEitherBody) {
  Problem problem = two_layers({2e-3, 5e5, 0.49}, {3e-3, 2e5, 0.2}, 2);
  problem.level = 2;
  problem.friction.torsion = true;
  problem.friction.increments = 4;
  for (const PressingFriction pressing : {PressingFriction::none, PressingFriction::coulomb}) {
    problem.pressing = pressing;
    const Result one = solve(problem, quiet), other = solve(swapped(problem), quiet);
    // The meshes are made for trial contacts that begin from different guesses: both errors count.
    const auto expect_same = [](double value, double error, double from_other, double its_error) {
      EXPECT_NEAR(value / from_other, 1, error + its_error);
    };
    expect_same(one.finest.indentation_m, one.error.indentation, other.finest.indentation_m,
                other.error.indentation);
    expect_same(one.finest.pressure_arm_m, one.error.max_torque, other.finest.pressure_arm_m,
                other.error.max_torque);
    expect_same(one.torsion->stiffness_Nm_per_rad, one.torsion->stiffness_error,
                other.torsion->stiffness_Nm_per_rad, other.torsion->stiffness_error);
  }
}

TEST(TwoLayers, OnAHardObjectAreTheFingersAlone) {
  const ElasticLayer finger{2e-3, 3e5, 0.3};
  Problem problem = two_layers(finger, {2e-3, 3e11, 0.3}, 3);
  problem.pressing = PressingFriction::coulomb;
  problem.friction.torsion = true;
  problem.friction.increments = 4;
  const Result two = solve(problem, quiet);
  problem.contact.object_layer = {};
  const Result one = solve(problem, quiet);
  // The object gives way by a millionth; the guess of the first mesh does not know it.
  EXPECT_NEAR(two.finest.indentation_m / one.finest.indentation_m, 1, 1e-5);
  EXPECT_NEAR(two.finest.pressure_arm_m / one.finest.pressure_arm_m, 1, 1e-5);
  EXPECT_NEAR(two.torsion->stiffness_Nm_per_rad / one.torsion->stiffness_Nm_per_rad, 1, 1e-5);
}

TEST(TwoLayers, RefuseWhatIsNotKnownOfThem) {
  const Problem problem = two_layers({2e-3, 3e5, 0.3}, {2e-3, 3e5, 0.3}, 3);
  EXPECT_NO_THROW(check_problem(problem));
  const auto refused = [&](const char* field, auto change) {
    Problem other = problem;
    change(other);
    try {
      check_problem(other);
      ADD_FAILURE() << field;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  };
  refused("kinematics", [](Problem& p) { p.finite_strain.emplace(); });
  refused("sphere_radius_m", [](Problem& p) { p.sphere_radius_m = 0.02; });
  refused("compliance_file", [](Problem& p) { p.compliance_file = "f"; });
  refused("object layer's thickness_m",
          [](Problem& p) { p.contact.object_layer.thickness_m = 0.3; });
  refused("object layer's poisson_ratio",
          [](Problem& p) { p.contact.object_layer.poisson_ratio = 0.6; });
}

}  // namespace
}  // namespace softfinger::fem
