#include "fem/levels/level_loop.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <string>
#include <utility>

#include "fem/base/formatted.h"
#include "fem/base/memory.h"
#include "fem/base/stopwatch.h"
#include "fem/base/threads.h"
#include "fem/levels/mesh_size.h"
#include "fem/levels/scan_readings.h"
#include "fem/levels/side_wall.h"
#include "fem/levels/stated_result.h"
#include "fem/levels/trial_meshes.h"
#include "fem/problem/check_problem.h"

namespace softfinger::fem {
namespace {

/// Factor on the usual number of cells of both levels, if the coarse one does not reach the load.
constexpr int finer_levels = 2;
/// Largest patch, over the usual one, where friction moves the contact's edge out of it.
constexpr double roomiest_patch = 2.5;

/// Expected from the level before: cells fourfold, and the factorisation's cost grows a little
/// faster than their number.
/// @param once_s  of its time, what the next one does not need again
std::string time_to_go(const std::vector<LevelResult>& done, int elements, double once_s) {
  if (done.empty()) return "";
  constexpr double order = 2.5;
  const double more = static_cast<double>(elements) / done.back().elements_per_semi_axis;
  return formatted(", about %.2g s to go", (done.back().wall_s - once_s) * std::pow(more, order));
}

/// Does both at the same time, or in turn where there is one thread. If the first one cannot be
/// solved, nothing of the second one counts, not even its failure: the answer does not depend on
/// the number of threads.
template <class First, class Second>
std::optional<Unsolved> first_unsolved(const First& first, const Second& second) {
  std::optional<Unsolved> of_first, of_second;
  std::exception_ptr failure;
  std::atomic<bool> is_given_up{false};
  side_by_side(
      [&] {
        of_first = first();
        is_given_up = of_first.has_value();
      },
      [&] {
        if (is_given_up) return;
        try {
          of_second = second();
        } catch (...) {
          failure = std::current_exception();
        }
      });
  if (of_first) return of_first;
  if (failure) std::rethrow_exception(failure);
  return of_second;
}

class LevelLoop {
 public:
  /// @param trial  outlives this
  LevelLoop(ContactPhysics& physics, const ContactTask& task, const Trial& trial)
      : physics_(physics), task_(task), problem_(task.problem), trial_(trial), mesh_(trial.mesh) {}

  /// Solves both levels, and between them what the side wall changes.
  /// @throws InputError, ConvergenceError, Interrupted
  std::optional<Unsolved> solve() {
    check_twist_axis(problem_, trial_.contact.result);
    if (task_.stop()) throw Interrupted();
    if (const auto unsolved = solve_level(problem_.level - 1)) return unsolved;
    if (!wall_is_near(measured_on_)) return solve_finer_level();
    // The finer level does not depend on the wall, so both can be solved side by side.
    const auto press_other = physics_.press_other();
    const LevelResult free = compared();
    const LayerDiscretisation mesh =
        physics_.shares_meshes() ? physics_.discretisation() : measured_on_;
    // The finer level may lay a scan's layer anew.
    Pressing pressing = task_.pressing;
    if (const auto& shape = pressing.bent.shape)
      if (std::shared_ptr<const LayerShape> own = shape->copy()) pressing.bent.shape = own;
    const ContactTask task{problem_, pressing, task_.progress.place(), task_.stop};
    return first_unsolved(
        [&]() -> std::optional<Unsolved> {
          const Outcome<WallChange, Obstacle> wall = measure_wall(task, mesh, free, press_other);
          task.progress.close();
          if (!wall) return unsolved_by(wall.reason());
          solved_.wall = *wall;
          return std::nullopt;
        },
        [&] { return solve_finer_level(); });
  }

  /// @pre solved
  SolvedLevels& solved() { return solved_; }

 private:
  std::optional<Unsolved> solve_finer_level() {
    if (!task_.stop()) return solve_level(problem_.level);
    keep_finished_level(problem_.level - 1);
    return std::nullopt;
  }

  std::optional<Unsolved> solve_level(int level) {
    const Stopwatch watch;
    const bool is_pressed = level == 0 && physics_.trial_is_level_0() && room_ == 1;
    if (!is_pressed) {
      if (!physics_.shares_meshes()) refine(level);
      std::optional<Obstacle> obstacle = physics_.press(mesh_, level);
      // A coarser mesh may not bear a load that a fine trial mesh bore.
      const bool may_be_finer =
          trial_.refinement > 1 && level_refinement_ == 1 && solved_.results.empty();
      if (obstacle && std::holds_alternative<NotReached>(*obstacle) && may_be_finer) {
        task_.progress(formatted("level %d: %s; once more with finer cells", level,
                                 message_of(*obstacle).c_str()));
        level_refinement_ = finer_levels;
        refine(level);
        obstacle = physics_.press(mesh_, level);
      }
      if (obstacle) return unsolved_by(*obstacle);
    }
    if (const RoughSize size = physics_.size(); size.reaches_rim) {
      if (physics_.shares_meshes()) return MeshesDoNotServe{};
      task_.progress(formatted("level %d: the contact outgrew its mesh; a larger one", level));
      if (const auto obstacle = grow_mesh(level)) return unsolved_by(*obstacle);
      if (physics_.size().reaches_rim)
        throw ConvergenceError("size of the refined patch", level, size.a / mesh_.a,
                               "the contact outgrew the patch on refinement");
    }
    if (const auto obstacle = physics_.rub()) return unsolved_by(*obstacle);
    Outcome<Measurement, Unmeasured> found = physics_.measure();
    if (!found && found.reason().outgrew_patch) {
      // The outline passes beside the cells that were made for it.
      if (physics_.shares_meshes()) return MeshesDoNotServe{};
      task_.progress(
          formatted("level %d: the contact is not where its mesh is; a larger one", level));
      if (const auto obstacle = grow_mesh(level)) return unsolved_by(*obstacle);
      if (const auto obstacle = physics_.rub()) return unsolved_by(*obstacle);
      found = physics_.measure();
    }
    if (!found) throw found.reason().error;
    if (problem_.friction.any() && !solve_friction(level)) {
      if (physics_.shares_meshes()) return MeshesDoNotServe{};
      return solve_level(level);
    }
    keep(*std::move(found), level, watch);
    return std::nullopt;
  }

  /// Cells of the same size, in a larger patch: large cells may not bear what these do.
  std::optional<Obstacle> grow_mesh(int level) {
    mesh_.patch *= growth_at_rim;
    check_reach(mesh_, problem_);
    return physics_.press(mesh_, level);
  }

  /// Whether a larger patch can still be meshed.
  bool has_room() const {
    LayerDiscretisation larger = mesh_;
    larger.patch *= growth_at_rim;
    return physics_.shares_meshes() ||
           (room_ * growth_at_rim <= roomiest_patch && larger.is_within_reach());
  }

  /// @returns false where friction moves the contact's edge out of the patch: the next one is
  /// planned larger
  bool solve_friction(int level) {
    try {
      solved_.friction.push_back(physics_.friction(plan_, has_room()));
      return true;
    } catch (const EdgeLeftMargin& error) {
      if (!physics_.shares_meshes() && room_ * growth_at_rim > roomiest_patch) throw;
      room_ *= growth_at_rim;
      // The first level plans anew.
      if (solved_.friction.empty()) plan_.reset();
      task_.progress(formatted("level %d: %s; once more with %.3g times the room around it", level,
                               error.what(), room_));
      return false;
    }
  }

  void refine(int level) {
    choose_elements(mesh_, level);
    mesh_.elements_per_semi_axis *= level_refinement_;
    mesh_.patch *= room_;
    // It is known from the coarse level how far friction moves the edge.
    if (plan_)
      mesh_.patch =
          std::max(mesh_.patch, plan_->edge + spare_margin / mesh_.elements_per_semi_axis);
    // The error is estimated from the difference of two meshes. A mesh from outside may be finer
    // than both levels ask for and would stay as it is: its cells are halved for the second level.
    if (problem_.mesh && !solved_.results.empty())
      mesh_.elements_per_semi_axis = 2 * solved_.results.back().elements_per_semi_axis;
    const bool was_corrected = !solved_.friction.empty() && solved_.friction.back().correction;
    const double once_s = was_corrected ? solved_.friction.back().correction->wall_s : 0;
    task_.progress(
        formatted("level %d: %d elements per semi-axis%s", level, mesh_.elements_per_semi_axis,
                  time_to_go(solved_.results, mesh_.elements_per_semi_axis, once_s).c_str()));
    tell_unknowns(formatted("level %d", level), mesh_, physics_, task_);
    check_reach(mesh_, problem_);
  }

  void keep(Measurement found, int level, const Stopwatch& watch) {
    LevelResult& result = found.result;
    result.level = level;
    result.wall_s = watch.seconds();
    result.cpu_s = watch.cpu_seconds();
    tell(found);
    solved_.results.push_back(result);
    solved_.frictionless = found.frictionless;
    compared_ = found.compared ? found.compared : found.frictionless;
    solved_.misfit = std::max(solved_.misfit, misfit(mesh_, found.block_a, found.block_b));
    measured_on_ = mesh_;
    fit_to(found.block_a, found.block_b, mesh_);
  }

  void tell(const Measurement& found) const {
    const LevelResult& result = found.result;
    task_.progress(formatted(
        "level %d: unknowns %ld, contact nodes %d%s, a %.5g mm, b %.5g mm, d %.5g mm, torque %.5g "
        "mN m, residual %.1g, %.1f s, peak memory %.0f MB",
        result.level, result.unknowns, result.active_nodes, physics_.size().effort.c_str(),
        1e3 * result.a_m, 1e3 * result.b_m, 1e3 * result.indentation_m, 1e3 * result.max_torque_Nm,
        found.residual, result.wall_s, peak_memory_MB()));
  }

  /// The error of a single level cannot be estimated: the last trial mesh takes the place of the
  /// coarse level.
  /// @throws Interrupted where no level is finished, or the trial mesh is that level's own
  void keep_finished_level(int level) {
    if (solved_.results.empty() || physics_.shares_meshes() ||
        trial_.contact.result.elements_per_semi_axis >=
            solved_.results.front().elements_per_semi_axis)
      throw Interrupted();
    solved_.interrupted = true;
    solved_.results.insert(solved_.results.begin(), trial_as_rubbed());
    task_.progress(formatted("stopped: the answer is that of level %d", level));
  }

  /// The last level's answer as trials and other walls are pressed.
  const LevelResult& compared() const {
    return physics_.rubs_on_levels_only() ? *compared_ : solved_.fine();
  }

  /// The trial's answer, changed by friction as the finished level was.
  LevelResult trial_as_rubbed() const {
    LevelResult result = trial_.contact.result;
    for (const auto quantity :
         {&LevelResult::a_m, &LevelResult::b_m, &LevelResult::area_projected_m2,
          &LevelResult::area_m2, &LevelResult::indentation_m, &LevelResult::peak_pressure_Pa,
          &LevelResult::centre_pressure_Pa, &LevelResult::pressure_arm_m, &LevelResult::load_N})
      result.*quantity *= solved_.fine().*quantity / compared().*quantity;
    return result;
  }

  ContactPhysics& physics_;
  const ContactTask& task_;
  const Problem& problem_;
  const Trial& trial_;
  LayerDiscretisation mesh_;  ///< of the next level
  int level_refinement_ = 1;
  double room_ = 1;                  ///< of the patch, over that of the usual one
  LayerDiscretisation measured_on_;  ///< mesh of the last level
  std::optional<FrictionPlan> plan_;
  std::optional<LevelResult> compared_;  ///< of the last level
  SolvedLevels solved_;
};

/// Solves the levels of a scan, and the errors by perturbed scans, which do not depend on them.
std::optional<Unsolved> solve_beside_readings(ContactPhysics& physics, const ContactTask& task,
                                              const Trial& trial, LevelLoop& levels,
                                              ScanErrors& errors) {
  std::optional<ReadingStart> start = start_readings(physics, trial.contact.result, task);
  const auto read = [&]() -> std::optional<Unsolved> {
    const Outcome<RelativeError, FoldedLayer> core = core_error(*start, task);
    if (!core) return core.reason();
    errors.core = *core;
    errors.geometry = geometry_error(*start, task);
    start->progress.close();
    return std::nullopt;
  };
  if (!task.problem.friction.any()) return first_unsolved(read, [&] { return levels.solve(); });
  // Friction takes most of the memory: the perturbed scans have released theirs by then.
  if (const auto unsolved = read()) return unsolved;
  start.reset();
  return levels.solve();
}

/// On a scan the object and the finger do not quite touch first at the aimed point.
void tell_first_touch(const ContactTask& task) {
  const Pressing& pressing = task.pressing;
  const Eigen::Vector3d at_mm = 1e3 * pressing.thickness_m * pressing.bent.first_touch;
  constexpr double worth_telling = 0.05;
  if (pressing.bent.first_touch.head<2>().norm() > worth_telling)
    task.progress(
        formatted("first touch at x %.3g, y %.3g mm from the aimed point", at_mm.x(), at_mm.y()));
}

}  // namespace

Outcome<Result, Unsolved> solve_on_levels(ContactPhysics& physics, const ContactTask& task) {
  tell_first_touch(task);
  const Outcome<Trial, Unsolved> trial = find_trial(physics, task);
  if (!trial) return trial.reason();
  LevelLoop levels(physics, task, *trial);
  ScanErrors scan;
  const std::optional<Unsolved> unsolved =
      task.problem.fingertip.scan ? solve_beside_readings(physics, task, *trial, levels, scan)
                                  : levels.solve();
  if (unsolved) return *unsolved;
  SolvedLevels& solved = levels.solved();
  if (!meshes_serve(solved, physics.error_table(), task)) return Unsolved(MeshesDoNotServe{});
  for (LevelResult& level : solved.results) correct_wall(solved.wall, level);
  if (solved.frictionless) correct_wall(solved.wall, *solved.frictionless);
  return stated_result(std::move(solved), scan, physics, task);
}

}  // namespace softfinger::fem
