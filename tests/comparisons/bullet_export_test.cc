// The numbers of `softfinger export --to bullet`, and of --to gz-sim as its plugin hands them to
// Bullet, in the real Bullet: where a pressed and twisted
// fingertip slips, that the sliding force does not matter to it, how fast it turns below the limit,
// and the rolling friction's trap.

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
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

/// A ball on a block as multi-bodies, whose colliders gz-physics' bullet-featherstone fills with
/// numbers from SDF: friction and spinning friction, and once more the friction as the scale of the
/// friction's directions x and y.
class GazeboSimsBullet : public testing::Test {
 protected:
  struct Collider {
    double friction = 0, spinning_friction_m = 0;
  };
  struct Acceleration {
    double along_m_per_s2 = 0, about_normal_rad_per_s2 = 0;
  };
  double load_N = 0, friction = 0, max_torque_Nm = 0;
  Collider finger, object;

  void SetUp() override {
    TemporaryFolder folder;
    const ProgramRun run = run_softfinger(
        {folder.path(), {}, -1, ""}, {"export", "silicone_pad_2mm", "--to", "gz-sim", "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    const json exported = json::parse(run.out), values = exported["values"];
    load_N = exported["load_N"];
    friction = exported["friction_coefficient"];
    max_torque_Nm = friction * load_N * exported["eccentricity_m"].get<double>();
    finger = {values["bullet_sliding_friction"], values["bullet_spinning_friction_m"]};
    object = {values["bullet_object_sliding_friction"],
              values["bullet_object_spinning_friction_m"]};
  }

  static std::unique_ptr<btMultiBodyLinkCollider> add(btMultiBodyDynamicsWorld& world,
                                                      btMultiBody& body, btCollisionShape& shape,
                                                      btScalar height_m, const Collider& numbers) {
    const btTransform at(btQuaternion::getIdentity(), btVector3(0, 0, height_m));
    body.setBaseWorldTransform(at);
    body.finalizeMultiDof();
    body.setLinearDamping(0);
    body.setAngularDamping(0);
    auto collider = std::make_unique<btMultiBodyLinkCollider>(&body, -1);
    collider->setCollisionShape(&shape);
    collider->setWorldTransform(at);
    const btScalar sliding = static_cast<btScalar>(numbers.friction);
    collider->setFriction(sliding);
    collider->setSpinningFriction(static_cast<btScalar>(numbers.spinning_friction_m));
    collider->setAnisotropicFriction(btVector3(sliding, sliding, 1),
                                     btCollisionObject::CF_ANISOTROPIC_FRICTION);
    world.addMultiBody(&body);
    const bool moves = !body.hasFixedBase();
    world.addCollisionObject(collider.get(), moves ? 1 : 2, moves ? 2 : 1);
    body.setBaseCollider(collider.get());
    return collider;
  }

  /// Pressed for 0.3 s, then also pushed or twisted for 0.2 s: the mean of the last 0.1 s.
  Acceleration acceleration(double push_N, double torque_Nm) const {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btMultiBodyConstraintSolver solver;
    btMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    world.setGravity(btVector3(0, 0, 0));
    world.getSolverInfo().m_numIterations = 200;
    const auto real = [](double value) { return static_cast<btScalar>(value); };
    btBoxShape block_shape(btVector3(1, 1, real(0.1)));
    btSphereShape ball_shape(real(kRadius_m));
    // It cannot roll.
    const btScalar about_normal = real(kInertia_kgm2), other = real(1e6 * kInertia_kgm2);
    btMultiBody block(0, 0, btVector3(0, 0, 0), true, false),
        ball(0, real(kMass_kg), btVector3(other, other, about_normal), false, false);
    const auto block_collider = add(world, block, block_shape, real(-0.1), object);
    const auto ball_collider = add(world, ball, ball_shape, real(kRadius_m), finger);
    const auto run = [&](double force_N, double twist_Nm, int steps) {
      for (int i = 0; i < steps; ++i) {
        ball.addBaseForce(btVector3(real(force_N), 0, real(-load_N)));
        ball.addBaseTorque(btVector3(0, 0, real(twist_Nm)));
        world.stepSimulation(real(kTimeStep_s), 0, real(kTimeStep_s));
      }
      return Acceleration{ball.getBaseVel().x(), ball.getBaseOmega().z()};
    };
    run(0, 0, 300);
    const Acceleration half = run(push_N, torque_Nm, 100), full = run(push_N, torque_Nm, 100);
    for (btMultiBody* body : {&ball, &block}) world.removeMultiBody(body);
    world.removeCollisionObject(ball_collider.get());
    world.removeCollisionObject(block_collider.get());
    return {(full.along_m_per_s2 - half.along_m_per_s2) / 0.1,
            (full.about_normal_rad_per_s2 - half.about_normal_rad_per_s2) / 0.1};
  }
};

// 1e-3 of the limit: single precision, and the rows of a contact are solved one after the other.
constexpr double kMultiBodyTolerance = 1e-3;

TEST_F(GazeboSimsBullet, HoldsTheTorqueAndSlipsAboveIt) {
  const double limit = max_torque_Nm / kInertia_kgm2;
  EXPECT_NEAR(acceleration(0, 0.95 * max_torque_Nm).about_normal_rad_per_s2, 0,
              kMultiBodyTolerance * limit);
  EXPECT_NEAR(acceleration(0, 1.05 * max_torque_Nm).about_normal_rad_per_s2, 0.05 * limit,
              kMultiBodyTolerance * limit);
}

TEST_F(GazeboSimsBullet, SlidesAtMuP) {
  const double limit_N = friction * load_N;
  EXPECT_NEAR(acceleration(0.95 * limit_N, 0).along_m_per_s2, 0,
              kMultiBodyTolerance * limit_N / kMass_kg);
  EXPECT_NEAR(acceleration(1.05 * limit_N, 0).along_m_per_s2, 0.05 * limit_N / kMass_kg,
              kMultiBodyTolerance * limit_N / kMass_kg);
}

// The traps of the export: mu in place of its root, and an object without a coefficient.
TEST_F(GazeboSimsBullet, SlidesAtTheSquareOfItsFrictionAndHoldsAnythingByTheDefaultCoefficient) {
  finger.friction = friction;
  const double limit_N = friction * friction * load_N;
  EXPECT_NEAR(acceleration(1.05 * limit_N, 0).along_m_per_s2, 0.05 * limit_N / kMass_kg,
              kMultiBodyTolerance * limit_N / kMass_kg);
  object.spinning_friction_m = 1;
  EXPECT_NEAR(acceleration(0, 20 * max_torque_Nm).about_normal_rad_per_s2, 0,
              kMultiBodyTolerance * max_torque_Nm / kInertia_kgm2);
}

}  // namespace
}  // namespace softfinger::tests
