#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace softfinger {

/// A triangulated surface in metres. Vertices are shared between neighbouring triangles (an STL
/// reader has to weld them), triangles are counter-clockwise seen from outside, every index is
/// valid and every coordinate finite.
struct TriangleSurface {
  std::vector<Eigen::Vector3d> vertices_m;
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace softfinger
