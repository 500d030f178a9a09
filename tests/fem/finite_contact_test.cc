// Pressing at finite strain against an independent axisymmetric solution and against what has to
// hold for any: balances, the limit of small loads, exact contact.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "fem/finite/deformed_contact.h"
#include "fem/finite/finite_pressing.h"
#include "fem/program/reference_solver.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "softfinger/input/errors.h"
#include "tests/fem/energy_balance.h"

namespace softfinger::fem {
namespace {

constexpr double kThickness_m = 2e-3, kModulus_Pa = 3e5, kFriction = 0.5;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

const Progress silent = [](const std::string&) {};

Problem problem_of(double major_m, double minor_m, double poisson_ratio, double load_N) {
  Problem problem;
  problem.contact.radii = {major_m, minor_m, 0};
  problem.contact.layer = {kThickness_m, kModulus_Pa, poisson_ratio};
  problem.contact.load = {load_N, kFriction};
  problem.finite_strain = MaterialChoice();
  return problem;
}

enum class Shape { sphere, paraboloid, curved };

/// Reference results of a bonded neo-Hookean layer with h/R = 0.2. They come from an axisymmetric
/// finite-element solution that has a mesh node at the contact's edge. It was checked by the
/// small-load limit, homogeneous states, a second element and the energy balance. Load and strain
/// energy in E* = E/(1 - nu²) and h, torque over mu P h; precision of the load 2e-4, of the others
/// 1e-4.
struct Axisymmetric {
  const char* name;
  Shape shape;
  VolumetricLaw law;
  double poisson_ratio, approach, load, a, torque, projected, area, energy, peak;
};

const Axisymmetric axisymmetric[] = {
    {"sphere_quadratic_0_30", Shape::sphere, VolumetricLaw::quadratic, 0.3, 0.199999979973,
     0.842718591367, 1.25693001115, 0.73138585399, 0.720060168224, 5.04431178425, 0.0565766015955,
     0.2852761800509473},
    {"sphere_quadratic_0_49", Shape::sphere, VolumetricLaw::quadratic, 0.49, 0.399999999428,
     6.23922758292, 2.05143939025, 1.18119403646, 1.13355480243, 13.8299098006, 0.752983140601,
     0.8987165930765569},
    {"sphere_logarithmic_0_30", Shape::sphere, VolumetricLaw::logarithmic, 0.3, 0.199999978737,
     0.840715451753, 1.26211906588, 0.736712568771, 0.725169917812, 5.08674547067, 0.0564072848373,
     0.27862594376061384},
    {"paraboloid_quadratic_0_49", Shape::paraboloid, VolumetricLaw::quadratic, 0.49, 0.19999997128,
     1.28805900984, 1.4015290943, 0.811484421577, 0.796678477938, 6.29065279986, 0.0810208070703,
     0.3611212016975745},
    {"curved_quadratic_0_49", Shape::curved, VolumetricLaw::quadratic, 0.49, 0.199999958103,
     1.08092453353, 1.36160082317, 0.778485672805, 0.778485672805, 5.82437706816, 0.0692504516448,
     0.3152485943604372},
};

class AxisymmetricReference : public testing::TestWithParam<Axisymmetric> {};

TEST_P(AxisymmetricReference, IsMetWithinTheStatedErrors) {
  const Axisymmetric& reference = GetParam();
  const double h = kThickness_m, R = h / 0.2, nu = reference.poisson_ratio;
  const double modulus = kModulus_Pa / (1 - nu * nu), load_N = reference.load * modulus * h * h;
  Problem problem = problem_of(R, R, nu, load_N);
  problem.finite_strain->volumetric = reference.law;
  if (reference.shape == Shape::sphere) problem.sphere_radius_m = R;
  if (reference.shape == Shape::curved) {
    problem.fingertip.pad = meshes::sphere_pad(R);
    problem.fingertip.object = meshes::plane_object();
    problem.fingertip.symmetric_object = true;
    problem.fingertip.pad_name = "sphere";
  }
  const Result result = solve(problem, silent);
  const LevelResult& finest = result.finest;
  // Twice the error stated at 95 %, and the reference's own.
  constexpr double own = 2e-4, largest = 5e-3;
  const auto expect = [&](const char* what, double value, double truth, double stated) {
    EXPECT_NEAR(value / truth, 1, 2 * stated + own) << what;
    EXPECT_LE(std::abs(value / truth - 1), largest) << what;
  };
  const double torque = kFriction * load_N * h;
  expect("d", finest.indentation_m, reference.approach * h, result.error.indentation);
  expect("a", finest.a_m, reference.a * h, result.error.a);
  expect("b", finest.b_m, reference.a * h, result.error.b);
  expect("torque", finest.max_torque_Nm, reference.torque * torque, result.error.max_torque);
  expect("projected torque", finest.max_torque_projected_Nm, reference.projected * torque,
         result.error.max_torque);
  expect("area", finest.area_m2, reference.area * h * h, result.error.area);
  // At a given load the energy has the approach's error to the same order.
  expect("energy", finest.strain_energy_J, reference.energy * modulus * h * h * h,
         2 * result.error.indentation);
  expect("peak", finest.peak_pressure_Pa, reference.peak * modulus, result.error.peak_pressure);
  EXPECT_LT(std::max({result.error.indentation, result.error.max_torque}), 5e-3);
  EXPECT_LT(finest.complementarity_residual, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(FiniteStrain, AxisymmetricReference, testing::ValuesIn(axisymmetric),
                         [](const auto& test) { return std::string(test.param.name); });

/// One layer for several loads, with cells of a quarter of the contact.
finite::FinitePressing layer_under(std::shared_ptr<const RigidObject> object, double a, double b,
                                   const MaterialChoice& choice, double poisson_ratio) {
  LayerDiscretisation mesh;
  mesh.a = a;
  mesh.b = b;
  mesh.elements_per_semi_axis = 4;
  mesh.patch = 1.6;
  return {std::make_shared<finite::FiniteLayer>(mesh, nullptr, both_planes,
                                                finite::make_material(choice, 1.0, poisson_ratio)),
          std::move(object)};
}

TEST(FinitePressing, WorkOfTheIndenterIsTheStrainEnergy) {
  for (const double nu : {0.3, 0.4999}) {
    auto pressing = layer_under(quadric(6, 3), 1.5, 0.8, {}, nu);
    const auto [departure, kinks] = tests::energy_balance(pressing, 0.25);
    EXPECT_NEAR(departure, 0, kinks) << nu;
  }
}

TEST(FinitePressing, TouchingNodesLieOnTheObject) {
  auto pressing = layer_under(sphere(5), 1.2, 1.2, {}, 0.49);
  pressing.press({0, 0.25});
  const auto& equilibrium = pressing.equilibrium();
  int touching = 0;
  for (std::size_t i = 0; i < pressing.layer().nodes().size(); ++i) {
    const Eigen::Vector3d at = pressing.layer().position(i);
    const double clearance = (at - Eigen::Vector3d(0, 0, 5 - equilibrium.approach)).norm() - 5;
    // Newton's last step was 1e-6 of the approach; the next one is its square.
    if (equilibrium.force[static_cast<Eigen::Index>(i)] > 0) {
      EXPECT_NEAR(clearance, 0, 1e-9);
      ++touching;
    } else {
      EXPECT_GT(clearance, -1e-9);
    }
  }
  EXPECT_EQ(touching, equilibrium.active);
}

TEST(FinitePressing, PathDoesNotMatter) {
  auto at_once = layer_under(quadric(6, 4), 1.2, 0.9, {}, 0.49);
  at_once.press({0, 0.2});
  auto in_steps = layer_under(quadric(6, 4), 1.2, 0.9, {}, 0.49);
  for (const double approach : {0.05, 0.25, 0.1, 0.2}) in_steps.press({0, approach});
  EXPECT_NEAR(in_steps.equilibrium().load / at_once.equilibrium().load, 1, 1e-9);
  auto by_load = layer_under(quadric(6, 4), 1.2, 0.9, {}, 0.49);
  by_load.press({at_once.equilibrium().load, 0});
  EXPECT_NEAR(by_load.equilibrium().approach, 0.2, 1e-9);
}

TEST(FinitePressing, NeverPassesThroughTheLayer) {
  // Cells so wide that the object finds room between the nodes: it could go on for ever.
  auto pressing = layer_under(quadric(6, 4), 60, 60, {}, 0.49);
  EXPECT_THROW(pressing.press({1e9, 0}), ConvergenceError);
  EXPECT_GT(pressing.equilibrium().approach, 0);
  EXPECT_LT(pressing.equilibrium().approach, 1);
}

TEST(FinitePressing, ElementDoesNotLock) {
  // On one coarse mesh, from nu = 0.49 to 0.4999 the load at given approach grows by the layer's
  // own stiffening (12 % for a contact of this size); an element that locks would make it several
  // times as large.
  double load[2];
  for (const int i : {0, 1}) {
    auto pressing = layer_under(sphere(5), 1.4, 1.4, {}, i == 0 ? 0.49 : 0.4999);
    pressing.press({0, 0.2});
    load[i] = pressing.equilibrium().load;
  }
  EXPECT_GT(load[1] / load[0], 1);
  EXPECT_LT(load[1] / load[0], 1.2);
}

TEST(FinitePressing, MaterialsThatAgreeToSecondOrderAgreeForSmallLoads) {
  // The two neo-Hookean energies differ by the cube of the strain: the load, relatively, by its
  // first power or less, since the differences under the contact and at its edge are of opposite
  // sign.
  const MaterialChoice logarithmic{MaterialName::neo_hookean, VolumetricLaw::logarithmic, 0, 0, 0};
  const auto difference = [&](double approach) {
    constexpr double radius = 200;
    const double a = std::sqrt(2 * approach * radius);
    double load[2];
    for (const int i : {0, 1}) {
      auto pressing =
          layer_under(quadric(radius, radius), a, a, i == 0 ? MaterialChoice() : logarithmic, 0);
      pressing.press({0, approach});
      load[i] = pressing.equilibrium().load;
    }
    return std::abs(load[1] / load[0] - 1);
  };
  const double at_2 = difference(0.02), at_1 = difference(0.01);
  EXPECT_GT(at_2, 1e-4);  // they are not the same
  EXPECT_LT(at_2, 0.02);
  EXPECT_LT(at_1, 0.55 * at_2);
}

TEST(FiniteStrain, IsLinearElasticityForSmallLoads) {
  // R'/R'' = 2, slopes of 0.04; every quantity within 0.2 % at d/h = 1e-3.
  for (const double nu : {0.3, 0.49}) {
    Problem problem = problem_of(1.0, 0.5, nu, 0);
    problem.approach_m = 1e-3 * kThickness_m;
    const Result finite_strain = solve(problem, silent);
    problem.finite_strain.reset();
    const Result linear = solve(problem, silent);
    const LevelResult &one = finite_strain.finest, &other = linear.finest;
    EXPECT_NEAR(one.load_N / other.load_N, 1, 2e-3);
    EXPECT_NEAR(one.max_torque_Nm / other.max_torque_Nm, 1, 2e-3);
    EXPECT_NEAR(one.a_m / other.a_m, 1, 2e-3);
    EXPECT_NEAR(one.b_m / other.b_m, 1, 2e-3);
    EXPECT_NEAR(one.peak_pressure_Pa / other.peak_pressure_Pa, 1, 2e-3);
  }
}

TEST(FiniteStrain, DepartsFromLinearElasticityInProportionToTheLoad) {
  // At given approach the loads differ by the strain, to its first power.
  const auto difference = [&](double approach) {
    Problem problem = problem_of(20 * kThickness_m, 20 * kThickness_m, 0.3, 0);
    problem.approach_m = approach * kThickness_m;
    problem.level = 1;
    const double load_N = solve(problem, silent).finest.load_N;
    problem.finite_strain.reset();
    return std::abs(load_N / solve(problem, silent).finest.load_N - 1);
  };
  const double at_2 = difference(0.04), at_1 = difference(0.02);
  EXPECT_NEAR(at_2 / at_1, 2, 0.3);
}

std::string refusal(const Problem& problem) {
  try {
    solve(problem, silent);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FiniteStrain, WhatItDoesNotHaveIsRefused) {
  Problem problem = problem_of(0.02, 0.02, 0.45, 1);
  problem.finite_strain->name = MaterialName::yeoh;
  problem.finite_strain->yeoh_second = -1;
  EXPECT_NE(refusal(problem).find("stable material"), std::string::npos);
}

TEST(FiniteStrain, ApproachOfTheWholeThicknessIsRefused) {
  Problem problem = problem_of(0.02, 0.02, 0.45, 0);
  problem.approach_m = kThickness_m;
  EXPECT_NE(refusal(problem).find("pressed through"), std::string::npos);
}

TEST(FiniteStrain, ObjectThatTheFingerSlidesOffIsSaidToBeOne) {
  Problem problem = problem_of(1e-3, 1e-3, 0.3, 0);
  problem.sphere_radius_m = 1e-3;
  problem.approach_m = 1.4e-3;
  problem.level = 1;
  try {
    solve(problem, silent);
    FAIL() << "a sphere was pressed in to 1.4 times its radius";
  } catch (const ConvergenceError& error) {
    EXPECT_NE(std::string(error.what()).find("slides off"), std::string::npos) << error.what();
  }
}

TEST(FiniteStrain, LoadThatTheLayerCannotCarryEndsWithTheLastOneThatConverged) {
  Problem problem = problem_of(0.004, 0.004, 0.3, 60);
  problem.level = 1;
  try {
    solve(problem, silent);
    FAIL() << "a sphere of twice the thickness carried 60 N";
  } catch (const ConvergenceError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("the last load that is converged"), std::string::npos) << message;
    EXPECT_NE(message.find("iteration"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace softfinger::fem
