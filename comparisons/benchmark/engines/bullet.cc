// needs header: btBulletDynamicsCommon.h in bullet
// needs libraries: BulletDynamics BulletCollision LinearMath
// needs package: libbullet-dev
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <memory>

#include "comparisons/benchmark/engine.h"

/// Bullet's rigid bodies with the numbers of `softfinger export --to bullet` and its default
/// solver.
namespace softfinger::benchmark {
namespace {

btScalar real(double value) { return static_cast<btScalar>(value); }
btVector3 vector(const Eigen::Vector3d& v) { return {real(v.x()), real(v.y()), real(v.z())}; }
Eigen::Vector3d vector(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

/// Torsional friction of a fingertip; the points of a flat pad's corners have none.
double spinning_friction_m(const Scene& scene, const Body& body) {
  if (body.shape != Body::Shape::ball) return 0;
  const ContactProblem& contact = scene.contact;
  return contact.load.friction_coefficient * eccentricity_m(contact, contact.load.normal_force_N);
}

std::unique_ptr<btRigidBody> made_body(const Scene& scene, const Body& body,
                                       btCollisionShape& shape) {
  const bool is_fixed = body.freedom == Body::Freedom::none;
  auto made =
      std::make_unique<btRigidBody>(is_fixed ? btScalar(0) : real(body.mass_kg), nullptr, &shape,
                                    is_fixed ? btVector3(0, 0, 0) : vector(body.inertia_kg_m2()));
  made->setWorldTransform(btTransform(btQuaternion::getIdentity(), vector(body.position_m)));
  made->setActivationState(DISABLE_DEACTIVATION);
  if (body.freedom == Body::Freedom::along_x) {
    made->setLinearFactor(btVector3(1, 0, 0));
    made->setAngularFactor(btVector3(0, 0, 0));
  }
  const double mu = scene.contact.load.friction_coefficient;
  if (body.is_fingertip) {
    const double spin_m = spinning_friction_m(scene, body);
    made->setFriction(real(mu));
    made->setSpinningFriction(real(spin_m));
    made->setRollingFriction(real(1e-3 * spin_m));
  } else {
    // The coefficients of a pair are multiplied.
    made->setFriction(
        real(scene.has_fingertips() ? 1 : std::sqrt(scene.rigid_friction_coefficient)));
  }
  return made;
}

Motion run(const Scene& scene) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity(vector(scene.gravity_m_per_s2));
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  for (const Body& body : scene.bodies) {
    if (body.shape == Body::Shape::ball)
      shapes.push_back(std::make_unique<btSphereShape>(real(body.half_size_m.x())));
    else if (body.shape == Body::Shape::capsule)
      shapes.push_back(std::make_unique<btCapsuleShape>(real(body.half_size_m.x()),
                                                        real(2 * body.half_size_m.y())));
    else
      shapes.push_back(std::make_unique<btBoxShape>(vector(exported_half_size_m(scene, body))));
    bodies.push_back(made_body(scene, body, *shapes.back()));
    world.addRigidBody(bodies.back().get());
  }

  Motion motion;
  std::size_t next = 0;
  const int steps = int(std::lround(scene.duration_s / scene.time_step_s));
  const auto start = std::chrono::steady_clock::now();
  for (motion.steps = 0; motion.steps < steps;) {
    const double time_s = motion.steps * scene.time_step_s;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Load load = scene.load_at(int(i), time_s);
      bodies[i]->applyCentralForce(vector(load.force_N));
      bodies[i]->applyTorque(vector(load.torque_Nm));
    }
    world.stepSimulation(real(scene.time_step_s), 0, real(scene.time_step_s));
    ++motion.steps;
    if (next < scene.sample_times_s.size() &&
        motion.steps * scene.time_step_s >= scene.sample_times_s[next] - scene.time_step_s / 2) {
      motion.samples.emplace_back();
      for (const auto& body : bodies) {
        const btQuaternion turn = body->getWorldTransform().getRotation();
        motion.samples.back().push_back({vector(body->getWorldTransform().getOrigin()),
                                         vector(body->getLinearVelocity()),
                                         Eigen::Quaterniond(turn.w(), turn.x(), turn.y(), turn.z()),
                                         vector(body->getAngularVelocity())});
      }
      ++next;
    }
  }
  motion.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const auto& body : bodies) world.removeRigidBody(body.get());
  return motion;
}

}  // namespace

std::vector<Engine> bullet_engines() {
  return {{"bullet_exported",
           fmt::format("Bullet {}.{}, lines of softfinger export", btGetVersion() / 100,
                       btGetVersion() % 100),
           "mu, mu e_n, pads as boxes; 10 iterations, single precision", run}};
}

}  // namespace softfinger::benchmark
