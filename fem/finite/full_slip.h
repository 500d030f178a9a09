#pragma once

#include <Eigen/Core>
#include <vector>

#include "fem/finite/superposed_friction.h"

namespace softfinger::fem::finite {

/// A slide that was solved with a share of full friction.
struct SolvedSlide {
  double share;  ///< 0 to 1
  FrictionWrench wrench;
};

/// A wrench, relative to the largest force and torque.
Eigen::Vector3d relative(const FrictionWrench& wrench, double force, double torque);

/// The slide with all of friction.
struct FullSlip {
  Eigen::Vector3d wrench;     ///< relative
  Eigen::Vector3d neglected;  ///< of it, by superposed motions
  double added;               ///< largest part of `neglected` that is not solved but inferred
};

/// Infers full slip from slides with less friction, where a soft layer folds before it.
///
/// What superposed motions neglect is of second order in the share s of friction, relative to a
/// wrench that is of first order: it is s³ c(s), and c changes little. It goes on along the line
/// through the last two. On a contact with d/h = 0.28, nu = 0.45 and mu = 0.7, from s = 0.3 and
/// 0.75 to 1, that left 0.008 of the wrench where c was 0.14.
/// @param solutions  in the order of their shares, at least one
FullSlip full_slip(const SuperposedSlide& superposed, const PlaneMotion& velocity,
                   const std::vector<SolvedSlide>& solutions, double force, double torque);

}  // namespace softfinger::fem::finite
