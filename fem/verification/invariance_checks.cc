// Units, the choice of axes and the mirror image that is computed must not change a result. Also
// checks equilibrium.
#include <cmath>
#include <cstdio>
#include <limits>

#include "fem/verification/contact_on_layer.h"
#include "fem/verification/groups.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "softfinger/input/constants.h"

namespace softfinger::fem::verification {
namespace {

const char* const invariance_group = "invariance";
/// Condition number of the stiffness of a coarse contact: (elements along the layer)² times the
/// ratios of moduli and of cell sizes, about 1e5 at nu = 0.4.
constexpr double condition = 1e5;

Problem oblong() {
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.02, 0.01, 0}, {2e-3, 3e5, 0.4}, {1, 0.8}};
  return problem;
}

Check same(const char* name, const char* quantity, double expected, double measured) {
  Check check{invariance_group, name, quantity, expected, measured};
  check.tolerance = 10 * kEpsilon * condition;
  check.reason = "round-off x condition, 1e5";
  return check;
}

Checks check_units() {
  const LevelResult plain = solve_quietly(oblong()).finest;
  Checks checks;
  for (const double length : {1e-3, 1e3})
    for (const double stress : {1e-3, 1e3}) {
      Problem scaled = oblong();
      auto& contact = scaled.contact;
      contact.radii.major_m *= length;
      contact.radii.minor_m *= length;
      contact.layer.thickness_m *= length;
      contact.layer.youngs_modulus_Pa *= stress;
      contact.load.normal_force_N *= stress * length * length;
      const LevelResult result = solve_quietly(scaled).finest;
      char name[64];
      std::snprintf(name, sizeof name, "lengths x %g, stresses x %g", length, stress);
      checks.push_back(same(name, "a, m", plain.a_m * length, result.a_m));
      checks.push_back(same(name, "d, m", plain.indentation_m * length, result.indentation_m));
      checks.push_back(same(name, "torque, N m", plain.max_torque_Nm * stress * std::pow(length, 3),
                            result.max_torque_Nm));
    }
  return checks;
}

Check axis_of_the_input() {
  Problem turned = oblong();
  turned.contact.radii.axis_rad = 0.6;
  Check check = same("axis_rad 0.6", "d, m", solve_quietly(oblong()).finest.indentation_m,
                     solve_quietly(turned).finest.indentation_m);
  check.tolerance = 0;
  check.reason = "the same computation";
  return check;
}

/// A flat layer under a quadric turned by an angle, by the path of curved fingertips: all of the
/// layer is meshed.
Problem with_turned_quadric(double angle_rad) {
  Problem problem = oblong();
  constexpr double flat = std::numeric_limits<double>::infinity();
  const RelativeRadii& radii = problem.contact.radii;
  problem.fingertip.pad = meshes::paraboloid_pad(flat, flat);
  problem.fingertip.object = meshes::quadric_object(radii.major_m, radii.minor_m, angle_rad);
  return problem;
}

/// A finger with one mirror plane on a plane.
Problem with_tapered_finger() {
  Problem problem = oblong();
  const RelativeRadii& radii = problem.contact.radii;
  problem.fingertip.pad = meshes::tapered_pad(radii.major_m, radii.minor_m, 0.2 / radii.major_m);
  problem.fingertip.object = meshes::plane_object();
  problem.fingertip.symmetric_object = true;
  return problem;
}

Checks check_turned_quadric() {
  const Result straight = solve_quietly(oblong());
  const Result turned = solve_quietly(with_turned_quadric(0.5));
  Checks checks;
  const auto add = [&](const char* quantity, double expected, double measured, double stated) {
    Check check{invariance_group, "quadric turned by 0.5 rad on the whole layer", quantity,
                expected, measured};
    check.tolerance = stated;
    check.reason = "stated errors of both, level 1";
    checks.push_back(check);
  };
  add("d, m", straight.finest.indentation_m, turned.finest.indentation_m,
      straight.error.indentation + turned.error.indentation);
  add("torque, N m", straight.finest.max_torque_Nm, turned.finest.max_torque_Nm,
      straight.error.max_torque + turned.error.max_torque);
  add("a, m", straight.finest.a_m, turned.finest.a_m, straight.error.a + turned.error.a);
  add("b, m", straight.finest.b_m, turned.finest.b_m, straight.error.b + turned.error.b);
  Check angle{invariance_group, "quadric turned by 0.5 rad on the whole layer", "long axis, rad",
              0.5, turned.finest.turn_rad};
  // An angle t changes the second moments' off-diagonal by (a² - b²) t.
  const double aspect2 = std::pow(turned.finest.b_m / turned.finest.a_m, 2);
  angle.tolerance = (turned.error.a + turned.error.b) / (1 - aspect2) / 0.5;
  angle.reason = "stated errors of a and b as an angle";
  checks.push_back(angle);
  return checks;
}

Checks check_mirrors() {
  const double a = 2.6e-3, b = 1.7e-3;
  Problem whole_problem = with_turned_quadric(0);
  const Pressed quarter = press_at_level(oblong(), a, b, 1);
  const Pressed whole = press_at_level(whole_problem, a, b, 1);
  Checks checks{same("whole layer against a quarter, same mesh", "d / h", quarter.contact.approach,
                     whole.contact.approach),
                same("whole layer against a quarter, same mesh", "torque arm / h",
                     quarter.torque_arm(), whole.torque_arm())};
  Problem half_problem = with_tapered_finger();
  const Pressed half = press_at_level(half_problem, a, b, 1);
  half_problem.fingertip.symmetric_object = false;
  const Pressed all = press_at_level(half_problem, a, b, 1);
  const char* const halves = "half a layer against the whole, same mesh";
  checks.push_back(same(halves, "d / h", all.contact.approach, half.contact.approach));
  checks.push_back(same(halves, "torque arm / h", all.torque_arm(), half.torque_arm()));
  const auto largest_difference = [](const Pressed& pressed, auto image) {
    const auto& nodes = pressed.model->nodes();
    double difference = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto [x, y] = image(nodes[i].x, nodes[i].y);
      bool found = false;
      for (std::size_t j = 0; j < nodes.size() && !found; ++j)
        if (std::hypot(nodes[j].x - x, nodes[j].y - y) < 1e-9) {
          found = true;
          difference =
              std::max(difference, std::abs(pressed.normal_force[static_cast<Eigen::Index>(i)] -
                                            pressed.normal_force[static_cast<Eigen::Index>(j)]));
        }
      if (!found) return std::numeric_limits<double>::quiet_NaN();
    }
    return difference / pressed.normal_force.maxCoeff();
  };
  using PlacePair = std::pair<double, double>;
  checks.push_back(
      same("whole layer mirrored in x", "change of nodal forces / largest", 0,
           largest_difference(whole, [](double x, double y) { return PlacePair(-x, y); })));
  checks.push_back(
      same("whole layer mirrored in y", "change of nodal forces / largest", 0,
           largest_difference(whole, [](double x, double y) { return PlacePair(x, -y); })));
  Problem round = oblong();
  round.contact.radii.minor_m = round.contact.radii.major_m;
  const Pressed circle = press_at_level(round, b, b, 1);
  checks.push_back(
      same("circle, x and y exchanged", "change of nodal forces / largest", 0,
           largest_difference(circle, [](double x, double y) { return PlacePair(y, x); })));
  return checks;
}

Checks check_equilibrium() {
  const Residuals& all = residuals_so_far();
  char name[64];
  std::snprintf(name, sizeof name, "worst of %d contacts above", all.contacts);
  Check balance{invariance_group, name, "sum of nodal forces / P - 1", 0, all.load};
  balance.tolerance = 1e4 * kEpsilon;
  balance.reason = "round-off of a sum of up to 1e4 nodes";
  Check gap{invariance_group, name, "penetration / d, tension / peak", 0, all.complementarity};
  gap.tolerance = 1e4 * kEpsilon * 100;
  gap.reason = "round-off of a product with up to 1e4 nodes, solved by Cholesky (condition 1e2)";
  return {balance, gap};
}

}  // namespace

Checks check_invariance(bool quick) {
  Checks checks;
  const auto add = [&](const Checks& more) {
    checks.insert(checks.end(), more.begin(), more.end());
  };
  add(check_mirrors());
  add({axis_of_the_input()});
  if (!quick) {
    add(check_units());
    add(check_turned_quadric());
  }
  add(check_equilibrium());
  return checks;
}

}  // namespace softfinger::fem::verification
