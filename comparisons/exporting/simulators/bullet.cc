#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"

/// Bullet 3 combines the coefficients of a pair in btManifoldResult: sliding mu_0 mu_1, spinning
/// s_0 mu_1 + s_1 mu_0, rolling like spinning. In btSequentialImpulseConstraintSolver the torque
/// about the normal is at most the spinning coefficient times the normal force, whatever the
/// sliding force. It has this limit only for pairs whose rolling coefficient is positive;
/// btMultiBodyConstraintSolver looks at the spinning coefficient only.
///
/// setupTorsionalFrictionConstraint takes the relative spin from the bodies' velocities before the
/// impulses of external torques, which sliding friction does include. A held contact thus turns
/// at torque x time step / moment of inertia.
///
/// So the finger gets all values and the object mu_1 = 1, s_1 = 0. The pair then slides with mu,
/// and its torque per load is s_0 = mu e_n.
namespace softfinger::exporting {
namespace {

/// Rolling coefficient over spinning coefficient: positive, so that spinning friction exists, and
/// too small to have an effect.
constexpr double kRollingShare = 1e-3;

Lines lines(const SoftContact& contact) {
  const double spin_m = contact.torque_per_load_m(), roll_m = kRollingShare * spin_m;
  return {
      fmt::format("# {origin}. spinningFriction: m, largest torque / load = mu e_n; "
                  "rollingFriction: m, only because Bullet ignores spinningFriction without it\n"
                  "p.changeDynamics(finger, link, lateralFriction={mu:.6g}, "
                  "spinningFriction={spin:.6g}, rollingFriction={roll:.3g})\n"
                  "p.changeDynamics(object, -1, lateralFriction=1, spinningFriction=0, "
                  "rollingFriction=0)\n"
                  "# C++: finger->setFriction({mu:.6g}); "
                  "finger->setSpinningFriction({spin:.6g}); "
                  "finger->setRollingFriction({roll:.3g}); object->setFriction(1);\n",
                  fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
                  fmt::arg("spin", spin_m), fmt::arg("roll", roll_m)),
      {{"sliding_friction", contact.friction_coefficient},
       {"spinning_friction_m", spin_m},
       {"rolling_friction_m", roll_m},
       {"object_sliding_friction", 1.0}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  return {
      fmt::format(
          "# {origin}. A box in place of the pad's face, its corners at e_n = {e:.6g} m from the "
          "middle: they slip together at mu e_n P\n"
          "pad = p.createCollisionShape(p.GEOM_BOX, halfExtents=[{x:.6g}, {y:.6g}, {z:.6g}])\n"
          "p.changeDynamics(finger, link, lateralFriction={mu:.6g}, spinningFriction=0, "
          "rollingFriction=0)\n"
          "p.changeDynamics(object, -1, lateralFriction=1, spinningFriction=0, "
          "rollingFriction=0)\n",
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("e", contact.face->eccentricity_m), fmt::arg("x", x_m), fmt::arg("y", y_m),
          fmt::arg("z", contact.face->thickness_m / 2)),
      {{"sliding_friction", contact.friction_coefficient},
       {"object_sliding_friction", 1.0},
       {"box_half_length_x_m", x_m},
       {"box_half_length_y_m", y_m}}};
}

}  // namespace

Simulator bullet_simulator() {
  return {
      "bullet",
      "Bullet",
      "|f| <= mu P and, apart from it, |torque| <= mu e_n P with a constant e_n",
      0,
      0,
      lines,
      box_lines,
      {"below the limit the contact does not hold, it turns at torque x time step / moment of "
       "inertia for ever (rigid bodies; some 0.05 to 2 rad/s for grams and newtons at 1 ms): the "
       "friction takes the spin of the step's start, and not what an applied torque adds within "
       "it; a quarter of the step turns a quarter as fast",
       "rigid bodies (btRigidBody) have spinning friction only where the pair's rolling friction "
       "is positive, so it is set to a thousandth of the spinning one; multi-bodies do not need it",
       "the pair has mu_0 mu_1 for sliding and s_0 mu_1 + s_1 mu_0 for spinning: with the "
       "default friction 0.5 of the object both are halved",
       "force and torque have separate limits: a sliding contact still carries the whole torque, "
       "at "
       "0.6 mu P for instance 25 % more than by the ellipsoid",
       "each contact point of a manifold adds a torque of its own; a normal impulse above 1 N s "
       "per "
       "step counts as 1 N s"},
      "Bullet 3.24 (BulletCollision/CollisionDispatch/btManifoldResult.cpp, BulletDynamics/"
      "ConstraintSolver/btSequentialImpulseConstraintSolver.cpp), and measured there",
      "changeDynamics takes it as contactStiffness={k} with a contactDamping, for each contact "
      "point; Bullet has no stiffness about the normal."};
}

}  // namespace softfinger::exporting
