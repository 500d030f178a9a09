#include "fem/finite/finite_contact.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "fem/base/formatted.h"
#include "fem/base/stopwatch.h"
#include "fem/finite/correct_friction.h"
#include "fem/finite/deformed_contact.h"
#include "fem/finite/rubbed_pressing.h"
#include "fem/finite/superposed_friction.h"
#include "fem/layer/element_limits.h"
#include "fem/levels/level_loop.h"
#include "fem/output/surface_series.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {
namespace {

/// A contact that reaches a steeper slope wraps around the object instead of being pressed on it.
constexpr double steep_rad = M_PI / 4;
/// If the load stops beyond this slope, the finger's surface leaves the object: finer cells go no
/// farther.
constexpr double wrapped_rad = 80 * M_PI / 180;

using Materials = std::vector<std::shared_ptr<const Material>>;

/// Materials of the sublayers, in units of the layer's E.
Materials materials_of(const ContactTask& task) {
  const Problem& problem = task.problem;
  const double largest =
      problem.has_friction() ? largest_rubbed_poisson_ratio : largest_poisson_ratio;
  Materials result;
  for (const auto& [youngs_ratio, poisson_ratio] : task.pressing.materials())
    result.push_back(make_material(problem.sublayers.empty()
                                       ? *problem.finite_strain
                                       : problem.sublayers[result.size()].material,
                                   youngs_ratio, std::min(poisson_ratio, largest)));
  return result;
}

/// ", load steps 3 (1 cut), iterations 20 (2 shifted)"
std::string text_of(const PressingHistory& history) {
  return formatted(", load steps %d%s, iterations %d%s", history.steps,
                   history.cuts > 0 ? formatted(" (%d cut)", history.cuts).c_str() : "",
                   history.iterations,
                   history.shifts > 0 ? formatted(" (%d shifted)", history.shifts).c_str() : "");
}

class FiniteContact : public ContactPhysics {
 public:
  explicit FiniteContact(const ContactTask& task)
      : task_(task),
        problem_(task.problem),
        h_(task.pressing.thickness_m),
        E_(task.problem.contact.layer.youngs_modulus_Pa),
        law_(task.problem.friction_law_of_model()),
        materials_(materials_of(task)),
        object_(rigid_object(task.pressing)),
        series_(task.problem) {}

  const ErrorTable& error_table() const override { return finite_strain; }
  long predicted_unknowns(const LayerDiscretisation& mesh) const override {
    return fem::predicted_unknowns(mesh, *task_.pressing.mesh, h_);
  }

  /// Level 0 has a mesh made for the size that the trial found: its edge lies on cell edges.
  bool trial_is_level_0() const override { return false; }

  std::optional<Obstacle> press(const LayerDiscretisation& mesh, int level) override {
    level_ = level;
    if (pressing_) pressing_->release_factor();
    return press_from(pressing_.get(), mesh);
  }

  bool rubs_on_levels_only() const override { return problem_.pressing != PressingFriction::none; }

  std::optional<Obstacle> rub() override {
    if (problem_.pressing == PressingFriction::none) return std::nullopt;
    Outcome<std::shared_ptr<FiniteLayer>, FoldedLayer> layer = make_layer(discretisation());
    if (!layer) return layer.reason();
    // Shear over pressure is below 1 where all sticks but in the last nodes before the edge.
    constexpr double never_slips = 10;
    const FrictionBound bound = problem_.pressing == PressingFriction::stuck
                                    ? FrictionBound(never_slips)
                                    : FrictionBound(law_.friction_coefficient);
    pressing_->release_factor();
    try {
      rubbed_ = press_with_friction(*layer, bound);
    } catch (const ConvergenceError& error) {
      throw ConvergenceError("pressing with friction at finite strain", error.iteration(),
                             error.residual(),
                             std::string(error.what()) +
                                 "; it bears this load without: pressing = \"frictionless\", whose "
                                 "largest torque is the same");
    }
    rubbed_->pressing->release_factor();
    return std::nullopt;
  }

  RoughSize size() const override {
    const Equilibrium& found = as_pressed().equilibrium();
    return {found.moment_a,
            found.moment_b,
            found.approach,
            found.reaches_rim,
            pressing_->layer().unknowns(),
            text_of(pressing_->history())};
  }

  std::optional<FoldedLayer> end_beside() const override {
    return fem::end_beside(pressing_->layer().nodes(), as_pressed().equilibrium().force,
                           task_.pressing);
  }

  PressOther press_other() override {
    pressing_->release_factor();
    return
        [start = std::shared_ptr<const FinitePressing>(pressing_)](
            const ContactTask& task,
            const LayerDiscretisation& mesh) -> Outcome<std::unique_ptr<ContactPhysics>, Obstacle> {
          auto other = std::make_unique<FiniteContact>(task);
          other->tells_what_fits_ = false;
          if (std::optional<Obstacle> obstacle = other->press_from(start.get(), mesh))
            return *obstacle;
          return std::unique_ptr<ContactPhysics>(std::move(other));
        };
  }

  const LayerDiscretisation& discretisation() const override {
    return pressing_->layer().discretisation();
  }

  Outcome<Measurement, Unmeasured> measure() override {
    check_covered();
    Outcome<DeformedContact, Unmeasured> measured = measure(*pressing_);
    if (!measured) return measured.reason();
    contact_ = *std::move(measured);
    if (!rubbed_) return measurement_of(*pressing_, contact_);
    std::optional<LevelResult> compared;
    if (task_.pressing.approach > 0) {
      compared = measurement_of(*pressing_, contact_).result;
      // The torque at full slip is that of the frictionless pressure under the same load, from
      // which friction leads to the same places.
      const Eigen::Matrix3Xd places = dragged_places(*pressing_, rubbed_->drag);
      pressing_->press({rubbed_->pressing->equilibrium().load, 0});
      const double stick_share = rubbed_->drag.stick_share;
      rubbed_->drag = drag_to(places, *rubbed_->pressing, *pressing_);
      rubbed_->drag.stick_share = stick_share;
      measured = measure(*pressing_);
      if (!measured) return measured.reason();
      contact_ = *std::move(measured);
    }
    measured = measure(*rubbed_->pressing);
    if (!measured) return measured.reason();
    Measurement measurement = measurement_of(*rubbed_->pressing, *measured);
    measurement.compared = compared;
    measurement.result.stick_share = rubbed_->drag.stick_share;
    measurement.frictionless = measurement_of(*pressing_, contact_).result;
    return measurement;
  }

  FrictionOfLevel friction(std::optional<FrictionPlan>& plan, bool has_room) override {
    const bool is_first = !plan;
    FrictionOfLevel result;
    const bool is_whole = !pressing_->layer().planes().any();
    const Eigen::MatrixXd tangent =
        pressing_->superposed_stiffness({/*odd_x=*/!is_whole, /*odd_y=*/!is_whole});
    SuperposedMotion motion(*pressing_, bound(), tangent);
    result.stiffness =
        rubbed_ ? SuperposedMotion(*rubbed_->pressing, bound(*rubbed_->pressing)).stiffness()
                : motion.stiffness();
    result.full_slip = slide(*pressing_, bound(), {0, 0, 1}).torque;
    if (is_first)
      plan = plan_friction({result.stiffness, result.full_slip, largest_force(), contact_.shape.b},
                           problem_);
    follow(*plan, motion, result);
    if (is_whole)
      slip(SuperposedSlide(*pressing_, bound(), tangent), plan->velocities, result);
    else if (!plan->velocities.empty())
      slip(SuperposedSlide(*pressing_, bound()), plan->velocities, result);
    // The correction of superposed motions is solved on the coarse mesh, if it is worth the work.
    constexpr double worthwhile = 0.002;
    const bool matters =
        std::max(result.neglected_of_twist, result.neglected_of_slide) > worthwhile;
    const bool is_written = problem_.friction.torsion && !problem_.output_directory.empty();
    const bool is_dragged = rubbed_ && (problem_.friction.torsion || !plan->paths.empty());
    if (is_first && (matters || is_written || is_dragged))
      result.correction = correction(result, tangent, has_room);
    return result;
  }

  std::vector<PressurePoint> pressures() const override {
    const Eigen::VectorXd pressure = nodal_pressure(as_pressed());
    const auto& nodes = pressing_->layer().nodes();
    std::vector<PressurePoint> result;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Equilibrium& found = as_pressed().equilibrium();
      const auto node = static_cast<Eigen::Index>(i);
      const Eigen::Vector2d at =
          as_pressed().layer().position(i).head<2>() + task_.pressing.bent.centre;
      result.push_back({nodes[i].x, nodes[i].y, at.x(), at.y(), pressure[node], at,
                        found.force[node], seen_area(nodes[i])});
      if (found.friction.size() > 0) result.back().friction = found.friction.col(node);
    }
    return result;
  }

  OutputFiles write_files() override {
    OutputFiles files;
    if (problem_.output_directory.empty()) return files;
    files.vtu = problem_.output_directory + "/solution.vtu";
    as_pressed().layer().write_vtu(files.vtu, nodal_pressure(as_pressed()), h_, E_);
    files.pvd = series_.finish();
    return files;
  }

 private:
  /// Presses with friction on a mesh of the same nodes: in load steps on the coarser level, whose
  /// drag the finer one takes over. Load steps cost ten times what the contact without friction
  /// does.
  /// @throws ConvergenceError
  RubbedPressing press_with_friction(const std::shared_ptr<FiniteLayer>& layer,
                                     const FrictionBound& bound) {
    const Drive drive{task_.pressing.load, task_.pressing.approach};
    if (drag_ && drag_level_ < level_) {
      const auto unloaded = layer->state();
      try {
        return press_dragged(*pressing_, layer, bound, drive, *drag_);
      } catch (const ConvergenceError&) {
        task_.progress(formatted("level %d: friction is followed in load steps", level_));
        layer->restore(*unloaded);
      }
    }
    RubbedPressing result = press_rubbing(*pressing_, layer, bound, drive);
    drag_ = result.drag;
    drag_level_ = level_;
    return result;
  }

  const Equilibrium& equilibrium() const { return pressing_->equilibrium(); }
  /// The contact as it was pressed. At full slip it is again the frictionless one, whatever
  /// friction did before.
  const FinitePressing& as_pressed() const { return rubbed_ ? *rubbed_->pressing : *pressing_; }

  /// @param start  the state on another mesh, near the one on this mesh; null: none
  std::optional<Obstacle> press_from(const FinitePressing* start, const LayerDiscretisation& mesh) {
    Outcome<std::shared_ptr<FiniteLayer>, FoldedLayer> layer = make_layer(mesh);
    if (!layer) return layer.reason();
    auto pressing = std::make_shared<FinitePressing>(*std::move(layer), object_);
    if (start && !task_.pressing.mesh) pressing->continue_from(*start);
    try {
      pressing->press({task_.pressing.load, task_.pressing.approach});
    } catch (const ConvergenceError& error) {
      const Equilibrium& last = pressing->equilibrium();
      const ConvergenceError told = not_reached(last, mesh, error);
      if (last.steepest_rad > wrapped_rad) throw told;
      return NotReached{told, last.moment_a, last.moment_b};
    }
    pressing_ = std::move(pressing);
    rubbed_.reset();
    if (std::optional<FoldedLayer> end = reached_end()) return *std::move(end);
    return std::nullopt;
  }

  Outcome<DeformedContact, Unmeasured> measure(const FinitePressing& pressing) const {
    const MaterialChoice& surface =
        problem_.sublayers.empty() ? *problem_.finite_strain : problem_.sublayers.front().material;
    return finite::measure(pressing, task_.pressing.surface_modulus(), surface);
  }

  /// @param contact  measured on that pressing
  Measurement measurement_of(const FinitePressing& pressing, const DeformedContact& contact) const {
    const Equilibrium& found = pressing.equilibrium();
    Measurement measurement;
    measurement.block_a = contact.shape.block_a;
    measurement.block_b = contact.shape.block_b;
    measurement.centre = contact.centre;
    measurement.residual = found.out_of_balance;
    LevelResult& result = measurement.result;
    result.elements_per_semi_axis = pressing.layer().discretisation().elements_per_semi_axis;
    result.unknowns = pressing.layer().unknowns();
    result.active_nodes = found.active;
    result.iterations = pressing_->history().iterations;
    set_shape(contact.shape, h_, E_, result);
    result.area_m2 = contact.area * h_ * h_;
    result.indentation_m = found.approach * h_;
    result.load_N =
        problem_.approach_m > 0 ? found.load * E_ * h_ * h_ : problem_.contact.load.normal_force_N;
    result.torque_arm_m = contact_.torque_arm * h_;
    result.pressure_arm_m = contact.torque_arm * h_;
    set_largest_friction(result);
    result.strain_energy_J = found.energy * E_ * h_ * h_ * h_;
    const double load = task_.pressing.load;
    result.load_residual = load > 0 ? std::abs(found.load / load - 1) : 0;
    result.complementarity_residual = found.complementarity_residual;
    return measurement;
  }

  Outcome<std::shared_ptr<FiniteLayer>, FoldedLayer> make_layer(
      const LayerDiscretisation& mesh) const {
    const Pressing& pressing = task_.pressing;
    if (pressing.mesh) return std::make_shared<FiniteLayer>(mesh, *pressing.mesh, h_, materials_);
    return FiniteLayer::made(mesh, pressing.bent.shape, pressing.planes(), materials_);
  }

  /// The node where the contact touches the end of the surface that can be touched; none: nullptr.
  static const SurfaceNode* touched_end(const FinitePressing& pressing) {
    for (const int node : pressing.touching_nodes().node) {
      const SurfaceNode& at = pressing.layer().nodes()[static_cast<std::size_t>(node)];
      if (at.at_end) return &at;
    }
    return nullptr;
  }

  /// Tells whether the contact reaches the end of the layer. If it does, less is pressed, to find
  /// how much would fit.
  /// @throws InputError where the finger ends
  std::optional<FoldedLayer> reached_end() {
    const SurfaceNode* const end = touched_end(*pressing_);
    if (!end) return std::nullopt;
    if (task_.pressing.mesh) refuse_end_of_surface(*end, h_);
    // That takes ten presses, too many on the finer mesh.
    const bool tells_what_fits = tells_what_fits_ && level_ < problem_.level;
    return end_of_layer(*end, task_.pressing, tells_what_fits ? share_that_fits() : std::nullopt);
  }

  /// None where Newton's method stops on the way.
  std::optional<double> share_that_fits() {
    const Pressing& whole = task_.pressing;
    task_.progress("the contact reaches the layer's end: how much would fit");
    try {
      return fem::share_that_fits([&](double share) {
        pressing_->press({share * whole.load, share * whole.approach});
        return !touched_end(*pressing_);
      });
    } catch (const ConvergenceError&) {
      return std::nullopt;
    }
  }

  /// Says how far the load got. A first mesh for a load that is far too large is far too wide and
  /// coarse: the message names it.
  ConvergenceError not_reached(const Equilibrium& last, const LayerDiscretisation& mesh,
                               const ConvergenceError& error) const {
    const std::string where = formatted(
        "finite strain beyond %.4g N (indentation %.4g mm, %.3g of the thickness), the "
        "last load that is converged on a mesh for a/h = %.3g,",
        last.load * E_ * h_ * h_, 1e3 * h_ * last.approach, last.approach, mesh.a);
    const std::string hint =
        last.steepest_rad > steep_rad
            ? formatted(
                  "the contact reaches where the object is %.0f degrees steep and the "
                  "finger's surface slides off: less load or a larger object",
                  last.steepest_rad * 180 / M_PI)
            : "the layer is nearly pressed through, or its surface folds: less load";
    return {where, error.iteration(), error.residual(), hint};
  }

  void check_covered() const {
    const Equilibrium& found = equilibrium();
    const auto& nodes = pressing_->layer().nodes();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (std::hypot(nodes[i].x / found.moment_a, nodes[i].y / found.moment_b) > 1) continue;
      const Eigen::Vector3d at = pressing_->layer().position(i);
      if (!object_->over(at.x(), at.y())) refuse_end_of_object(at.head<2>(), task_.pressing);
    }
  }

  FrictionBound bound() const { return bound(*pressing_); }

  /// The bound of friction on each node of the layer.
  FrictionBound bound(const FinitePressing& pressing) const {
    if (!law_.has_shear_strength()) return law_.friction_coefficient;
    const FiniteLayer& layer = pressing.layer();
    const TouchingNodes touching = pressing.touching_nodes();
    Eigen::VectorXd area = nodal_area(layer), seen = area, radius(area.size());
    for (Eigen::Index i = 0; i < touching.size(); ++i)
      seen[touching.node[static_cast<std::size_t>(i)]] *=
          touching.axes[static_cast<std::size_t>(i)](2, 2);
    const auto& nodes = layer.nodes();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      radius[static_cast<Eigen::Index>(i)] =
          std::hypot(nodes[i].x / contact_.shape.block_a, nodes[i].y / contact_.shape.block_b);
    const Eigen::VectorXd share =
        strength_share(law_, {pressing.equilibrium().force, seen, radius,
                              1.0 / layer.discretisation().elements_per_semi_axis,
                              contact_.shape.projected_area / pressing.copies()});
    return {law_, area.cwiseProduct(share)};
  }

  /// int tau dA, seen along the load under Coulomb's law.
  double largest_force() const {
    if (!law_.has_shear_strength()) return law_.friction_coefficient * equilibrium().load;
    return pressing_->copies() * bound().of(equilibrium().normal_force).sum();
  }

  void set_largest_friction(LevelResult& result) const {
    if (!law_.has_shear_strength()) {
      result.max_force_N = law_.friction_coefficient * result.load_N;
      result.max_torque_Nm = result.max_force_N * contact_.torque_arm * h_;
      result.max_torque_projected_Nm = result.max_force_N * contact_.projected_arm * h_;
      return;
    }
    const double unit_of_force_N = E_ * h_ * h_;
    result.max_force_N = largest_force() * unit_of_force_N;
    // The turn is about the pressure's centre, and so is the torque.
    const Eigen::Vector2d& centre = contact_.centre;
    const FrictionWrench turning = slide(*pressing_, bound(), {centre.y(), -centre.x(), 1});
    const double torque =
        turning.torque - centre.x() * turning.force_y + centre.y() * turning.force_x;
    result.max_torque_Nm = torque * unit_of_force_N * h_;
    const TouchingNodes nodes = pressing_->touching_nodes();
    const Eigen::VectorXd friction = bound().of(equilibrium().normal_force)(nodes.node);
    double projected = 0;
    for (Eigen::Index i = 0; i < nodes.size(); ++i)
      projected += friction[i] * nodes.axes[static_cast<std::size_t>(i)](2, 2) *
                   (nodes.position.col(i).head<2>() - centre).norm();
    result.max_torque_projected_Nm = pressing_->copies() * projected * unit_of_force_N * h_;
  }

  /// The relative error of superposed motions is about friction's energy over this work
  /// (superposed_friction.h).
  double reference_work() const { return equilibrium().load * std::min(1.0, contact_.shape.b); }

  void follow(const FrictionPlan& plan, SuperposedMotion& twist, FrictionOfLevel& result) const {
    const Stopwatch watch;
    for (const std::vector<PlaneMotion>& path : plan.paths) {
      twist.restart();
      std::vector<FrictionState>& states = result.paths.emplace_back();
      for (const PlaneMotion& motion : path) {
        twist.move_to(motion);
        states.push_back({motion, twist.wrench(), twist.slip_fraction(), 0});
      }
    }
    twist.restart();
    for (const PlaneMotion& motion : plan.twist) {
      twist.move_to(motion);
      result.twist.push_back({motion, twist.wrench(), twist.slip_fraction(), 0});
    }
    // A twist changes the pressure by an odd field. The torque changes by the square of that
    // change. It also changes because nodes open or begin to slip. A quarter cannot show this. On
    // whole layers of symmetric contacts it was up to 0.09 of the pressure's change.
    constexpr double unseen_by_quarter = 0.1;
    const double moved = twist.pressure_change();
    result.neglected_of_twist = twist.stored_energy() / reference_work() + moved * moved +
                                (pressing_->layer().planes().any() ? unseen_by_quarter * moved : 0);
    result.neglected_of_full_slip = result.neglected_of_twist;
    if (!problem_.friction.torsion) return;
    task_.progress(formatted(
        "friction: twist of %zu increments to %.3g rad, slip on %.0f %% of the area, surface moved "
        "by %.2g h, pressure by %.1g, neglected %.1g, %.1f s",
        plan.twist.size(), plan.twist.back().turn_rad, 100 * twist.slip_fraction(),
        twist.largest_displacement(), moved, result.neglected_of_twist, watch.seconds()));
  }

  /// Full slip: the limit surface, and on a whole layer that of the twist too, whose turn moves the
  /// torque's own pressure where nothing is odd.
  void slip(const SuperposedSlide& slides, const std::vector<PlaneMotion>& velocities,
            FrictionOfLevel& result) const {
    const double force = largest_force(), torque = result.full_slip;
    if (!pressing_->layer().planes().any())
      result.full_slip = slides.slide({0, 0, 1}).wrench.torque;
    double second_order = 0, moved = 0;
    for (const PlaneMotion& velocity : velocities) {
      const auto [found, energy] = slides.slide(velocity);
      const FrictionWrench frictionless = slide(*pressing_, bound(), velocity);
      second_order = std::max(second_order, energy / reference_work());
      moved = std::max({moved, std::abs(found.force_x - frictionless.force_x) / force,
                        std::abs(found.force_y - frictionless.force_y) / force,
                        std::abs(found.torque - frictionless.torque) / torque});
      result.limit_surface.push_back({velocity, found, 1, 0});
    }
    // The edge, which moves with the pressure, does not follow: of second order in what the
    // pressure's change does. Against the linear solver for small loads: 0.9 times that.
    result.neglected_of_slide = second_order + moved * moved;
  }

  /// Solves the states of the plan on the whole layer.
  /// @throws EdgeLeftMargin with room
  /// @param tangent  of a whole layer
  FrictionCorrection correction(const FrictionOfLevel& superposed, const Eigen::MatrixXd& tangent,
                                bool has_room) {
    const Stopwatch watch;
    std::unique_ptr<FinitePressing> own_whole;
    if (pressing_->layer().planes().any())
      own_whole = press_whole(std::make_shared<FiniteLayer>(
          discretisation(), task_.pressing.bent.shape, no_plane, materials_));
    FinitePressing& whole = own_whole ? *own_whole : *pressing_;
    FrictionCorrecting correcting{{&whole, bound(whole), own_whole ? Eigen::MatrixXd() : tangent}};
    const std::unique_ptr<FinitePressing> coarser = press_coarser();
    if (coarser) {
      correcting.coarser = FrictionMesh{coarser.get(), bound(*coarser), {}};
      correcting.refinement = static_cast<double>(discretisation().elements_per_semi_axis) /
                              coarser->layer().discretisation().elements_per_semi_axis;
    }
    correcting.has_room = has_room;
    correcting.with_turn = problem_.friction.torsion;
    correcting.force = largest_force();
    if (rubbed_) correcting.drag = &rubbed_->drag;
    correcting.progress = task_.progress;
    correcting.on_solved = [this](double turn_rad, const RubbedSurface& surface) {
      series_.add(turn_rad, surface);
    };
    FrictionCorrection result = correct_friction(correcting, superposed);
    result.wall_s = watch.seconds();
    return result;
  }

  /// Presses the same contact on another mesh, of the whole layer. Its object is its own: an object
  /// keeps what it has found of its surface, and friction on two meshes may be solved at a time.
  std::unique_ptr<FinitePressing> press_whole(std::shared_ptr<FiniteLayer> layer) {
    auto whole = std::make_unique<FinitePressing>(std::move(layer), rigid_object(task_.pressing));
    whole->continue_from(*pressing_);
    whole->press({equilibrium().load, 0});
    return whole;
  }

  /// Presses the contact on a mesh that is one level coarser; null where there is none.
  std::unique_ptr<FinitePressing> press_coarser() {
    if (level_ == 0 || task_.pressing.mesh) return nullptr;
    const LayerDiscretisation& own = discretisation();
    LayerDiscretisation usual = own, coarser = own;
    choose_elements(usual, level_);
    choose_elements(coarser, level_ - 1);
    coarser.elements_per_semi_axis *= own.elements_per_semi_axis / usual.elements_per_semi_axis;
    coarser.patch *= own.patch / usual.patch;
    if (!coarser.is_within_reach()) return nullptr;
    // The coarser mesh can fold in a shape in which the finer one does not.
    Outcome<std::shared_ptr<FiniteLayer>, FoldedLayer> layer =
        FiniteLayer::made(coarser, task_.pressing.bent.shape, no_plane, materials_);
    if (!layer) return nullptr;
    try {
      return press_whole(*std::move(layer));
    } catch (const ConvergenceError&) {
      return nullptr;
    }
  }

  const ContactTask& task_;
  bool tells_what_fits_ = true;  ///< where it refuses
  const Problem& problem_;
  const double h_, E_;
  const ShearLaw law_;  ///< in the units of the model
  const Materials materials_;
  const std::shared_ptr<const RigidObject> object_;
  std::shared_ptr<FinitePressing> pressing_;  ///< without friction
  std::optional<RubbedPressing> rubbed_;      ///< the same contact, pressed with friction by `rub`
  std::optional<Drag> drag_;                  ///< by load steps, on a level
  int drag_level_ = 0;
  int level_ = 0;            ///< of that mesh
  DeformedContact contact_;  ///< as measured last, of the frictionless one
  SurfaceSeries series_;
};

}  // namespace

Outcome<Result, Unsolved> solve_finite(const ContactTask& task) {
  FiniteContact contact(task);
  return solve_on_levels(contact, task);
}

}  // namespace softfinger::fem::finite
