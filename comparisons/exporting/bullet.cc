#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"

/// Bullet 3, btManifoldResult: the pair's sliding coefficient is the product mu_0 mu_1, its
/// spinning one s_0 mu_1 + s_1 mu_0, its rolling one likewise. btSequentialImpulseConstraintSolver:
/// the torque about the normal is at most the spinning coefficient times the normal force, whatever
/// the sliding force, and this row exists only where the rolling coefficient is positive.
/// btMultiBodyConstraintSolver asks for the spinning one alone. So the finger carries all, the
/// object has mu_1 = 1, s_1 = 0: sliding mu, torque per load s_0 = mu e_n.
namespace softfinger::exporting {
namespace {

/// Against the spinning coefficient: enough to have the row, too little to be felt.
constexpr double kRollingShare = 1e-3;

Lines lines(const SoftContact& contact) {
  const double spin_m = contact.torque_per_load_m(), roll_m = kRollingShare * spin_m;
  return {
      fmt::format("# {origin}. spinningFriction: m, largest torque / load = mu e_n; "
                  "rollingFriction: m, only so that the spinning one is looked at\n"
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

}  // namespace

Simulator bullet() {
  return {
      "bullet",
      "Bullet",
      "|f| <= mu P and, apart from it, |torque| <= mu e_n P with a constant e_n",
      0,
      0,
      lines,
      {"rigid bodies (btRigidBody) have spinning friction only where the pair's rolling friction "
       "is positive: hence a thousandth of it; multi-bodies do not need it",
       "the pair has mu_0 mu_1 for sliding and s_0 mu_1 + s_1 mu_0 for spinning: with the "
       "default friction 0.5 of the object both are halved",
       "force and torque do not share one limit: while sliding starts, the whole torque is "
       "still there, 25 % above the ellipsoid at 0.6 mu P",
       "every contact point of a manifold has its own torque; loads above 1 N s per step count "
       "as 1 N s"}};
}

}  // namespace softfinger::exporting
