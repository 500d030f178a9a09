#include "softfinger/dynamics/step/presliding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace softfinger {
namespace {

constexpr StuckStiffness kStuck{0.03, 3600, 3000};
constexpr double kForce_N = 4, kTorque_Nm = 8e-3;

PreslidingElements pressed(const ShiftCurve& shift, const TwistCurve& twist) {
  PreslidingElements elements(shift, twist);
  elements.set_limits(kStuck, kForce_N, kTorque_Nm);
  return elements;
}

/// Shift and twist as large as their units: k u/(mu P), k theta/T_max.
Eigen::Vector3d displacement(double x, double y, double twist) {
  return {x * kForce_N / kStuck.tangential_x_N_per_m, y * kForce_N / kStuck.tangential_y_N_per_m,
          twist * kTorque_Nm / kStuck.torsional_Nm_per_rad};
}

TEST(PreslidingElements, FollowTheirCurvesToAndFro) {
  const ShiftCurve shift(0.38);
  const TwistCurve twist(0.6, 0.7);
  PreslidingElements shifted = pressed(shift, twist), twisted = shifted;
  MasingPath<ShiftCurve> force{shift};
  MasingPath<TwistCurve> torque{twist};
  double x = 0;
  for (const double end : {0.7, -0.3, 0.4, -0.2, 1.1, -1.4, 3.}) {
    for (int i = 0; i < 50; ++i) {
      const double step = (end - force.x()) / (50 - i);
      x += step;
      shifted.move(displacement(step, 0, 0));
      twisted.move(displacement(0, 0, step));
      // The chords of 16 elements are within 0.6 % of the limit; twice on a branch of a loop.
      EXPECT_NEAR(-shifted.wrench().x() / kForce_N, force.go_to(x), 0.012) << "at " << x;
      EXPECT_NEAR(-twisted.wrench().z() / kTorque_Nm, torque.go_to(x), 0.012) << "at " << x;
    }
  }
}

TEST(PreslidingElements, ReachTheLimitAndNoMore) {
  PreslidingElements elements = pressed(ShiftCurve(1. / 3), TwistCurve(0.5));
  for (int i = 0; i < 100; ++i) elements.move(displacement(0, 0.5, 0));
  EXPECT_NEAR(elements.wrench().y(), -kForce_N, 1e-9 * kForce_N);
  for (int i = 0; i < 1000; ++i) elements.move(displacement(0, 0, -0.5));
  EXPECT_NEAR(elements.wrench().z(), kTorque_Nm, 1e-2 * kTorque_Nm);
}

TEST(PreslidingElements, HoldForceAndTorqueNearlyWithinOneEllipsoid) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal(0, 1);
  for (int path = 0; path < 50; ++path) {
    PreslidingElements elements = pressed(ShiftCurve(1. / 3), TwistCurve(0.5));
    const Eigen::Vector3d step =
        displacement(0.3 * normal(random), 0.3 * normal(random), 0.3 * normal(random));
    for (int i = 0; i < 200; ++i) elements.move(step);
    const Eigen::Vector3d wrench = elements.wrench();
    const double used = std::hypot(wrench.head<2>().norm() / kForce_N, wrench.z() / kTorque_Nm);
    // Elements differ in their limit of force over that of torque, so that the sum of their
    // ellipsoids is some per cent larger than the contact's. A cylinder's corner would be at 1.41.
    EXPECT_LE(used, 1.06);
    EXPECT_GE(used, 1 - 1e-12);
  }
}

TEST(PreslidingElements, KeepTheirStrainWhereTheySoften) {
  PreslidingElements elements = pressed(ShiftCurve(1. / 3), TwistCurve(0.5));
  elements.move(displacement(0.02, -0.01, 0.01));  // no element slides
  const Eigen::Vector3d before = elements.wrench();
  elements.set_limits({kStuck.torsional_Nm_per_rad / 2, kStuck.tangential_x_N_per_m / 4,
                       kStuck.tangential_y_N_per_m},
                      kForce_N, kTorque_Nm);
  const Eigen::Vector3d after = elements.wrench();
  EXPECT_NEAR(after.x(), before.x() / 4, 1e-12);
  EXPECT_NEAR(after.y(), before.y(), 1e-12);
  EXPECT_NEAR(after.z(), before.z() / 2, 1e-15);
}

// The load history is that of a time step: the contact exerts the wrench at the start less
// displacement over compliance. Whatever the motion and the load, the springs gain no more than the
// bodies gave.
TEST(PreslidingElements, MakeNoEnergyInRandomHistories) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  double largest_J = 0;
  for (int history = 0; history < 200; ++history) {
    PreslidingElements elements = pressed(ShiftCurve(0.4), TwistCurve(0.8, 0.5));
    double given_J = 0;
    for (int step = 0; step < 200; ++step) {
      const double before_J = elements.energy_J();
      const double size = std::pow(10, -2 * uniform(random));
      const Eigen::Vector3d move =
          displacement(size * normal(random), size * normal(random), size * normal(random));
      const Eigen::Vector3d exerted = elements.wrench() - elements.stiffness().cwiseProduct(move);
      elements.move(move);
      const double work_J = -exerted.dot(move);  // of the bodies on the contact
      EXPECT_LE(elements.energy_J() - before_J, work_J + 1e-15);
      given_J += work_J;
      EXPECT_GE(given_J, -1e-15) << "never more comes back than was given";
      if (uniform(random) < 0.1) {
        // Another load: limits and stiffness with it.
        const double load = 0.2 + 1.5 * uniform(random), stiffness = std::cbrt(load);
        const double old_J = elements.energy_J();
        elements.set_limits(
            {kStuck.torsional_Nm_per_rad * load, kStuck.tangential_x_N_per_m * stiffness,
             kStuck.tangential_y_N_per_m * stiffness},
            kForce_N * load, kTorque_Nm * load * stiffness);
        EXPECT_LE(elements.energy_J(), old_J * (1 + 1e-12));
      }
      largest_J = std::max(largest_J, elements.energy_J());
    }
  }
  EXPECT_GT(largest_J, 1e-4) << "of the order of (mu P)²/k";
}

TEST(PreslidingElements, RelaxAsTheirRubber) {
  const Relaxation relaxation({{0.2, 0.1}, {0.15, 3}, {0.05, 40}});
  PreslidingElements elements = pressed(ShiftCurve(1. / 3), TwistCurve(0.5));
  elements.set_relaxation(relaxation);
  // So far below the limit that nothing slides but the first of sixteen elements.
  elements.move(displacement(2e-3, -1e-3, 1e-3));
  const Eigen::Vector3d at_once = elements.wrench();
  double time_s = 0;
  for (const double step_s : {1e-3, 0.05, 0.2, 1., 20., 500.}) {
    const double before_J = elements.energy_J();
    elements.relax(step_s);
    time_s += step_s;
    // Products of exponentials: round-off.
    EXPECT_LT((elements.wrench() - relaxation.modulus(time_s) * at_once).norm(),
              1e-12 * at_once.norm());
    EXPECT_LT(elements.energy_J(), before_J);
  }
}

TEST(PreslidingElements, MakeNoEnergyWhileTheyRelax) {
  std::mt19937 random(20261130);
  std::normal_distribution<double> normal(0, 1);
  for (int history = 0; history < 100; ++history) {
    PreslidingElements elements = pressed(ShiftCurve(0.4), TwistCurve(0.8, 0.5));
    elements.set_relaxation(Relaxation({{0.3, 1}, {0.2, 10}}));
    double given_J = 0;
    for (int step = 0; step < 200; ++step) {
      elements.relax(0.1);
      elements.turn_axes(0.1 * normal(random));
      const double before_J = elements.energy_J();
      const Eigen::Vector3d move = displacement(normal(random), normal(random), normal(random));
      const double work_J =
          -(elements.wrench() - elements.stiffness().cwiseProduct(move)).dot(move);
      elements.move(move);
      // Round-off of energies of some 1e-4 J.
      EXPECT_LE(elements.energy_J() - before_J, work_J + 1e-15);
      given_J += work_J;
      EXPECT_GE(given_J, -1e-15);
    }
  }
}

TEST(PreslidingElements, TurnWithTheAxes) {
  PreslidingElements elements = pressed(ShiftCurve(1. / 3), TwistCurve(0.5));
  elements.move(displacement(0.3, -0.1, 0.2));
  const Eigen::Vector3d before = elements.wrench();
  elements.turn_axes(0.7);
  const Eigen::Vector3d after = elements.wrench();
  EXPECT_NEAR(after.x(), std::cos(0.7) * before.x() + std::sin(0.7) * before.y(), 1e-15);
  EXPECT_NEAR(after.head<2>().norm(), before.head<2>().norm(), 1e-15);
  EXPECT_EQ(after.z(), before.z());
}

}  // namespace
}  // namespace softfinger
