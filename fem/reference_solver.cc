#include "fem/reference_solver.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "fem/friction_levels.h"
#include "fem/layer_model.h"
#include "fem/normal_contact.h"
#include "fem/pressure_ellipse.h"
#include "fem/surface_series.h"
#include "fem/write_compliance.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

/// The problem in units of h and E.
struct Dimensionless {
  double major, minor;  ///< relative radii / h
  double sphere;        ///< radius / h, infinite for a paraboloid
  double load;          ///< P / (E h²)
  double poisson_ratio;

  double gap(double x, double y) const {
    if (!std::isfinite(sphere)) return x * x / (2 * major) + y * y / (2 * minor);
    const double r2 = x * x + y * y;
    // Beside the sphere there is nothing to touch; any height above its equator says so.
    return r2 < sphere * sphere ? r2 / (sphere + std::sqrt(sphere * sphere - r2)) : 10 * sphere;
  }
};

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
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

/// Semi-axes to begin meshing with: half-space and thin-layer stiffness added. It decides how
/// many meshes are tried, never the result.
LayerDiscretisation first_guess(const Dimensionless& problem) {
  const double nu = problem.poisson_ratio, R = std::sqrt(problem.major * problem.minor);
  const double confined = M_PI / 4 * std::pow(1 - nu, 2) / (1 - 2 * nu);  // (pi/4) M / E*
  const double target = problem.load * (1 - nu * nu) * R;                 // P R / (E* h³)
  const auto load = [&](double s) {
    const double thin = 1 / (1 / (confined * s) + 1 / (0.03 * s * s * s));
    return s * s * s * (4.0 / 3 + thin);
  };
  double low = 1e-12, high = 1e12;
  while (high / low > 1.01) {
    const double middle = std::sqrt(low * high);
    (load(middle) < target ? low : high) = middle;
  }
  const double stretch = std::pow(problem.major / problem.minor, 0.3);
  LayerDiscretisation guess;
  guess.a = low * stretch;
  guess.b = low / stretch;
  return guess;
}

/// A contact solved on one mesh.
struct Solved {
  std::unique_ptr<LayerModel> model;
  Eigen::VectorXd gap;
  NormalContact contact;
  double moment_a = 0, moment_b = 0;  ///< semi-axes from second moments, rough but robust
  bool reaches_rim = false;           ///< of the region where contact is possible
};

Solved solve_on(const LayerDiscretisation& discretisation, const Dimensionless& problem) {
  Solved solved;
  solved.model = std::make_unique<LayerModel>(discretisation, problem.poisson_ratio);
  const auto& nodes = solved.model->nodes();
  solved.gap.resize(static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    solved.gap[static_cast<Eigen::Index>(i)] = problem.gap(nodes[i].x, nodes[i].y);
  solved.contact = solve_normal_contact(solved.model->compliance(), solved.gap, problem.load / 4);

  double xx = 0, yy = 0;
  const double spacing_a = 0.5 / discretisation.elements_along_a();
  const double spacing_b = 0.5 / discretisation.elements_per_semi_axis;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double force = solved.contact.force[static_cast<Eigen::Index>(i)];
    if (force <= 0) continue;
    xx += force * nodes[i].x * nodes[i].x;
    yy += force * nodes[i].y * nodes[i].y;
    const double x = nodes[i].x / discretisation.a + spacing_a;
    const double y = nodes[i].y / discretisation.b + spacing_b;
    if (std::hypot(nodes[i].x / discretisation.a, y) > discretisation.patch ||
        std::hypot(x, nodes[i].y / discretisation.b) > discretisation.patch)
      solved.reaches_rim = true;
  }
  // <x²> is a²/5 for a half-space's pressure, a²/6 for a thin compressible layer's.
  const double total = solved.contact.force.sum();
  solved.moment_a = std::sqrt(5.4 * xx / total);
  solved.moment_b = std::sqrt(5.4 * yy / total);
  return solved;
}

double torque_arm(const Solved& solved) {
  double moment = 0;
  const auto& nodes = solved.model->nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i)
    moment +=
        solved.contact.force[static_cast<Eigen::Index>(i)] * std::hypot(nodes[i].x, nodes[i].y);
  return moment / solved.contact.force.sum();
}

Profile nodal_profile(const Solved& solved, const Problem& problem, bool along_x) {
  std::vector<std::pair<double, double>> points;
  const auto& nodes = solved.model->nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double along = along_x ? nodes[i].x : nodes[i].y,
                 across = along_x ? nodes[i].y : nodes[i].x;
    if (std::abs(across) > 1e-9) continue;
    points.emplace_back(along * problem.contact.layer.thickness_m,
                        solved.contact.force[static_cast<Eigen::Index>(i)] / nodes[i].weight *
                            problem.contact.layer.youngs_modulus_Pa);
  }
  std::sort(points.begin(), points.end());
  Profile profile;
  for (const auto& [position, pressure] : points) {
    profile.position_m.push_back(position);
    profile.pressure_Pa.push_back(pressure);
  }
  return profile;
}

LevelResult measure(const Solved& solved, const Problem& problem, int level) {
  const double h = problem.contact.layer.thickness_m, E = problem.contact.layer.youngs_modulus_Pa;
  const PressureEllipse ellipse =
      fit_pressure_ellipse(solved.model->nodes(), solved.model->faces(), solved.contact.force,
                           solved.moment_a, solved.moment_b);
  LevelResult result;
  result.level = level;
  result.elements_per_semi_axis = solved.model->discretisation().elements_per_semi_axis;
  result.unknowns = solved.model->unknowns();
  result.active_nodes = solved.contact.active;
  result.iterations = solved.contact.iterations;
  result.a_m = ellipse.a * h;
  result.b_m = ellipse.b * h;
  result.indentation_m = solved.contact.approach * h;
  result.peak_pressure_Pa = ellipse.peak * E;
  const auto& load = problem.contact.load;
  result.max_torque_Nm = load.friction_coefficient * load.normal_force_N * torque_arm(solved) * h;
  result.load_residual = solved.contact.load_residual;
  result.complementarity_residual = solved.contact.complementarity_residual;
  result.fit_residual = ellipse.residual;
  return result;
}

PressedContact pressed_contact(const Solved& solved, const LevelResult& measured,
                               const Problem& problem, const Dimensionless& dimensionless) {
  const double h = problem.contact.layer.thickness_m;
  return {*solved.model,
          solved.gap,
          solved.contact.force,
          measured.a_m / h,
          measured.b_m / h,
          dimensionless.load,
          problem.contact.load.friction_coefficient};
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
  result.max_torque = error(&LevelResult::max_torque_Nm, integral_error);
  return result;
}

double peak_memory_MB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
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

Result solve(const Problem& problem, const Progress& progress, const StopRequested& stop) {
  check(problem);
  const Stopwatch total;
  const RelativeRadii& radii = problem.contact.radii;
  const ElasticLayer& layer = problem.contact.layer;
  const ContactLoad& load = problem.contact.load;
  const double h = layer.thickness_m;
  const Dimensionless dimensionless{
      radii.major_m / h, radii.minor_m / h, problem.sphere_radius_m / h,
      load.normal_force_N / (layer.youngs_modulus_Pa * h * h), layer.poisson_ratio};

  // Finer in thin layers, where the pressure falls within a thickness of the edge.
  const auto elements = [](int level, double b) {
    const double thin = std::clamp(std::sqrt(b), 1.0, 3.0);
    return static_cast<int>(std::lround((level == 0 ? 3 : 4 << (level - 1)) * thin));
  };
  // Room for the contact to be found a cell larger than it is.
  const auto patch = [](int count) { return std::max(1.25, 1 + 1.2 / count); };
  const auto sensible = [&](const Solved& solved) {
    if (solved.contact.approach >= 1)
      throw InputError(problem.name, "load_N", text("%g", load.normal_force_N),
                       "less: the approach reaches the layer's thickness (" +
                           text("%.3g", solved.contact.approach) +
                           " times it), far outside linear elasticity");
    if (solved.moment_b > 50 || solved.moment_a > 300 || solved.moment_b < 1e-4)
      throw InputError(problem.name, "contact",
                       text("b/h %.3g", solved.moment_b) + text(", a/h %.3g", solved.moment_a),
                       "semi-axes b/h from 1e-4 to 50, a/h to 300 for finite elements");
    if (std::isfinite(dimensionless.sphere) && solved.moment_a > 0.95 * dimensionless.sphere)
      throw InputError(problem.name, "load_N", text("%g", load.normal_force_N),
                       "less: the contact is as wide as the sphere");
  };

  // Coarse meshes until mesh and contact agree in size.
  LayerDiscretisation mesh = first_guess(dimensionless);
  mesh.b = std::clamp(mesh.b, 1e-4, 60.0);
  mesh.a = std::clamp(mesh.a, mesh.b, 300.0);
  constexpr int limit = 15;
  Solved solved;
  for (int attempt = 1;; ++attempt) {
    mesh.elements_per_semi_axis = elements(0, mesh.b);
    mesh.patch = patch(mesh.elements_per_semi_axis);
    solved = solve_on(mesh, dimensionless);
    sensible(solved);
    const double change = std::max(std::abs(std::log(solved.moment_a / mesh.a)),
                                   std::abs(std::log(solved.moment_b / mesh.b)));
    progress("mesh " + std::to_string(attempt) + text(": a/h %.4g", solved.moment_a) +
             text(", b/h %.4g", solved.moment_b) + ", unknowns " +
             std::to_string(solved.model->unknowns()) +
             (solved.reaches_rim ? ", contact at the rim" : ""));
    if (!solved.reaches_rim && change < 0.08) break;
    if (attempt == limit)
      throw ConvergenceError("size of the refined patch", limit, change,
                             "the contact's size depends on the mesh; is the contact elliptic?");
    if (stop()) throw Interrupted();
    // At the rim the moments only bound the contact from below.
    const double growth = solved.reaches_rim ? 1.3 : 1.0;
    mesh.a = growth * solved.moment_a;
    mesh.b = growth * solved.moment_b;
  }
  const auto fit_mesh_to = [&](const LevelResult& measured) {
    mesh.a = measured.a_m / h;
    mesh.b = measured.b_m / h;
  };
  const LevelResult trial = measure(solved, problem, 0);
  const FrictionRequest& friction_request = problem.friction;
  const double axis = std::hypot(friction_request.twist_axis_x_m / trial.a_m,
                                 friction_request.twist_axis_y_m / trial.b_m);
  if (!(axis < 1))
    throw InputError(problem.name, "twist_axis_m",
                     text("%.4g", friction_request.twist_axis_x_m) +
                         text(", %.4g", friction_request.twist_axis_y_m),
                     "a point of the contact, whose semi-axes are " + text("%.4g", trial.a_m) +
                         text(" and %.4g m", trial.b_m));
  fit_mesh_to(trial);

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
      mesh.elements_per_semi_axis = elements(level, mesh.b);
      mesh.patch = patch(mesh.elements_per_semi_axis);
      progress("level " + std::to_string(level) + ": " +
               std::to_string(mesh.elements_per_semi_axis) + " elements per semi-axis");
      solved = solve_on(mesh, dimensionless);
      if (solved.reaches_rim)
        throw ConvergenceError("size of the refined patch", level, solved.moment_a / mesh.a,
                               "the contact outgrew the patch on refinement");
    }
    LevelResult measured = measure(solved, problem, level);
    if (problem.friction.any()) {
      friction.push_back(friction_on(pressed_contact(solved, measured, problem, dimensionless),
                                     problem, plan, progress, surface_series.of(level)));
    }
    measured.wall_s = watch.seconds();
    if (level > 0) fit_mesh_to(measured);
    progress("level " + std::to_string(level) + ": unknowns " + std::to_string(measured.unknowns) +
             ", contact nodes " + std::to_string(measured.active_nodes) + ", iterations " +
             std::to_string(measured.iterations) + text(", a %.5g mm", 1e3 * measured.a_m) +
             text(", b %.5g mm", 1e3 * measured.b_m) +
             text(", d %.5g mm", 1e3 * measured.indentation_m) +
             text(", torque %.5g mN m", 1e3 * measured.max_torque_Nm) +
             text(", %.1f s", measured.wall_s) + text(", peak memory %.0f MB", peak_memory_MB()));
    result.levels.push_back(measured);
  }
  // Interrupted after the first level: the trial mesh takes the coarser level's place.
  if (result.levels.size() == 1) result.levels.insert(result.levels.begin(), trial);
  const LevelResult &coarse = result.levels.front(), &fine = result.levels.back();
  result.finest = fine;
  result.error = estimate_error(coarse, fine, h);
  const double refinement =
      static_cast<double>(fine.elements_per_semi_axis) / coarse.elements_per_semi_axis;
  if (friction.size() == 2)
    state_friction(friction.front(), friction.back(), refinement, problem, result);
  result.pressure_exponent = M_PI * result.finest.a_m * result.finest.b_m *
                                 result.finest.peak_pressure_Pa / load.normal_force_N -
                             1;
  result.along_x = nodal_profile(solved, problem, true);
  result.along_y = nodal_profile(solved, problem, false);
  if (!problem.output_directory.empty()) {
    result.vtu_file = problem.output_directory + "/solution.vtu";
    solved.model->write_vtu(result.vtu_file, solved.contact.force, h, layer.youngs_modulus_Pa);
    result.pvd_file = surface_series.finish();
  }
  if (!problem.compliance_file.empty()) {
    const PressedContact pressed = pressed_contact(solved, fine, problem, dimensionless);
    write_compliance(
        problem.compliance_file,
        surface_compliance(friction_compliances(pressed, Invariance::none), Invariance::none), h,
        layer.youngs_modulus_Pa, layer.poisson_ratio);
  }
  result.wall_s = total.seconds();
  result.peak_memory_MB = peak_memory_MB();
  return result;
}

}  // namespace softfinger::fem
