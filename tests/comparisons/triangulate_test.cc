#include "comparisons/simulation/triangulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "sample_motion.h"
#include "softfinger/input/constants.h"

namespace softfinger::simulation {
namespace {

double volume_m3(const TriangleSurface& surface) {
  double volume = 0;
  for (const auto& [i, j, k] : surface.triangles)
    volume += surface.vertices_m[i].dot(surface.vertices_m[j].cross(surface.vertices_m[k])) / 6;
  return volume;
}

/// Every edge is run along once in each direction.
bool is_closed(const TriangleSurface& surface) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& [i, j, k] : surface.triangles)
    for (const auto& [from, to] : {std::pair{i, j}, {j, k}, {k, i}}) ++edges[{from, to}];
  for (const auto& [edge, count] : edges)
    if (count != 1 || !edges.count({edge.second, edge.first})) return false;
  return !edges.empty();
}

TEST(Triangulate, ClosedShapesAreClosedAndSeenFromOutside) {
  // A regular 36-gon over its circle; and frustums under a meridian of segments of 10 degrees,
  // which lose their square over 4, to the next order, which is positive.
  const double circle = 18 / kPi * std::sin(kPi / 18);
  const double ball = circle * (1 - std::pow(kPi / 18, 2) / 4);
  const auto check = [](const input::ShapeKind& kind, double exact_m3, double least, double most) {
    input::Shape shape{kind, Eigen::Isometry3d::Identity()};
    shape.pose.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
    shape.pose.pretranslate(Eigen::Vector3d(1, -2, 0.5));
    const TriangleSurface surface = triangulate(shape, 1);
    EXPECT_TRUE(is_closed(surface));
    const double ratio = volume_m3(surface) / exact_m3;
    EXPECT_GE(ratio, least - 1e-12);
    EXPECT_LE(ratio, most + 1e-12);
  };
  check(input::Box{{1, 2, 3}}, 6, 1, 1);
  check(input::Cylinder{0.5, 2}, kPi / 2, circle, circle);
  check(input::Sphere{2}, 32 * kPi / 3, ball, circle);
  check(input::Ellipsoid{{1, 2, 3}}, 8 * kPi, ball, circle);
  check(input::Capsule{0.5, 2}, kPi / 2 + kPi / 6, ball, circle);
}

TEST(Triangulate, VerticesLieOnTheSurface) {
  constexpr double kRounding = 1e-15;
  for (const Eigen::Vector3d& vertex :
       triangulate({input::Sphere{1}, Eigen::Isometry3d::Identity()}, 1).vertices_m)
    EXPECT_NEAR(vertex.norm(), 1, kRounding);
  for (const Eigen::Vector3d& vertex :
       triangulate({input::Capsule{1, 4}, Eigen::Isometry3d::Identity()}, 1).vertices_m)
    EXPECT_NEAR(std::hypot(vertex.x(), vertex.y(), std::max(0., std::abs(vertex.z()) - 2)), 1,
                kRounding);
}

TEST(Triangulate, AHalfSpaceIsASquareOfItsPlaneSeenFromOutside) {
  const TriangleSurface square =
      triangulate({input::HalfSpace{}, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 3))}, 4);
  ASSERT_EQ(square.triangles.size(), 2u);
  for (const auto& [i, j, k] : square.triangles) {
    const Eigen::Vector3d twice_area = (square.vertices_m[j] - square.vertices_m[i])
                                           .cross(square.vertices_m[k] - square.vertices_m[i]);
    EXPECT_EQ(twice_area, Eigen::Vector3d(0, 0, 16));
  }
  for (const Eigen::Vector3d& vertex : square.vertices_m) EXPECT_EQ(vertex.z(), 3);
}

TEST(Triangulate, AMeshIsItselfAndAMissingOneIsNothing) {
  const auto surface = std::make_shared<TriangleSurface>(
      triangulate({input::Box{{1, 1, 1}}, Eigen::Isometry3d::Identity()}, 1));
  EXPECT_EQ(triangulate({input::Mesh{surface}, Eigen::Isometry3d::Identity()}, 1).vertices_m,
            surface->vertices_m);
  EXPECT_TRUE(triangulate({input::Mesh{}, Eigen::Isometry3d::Identity()}, 1).triangles.empty());
}

TEST(Extent, HoldsBodiesInAllFramesAndNoHalfSpace) {
  Recording recording = tests::sample_motion(40);
  const Eigen::AlignedBox3d extent = extent_of(recording);
  EXPECT_NEAR(extent.min().z(), 0, 1e-12) << "the box stood on the table";
  EXPECT_GT(extent.max().z(), 0.055 + 0.06) << "and was lifted";
  EXPECT_LT(extent.diagonal().norm(), 0.25);
  EXPECT_GT(half_space_width_m(recording), 2 * extent.diagonal().norm());
  EXPECT_TRUE(extent_of(tests::empty_motion()).isEmpty());
  EXPECT_EQ(half_space_width_m(tests::empty_motion()), 1);
}

TEST(Extent, AHalfSpaceFarAwayStillReachesUnderTheMotion) {
  Recording recording = tests::sample_motion(10);
  recording.bodies[3].shapes[0].pose.translation() = Eigen::Vector3d(50, 0, 0);
  EXPECT_GT(half_space_width_m(recording) / 2, 50 + 0.1);
}

}  // namespace
}  // namespace softfinger::simulation
