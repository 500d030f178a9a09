#pragma once

#include <vector>

#include "comparisons/simulation/shape_pair.h"

namespace softfinger::simulation {

/// Appends the points that hold two shapes apart where no single point with an ellipse does:
/// - of a sphere or an ellipsoid, the nearest point alone;
/// - corners, points of a rim, ends of a line of either shape that lie over the other one;
/// - where edges, rims or lines of both cross, seen along the normal: with the corners, the polygon
///   that both faces share, or the part of a line that lies over a face;
/// - the nearest point, where none of these is as near.
/// @param nearest  of the pair, at poses where the normal is that of the contact
void find_flat_contact(const ShapePair& pair, const Nearest& nearest,
                       std::vector<TouchingPoint>& points);

}  // namespace softfinger::simulation
