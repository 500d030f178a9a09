// Cells of a user's mesh that are too long in one direction, and points in a plane.

#include "meshes/generation/divide_sheets.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "meshes/generation/planar_triangulation.h"

namespace softfinger::meshes {
namespace {

/// Two cells side by side along x, the second one skewed.
LayerMesh two_cells() {
  LayerMesh mesh;
  for (const double z : {0.0, 1.0})
    for (const double y : {0.0, 1.0})
      for (const double x : {0.0, 2.0, 5.0})
        mesh.hexahedra.vertices.emplace_back(x + (x > 2 ? 0.5 * y : 0), y, z + (x > 2 ? 0.2 : 0));
  const auto at = [](int x, int y, int z) { return x + 3 * (y + 2 * z); };
  for (const int x : {0, 1}) {
    mesh.hexahedra.cells.push_back({at(x, 0, 0), at(x + 1, 0, 0), at(x + 1, 1, 0), at(x, 1, 0),
                                    at(x, 0, 1), at(x + 1, 0, 1), at(x + 1, 1, 1), at(x, 1, 1)});
    mesh.hexahedra.region.push_back(x);
    mesh.contact.push_back({at(x, 0, 1), at(x + 1, 0, 1), at(x + 1, 1, 1), at(x, 1, 1)});
    mesh.core.push_back({at(x, 0, 0), at(x + 1, 0, 0), at(x + 1, 1, 0), at(x, 1, 0)});
  }
  return mesh;
}

/// Volume of a cell with plane faces, by the tetrahedra from its middle.
double volume(const HexahedralMesh& mesh, const std::array<int, 8>& cell) {
  const auto at = [&](int corner) {
    return mesh.vertices[static_cast<std::size_t>(cell[static_cast<std::size_t>(corner)])];
  };
  constexpr int faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                               {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  double sum = 0;
  for (const auto& face : faces)
    for (const int i : {1, 2}) sum += at(face[0]).dot(at(face[i]).cross(at(face[i + 1]))) / 6;
  return sum;
}

TEST(DivideSheets, DividesAllCellsOfASheetAndNoOthers) {
  const LayerMesh mesh = two_cells();
  // An edge of the first cell along x, and one along z, whose sheet goes through both cells.
  const LayerMesh divided = divide_sheets(mesh, [](int from, int to) {
    if (from == 0 && to == 1) return 3;
    if (from == 0 && to == 6) return 2;
    return 1;
  });
  EXPECT_EQ(divided.hexahedra.cells.size(), 3u * 2 + 2);
  EXPECT_EQ(divided.contact.size(), 3u + 1);
  EXPECT_EQ(divided.core.size(), 3u + 1);
  EXPECT_EQ(divided.hexahedra.vertices.size(), 5u * 2 * 3) << "shared between cells";
  EXPECT_EQ(std::count(divided.hexahedra.region.begin(), divided.hexahedra.region.end(), 0), 6);
  double before = 0, after = 0;
  for (const auto& cell : mesh.hexahedra.cells) before += volume(mesh.hexahedra, cell);
  for (const auto& cell : divided.hexahedra.cells) {
    EXPECT_GT(volume(divided.hexahedra, cell), 0) << "gmsh's order of the corners";
    after += volume(divided.hexahedra, cell);
  }
  EXPECT_NEAR(after, before, 1e-14 * before);
}

TEST(DivideSheets, LeavesAMeshAsItIsWhereNothingIsTooLong) {
  const LayerMesh mesh = two_cells();
  const LayerMesh divided = divide_sheets(mesh, [](int, int) { return 1; });
  ASSERT_EQ(divided.hexahedra.cells.size(), mesh.hexahedra.cells.size());
  for (std::size_t c = 0; c < 2; ++c)
    for (std::size_t i = 0; i < 8; ++i)
      EXPECT_EQ(divided.hexahedra.vertices[std::size_t(divided.hexahedra.cells[c][i])],
                mesh.hexahedra.vertices[std::size_t(mesh.hexahedra.cells[c][i])]);
}

TEST(Triangulate, CoversTheConvexHullCounterClockwise) {
  // A grid with a finer one in its middle, as hanging nodes leave it.
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; j <= 4; ++j) places.emplace_back(i, j);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) places.emplace_back(1.5 + i, 1.5 + j);
  Eigen::Matrix2Xd points(2, static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = places[i];
  double area = 0;
  std::map<int, int> corners_at;
  for (const auto& triangle : triangulate(points)) {
    const Eigen::Vector2d one = points.col(triangle[1]) - points.col(triangle[0]),
                          other = points.col(triangle[2]) - points.col(triangle[0]);
    const double twice = one.x() * other.y() - one.y() * other.x();
    EXPECT_GT(twice, 0);
    area += twice / 2;
    for (const int corner : triangle) ++corners_at[corner];
  }
  EXPECT_NEAR(area, 16, 1e-12);
  EXPECT_EQ(corners_at.size(), places.size()) << "all points are corners";
}

}  // namespace
}  // namespace softfinger::meshes
