#include "fem/finite/finite_solver.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "fem/finite/deformed_contact.h"
#include "fem/finite/superposed_friction.h"
#include "fem/friction_levels.h"
#include "fem/memory.h"
#include "fem/stopwatch.h"
#include "meshes/generation/object_surface.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {
namespace {

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

void check(const Problem& problem) {
  const auto refuse = [&](const char* field, const char* allowed) {
    throw InputError(problem.name, field, "", allowed);
  };
  const FrictionRequest& friction = problem.friction;
  if (friction.limit_surface > 0 && friction.increments_to_slip > 0)
    refuse("increments_to_slip", "0 with finite strain: full slip only");
  if (friction.torsion && (friction.twist_axis_x_m != 0 || friction.twist_axis_y_m != 0))
    refuse("twist_axis_m", "[0, 0] with finite strain: a twist about the contact's centre");
  if (!problem.compliance_file.empty())
    refuse("compliance_file", "none with finite strain, where it changes with the load");
}

void check_approach(const Problem& problem, const Pressing& pressing) {
  if (pressing.approach >= 1)
    throw InputError(problem.name, "approach_m", text("%g", problem.approach_m),
                     "less than the layer's thickness, which would be pressed through");
}

/// Of the sublayers, in units of the layer's E.
std::vector<std::shared_ptr<const Material>> materials_of(const Problem& problem,
                                                          const Pressing& pressing) {
  std::vector<std::shared_ptr<const Material>> result;
  for (const auto& [youngs_ratio, poisson_ratio] : pressing.materials())
    result.push_back(make_material(problem.sublayers.empty()
                                       ? *problem.finite_strain
                                       : problem.sublayers[result.size()].material,
                                   youngs_ratio, poisson_ratio));
  return result;
}

std::shared_ptr<const RigidObject> object_of(const Pressing& pressing) {
  if (pressing.fingertip) {
    const auto height = [object = pressing.fingertip.object, h = pressing.thickness_m](
                            double x, double y) -> std::optional<double> {
      const auto found = object->height(h * x, h * y);
      if (!found) return std::nullopt;
      return *found / h;
    };
    // A thousandth of the thickness is far below any radius that a layer bears; an edge rounded
    // over a tenth of it is one that Newton's steps do not jump across.
    constexpr double step = 1e-3, rounded_edges = 0.05;
    if (pressing.fingertip.object->faceted()) return smoothed(height, rounded_edges);
    return sampled(height, step);
  }
  if (std::isfinite(pressing.sphere)) return sphere(pressing.sphere);
  return quadric(pressing.major, pressing.minor);
}

/// As for linear elasticity: to one part in a thousand.
double rounded(double semi_axis) {
  constexpr double step = 1e-3;
  return std::exp(step * std::round(std::log(semi_axis) / step));
}

/// One mesh's answer, and the shape that the next mesh is made for.
struct Measured {
  LevelResult result;
  DeformedContact contact;
  std::shared_ptr<FinitePressing> pressing;
};

/// What one mesh says about friction.
struct DeformedFriction {
  FrictionOfLevel of_level;
  /// What superposed motions leave out at full slip, relative (superposed_friction.h): of the
  /// twist, and the largest of all directions.
  double second_order_of_twist = 0, second_order_of_slide = 0;
  /// Of a point of the limit surface against the frictionless pressure, over mu P and the largest
  /// torque: the largest.
  double moved_by_pressure = 0;
};

/// What is the same on every mesh.
class Levels {
 public:
  Levels(const Problem& problem, const Pressing& pressing, const Progress& progress,
         const StopRequested& stop)
      : problem_(problem),
        pressing_(pressing),
        progress_(progress),
        stop_(stop),
        materials_(materials_of(problem, pressing)),
        object_(object_of(pressing)) {}

  /// A mesh pressed by all of the load.
  FinitePressing pressed(const LayerDiscretisation& mesh) const {
    check_reach(mesh);
    FinitePressing result(pressing_.mesh
                              ? std::make_shared<FiniteLayer>(mesh, *pressing_.mesh,
                                                              pressing_.thickness_m, materials_)
                              : std::make_shared<FiniteLayer>(mesh, pressing_.bent.shape,
                                                              pressing_.whole(), materials_),
                          object_);
    try {
      result.press({pressing_.load, pressing_.approach});
    } catch (const ConvergenceError& error) {
      const Equilibrium& last = result.equilibrium();
      const double E = problem_.contact.layer.youngs_modulus_Pa, h = pressing_.thickness_m;
      char where[200];
      // A first mesh for a load that is far too large is far too wide and coarse.
      std::snprintf(where, sizeof where,
                    "finite strain beyond %.4g N (indentation %.4g mm, %.3g of the thickness), the "
                    "last load that is converged on a mesh for a/h = %.3g,",
                    last.load * E * h * h, 1e3 * h * last.approach, last.approach, mesh.a);
      // From there on a contact wraps around the object.
      constexpr double steep_rad = M_PI / 4;
      throw ConvergenceError(
          where, error.iteration(), error.residual(),
          last.steepest_rad > steep_rad
              ? "the contact reaches where the object is" +
                    text(" %.0f degrees", last.steepest_rad * 180 / M_PI) +
                    " steep and the finger's surface slides off: less load or a larger object"
              : "the layer is nearly pressed through, or its surface folds: less load");
    }
    for (const int node : result.touching_nodes().node)
      if (const SurfaceNode& at = result.layer().nodes()[static_cast<std::size_t>(node)]; at.at_end)
        refuse_end_of_surface(at, pressing_.thickness_m);
    return result;
  }

  /// An object that ends within the contact has an edge there, which is no contact of two smooth
  /// surfaces any more.
  void check_covered(const FinitePressing& pressing) const {
    const Equilibrium& found = pressing.equilibrium();
    const auto& nodes = pressing.layer().nodes();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (std::hypot(nodes[i].x / found.moment_a, nodes[i].y / found.moment_b) > 1) continue;
      const Eigen::Vector3d at = pressing.layer().position(i);
      if (object_->over(at.x(), at.y())) continue;
      const double h = pressing_.thickness_m;
      throw InputError(problem_.name, "object",
                       text("no surface at x %.4g mm", 1e3 * h * at.x()) +
                           text(", y %.4g mm from the contact point", 1e3 * h * at.y()),
                       "an object that covers the contact, or less load: the finger slides off");
    }
  }

  /// Coarse meshes until mesh and contact agree in size.
  LayerDiscretisation find_size() const {
    LayerDiscretisation mesh = first_guess(pressing_);
    mesh.b = rounded(std::clamp(mesh.b, 1e-4, 60.0));
    mesh.a = rounded(std::clamp(mesh.a, mesh.b, 300.0));
    constexpr int limit = 15;
    for (int attempt = 1;; ++attempt) {
      choose_elements(mesh, 0);
      const FinitePressing trial = pressed(mesh);
      const Equilibrium& found = trial.equilibrium();
      const double change = std::max(std::abs(std::log(found.moment_a / mesh.a)),
                                     std::abs(std::log(found.moment_b / mesh.b)));
      progress_("mesh " + std::to_string(attempt) + text(": a/h %.4g", found.moment_a) +
                text(", b/h %.4g", found.moment_b) + text(", d/h %.4g", found.approach) +
                ", unknowns " + std::to_string(trial.layer().unknowns()) + ", load steps " +
                std::to_string(trial.history().steps) + ", iterations " +
                std::to_string(trial.history().iterations) +
                (found.reaches_rim ? ", contact at the rim" : ""));
      if (!found.reaches_rim && change < 0.08) {
        check_covered(trial);
        const DeformedContact contact = measure(trial);
        mesh.a = rounded(contact.block_a);
        mesh.b = rounded(contact.block_b);
        return mesh;
      }
      if (attempt == limit)
        throw ConvergenceError("size of the refined patch", limit, change,
                               "the contact's size depends on the mesh; is the contact elliptic?");
      if (stop_()) throw Interrupted();
      // At the rim the moments only bound the contact from below.
      const double growth = found.reaches_rim ? 1.3 : 1.0;
      mesh.a = rounded(growth * found.moment_a);
      mesh.b = rounded(growth * found.moment_b);
    }
  }

  Measured solve(const LayerDiscretisation& mesh, int level) const {
    const Stopwatch watch;
    auto pressed_on_mesh = std::make_shared<FinitePressing>(pressed(mesh));
    const FinitePressing& pressing = *pressed_on_mesh;
    if (pressing.equilibrium().reaches_rim)
      throw ConvergenceError("size of the refined patch", level,
                             pressing.equilibrium().moment_a / mesh.a,
                             "the contact outgrew the patch on refinement");
    Measured measured;
    measured.contact = measure(pressing);
    measured.pressing = std::move(pressed_on_mesh);
    const Equilibrium& equilibrium = pressing.equilibrium();
    const double h = pressing_.thickness_m, E = problem_.contact.layer.youngs_modulus_Pa;
    LevelResult& result = measured.result;
    result.level = level;
    result.elements_per_semi_axis = pressing.layer().discretisation().elements_per_semi_axis;
    result.unknowns = pressing.layer().unknowns();
    result.active_nodes = equilibrium.active;
    result.iterations = pressing.history().iterations;
    result.a_m = measured.contact.a * h;
    result.b_m = measured.contact.b * h;
    result.turn_rad = measured.contact.turn_rad;
    result.area_m2 = measured.contact.area * h * h;
    result.indentation_m = equilibrium.approach * h;
    result.peak_pressure_Pa = measured.contact.peak * E;
    result.load_N = problem_.approach_m > 0 ? equilibrium.load * E * h * h
                                            : problem_.contact.load.normal_force_N;
    const double friction_force = problem_.contact.load.friction_coefficient * result.load_N;
    result.max_torque_Nm = friction_force * measured.contact.torque_arm * h;
    result.max_torque_projected_Nm = friction_force * measured.contact.projected_arm * h;
    result.strain_energy_J = equilibrium.energy * E * h * h * h;
    result.load_residual = pressing_.load > 0 ? std::abs(equilibrium.load / pressing_.load - 1) : 0;
    result.complementarity_residual = equilibrium.complementarity_residual;
    result.fit_residual = measured.contact.fit_residual;
    result.wall_s = watch.seconds();
    result.cpu_s = watch.cpu_seconds();
    const PressingHistory& history = pressing.history();
    progress_("level " + std::to_string(level) + ": unknowns " + std::to_string(result.unknowns) +
              ", contact nodes " + std::to_string(result.active_nodes) + ", load steps " +
              std::to_string(history.steps) +
              (history.cuts > 0 ? " (" + std::to_string(history.cuts) + " cut)" : "") +
              ", iterations " + std::to_string(history.iterations) +
              (history.shifts > 0 ? " (" + std::to_string(history.shifts) + " shifted)" : "") +
              text(", a %.5g mm", 1e3 * result.a_m) + text(", b %.5g mm", 1e3 * result.b_m) +
              text(", d %.5g mm", 1e3 * result.indentation_m) +
              text(", torque %.5g mN m", 1e3 * result.max_torque_Nm) +
              text(", residual %.1g", equilibrium.out_of_balance) +
              text(", %.1f s", result.wall_s) + text(", peak memory %.0f MB", peak_memory_MB()));
    return measured;
  }

  /// @param plan  as for `friction_on`
  DeformedFriction friction(const Measured& measured, std::optional<FrictionPlan>& plan) const {
    const Stopwatch watch;
    FinitePressing& pressing = *measured.pressing;
    const Equilibrium& equilibrium = pressing.equilibrium();
    const double mu = problem_.contact.load.friction_coefficient;
    SuperposedTwist twist(pressing, mu);
    DeformedFriction friction;
    FrictionOfLevel& result = friction.of_level;
    result.stiffness = twist.stiffness();
    const double torque = slide(pressing, mu, {0, 0, 1}).torque;
    if (!plan)
      plan = plan_friction({result.stiffness, torque, mu * equilibrium.load, measured.contact.b},
                           problem_);
    for (const PlaneMotion& motion : plan->twist) {
      twist.turn_to(motion.turn_rad);
      result.twist.push_back({motion, {0, 0, twist.torque()}, twist.slip_fraction(), 0});
    }
    const double work = equilibrium.load * std::min(1.0, measured.contact.b);
    // The odd change of the pressure changes the torque by its square, and what nodes that let go
    // or begin to slip by it change, which a quarter does not see: on the whole layer of symmetric
    // contacts up to 0.09 of it.
    const bool whole = pressing.layer().whole();
    const double pressure_change = twist.pressure_change();
    friction.second_order_of_twist = twist.stored_energy() / work +
                                     pressure_change * pressure_change +
                                     (whole ? 0 : 0.1 * pressure_change);
    result.full_slip = torque;
    if (whole || !plan->velocities.empty()) {
      const SuperposedSlide slides(pressing, mu);
      // Where nothing is odd, a turn moves the torque's own pressure.
      if (whole) result.full_slip = slides.slide({0, 0, 1}).wrench.torque;
      for (const PlaneMotion& velocity : plan->velocities) {
        const auto [found, energy] = slides.slide(velocity);
        const FrictionWrench frictionless = slide(pressing, mu, velocity);
        friction.second_order_of_slide = std::max(friction.second_order_of_slide, energy / work);
        result.limit_surface.push_back({velocity, found, 1, 0});
        const double force = mu * equilibrium.load;
        friction.moved_by_pressure = std::max(
            {friction.moved_by_pressure, std::abs(found.force_x - frictionless.force_x) / force,
             std::abs(found.force_y - frictionless.force_y) / force,
             std::abs(found.torque - frictionless.torque) / torque});
      }
    }
    if (problem_.friction.torsion)
      progress_("friction: twist of " + std::to_string(plan->twist.size()) + " increments to " +
                text("%.3g rad", plan->twist.back().turn_rad) +
                text(", slip on %.0f %% of the area", 100 * twist.slip_fraction()) +
                text(", surface moved by %.2g h", twist.largest_displacement()) +
                text(", pressure by %.1g", pressure_change) +
                text(", neglected %.1g", friction.second_order_of_twist) +
                text(", %.1f s", watch.seconds()));
    return friction;
  }

 private:
  const char* driver() const { return problem_.approach_m > 0 ? "approach_m" : "load_N"; }
  std::string driver_value() const {
    return text(
        "%g", problem_.approach_m > 0 ? problem_.approach_m : problem_.contact.load.normal_force_N);
  }

  /// A bent layer's map ends somewhere: the patch and a cell beside it have to fit.
  void check_reach(const LayerDiscretisation& mesh) const {
    const double needed_x = mesh.patch * mesh.a + mesh.a / mesh.elements_along_a();
    const double needed_y = mesh.patch * mesh.b + mesh.b / mesh.elements_per_semi_axis;
    if (needed_x < 0.98 * mesh.reach_x && needed_y < 0.98 * mesh.reach_y) return;
    throw InputError(problem_.name, problem_.approach_m > 0 ? "approach_m" : "load_N",
                     text("%g", problem_.approach_m > 0 ? problem_.approach_m
                                                        : problem_.contact.load.normal_force_N),
                     "less, or a larger pad: the contact needs the finger's surface further out "
                     "than the layer fits on it");
  }

  const Problem& problem_;
  const Pressing& pressing_;
  const Progress& progress_;
  const StopRequested& stop_;
  std::vector<std::shared_ptr<const Material>> materials_;
  std::shared_ptr<const RigidObject> object_;
};

/// As for linear elasticity (`reference_solver.cc`): the difference of the two meshes, extrapolated
/// with a cautious order, plus what it does not show.
RelativeError estimate_error(const LevelResult& coarse, const LevelResult& fine, double side_wall) {
  const double refinement =
      static_cast<double>(fine.elements_per_semi_axis) / coarse.elements_per_semi_axis;
  const auto error = [&](double LevelResult::*quantity, double order, double common) {
    return std::abs(coarse.*quantity / fine.*quantity - 1) / (std::pow(refinement, order) - 1) +
           common;
  };
  constexpr double integral_order = 1.6, edge_order = 1;
  constexpr double integral_common = 1e-4, edge_common = 1e-3;
  // Of the fit of a strongly deformed contact: the peak was 0.3 % low, up to 0.5 %, on the finer of
  // two levels that agreed to 0.2 % (level 2, d/h from 0.05 to 0.4).
  constexpr double peak_common = 4e-3;
  RelativeError result;
  result.a = error(&LevelResult::a_m, edge_order, edge_common);
  result.b = error(&LevelResult::b_m, edge_order, edge_common);
  result.area = error(&LevelResult::area_m2, edge_order, 2 * edge_common);
  result.peak_pressure = error(&LevelResult::peak_pressure_Pa, edge_order, peak_common);
  result.indentation =
      error(&LevelResult::indentation_m, integral_order, integral_common) + side_wall;
  result.load = error(&LevelResult::load_N, integral_order, integral_common) + side_wall;
  result.max_torque = error(&LevelResult::max_torque_Nm, integral_order, integral_common);
  return result;
}

/// What the free side wall changes in the approach, at `extent` from the contact's edge: on a
/// finger there may be no room for the six thicknesses of a flat layer. Measured for nu >= 0.49,
/// where it is felt most: up to 4 % at 2 h, 0.23 % at 4 h.
double side_wall_error(const LayerDiscretisation& mesh) {
  const double extent = std::min({mesh.extent, mesh.reach_x - mesh.a, mesh.reach_y - mesh.b});
  return extent < mesh.extent ? 0.04 * std::exp(-1.5 * (extent - 2)) : 0;
}

Profile profile(const FinitePressing& pressing, const Problem& problem, bool along_x) {
  const double h = problem.contact.layer.thickness_m, E = problem.contact.layer.youngs_modulus_Pa;
  const Eigen::VectorXd pressure = nodal_pressure(pressing);
  const auto& nodes = pressing.layer().nodes();
  std::vector<std::pair<double, double>> points;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (std::abs(along_x ? nodes[i].y : nodes[i].x) > 1e-9) continue;
    const Eigen::Vector3d at = pressing.layer().position(i);
    points.emplace_back(h * (along_x ? at.x() : at.y()),
                        E * pressure[static_cast<Eigen::Index>(i)]);
  }
  std::sort(points.begin(), points.end());
  Profile result;
  for (const auto& [position_m, pressure_Pa] : points) {
    result.position_m.push_back(position_m);
    result.pressure_Pa.push_back(pressure_Pa);
  }
  return result;
}

}  // namespace

Result solve_finite(const Problem& problem, const Pressing& pressing, const Progress& progress,
                    const StopRequested& stop) {
  check(problem);
  check_approach(problem, pressing);
  const Stopwatch total;
  const Levels levels(problem, pressing, progress, stop);
  if (stop()) throw Interrupted();
  LayerDiscretisation mesh = levels.find_size();
  Result result;
  double side_wall = 0;
  double misfit = 0;  // of contact and mesh, relative
  std::shared_ptr<const FinitePressing> finest;
  std::optional<FrictionPlan> plan;
  std::vector<DeformedFriction> friction;
  for (const int level : {problem.level - 1, problem.level}) {
    if (stop()) throw Interrupted();
    choose_elements(mesh, level);
    // As in linear elasticity: a mesh from outside may be finer than the levels ask for.
    if (problem.mesh && !result.levels.empty())
      mesh.elements_per_semi_axis = 2 * result.levels.back().elements_per_semi_axis;
    progress("level " + std::to_string(level) + ": " + std::to_string(mesh.elements_per_semi_axis) +
             " elements per semi-axis");
    finest.reset();  // before the next one takes its memory
    const Measured measured = levels.solve(mesh, level);
    finest = measured.pressing;
    side_wall = side_wall_error(mesh);
    result.levels.push_back(measured.result);
    misfit = std::max({misfit, std::abs(std::log(mesh.a / measured.contact.block_a)),
                       std::abs(std::log(mesh.b / measured.contact.block_b))});
    if (problem.friction.any()) friction.push_back(levels.friction(measured, plan));
    mesh.a = rounded(measured.contact.block_a);
    mesh.b = rounded(measured.contact.block_b);
  }
  result.finest = result.levels.back();
  result.error = estimate_error(result.levels.front(), result.levels.back(), side_wall);
  if (pressing.whole()) {
    // Against the fit on symmetric contacts (6 contacts, d/h 0.1 to 0.4, R'/R'' 1 to 4, meshes of
    // 0.93 to 1.12 times their size): the nodes that touch tell the edge to this share of a cell,
    // and the moments' a/b is up to 2.7 % off, most where the contact is long.
    constexpr double edge_between_nodes = 0.1, of_moments = 0.015;
    const double of_edge = edge_between_nodes / result.finest.elements_per_semi_axis;
    result.error.a += of_edge + of_moments;
    result.error.b += of_edge + of_moments;
    result.error.area += 2 * of_edge;
  }
  if (pressing.fingertip && pressing.fingertip.object->faceted()) {
    // Both levels round the facets' edges: a scanned pad on a sphere's mesh went 5e-4 h less deep
    // than on the facets themselves. A load goes with the approach's power 2 or so.
    constexpr double by_rounded_edges = 5e-4;
    const double of_edges = by_rounded_edges * pressing.thickness_m / result.finest.indentation_m;
    result.error.indentation += of_edges;
    result.error.load += 2 * of_edges;
  }
  (problem.approach_m > 0 ? result.error.indentation : result.error.load) = 0;  // as given
  if (!friction.empty()) {
    const double refinement = static_cast<double>(result.finest.elements_per_semi_axis) /
                              result.levels.front().elements_per_semi_axis;
    state_friction(friction.front().of_level, friction.back().of_level, refinement, problem,
                   result);
    const double neglected = friction.back().second_order_of_twist;
    if (result.torsion) {
      result.torsion->curve_error += neglected;
      result.torsion->full_slip_error += neglected;
      // As for a mesh from outside: the stuck contact's radius, whose third power is its stiffness,
      // is known to a quarter of a cell where its edge does not lie on the mesh's, and a ring of
      // nodes may be missing on one of the levels (5 % at n = 8, 14 % at n = 4).
      constexpr double edge_on_cells = 2e-3;
      if (pressing.whole() || misfit > edge_on_cells)
        result.torsion->stiffness_error += 0.75 / result.finest.elements_per_semi_axis;
    }
    // The edge, which moves with the pressure, does not follow: of second order in what the
    // pressure's change does. Against the linear solver for small loads: 0.9 times that.
    const double moved = friction.back().moved_by_pressure;
    if (!result.limit_surface.empty())
      result.limit_surface_error += friction.back().second_order_of_slide + moved * moved;
  }
  result.pressure_exponent =
      result.finest.area_m2 * result.finest.peak_pressure_Pa / result.finest.load_N - 1;
  result.along_x = profile(*finest, problem, true);
  result.along_y = profile(*finest, problem, false);
  if (!problem.output_directory.empty()) {
    result.vtu_file = problem.output_directory + "/solution.vtu";
    finest->layer().write_vtu(result.vtu_file, nodal_pressure(*finest),
                              problem.contact.layer.thickness_m,
                              problem.contact.layer.youngs_modulus_Pa);
  }
  result.wall_s = total.seconds();
  result.cpu_s = total.cpu_seconds();
  result.peak_memory_MB = peak_memory_MB();
  return result;
}

}  // namespace softfinger::fem::finite
