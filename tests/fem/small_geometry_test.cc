#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "fem/layer/surface_frame.h"

namespace softfinger::fem {
namespace {

constexpr double geometry_round_off = 1e-14;

TEST(SurfaceFrame, IsTheSmallestRotationToTheNormal) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.4, 0.8).normalized();
  const Eigen::Matrix3d frame = surface_frame(normal);
  EXPECT_LT((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), geometry_round_off);
  EXPECT_GT(frame.determinant(), 0);
  EXPECT_LT((frame.col(2) - normal).norm(), geometry_round_off);
  // The frame turns by the angle between z and the normal, about an axis across both.
  EXPECT_NEAR(Eigen::AngleAxisd(frame).angle(), std::acos(normal.z()), geometry_round_off);
  EXPECT_LT(
      (frame * normal.cross(Eigen::Vector3d::UnitZ()) - normal.cross(Eigen::Vector3d::UnitZ()))
          .norm(),
      geometry_round_off);
}

TEST(SurfaceFrame, LeavesXAloneOnTheMirrorPlaneOfX) {
  const Eigen::Vector3d on_plane = Eigen::Vector3d(0, 0.6, 0.8);
  EXPECT_EQ(surface_frame(on_plane).col(0), Eigen::Vector3d::UnitX());
  EXPECT_EQ(surface_frame(Eigen::Vector3d::UnitZ()), Eigen::Matrix3d::Identity());
}

}  // namespace
}  // namespace softfinger::fem
