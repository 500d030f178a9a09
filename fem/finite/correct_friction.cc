#include "fem/finite/correct_friction.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "fem/base/formatted.h"
#include "fem/base/stopwatch.h"
#include "fem/base/threads.h"
#include "fem/finite/frictional_pressing.h"
#include "fem/finite/full_slip.h"
#include "fem/finite/solved_slides.h"
#include "fem/finite/superposed_friction.h"
#include "fem/friction/friction_study.h"
#include "fem/levels/error_model.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {
namespace {

/// States of one path, solved as far as it goes.
struct Path {
  std::vector<FrictionState> changes;  ///< solved less superposed
  std::size_t solved = 0;              ///< of them, the first ones
  double guessed = 0;                  ///< largest change that is not solved, relative
  bool starts_as_pressed = false;      ///< with friction
};

FrictionWrench difference(const FrictionWrench& one, const FrictionWrench& other) {
  return {one.force_x - other.force_x, one.force_y - other.force_y, one.torque - other.torque};
}

/// The error of a correction that is solved on one mesh only. On twists that were solved on two
/// meshes the finer one changed 3 % of corrections of 0.023, 0.032 and 0.095, elsewhere 10 % of
/// 0.05, 6 % of 0.14 and 24 % of 0.25.
double usual_error(double correction) {
  return std::max(0.1 * correction, correction * correction);
}

/// The states that were solved on the mesh.
struct OnMesh {
  Path twist;
  std::vector<FrictionWrench> superposed;  ///< of the twist, where there is a coarser mesh
  std::vector<Path> paths;
  std::optional<SolvedSlides::Neglected> turn;  ///< full slip of it
  double aim = 1;                               ///< as of SolvedSlides, for further slides
};

/// The states that were solved on the coarser mesh, as far as it bears them.
struct OnCoarser {
  std::optional<Path> twist;
  std::optional<SolvedSlides::Neglected> turn;
  /// The correction of the limit surface, and how far it is guessed.
  std::optional<std::vector<SolvedSlides::Neglected>> slides;
  double spread = 0;
};

class Corrector {
 public:
  Corrector(const FrictionCorrecting& correcting, const FrictionOfLevel& superposed)
      : correcting_(correcting), superposed_(superposed), torque_(superposed.full_slip) {
    for (const FrictionState& state : superposed.limit_surface) velocities_.push_back(state.motion);
  }

  FrictionCorrection run() {
    const Stopwatch watch;
    // Neither mesh's solution depends on what the other one finds, so the two can run side by side.
    Solving solving(correcting_.mesh, correcting_.progress), of_coarser;
    OnMesh on_mesh;
    OnCoarser on_coarser;
    std::vector<std::string> told;  // after the other mesh's lines, whichever is faster
    if (correcting_.coarser) {
      of_coarser =
          Solving(*correcting_.coarser, [&](const std::string& line) { told.push_back(line); });
      side_by_side([&] { on_mesh = solve_on_mesh(solving); },
                   [&] { on_coarser = solve_on_coarser(of_coarser); });
      for (const std::string& line : told) correcting_.progress(line);
    } else {
      on_mesh = solve_on_mesh(solving);
    }
    result_.starts_as_pressed = on_mesh.twist.starts_as_pressed;
    for (const Path& path : on_mesh.paths) result_.starts_as_pressed |= path.starts_as_pressed;
    correct_motions(on_mesh, on_coarser);
    if (correcting_.with_turn || !velocities_.empty()) correct_slides(on_mesh, on_coarser, solving);
    const std::vector<FrictionState>& twist = result_.twist;
    const ShearedContact last =
        twist.empty() ? ShearedContact() : twist.back().sheared.value_or(ShearedContact());
    correcting_.progress(formatted(
        "friction: solved on the deformed layer, %d iterations, %d factorisations, %.1f s%s",
        solving.iterations + of_coarser.iterations,
        solving.factorisations + of_coarser.factorisations, watch.seconds(),
        twist.empty() ? ""
                      : formatted("; after the twist area %+.1f %%, peak pressure %+.1f %%",
                                  100 * (last.area_ratio - 1), 100 * (last.peak_pressure_ratio - 1))
                            .c_str()));
    return std::move(result_);
  }

 private:
  /// A mesh, and what solving on it has found so far. Two of them share nothing.
  struct Solving {
    Solving() = default;
    Solving(const FrictionMesh& of, std::function<void(const std::string&)> tell_line)
        : mesh(&of), tangent(of.tangent), tell(std::move(tell_line)) {}

    const FrictionMesh* mesh = nullptr;
    Eigen::MatrixXd tangent;  ///< of the mesh as pressed; empty until it is needed
    std::function<void(const std::string&)> tell;
    std::optional<FrictionalPressing::State> end;  ///< of a twist that was solved to its end
    int iterations = 0, factorisations = 0;

    template <class Solved>
    void count(const Solved& solved) {
      iterations += solved.iterations();
      factorisations += solved.factorisations();
    }
  };

  /// The twist, paths to the points of the limit surface, and full slip of a turn.
  OnMesh solve_on_mesh(Solving& solving) const {
    OnMesh result;
    {
      FrictionalPressing solved(*solving.mesh->pressed, solving.mesh->bound, correcting_.has_room);
      result.twist = follow(solved, superposed_.twist, solving, "", [&](double turn_rad) {
        correcting_.on_solved(turn_rad, solved.surface());
      });
      if (result.twist.solved == result.twist.changes.size()) solving.end = solved.present();
      for (const std::vector<FrictionState>& states : superposed_.paths)
        result.paths.push_back(follow(solved, states, solving));
      solving.count(solved);
    }
    if (!correcting_.with_turn) return result;
    // A quarter's superposed motions leave out what an odd field changes about the limits of
    // friction.
    if (correcting_.coarser) result.superposed = superposed_twist(solving);
    SolvedSlides slides = slides_on(solving, 1);
    // All points slip at the end of the twist, so that state is a good guess.
    result.turn = slides.of({0, 0, 1}, solving.end ? &*solving.end : nullptr);
    result.aim = slides.aim();
    solving.count(slides);
    return result;
  }

  OnCoarser solve_on_coarser(Solving& solving) const {
    OnCoarser result;
    if (correcting_.with_turn)
      if_it_goes(solving, [&] {
        const std::vector<FrictionWrench> rough = superposed_twist(solving);
        FrictionalPressing solved(*solving.mesh->pressed, solving.mesh->bound);
        std::vector<FrictionState> states = superposed_.twist;
        for (std::size_t i = 0; i < states.size(); ++i) states[i].wrench = rough[i];
        result.twist = follow(solved, states, solving, " on the coarser mesh");
        if (result.twist->solved == states.size()) solving.end = solved.present();
        solving.count(solved);
      });
    if (correcting_.with_turn || !velocities_.empty())
      if_it_goes(solving, [&] {
        SolvedSlides slides = slides_on(solving, 1);
        if (correcting_.with_turn)
          result.turn = slides.of({0, 0, 1}, solving.end ? &*solving.end : nullptr);
        if (!velocities_.empty() && coarser_is_cheaper())
          result.slides = slides.of(velocities_, result.spread);
        solving.count(slides);
      });
    return result;
  }

  /// Solves on the coarser mesh. If only that mesh does not bear a state, the state is reported and
  /// left out.
  void if_it_goes(const Solving& solving, const std::function<void()>& solve) const {
    try {
      solve();
    } catch (const EdgeLeftMargin&) {
      throw;
    } catch (const ConvergenceError& failure) {
      solving.tell(formatted("friction on the coarser mesh: %s", failure.what()));
    }
  }

  void correct_motions(OnMesh& on_mesh, const OnCoarser& on_coarser) {
    Path& twist = on_mesh.twist;
    for (Path& path : on_mesh.paths) {
      result_.slide_error = std::max({result_.slide_error, path.guessed, usual_error_of(path, 0)});
      result_.paths.push_back(std::move(path.changes));
    }
    std::size_t compared = 0;
    if (on_coarser.twist && on_coarser.twist->starts_as_pressed == twist.starts_as_pressed) {
      const auto [largest, states] = compare(on_mesh, *on_coarser.twist);
      result_.twist_error = error_of_difference(largest);
      compared = states;
    }
    result_.twist_error =
        std::max({result_.twist_error, twist.guessed, usual_error_of(twist, compared)});
    result_.twist = std::move(twist.changes);
  }

  /// Compares the twist's correction on this mesh with that on the coarser one, over the states
  /// that were solved on both.
  /// @returns the largest difference, relative, and the number of states compared
  std::pair<double, std::size_t> compare(const OnMesh& on_mesh, const Path& rough) const {
    const Path& twist = on_mesh.twist;
    const std::size_t compared = std::min(rough.solved, twist.solved);
    double largest = 0;
    for (std::size_t i = 0; i < compared; ++i) {
      const Eigen::Vector3d correction =
          of(twist.changes[i].wrench) + of(superposed_.twist[i].wrench) - of(on_mesh.superposed[i]);
      largest = std::max(largest, (correction - of(rough.changes[i].wrench)).cwiseAbs().maxCoeff());
    }
    return {largest, compared};
  }

  std::vector<FrictionWrench> superposed_twist(Solving& solving) const {
    find_tangent(solving);
    SuperposedMotion motion(*solving.mesh->pressed, solving.mesh->bound, solving.tangent);
    std::vector<FrictionWrench> wrenches;
    for (const FrictionState& state : superposed_.twist) {
      motion.move_to(state.motion);
      wrenches.push_back(motion.wrench());
    }
    return wrenches;
  }

  static void find_tangent(Solving& solving) {
    if (solving.tangent.size() == 0)
      solving.tangent = solving.mesh->pressed->superposed_stiffness({});
  }

  /// @param solving  outlives the slides
  SolvedSlides slides_on(Solving& solving, double aim) const {
    find_tangent(solving);
    return {*solving.mesh->pressed,
            solving.mesh->bound,
            correcting_.has_room,
            correcting_.force,
            torque_,
            aim,
            [&solving](const std::string& why) { solving.tell("friction: " + why); },
            solving.tangent};
  }

  /// Full slip: of a turn about the centre, and of the limit surface.
  void correct_slides(const OnMesh& on_mesh, const OnCoarser& on_coarser, Solving& solving) {
    if (on_mesh.turn) {
      // Without symmetry a force opposes a turn as well.
      result_.full_slip = on_mesh.turn->superposed.torque + on_mesh.turn->wrench.torque - torque_;
      if (on_coarser.turn)
        state_turn(*on_mesh.turn, *on_coarser.turn);
      else
        result_.full_slip_error = usual_error_of(*on_mesh.turn);
      // The twist ends there.
      result_.twist_error = std::max(result_.twist_error, result_.full_slip_error);
    }
    if (velocities_.empty()) return;
    if (on_coarser.slides) {
      correct_limit_surface(*on_coarser.slides, on_coarser.spread);
      return;
    }
    SolvedSlides slides = slides_on(solving, on_mesh.aim);
    double spread = 0;
    const std::vector<SolvedSlides::Neglected> found = slides.of(velocities_, spread);
    correct_limit_surface(found, spread);
    solving.count(slides);
  }

  /// Fewer elements per semi-axis may be more cells, where halving them ends elsewhere.
  bool coarser_is_cheaper() const {
    return correcting_.coarser->pressed->layer().unknowns() <
           correcting_.mesh.pressed->layer().unknowns();
  }

  void state_turn(const SolvedSlides::Neglected& fine, const SolvedSlides::Neglected& rough) {
    result_.full_slip_error =
        fine.is_known && rough.is_known
            ? fine.inferred +
                  error_of_difference((of(fine.wrench) - of(rough.wrench)).cwiseAbs().maxCoeff())
            : usual_error_of(fine);
  }

  void correct_limit_surface(const std::vector<SolvedSlides::Neglected>& found, double spread) {
    double error = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      result_.limit_surface.push_back({velocities_[i], found[i].wrench, 1, 0, found[i].sheared});
      error = std::max(error, usual_error_of(found[i]));
    }
    result_.slide_error = std::max(result_.slide_error, error + spread);
  }

  /// @param on         which mesh, for a line of progress
  /// @param on_solved  called with the turn of each state that is solved
  Path follow(
      FrictionalPressing& solved, const std::vector<FrictionState>& superposed,
      const Solving& solving, const char* on = "",
      const std::function<void(double)>& on_solved = [](double) {}) const {
    Path path;
    if (superposed.empty()) return path;
    solved.restart();
    if (correcting_.drag)
      path.starts_as_pressed = drag(solved, *solving.mesh->pressed, *correcting_.drag, solving);
    for (const FrictionState& state : superposed) {
      const bool goes_on = path.solved == path.changes.size();
      try {
        if (goes_on) {
          solved.move_to(state.motion);
          path.changes.push_back({state.motion, difference(solved.wrench(), state.wrench),
                                  solved.slip_fraction(), 0, solved.sheared()});
          ++path.solved;
          on_solved(state.motion.turn_rad);
          continue;
        }
      } catch (const EdgeLeftMargin&) {
        throw;
      } catch (const ConvergenceError& failure) {
        solving.tell(formatted("friction%s: not solved to the end: %s", on, failure.what()));
      }
      // Beyond the last solved state, what superposition leaves out grows at most with the square
      // of friction.
      FrictionState change = state;
      change.wrench = {};
      path.guessed = std::max(path.guessed, path.solved == 0 ? 1.0 : 0.0);
      if (path.solved > 0) {
        const std::size_t last = path.changes.size() - 1;
        const double growth = size_of(state.wrench) / size_of(superposed[last].wrench);
        change.wrench = path.changes[last].wrench;
        change.wrench.force_x *= growth * growth;
        change.wrench.force_y *= growth * growth;
        change.wrench.torque *= growth * growth;
        path.guessed = std::max(path.guessed, size_of(change.wrench));
      }
      path.changes.push_back(std::move(change));
    }
    return path;
  }

  /// Takes the contact to where friction has pressed it; where that fails it stays frictionless.
  static bool drag(FrictionalPressing& solved, const FinitePressing& pressed, const Drag& drag,
                   const Solving& solving) {
    try {
      solved.settle_at(dragged_places(pressed, drag), {pressed.equilibrium().load, 0});
      return true;
    } catch (const EdgeLeftMargin&) {
      throw;
    } catch (const ConvergenceError& failure) {
      solving.tell(
          formatted("friction: motions start from pressing without friction: %s", failure.what()));
      solved.restart();
      return false;
    }
  }

  Eigen::Vector3d of(const FrictionWrench& wrench) const {
    return relative(wrench, correcting_.force, torque_);
  }
  double size_of(const FrictionWrench& wrench) const { return of(wrench).cwiseAbs().maxCoeff(); }

  double error_of_difference(double difference) const {
    return stated_error(difference, correcting_.refinement, friction_integral);
  }

  /// Largest of the solved states from this one on.
  double usual_error_of(const Path& path, std::size_t first) const {
    double error = 0;
    for (std::size_t i = first; i < path.solved; ++i)
      error = std::max(error, usual_error(size_of(path.changes[i].wrench)));
    return error;
  }

  double usual_error_of(const SolvedSlides::Neglected& neglected) const {
    return neglected.is_known ? usual_error(size_of(neglected.wrench)) + neglected.inferred : 1;
  }

  const FrictionCorrecting& correcting_;
  const FrictionOfLevel& superposed_;
  const double torque_;
  std::vector<PlaneMotion> velocities_;  ///< of the limit surface
  FrictionCorrection result_;
};

}  // namespace

FrictionCorrection correct_friction(const FrictionCorrecting& correcting,
                                    const FrictionOfLevel& superposed) {
  return Corrector(correcting, superposed).run();
}

}  // namespace softfinger::fem::finite
