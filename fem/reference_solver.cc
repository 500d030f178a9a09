#include "fem/reference_solver.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>

#include "fem/cholesky.h"
#include "fem/finite/finite_solver.h"
#include "fem/friction_levels.h"
#include "fem/layer_model.h"
#include "fem/memory.h"
#include "fem/model_cache.h"
#include "fem/pressing.h"
#include "fem/stopwatch.h"
#include "fem/surface_series.h"
#include "fem/write_compliance.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

/// What the contact is pressed by, for messages.
const char* driver(const Problem& problem) {
  return problem.approach_m > 0 ? "approach_m" : "load_N";
}

std::string driver_value(const Problem& problem) {
  return text("%g",
              problem.approach_m > 0 ? problem.approach_m : problem.contact.load.normal_force_N);
}

void check(const Problem& problem) {
  const auto positive = [&](double value, const char* field) {
    if (!(value > 0) || !std::isfinite(value))
      throw InputError(problem.name, field, text("%g", value), "> 0 and finite");
  };
  const RelativeRadii& radii = problem.contact.radii;
  const ElasticLayer& layer = problem.contact.layer;
  const ContactLoad& load = problem.contact.load;
  positive(radii.major_m, "R'");
  positive(radii.minor_m, "R''");
  positive(layer.thickness_m, "thickness_m");
  positive(layer.youngs_modulus_Pa, "youngs_modulus_Pa");
  if (problem.approach_m != 0)
    positive(problem.approach_m, "approach_m");
  else
    positive(load.normal_force_N, "load_N");
  positive(load.friction_coefficient, "friction_coefficient");
  if (radii.major_m < radii.minor_m)
    throw InputError(problem.name, "R'", text("%g", radii.major_m), "R' >= R''");
  if (radii.major_m / radii.minor_m > 100 * (1 + 1e-9))
    throw InputError(problem.name, "R'/R''", text("%g", radii.major_m / radii.minor_m),
                     "at most 100 for finite elements; longer contacts need a plane model");
  if (!(layer.poisson_ratio >= 0 && layer.poisson_ratio <= 0.5))
    throw InputError(problem.name, "poisson_ratio", text("%.9g", layer.poisson_ratio),
                     "0 <= nu <= 1/2");
  if (std::isfinite(problem.sphere_radius_m) &&
      !(std::abs(problem.sphere_radius_m / radii.major_m - 1) < 1e-9 &&
        std::abs(problem.sphere_radius_m / radii.minor_m - 1) < 1e-9))
    throw InputError(
        problem.name, "sphere_radius_m", text("%g", problem.sphere_radius_m),
        "the relative radii's own value, both of them (an exact sphere on a flat layer)");
  if (problem.contact.has_object_layer())
    throw InputError(problem.name, "object layer", "", "a rigid object for finite elements");
  double depth_m = 0;
  for (const Sublayer& sublayer : problem.sublayers) {
    positive(sublayer.layer.thickness_m, "sublayer's thickness_m");
    positive(sublayer.layer.youngs_modulus_Pa, "sublayer's youngs_modulus_Pa");
    if (!(sublayer.layer.poisson_ratio >= 0 && sublayer.layer.poisson_ratio <= 0.5))
      throw InputError(problem.name, "sublayer's poisson_ratio",
                       text("%.9g", sublayer.layer.poisson_ratio), "0 <= nu <= 1/2");
    // Elements of a thinner one could not be as small as it is anywhere under the contact.
    constexpr double thinnest = 0.02;
    if (sublayer.layer.thickness_m < thinnest * layer.thickness_m)
      throw InputError(problem.name, "sublayer's thickness_m",
                       text("%g", sublayer.layer.thickness_m),
                       text("at least 2 %% of all of them, %g", thinnest * layer.thickness_m));
    depth_m += sublayer.layer.thickness_m;
  }
  if (!problem.sublayers.empty() && std::abs(depth_m / layer.thickness_m - 1) > 1e-9)
    throw InputError(problem.name, "sublayers' thickness_m", text("%.9g in sum", depth_m),
                     text("the layer's, %.9g", layer.thickness_m));
  if (!problem.sublayers.empty() && !problem.compliance_file.empty())
    throw InputError(problem.name, "compliance_file", problem.compliance_file,
                     "a homogeneous layer: the file's head has one E and nu");
  const FrictionRequest& friction = problem.friction;
  if (problem.fingertip && problem.mesh)
    throw InputError(problem.name, "mesh of the layer", problem.mesh_name,
                     "a mesh or a curved finger, not both");
  if ((problem.fingertip || problem.mesh) && !problem.compliance_file.empty())
    throw InputError(
        problem.name, "compliance_file", problem.compliance_file,
        "geometry = \"flat\": a curved layer's compliance has other normals at each point");
  if (friction.torsion && (friction.increments < 1 || friction.increments > 1000))
    throw InputError(problem.name, "torsion_increments", std::to_string(friction.increments),
                     "1 to 1000");
  if (friction.limit_surface < 0 || friction.limit_surface > 10000)
    throw InputError(problem.name, "limit_surface", std::to_string(friction.limit_surface),
                     "0 to 10000 points");
  if (friction.increments_to_slip < 0 || friction.increments_to_slip > 1000)
    throw InputError(problem.name, "increments_to_slip",
                     std::to_string(friction.increments_to_slip), "0 to 1000");
  if (problem.level < 1 || problem.level > 4)
    throw InputError(problem.name, "level", std::to_string(problem.level), "1 to 4");
}

Profile nodal_profile(const Pressed& pressed, const Problem& problem, bool along_x) {
  std::vector<std::pair<double, double>> points;
  const auto& nodes = pressed.model->nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double along = along_x ? nodes[i].x : nodes[i].y,
                 across = along_x ? nodes[i].y : nodes[i].x;
    if (std::abs(across) > 1e-9) continue;
    points.emplace_back(
        along * problem.contact.layer.thickness_m,
        pressed.pressure(static_cast<Eigen::Index>(i)) * problem.contact.layer.youngs_modulus_Pa);
  }
  std::sort(points.begin(), points.end());
  Profile profile;
  for (const auto& [position, pressure] : points) {
    profile.position_m.push_back(position);
    profile.pressure_Pa.push_back(pressure);
  }
  return profile;
}

/// One mesh's answer, and the shape that the next mesh is made for.
struct Measured {
  LevelResult result;
  ContactShape shape;
};

Measured measure(const Pressed& pressed, const Pressing& pressing, const Problem& problem,
                 int level) {
  const double h = problem.contact.layer.thickness_m, E = problem.contact.layer.youngs_modulus_Pa;
  Measured measured;
  measured.shape = measure_shape(pressed, pressing);
  LevelResult& result = measured.result;
  result.level = level;
  result.elements_per_semi_axis = pressed.model->discretisation().elements_per_semi_axis;
  result.unknowns = pressed.model->unknowns();
  result.active_nodes = pressed.contact.active;
  result.iterations = pressed.contact.iterations;
  result.a_m = measured.shape.a * h;
  result.b_m = measured.shape.b * h;
  result.area_m2 = M_PI * result.a_m * result.b_m;
  result.turn_rad = measured.shape.turn_rad;
  result.indentation_m = pressed.contact.approach * h;
  result.peak_pressure_Pa = measured.shape.peak * E;
  result.load_N =
      problem.approach_m > 0 ? pressed.load() * E * h * h : problem.contact.load.normal_force_N;
  result.max_torque_Nm =
      problem.contact.load.friction_coefficient * result.load_N * pressed.torque_arm() * h;
  result.load_residual = pressed.contact.load_residual;
  result.complementarity_residual = pressed.contact.complementarity_residual;
  result.fit_residual = measured.shape.fit_residual;
  return measured;
}

PressedContact pressed_contact(const Pressed& pressed, const ContactShape& shape,
                               const Problem& problem) {
  PressedContact contact{*pressed.model,
                         pressed.gap,
                         pressed.contact.force,
                         shape.block_a,
                         shape.block_b,
                         pressed.load(),
                         problem.contact.load.friction_coefficient};
  if (pressed.model->whole()) {
    const auto& nodes = pressed.model->nodes();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (contact.force[static_cast<Eigen::Index>(i)] > 0)
        contact.edge =
            std::max(contact.edge, std::hypot(nodes[i].x / contact.a, nodes[i].y / contact.b));
  }
  return contact;
}

/// To one part in a thousand, so that contacts of one size ask for the very same mesh: far below a
/// cell, which is what the edge has to meet.
double rounded(double semi_axis) {
  constexpr double step = 1e-3;
  return std::exp(step * std::round(std::log(semi_axis) / step));
}

/// A bent layer's map ends somewhere: the patch and a cell beside it have to fit.
void check_reach(const LayerDiscretisation& mesh, const Problem& problem) {
  const double h = problem.contact.layer.thickness_m;
  const double needed_x = mesh.patch * mesh.a + mesh.a / mesh.elements_along_a();
  const double needed_y = mesh.patch * mesh.b + mesh.b / mesh.elements_per_semi_axis;
  if (needed_x < 0.98 * mesh.reach_x && needed_y < 0.98 * mesh.reach_y) return;
  throw InputError(problem.name, driver(problem), driver_value(problem),
                   "less, or a larger pad: the contact needs the finger's surface up to " +
                       text("%.3g", 1e3 * h * needed_x) + text(" x %.3g mm", 1e3 * h * needed_y) +
                       " from the contact point, and a layer fits on it up to " +
                       text("%.3g", 1e3 * h * mesh.reach_x) +
                       text(" x %.3g mm", 1e3 * h * mesh.reach_y));
}

/// What is stated for the finer of two meshes: their difference, extrapolated with a cautious
/// order, plus what their difference does not show (`fem/README.md` has the measurements).
struct ErrorModel {
  double order;
  double common;  ///< on every mesh
  double across;  ///< where the edge lies across cells of an eighth of the semi-axis
};
// Approach and torque are integrals: observed order 2 to 3. In common: the mesh away from the
// contact.
constexpr ErrorModel integral_error{1.6, 1e-4, 2e-4};
// The edge is found to a fraction of a cell: observed order 1 to 2, not always of one sign. In
// common: the shape that is fitted to the pressure.
constexpr ErrorModel edge_error{1.0, 1e-3, 1.5e-3};
constexpr ErrorModel peak_error{1.0, 2e-3, 2e-3};

/// Relative: a cell is an eighth of the contact, and meshes are made for sizes rounded to 0.1 %.
constexpr double edge_on_cells = 2e-3;

/// Cells that the contact's edge crosses, against an eighth of the semi-axis, squared: to the
/// second order they are missed. 0 on the contact's own mesh.
double crossed_cells(const LevelResult& level) {
  if (std::abs(std::log(level.oversize)) <= edge_on_cells) return 0;
  const double cell = 8 * level.oversize / level.elements_per_semi_axis;
  return cell * cell;
}

double stated_error(double coarse, double fine, double refinement, double crossed,
                    const ErrorModel& model) {
  return std::abs(coarse / fine - 1) / (std::pow(refinement, model.order) - 1) + model.common +
         model.across * crossed;
}

/// What a, b lose where cells are not small against the thickness: the pressure falls to its edge
/// within about h, and both levels may miss that. Measured on thin layers: 0.3 % at cells of 0.8 h,
/// b = 20 h.
double unresolved_edge(const LevelResult& fine, double thickness_m) {
  const double b = fine.b_m / thickness_m;
  const double cell = fine.oversize * b / fine.elements_per_semi_axis;
  return 0.2 * cell * cell * cell / b;
}

/// What the approach of a long contact, small against the thickness, loses in the cells away from
/// it, which both levels share. Measured against a spectral solver on 297 contacts, R'/R'' 2 to 10,
/// s = sqrt(ab)/h 0.06 to 8: 0.08 % at s = 0.06, 0.04 % at 0.17; circular ones, whose cells are
/// cubes, lose 0.02 %.
double cells_away(const LevelResult& fine, double thickness_m) {
  const double s = std::sqrt(fine.a_m * fine.b_m) / thickness_m;
  return fine.a_m > 1.02 * fine.b_m ? 6e-4 * std::min(1.0, 0.1 / s) : 0;
}

RelativeError estimate_error(const LevelResult& coarse, const LevelResult& fine,
                             double thickness_m) {
  const double refinement =
      static_cast<double>(fine.elements_per_semi_axis) / coarse.elements_per_semi_axis;
  const double crossed = crossed_cells(fine);
  const auto error = [&](double LevelResult::*quantity, const ErrorModel& model) {
    return stated_error(coarse.*quantity, fine.*quantity, refinement, crossed, model);
  };
  const double edge = unresolved_edge(fine, thickness_m);
  RelativeError result;
  result.a = error(&LevelResult::a_m, edge_error) + edge;
  result.b = error(&LevelResult::b_m, edge_error) + edge;
  result.area =
      stated_error(coarse.a_m * coarse.b_m, fine.a_m * fine.b_m, refinement, crossed, edge_error) +
      2 * edge;
  result.peak_pressure = error(&LevelResult::peak_pressure_Pa, peak_error);
  result.indentation =
      error(&LevelResult::indentation_m, integral_error) + cells_away(fine, thickness_m);
  result.load = error(&LevelResult::load_N, integral_error);
  result.max_torque = error(&LevelResult::max_torque_Nm, integral_error);
  return result;
}

/// Whether an answer on a larger contact's meshes is worth having: a and b known to an eighth of
/// the cells that the contact would have on its own, approach and torque five times as well.
bool is_useful(const RelativeError& error, const LevelResult& fine, double thickness_m) {
  LayerDiscretisation own;
  own.a = fine.a_m / thickness_m;
  own.b = fine.b_m / thickness_m;
  choose_elements(own, fine.level);
  const double known = 1.0 / (8 * own.elements_per_semi_axis);
  return std::max(error.a, error.b) <= known &&
         std::max(error.indentation, error.max_torque) <= known / 5;
}

/// Expected from the level before: cells fourfold, and the factorisation's cost grows a little
/// faster than their number.
std::string time_to_go(const std::vector<LevelResult>& done, int elements) {
  if (done.empty()) return "";
  constexpr double order = 2.5;
  return text(
      ", about %.2g s to go",
      done.back().wall_s *
          std::pow(static_cast<double>(elements) / done.back().elements_per_semi_axis, order));
}

/// The problem in the units of its layer.
void set_sublayers(const Problem& problem, Pressing& pressing) {
  // The pressure is condensed, which takes a finite bulk modulus. What that changes at nu = 1/2 is
  // of the order of (ab/h²) 1e-8 (measured: 2e-5 in d at a/h = 20).
  const auto compressible = [](double poisson_ratio) {
    return std::min(poisson_ratio, 0.5 - 1e-8);
  };
  const ElasticLayer& layer = problem.contact.layer;
  pressing.poisson_ratio = compressible(layer.poisson_ratio);
  double depth_m = 0;
  for (const Sublayer& sublayer : problem.sublayers) {
    pressing.sublayers.push_back({sublayer.layer.youngs_modulus_Pa / layer.youngs_modulus_Pa,
                                  compressible(sublayer.layer.poisson_ratio)});
    if (depth_m > 0) pressing.interfaces.push_back(depth_m / layer.thickness_m);
    depth_m += sublayer.layer.thickness_m;
  }
}

Pressing pressing_of(const Problem& problem) {
  const RelativeRadii& radii = problem.contact.radii;
  const ElasticLayer& layer = problem.contact.layer;
  const double h = layer.thickness_m;
  Pressing pressing;
  pressing.major = radii.major_m / h;
  pressing.minor = radii.minor_m / h;
  pressing.sphere = problem.sphere_radius_m / h;
  if (problem.approach_m > 0)
    pressing.approach = problem.approach_m / h;
  else
    pressing.load = problem.contact.load.normal_force_N / (layer.youngs_modulus_Pa * h * h);
  set_sublayers(problem, pressing);
  pressing.thickness_m = h;
  pressing.mesh = problem.mesh;
  if (problem.fingertip) {
    pressing.fingertip = problem.fingertip;
    pressing.bent = shape_fingertip(problem.fingertip, h);
  }
  return pressing;
}

void check_sensible(const Pressed& pressed, const Pressing& pressing, const Problem& problem) {
  if (pressed.contact.approach >= 1)
    throw InputError(problem.name, driver(problem), driver_value(problem),
                     "less: the approach reaches the layer's thickness (" +
                         text("%.3g", pressed.contact.approach) +
                         " times it), far outside linear elasticity");
  if (pressed.moment_b > 50 || pressed.moment_a > 300 || pressed.moment_b < 1e-4)
    throw InputError(problem.name, "contact",
                     text("b/h %.3g", pressed.moment_b) + text(", a/h %.3g", pressed.moment_a),
                     "semi-axes b/h from 1e-4 to 50, a/h to 300 for finite elements");
  if (std::isfinite(pressing.sphere) && pressed.moment_a > 0.95 * pressing.sphere)
    throw InputError(problem.name, driver(problem), driver_value(problem),
                     "less: the contact is as wide as the sphere");
}

void check_twist_axis(const Problem& problem, const LevelResult& trial) {
  const FrictionRequest& request = problem.friction;
  const double axis =
      std::hypot(request.twist_axis_x_m / trial.a_m, request.twist_axis_y_m / trial.b_m);
  if (axis < 1) return;
  throw InputError(problem.name, "twist_axis_m",
                   text("%.4g", request.twist_axis_x_m) + text(", %.4g", request.twist_axis_y_m),
                   "a point of the contact, whose semi-axes are " + text("%.4g", trial.a_m) +
                       text(" and %.4g m", trial.b_m));
}

/// Coarse meshes until mesh and contact agree in size.
Pressed find_size(const Pressing& pressing, const Problem& problem, const Progress& progress,
                  const StopRequested& stop) {
  LayerDiscretisation mesh = first_guess(pressing);
  mesh.b = rounded(std::clamp(mesh.b, 1e-4, 60.0));
  mesh.a = rounded(std::clamp(mesh.a, mesh.b, 300.0));
  constexpr int limit = 15;
  for (int attempt = 1;; ++attempt) {
    choose_elements(mesh, 0);
    check_reach(mesh, problem);
    Pressed pressed = press_on(make_layer(mesh, pressing), pressing);
    check_sensible(pressed, pressing, problem);
    const double change = std::max(std::abs(std::log(pressed.moment_a / mesh.a)),
                                   std::abs(std::log(pressed.moment_b / mesh.b)));
    progress("mesh " + std::to_string(attempt) + text(": a/h %.4g", pressed.moment_a) +
             text(", b/h %.4g", pressed.moment_b) + ", unknowns " +
             std::to_string(pressed.model->unknowns()) +
             (pressed.reaches_rim ? ", contact at the rim" : ""));
    if (!pressed.reaches_rim && change < 0.08) return pressed;
    if (attempt == limit)
      throw ConvergenceError("size of the refined patch", limit, change,
                             "the contact's size depends on the mesh; is the contact elliptic?");
    if (stop()) throw Interrupted();
    // At the rim the moments only bound the contact from below.
    const double growth = pressed.reaches_rim ? 1.3 : 1.0;
    mesh.a = rounded(growth * pressed.moment_a);
    mesh.b = rounded(growth * pressed.moment_b);
  }
}

/// Of a contact, relative to another one.
double oversize(const std::array<double, 2>& contact, const ContactShape& other) {
  return std::max(contact[0] / other.block_a, contact[1] / other.block_b);
}

/// Of a larger contact's mesh, against those that a contact would have on its own: with these, a
/// and b are still found to 0.9 % on level 2, d and torque to 0.1 %.
constexpr double largest_cells = 1.6;

/// Meshes of an earlier contact of the run that suit this one; no models where there are none.
MeshPair suitable_meshes(const ModelCache& models, const LayerIdentity& layer,
                         const Pressing& pressing, const Problem& problem) {
  for (const MeshPair& meshes : models.of(layer)) {
    const Pressed pressed = press_on(meshes.models.front(), pressing);
    if (pressed.reaches_rim) continue;
    ContactShape shape;
    try {
      shape = measure_shape(pressed, pressing);
    } catch (const ConvergenceError&) {
      continue;  // far too few cells
    }
    LayerDiscretisation own;
    own.a = shape.block_a;
    own.b = shape.block_b;
    choose_elements(own, layer.level - 1);
    if (oversize(meshes.made_for.front(), shape) * own.elements_per_semi_axis >
        largest_cells * pressed.model->discretisation().elements_per_semi_axis)
      continue;
    // Friction is singular at the contact's edge: stuck tractions want it on cell edges.
    if (problem.friction.any() &&
        (std::abs(std::log(meshes.made_for.front()[0] / shape.block_a)) > edge_on_cells ||
         std::abs(std::log(meshes.made_for.front()[1] / shape.block_b)) > edge_on_cells))
      continue;
    return meshes;
  }
  return {};
}

enum class Meshes { own, any };

Result solve_with(ModelCache& models, Meshes allowed, const Problem& problem,
                  const Progress& progress, const StopRequested& stop) {
  check(problem);
  const Stopwatch total;
  const ElasticLayer& layer = problem.contact.layer;
  const double h = layer.thickness_m;
  const Pressing pressing = pressing_of(problem);
  LayerIdentity identity{pressing.materials(), pressing.interfaces, "", pressing.whole(),
                         problem.level};
  if (problem.mesh) identity.fingertip = problem.mesh_name + text(", h %.17g", h);
  if (problem.fingertip) identity.fingertip = problem.fingertip.pad_name + text(", h %.17g", h);

  if (stop()) throw Interrupted();
  MeshPair meshes;
  if (allowed == Meshes::any) meshes = suitable_meshes(models, identity, pressing, problem);
  const bool reuses = meshes.models.front() != nullptr;
  Pressed pressed = reuses ? press_on(meshes.models.front(), pressing)
                           : find_size(pressing, problem, progress, stop);
  check_sensible(pressed, pressing, problem);
  const Measured first = measure(pressed, pressing, problem, 0);
  check_twist_axis(problem, first.result);
  LayerDiscretisation mesh = pressed.model->discretisation();
  const auto fit_mesh_to = [&](const ContactShape& shape) {
    mesh.a = rounded(shape.block_a);
    mesh.b = rounded(shape.block_b);
  };
  fit_mesh_to(first.shape);
  if (reuses)
    progress("meshes of an earlier contact, " +
             text("%.3g times as large", oversize(meshes.made_for.front(), first.shape)));

  // On meshes of its own the contact's edge lies on cell edges along both axes: it does so on every
  // level, which makes them comparable.
  Result result;
  SurfaceSeries surface_series(problem);
  std::optional<FrictionPlan> plan;
  std::vector<FrictionOfLevel> friction;
  ContactShape finest_shape;
  for (const int i : {0, 1}) {
    const int level = problem.level - 1 + i;
    if (stop()) {
      // A single level says nothing of its error; the trial mesh may take the coarser one's place.
      if (result.levels.empty() || reuses) throw Interrupted();
      result.interrupted = true;
      progress("stopped: the answer is that of level " + std::to_string(level - 1));
      break;
    }
    const Stopwatch watch;
    auto& model = meshes.models[static_cast<std::size_t>(i)];
    auto& made_for = meshes.made_for[static_cast<std::size_t>(i)];
    if (!model && level == 0) model = pressed.model;
    if (!model) {
      choose_elements(mesh, level);
      // A mesh from outside may be finer than the levels ask for: halved once more, it shows what
      // its cells cost.
      if (problem.mesh && !result.levels.empty())
        mesh.elements_per_semi_axis = 2 * result.levels.back().elements_per_semi_axis;
      progress("level " + std::to_string(level) + ": " +
               std::to_string(mesh.elements_per_semi_axis) + " elements per semi-axis" +
               time_to_go(result.levels, mesh.elements_per_semi_axis));
      check_reach(mesh, problem);
      pressed.model.reset();  // before the next one takes its memory
      if (models.capacity() == 0) meshes.models.front().reset();
      model = make_layer(mesh, pressing);
    }
    pressed = press_on(model, pressing);
    if (pressed.reaches_rim && reuses)
      return solve_with(models, Meshes::own, problem, progress, stop);
    if (pressed.reaches_rim)
      throw ConvergenceError("size of the refined patch", level, pressed.moment_a / mesh.a,
                             "the contact outgrew the patch on refinement");
    const Measured measurement = measure(pressed, pressing, problem, level);
    LevelResult measured = measurement.result;
    finest_shape = measurement.shape;
    if (reuses)
      measured.oversize = oversize(made_for, measurement.shape);
    else
      made_for = {measurement.shape.block_a, measurement.shape.block_b};
    if (problem.friction.any()) {
      KeptCompliances* kept = models.capacity() > 0 ? &meshes.compliances[std::size_t(i)] : nullptr;
      friction.push_back(friction_on(pressed_contact(pressed, measurement.shape, problem), problem,
                                     kept, plan, progress, surface_series.of(level)));
    }
    measured.wall_s = watch.seconds();
    measured.cpu_s = watch.cpu_seconds();
    if (level > 0) fit_mesh_to(measurement.shape);
    progress("level " + std::to_string(level) + ": unknowns " + std::to_string(measured.unknowns) +
             ", contact nodes " + std::to_string(measured.active_nodes) + ", iterations " +
             std::to_string(measured.iterations) + text(", a %.5g mm", 1e3 * measured.a_m) +
             text(", b %.5g mm", 1e3 * measured.b_m) +
             text(", d %.5g mm", 1e3 * measured.indentation_m) +
             text(", torque %.5g mN m", 1e3 * measured.max_torque_Nm) +
             text(", residual %.1g",
                  std::max(measured.load_residual, measured.complementarity_residual)) +
             text(", %.1f s", measured.wall_s) + text(", peak memory %.0f MB", peak_memory_MB()));
    result.levels.push_back(measured);
  }
  // Interrupted after the first level: the trial mesh takes the coarser level's place.
  if (result.levels.size() == 1) result.levels.insert(result.levels.begin(), first.result);
  const LevelResult &coarse = result.levels.front(), &fine = result.levels.back();
  result.finest = fine;
  result.error = estimate_error(coarse, fine, h);
  if (crossed_cells(fine) > 0 && !is_useful(result.error, fine, h)) {
    progress(text("a to %.2g %% only: meshes of its own", 100 * result.error.a));
    return solve_with(models, Meshes::own, problem, progress, stop);
  }
  if (!result.interrupted && models.capacity() > 0) models.keep(identity, meshes);
  (problem.approach_m > 0 ? result.error.indentation : result.error.load) = 0;  // as given
  if (pressing.whole()) {
    // Second moments do not know the edge: their ellipse and the fitted one differ by up to this on
    // symmetric contacts.
    constexpr double of_moments = 0.03;
    result.error.a += of_moments;
    result.error.b += of_moments;
    result.error.area += 2 * of_moments;
  }
  const double refinement =
      static_cast<double>(fine.elements_per_semi_axis) / coarse.elements_per_semi_axis;
  if (friction.size() == 2)
    state_friction(friction.front(), friction.back(), refinement, problem, result);
  // The stuck contact's radius, whose third power is its stiffness, is known to a quarter of a cell
  // where its edge lies across cells, on both meshes alike (measured on a flat layer's: 4 %).
  if (result.torsion && problem.mesh)
    result.torsion->stiffness_error += 0.75 / fine.elements_per_semi_axis;
  result.pressure_exponent = M_PI * result.finest.a_m * result.finest.b_m *
                                 result.finest.peak_pressure_Pa / result.finest.load_N -
                             1;
  result.along_x = nodal_profile(pressed, problem, true);
  result.along_y = nodal_profile(pressed, problem, false);
  if (!problem.output_directory.empty()) {
    result.vtu_file = problem.output_directory + "/solution.vtu";
    pressed.model->write_vtu(result.vtu_file, pressed.normal_force, h, layer.youngs_modulus_Pa);
    result.pvd_file = surface_series.finish();
  }
  if (!problem.compliance_file.empty()) {
    const PressedContact start = pressed_contact(pressed, finest_shape, problem);
    write_compliance(
        problem.compliance_file,
        surface_compliance(friction_compliances(start, Invariance::none), Invariance::none), h,
        layer.youngs_modulus_Pa, layer.poisson_ratio);
  }
  result.wall_s = total.seconds();
  result.cpu_s = total.cpu_seconds();
  result.peak_memory_MB = peak_memory_MB();
  return result;
}

}  // namespace

Result solve(const Problem& problem, const Progress& progress, const StopRequested& stop,
             ModelCache* cache) {
  if (problem.finite_strain) {
    check(problem);
    return finite::solve_finite(problem, pressing_of(problem), progress, stop);
  }
  ModelCache none(0);
  ModelCache& models = cache ? *cache : none;
  try {
    return solve_with(models, Meshes::any, problem, progress, stop);
  } catch (const NotEnoughMemory&) {
    if (models.empty()) throw;
    progress("the meshes of earlier contacts make room");
    models.clear();
    return solve_with(none, Meshes::own, problem, progress, stop);
  }
}

}  // namespace softfinger::fem
