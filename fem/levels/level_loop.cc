#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <functional>
#include <utility>

#include "fem/algebra/cholesky.h"
#include "fem/base/formatted.h"
#include "fem/base/memory.h"
#include "fem/base/stopwatch.h"
#include "fem/base/threads.h"
#include "fem/contact/touching_outline.h"
#include "fem/friction/friction_study.h"
#include "fem/levels/level_loop.h"
#include "fem/problem/check_problem.h"
#include "meshes/generation/object_surface.h"

namespace softfinger::fem {
namespace {

/// Semi-axes over h that first guesses are kept to: what a contact may have (check in
/// linear_contact.cc), b with room to overshoot.
constexpr double smallest_guess = 1e-4, largest_guess_b = 60, largest_guess_a = 300;
/// Trial meshes. Most contacts take two or three.
constexpr int most_trials = 15;
/// Mesh and contact agree when they differ by less than this share.
constexpr double trial_agreement = 0.08;
/// The room of a trial mesh's patch around the contact that it is made for, as that share.
const double room_of_trial_patch = std::log(1.25);
/// After so many trials a mesh serves whose patch has room for the contact: the outline of a scan's
/// contact may jump by a node from one mesh to the next for ever. Twice as many as most need.
constexpr int most_strict_trials = 7;
/// Cells of a trial mesh, times those of the usual one, where the load is not reached.
constexpr int finest_trial = 3;
/// Cells of both levels, times those of the usual ones, where the coarse one does not reach it.
constexpr int finer_levels = 2;
/// Trial after which the next mesh lies half-way to what was found: coarse cells may tell one size
/// on another's mesh in turn.
constexpr int whole_way = 3;
/// At the rim of the patch the moments only bound the contact from below.
constexpr double growth_at_rim = 1.3;
/// Relative change of the mesh's size that is worth another try where the load was not reached.
constexpr double worth_another = 0.25;
/// Largest patch, over the usual one, where friction moves the contact's edge out of it.
constexpr double roomiest_patch = 2.5;
/// A contact larger than its mesh is made for by this much still lies in the refined patch.
constexpr double spare_size = 0.1;

constexpr std::array<double RelativeError::*, 7> relative_errors{&RelativeError::a,
                                                                 &RelativeError::b,
                                                                 &RelativeError::area,
                                                                 &RelativeError::indentation,
                                                                 &RelativeError::peak_pressure,
                                                                 &RelativeError::max_torque,
                                                                 &RelativeError::load};

/// To one part in a thousand, so that contacts of one size ask for the very same mesh: far below a
/// cell, which is what the edge has to meet.
double rounded(double semi_axis) {
  constexpr double step = 1e-3;
  return std::exp(step * std::round(std::log(semi_axis) / step));
}

void keep_guess_sensible(LayerDiscretisation& mesh) {
  // A straight finger's radius may be anything.
  const double largest_a = mesh.is_scan ? farthest_facet : largest_guess_a;
  mesh.b = rounded(std::clamp(mesh.b, smallest_guess, std::min(largest_guess_b, largest_a)));
  mesh.a = rounded(std::clamp(mesh.a, smallest_guess, largest_a));
}

/// How far a contact and the mesh it is on differ in size.
double misfit(const LayerDiscretisation& mesh, double a, double b) {
  return std::max(std::abs(std::log(a / mesh.a)), std::abs(std::log(b / mesh.b)));
}

void check_reach(const LayerDiscretisation& mesh, const Problem& problem) {
  if (mesh.is_within_reach()) return;
  const Eigen::Vector2d reach = mesh.needed_reach();
  const double mm = 1e3 * problem.contact.layer.thickness_m;
  throw too_much(problem,
                 formatted("less, or a larger pad: the contact needs the finger's surface up to "
                           "%.3g x %.3g mm from the contact point, and a layer fits on it up to "
                           "%.3g x %.3g mm",
                           mm * reach.x(), mm * reach.y(), mm * mesh.reach_x, mm * mesh.reach_y));
}

/// Expected from the level before: cells fourfold, and the factorisation's cost grows a little
/// faster than their number.
/// @param once_s  of its time, what the next one does not need again
std::string time_to_go(const std::vector<LevelResult>& done, int elements, double once_s) {
  if (done.empty()) return "";
  constexpr double order = 2.5;
  const double more = static_cast<double>(elements) / done.back().elements_per_semi_axis;
  return formatted(", about %.2g s to go", (done.back().wall_s - once_s) * std::pow(more, order));
}

/// Pressure along x or y, from the nodes on that axis of the block.
Profile profile_of(const std::vector<PressurePoint>& nodes, const ElasticLayer& layer,
                   bool along_x) {
  constexpr double on_axis = 1e-9;
  std::vector<std::pair<double, double>> points;
  for (const PressurePoint& node : nodes)
    if (std::abs(along_x ? node.block_y : node.block_x) <= on_axis)
      points.emplace_back(layer.thickness_m * (along_x ? node.x : node.y),
                          layer.youngs_modulus_Pa * node.pressure);
  std::sort(points.begin(), points.end());
  Profile profile;
  for (const auto& [position_m, pressure_Pa] : points) {
    profile.position_m.push_back(position_m);
    profile.pressure_Pa.push_back(pressure_Pa);
  }
  return profile;
}

/// A folded layer may be pressed on another core. A load that is not reached is an error.
/// @throws ConvergenceError
Unsolved unsolved_by(const Obstacle& obstacle) {
  if (const auto* last = std::get_if<NotReached>(&obstacle)) throw last->error;
  return std::get<FoldedLayer>(obstacle);
}

/// @throws ConvergenceError
Measurement measured(ContactPhysics& physics) {
  Outcome<Measurement, Unmeasured> measurement = physics.measure();
  if (!measurement) throw measurement.reason().error;
  return *std::move(measurement);
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
  LevelLoop(ContactPhysics& physics, const ContactTask& task)
      : physics_(physics), task_(task), problem_(task.problem) {}

  Outcome<Result, Unsolved> run() {
    tell_first_touch();
    if (const auto unsolved = find_size()) return *unsolved;
    if (const auto unsolved =
            problem_.fingertip.scan ? solve_levels_beside_readings() : solve_levels())
      return *unsolved;
    if (!meshes_serve()) return Unsolved(MeshesDoNotServe{});
    correct_wall();
    estimate();
    describe();
    return std::move(result_);
  }

 private:
  /// Which is not quite at the aimed point where that is a scan's.
  void tell_first_touch() const {
    const Pressing& pressing = task_.pressing;
    const Eigen::Vector3d at_mm = 1e3 * pressing.thickness_m * pressing.bent.first_touch;
    constexpr double worth_telling = 0.05;
    if (pressing.bent.first_touch.head<2>().norm() > worth_telling)
      task_.progress(
          formatted("first touch at x %.3g, y %.3g mm from the aimed point", at_mm.x(), at_mm.y()));
  }

  std::optional<Unsolved> find_size() {
    if (physics_.shares_meshes()) {
      if (const auto obstacle = physics_.press({}, problem_.level - 1))
        return unsolved_by(*obstacle);
    } else {
      mesh_ = first_guess(task_.pressing);
      mesh_.a = std::max(mesh_.a, mesh_.b);
      keep_guess_sensible(mesh_);
      if (problem_.size_hint_m) take_hint(*problem_.size_hint_m);
      for (int trial = 1;; ++trial) {
        const std::optional<Obstacle> obstacle = press_trial(trial);
        if (obstacle && std::holds_alternative<FoldedLayer>(*obstacle))
          return unsolved_by(*obstacle);
        if (!obstacle && fits_trial(trial)) break;
        if (obstacle) plan_beyond(std::get<NotReached>(*obstacle), trial);
        if (task_.stop()) throw Interrupted();
      }
    }
    trial_ = measured(physics_);
    trial_.result.level = 0;
    fit_mesh_to(trial_.block_a, trial_.block_b);
    if (const auto beside = off_centre()) return *beside;
    if (physics_.shares_meshes())
      task_.progress(
          formatted("meshes of an earlier contact, %.3g times as large", trial_.result.oversize));
    return std::nullopt;
  }

  /// The object turns about where coordinates begin. A hundredth of the contact beside its centre
  /// is worth 1e-4 of the torque of a symmetric pressure, up to 3e-3 of one that ends at an edge.
  std::optional<OffCentre> off_centre() const {
    constexpr double tolerated = 0.01;
    const FingertipShape& bent = task_.pressing.bent;
    if (!problem_.friction.any() || !bent.shape || !bent.centre.isZero(0) ||
        trial_.centre.norm() <= tolerated * trial_.block_b)
      return std::nullopt;
    const double h = task_.pressing.thickness_m;
    return OffCentre{trial_.centre, {h * mesh_.a, h * mesh_.b}};
  }

  std::optional<Unsolved> solve_levels() {
    check_twist_axis(problem_, trial_.result);
    if (task_.stop()) throw Interrupted();
    if (const auto unsolved = solve_level(problem_.level - 1)) return unsolved;
    if (!wall_is_near(measured_on_)) return solve_finer_level();
    // What the finer level asks for does not depend on the wall.
    const auto press_other = physics_.press_other();
    const LevelResult free = coarse();
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
          result_.wall = *wall;
          return std::nullopt;
        },
        [&] { return solve_finer_level(); });
  }

  std::optional<Unsolved> solve_finer_level() {
    if (!task_.stop()) return solve_level(problem_.level);
    keep_finished_level(problem_.level - 1);
    return std::nullopt;
  }

  /// What other readings of the scan tell does not change the levels.
  std::optional<Unsolved> solve_levels_beside_readings() {
    std::optional<Readings> readings{
        {physics_.press_other(), physics_.discretisation(), trial_.result, task_.progress.place()}};
    const auto read = [&]() -> std::optional<Unsolved> {
      const Outcome<RelativeError, FoldedLayer> core_error = measure_core(*readings);
      if (!core_error) return core_error.reason();
      core_error_ = *core_error;
      result_.geometry_error = measure_readings(*readings);
      readings->tell.close();
      return std::nullopt;
    };
    if (!problem_.friction.any()) return first_unsolved(read, [&] { return solve_levels(); });
    // Friction takes most of the memory: the readings have given theirs back by then.
    if (const auto unsolved = read()) return unsolved;
    readings.reset();
    return solve_levels();
  }

  /// A hint for which the layer has no room would refuse what may fit.
  void take_hint(const std::array<double, 2>& size_m) {
    LayerDiscretisation hinted = mesh_;
    hinted.a = size_m[0] / task_.pressing.thickness_m;
    hinted.b = size_m[1] / task_.pressing.thickness_m;
    keep_guess_sensible(hinted);
    choose_elements(hinted, 0);
    if (hinted.is_within_reach()) mesh_ = hinted;
  }

  std::optional<Obstacle> press_trial(int trial) {
    choose_elements(mesh_, 0);
    mesh_.elements_per_semi_axis *= trial_refinement_;
    check_reach(mesh_, problem_);
    tell_unknowns(formatted("mesh %d", trial));
    return physics_.press(mesh_, 0);
  }

  /// Plans the next trial mesh where the load was not reached. On a mesh that is made for the
  /// contact so far, and then on a finer one, Newton's method may get farther: coarse cells beside
  /// the contact collapse under large strain.
  /// @throws ConvergenceError where another mesh promises nothing
  void plan_beyond(const NotReached& last, int trial) {
    if (trial == most_trials || !(last.b > 0)) throw last.error;
    const double a = rounded(growth_at_rim * last.a), b = rounded(growth_at_rim * last.b);
    if (misfit(mesh_, a, b) < worth_another) {
      if (trial_refinement_ == finest_trial) throw last.error;
      ++trial_refinement_;
    }
    task_.progress(formatted("mesh %d: %s; once more on a mesh for a/h %.3g, b/h %.3g", trial,
                             last.error.what(), a, b));
    mesh_.a = a;
    mesh_.b = b;
  }

  /// Whether the trial mesh that is pressed suits the contact. If not, the next one is planned.
  bool fits_trial(int trial) {
    const RoughSize found = physics_.size();
    const double difference = misfit(mesh_, found.a, found.b);
    task_.progress(formatted("mesh %d: a/h %.4g, b/h %.4g, d/h %.4g, unknowns %ld%s%s", trial,
                             found.a, found.b, found.approach, found.unknowns, found.effort.c_str(),
                             found.reaches_rim ? ", contact at the rim" : ""));
    const double close_enough = trial <= most_strict_trials ? trial_agreement : room_of_trial_patch;
    if (!found.reaches_rim && difference < close_enough) return true;
    if (trial == most_trials)
      throw ConvergenceError("size of the refined patch", most_trials, difference,
                             "the contact's size depends on the mesh; is the contact elliptic?");
    if (found.reaches_rim)
      fit_mesh_to(growth_at_rim * found.a, growth_at_rim * found.b);
    else if (trial <= whole_way)
      fit_mesh_to(found.a, found.b);
    else
      fit_mesh_to(std::sqrt(found.a * mesh_.a), std::sqrt(found.b * mesh_.b));
    return false;
  }

  void fit_mesh_to(double a, double b) {
    mesh_.a = rounded(a);
    mesh_.b = rounded(b);
  }

  std::optional<Unsolved> solve_level(int level) {
    const Stopwatch watch;
    const bool is_pressed = level == 0 && physics_.trial_is_level_0() && room_ == 1;
    if (!is_pressed) {
      if (!physics_.shares_meshes()) refine(level);
      std::optional<Obstacle> obstacle = physics_.press(mesh_, level);
      // What a fine trial mesh bore, a coarser one may not.
      const bool may_be_finer =
          trial_refinement_ > 1 && level_refinement_ == 1 && result_.levels.empty();
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
    Outcome<Measurement, Unmeasured> found = physics_.measure();
    if (!found && found.reason().outgrew_patch) {
      // The outline passes beside the cells that were made for it.
      if (physics_.shares_meshes()) return MeshesDoNotServe{};
      task_.progress(
          formatted("level %d: the contact is not where its mesh is; a larger one", level));
      if (const auto obstacle = grow_mesh(level)) return unsolved_by(*obstacle);
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
      friction_.push_back(physics_.friction(plan_, has_room()));
      return true;
    } catch (const EdgeLeftMargin& error) {
      if (!physics_.shares_meshes() && room_ * growth_at_rim > roomiest_patch) throw;
      room_ *= growth_at_rim;
      // The first level plans anew.
      if (friction_.empty()) plan_.reset();
      task_.progress(formatted("level %d: %s; once more with %.3g times the room around it", level,
                               error.what(), room_));
      return false;
    }
  }

  void refine(int level) {
    choose_elements(mesh_, level);
    mesh_.elements_per_semi_axis *= level_refinement_;
    mesh_.patch *= room_;
    // The coarse level has told how far friction moves the edge.
    if (plan_)
      mesh_.patch =
          std::max(mesh_.patch, plan_->edge + spare_margin / mesh_.elements_per_semi_axis);
    // The error is estimated from the difference of two meshes. A mesh from outside may be finer
    // than both levels ask for and would stay as it is: its cells are halved for the second level.
    if (problem_.mesh && !result_.levels.empty())
      mesh_.elements_per_semi_axis = 2 * result_.levels.back().elements_per_semi_axis;
    const bool was_corrected = !friction_.empty() && friction_.back().correction;
    const double once_s = was_corrected ? friction_.back().correction->wall_s : 0;
    task_.progress(
        formatted("level %d: %d elements per semi-axis%s", level, mesh_.elements_per_semi_axis,
                  time_to_go(result_.levels, mesh_.elements_per_semi_axis, once_s).c_str()));
    tell_unknowns(formatted("level %d", level));
    check_reach(mesh_, problem_);
  }

  /// Cells of a mesh from outside are halved until they are small enough, which may make far more
  /// of them than anybody expects.
  void tell_unknowns(const std::string& mesh) const {
    if (problem_.mesh)
      task_.progress(formatted("%s: the mesh from outside makes %ld unknowns", mesh.c_str(),
                               physics_.predicted_unknowns(mesh_)));
  }

  void keep(Measurement found, int level, const Stopwatch& watch) {
    LevelResult& result = found.result;
    result.level = level;
    result.wall_s = watch.seconds();
    result.cpu_s = watch.cpu_seconds();
    tell(found);
    result_.levels.push_back(result);
    misfit_ = std::max(misfit_, misfit(mesh_, found.block_a, found.block_b));
    measured_on_ = mesh_;
    fit_mesh_to(found.block_a, found.block_b);
  }

  /// Whether what lies beyond the side wall may change the contact.
  bool wall_is_near(const LayerDiscretisation& mesh) const {
    return mesh.is_scan || std::min(mesh.reach_x - mesh.a, mesh.reach_y - mesh.b) < mesh.extent;
  }

  /// Where other readings of a scan start from.
  struct Readings {
    ContactPhysics::PressOther press;
    LayerDiscretisation mesh;
    LevelResult best;
    OrderedProgress tell;
  };

  /// The core's ridge is drawn by ways from the surface that end on it, and by cells that are not
  /// fitted to it. How far other ways change the answer tells what that leaves open: all of the
  /// largest change is stated.
  Outcome<RelativeError, FoldedLayer> measure_core(const Readings& readings) const {
    const CoreWays own = task_.pressing.bent.ways;
    if (own == CoreWays::smoothed) return RelativeError{};
    std::vector<Other> others;
    for (const CoreWays ways :
         {CoreWays::eroded, CoreWays::eroded_nearer, CoreWays::eroded_smoother, CoreWays::smoothed})
      if (ways != own) others.push_back({{}, ways});
    RelativeError largest;
    bool is_known = false;
    for (const std::optional<RelativeError>& change : changes_by(others, readings)) {
      if (!change) continue;
      is_known = true;
      for (const auto quantity : relative_errors)
        largest.*quantity = std::max(largest.*quantity, *change.*quantity);
    }
    if (!is_known && !task_.stop())
      return FoldedLayer{InputError("contact", "room on the finger",
                                    "its layer would fold with all ways to its core but one",
                                    "less load, or another point")};
    readings.tell(formatted(
        "core: what its ridge leaves open changes a by %.3g, area by %.3g, d by %.3g, torque by "
        "%.3g %%",
        100 * largest.a, 100 * largest.area, 100 * largest.indentation, 100 * largest.max_torque));
    return largest;
  }

  /// What the scan's triangles tell, read in other ways. At random: where the surface lies, with
  /// vertices moved by what facets leave open. The finger is held by its own normal, which they
  /// change, too. Beyond that interval, not at random: what is smoothed away, and the frame, whose
  /// normal was fitted over a larger region than the contact asks for where facets are large.
  std::optional<RelativeError> measure_readings(const Readings& readings) const {
    constexpr double wider = 1.5;
    const FingertipShape& bent = task_.pressing.bent;
    const auto moved = [&](unsigned int pattern) {
      return Other{[&bent, pattern](double part) {
                     return Reading{1, part, pattern, bent.own_normal};
                   },
                   bent.ways};
    };
    const auto smoother = [](double part) {
      return Reading{1 + part * (wider - 1), 0, 0, std::nullopt};
    };
    std::vector<Other> others{moved(1), moved(2), {smoother, bent.ways}};
    if (const double share = problem_.fingertip.region_excess; share > 0) {
      const auto to_frame =
          Eigen::Quaterniond::FromTwoVectors(bent.own_normal, Eigen::Vector3d::UnitZ());
      const auto held = [=, &bent](double part) {
        const Eigen::Vector3d normal =
            Eigen::Quaterniond::Identity().slerp(part * share, to_frame) * bent.own_normal;
        return Reading{1, 0, 0, normal};
      };
      others.push_back({held, bent.ways});
    }
    const Changes changes = changes_by(others, readings);
    Changes random(changes.begin(), changes.begin() + 2);
    const Changes systematic(changes.begin() + 2, changes.end());
    // What a systematic change would be cannot be told from the others.
    if (std::count(systematic.begin(), systematic.end(), std::nullopt) > 0) return std::nullopt;
    std::optional<RelativeError> stated = left_open(random, systematic);
    // Two samples make a wide interval. What is less than this hardly matters to a choice of model.
    constexpr double worth_more_samples = 0.03;
    const auto is_large = [&](double RelativeError::*quantity) {
      return (*stated).*quantity > worth_more_samples;
    };
    if (!stated || std::any_of(relative_errors.begin(), relative_errors.end(), is_large)) {
      for (const auto& change : changes_by({moved(3), moved(4)}, readings))
        random.push_back(change);
      stated = left_open(random, systematic);
    }
    if (!stated) return std::nullopt;
    readings.tell(formatted(
        "geometry: what facets and noise leave open changes a by %.3g, area by %.3g, d by %.3g, "
        "torque by %.3g %%",
        100 * stated->a, 100 * stated->area, 100 * stated->indentation, 100 * stated->max_torque));
    return stated;
  }

  using Changes = std::vector<std::optional<RelativeError>>;

  /// The interval of 95 % around no change, by Student's factor for as many samples as could be
  /// pressed, and the systematic changes. None without a sample.
  static std::optional<RelativeError> left_open(const Changes& random, const Changes& systematic) {
    constexpr std::array<double, 5> student = {0, 12.706, 4.303, 3.182, 2.776};
    const auto count = static_cast<std::size_t>(std::count_if(
        random.begin(), random.end(), [](const auto& change) { return change.has_value(); }));
    if (count == 0) return std::nullopt;
    const auto norm = [](const Changes& changes, double RelativeError::*quantity) {
      double squares = 0;
      for (const std::optional<RelativeError>& change : changes)
        if (change) squares += (*change).*quantity * (*change).*quantity;
      return std::sqrt(squares);
    };
    RelativeError result;
    for (const auto quantity : relative_errors)
      result.*quantity =
          student.at(count) * norm(random, quantity) / std::sqrt(static_cast<double>(count)) +
          norm(systematic, quantity);
    return result;
  }

  /// Another reading of the scan, by how much of its change is made, and ways to the core.
  struct Other {
    std::function<Reading(double part)> reading;  ///< none: the best one
    CoreWays ways;
  };

  /// Relative changes by other readings, on the trial mesh. None where one cannot be pressed.
  Changes changes_by(const std::vector<Other>& others, const Readings& readings) const {
    Changes changes(others.size());
    std::vector<OrderedProgress> tell;
    for (std::size_t i = 0; i < others.size(); ++i) tell.push_back(readings.tell.place());
    in_parallel(static_cast<int>(others.size()), [&](int number) {
      const auto i = static_cast<std::size_t>(number);
      changes[i] = change_or_less(others[i], readings, tell[i]);
      tell[i].close();
    });
    return changes;
  }

  /// Where a layer would fold, less of the change is made: what follows is taken to be in
  /// proportion.
  std::optional<RelativeError> change_or_less(const Other& other, const Readings& readings,
                                              const OrderedProgress& tell) const {
    constexpr double least_part = 0.25;
    for (double part = 1; part >= least_part && !task_.stop(); part /= 2) {
      std::string failure;
      try {
        Outcome<RelativeError, std::string> change =
            change_by(other.reading ? other.reading(part) : Reading(), other.ways, readings, tell);
        if (change) {
          for (const auto quantity : relative_errors) (*change).*quantity /= part;
          return *change;
        }
        failure = change.reason();
      } catch (const NotEnoughMemory&) {
        throw;
      } catch (const Interrupted&) {
        return std::nullopt;
      } catch (const std::runtime_error& error) {
        failure = error.what();
      }
      tell("geometry: another reading of the scan or its core cannot be pressed: " + failure);
      if (!other.reading) break;
    }
    return std::nullopt;
  }

  /// @returns the change, or why this reading cannot be pressed
  Outcome<RelativeError, std::string> change_by(const Reading& reading, CoreWays ways,
                                                const Readings& readings,
                                                const OrderedProgress& tell) const {
    Pressing other = task_.pressing;
    other.bent = shape_fingertip(other.fingertip, other.thickness_m, reading, ways);
    // What starts from this contact has its coordinates.
    const Eigen::Vector2d& centre = task_.pressing.bent.centre;
    if (!centre.isZero(0)) other.bent = other.bent.seen_from(centre);
    const ContactTask task{problem_, other, tell, task_.stop};
    const auto pressed = readings.press(task, readings.mesh);
    if (!pressed) return message_of(pressed.reason());
    ContactPhysics* const physics = pressed->get();
    // It touches first elsewhere, so that it may lie beside the patch that was refined.
    const auto fits = [&] {
      const RoughSize size = physics->size();
      const LayerDiscretisation& mesh = physics->discretisation();
      return !size.reaches_rim && std::max(size.a / mesh.a, size.b / mesh.b) < 1 + spare_size;
    };
    for (int trial = 1; !fits() && trial < most_trials; ++trial) {
      LayerDiscretisation mesh = physics->discretisation();
      const RoughSize size = physics->size();
      const double growth = size.reaches_rim ? growth_at_rim : 1;
      mesh.a = rounded(growth * size.a);
      mesh.b = rounded(growth * size.b);
      if (const auto obstacle = physics->press(mesh, 0)) return message_of(*obstacle);
    }
    const Outcome<Measurement, Unmeasured> measurement = physics->measure();
    if (!measurement) return std::string(measurement.reason().error.what());
    const LevelResult& found = measurement->result;
    const auto change = [&](double LevelResult::*quantity) {
      return std::abs(found.*quantity / readings.best.*quantity - 1);
    };
    return RelativeError{change(&LevelResult::a_m),
                         change(&LevelResult::b_m),
                         change(&LevelResult::area_projected_m2),
                         change(&LevelResult::indentation_m),
                         change(&LevelResult::peak_pressure_Pa),
                         change(&LevelResult::max_torque_Nm),
                         change(&LevelResult::load_N)};
  }

  /// A free wall yields too much and a clamped one too little.
  /// @param mesh   of the level
  /// @param press  from its state
  Outcome<WallChange, Obstacle> measure_wall(const ContactTask& task, LayerDiscretisation mesh,
                                             const LevelResult& free,
                                             const ContactPhysics::PressOther& press) const {
    mesh.clamped_wall = true;
    const auto pressed = press(task, mesh);
    if (!pressed) return pressed.reason();
    ContactPhysics& physics = **pressed;
    Outcome<Measurement, Unmeasured> measurement = physics.measure();
    if (!measurement && measurement.reason().outgrew_patch) {
      mesh.patch *= growth_at_rim;
      if (const auto obstacle = physics.press(mesh, 0)) return *obstacle;
      measurement = physics.measure();
      if (!measurement && measurement.reason().outgrew_patch)
        if (const auto folded = physics.end_beside()) return Obstacle(*folded);
    }
    if (!measurement) throw measurement.reason().error;
    const LevelResult& clamped = measurement->result;
    const auto half = [&](double LevelResult::*quantity) {
      return (clamped.*quantity / free.*quantity - 1) / 2;
    };
    // The arm of the pressure is a length of the contact, and one that no fit blurs.
    const double load = half(&LevelResult::load_N), length = half(&LevelResult::torque_arm_m);
    const WallChange wall{length,
                          length,
                          2 * length,
                          half(&LevelResult::indentation_m),
                          load - 2 * length,
                          half(&LevelResult::max_torque_Nm),
                          load,
                          half(&LevelResult::max_force_N)};
    task.progress(
        formatted("side wall: clamped it would change the contact's size by %.2g, d by "
                  "%.2g, load by %.2g %%; half of that is taken",
                  200 * length, 200 * wall.indentation, 200 * load));
    return wall;
  }

  void correct_wall() {
    const WallChange& wall = result_.wall;
    for (LevelResult& level : result_.levels) {
      level.a_m *= 1 + wall.a;
      level.b_m *= 1 + wall.b;
      level.area_projected_m2 *= 1 + wall.area;
      level.area_m2 *= 1 + wall.area;
      level.indentation_m *= 1 + wall.indentation;
      level.peak_pressure_Pa *= 1 + wall.peak_pressure;
      level.centre_pressure_Pa *= 1 + wall.peak_pressure;
      level.max_torque_Nm *= 1 + wall.max_torque;
      level.max_force_N *= 1 + wall.max_force;
      level.torque_arm_m *= 1 + wall.a;
      level.max_torque_projected_Nm *= 1 + wall.max_torque;
      level.load_N *= 1 + wall.load;
    }
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
    if (result_.levels.empty() || physics_.shares_meshes() ||
        trial_.result.elements_per_semi_axis >= result_.levels.front().elements_per_semi_axis)
      throw Interrupted();
    result_.interrupted = true;
    result_.levels.insert(result_.levels.begin(), trial_.result);
    task_.progress(formatted("stopped: the answer is that of level %d", level));
  }

  const LevelResult& coarse() const { return result_.levels.front(); }
  const LevelResult& fine() const { return result_.levels.back(); }

  ErrorSetting error_setting() const {
    const Pressing& pressing = task_.pressing;
    ErrorSetting setting;
    setting.thickness_m = pressing.thickness_m;
    setting.layered = !pressing.interfaces.empty();
    setting.is_scan = pressing.bent.is_scan;
    setting.fitted = fine().fitted;
    setting.approach_given = problem_.approach_m > 0;
    setting.wall = result_.wall;
    setting.rounded_edges =
        problem_.finite_strain && pressing.fingertip && pressing.fingertip.object->faceted();
    return setting;
  }

  /// Whether meshes of a larger contact, where the levels are on such, tell enough of this one.
  bool meshes_serve() const {
    if (crossed_cells(fine()) == 0) return true;
    LayerDiscretisation own;
    own.a = fine().a_m / task_.pressing.thickness_m;
    own.b = fine().b_m / task_.pressing.thickness_m;
    choose_elements(own, fine().level);
    const RelativeError error =
        error_of_levels(physics_.error_table(), coarse(), fine(), error_setting());
    const bool useful = is_useful(error, own.elements_per_semi_axis);
    if (!useful) task_.progress(formatted("a to %.2g %% only: meshes of its own", 100 * error.a));
    return useful;
  }

  void estimate() {
    result_.finest = fine();
    result_.error = error_of_contact(physics_.error_table(), coarse(), fine(), error_setting());
    for (const auto quantity : relative_errors) result_.error.*quantity += core_error_.*quantity;
    if (friction_.size() < 2) return;
    state_friction(friction_.front(), friction_.back(), refinement_of(coarse(), fine()), problem_,
                   result_);
    if (result_.torsion)
      result_.torsion->stiffness_error +=
          stuck_edge_error(physics_.error_table(), fine().elements_per_semi_axis,
                           task_.pressing.planes().both(), problem_.mesh == nullptr, misfit_);
  }

  void describe() {
    result_.planes = task_.pressing.planes();
    for (std::size_t c = 0; c < 3; ++c)
      result_.first_touch_m[c] = task_.pressing.thickness_m *
                                 task_.pressing.bent.first_touch[static_cast<Eigen::Index>(c)];
    const Eigen::Vector2d centre_m = task_.pressing.thickness_m * task_.pressing.bent.centre;
    result_.friction_centre_m = {centre_m.x(), centre_m.y()};
    for (Eigen::Matrix2Xd& outline : result_.finest.outlines_m) outline.colwise() += centre_m;
    const LevelResult& finest = result_.finest;
    result_.pressure_exponent =
        finest.area_projected_m2 * finest.peak_pressure_Pa / finest.load_N - 1;
    const std::vector<PressurePoint> pressures = physics_.pressures();
    result_.along_x = profile_of(pressures, problem_.contact.layer, true);
    result_.along_y = profile_of(pressures, problem_.contact.layer, false);
    const OutputFiles files = physics_.write_files();
    result_.vtu_file = files.vtu;
    result_.pvd_file = files.pvd;
  }

  ContactPhysics& physics_;
  const ContactTask& task_;
  const Problem& problem_;
  LayerDiscretisation mesh_;  ///< of the next level
  int trial_refinement_ = 1;
  int level_refinement_ = 1;
  double room_ = 1;  ///< of the patch, over that of the usual one
  Measurement trial_;
  Result result_;
  LayerDiscretisation measured_on_;  ///< mesh of the last level
  RelativeError core_error_;         ///< of a core with a ridge
  std::optional<FrictionPlan> plan_;
  std::vector<FrictionOfLevel> friction_;  ///< per level
  double misfit_ = 0;                      ///< largest of the levels
};

}  // namespace

Outcome<Result, Unsolved> solve_on_levels(ContactPhysics& physics, const ContactTask& task) {
  return LevelLoop(physics, task).run();
}

}  // namespace softfinger::fem
