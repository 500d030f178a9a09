#include "meshes/generation/planar_triangulation.h"

#include <gmsh.h>

#include <cstddef>
#include <utility>

#include "meshes/generation/gmsh_session.h"

namespace softfinger::meshes {

std::vector<std::array<int, 3>> triangulate(const Eigen::Matrix2Xd& points) {
  const GmshSession session("planar triangulation");
  std::vector<std::size_t> corners;
  gmsh::model::mesh::triangulate({points.data(), points.data() + points.size()}, corners);
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    // gmsh counts from one.
    std::array<int, 3> triangle{static_cast<int>(corners[i]) - 1,
                                static_cast<int>(corners[i + 1]) - 1,
                                static_cast<int>(corners[i + 2]) - 1};
    const Eigen::Vector2d one = points.col(triangle[1]) - points.col(triangle[0]),
                          other = points.col(triangle[2]) - points.col(triangle[0]);
    if (one.x() * other.y() < one.y() * other.x()) std::swap(triangle[1], triangle[2]);
    triangles.push_back(triangle);
  }
  return triangles;
}

}  // namespace softfinger::meshes
