#include "fem/linear/linear_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "fem/algebra/cholesky.h"
#include "fem/base/formatted.h"
#include "fem/friction/rubbed_pressing.h"
#include "fem/levels/level_loop.h"
#include "fem/output/surface_series.h"
#include "fem/output/write_compliance.h"
#include "fem/output/write_vtu.h"
#include "fem/problem/check_problem.h"

namespace softfinger::fem {
namespace {

/// Semi-axes over h that are accepted. Contacts from a/h = 0.05 to 20 are verified.
constexpr double smallest_b = 1e-4, largest_b = 50, largest_a = 300;
/// Largest contact, over the sphere's radius. Beyond it the gap is so steep that small strain does
/// not apply.
constexpr double widest_on_sphere = 0.95;
/// Largest cells, over those of a mesh of the contact's own, with which the mesh of a larger
/// contact is used. With such cells a and b are still found to 0.9 % on level 2, d and torque to
/// 0.1 %.
constexpr double largest_cells = 1.6;

/// Sizes, in h, of the contacts that a pair of meshes was made for.
using Size = std::array<double, 2>;

/// Size of the contact that a mesh was made for, relative to another contact.
double oversize(const Size& made_for, const ContactShape& contact) {
  return std::max(made_for[0] / contact.block_a, made_for[1] / contact.block_b);
}

bool is_same_size(const Size& made_for, const ContactShape& contact) {
  return std::abs(std::log(made_for[0] / contact.block_a)) <= edge_on_cells &&
         std::abs(std::log(made_for[1] / contact.block_b)) <= edge_on_cells;
}

/// Rounded down to two digits.
double told_load(double load_N) {
  const double digit = std::pow(10, std::floor(std::log10(load_N)) - 1);
  return digit * std::floor(load_N / digit);
}

/// Refuses a contact that linear elasticity would press through the layer: finite strain can do it.
/// @returns what stands in the way of saying how much it can
/// @throws InputError otherwise
FoldedLayer refuse_pressed_through(const Pressed& pressed, const ContactTask& task) {
  const char* const beyond = "the approach reaches the layer's thickness";
  if (task.problem.approach_m > 0)
    throw too_much(task.problem, formatted("less, or finite strain: %s (%.3g times it), far "
                                           "outside linear elasticity",
                                           beyond, pressed.contact.approach));
  Pressing through = task.pressing;
  through.approach = task.pressing.whole_thickness();
  const Outcome<Pressed, FoldedLayer> largest = press_on(pressed.model, through);
  if (!largest) return largest.reason();
  const double load_N = through.unit_of_force_N * largest->load();
  throw too_much(task.problem, formatted("about %g at most, or finite strain: %s (%.3g times it), "
                                         "far outside linear elasticity",
                                         told_load(load_N), beyond, pressed.contact.approach));
}

/// @throws InputError for a contact that linear elasticity on a layer does not describe
std::optional<FoldedLayer> check_sensible(const Pressed& pressed, const ContactTask& task) {
  // A region that is too small holds less: the next mesh is larger.
  if (pressed.contact.approach >= task.pressing.whole_thickness() && !pressed.reaches_rim)
    return refuse_pressed_through(pressed, task);
  if (pressed.moment_b > largest_b || pressed.moment_a > largest_a || pressed.moment_b < smallest_b)
    throw InputError(task.problem.name, "contact",
                     formatted("b/h %.3g, a/h %.3g", pressed.moment_b, pressed.moment_a),
                     formatted("semi-axes b/h from %g to %g, a/h to %g for finite elements",
                               smallest_b, largest_b, largest_a));
  const double sphere = task.pressing.sphere;
  if (std::isfinite(sphere) && pressed.moment_a > widest_on_sphere * sphere)
    throw too_much(task.problem, "less: the contact is as wide as the sphere");
  return std::nullopt;
}

class LinearContact : public ContactPhysics {
 public:
  /// @param keeps_meshes  for later contacts of the run: they stay in memory
  /// @param shared        made for an earlier contact; empty: none
  LinearContact(const ContactTask& task, bool keeps_meshes, MeshPair shared = {})
      : task_(task),
        keeps_meshes_(keeps_meshes),
        shares_meshes_(shared.models.front() != nullptr),
        meshes_(std::move(shared)),
        object_(rigid_object(task.pressing)),
        series_(task.problem) {}

  /// The meshes of the two levels that were solved, if they are kept.
  const MeshPair& meshes() const { return meshes_; }

  const ErrorTable& error_table() const override { return linear_elasticity; }
  long predicted_unknowns(const LayerDiscretisation& mesh) const override {
    return fem::predicted_unknowns(mesh, *task_.pressing.mesh, task_.pressing.thickness_m);
  }
  bool shares_meshes() const override { return shares_meshes_; }
  bool trial_is_level_0() const override { return true; }

  std::optional<Obstacle> press(const LayerDiscretisation& mesh, int level) override {
    level_ = level;
    pressed_.model.reset();
    // The last trial mesh, too, goes before the next one is made: a layer takes most of the memory.
    if (!shares_meshes_ && is_kept_level()) meshes_.models[place()].reset();
    std::shared_ptr<const LayerModel> model;
    if (shares_meshes_) {
      model = meshes_.models[place()];
    } else {
      auto made = make_layer(mesh, task_.pressing, rubs(mesh));
      if (!made) return made.reason();
      model = *std::move(made);
    }
    if (keeps_meshes_ && is_kept_level()) meshes_.models[place()] = model;
    Outcome<Pressed, FoldedLayer> pressed = press_on(std::move(model), task_.pressing);
    if (!pressed) return pressed.reason();
    pressed_ = *std::move(pressed);
    largest_.reset();
    if (pressed_.largest) {
      largest_ = pressed_;
      largest_->contact = *pressed_.largest;
      largest_->normal_force = largest_->contact.force.cwiseQuotient(largest_->cosine);
      set_size(*largest_, task_.pressing);
    }
    if (std::optional<FoldedLayer> obstacle = check_sensible(widest(), task_)) return *obstacle;
    if (pressed_.contact.active == 0)
      throw InputError(task_.problem.name, "time_s", task_.problem.in_time->time_s,
                       "a time at which the finger touches: the object has left it");
    frictionless_.reset();
    rubbed_.reset();
    if (task_.problem.pressing == PressingFriction::none || pressed_.reaches_rim)
      return std::nullopt;
    if (std::optional<FoldedLayer> obstacle = press_with_friction()) return *obstacle;
    return std::nullopt;
  }

  RoughSize size() const override {
    return {widest().moment_a,          widest().moment_b,
            widest().contact.approach,  widest().reaches_rim,
            pressed_.model->unknowns(), formatted(", iterations %d", pressed_.contact.iterations)};
  }

  std::optional<FoldedLayer> end_beside() const override {
    return fem::end_beside(pressed_.model->nodes(), pressed_.contact.force, task_.pressing);
  }

  PressOther press_other() override {
    return
        [](const ContactTask& task,
           const LayerDiscretisation& mesh) -> Outcome<std::unique_ptr<ContactPhysics>, Obstacle> {
          auto other = std::make_unique<LinearContact>(task, /*keeps_meshes=*/false);
          if (std::optional<Obstacle> obstacle = other->press(mesh, no_level)) return *obstacle;
          return std::unique_ptr<ContactPhysics>(std::move(other));
        };
  }

  const LayerDiscretisation& discretisation() const override {
    return pressed_.model->discretisation();
  }

  Outcome<Measurement, Unmeasured> measure() override {
    const Problem& problem = task_.problem;
    const double h = task_.pressing.thickness_m, E = problem.contact.layer.youngs_modulus_Pa;
    check_covered();
    Outcome<ContactShape, Unmeasured> shape = measure_shape(pressed_, task_.pressing);
    if (!shape) return shape.reason();
    shape_ = *std::move(shape);
    Measurement measurement;
    measurement.block_a = shape_.block_a;
    measurement.block_b = shape_.block_b;
    if (largest_) {
      // The next mesh has to hold what was touched before, too.
      const double shrunk = std::min(
          {1.0, pressed_.moment_a / largest_->moment_a, pressed_.moment_b / largest_->moment_b});
      measurement.block_a /= shrunk;
      measurement.block_b /= shrunk;
    }
    measurement.centre = pressed_.centre();
    LevelResult& result = measurement.result;
    result.elements_per_semi_axis = pressed_.model->discretisation().elements_per_semi_axis;
    result.unknowns = pressed_.model->unknowns();
    result.active_nodes = pressed_.contact.active;
    result.iterations = pressed_.contact.iterations;
    set_shape(shape_, h, E, result);
    result.area_m2 = result.area_projected_m2 * mean_secant(shape_.outlines, *object_);
    result.indentation_m = pressed_.contact.approach * h;
    result.load_N =
        problem.approach_m > 0 ? pressed_.load() * E * h * h : problem.contact.load.normal_force_N;
    result.torque_arm_m = frictionless().torque_arm() * h;
    result.pressure_arm_m = pressed_.torque_arm() * h;
    if (rubbed_) result.stick_share = rubbed_->stick_share;
    set_largest_friction(result);
    result.load_residual = pressed_.contact.load_residual;
    result.complementarity_residual = pressed_.contact.complementarity_residual;
    if (shares_meshes_)
      result.oversize = oversize(meshes_.made_for[place()], shape_);
    else if (largest_)
      result.oversize = measurement.block_a / shape_.block_a;
    else if (is_kept_level())
      meshes_.made_for[place()] = {shape_.block_a, shape_.block_b};
    measurement.residual = std::max(result.load_residual, result.complementarity_residual);
    if (frictionless_) {
      shape = measure_shape(*frictionless_, task_.pressing);
      if (!shape) return shape.reason();
      measurement.frictionless = result;
      set_shape(*shape, h, E, *measurement.frictionless);
      measurement.frictionless->indentation_m = frictionless_->contact.approach * h;
    }
    return measurement;
  }

  FrictionOfLevel friction(std::optional<FrictionPlan>& plan, bool) override {
    KeptCompliances* kept = keeps_meshes_ ? &meshes_.compliances[place()] : nullptr;
    FrictionOfLevel result = friction_on(start_of_friction(), task_.problem, kept, plan,
                                         task_.progress, series_.of(level_));
    region_ = plan->region;
    return result;
  }

  std::vector<PressurePoint> pressures() const override {
    const auto& nodes = pressed_.model->nodes();
    std::vector<PressurePoint> result;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      result.push_back({nodes[i].x, nodes[i].y, nodes[i].x, nodes[i].y, pressed_.pressure(at),
                        nodes[i].position.head<2>() + task_.pressing.bent.centre,
                        pressed_.contact.force[at], seen_area(nodes[i])});
      if (rubbed_) result.back().friction = rubbed_->state.tangential.segment<2>(2 * at);
    }
    return result;
  }

  OutputFiles write_files() override {
    const Problem& problem = task_.problem;
    const ElasticLayer& layer = problem.contact.layer;
    OutputFiles files;
    if (!problem.output_directory.empty()) {
      files.vtu = problem.output_directory + "/solution.vtu";
      write_vtu(files.vtu, *pressed_.model, pressed_.normal_force, layer.thickness_m,
                layer.youngs_modulus_Pa);
      files.pvd = series_.finish();
    }
    if (!problem.compliance_file.empty()) {
      const QuarterCompliances quarters =
          friction_compliances(start_of_friction(), Invariance::none);
      write_compliance(problem.compliance_file, surface_compliance(quarters, Invariance::none),
                       layer.thickness_m, layer.youngs_modulus_Pa, layer.poisson_ratio);
    }
    return files;
  }

 private:
  static constexpr int no_level = -1;  ///< of a mesh on which no friction follows

  void check_covered() const {
    for (const SurfaceNode& node : pressed_.model->nodes())
      if (std::hypot(node.x / pressed_.moment_a, node.y / pressed_.moment_b) < 1 &&
          task_.pressing.gap(node) >= Pressing::beside_object)
        refuse_end_of_object(node.position.head<2>(), task_.pressing);
  }

  /// Nodes of the present level's mesh that friction may reach. With mirror planes it has other
  /// parities, which are factorised by themselves; trial meshes are only pressed. Later contacts
  /// and files may ask for nodes that this contact's friction leaves alone.
  Rubs rubs(const LayerDiscretisation& mesh) const {
    const bool for_others = !task_.problem.compliance_file.empty();
    if (task_.problem.pressing != PressingFriction::none && !task_.pressing.planes().any())
      return all_rub;
    if (!(for_others || task_.problem.friction.any()) || !is_kept_level() ||
        task_.pressing.planes().any())
      return none_rubs;
    if (for_others || keeps_meshes_) return all_rub;
    return [this, mesh](const SurfaceNode& node) { return is_in_region(region_, node, mesh); };
  }

  /// Index of the present level in a pair of meshes.
  std::size_t place() const { return static_cast<std::size_t>(level_ - task_.problem.level + 1); }
  /// Trial meshes are not kept, except the last one where it serves as level 0 as well.
  bool is_kept_level() const { return level_ >= task_.problem.level - 1; }

  void set_largest_friction(LevelResult& result) const {
    const Problem& problem = task_.problem;
    const double h = task_.pressing.thickness_m;
    const double unit_of_force_N = problem.contact.layer.youngs_modulus_Pa * h * h;
    if (problem.shear_law == ShearLaw::Kind::coulomb) {
      result.max_force_N = problem.contact.load.friction_coefficient * result.load_N;
      result.max_torque_Nm = result.max_force_N * result.torque_arm_m;
      return;
    }
    const Eigen::VectorXd friction = largest_friction(start_of_friction());
    result.max_force_N = pressed_.copies() * friction.sum() * unit_of_force_N;
    result.max_torque_Nm = pressed_.copies() * pressed_.moment_of(friction) * unit_of_force_N * h;
  }

  /// Over time, the contact that the mesh has to hold.
  const Pressed& widest() const { return largest_ ? *largest_ : pressed_; }

  const Pressed& frictionless() const { return frictionless_ ? *frictionless_ : pressed_; }

  /// Presses the contact once more with friction.
  std::optional<FoldedLayer> press_with_friction() {
    PressedContact start{*pressed_.model,   pressed_.gap,      pressed_.contact.force,
                         pressed_.moment_a, pressed_.moment_b, pressed_.load(),
                         pressing_law()};
    start.edge = outermost(start);
    const LayerDiscretisation& mesh = discretisation();
    const double all = (mesh.patch - start.edge) * mesh.elements_per_semi_axis;
    start.margin = std::min(1.0, all);
    const auto press_within_margin = [&] {
      return press_rubbing(start, friction_compliances(start, Invariance::mirrors),
                           {task_.pressing.load, task_.pressing.approach});
    };
    try {
      rubbed_ = press_within_margin();
    } catch (const EdgeLeftMargin&) {
      if (start.margin >= all) throw;
      start.margin = all;
      rubbed_ = press_within_margin();
    }
    frictionless_ = pressed_;
    if (task_.pressing.approach > 0) {
      // The torque at full slip is that of the frictionless pressure under the same load.
      Pressing by_load = task_.pressing;
      by_load.approach = 0;
      by_load.load = rubbed_->load;
      const Outcome<Pressed, FoldedLayer> pressed = press_on(pressed_.model, by_load);
      if (!pressed) return pressed.reason();
      frictionless_ = *pressed;
    }
    pressed_.contact.force = rubbed_->state.normal;
    pressed_.contact.approach = rubbed_->state.approach;
    pressed_.contact.active = static_cast<int>((rubbed_->state.normal.array() > 0).count());
    pressed_.normal_force = pressed_.contact.force.cwiseQuotient(pressed_.cosine);
    pressed_.lift = rubbed_->lift;
    set_size(pressed_, task_.pressing);
    return std::nullopt;
  }

  /// The law while the contact is pressed.
  ShearLaw pressing_law() const {
    // Shear over pressure where all sticks is below 1 but in the last nodes before the edge. With a
    // bound that is no bound such a node would touch, pull itself off and touch again.
    constexpr double never_slips = 10;
    return task_.problem.pressing == PressingFriction::stuck
               ? ShearLaw::coulomb(never_slips)
               : task_.problem.friction_law_of_model();
  }

  /// The relative radius of the farthest node that touches.
  static double outermost(const PressedContact& contact) {
    const auto& nodes = contact.model.nodes();
    double edge = 1;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (contact.force[static_cast<Eigen::Index>(i)] > 0)
        edge = std::max(edge, std::hypot(nodes[i].x / contact.a, nodes[i].y / contact.b));
    return edge;
  }

  PressedContact start_of_friction() const {
    PressedContact start{
        *pressed_.model, pressed_.gap,    frictionless().contact.force,         shape_.block_a,
        shape_.block_b,  pressed_.load(), task_.problem.friction_law_of_model()};
    if (rubbed_) start.rubbed = rubbed_->state;
    const auto& nodes = pressed_.model->nodes();
    if (start.law.has_shear_strength()) {
      Eigen::VectorXd area(start.force.size()), radius(start.force.size());
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        area[static_cast<Eigen::Index>(i)] = seen_area(nodes[i]);
        radius[static_cast<Eigen::Index>(i)] =
            std::hypot(nodes[i].x / start.a, nodes[i].y / start.b);
      }
      start.strength_share = strength_share(
          start.law, {start.force, area, radius, 1.0 / discretisation().elements_per_semi_axis,
                      shape_.projected_area / pressed_.copies()});
    }
    // Without symmetry nodes beyond the ellipse of the moments may touch. A contact that was
    // pressed with friction is smaller than it is at full slip.
    if (!pressed_.model->planes().both() || rubbed_) start.edge = outermost(start);
    return start;
  }

  const ContactTask& task_;
  const bool keeps_meshes_, shares_meshes_;
  int level_ = 0;
  MeshPair meshes_;
  const std::shared_ptr<const RigidObject> object_;
  SurfaceSeries series_;
  TouchedRegion region_;  ///< of friction on the coarse level; empty before it
  Pressed pressed_;
  std::optional<Pressed> largest_;        ///< over time, on the way there
  std::optional<Pressed> frictionless_;   ///< where `pressed_` is pressed with friction
  std::optional<RubbedPressing> rubbed_;  ///< in the same case
  ContactShape shape_;                    ///< as measured last
};

/// Properties that two contacts must share for one to be solved on the other's meshes.
LayerIdentity identity_of(const ContactTask& task) {
  const Problem& problem = task.problem;
  const Pressing& pressing = task.pressing;
  LayerIdentity identity{pressing.materials(), pressing.interfaces, "",
                         pressing.planes(),    problem.level,       pressing.opposite};
  const std::string scale = formatted(", h %.17g", pressing.thickness_m);
  if (problem.mesh) identity.fingertip = problem.mesh_name + scale;
  if (problem.fingertip)
    identity.fingertip = problem.fingertip.pad_name + scale +
                         formatted(", core %d", static_cast<int>(pressing.bent.ways)) +
                         formatted(", touched at %.17g, %.17g, seen from %.17g, %.17g",
                                   pressing.bent.first_touch.x(), pressing.bent.first_touch.y(),
                                   pressing.bent.centre.x(), pressing.bent.centre.y());
  return identity;
}

/// Whether meshes of an earlier contact of the run suit this one.
/// @param pressed  this contact on the coarse one
bool is_suitable(const Pressed& pressed, const MeshPair& meshes, const ContactTask& task) {
  if (pressed.reaches_rim) return false;
  const Outcome<ContactShape, Unmeasured> shape = measure_shape(pressed, task.pressing);
  if (!shape) return false;  // far too few cells
  LayerDiscretisation own;
  own.a = shape->block_a;
  own.b = shape->block_b;
  choose_elements(own, task.problem.level - 1);
  const double cells = oversize(meshes.made_for.front(), *shape) * own.elements_per_semi_axis;
  if (cells > largest_cells * pressed.model->discretisation().elements_per_semi_axis) return false;
  // Friction is singular at the contact's edge: stuck tractions want it on cell edges.
  return !task.problem.friction.any() || is_same_size(meshes.made_for.front(), *shape);
}

Outcome<Result, Unsolved> solve_on_shared_meshes(const ContactTask& task, ModelCache& models) {
  // The meshes of another history need not hold what was touched before.
  if (task.problem.in_time) return Unsolved(MeshesDoNotServe{});
  const LayerIdentity identity = identity_of(task);
  for (const MeshPair& meshes : models.of(identity)) {
    const Outcome<Pressed, FoldedLayer> pressed = press_on(meshes.models.front(), task.pressing);
    if (!pressed) return Unsolved(pressed.reason());
    if (!is_suitable(*pressed, meshes, task)) continue;
    LinearContact contact(task, /*keeps_meshes=*/true, meshes);
    Outcome<Result, Unsolved> result = solve_on_levels(contact, task);
    if (result) models.keep(identity, contact.meshes());
    return result;
  }
  return Unsolved(MeshesDoNotServe{});
}

Outcome<Result, Unsolved> solve_on_own_meshes(const ContactTask& task, ModelCache& models) {
  const bool keeps_meshes = models.capacity() > 0;
  LinearContact contact(task, keeps_meshes);
  Outcome<Result, Unsolved> result = solve_on_levels(contact, task);
  if (result && keeps_meshes && !result->interrupted)
    models.keep(identity_of(task), contact.meshes());
  return result;
}

}  // namespace

Outcome<Result, Unsolved> solve_linear(const ContactTask& task, ModelCache& models) {
  try {
    Outcome<Result, Unsolved> result = solve_on_shared_meshes(task, models);
    if (result || !std::holds_alternative<MeshesDoNotServe>(result.reason())) return result;
    return solve_on_own_meshes(task, models);
  } catch (const NotEnoughMemory&) {
    if (models.empty()) throw;
    task.progress("the meshes of earlier contacts make room");
    models.clear();
    ModelCache none(0);
    return solve_on_own_meshes(task, none);
  }
}

}  // namespace softfinger::fem
