#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace softfinger::meshes {

/// Cuts a polygon into triangles that go round it the same way, two fewer than it has corners. It
/// may be concave and need not be quite plane. Ears are cut off: corners whose triangle holds no
/// other corner (Meisters, American Mathematical Monthly 82, 1975). Where there is no ear, as in a
/// polygon that crosses itself, the rest is cut from one corner. Costs the square of the corners.
/// @param polygon    indices into `vertices`, at least three
/// @param triangles  get the new ones at their end
void cut_polygon(const std::vector<int>& polygon, const std::vector<Eigen::Vector3d>& vertices,
                 std::vector<std::array<int, 3>>& triangles);

}  // namespace softfinger::meshes
