#pragma once

#include "fem/pad/pad_mesh.h"
#include "fem/pad/pad_problem.h"

namespace softfinger::fem {

/// The touched part of a pad's face, in the units of its thickness.
struct PadPlan {
  PadGeometry geometry;
  Eigen::Vector2d origin_m =
      Eigen::Vector2d::Zero();  ///< of the geometry, in the pad's coordinates
};

/// Checks what can be checked before anything is solved, and places the pad and the object's face.
/// @throws InputError for a value outside of its range, shapes that do not meet, a load outside of
/// the touched face
PadPlan plan_pad(const PadProblem& problem);

}  // namespace softfinger::fem
