// Surfaces of shapes: normals and curvatures against differences of points and normals.
#include "comparisons/simulation/surface_point.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "softfinger/input/constants.h"
#include "tests/meshes/triangulated_ellipsoid.h"

namespace softfinger::simulation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

class Random {
 public:
  double uniform(double least, double most) {
    return least + (most - least) * std::generate_canonical<double, 53>(random_);
  }
  Vector3d direction() {
    return Vector3d(normal_(random_), normal_(random_), normal_(random_)).normalized();
  }

 private:
  std::mt19937_64 random_{11};
  std::normal_distribution<double> normal_;
};

const std::vector<input::ShapeKind> kShapes = {
    input::Sphere{0.03},         input::Ellipsoid{{0.01, 0.02, 0.05}},
    input::Cylinder{0.02, 0.07}, input::Cylinder{0.05, 0.01},
    input::Capsule{0.02, 0.05},  input::Box{{0.02, 0.05, 0.09}},
    input::HalfSpace{}};

bool bounded(const input::ShapeKind& kind) {
  return !std::holds_alternative<input::HalfSpace>(kind);
}

/// h/size for central differences: their error is h², with round-off epsilon/h.
constexpr double kDifference = 1e-5;

TEST(SurfacePoint, NormalIsAcrossAndCurvatureTurnsTheNormal) {
  Random random;
  int smooth = 0;
  for (const input::ShapeKind& kind : kShapes) {
    const double size = bounded(kind) ? bounding_radius_m(kind) : 0.05;
    for (int trial = 0; trial < 200; ++trial) {
      const SurfacePoint at =
          surface_near(kind, size * random.uniform(0.4, 1.5) * random.direction());
      ASSERT_NEAR(at.normal.norm(), 1, 8 * kEpsilon);
      if (!at.smooth) continue;
      ++smooth;
      // Both lie in the tangent plane.
      ASSERT_LE((at.curvature_per_m * at.normal).norm(), 64 * kEpsilon * at.curvature_per_m.norm());
      ASSERT_LE((at.curvature_per_m - at.curvature_per_m.transpose()).norm(),
                64 * kEpsilon * at.curvature_per_m.norm());
      const Vector3d tangent = at.normal.unitOrthogonal();
      for (const Vector3d& along : {tangent, Vector3d(at.normal.cross(tangent))}) {
        const double h = kDifference * size;
        const SurfacePoint ahead = surface_near(kind, at.point_m + h * along);
        const SurfacePoint behind = surface_near(kind, at.point_m - h * along);
        const Vector3d moved = (ahead.point_m - behind.point_m) / (2 * h);
        const Vector3d turned = (ahead.normal - behind.normal) / (2 * h);
        if ((ahead.normal - behind.normal).norm() > 0.1) continue;  // across an edge
        // A change of curvature, where a capsule's cap begins, is none of the surface.
        if ((ahead.curvature_per_m - behind.curvature_per_m).norm() * size > 100 * kDifference)
          continue;
        const double accuracy = 1e3 * kDifference * kDifference + 64 * kEpsilon / kDifference;
        ASSERT_LE(std::abs(moved.dot(at.normal)), accuracy) << kind.index();
        ASSERT_LE((turned - at.curvature_per_m * moved).norm() * size, accuracy) << kind.index();
      }
    }
  }
  EXPECT_GT(smooth, 900);
}

TEST(SurfacePoint, LiesOnTheSurface) {
  Random random;
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d point = random.uniform(0.01, 0.2) * random.direction();
    const auto on = [&](const input::ShapeKind& kind) { return surface_near(kind, point).point_m; };
    const double round_off = 64 * kEpsilon;
    EXPECT_NEAR(on(input::Sphere{0.03}).norm(), 0.03, round_off);
    EXPECT_NEAR(on(input::Ellipsoid{{0.01, 0.02, 0.05}})
                    .cwiseQuotient(Vector3d(0.01, 0.02, 0.05))
                    .squaredNorm(),
                1, round_off);
    const Vector3d capsule = on(input::Capsule{0.02, 0.05});
    EXPECT_NEAR((capsule - Vector3d(0, 0, std::clamp(capsule.z(), -0.025, 0.025))).norm(), 0.02,
                round_off);
    const Vector3d cylinder = on(input::Cylinder{0.02, 0.07});
    EXPECT_NEAR(
        std::max(std::hypot(cylinder.x(), cylinder.y()) / 0.02, std::abs(cylinder.z()) / 0.035), 1,
        round_off);
    const Vector3d box = on(input::Box{{0.02, 0.05, 0.09}});
    EXPECT_NEAR(box.cwiseAbs().cwiseQuotient(Vector3d(0.01, 0.025, 0.045)).maxCoeff(), 1,
                round_off);
    EXPECT_EQ(on(input::HalfSpace{}).z(), 0);
  }
}

TEST(SurfacePoint, IsTheNearestOneButOnEllipsoids) {
  Random random;
  for (const input::ShapeKind& kind : kShapes) {
    if (std::holds_alternative<input::Ellipsoid>(kind) || !bounded(kind)) continue;
    const double size = bounding_radius_m(kind);
    for (int trial = 0; trial < 100; ++trial) {
      const Vector3d point = 2 * size * random.direction();  // outside
      const SurfacePoint at = surface_near(kind, point);
      for (int other = 0; other < 100; ++other) {
        const Vector3d elsewhere = support_point(kind, random.direction());
        ASSERT_LE((at.point_m - point).norm(), (elsewhere - point).norm() * (1 + 8 * kEpsilon));
      }
      ASSERT_LE((point - at.point_m).normalized().cross(at.normal).norm(), 1e-7)
          << "the nearest point lies along the normal";
    }
  }
}

TEST(SurfacePoint, CurvaturesOfTheEllipsoidsEndsAreTheTextbooks) {
  const double a = 0.01, b = 0.02, c = 0.05;
  const SurfacePoint top = surface_near(input::Ellipsoid{{a, b, c}}, Vector3d(0, 0, 1));
  EXPECT_NEAR(top.curvature_per_m(0, 0), c / (a * a), 64 * kEpsilon * c / (a * a));
  EXPECT_NEAR(top.curvature_per_m(1, 1), c / (b * b), 64 * kEpsilon * c / (b * b));
  EXPECT_TRUE(top.smooth);
  const SurfacePoint side = surface_near(input::Cylinder{a, c}, Vector3d(1, 0, 0));
  EXPECT_NEAR(side.curvature_per_m(1, 1), 1 / a, 64 * kEpsilon / a);
  EXPECT_NEAR(side.curvature_per_m(2, 2), 0, 64 * kEpsilon / a);
  EXPECT_FALSE(surface_near(input::Cylinder{a, c}, Vector3d(a, 0, c / 2)).smooth) << "on the rim";
  EXPECT_FALSE(surface_near(input::Box{{a, b, c}}, Vector3d(a / 2, b / 2, 0)).smooth)
      << "on an edge";
  EXPECT_FALSE(surface_near(input::Box{{a, b, c}}, Vector3d(a, b, c)).smooth) << "beyond a corner";
}

TEST(SupportPoint, IsTheFarthestOne) {
  Random random;
  for (const input::ShapeKind& kind : kShapes) {
    if (!bounded(kind)) continue;
    const double size = bounding_radius_m(kind);
    for (int trial = 0; trial < 200; ++trial) {
      const Vector3d direction = random.direction();
      const Vector3d farthest = support_point(kind, direction);
      ASSERT_LE(farthest.norm(), size * (1 + 8 * kEpsilon)) << "within the bounding radius";
      const SurfacePoint at = surface_near(kind, farthest);
      ASSERT_LE((at.point_m - farthest).norm(), 64 * kEpsilon * size) << "on the surface";
      for (int other = 0; other < 50; ++other)
        ASSERT_GE(farthest.dot(direction) + 8 * kEpsilon * size,
                  surface_near(kind, size * random.direction()).point_m.dot(direction));
    }
  }
}

TEST(BearingPoints, AreOnTheSurfaceAndCarry) {
  Random random;
  for (const input::ShapeKind& kind : kShapes) {
    if (!bounded(kind)) continue;
    const double size = bounding_radius_m(kind);
    for (int trial = 0; trial < 100; ++trial) {
      const Vector3d direction = trial < 3 ? Vector3d::Unit(trial) : random.direction();
      const auto points = bearing_points(kind, direction);
      ASSERT_GE(points.size(), 1u);
      ASSERT_LE(points.size(), 8u);
      double farthest = -size;
      const double reach = 0.01 * size;
      const double most = support_point(kind, direction).dot(direction);
      for (const Vector3d& point : points) {
        farthest = std::max(farthest, point.dot(direction));
        if (point.dot(direction) < most - reach) continue;  // of no use
        // The upper end of a capsule that lies nearly flat: inside by the square of the tilt.
        ASSERT_LE((surface_near(kind, point).point_m - point).norm(),
                  1e3 * kEpsilon * size +
                      (std::holds_alternative<input::Capsule>(kind) ? reach * reach / size : 0));
      }
      ASSERT_NEAR(farthest, most, 1e-9 * size)
          << "the lowest point is among them: shape " << kind.index();
    }
  }
}

TEST(BearingPoints, OfAMeshAreSpreadOverItsFlatSide) {
  auto mesh = std::make_shared<TriangleSurface>(
      meshes::triangulated_ellipsoid({0.03, 0.03, 0.03}, Vector3d::Zero(), 10));
  for (Vector3d& vertex : mesh->vertices_m) vertex.z() = std::max(vertex.z(), -0.02);
  const auto points = bearing_points(input::Mesh{mesh}, -Vector3d::UnitZ());
  EXPECT_GE(points.size(), 4u);
  EXPECT_LE(points.size(), 8u);
  Vector3d least = points[0], most = points[0];
  for (const Vector3d& point : points) {
    EXPECT_LT(point.z(), -0.02 + 1e-4);
    least = least.cwiseMin(point);
    most = most.cwiseMax(point);
  }
  const double rim = std::sqrt(0.03 * 0.03 - 0.02 * 0.02);
  EXPECT_GT((most - least).head<2>().minCoeff(), rim);
}

}  // namespace
}  // namespace softfinger::simulation
