#include "softfinger/friction/friction_ellipsoid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace softfinger {
namespace {

TEST(FrictionEllipsoid, IsReachedByPureForceAndByPureTorque) {
  const FrictionEllipsoid ellipsoid{4, 0.002};
  EXPECT_DOUBLE_EQ(ellipsoid.max_torque_Nm(), 0.008);
  EXPECT_DOUBLE_EQ(ellipsoid.utilisation(2.4, 3.2, 0), 1);
  EXPECT_DOUBLE_EQ(ellipsoid.utilisation(0, 0, -0.008), 1);
  EXPECT_DOUBLE_EQ(ellipsoid.utilisation(0, 0, 0), 0);
  EXPECT_DOUBLE_EQ(ellipsoid.utilisation(1.2, 1.6, 0.004), std::sqrt(0.5));
}

TEST(FrictionEllipsoid, HardPointContactCarriesNoTorque) {
  const FrictionEllipsoid point{4, 0};
  EXPECT_DOUBLE_EQ(point.utilisation(4, 0, 0), 1);
  EXPECT_TRUE(std::isinf(point.utilisation(0, 0, 1e-300)));
  EXPECT_DOUBLE_EQ(FrictionEllipsoid{}.utilisation(0, 0, 0), 0);
}

TEST(FrictionEllipsoid, SectionLiesOnTheSurfaceEvenlySpacedAndStartsAtPureForce) {
  const FrictionEllipsoid ellipsoid{4, 0.002};
  const int count = 24;
  const auto section = sample_section(ellipsoid, 0.7, count);
  ASSERT_EQ(section.size(), std::size_t(count));
  EXPECT_EQ(section[0].torque_Nm, 0);
  EXPECT_DOUBLE_EQ(section[0].force_x_N, 4 * std::cos(0.7));
  EXPECT_DOUBLE_EQ(section[0].force_y_N, 4 * std::sin(0.7));
  const double chord_N = 2 * 4 * std::sin(std::acos(-1.0) / count);
  for (int i = 0; i < count; ++i) {
    const LimitWrench &one = section[i], &next = section[(i + 1) % count];
    EXPECT_NEAR(ellipsoid.utilisation(one.force_x_N, one.force_y_N, one.torque_Nm), 1, 1e-15);
    const double distance_N =
        std::hypot(next.force_x_N - one.force_x_N, next.force_y_N - one.force_y_N,
                   (next.torque_Nm - one.torque_Nm) / ellipsoid.eccentricity_m);
    EXPECT_NEAR(distance_N, chord_N, 1e-14);  // a few epsilon of 4 N
  }
}

TEST(FrictionEllipsoid, SectionOfNoPointsIsEmpty) {
  EXPECT_TRUE(sample_section({4, 0.002}, 0, 0).empty());
  EXPECT_TRUE(sample_section({4, 0.002}, 0, -3).empty());
}

}  // namespace
}  // namespace softfinger
