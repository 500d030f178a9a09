#pragma once

#include <array>
#include <optional>

#include "comparisons/simulation/shape_pair.h"

namespace softfinger::simulation {

/// The quadrics that stand for the two shapes of a pair, where these are meshes.
using Fits = std::array<std::optional<QuadricFit>, 2>;

/// The one point in which two round surfaces touch: there they have a common normal, and both
/// relative curvatures are positive, so that the contact is an ellipse (Ciocarlie et al. 2007,
/// eq. 7, 8).
///
/// From the nearest points, Newton's method minimises the distance of the surfaces along the
/// normal, whose Hessian is the relative curvature. After each step the normal is turned to
/// theirs.
///
/// @returns nothing where there is no such point, or more than one: at an edge, along a line, on a
/// flat face, in a saddle
std::optional<TouchingPoint> find_elliptic_contact(const ShapePair& pair, const Fits& fits,
                                                   const Nearest& nearest);

}  // namespace softfinger::simulation
