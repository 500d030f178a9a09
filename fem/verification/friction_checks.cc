// Friction from stick to slip, on contacts whose size is known: the increments are those of the
// reference, so that nothing is interpolated.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "fem/friction/friction_study.h"
#include "fem/verification/contact_on_layer.h"
#include "fem/verification/groups.h"
#include "fem/verification/torsion_reference.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"

namespace softfinger::fem::verification {
namespace {

const char* const friction_group = "friction";
constexpr double thickness_m = 2e-3, youngs_modulus_Pa = 3e5, friction_coefficient = 0.1;
constexpr double half_space = 0.05;  ///< a/h of what stands for a half-space
constexpr double zeta_3 = 1.2020569031595942;
/// Relative change that the base makes at a/h = 0.05: zeta(3)/(4 pi) (a/h)³ in a torsional
/// stiffness, half of (a/h)³ in pressure. This bounds both.
const double base_effect = std::pow(half_space, 3);

std::string named_friction(const char* format, double first, double second) {
  char buffer[80];
  std::snprintf(buffer, sizeof buffer, format, first, second);
  return buffer;
}

/// A Hertz contact of given semi-axes at a/h = 0.05.
struct HalfSpaceContact {
  Problem problem;
  double a_m, b_m;
};

HalfSpaceContact half_space_contact(double aspect, double nu) {
  const double a = half_space * thickness_m, b = a / aspect;
  const double modulus_Pa = youngs_modulus_Pa / (1 - nu * nu);
  // Johnson, Contact Mechanics, 4.26 and 4.27.
  const double major = 60 * a;
  double ratio = 1, peak = 2 * modulus_Pa * a / (M_PI * major);
  if (aspect > 1) {
    const double m = 1 - 1 / (aspect * aspect), e = std::sqrt(m);
    const double K = std::comp_ellint_1(e), E = std::comp_ellint_2(e);
    ratio = (aspect * aspect * E - K) / (K - E);
    peak = modulus_Pa * m * a * a / (2 * major * b * (K - E));
  }
  HalfSpaceContact contact{{}, a, b};
  contact.problem.contact = {{major, major / ratio, 0},
                             {thickness_m, youngs_modulus_Pa, nu},
                             {2.0 / 3 * M_PI * a * b * peak, friction_coefficient}};
  return contact;
}

/// The layer of a reference as a problem, mu P and G of it.
double force_limit_N(const Problem& problem) {
  return problem.contact.load.friction_coefficient * problem.contact.load.normal_force_N;
}

/// Expected results of a twist, in units with G = a = mu P = 1: the torque at each angle, that of
/// full slip, and the stiffness at the start.
struct ExpectedTwist {
  std::vector<double> angle, torque;
  double full_slip, stiffness;
  double reference_error;
  std::string reference;
};

Checks check_twist(const std::string& name, Problem problem, double a_m,
                   const ExpectedTwist& expected) {
  const double shear_Pa = problem.contact.layer.shear_modulus_Pa();
  const double force_N = force_limit_N(problem);
  problem.friction.torsion = true;
  const Result result = friction_of(problem, a_m, a_m, [&](FrictionPlan& plan) {
    for (const double angle : expected.angle)
      plan.twist.push_back({0, 0, angle * force_N / (shear_Pa * a_m * a_m)});
  });
  const Torsion& torsion = *result.torsion;
  Checks checks;
  const auto add = [&](const std::string& quantity, double value, double measured, double stated) {
    checks.push_back(stated_check(friction_group, name, quantity, value, measured, stated,
                                  expected.reference_error, expected.reference));
  };
  for (std::size_t i = 0; i < expected.angle.size(); ++i)
    add(named_friction("torque / full slip at G a² angle/(mu P) %.4g", expected.angle[i], 0),
        expected.torque[i] / expected.full_slip,
        torsion.increments[i].wrench.torque_Nm / (force_N * a_m * expected.full_slip),
        torsion.curve_error * expected.full_slip / expected.torque[i]);
  add("full slip / (mu P a)", expected.full_slip, torsion.full_slip_Nm / (force_N * a_m),
      torsion.full_slip_error);
  add("initial stiffness / (G a³)", expected.stiffness,
      torsion.stiffness_Nm_per_rad / (shear_Pa * a_m * a_m * a_m), torsion.stiffness_error);
  return checks;
}

Checks check_layer_twist(const LayerTwist& layer) {
  ExpectedTwist expected{{},
                         {},
                         layer.full_slip,
                         16.0 / 3 * layer.stiffness_ratio,
                         1e-7,
                         "1e-7 of the integral equation"};
  // Not the first point: it is the initial stiffness.
  for (std::size_t i = 1; i < layer.angle.size(); ++i) {
    expected.angle.push_back(layer.angle[i]);
    expected.torque.push_back(layer.torque[i]);
  }
  const Problem problem = circular_problem(circular_layer(layer.nu, layer.s));
  return check_twist(named_friction("twist on a layer, nu %.4g, a/h %.3g", layer.nu, layer.s),
                     problem, layer.s * problem.contact.layer.thickness_m, expected);
}

Checks check_lubkin(double nu) {
  const HalfSpaceContact contact = half_space_contact(1, nu);
  ExpectedTwist expected{{},
                         {0.1763453814, 0.5285759655, 0.5886198850},
                         3 * M_PI / 16,
                         16.0 / 3,
                         base_effect,
                         "(a/h)³ of the base"};
  for (const double stick : {0.9, 0.5, 0.1}) expected.angle.push_back(Lubkin::angle(stick));
  return check_twist(named_friction("Lubkin's twist on a half-space, nu %.4g", nu, 0),
                     contact.problem, contact.a_m, expected);
}

/// A disc that sticks: the start of any twist.
Checks check_stuck_disc(double s, double ratio) {
  Problem problem = circular_problem(circular_layer(0.3, s));
  problem.friction.torsion = true;
  const double a = s * problem.contact.layer.thickness_m;
  const Result result = friction_of(problem, a, a, [](FrictionPlan& plan) {
    plan.twist.push_back({0, 0, 1e-6});
  });
  return {stated_check(friction_group, named_friction("stuck disc, a/h %.3g", s, 0),
                       "stiffness / (16 G a³/3)", ratio,
                       result.torsion->stiffness_Nm_per_rad /
                           (16.0 / 3 * problem.contact.layer.shear_modulus_Pa() * a * a * a),
                       result.torsion->stiffness_error, 1e-7, "1e-7 of the integral equation")};
}

Checks check_stuck_ellipse(double aspect) {
  constexpr double nu =
      0.5;  // elsewhere sticking changes the pressure, which the formula leaves out
  HalfSpaceContact contact = half_space_contact(aspect, nu);
  contact.problem.friction.torsion = true;
  const Result result =
      friction_of(contact.problem, contact.a_m, contact.b_m, [](FrictionPlan& plan) {
        plan.twist.push_back({0, 0, 1e-6});
      });
  const double m = 1 - 1 / (aspect * aspect), e = std::sqrt(m);
  const double K = std::comp_ellint_1(e), E = std::comp_ellint_2(e);
  const double B = (E - (1 - m) * K) / m, D = (K - E) / m, C = ((2 - m) * K - 2 * E) / (m * m);
  const double expected = 2 * M_PI / 3 * (E - 4 * nu * (1 - m) * C) / (B * D - nu * E * C);
  return {stated_check(
      friction_group, named_friction("stuck ellipse, a/b %.3g, nu %.4g", aspect, nu),
      "stiffness / (G a³)", expected,
      result.torsion->stiffness_Nm_per_rad /
          (contact.problem.contact.layer.shear_modulus_Pa() * std::pow(contact.a_m, 3)),
      result.torsion->stiffness_error, base_effect, "(a/h)³ of the base")};
}

/// Full slip about centres of rotation, over mu P and mu P a.
struct LimitRow {
  double aspect, centre_x, centre_y;  ///< centre in units of b
  double force_x, force_y, torque;    ///< torque in units of mu P b
};
/// Hertzian pressure, quadrature to 15 digits.
const LimitRow limit_rows[] = {
    {1, 0.4, 0, 0, -0.452389342116930226, 0.500455709716854063},
    {1, 1, 0, 0, -0.883572933822129348, 0.220893233455532337},
    {1, 5, 0, 0, -0.995982663576298192, 0.0401154462210067719},
    {2, 0.2, 0, 0, -0.133998256729189, 0.894911553323902},
    {2, 0, 0.9, 0.709791501667781, 0, 0.620638330086657},
    {2, 2.4, 1.6, 0.56678073714791, -0.790807277768474, 0.150603734596441},
};

Checks check_limit_surface(double aspect) {
  HalfSpaceContact contact = half_space_contact(aspect, 0.5);
  std::vector<LimitRow> rows;
  for (const LimitRow& row : limit_rows)
    if (row.aspect == aspect) rows.push_back(row);
  contact.problem.friction.limit_surface = static_cast<int>(rows.size());
  const Result result =
      friction_of(contact.problem, contact.a_m, contact.b_m, [&](FrictionPlan& plan) {
        const double b = contact.b_m / thickness_m;
        for (const LimitRow& row : rows)
          plan.velocities.push_back({row.centre_y * b, -row.centre_x * b, 1});
      });
  const double force_N = force_limit_N(contact.problem);
  Checks checks;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string name =
        named_friction("full slip, a/b %.3g", aspect, 0) +
        named_friction(", centre at %.3g, %.3g b", rows[i].centre_x, rows[i].centre_y);
    const Wrench& wrench = result.limit_surface[i].wrench;
    const auto add = [&](const char* quantity, double value, double measured, double scale) {
      if (value == 0) return;
      checks.push_back(stated_check(friction_group, name, quantity, value, measured,
                                    result.limit_surface_error * scale / std::abs(value),
                                    base_effect, "(a/h)³ of the base"));
    };
    add("force x / (mu P)", rows[i].force_x, wrench.force_x_N / force_N, 1);
    add("force y / (mu P)", rows[i].force_y, wrench.force_y_N / force_N, 1);
    add("torque / (mu P b)", rows[i].torque, wrench.torque_Nm / (force_N * contact.b_m),
        result.finest.max_torque_Nm / (force_N * contact.b_m));
  }
  return checks;
}

/// int_0^inf (1 - w_t(x)) dx, w_t the bonded layer's compliance to in-plane tangential waves over
/// the half-space's (as Johnson 5.8, + 4x in the numerator).
double missing_tangential_compliance(double nu) {
  const double kappa = 3 - 4 * nu;
  constexpr int intervals = 4000;
  constexpr double end = 20, step = end / intervals;
  double sum = 0;
  for (int i = 0; i <= intervals; ++i) {
    const double x = i * step, weight = i == 0 || i == intervals ? 1 : i % 2 ? 4 : 2;
    const double w = (2 * kappa * std::sinh(2 * x) + 4 * x) /
                     (2 * kappa * std::cosh(2 * x) + 4 * x * x + 1 + kappa * kappa);
    sum += weight * step / 3 * (1 - w);
  }
  return sum;
}

/// Cattaneo and Mindlin: Q(u) of a sphere under constant load; the base takes
/// Q (ln 2 + (1 - nu) int (1 - w_t) dx) / (4 pi G h) from u.
Checks check_mindlin() {
  constexpr double nu = 0.5;  // no coupling of pressure and shear on a half-space
  const HalfSpaceContact contact = half_space_contact(1, nu);
  const Problem& problem = contact.problem;
  const double shear_Pa = problem.contact.layer.shear_modulus_Pa();
  const double force_N = force_limit_N(problem), h = problem.contact.layer.thickness_m;
  const double full_m = 3 * force_N * (2 - nu) / (16 * shear_Pa * contact.a_m);
  const double base_m_per_N =
      (std::log(2.0) + (1 - nu) * missing_tangential_compliance(nu)) / (4 * M_PI * shear_Pa * h);
  const std::vector<double> shares{0.1, 0.25, 0.5, 0.75, 0.9};
  std::vector<PlaneMotion> motions;
  for (const double share : shares)
    motions.push_back(
        {(full_m * (1 - std::pow(1 - share, 2.0 / 3)) - base_m_per_N * share * force_N) / h, 0, 0});
  std::vector<FrictionState> states[2];
  for (const int level : {1, 2}) {
    const Pressed pressed = press_at_level(problem, contact.a_m, contact.b_m, level);
    const PressedContact start = friction_start(pressed, problem, contact.a_m, contact.b_m);
    const QuarterCompliances quarters = friction_compliances(start, Invariance::none);
    states[level - 1] = move_through(start, surface_compliance(quarters, Invariance::none), motions,
                                     [](auto&&...) {});
  }
  const double unit_N = problem.contact.layer.youngs_modulus_Pa * h * h;
  Checks checks;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double coarse = unit_N * states[0][i].wrench.force_x / force_N;
    const double fine = unit_N * states[1][i].wrench.force_x / force_N;
    Check check{friction_group, "Mindlin's shift of a sphere, nu 0.5", "Q / (mu P)", shares[i],
                fine};
    const double transverse = nu / (4 - 2 * nu);
    check.tolerance = std::abs(fine - coarse) / shares[i] + transverse * transverse;
    check.reason = "level 2 - level 1, and (nu/(4 - 2 nu))²: Mindlin leaves out transverse slip";
    checks.push_back(check);
  }
  return checks;
}

/// The problem with its layer on a sphere and a plane in place of the relative radii.
Problem on_sphere(Problem problem) {
  problem.fingertip.pad = meshes::sphere_pad(problem.contact.radii.major_m);
  problem.fingertip.object = meshes::plane_object();
  problem.fingertip.symmetric_object = true;
  problem.friction.torsion = true;
  problem.friction.increments = 4;
  return problem;
}

/// A contact on a curved layer, h = R/3, that is far smaller than h and R is that of a half-space.
Checks check_bent_half_space() {
  const HalfSpaceContact contact = half_space_contact(1, 0.3);
  const Problem problem = on_sphere(contact.problem);
  const Torsion torsion = *solve_quietly(problem).torsion;
  const double a = contact.a_m, slope = a / problem.contact.radii.major_m;
  const double shear_Pa = problem.contact.layer.shear_modulus_Pa();
  const std::string name = "curved layer, h/R 1/3, a/h 0.05";
  const double neglected = base_effect + slope * slope;
  const std::string reference = "(a/h)³ of the base, (a/R)²";
  return {stated_check(friction_group, name, "stiffness / (16 G a³/3)", 1,
                       torsion.stiffness_Nm_per_rad / (16.0 / 3 * shear_Pa * a * a * a),
                       torsion.stiffness_error, 3 * neglected, reference),
          stated_check(friction_group, name, "full slip / (mu P a)", 3 * M_PI / 16,
                       torsion.full_slip_Nm / (force_limit_N(problem) * a), torsion.full_slip_error,
                       neglected, reference)};
}

/// A layer of slight curvature is the flat one; curvature changes lengths by h/R through the
/// thickness.
Checks check_bent_slightly() {
  constexpr double bending = 0.01;
  Problem flat;
  flat.contact = {{thickness_m / bending, thickness_m / bending, 0},
                  {thickness_m, youngs_modulus_Pa, 0.45},
                  {0.02, friction_coefficient}};
  Problem bent = on_sphere(flat);
  flat.friction = bent.friction;
  const Result of_flat = solve_quietly(flat), of_bent = solve_quietly(bent);
  const std::string name = "curved layer, h/R 0.01, against the flat one";
  const std::string reference = "stated of the flat one, 2 h/R";
  return {stated_check(friction_group, name, "stiffness, N m/rad",
                       of_flat.torsion->stiffness_Nm_per_rad, of_bent.torsion->stiffness_Nm_per_rad,
                       of_bent.torsion->stiffness_error,
                       of_flat.torsion->stiffness_error + 2 * bending, reference),
          stated_check(friction_group, name, "full slip, N m", of_flat.torsion->full_slip_Nm,
                       of_bent.torsion->full_slip_Nm, of_bent.torsion->full_slip_error,
                       of_flat.torsion->full_slip_error + 2 * bending, reference)};
}

/// Twist and pressure give one torque, but for what shear does to the pressure.
Checks check_bent_levels() {
  Problem problem;
  problem.contact = {{10e-3, 6e-3, 0}, {thickness_m, youngs_modulus_Pa, 0.49}, {0.3, 0.5}};
  problem.fingertip.pad = meshes::ellipsoid_pad(10e-3, 6e-3);
  problem.fingertip.object = meshes::plane_object();
  problem.fingertip.symmetric_object = true;
  problem.friction.torsion = true;
  problem.friction.limit_surface = 6;
  const Result result = solve_quietly(problem);
  const std::string name = "curved layer, h/R 1/4, nu 0.49, ellipsoid on a plane";
  // Measured on flat layers to 0.5 %; nearly incompressible ones have less.
  constexpr double coupling = 5e-3;
  Checks checks{stated_check(friction_group, name, "full slip / int mu p r dA", 1,
                             result.torsion->full_slip_Nm / result.finest.max_torque_Nm,
                             result.torsion->full_slip_error + result.error.max_torque, coupling,
                             "shear moves the pressure")};
  double largest = 0;
  for (const LimitPoint& point : result.limit_surface)
    largest = std::max(largest, std::hypot(point.wrench.force_x_N, point.wrench.force_y_N) /
                                    force_limit_N(problem));
  Check bound{friction_group, name, "largest tangential force / (mu P)", 1, largest};
  bound.expected = 1 + result.limit_surface_error;
  bound.relation = Relation::at_most;
  bound.reason = "Coulomb's law";
  checks.push_back(bound);
  return checks;
}

}  // namespace

Checks check_friction(bool quick) {
  Checks checks;
  const auto add = [&](const Checks& more) {
    checks.insert(checks.end(), more.begin(), more.end());
  };
  for (const LayerTwist& layer : layer_twists())
    if (!quick || (layer.nu == 0.45 && layer.s == 1)) add(check_layer_twist(layer));
  if (quick) return checks;
  add(check_lubkin(0.3));
  add(check_stuck_disc(0.1, 1.0000950508463733));
  add(check_stuck_disc(1, 1.0615525859023598));
  add(check_stuck_disc(2, 1.2581477238046626));
  add(check_stuck_disc(20, 6.427368756960895));
  add(check_stuck_ellipse(1.5));
  add(check_stuck_ellipse(4));
  add(check_limit_surface(1));
  add(check_limit_surface(2));
  add(check_mindlin());
  add(check_bent_half_space());
  add(check_bent_slightly());
  add(check_bent_levels());
  return checks;
}

}  // namespace softfinger::fem::verification
