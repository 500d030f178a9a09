#include "meshes/io/cut_polygon.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

struct Cut {
  int triangles = 0;
  double area = 0;  ///< sum
  double area_vector =
      0;  ///< length of the vector sum: equal when all lie in one plane, turned alike
};

Cut cut(const std::vector<Vector3d>& corners) {
  std::vector<int> polygon;
  for (std::size_t i = 0; i < corners.size(); ++i) polygon.push_back(static_cast<int>(i));
  std::vector<std::array<int, 3>> triangles;
  cut_polygon(polygon, corners, triangles);
  Cut result;
  Vector3d sum = Vector3d::Zero();
  for (const auto& t : triangles) {
    const Vector3d& a = corners[std::size_t(t[0])];
    const Vector3d twice = (corners[std::size_t(t[1])] - a).cross(corners[std::size_t(t[2])] - a);
    ++result.triangles;
    result.area += twice.norm() / 2;
    sum += twice / 2;
  }
  result.area_vector = sum.norm();
  return result;
}

/// A star of 2n corners, every other one at `inner`, of outer radius 1.
std::vector<Vector3d> star(int points, double inner) {
  std::vector<Vector3d> corners;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = M_PI * i / points, radius = i % 2 == 0 ? 1 : inner;
    corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  return corners;
}

double star_area(int points, double inner) { return points * inner * std::sin(M_PI / points); }

}  // namespace

TEST(CutPolygon, KeepsTheAreaOfConcaveOnes) {
  for (const double inner : {0.1, 0.3, 0.9, 1.0})
    for (const int points : {2, 3, 5, 40}) {
      const Cut found = cut(star(points, inner));
      EXPECT_EQ(found.triangles, 2 * points - 2);
      // Roundings of one per triangle. A triangle outside would add to the first sum alone.
      EXPECT_NEAR(found.area, star_area(points, inner), 1e-14 * points) << points << " " << inner;
      EXPECT_NEAR(found.area_vector, star_area(points, inner), 1e-14 * points);
    }
}

TEST(CutPolygon, GoesRoundAsThePolygonDoesInAnyPlane) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
            .normalized();
    std::vector<Vector3d> corners = star(5, 0.4);
    for (Vector3d& corner : corners) corner = turn * corner + Vector3d(1, 2, 3);
    if (trial % 2 == 1) std::reverse(corners.begin(), corners.end());
    const Cut found = cut(corners);
    EXPECT_NEAR(found.area, star_area(5, 0.4), 1e-14 * 100);
    EXPECT_NEAR(found.area_vector, star_area(5, 0.4), 1e-14 * 100);
  }
  std::vector<std::array<int, 3>> triangles;
  cut_polygon({0, 1, 2, 3}, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, triangles);
  for (const auto& t : triangles)
    EXPECT_EQ((t[1] - t[0] + 4) % 4 + (t[2] - t[1] + 4) % 4 + (t[0] - t[2] + 4) % 4, 4)
        << "clockwise";
}

TEST(CutPolygon, EndsForPolygonsThatCrossThemselvesOrHaveNoArea) {
  EXPECT_EQ(cut({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).triangles, 2);
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}).triangles, 3);
  EXPECT_EQ(cut({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}).triangles, 2);
}

}  // namespace softfinger::meshes
