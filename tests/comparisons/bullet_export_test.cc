// The numbers of `softfinger export --to bullet` in the real Bullet: where a pressed and twisted
// fingertip slips, that the sliding force does not matter to it, how fast it turns below the limit,
// and the rolling friction's trap.

#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace {

using nlohmann::json;

constexpr double kMass_kg = 0.02, kRadius_m = 0.02, kTimeStep_s = 1e-3;
constexpr double kInertia_kgm2 = 0.4 * kMass_kg * kRadius_m * kRadius_m;

/// Turning of the object: velocity at the end, acceleration on average over the last half.
struct Turning {
  double velocity_rad_per_s = 0, acceleration_rad_per_s2 = 0;
};

class BulletExport : public testing::Test {
 protected:
  json exported;
  double load_N = 0, friction = 0, max_torque_Nm = 0, rolling_friction_m = 0;

  void SetUp() override {
    TemporaryFolder folder;
    const ProgramRun run = run_softfinger(
        {folder.path(), {}, -1, ""}, {"export", "silicone_pad_2mm", "--to", "bullet", "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    exported = json::parse(run.out);
    load_N = exported["load_N"];
    friction = exported["friction_coefficient"];
    max_torque_Nm = friction * load_N * exported["eccentricity_m"].get<double>();
    rolling_friction_m = exported["values"]["rolling_friction_m"];
  }

  /// A ball on a block, without gravity, that turns about z only: pressed for half a second, then
  /// also pushed and twisted for one.
  Turning turning(double push_N, double torque_Nm, double time_step_s = kTimeStep_s) const {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    world.setGravity(btVector3(0, 0, 0));
    world.getSolverInfo().m_numIterations = 200;

    const auto real = [](double value) { return static_cast<btScalar>(value); };
    const btScalar inertia = real(kInertia_kgm2), radius = real(kRadius_m);
    btBoxShape block_shape(btVector3(1, 1, real(0.1)));
    btSphereShape ball_shape(radius);
    btRigidBody block(0, nullptr, &block_shape);
    btRigidBody ball(real(kMass_kg), nullptr, &ball_shape, btVector3(inertia, inertia, inertia));
    block.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, real(-0.1))));
    ball.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, radius)));
    ball.setAngularFactor(btVector3(0, 0, 1));
    ball.setActivationState(DISABLE_DEACTIVATION);
    const json& values = exported["values"];
    ball.setFriction(real(values["sliding_friction"]));
    ball.setSpinningFriction(real(values["spinning_friction_m"]));
    ball.setRollingFriction(real(rolling_friction_m));
    block.setFriction(real(values["object_sliding_friction"]));
    world.addRigidBody(&block);
    world.addRigidBody(&ball);

    const auto run = [&](double force_N, double twist_Nm, double duration_s) {
      const int steps = static_cast<int>(std::lround(duration_s / time_step_s));
      for (int i = 0; i < steps; ++i) {
        ball.applyCentralForce(btVector3(real(force_N), 0, real(-load_N)));
        ball.applyTorque(btVector3(0, 0, real(twist_Nm)));
        world.stepSimulation(real(time_step_s), 0, real(time_step_s));
      }
      return static_cast<double>(ball.getAngularVelocity().z());
    };
    run(0, 0, 0.5);
    const double half = run(push_N, torque_Nm, 0.5), full = run(push_N, torque_Nm, 0.5);
    world.removeRigidBody(&ball);
    world.removeRigidBody(&block);
    return {full, (full - half) / 0.5};
  }
};

// Bullet calculates in single precision: 1e-4 of the limit is a tenth of the distance from it.
constexpr double kTolerance = 1e-4, kBelow = 0.999, kAbove = 1.001;

TEST_F(BulletExport, SlipsAtThePredictedTorqueWhateverTheSlidingForce) {
  const double limit = max_torque_Nm / kInertia_kgm2;
  for (const double share : {0.0, 0.6}) {
    SCOPED_TRACE(share);
    const double push_N = share * friction * load_N;
    EXPECT_NEAR(turning(push_N, kBelow * max_torque_Nm).acceleration_rad_per_s2, 0,
                kTolerance * limit);
    EXPECT_NEAR(turning(push_N, kAbove * max_torque_Nm).acceleration_rad_per_s2,
                (kAbove - 1) * limit, kTolerance * limit);
  }
}

// Below the limit nothing accelerates, but the contact does not hold: the friction takes the spin
// that was there at the start of the step, and not what the torque adds within it.
TEST_F(BulletExport, TurnsAtTorqueTimesStepOverInertiaBelowTheLimit) {
  for (const double time_step_s : {kTimeStep_s, kTimeStep_s / 4})
    for (const double share : {0.05, 0.5, 0.999}) {
      SCOPED_TRACE(share);
      const double torque_Nm = share * max_torque_Nm;
      EXPECT_NEAR(turning(0, torque_Nm, time_step_s).velocity_rad_per_s /
                      (torque_Nm * time_step_s / kInertia_kgm2),
                  1, kTolerance);
    }
}

TEST_F(BulletExport, HasNoSpinningFrictionWithoutRollingFriction) {
  rolling_friction_m = 0;
  const double torque_Nm = 0.5 * max_torque_Nm;
  EXPECT_NEAR(turning(0, torque_Nm).acceleration_rad_per_s2 / (torque_Nm / kInertia_kgm2), 1,
              kTolerance);
}

constexpr double kPadInertia_kgm2 = 1e-4;

/// A flat pad as the exported box, twisted for half a second by a share of the stated torque.
double turning_of_pad_rad_per_s(double share, bool by_own_face) {
  TemporaryFolder folder;
  const ProgramRun run = run_softfinger(
      {folder.path(), {}, -1, "", ""},
      {"export", "--pad-mm", "22,37.5", "--thickness-mm", "3", "--youngs-modulus-kPa", "800",
       "--poisson-ratio", "0.49", "--load", "20", "--friction", "0.9", "--to", "bullet", "--json"});
  EXPECT_EQ(run.status, 0) << run.err;
  const json exported = json::parse(run.out), values = exported["box_values"];
  const double load_N = 20,
               torque_Nm = share * 0.9 * load_N * exported["eccentricity_m"].get<double>();
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity(btVector3(0, 0, 0));
  world.getSolverInfo().m_numIterations = 200;
  const auto real = [](double value) { return static_cast<btScalar>(value); };
  const btScalar half_height = real(0.02), inertia = real(kPadInertia_kgm2);
  btBoxShape block_shape(btVector3(1, 1, real(0.1)));
  btBoxShape pad_shape(by_own_face ? btVector3(real(11e-3), real(18.75e-3), half_height)
                                   : btVector3(real(values["box_half_length_x_m"]),
                                               real(values["box_half_length_y_m"]), half_height));
  pad_shape.setMargin(real(1e-4));
  btRigidBody block(0, nullptr, &block_shape);
  btRigidBody pad(real(0.1), nullptr, &pad_shape, btVector3(inertia, inertia, inertia));
  block.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, real(-0.1))));
  pad.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, half_height)));
  pad.setActivationState(DISABLE_DEACTIVATION);
  pad.setFriction(real(values["sliding_friction"]));
  block.setFriction(real(values["object_sliding_friction"]));
  world.addRigidBody(&block);
  world.addRigidBody(&pad);
  for (int i = 0; i < 1000; ++i) {
    pad.applyCentralForce(btVector3(0, 0, real(-load_N)));
    if (i >= 500) pad.applyTorque(btVector3(0, 0, real(torque_Nm)));
    world.stepSimulation(real(kTimeStep_s), 0, real(kTimeStep_s));
  }
  const double turning = static_cast<double>(pad.getAngularVelocity().z());
  world.removeRigidBody(&pad);
  world.removeRigidBody(&block);
  return turning;
}

// Friction does not know the torque of the step itself, here as with one point.
TEST(BulletPad, SlipsByTheForcesAtABoxsCorners) {
  const double creep_rad_per_s = 0.9 * 20 * 9.878e-3 * kTimeStep_s / kPadInertia_kgm2;
  EXPECT_NEAR(turning_of_pad_rad_per_s(0.97, false) / creep_rad_per_s, 0.97, 0.02);
  // Without friction it would turn at 890 rad/s by then, against the stated torque at 27.
  // 5 rad/s are 0.6 % of the torque.
  EXPECT_NEAR(turning_of_pad_rad_per_s(1.03, false), 27, 5);
  EXPECT_NEAR(turning_of_pad_rad_per_s(2, true) / creep_rad_per_s, 2, 0.02);
}

}  // namespace
}  // namespace softfinger::tests
