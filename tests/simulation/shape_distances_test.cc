// Nearest points of shapes against closed forms, where the library that finds them is not sure.
#include "comparisons/simulation/shape_distances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace softfinger::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// A box above a table, turned by the three small angles (rad) and moved sideways.
Isometry3d above_table(const Vector3d& turned_rad, const Vector3d& centre_m) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() << 1, -turned_rad.z(), turned_rad.y(),  //
      turned_rad.z(), 1, -turned_rad.x(),               //
      -turned_rad.y(), turned_rad.x(), 1;
  pose.translation() = centre_m;
  return pose;
}

/// In one of 3,000 such poses FCL 0.7 gives points up to 13 mm apart for a distance of 0.7 mm, in
/// one of 100,000 a direction that is wrong by up to 0.007 rad. The first pose is from a simulation
/// of boxes at rest, which fell apart by it.
TEST(ShapeDistances, NearestPointsOfParallelFacesAreAcrossTheGap) {
  const input::ShapeKind table = input::Box{{0.4, 0.4, 0.1}}, box = input::Box{{0.04, 0.04, 0.04}};
  const ShapeDistances distances({&table, &box});
  constexpr double kTolerance_m = 1e-14;
  Isometry3d of_table = Isometry3d::Identity();
  of_table.translation().z() = -0.05;
  const auto check = [&](const Vector3d& turned_rad, const Vector3d& moved_m, double gap_m) {
    const Isometry3d pose = above_table(turned_rad, moved_m + Vector3d(0, 0, 0.02 + gap_m));
    const ShapeDistances::Nearest at = distances.nearest(0, of_table, 1, pose, kTolerance_m);
    ASSERT_TRUE(at.has_points);
    // The lowest corner is nearer than the face's middle by as much as the face is tilted.
    EXPECT_NEAR(at.distance_m, gap_m, kTolerance_m + 0.03 * turned_rad.norm());
    // The box may have been turned by a millionth.
    EXPECT_LT(((at.on_b - at.on_a).normalized() - Vector3d::UnitZ()).norm(), 2e-6);
    EXPECT_NEAR(at.on_a.z(), 0, kTolerance_m);
  };
  const double gap_m = 0.0006928203230275509;
  check({-2.1e-16, 2.0e-15, -3.4e-15}, {2.4000951083298931e-16, 2.1480757602401738e-16, 0}, gap_m);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto any = [&] { return Vector3d(normal(random), normal(random), normal(random)); };
  for (int pose = 0; pose < 400000 && !HasFailure(); ++pose) {
    const double size_rad = std::pow(10., -17 + 4 * uniform(random));
    check(size_rad * any(), 1e-15 * any(), 2 * gap_m * uniform(random));
  }
}

}  // namespace
}  // namespace softfinger::simulation
