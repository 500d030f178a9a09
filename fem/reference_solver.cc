#include "fem/reference_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "fem/friction_levels.h"
#include "fem/layer_model.h"
#include "fem/memory.h"
#include "fem/pressing.h"
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
  const FrictionRequest& friction = problem.friction;
  if (problem.fingertip && (friction.any() || !problem.compliance_file.empty()))
    throw InputError(problem.name, "torsion, limit surface or compliance", "",
                     "geometry = \"flat\"; on a curved layer the torque is int mu p r dA");
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

PressedContact pressed_contact(const Pressed& pressed, const LevelResult& measured,
                               const Problem& problem) {
  const double h = problem.contact.layer.thickness_m;
  return {*pressed.model,
          pressed.gap,
          pressed.contact.force,
          measured.a_m / h,
          measured.b_m / h,
          pressed.load(),
          problem.contact.load.friction_coefficient};
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
/// order, plus what refinement of the contact does not show (`fem/README.md` has the measurements).
struct ErrorModel {
  double order;
  double common;
};
// Approach and torque are integrals: observed order 2 to 3. In common: the mesh away from the
// contact.
constexpr ErrorModel integral_error{1.6, 1e-4};
// The edge is found to a fraction of a cell: observed order 1 to 2, not always of one sign. In
// common: the shape that is fitted to the pressure.
constexpr ErrorModel edge_error{1.0, 1e-3};
constexpr ErrorModel peak_error{1.0, 2e-3};

double stated_error(double coarse, double fine, double refinement, const ErrorModel& model) {
  return std::abs(coarse / fine - 1) / (std::pow(refinement, model.order) - 1) + model.common;
}

/// What a, b lose where cells are not small against the thickness: the pressure falls to its edge
/// within about h, and both levels may miss that. Measured on thin layers: 0.3 % at cells of 0.8 h,
/// b = 20 h.
double unresolved_edge(const LevelResult& fine, double thickness_m) {
  const double b = fine.b_m / thickness_m, cell = b / fine.elements_per_semi_axis;
  return 0.2 * cell * cell * cell / b;
}

RelativeError estimate_error(const LevelResult& coarse, const LevelResult& fine,
                             double thickness_m) {
  const double refinement =
      static_cast<double>(fine.elements_per_semi_axis) / coarse.elements_per_semi_axis;
  const auto error = [&](double LevelResult::*quantity, const ErrorModel& model) {
    return stated_error(coarse.*quantity, fine.*quantity, refinement, model);
  };
  const double edge = unresolved_edge(fine, thickness_m);
  RelativeError result;
  result.a = error(&LevelResult::a_m, edge_error) + edge;
  result.b = error(&LevelResult::b_m, edge_error) + edge;
  result.area =
      stated_error(coarse.a_m * coarse.b_m, fine.a_m * fine.b_m, refinement, edge_error) + 2 * edge;
  result.peak_pressure = error(&LevelResult::peak_pressure_Pa, peak_error);
  result.indentation = error(&LevelResult::indentation_m, integral_error);
  result.load = error(&LevelResult::load_N, integral_error);
  result.max_torque = error(&LevelResult::max_torque_Nm, integral_error);
  return result;
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

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

Result solve(const Problem& problem, const Progress& progress, const StopRequested& stop,
             ModelCache* cache) {
  check(problem);
  ModelCache none(0);
  ModelCache& models = cache ? *cache : none;
  const Stopwatch total;
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
  // The pressure is condensed, which takes a finite bulk modulus. What that changes at nu = 1/2 is
  // of the order of (ab/h²) 1e-8 (measured: 2e-5 in d at a/h = 20).
  pressing.poisson_ratio = std::min(layer.poisson_ratio, 0.5 - 1e-8);
  pressing.thickness_m = h;
  if (problem.fingertip) {
    pressing.fingertip = problem.fingertip;
    pressing.bent = shape_fingertip(problem.fingertip, h);
  }

  const auto sensible = [&](const Pressed& pressed) {
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
  };

  // Coarse meshes until mesh and contact agree in size.
  LayerDiscretisation mesh = first_guess(pressing);
  mesh.b = rounded(std::clamp(mesh.b, 1e-4, 60.0));
  mesh.a = rounded(std::clamp(mesh.a, mesh.b, 300.0));
  constexpr int limit = 15;
  Pressed pressed;
  for (int attempt = 1;; ++attempt) {
    choose_elements(mesh, 0);
    check_reach(mesh, problem);
    pressed.model.reset();
    pressed = press_on(mesh, pressing, models);
    sensible(pressed);
    const double change = std::max(std::abs(std::log(pressed.moment_a / mesh.a)),
                                   std::abs(std::log(pressed.moment_b / mesh.b)));
    progress("mesh " + std::to_string(attempt) + text(": a/h %.4g", pressed.moment_a) +
             text(", b/h %.4g", pressed.moment_b) + ", unknowns " +
             std::to_string(pressed.model->unknowns()) +
             (pressed.reaches_rim ? ", contact at the rim" : ""));
    if (!pressed.reaches_rim && change < 0.08) break;
    if (attempt == limit)
      throw ConvergenceError("size of the refined patch", limit, change,
                             "the contact's size depends on the mesh; is the contact elliptic?");
    if (stop()) throw Interrupted();
    // At the rim the moments only bound the contact from below.
    const double growth = pressed.reaches_rim ? 1.3 : 1.0;
    mesh.a = rounded(growth * pressed.moment_a);
    mesh.b = rounded(growth * pressed.moment_b);
  }
  const auto fit_mesh_to = [&](const ContactShape& shape) {
    mesh.a = rounded(shape.block_a);
    mesh.b = rounded(shape.block_b);
  };
  const Measured first = measure(pressed, pressing, problem, 0);
  const LevelResult& trial = first.result;
  const FrictionRequest& friction_request = problem.friction;
  const double axis = std::hypot(friction_request.twist_axis_x_m / trial.a_m,
                                 friction_request.twist_axis_y_m / trial.b_m);
  if (!(axis < 1))
    throw InputError(problem.name, "twist_axis_m",
                     text("%.4g", friction_request.twist_axis_x_m) +
                         text(", %.4g", friction_request.twist_axis_y_m),
                     "a point of the contact, whose semi-axes are " + text("%.4g", trial.a_m) +
                         text(" and %.4g m", trial.b_m));
  fit_mesh_to(first.shape);

  // The contact's edge lies on cell edges along both axes: it does so on every level, which makes
  // them comparable.
  Result result;
  SurfaceSeries surface_series(problem);
  std::optional<FrictionPlan> plan;
  std::vector<FrictionOfLevel> friction;
  for (int level = problem.level - 1; level <= problem.level; ++level) {
    if (stop()) {
      if (result.levels.empty()) throw Interrupted();
      result.interrupted = true;
      progress("stopped: the answer is that of level " + std::to_string(level - 1));
      break;
    }
    const Stopwatch watch;
    if (level > 0) {  // level 0 is the last of the trial meshes
      choose_elements(mesh, level);
      progress("level " + std::to_string(level) + ": " +
               std::to_string(mesh.elements_per_semi_axis) + " elements per semi-axis" +
               time_to_go(result.levels, mesh.elements_per_semi_axis));
      check_reach(mesh, problem);
      pressed.model.reset();  // before the next one takes its memory
      pressed = press_on(mesh, pressing, models);
      if (pressed.reaches_rim)
        throw ConvergenceError("size of the refined patch", level, pressed.moment_a / mesh.a,
                               "the contact outgrew the patch on refinement");
    }
    const Measured measurement = measure(pressed, pressing, problem, level);
    LevelResult measured = measurement.result;
    if (problem.friction.any()) {
      friction.push_back(friction_on(pressed_contact(pressed, measured, problem), problem, plan,
                                     progress, surface_series.of(level)));
    }
    measured.wall_s = watch.seconds();
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
  if (result.levels.size() == 1) result.levels.insert(result.levels.begin(), trial);
  const LevelResult &coarse = result.levels.front(), &fine = result.levels.back();
  result.finest = fine;
  result.error = estimate_error(coarse, fine, h);
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
    const PressedContact start = pressed_contact(pressed, fine, problem);
    write_compliance(
        problem.compliance_file,
        surface_compliance(friction_compliances(start, Invariance::none), Invariance::none), h,
        layer.youngs_modulus_Pa, layer.poisson_ratio);
  }
  result.wall_s = total.seconds();
  result.peak_memory_MB = peak_memory_MB();
  return result;
}

}  // namespace softfinger::fem
