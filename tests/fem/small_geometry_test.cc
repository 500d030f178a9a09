#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "fem/pressing.h"
#include "fem/surface_frame.h"

namespace softfinger::fem {
namespace {

constexpr double geometry_round_off = 1e-14;

TEST(PressureMoments, AreThoseOfTheTurnedContactAboutItsCentre) {
  for (const double turn : {0.0, 0.3, -1.2, 1.5}) {
    // Two forces on the long axis and two on the short one.
    Eigen::Matrix2Xd position(2, 4);
    position << 3, -3, 0, 0, 0, 0, 1, -1;
    const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(turn).toRotationMatrix();
    const Eigen::Matrix2Xd turned = rotation * position;
    position = turned.colwise() + Eigen::Vector2d(0.5, -0.2);
    const PressureMoments moments = moments_of(position, Eigen::Vector4d(2, 2, 2, 2));
    EXPECT_NEAR(moments.major, 9.0 / 2, 100 * geometry_round_off) << turn;
    EXPECT_NEAR(moments.minor, 1.0 / 2, 100 * geometry_round_off) << turn;
    EXPECT_NEAR(moments.turn_rad, turn, 100 * geometry_round_off);
  }
}

TEST(PressureMoments, AreWeighedByTheForce) {
  Eigen::Matrix2Xd position(2, 3);
  position << 0, 3, 9, 0, 0, 0;
  const PressureMoments moments = moments_of(position, Eigen::Vector3d(2, 1, 0));
  EXPECT_NEAR(moments.major, 2, 10 * geometry_round_off);  // about the centre at 1
  EXPECT_NEAR(moments.minor, 0, 10 * geometry_round_off);
}

TEST(SurfaceFrame, IsTheSmallestRotationToTheNormal) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.4, 0.8).normalized();
  const Eigen::Matrix3d frame = surface_frame(normal);
  EXPECT_LT((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), geometry_round_off);
  EXPECT_GT(frame.determinant(), 0);
  EXPECT_LT((frame.col(2) - normal).norm(), geometry_round_off);
  // By the angle between z and the normal, and about an axis across both.
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
