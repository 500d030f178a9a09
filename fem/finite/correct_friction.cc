#include "fem/finite/correct_friction.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "fem/error_model.h"
#include "fem/finite/frictional_pressing.h"
#include "fem/finite/full_slip.h"
#include "fem/finite/solved_slides.h"
#include "fem/finite/superposed_friction.h"
#include "fem/formatted.h"
#include "fem/friction_study.h"
#include "fem/stopwatch.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {
namespace {

/// States of one path, solved as far as it goes.
struct Path {
  std::vector<FrictionState> changes;  ///< solved less superposed
  std::size_t solved = 0;              ///< of them, the first ones
  double guessed = 0;                  ///< largest change that is not solved, relative
};

FrictionWrench difference(const FrictionWrench& one, const FrictionWrench& other) {
  return {one.force_x - other.force_x, one.force_y - other.force_y, one.torque - other.torque};
}

/// What the next finer mesh changes about a correction, where no second mesh tells. Of twists that
/// were solved on both it changed 3 % of corrections of 0.023, 0.032 and 0.095, elsewhere 10 % of
/// 0.05, 6 % of 0.14 and 24 % of 0.25.
double usual_error(double correction) {
  return std::max(0.1 * correction, correction * correction);
}

class Corrector {
 public:
  Corrector(const FrictionCorrecting& correcting, const FrictionOfLevel& superposed)
      : correcting_(correcting),
        superposed_(superposed),
        torque_(superposed.full_slip),
        tangent_(correcting.mesh.tangent) {
    if (correcting.coarser) coarser_tangent_ = correcting.coarser->tangent;
  }

  FrictionCorrection run() {
    const Stopwatch watch;
    correct_motions();
    if (correcting_.with_turn || !superposed_.limit_surface.empty()) correct_slides();
    const std::vector<FrictionState>& twist = result_.twist;
    const ShearedContact last =
        twist.empty() ? ShearedContact() : twist.back().sheared.value_or(ShearedContact());
    correcting_.progress(formatted(
        "friction: solved on the deformed layer, %d iterations, %d factorisations, %.1f s%s",
        iterations_, factorisations_, watch.seconds(),
        twist.empty() ? ""
                      : formatted("; after the twist area %+.1f %%, peak pressure %+.1f %%",
                                  100 * (last.area_ratio - 1), 100 * (last.peak_pressure_ratio - 1))
                            .c_str()));
    return std::move(result_);
  }

 private:
  /// The twist, and paths to the points of the limit surface.
  void correct_motions() {
    Path twist;
    {
      FrictionalPressing solved(*correcting_.mesh.pressed, correcting_.mesh.bound,
                                correcting_.has_room);
      twist = follow(solved, superposed_.twist, "",
                     [&](double turn_rad) { correcting_.on_solved(turn_rad, solved.surface()); });
      if (twist.solved == twist.changes.size()) end_ = solved.present();
      for (const std::vector<FrictionState>& states : superposed_.paths) {
        Path path = follow(solved, states);
        result_.slide_error =
            std::max({result_.slide_error, path.guessed, usual_error_of(path, 0)});
        result_.paths.push_back(std::move(path.changes));
      }
      count(solved);
    }
    std::size_t compared = 0;
    if (correcting_.coarser && correcting_.with_turn) {
      try {
        const auto [largest, states] = compare(twist);
        result_.twist_error = error_of_difference(largest);
        compared = states;
      } catch (const ConvergenceError& failure) {
        tell_of_coarser(failure);
      }
    }
    result_.twist_error =
        std::max({result_.twist_error, twist.guessed, usual_error_of(twist, compared)});
    result_.twist = std::move(twist.changes);
  }

  /// How far the coarser mesh tells another correction of the twist.
  /// @returns the largest difference, relative, and the number of states that it is of
  std::pair<double, std::size_t> compare(const Path& twist) {
    // A quarter's superposed motions leave out what an odd field changes about the limits of
    // friction.
    const std::vector<FrictionWrench> fine = superposed_twist(correcting_.mesh, tangent_),
                                      rough =
                                          superposed_twist(*correcting_.coarser, coarser_tangent_);
    FrictionalPressing solved(*correcting_.coarser->pressed, correcting_.coarser->bound);
    std::vector<FrictionState> states = superposed_.twist;
    for (std::size_t i = 0; i < states.size(); ++i) states[i].wrench = rough[i];
    const Path path = follow(solved, states, " on the coarser mesh");
    if (path.solved == path.changes.size()) coarser_end_ = solved.present();
    count(solved);
    const std::size_t compared = std::min(path.solved, twist.solved);
    double largest = 0;
    for (std::size_t i = 0; i < compared; ++i) {
      const Eigen::Vector3d correction =
          of(twist.changes[i].wrench) + of(superposed_.twist[i].wrench) - of(fine[i]);
      largest = std::max(largest, (correction - of(path.changes[i].wrench)).cwiseAbs().maxCoeff());
    }
    return {largest, compared};
  }

  std::vector<FrictionWrench> superposed_twist(const FrictionMesh& mesh,
                                               Eigen::MatrixXd& tangent) const {
    find_tangent(mesh, tangent);
    SuperposedMotion motion(*mesh.pressed, mesh.bound, tangent);
    std::vector<FrictionWrench> wrenches;
    for (const FrictionState& state : superposed_.twist) {
      motion.move_to(state.motion);
      wrenches.push_back(motion.wrench());
    }
    return wrenches;
  }

  static void find_tangent(const FrictionMesh& mesh, Eigen::MatrixXd& tangent) {
    if (tangent.size() == 0) tangent = mesh.pressed->superposed_stiffness({});
  }

  SolvedSlides slides_on(const FrictionMesh& mesh, Eigen::MatrixXd& tangent, double aim) const {
    find_tangent(mesh, tangent);
    return {*mesh.pressed,
            mesh.bound,
            correcting_.has_room,
            correcting_.force,
            torque_,
            aim,
            [this](const std::string& why) { correcting_.progress("friction: " + why); },
            tangent};
  }

  /// Full slip: of a turn about the centre, and of the limit surface.
  void correct_slides() {
    std::optional<SolvedSlides::Neglected> of_turn;
    double aim = 1;
    if (correcting_.with_turn) {
      SolvedSlides slides = slides_on(correcting_.mesh, tangent_, aim);
      // Where the twist ended all points slip.
      of_turn = slides.of({0, 0, 1}, end_ ? &*end_ : nullptr);
      // Without symmetry a force opposes a turn as well.
      result_.full_slip = of_turn->superposed.torque + of_turn->wrench.torque - torque_;
      aim = slides.aim();
      count(slides);
    }
    bool turn_is_stated = false, surface_is_corrected = superposed_.limit_surface.empty();
    if (correcting_.coarser) {
      try {
        SolvedSlides slides = slides_on(*correcting_.coarser, coarser_tangent_, aim);
        if (of_turn) {
          state_turn(*of_turn, slides.of({0, 0, 1}, coarser_end_ ? &*coarser_end_ : nullptr));
          turn_is_stated = true;
        }
        if (!surface_is_corrected && coarser_is_cheaper()) {
          correct_limit_surface(slides);
          surface_is_corrected = true;
        }
        count(slides);
      } catch (const EdgeLeftMargin&) {
        throw;
      } catch (const ConvergenceError& failure) {
        tell_of_coarser(failure);
      }
    }
    if (of_turn && !turn_is_stated)
      result_.twist_error = std::max(result_.twist_error, usual_error_of(*of_turn));
    if (surface_is_corrected) return;
    SolvedSlides slides = slides_on(correcting_.mesh, tangent_, aim);
    correct_limit_surface(slides);
    count(slides);
  }

  /// Fewer elements per semi-axis may be more cells, where halving them ends elsewhere.
  bool coarser_is_cheaper() const {
    return correcting_.coarser->pressed->layer().unknowns() <
           correcting_.mesh.pressed->layer().unknowns();
  }

  void tell_of_coarser(const ConvergenceError& failure) const {
    correcting_.progress(formatted("friction on the coarser mesh: %s", failure.what()));
  }

  void state_turn(const SolvedSlides::Neglected& fine, const SolvedSlides::Neglected& rough) {
    const double error =
        fine.is_known && rough.is_known
            ? fine.inferred +
                  error_of_difference((of(fine.wrench) - of(rough.wrench)).cwiseAbs().maxCoeff())
            : usual_error_of(fine);
    result_.twist_error = std::max(result_.twist_error, error);
  }

  void correct_limit_surface(SolvedSlides& slides) {
    if (superposed_.limit_surface.empty()) return;
    std::vector<PlaneMotion> velocities;
    for (const FrictionState& state : superposed_.limit_surface) velocities.push_back(state.motion);
    double error = 0, spread = 0;
    const std::vector<SolvedSlides::Neglected> found = slides.of(velocities, spread);
    for (std::size_t i = 0; i < found.size(); ++i) {
      result_.limit_surface.push_back({velocities[i], found[i].wrench, 1, 0, found[i].sheared});
      error = std::max(error, usual_error_of(found[i]));
    }
    result_.slide_error = std::max(result_.slide_error, error + spread);
  }

  /// @param on         which mesh, for a line of progress
  /// @param on_solved  called with the turn of each state that is solved
  Path follow(
      FrictionalPressing& solved, const std::vector<FrictionState>& superposed, const char* on = "",
      const std::function<void(double)>& on_solved = [](double) {}) const {
    Path path;
    solved.restart();
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
        correcting_.progress(
            formatted("friction%s: not solved to the end: %s", on, failure.what()));
      }
      // Where it does not go on, what is left out grows at most with the square of friction.
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

  template <class Solved>
  void count(const Solved& solved) {
    iterations_ += solved.iterations();
    factorisations_ += solved.factorisations();
  }

  const FrictionCorrecting& correcting_;
  const FrictionOfLevel& superposed_;
  const double torque_;
  /// Of the meshes as pressed; empty until one is needed.
  Eigen::MatrixXd tangent_, coarser_tangent_;
  /// Of a twist that was solved to its end.
  std::optional<FrictionalPressing::State> end_, coarser_end_;
  FrictionCorrection result_;
  int iterations_ = 0, factorisations_ = 0;
};

}  // namespace

FrictionCorrection correct_friction(const FrictionCorrecting& correcting,
                                    const FrictionOfLevel& superposed) {
  return Corrector(correcting, superposed).run();
}

}  // namespace softfinger::fem::finite
