// Rigid bodies and trees against closed forms, finite differences of poses and Lagrange's
// equations.
#include "softfinger/dynamics/bodies/multibody.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <random>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
constexpr double kRoundOff = 1e3 * kEpsilon;

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  double uniform(double least, double most) {
    return least + (most - least) * std::generate_canonical<double, 53>(random_);
  }
  Vector3d vector(double size) {
    return size * Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
  }
  Isometry3d pose() {
    Isometry3d result = Isometry3d::Identity();
    result.translation() = vector(0.3);
    result.linear() = Eigen::AngleAxisd(uniform(0, kPi), vector(1).normalized()).toRotationMatrix();
    return result;
  }
  /// A box of any density, its centre beside the frame's origin, turned against it.
  BodyDescription body(const std::string& name) {
    BodyDescription result;
    result.name = name;
    result.pose = pose();
    result.mass =
        with_mass(unit_mass_of_box({uniform(0.02, 0.2), uniform(0.02, 0.2), uniform(0.02, 0.2)}),
                  uniform(0.1, 2));
    const Matrix3d turn = pose().linear();
    result.mass.inertia_kg_m2 = turn * result.mass.inertia_kg_m2 * turn.transpose();
    result.mass.center_m = vector(0.05);
    return result;
  }
  JointDescription joint(int parent, int child, JointKind kind) {
    JointDescription result;
    result.name = "joint " + std::to_string(child);
    result.parent = parent;
    result.child = child;
    result.kind = kind;
    result.anchor_m = vector(0.3);
    result.axis = vector(2);
    result.start = uniform(-1, 1);
    return result;
  }

 private:
  std::mt19937_64 random_;
};

/// A tree of eight bodies: revolute, prismatic and fixed joints, branches, a fixed pair of joints
/// in a row. Its root hangs on the world, or is free.
Multibody random_tree(unsigned seed, bool floating) {
  Random random(seed);
  std::vector<BodyDescription> bodies;
  for (int b = 0; b < 8; ++b) bodies.push_back(random.body("body " + std::to_string(b)));
  bodies[3].velocity_m_per_s = random.vector(1);
  bodies[3].angular_velocity_rad_per_s = random.vector(3);
  std::vector<JointDescription> joints;
  // Not in order, so that parents come behind children.
  joints.push_back(random.joint(5, 0, JointKind::revolute));
  joints.push_back(random.joint(3, 5, JointKind::prismatic));
  joints.push_back(random.joint(0, 1, JointKind::fixed));
  joints.push_back(random.joint(1, 2, JointKind::fixed));
  joints.push_back(random.joint(2, 4, JointKind::revolute));
  joints.push_back(random.joint(3, 6, JointKind::fixed));
  joints.push_back(random.joint(6, 7, JointKind::prismatic));
  if (!floating) joints.push_back(random.joint(-1, 3, JointKind::revolute));
  Multibody bodies_and_joints(bodies, joints);
  VectorXd velocity = bodies_and_joints.velocity();
  for (int i = floating ? 6 : 0; i < velocity.size(); ++i) velocity[i] = random.uniform(-2, 2);
  bodies_and_joints.set_velocity(velocity);
  return bodies_and_joints;
}

Multibody moved(Multibody bodies, const VectorXd& velocity, double time_s) {
  bodies.set_velocity(velocity);
  bodies.integrate(time_s);
  return bodies;
}

/// sum m J^T J + J_w^T I J_w, the Jacobians by central differences of poses: errors h², and
/// epsilon/h.
MatrixXd mass_matrix_by_differences(const Multibody& bodies, double h) {
  const int n = bodies.velocities();
  std::vector<Multibody> ahead, behind;
  for (int i = 0; i < n; ++i) {
    ahead.push_back(moved(bodies, VectorXd::Unit(n, i), h));
    behind.push_back(moved(bodies, VectorXd::Unit(n, i), -h));
  }
  MatrixXd result = MatrixXd::Zero(n, n);
  for (int b = 0; b < bodies.bodies(); ++b) {
    if (!bodies.moves(b)) continue;
    MatrixXd linear(3, n), angular(3, n);
    for (int i = 0; i < n; ++i) {
      linear.col(i) = (ahead[i].center_of_mass_m(b) - behind[i].center_of_mass_m(b)) / (2 * h);
      const Matrix3d spin = (ahead[i].pose(b).linear() - behind[i].pose(b).linear()) / (2 * h) *
                            bodies.pose(b).linear().transpose();
      angular.col(i) =
          Vector3d(spin(2, 1) - spin(1, 2), spin(0, 2) - spin(2, 0), spin(1, 0) - spin(0, 1)) / 2;
    }
    const Matrix3d turn = bodies.pose(b).linear();
    const MassProperties& mass = bodies.body(b).mass;
    result += mass.mass_kg * linear.transpose() * linear +
              angular.transpose() * turn * mass.inertia_kg_m2 * turn.transpose() * angular;
  }
  return result;
}

MatrixXd mass_matrix(const Multibody& bodies) {
  MatrixXd matrix = MatrixXd::Zero(bodies.velocities(), bodies.velocities());
  for (const Multibody::Tree& tree : bodies.trees())
    bodies.mass_matrix(tree, matrix.block(tree.first, tree.first, tree.count, tree.count));
  return matrix;
}

VectorXd passive_forces(const Multibody& bodies, const Vector3d& gravity) {
  VectorXd forces = VectorXd::Zero(bodies.velocities());
  for (const Multibody::Tree& tree : bodies.trees())
    bodies.passive_forces(tree, gravity, forces.segment(tree.first, tree.count));
  return forces;
}

std::vector<BodyDescription> double_pendulum_bodies() {
  std::vector<BodyDescription> bodies(2);
  for (int b = 0; b < 2; ++b) {
    bodies[b].name = b == 0 ? "upper" : "lower";
    bodies[b].mass = with_mass(unit_mass_of_box({0.02, 0.03, 0.3}), b == 0 ? 0.4 : 0.7);
    bodies[b].pose.translation() = Vector3d(0, 0, -0.15 - 0.3 * b);
  }
  return bodies;
}

Multibody double_pendulum(double upper_rad, double lower_rad, double upper_speed,
                          double lower_speed) {
  std::vector<JointDescription> joints(2);
  for (int j = 0; j < 2; ++j) {
    joints[j].name = j == 0 ? "shoulder" : "elbow";
    joints[j].parent = j - 1;
    joints[j].child = j;
    joints[j].kind = JointKind::revolute;
    joints[j].axis = Vector3d::UnitY();
    joints[j].anchor_m = Vector3d(0, 0, -0.3 * j);
  }
  Multibody bodies(double_pendulum_bodies(), joints);
  bodies = moved(bodies, Eigen::Vector2d(upper_rad, lower_rad), 1);
  bodies.set_velocity(Eigen::Vector2d(upper_speed, lower_speed));
  return bodies;
}

/// Steps of the stepping scheme without contacts: M(q) (v' - v) = dt forces, q' = q + dt v'.
void step(Multibody& bodies, const Vector3d& gravity, double dt) {
  const VectorXd change =
      mass_matrix(bodies).llt().solve(dt * passive_forces(bodies, gravity)).eval();
  bodies.set_velocity(bodies.velocity() + change);
  bodies.integrate(dt);
}

TEST(Multibody, BodiesStartWhereTheyAreSaidToBe) {
  const Multibody bodies = random_tree(1, true);
  for (int b = 0; b < bodies.bodies(); ++b)
    EXPECT_LE((bodies.pose(b).matrix() - bodies.body(b).pose.matrix()).norm(), kRoundOff);
  EXPECT_EQ(bodies.velocities(), 6 + 4);
  EXPECT_EQ(bodies.trees().size(), 1u);
  EXPECT_LE(
      (bodies.velocity_at(3, bodies.center_of_mass_m(3)) - bodies.body(3).velocity_m_per_s).norm(),
      kRoundOff);
  EXPECT_LE((bodies.angular_velocity(6) - bodies.body(3).angular_velocity_rad_per_s).norm(),
            kRoundOff)
      << "fixed to body 3";
  for (int j = 0; j < bodies.joints(); ++j)
    EXPECT_EQ(bodies.joint_position(j), bodies.joint(j).start);
}

TEST(Multibody, FallsFreely) {
  BodyDescription body;
  body.name = "stone";
  body.mass = with_mass(unit_mass_of_box({0.1, 0.2, 0.3}), 2);
  body.mass.center_m = Vector3d(0.02, -0.01, 0.03);
  body.velocity_m_per_s = Vector3d(1, 2, 3);
  Multibody bodies({body}, {});
  const Vector3d gravity(0, 0, -9.81), start = bodies.center_of_mass_m(0);
  const double dt = 1e-3;
  const int steps = 1000;
  for (int i = 0; i < steps; ++i) step(bodies, gravity, dt);
  const double t = steps * dt;
  // q' = q + dt v' sums g dt² n (n+1)/2.
  const Vector3d expected = start + t * body.velocity_m_per_s + gravity * t * (t + dt) / 2;
  EXPECT_LE((bodies.center_of_mass_m(0) - expected).norm(), steps * kEpsilon * expected.norm());
  EXPECT_LE(
      (bodies.velocity_at(0, bodies.center_of_mass_m(0)) - body.velocity_m_per_s - t * gravity)
          .norm(),
      steps * kEpsilon * 10);
  EXPECT_LE((bodies.pose(0).linear() - Matrix3d::Identity()).norm(), kRoundOff);
}

TEST(Multibody, SpinsAboutAPrincipalAxisAtItsRate) {
  BodyDescription body;
  body.name = "disc";
  body.mass = with_mass(unit_mass_of_cylinder(0.1, 0.02), 3);
  body.angular_velocity_rad_per_s = Vector3d(0, 0, 40);
  Multibody bodies({body}, {});
  const int steps = 1000;
  for (int i = 0; i < steps; ++i) step(bodies, Vector3d::Zero(), 1e-3);
  const Matrix3d expected = Eigen::AngleAxisd(40., Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_LE((bodies.pose(0).linear() - expected).norm(), steps * 16 * kEpsilon);
}

TEST(Multibody, AFreeTopKeepsMomentumAndEnergy) {
  // About its middle axis, which is unstable: it tumbles.
  BodyDescription body;
  body.name = "top";
  body.mass = with_mass(unit_mass_of_box({0.1, 0.2, 0.3}), 2);
  body.mass.center_m = Vector3d(0.01, 0, -0.02);
  body.velocity_m_per_s = Vector3d(0.3, -0.2, 0.1);
  body.angular_velocity_rad_per_s = Vector3d(0.1, 20, 0.2);
  Multibody bodies({body}, {});
  const Vector3d linear = bodies.linear_momentum_N_s(), angular = bodies.angular_momentum_N_m_s();
  const double energy = bodies.kinetic_energy_J();
  const int steps = 10000;
  double turned = 1;
  for (int i = 0; i < steps; ++i) {
    step(bodies, Vector3d::Zero(), 1e-3);
    turned = std::min(turned, bodies.pose(0).linear()(1, 1));
  }
  EXPECT_LT(turned, -0.5) << "it did not tumble: the test is too easy";
  const double round_off = steps * 16 * kEpsilon;
  EXPECT_LE((bodies.linear_momentum_N_s() - linear).norm(), round_off * linear.norm());
  EXPECT_LE((bodies.angular_momentum_N_m_s() - angular).norm(), round_off * angular.norm() * 10);
  EXPECT_NEAR(bodies.kinetic_energy_J() / energy, 1, round_off);
  EXPECT_LE(
      (bodies.pose(0).linear().transpose() * bodies.pose(0).linear() - Matrix3d::Identity()).norm(),
      kRoundOff);
}

TEST(Multibody, ASymmetricTopPrecessesAtEulersRate) {
  // Free symmetric top: the axis turns about L at |L| / I_across. Second order in the step.
  BodyDescription body;
  body.name = "top";
  body.mass = with_mass(unit_mass_of_cylinder(0.1, 0.05), 1);
  body.angular_velocity_rad_per_s = Vector3d(3, 0, 10);
  const double across = body.mass.inertia_kg_m2(0, 0), along = body.mass.inertia_kg_m2(2, 2);
  const Vector3d momentum(across * 3, 0, along * 10);
  double last = 0;
  for (const int steps : {250, 500, 1000}) {
    Multibody bodies({body}, {});
    for (int i = 0; i < steps; ++i) step(bodies, Vector3d::Zero(), 1. / steps);
    const Vector3d exact =
        Eigen::AngleAxisd(momentum.norm() / across, momentum.normalized()) * Vector3d::UnitZ();
    const double error = (bodies.pose(0).linear().col(2) - exact).norm();
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.1);
    }
    last = error;
  }
}

TEST(Multibody, MassMatrixIsTheSumOverBodies) {
  const double h = 1e-5;
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const bool floating : {false, true}) {
      const Multibody bodies = random_tree(seed, floating);
      const MatrixXd matrix = mass_matrix(bodies);
      EXPECT_LE((matrix - mass_matrix_by_differences(bodies, h)).norm(), h * h * 10 * matrix.norm())
          << "seed " << seed;
      EXPECT_EQ((matrix - matrix.transpose()).norm(), 0);
      EXPECT_NEAR(bodies.velocity().dot(matrix * bodies.velocity()) / 2 / bodies.kinetic_energy_J(),
                  1, kRoundOff);
    }
  const Multibody pendulum = double_pendulum(0.4, -1.1, 0, 0);
  EXPECT_LE((mass_matrix(pendulum) - mass_matrix_by_differences(pendulum, h)).norm(), h * h);
}

TEST(Multibody, MassMatrixIsAskedForWithACopyOfTheTree) {
  const Multibody bodies = random_tree(1, true);
  const Multibody::Tree copy = bodies.trees()[0];
  MatrixXd one(copy.count, copy.count), other = one;
  bodies.mass_matrix(copy, one);
  bodies.mass_matrix(bodies.trees()[0], other);
  EXPECT_EQ((one - other).norm(), 0);
  VectorXd forces(copy.count), same = forces;
  bodies.passive_forces(copy, Vector3d(0, 0, -9.81), forces);
  bodies.passive_forces(bodies.trees()[0], Vector3d(0, 0, -9.81), same);
  EXPECT_EQ((forces - same).norm(), 0);
}

TEST(Multibody, ADoublePendulumHasTheTextbooksMassMatrixAndForces) {
  // Angle of the lower rod against the upper one. Landau and Lifshitz, Mechanics, section 5, with
  // rods instead of points: T = 1/2 v^T M v of absolute angles, transformed to relative ones.
  const double m1 = 0.4, m2 = 0.7, l = 0.3, g = 9.81, i = (0.02 * 0.02 + 0.3 * 0.3) / 12;
  const double q1 = 0.4, q2 = -1.1, v1 = 1.7, v2 = -0.6;
  const Multibody bodies = double_pendulum(q1, q2, v1, v2);
  const double coupling = m2 * l * l / 2;
  Eigen::Matrix2d absolute, relative;
  absolute << m1 * (i + l * l / 4) + m2 * l * l, coupling * std::cos(q2), coupling * std::cos(q2),
      m2 * (i + l * l / 4);
  relative << 1, 0, 1, 1;
  EXPECT_LE((mass_matrix(bodies) - relative.transpose() * absolute * relative).norm(), kRoundOff);
  // Absolute angles a1 = q1, a2 = q1 + q2: forces -coupling sin(a1 - a2) (v2², -v1²) - dV/da.
  const double w1 = v1, w2 = v1 + v2, a1 = q1, a2 = q1 + q2;
  const Eigen::Vector2d force(
      -coupling * std::sin(a1 - a2) * w2 * w2 - (m1 / 2 + m2) * g * l * std::sin(a1),
      coupling * std::sin(a1 - a2) * w1 * w1 - m2 / 2 * g * l * std::sin(a2));
  EXPECT_LE((passive_forces(bodies, Vector3d(0, 0, -g)) - relative.transpose() * force).norm(),
            kRoundOff);
}

TEST(Multibody, ForcesOfTreesAreLagranges) {
  // Joint positions are coordinates: forces_i = -sum (dM_ij/dq_k - dM_jk/dq_i / 2) v_j v_k -
  // dV/dq_i.
  const double h = 1e-5;
  const Vector3d gravity(1, -2, -9);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Multibody bodies = random_tree(seed, false);
    const int n = bodies.velocities();
    ASSERT_EQ(n, 5);
    const VectorXd v = bodies.velocity();
    std::vector<MatrixXd> slopes;
    VectorXd expected(n);
    for (int k = 0; k < n; ++k) {
      const Multibody ahead = moved(bodies, VectorXd::Unit(n, k), h);
      const Multibody behind = moved(bodies, VectorXd::Unit(n, k), -h);
      slopes.push_back((mass_matrix(ahead) - mass_matrix(behind)) / (2 * h));
      expected[k] =
          -(ahead.potential_energy_J(gravity) - behind.potential_energy_J(gravity)) / (2 * h);
    }
    for (int k = 0; k < n; ++k) {
      expected -= v[k] * slopes[k] * v;
      expected[k] += v.dot(slopes[k] * v) / 2;
    }
    EXPECT_LE((passive_forces(bodies, gravity) - expected).norm(), 1e2 * h * h * expected.norm())
        << "seed " << seed;
  }
}

TEST(Multibody, AFloatingTreeKeepsMomentumAndEnergyInTheLimitOfSmallSteps) {
  // Derivatives along the motion by central differences.
  const double h = 1e-5;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Multibody bodies = random_tree(seed, true);
    const VectorXd acceleration =
        mass_matrix(bodies).llt().solve(passive_forces(bodies, Vector3d::Zero()));
    std::array<Multibody, 2> at = {bodies, bodies};
    for (int side = 0; side < 2; ++side) {
      const double t = side == 0 ? -h : h;
      at[side] = moved(bodies, bodies.velocity(), t);
      at[side].set_velocity(bodies.velocity() + t * acceleration);
    }
    const double p = bodies.linear_momentum_N_s().norm(),
                 l = bodies.angular_momentum_N_m_s().norm();
    EXPECT_LE((at[1].linear_momentum_N_s() - at[0].linear_momentum_N_s()).norm() / (2 * h),
              1e3 * h * h * p + kRoundOff / h);
    EXPECT_LE((at[1].angular_momentum_N_m_s() - at[0].angular_momentum_N_m_s()).norm() / (2 * h),
              1e3 * h * h * l + kRoundOff / h);
    EXPECT_LE(std::abs(at[1].kinetic_energy_J() - at[0].kinetic_energy_J()) / (2 * h),
              1e3 * h * h * bodies.kinetic_energy_J() + kRoundOff / h);
  }
}

TEST(Multibody, MomentumOfAFloatingTreeDriftsInFirstOrder) {
  double last = 0;
  for (const int steps : {200, 400, 800}) {
    Multibody bodies = random_tree(2, true);
    const Vector3d linear = bodies.linear_momentum_N_s(), angular = bodies.angular_momentum_N_m_s();
    for (int i = 0; i < steps; ++i) step(bodies, Vector3d::Zero(), 0.2 / steps);
    const double drift = (bodies.linear_momentum_N_s() - linear).norm() +
                         (bodies.angular_momentum_N_m_s() - angular).norm();
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / drift), 1, 0.15);
    }
    last = drift;
  }
}

TEST(Multibody, EnergyOfADoublePendulumDriftsInFirstOrder) {
  const Vector3d gravity(0, 0, -9.81);
  double last = 0;
  for (const int steps : {1000, 2000, 4000}) {
    Multibody bodies = double_pendulum(1.2, -0.5, 0, 0);
    const double start = bodies.potential_energy_J(gravity);
    for (int i = 0; i < steps; ++i) step(bodies, gravity, 1. / steps);
    const double drift =
        std::abs(bodies.kinetic_energy_J() + bodies.potential_energy_J(gravity) - start);
    std::printf("double pendulum, %d steps of %g ms: energy drifts by %.2e J of %.2e J kinetic\n",
                steps, 1e3 / steps, drift, bodies.kinetic_energy_J());
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / drift), 1, 0.15);
    }
    last = drift;
  }
}

TEST(Multibody, ASliderOnATurningRodFeelsTheCentrifugalAndTheCoriolisForce) {
  // Radius r(t) of a bead on a rod that turns about z: r'' = r w², and m r² + I keeps momentum.
  std::vector<BodyDescription> bodies(2);
  bodies[0].name = "rod";
  bodies[0].mass = with_mass(unit_mass_of_box({1, 0.01, 0.01}), 0.5);
  bodies[1].name = "bead";
  bodies[1].mass = with_mass(unit_mass_of_box({0.02, 0.02, 0.02}), 0.3);
  bodies[1].pose.translation() = Vector3d(0.2, 0, 0);
  std::vector<JointDescription> joints(2);
  joints[0] = {"turn", -1, 0, JointKind::revolute};
  joints[1] = {"slide", 0, 1, JointKind::prismatic};
  joints[1].axis = Vector3d(5, 0, 0);
  joints[1].start = 0.2;
  Multibody both(bodies, joints);
  both.set_velocity(Eigen::Vector2d(3, 0.7));
  const double r = 0.2, w = 3, v = 0.7, m = 0.3;
  const double inertia = bodies[0].mass.inertia_kg_m2(2, 2) + bodies[1].mass.inertia_kg_m2(2, 2);
  const MatrixXd matrix = mass_matrix(both);
  EXPECT_LE((matrix - Eigen::Matrix2d(Eigen::Vector2d(inertia + m * r * r, m).asDiagonal())).norm(),
            kRoundOff);
  EXPECT_LE(
      (passive_forces(both, Vector3d::Zero()) - Eigen::Vector2d(-2 * m * r * w * v, m * r * w * w))
          .norm(),
      kRoundOff);
}

TEST(Multibody, BodiesOnFixedJointsMoveAsOne) {
  // Two halves of a box, glued, against the whole.
  std::vector<BodyDescription> halves(2);
  for (int b = 0; b < 2; ++b) {
    halves[b].name = b == 0 ? "left" : "right";
    halves[b].mass = with_mass(unit_mass_of_box({0.1, 0.2, 0.3}), 1);
    halves[b].pose.translation() = Vector3d(b == 0 ? -0.05 : 0.05, 0, 0);
  }
  BodyDescription whole = halves[0];
  whole.name = "whole";
  whole.mass = with_mass(unit_mass_of_box({0.2, 0.2, 0.3}), 2);
  whole.pose = Isometry3d::Identity();
  JointDescription glue;
  glue.name = "glue";
  glue.parent = 0;
  glue.child = 1;
  Multibody glued(halves, {glue}), one({whole}, {});
  const Vector3d velocity(1, 2, 3), spin(4, -5, 6);
  VectorXd of_whole(6), of_left(6);
  of_whole << velocity, spin;
  of_left << velocity + spin.cross(Vector3d(-0.05, 0, 0)), spin;
  glued.set_velocity(of_left);
  one.set_velocity(of_whole);
  EXPECT_NEAR(glued.kinetic_energy_J() / one.kinetic_energy_J(), 1, kRoundOff);
  EXPECT_LE((glued.angular_momentum_N_m_s() - one.angular_momentum_N_m_s()).norm(),
            kRoundOff * one.angular_momentum_N_m_s().norm());
  EXPECT_TRUE(glued.are_joined(0, 1));
  const Vector3d point(0.3, 0.1, 0.2);
  EXPECT_LE((glued.velocity_at(1, point) - one.velocity_at(0, point)).norm(), kRoundOff * 10);
  // Accelerations: of the whole, without forces, I dw/dt = I w x w, and none of the centre.
  const VectorXd change = mass_matrix(glued).llt().solve(passive_forces(glued, Vector3d::Zero()));
  const Matrix3d inertia = whole.mass.inertia_kg_m2;
  const Vector3d turning = inertia.inverse() * (inertia * spin).cross(spin);
  EXPECT_LE((change.tail<3>() - turning).norm(), kRoundOff * turning.norm());
  const Vector3d arm(-0.05, 0, 0);
  const Vector3d expected = turning.cross(arm) + spin.cross(spin.cross(arm));
  EXPECT_LE((change.head<3>() - expected).norm(), kRoundOff * expected.norm());
}

TEST(Multibody, WhatHangsOnTheWorldByAFixedJointDoesNotMove) {
  Random random(4);
  std::vector<BodyDescription> bodies = {random.body("stand"), random.body("arm")};
  Multibody both(bodies,
                 {random.joint(-1, 0, JointKind::fixed), random.joint(0, 1, JointKind::revolute)});
  EXPECT_FALSE(both.moves(0));
  EXPECT_TRUE(both.moves(1));
  EXPECT_EQ(both.velocities(), 1);
  EXPECT_EQ(both.tree_of(0), -1);
  both.set_velocity(VectorXd::Constant(1, 1));
  EXPECT_EQ(both.velocity_at(0, Vector3d(1, 2, 3)).norm(), 0);
  both.integrate(0.5);
  EXPECT_EQ((both.pose(0).matrix() - bodies[0].pose.matrix()).norm(), 0);
}

TEST(Multibody, JointsMoveAboutTheirAnchorsAndAlongTheirAxes) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Random random(seed);
    const std::vector<BodyDescription> bodies = {random.body("parent"), random.body("child")};
    for (const JointKind kind : {JointKind::revolute, JointKind::prismatic}) {
      const JointDescription joint = random.joint(0, 1, kind);
      Multibody both(bodies, {joint});
      VectorXd velocity = VectorXd::Zero(7);
      velocity[6] = 0.7;
      const Multibody after = moved(both, velocity, 1);
      Isometry3d expected = Isometry3d::Identity();
      if (kind == JointKind::revolute)
        expected = Eigen::Translation3d(joint.anchor_m) *
                   Eigen::AngleAxisd(0.7, joint.axis.normalized()) *
                   Eigen::Translation3d(-joint.anchor_m);
      else
        expected.translation() = 0.7 * joint.axis.normalized();
      EXPECT_LE((after.pose(1).matrix() - (expected * bodies[1].pose).matrix()).norm(), kRoundOff);
      EXPECT_NEAR(after.joint_position(0), joint.start + 0.7, kRoundOff);
      EXPECT_LE((after.pose(0).matrix() - bodies[0].pose.matrix()).norm(), kRoundOff);
    }
  }
}

TEST(Multibody, ContactJacobianAndForcesAreDual) {
  const Multibody bodies = random_tree(3, true);
  const int n = bodies.velocities();
  Random random(8);
  for (int body = 0; body < bodies.bodies(); ++body) {
    const Vector3d point = random.vector(0.5), force = random.vector(2), torque = random.vector(1);
    const Matrix3d axes = random.pose().linear();
    MatrixXd rows = MatrixXd::Zero(4, n);
    bodies.add_contact_jacobian(body, point, axes, 1, rows);
    const Eigen::Vector4d velocity = rows * bodies.velocity();
    const Vector3d at_point = axes.transpose() * bodies.velocity_at(body, point);
    EXPECT_LE((velocity - Eigen::Vector4d(at_point[2], at_point[0], at_point[1],
                                          axes.col(2).dot(bodies.angular_velocity(body))))
                  .norm(),
              kRoundOff * 10);
    VectorXd generalised = VectorXd::Zero(n);
    bodies.add_force(body, point, force, torque, generalised);
    EXPECT_NEAR(
        generalised.dot(bodies.velocity()),
        force.dot(bodies.velocity_at(body, point)) + torque.dot(bodies.angular_velocity(body)),
        kRoundOff * 10);
  }
}

TEST(Multibody, MasslessLinksMakeABallJointOfThreeHinges) {
  Random random(6);
  BodyDescription body = random.body("body"), link;
  link.massless = true;
  link.mass.mass_kg = 0;
  JointDescription ball = random.joint(-1, 0, JointKind::ball);
  const Multibody one({body}, {ball});
  std::vector<BodyDescription> bodies(2, link);
  bodies[0].name = "first";
  bodies[1].name = "second";
  bodies.push_back(body);
  std::vector<JointDescription> hinges;
  for (int j = 0; j < 3; ++j) {
    hinges.push_back(random.joint(j - 1, j, JointKind::revolute));
    hinges.back().anchor_m = ball.anchor_m;
    hinges.back().axis = Vector3d::Unit(j);
  }
  const Multibody three(bodies, hinges);
  // At the start the hinges' axes are those of the ball.
  EXPECT_LE((mass_matrix(three) - mass_matrix(one)).norm(), kRoundOff);
  hinges[1].axis = hinges[0].axis;
  EXPECT_THROW(Multibody(bodies, hinges), InputError) << "two hinges on one axis move nothing";
  EXPECT_THROW(Multibody({bodies[0]}, {hinges[0]}), InputError);
  EXPECT_THROW(Multibody({bodies[0]}, {}), InputError);
}

TEST(Multibody, ARotorAddsItsInertiaToItsJointAlone) {
  Multibody plain = double_pendulum(0.4, -1.1, 1.7, -0.6);
  std::vector<JointDescription> joints = {plain.joint(0), plain.joint(1)};
  joints[1].rotor_inertia = 0.03;
  Multibody geared(double_pendulum_bodies(), joints);
  geared = moved(geared, Eigen::Vector2d(0.4, -1.1), 1);
  geared.set_velocity(plain.velocity());
  MatrixXd difference = mass_matrix(geared) - mass_matrix(plain);
  EXPECT_NEAR(difference(1, 1), 0.03, kRoundOff);
  difference(1, 1) = 0;
  EXPECT_LE(difference.norm(), kRoundOff);
  EXPECT_NEAR(geared.kinetic_energy_J() - plain.kinetic_energy_J(), 0.03 * 0.6 * 0.6 / 2,
              kRoundOff);
  Eigen::Vector2d momentum, rate, other, same_rate;
  geared.momentum(geared.trees()[0], Vector3d(0, 0, -9.81), momentum, rate);
  plain.momentum(plain.trees()[0], Vector3d(0, 0, -9.81), other, same_rate);
  EXPECT_LE((momentum - mass_matrix(geared) * geared.velocity()).norm(), kRoundOff);
  EXPECT_LE((rate - same_rate).norm(), kRoundOff);
}

TEST(Multibody, RefusesWhatIsNoTreeOfBodies) {
  Random random(5);
  std::vector<BodyDescription> bodies = {random.body("a"), random.body("b"), random.body("c")};
  const auto refused = [&](std::vector<JointDescription> joints, const std::string& name) {
    try {
      Multibody(bodies, std::move(joints));
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      return true;
    }
    return false;
  };
  const JointKind turn = JointKind::revolute;
  EXPECT_FALSE(refused({random.joint(0, 1, turn), random.joint(1, 2, turn)}, ""));
  EXPECT_TRUE(refused({random.joint(0, 1, turn), random.joint(1, 0, turn)}, "ring"));
  EXPECT_TRUE(refused(
      {random.joint(0, 1, turn), random.joint(1, 2, turn), random.joint(2, 0, turn)}, "ring"));
  EXPECT_TRUE(refused({random.joint(0, 2, turn), random.joint(1, 2, turn)}, "parent"));
  EXPECT_TRUE(refused({random.joint(0, 0, turn)}, "parent"));
  EXPECT_TRUE(refused({random.joint(0, 3, turn)}, "child"));
  EXPECT_TRUE(refused({random.joint(3, 0, turn)}, "parent"));
  EXPECT_TRUE(refused({random.joint(-2, 0, turn)}, "parent"));
  EXPECT_TRUE(refused({random.joint(0, -1, turn)}, "child"));
  JointDescription joint = random.joint(0, 1, turn);
  joint.axis.setZero();
  EXPECT_TRUE(refused({joint}, "axis"));
  joint = random.joint(0, 1, turn);
  joint.lower = joint.start + 0.1;
  EXPECT_TRUE(refused({joint}, "limits"));
  joint = random.joint(0, 1, turn);
  joint.upper = std::nan("");
  EXPECT_TRUE(refused({joint}, "limits"));
  bodies[1].fixed = true;
  EXPECT_TRUE(refused({random.joint(0, 1, turn)}, "fixed"));
  bodies[1].fixed = false;
  bodies[2].mass.mass_kg = 0;
  EXPECT_TRUE(refused({}, "\"c\""));
  bodies[2].fixed = true;
  EXPECT_FALSE(refused({}, "")) << "a fixed body needs no mass";
  bodies[2].pose.translation().x() = std::nan("");
  EXPECT_TRUE(refused({}, "\"c\""));
}

}  // namespace
}  // namespace softfinger
