#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fem/finite/finite_pressing.h"
#include "fem/finite/frictional_pressing.h"
#include "fem/finite/full_slip.h"
#include "fem/finite/superposed_friction.h"
#include "fem/friction/frictional_contact.h"

namespace softfinger::fem::finite {

/// Full slip of a contact, solved on the deformed layer, less that of superposed motions on the
/// same mesh: what these neglect. In units of h and E.
///
/// Neighbouring velocities lead to neighbouring states: each slide starts from those before.
class SolvedSlides {
 public:
  /// @param pressed   of a whole layer, in its equilibrium; its tangent is factorised anew
  /// @param has_room  as of FrictionalPressing
  /// @param force, torque  largest ones, which wrenches are relative to
  /// @param aim            share of friction to solve slides to, 0 to 1
  /// @param on_failure     called with the reason why a slide was not solved to the end
  /// @param tangent        the pressed one's `superposed_stiffness`; empty: it is found
  /// @throws ConvergenceError where the pressed state is not stable against shear
  SolvedSlides(FinitePressing& pressed, const FrictionBound& bound, bool has_room, double force,
               double torque, double aim, std::function<void(const std::string& why)> on_failure,
               const Eigen::MatrixXd& tangent = {});

  struct Neglected {
    FrictionWrench superposed;              ///< what these say
    FrictionWrench wrench;                  ///< to be added
    std::optional<ShearedContact> sheared;  ///< where all of friction was solved
    /// Largest component of the wrench's part that is inferred and not solved, relative.
    double inferred = 0;
    bool is_known = true;  ///< false where no share of friction at all was solved
  };
  /// @param guess  as of FrictionalPressing
  /// @throws EdgeLeftMargin with room
  Neglected of(const PlaneMotion& velocity, const FrictionalPressing::State* guess = nullptr);

  /// Solves for many velocities, in an order in which neighbours are close. At most `most_solved`
  /// are solved, evenly spread. The others' result is linear in the wrench, by least squares: a
  /// rough guess, because the neglected part turns faster than the wrench does.
  /// @param spread  raised by the largest misfit of that guess, relative
  std::vector<Neglected> of(const std::vector<PlaneMotion>& velocities, double& spread);
  static constexpr std::size_t most_solved = 24;

  /// Share of friction that the next slide is solved to: less where an earlier one folded.
  double aim() const { return aim_; }
  int iterations() const { return solved_.iterations(); }
  int factorisations() const { return solved_.factorisations(); }

 private:
  const double force_, torque_;
  const std::function<void(const std::string&)> on_failure_;
  const SuperposedSlide superposed_;
  FrictionalPressing solved_;
  double aim_;
};

}  // namespace softfinger::fem::finite
