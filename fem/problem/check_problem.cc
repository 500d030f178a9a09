#include "fem/problem/check_problem.h"

#include <cmath>

#include "fem/base/formatted.h"

namespace softfinger::fem {
namespace {

/// Longer contacts are nearly lines, which a plane model answers better.
constexpr double largest_ratio_of_radii = 100;
/// Thinnest sublayer, over the layer's thickness. In a thinner one the elements could not be as
/// small as the sublayer is thin everywhere under the contact.
constexpr double thinnest_sublayer = 0.02;
/// Values that are given twice differ by the round-off of a change of units only.
constexpr double agreement = 1e-9;
/// Largest ratio of two layers' thicknesses. The contact lies between the sizes, over each of them,
/// for which layers are verified.
constexpr double most_unlike_layers = 100;

bool agree(double one, double other) { return std::abs(one / other - 1) < agreement; }

void require_positive(const Problem& problem, double value, const char* field) {
  if (!(value > 0) || !std::isfinite(value))
    throw InputError(problem.name, field, value, "> 0 and finite");
}

void require_range(const Problem& problem, int value, int least, int largest, const char* field,
                   const char* unit = "") {
  if (value < least || value > largest)
    throw InputError(problem.name, field, value, formatted("%d to %d%s", least, largest, unit));
}

void check_material(const Problem& problem, const ElasticLayer& layer, const std::string& owner) {
  require_positive(problem, layer.thickness_m, (owner + "thickness_m").c_str());
  require_positive(problem, layer.youngs_modulus_Pa, (owner + "youngs_modulus_Pa").c_str());
  if (!(layer.poisson_ratio >= 0 && layer.poisson_ratio <= 0.5))
    throw InputError(problem.name, owner + "poisson_ratio", formatted("%.9g", layer.poisson_ratio),
                     "0 <= nu <= 1/2");
}

void check_load(const Problem& problem) {
  if (problem.approach_m != 0)
    require_positive(problem, problem.approach_m, "approach_m");
  else
    require_positive(problem, problem.contact.load.normal_force_N, "load_N");
  // Far below the load of the smallest contact that is meshed, b/h 1e-4.
  constexpr double least = 1e-20;
  const ElasticLayer& layer = problem.contact.layer;
  const double unit_N = layer.youngs_modulus_Pa * layer.thickness_m * layer.thickness_m;
  if (problem.approach_m == 0 && problem.contact.load.normal_force_N < least * unit_N)
    throw InputError(
        problem.name, "load_N", problem.contact.load.normal_force_N,
        formatted("more: at least %.2g N for finite elements of this layer", least * unit_N));
  const ShearLaw law = problem.friction_law();
  if (law.has_friction_coefficient())
    require_positive(problem, law.friction_coefficient, "friction_coefficient");
  if (law.has_shear_strength())
    require_positive(problem, law.shear_strength_Pa, "shear_strength_Pa");
  if (problem.pressing == PressingFriction::none) return;
  if (law.kind != ShearLaw::Kind::coulomb)
    throw InputError(problem.name, "pressing", name_of(problem.pressing),
                     formatted("\"frictionless\" where the shear law is \"%s\"", law.name()));
}

void check_times(const Problem& problem) {
  if (!problem.in_time) return;
  const PressedInTime& pressed = *problem.in_time;
  const auto refuse = [&](const char* field, const std::string& value, const char* allowed) {
    throw InputError(problem.name, field, value, allowed);
  };
  if (problem.pressing != PressingFriction::none)
    refuse("pressing", name_of(problem.pressing), "\"frictionless\" over time");
  if (problem.friction.any()) refuse("friction", "", "none over time but the largest torque");
  if (problem.finite_strain) refuse("kinematics", "\"finite\"", "\"linear\" over time");
  if (!problem.sublayers.empty() || problem.contact.has_object_layer())
    refuse("layer", "of several", "one layer that relaxes: several have no common modulus");
  double lost = 0;
  for (const PressedInTime::Term& term : pressed.terms) {
    require_positive(problem, term.share, "relaxation share");
    require_positive(problem, term.time_s, "relaxation time_s");
    lost += term.share;
  }
  if (!(lost < 1)) refuse("relaxation shares", formatted("%.9g in sum", lost), "less than 1");
  if (pressed.points.empty()) refuse("history", "empty", "a load or an approach over time");
  for (std::size_t i = 0; i < pressed.points.size(); ++i) {
    const PressedInTime::Point& point = pressed.points[i];
    if (!(point.value >= 0) || !std::isfinite(point.value))
      refuse("history", formatted("%g", point.value), "finite values >= 0");
    if (!std::isfinite(point.time_s) || (i > 0 && point.time_s < pressed.points[i - 1].time_s))
      refuse("history time_s", formatted("%g", point.time_s), "finite times that do not fall");
  }
  if (!(pressed.time_s >= pressed.points.front().time_s))
    refuse("time_s", formatted("%g", pressed.time_s), "not before the history begins");
  if (!(value_at(pressed, pressed.time_s) > 0))
    refuse("time_s", formatted("%g", pressed.time_s), "a time at which something is pressed");
}

void check_radii(const Problem& problem) {
  const RelativeRadii& radii = problem.contact.radii;
  require_positive(problem, radii.major_m, "R'");
  require_positive(problem, radii.minor_m, "R''");
  if (radii.major_m < radii.minor_m)
    throw InputError(problem.name, "R'", radii.major_m, "R' >= R''");
  const double ratio = radii.major_m / radii.minor_m;
  // A scan's contact ends where it ends: its radii are but the first guess.
  if (!problem.fingertip.scan && ratio > largest_ratio_of_radii * (1 + agreement))
    throw InputError(problem.name, "R'/R''", ratio,
                     formatted("at most %g for finite elements; longer contacts need a plane model",
                               largest_ratio_of_radii));
  if (std::isfinite(problem.sphere_radius_m) && !(agree(problem.sphere_radius_m, radii.major_m) &&
                                                  agree(problem.sphere_radius_m, radii.minor_m)))
    throw InputError(
        problem.name, "sphere_radius_m", formatted("%g", problem.sphere_radius_m),
        "the relative radii's own value, both of them (an exact sphere on a flat layer)");
}

void check_sublayers(const Problem& problem) {
  if (problem.sublayers.empty()) return;
  const double thickness_m = problem.contact.layer.thickness_m;
  double depth_m = 0;
  for (const Sublayer& sublayer : problem.sublayers) {
    check_material(problem, sublayer.layer, "sublayer's ");
    if (sublayer.layer.thickness_m < thinnest_sublayer * thickness_m)
      throw InputError(problem.name, "sublayer's thickness_m",
                       formatted("%g", sublayer.layer.thickness_m),
                       formatted("at least %g %% of all of them, %g", 100 * thinnest_sublayer,
                                 thinnest_sublayer * thickness_m));
    depth_m += sublayer.layer.thickness_m;
  }
  if (std::abs(depth_m / thickness_m - 1) > agreement)
    throw InputError(problem.name, "sublayers' thickness_m", formatted("%.9g in sum", depth_m),
                     formatted("the layer's, %.9g", thickness_m));
}

/// A layer on the object, too, is solved in linear elasticity, where both are flat.
void check_object_layer(const Problem& problem) {
  if (!problem.contact.has_object_layer()) return;
  const ElasticLayer& layer = problem.contact.object_layer;
  check_material(problem, layer, "object layer's ");
  const double ratio = layer.thickness_m / problem.contact.layer.thickness_m;
  if (ratio > most_unlike_layers || 1 / ratio > most_unlike_layers)
    throw InputError(
        problem.name, "object layer's thickness_m", formatted("%g", layer.thickness_m),
        formatted("%g times as thick as the finger's at most, or as thin", most_unlike_layers));
  const auto refuse = [&](const char* field, const char* value, const char* allowed) {
    throw InputError(problem.name, field, value, allowed);
  };
  if (problem.finite_strain)
    refuse("kinematics", "finite", "\"linear\" where the object has a layer too");
  if (problem.fingertip || problem.mesh)
    refuse("geometry", "curved", "\"flat\" where the object has a layer too");
  if (std::isfinite(problem.sphere_radius_m))
    refuse("sphere_radius_m", formatted("%g", problem.sphere_radius_m).c_str(),
           "none where the object has a layer too: the gap is that of the relative radii");
  if (!problem.compliance_file.empty())
    refuse("compliance_file", problem.compliance_file.c_str(), "one layer");
}

void check_geometry(const Problem& problem) {
  if (problem.fingertip && problem.mesh)
    throw InputError(problem.name, "mesh of the layer", problem.mesh_name,
                     "a mesh or a curved finger, not both");
}

void check_compliance_file(const Problem& problem) {
  if (problem.compliance_file.empty()) return;
  const auto refuse = [&](const char* allowed) {
    throw InputError(problem.name, "compliance_file", problem.compliance_file, allowed);
  };
  if (!problem.sublayers.empty()) refuse("a homogeneous layer: the file's head has one E and nu");
  if (problem.fingertip || problem.mesh)
    refuse("geometry = \"flat\": a curved layer's compliance has other normals at each point");
  if (problem.finite_strain) refuse("none with finite strain, where it changes with the load");
}

void check_friction(const Problem& problem) {
  const FrictionRequest& friction = problem.friction;
  if (friction.torsion) require_range(problem, friction.increments, 1, 1000, "torsion_increments");
  require_range(problem, friction.limit_surface, 0, 10000, "limit_surface", " points");
  require_range(problem, friction.increments_to_slip, 0, 1000, "increments_to_slip");
}

/// Refuses requests that the finite-strain solver cannot serve.
void check_finite_strain(const Problem& problem) {
  if (problem.approach_m >= problem.contact.layer.thickness_m)
    throw InputError(problem.name, "approach_m", problem.approach_m,
                     "less than the layer's thickness, which would be pressed through");
}

}  // namespace

void check_problem(const Problem& problem) {
  check_radii(problem);
  check_material(problem, problem.contact.layer, "");
  check_load(problem);
  check_times(problem);
  check_geometry(problem);
  check_object_layer(problem);
  check_sublayers(problem);
  check_compliance_file(problem);
  check_friction(problem);
  require_range(problem, problem.level, 1, 4, "level");
  if (problem.finite_strain) check_finite_strain(problem);
}

InputError too_much(const Problem& problem, const std::string& allowed) {
  if (problem.approach_m > 0) return {problem.name, "approach_m", problem.approach_m, allowed};
  return {problem.name, "load_N", formatted("%g", problem.contact.load.normal_force_N), allowed};
}

void check_twist_axis(const Problem& problem, const LevelResult& contact) {
  const FrictionRequest& request = problem.friction;
  const double axis =
      std::hypot(request.twist_axis_x_m / contact.a_m, request.twist_axis_y_m / contact.b_m);
  if (axis < 1) return;
  throw InputError(problem.name, "twist_axis_m",
                   formatted("%.4g, %.4g", request.twist_axis_x_m, request.twist_axis_y_m),
                   formatted("a point of the contact, whose semi-axes are %.4g and %.4g m",
                             contact.a_m, contact.b_m));
}

}  // namespace softfinger::fem
