#include "comparisons/prediction/mesh_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "tests/meshes/capsule_finger.h"

namespace softfinger::prediction {
namespace {

using Eigen::Vector3d;

/// A box's corners at (0, 0, 0) and `size`; its top may be left open.
TriangleSurface box(const Vector3d& size, bool has_top) {
  TriangleSurface surface;
  for (int i = 0; i < 8; ++i)
    surface.vertices_m.push_back(
        {i & 1 ? size.x() : 0, i & 2 ? size.y() : 0, i & 4 ? size.z() : 0});
  surface.triangles = {{0, 2, 1}, {1, 2, 3}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3},
                       {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  if (has_top) {
    surface.triangles.push_back({4, 5, 6});
    surface.triangles.push_back({5, 7, 6});
  }
  return surface;
}

TEST(MeshPoints, FindTheMiddleOfAFlatFace) {
  const TriangleSurface surface = box({0.02, 0.01, 0.03}, true);
  EXPECT_LT((extreme_point_m(surface, {0, 0, 1}) - Vector3d(0.01, 0.005, 0.03)).norm(), 1e-12);
  EXPECT_LT((extreme_point_m(surface, {-1, 0, 0}) - Vector3d(0, 0.005, 0.015)).norm(), 1e-12);
  // An edge, a corner.
  const Vector3d to_edge = Vector3d(0, -1, 1).normalized(),
                 to_corner = Vector3d(1, 2, 3).normalized();
  EXPECT_LT((extreme_point_m(surface, to_edge) - Vector3d(0.01, 0, 0.03)).norm(), 1e-12);
  EXPECT_LT((extreme_point_m(surface, to_corner) - Vector3d(0.02, 0.01, 0.03)).norm(), 1e-12);
}

TEST(MeshPoints, FindTheMiddleOfAStraightPadsLine) {
  // A half-round pad along z in three uneven strips, whose file has four decimals of a millimetre:
  // the points of its lowest line differ by up to 1e-4 mm. It touches a plane in the line's middle.
  constexpr int kAround = 32;
  constexpr double kRadius_m = 7e-3, kRounding_m = 0.5e-7;
  const double ends_m[] = {-13e-3, -12e-3, -2e-3, 13e-3};
  const double off_m[] = {kRounding_m, -kRounding_m, 0, kRounding_m / 2};
  TriangleSurface pad;
  for (int ring = 0; ring < 4; ++ring)
    for (int i = 0; i <= kAround; ++i) {
      const double angle = kPi * i / kAround;
      pad.vertices_m.push_back(
          {kRadius_m * std::cos(angle), -kRadius_m * std::sin(angle) + off_m[ring], ends_m[ring]});
    }
  for (int ring = 0; ring < 3; ++ring)
    for (int i = 0; i < kAround; ++i) {
      const int one = ring * (kAround + 1) + i, other = one + kAround + 1;
      pad.triangles.push_back({one, one + 1, other + 1});
      pad.triangles.push_back({one, other + 1, other});
    }
  const Vector3d point = extreme_point_m(pad, {0, -1, 0});
  EXPECT_NEAR(point.x(), 0, 1e-12);
  EXPECT_NEAR(point.y(), -kRadius_m, 2 * kRounding_m);
  EXPECT_NEAR(point.z(), 0, 2 * kRounding_m);
}

TEST(MeshPoints, StayOnTheSurfaceWhereItsMiddleIsAHole) {
  // Without its top, four edges lie highest; their centre is in the hole.
  const Vector3d point = extreme_point_m(box({0.02, 0.01, 0.03}, false), {0, 0, 1});
  EXPECT_DOUBLE_EQ(point.z(), 0.03);
  EXPECT_LT((point - Vector3d(0.01, 0.005, 0.03)).norm(), 0.005 + 1e-12);
  EXPECT_NEAR(std::min(point.y(), 0.01 - point.y()), 0, 1e-12) << "on one of the long edges";
}

TEST(MeshPoints, DoNotDependOnTheOrderOfTheTriangles) {
  TriangleSurface surface = box({0.02, 0.01, 0.03}, true);
  const Vector3d point = extreme_point_m(surface, {0, 1, 0});
  std::reverse(surface.triangles.begin(), surface.triangles.end());
  EXPECT_LT((extreme_point_m(surface, {0, 1, 0}) - point).norm(), 1e-12);
}

TEST(MeshPoints, MeasureASurface) {
  const Vector3d size(0.02, 0.01, 0.03);
  const SurfaceFacts closed = facts_of(box(size, true));
  EXPECT_EQ(closed.open_edges, 0u);
  EXPECT_EQ(closed.least_m, Vector3d::Zero());
  EXPECT_EQ(closed.largest_m, size);
  EXPECT_NEAR(closed.area_m2, 2 * (2e-4 + 3e-4 + 6e-4), 1e-15);
  EXPECT_EQ(facts_of(box(size, false)).open_edges, 4u);
  // One triangle turned round: its three edges run the wrong way.
  TriangleSurface turned = box(size, true);
  std::swap(turned.triangles[0][1], turned.triangles[0][2]);
  EXPECT_EQ(facts_of(turned).open_edges, 3u);
}

TEST(MeshPoints, FitARegionThatHasVerticesEnough) {
  const TriangleSurface surface =
      meshes::triangulated_ellipsoid({12e-3, 7e-3, 14e-3}, Vector3d::Zero(), 32);
  const Vector3d normal(0, -1, 0);
  const QuadricFit fit = fit_around(surface, {0, -7e-3, 0}, &normal);
  EXPECT_GE(fit.points, 15);
  EXPECT_LE(fit.points, 80);
}

TEST(MeshPoints, LieAroundAPointDenseBesideItAndSparseFarAway) {
  const TriangleSurface surface =
      meshes::triangulated_ellipsoid({12e-3, 7e-3, 14e-3}, Vector3d::Zero(), 32);
  const Vector3d centre(0, -7e-3, 0);
  const std::vector<Vector3d> points = points_around(surface, centre);
  ASSERT_GT(points.size(), 20u);
  EXPECT_LE(points.size(), 100u);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double distance = (points[i] - centre).norm();
    EXPECT_GE(distance, (points[i - 1] - centre).norm());
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE((points[i] - points[j]).norm(), 0.5 * distance);
  }
}

TEST(MeshPoints, FindTheNearestPointThatIsRoundAndSmooth) {
  const TriangleSurface finger = meshes::capsule_finger();
  const Vector3d normal(0, -1, 0);
  const auto found = nearest_smooth_point(finger, {0, -8e-3, 0}, &normal);
  ASSERT_TRUE(found);
  EXPECT_GT(std::abs(found->z()), 9e-3) << "one of its round ends";
  const QuadricFit fit = fit_around(finger, *found, nullptr);
  EXPECT_GT(fit.principal.radii_m[0], 0);
  EXPECT_GT(fit.principal.radii_m[1], 0);
  EXPECT_EQ(doubt_of(fit), "");
  EXPECT_GT(fit.normal.dot(normal), 0);
  EXPECT_FALSE(nearest_smooth_point(box({0.02, 0.01, 0.03}, true), {0.01, 0, 0.01}, nullptr));
}

TEST(MeshPoints, AreWrittenInMillimetresWithoutAMinusBeforeZero) {
  EXPECT_EQ(in_millimetres({1e-3, -7.25e-3, -1e-9}), "[1, -7.25, 0]");
}

}  // namespace
}  // namespace softfinger::prediction
