#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "comparisons/simulation/shape_pair.h"

namespace softfinger::simulation {

/// The bearing points of a shape towards a direction, both in its frame. Of a mesh they are
/// searched for among all vertices, and of one that rests they stay the same.
struct Bearing {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< zero: not yet known
  std::vector<Eigen::Vector3d> points;
};

/// Appends the points that hold two shapes apart where no single point with an ellipse does:
/// - of a sphere or an ellipsoid, the nearest point alone;
/// - corners, points of a rim, ends of a line of either shape that lie over the other one;
/// - where edges, rims or lines of both cross, seen along the normal: with the corners, the polygon
///   that both faces share, or the part of a line that lies over a face;
/// - the nearest point, where none of these is as near.
/// @param nearest  of the pair, at poses where the normal is that of the contact
/// @param bearing  of a and b, the last time; receives those of this time
void find_flat_contact(const ShapePair& pair, const Nearest& nearest,
                       std::array<Bearing, 2>& bearing, std::vector<TouchingPoint>& points);

}  // namespace softfinger::simulation
