#pragma once

#include <optional>
#include <vector>

#include "fem/base/ordered_progress.h"
#include "fem/friction/friction_study.h"
#include "fem/problem/problem.h"
#include "fem/problem/result.h"

namespace softfinger::fem {

/// The part of friction that a cheaper method leaves out, found on the coarse mesh by solving the
/// same states without its simplification: differences of wrenches, in the units of the model.
struct FrictionCorrection {
  std::vector<FrictionState> twist, limit_surface;
  std::vector<std::vector<FrictionState>> paths;
  double full_slip = 0;            ///< torque
  bool starts_as_pressed = false;  ///< twist and paths, with friction
  /// Relative errors of what is so corrected.
  double twist_error = 0, full_slip_error = 0, slide_error = 0;
  double wall_s = 0;  ///< spent on it, which a finer level does not need again
};

/// One mesh's answer about friction, in the units of the model.
struct FrictionOfLevel {
  double stiffness = 0, full_slip = 0;
  std::vector<FrictionState> twist, limit_surface;
  std::vector<std::vector<FrictionState>> paths;  ///< to each point of the limit surface
  /// Whether twist and paths start from the contact as friction pressed it, once corrected.
  bool starts_as_pressed = false;
  /// Relative errors by what the method itself neglects: of the torque through the twist and at its
  /// end, of the limit surface.
  double neglected_of_twist = 0, neglected_of_full_slip = 0, neglected_of_slide = 0;
  /// The part that is neglected on this mesh, where it was asked for.
  std::optional<FrictionCorrection> correction;
};

/// Angles of a twist and velocities of the limit surface: the same on every level, so that levels
/// can be compared.
struct FrictionPlan {
  std::vector<PlaneMotion> twist, velocities;
  std::vector<std::vector<PlaneMotion>> paths;
  /// Largest relative radius that friction has moved the contact's edge to, on the levels so far:
  /// the next one needs compliances up to there.
  double edge = 1;
  TouchedRegion region;  ///< of the last level
};

/// Scales of the motions in a plan, in the units of the model.
struct FrictionScale {
  double stiffness = 0;          ///< of the stuck contact against a turn
  double torque = 0, force = 0;  ///< largest ones of the frictionless pressure
  double b = 0;                  ///< smaller semi-axis
};

FrictionPlan plan_friction(const FrictionScale& scale, const Problem& problem);

/// @param kept      compliances of this mesh from earlier contacts, and for later ones; or null
/// @param plan      made here when it has none, by the first level, and followed by the next
/// @param on_state  called after each increment of the twist, for output
FrictionOfLevel friction_on(PressedContact contact, const Problem& problem, KeptCompliances* kept,
                            std::optional<FrictionPlan>& plan, const OrderedProgress& progress,
                            const OnState& on_state);

/// The finer mesh's answer plus the correction that was found on the coarse mesh, scaled by the
/// torques of full slip on both; without such a correction, the finer mesh's answer itself.
FrictionOfLevel corrected(const FrictionOfLevel& fine, const FrictionOfLevel& coarse);

/// Puts the finer level's answer into the result, with the stiffness extrapolated, and the errors
/// that follow from both levels.
void state_friction(const FrictionOfLevel& coarse, const FrictionOfLevel& fine, double refinement,
                    const Problem& problem, Result& result);

}  // namespace softfinger::fem
