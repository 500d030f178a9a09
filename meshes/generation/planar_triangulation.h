#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace softfinger::meshes {

/// Delaunay triangles of points in a plane, by gmsh: they cover the points' convex hull.
/// @param points  distinct, at least three, not all on a line; in any unit of length
/// @returns the points of each triangle, counter-clockwise
std::vector<std::array<int, 3>> triangulate(const Eigen::Matrix2Xd& points);

}  // namespace softfinger::meshes
