#include "softfinger/friction/linearised_friction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "softfinger/math/sphere_covering.h"

namespace softfinger {
namespace {

double support_of(const std::vector<Eigen::Vector3d>& vertices, const Eigen::Vector3d& direction) {
  double largest = -1;
  for (const Eigen::Vector3d& vertex : vertices) largest = std::max(largest, vertex.dot(direction));
  return largest;
}

Eigen::Vector3d random_direction(std::mt19937& engine) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
}

TEST(LinearisedFriction, HasTheStatedInnerBoundForEveryCount) {
  struct Row {
    int count;
    double symmetric, free;
  };
  std::printf("u, inner bound symmetric, free, outer scale (symmetric)\n");
  // The table of linearised_friction.h, truncated to three digits there.
  for (const Row& row :
       {Row{6, 0.577, 0.577}, Row{8, 0.654, 0.666}, Row{10, 0.692, 0.738}, Row{12, 0.794, 0.794},
        Row{16, 0.811, 0.837}, Row{20, 0.861, 0.864}, Row{26, 0.894, 0.898}, Row{32, 0.922, 0.917},
        Row{48, 0.946, 0.945}, Row{64, 0.958, 0.959}, Row{100, 0.973, 0.973}}) {
    const LinearisedFriction symmetric(row.count), free(row.count, false);
    std::printf("%4d  %.4f  %.4f  %.4f\n", row.count, symmetric.inner_bound(), free.inner_bound(),
                symmetric.outer_scale());
    EXPECT_GE(symmetric.inner_bound(), row.symmetric);
    EXPECT_GE(free.inner_bound(), row.free);
  }
}

TEST(LinearisedFriction, OctahedronAndIcosahedronAreFound) {
  // The best coverings by 6 and 12 points; the steps end within 1e-3 of them.
  EXPECT_NEAR(LinearisedFriction(6).inner_bound(), 1 / std::sqrt(3.0), 1e-3);
  EXPECT_NEAR(LinearisedFriction(12).inner_bound(), 0.7946544722917661, 1e-3);
}

TEST(LinearisedFriction, NoDirectionFallsBelowTheBoundAndSomeReachesIt) {
  std::mt19937 engine(5);
  for (const int count : {6, 7, 9, 13, 20, 33, 50}) {
    const LinearisedFriction friction(count);
    double lowest = 1;
    for (int trial = 0; trial < 20000; ++trial) {
      const double support = support_of(friction.vertices(), random_direction(engine));
      lowest = std::min(lowest, support);
      ASSERT_GE(support, friction.inner_bound() - 1e-14);
      // Times the outer scale it reaches around the unit sphere.
      ASSERT_GE(support * friction.outer_scale(), 1 - 1e-14);
    }
    // 20,000 directions come within about 0.01 of the worst one; support falls off linearly there.
    EXPECT_LT(lowest, friction.inner_bound() + 0.02);
  }
}

TEST(LinearisedFriction, EveryCountFromSixHasABoundThatImprovesOnTheWhole) {
  for (int count = 6; count <= 72; ++count) {
    const LinearisedFriction friction(count);
    EXPECT_EQ(friction.count(), count);
    EXPECT_GE(friction.inner_bound(), 1 - 3.2 / count) << count;  // measured: 2.4 to 3.1
    for (const Eigen::Vector3d& vertex : friction.vertices()) EXPECT_NEAR(vertex.norm(), 1, 1e-15);
    EXPECT_EQ(friction.vertices()[0], Eigen::Vector3d::UnitZ());
    EXPECT_EQ(friction.symmetric(), count % 2 == 0);
    for (int i = 0; friction.symmetric() && i < count / 2; ++i)
      EXPECT_EQ(friction.vertices()[count / 2 + i], -friction.vertices()[i]);
  }
  EXPECT_EQ(LinearisedFriction(-3).count(), LinearisedFriction::kSmallestCount);
}

TEST(LinearisedFriction, ChoosesTheCountByTolerance) {
  for (const double tolerance : {0.5, 0.2, 0.1, 0.05, 0.03}) {
    const LinearisedFriction friction = LinearisedFriction::with_tolerance(tolerance);
    EXPECT_GE(friction.inner_bound(), 1 - tolerance);
    std::printf("tolerance %.3f: u = %d\n", tolerance, friction.count());
    if (friction.count() == LinearisedFriction::kSmallestCount) continue;
    EXPECT_LT(LinearisedFriction(friction.count() - 2).inner_bound(), 1 - tolerance);
  }
}

TEST(LinearisedFriction, ColumnsLieOnTheEllipsoid) {
  const FrictionEllipsoid unit{1, 0.003};
  const LinearisedFriction friction(20);
  const Eigen::Matrix3Xd columns = friction.columns(0.003);
  ASSERT_EQ(columns.cols(), 20);
  for (int i = 0; i < 20; ++i)
    EXPECT_NEAR(unit.utilisation(columns(0, i), columns(1, i), columns(2, i)), 1, 1e-15);
  // A hard point contact: no torque, and still the whole disc of forces times the bound.
  EXPECT_EQ(friction.columns(0).row(2).norm(), 0);
}

TEST(LinearisedFriction, OfTheExactSurfaceLiesOnItWithItsOwnBound) {
  std::mt19937 engine(6);
  for (const double aspect : {1.0, 3.0}) {
    const LimitSurface surface(aspect, 1, 0.5, 7);
    const double arm = surface.eccentricity_m();
    const LinearisedFriction friction(surface, 26);
    EXPECT_GT(friction.inner_bound(), 0.85);
    for (const Eigen::Vector3d& vertex : friction.vertices())
      EXPECT_NEAR(surface.utilisation({7 * vertex.x(), 7 * vertex.y(), 7 * arm * vertex.z()}), 1,
                  3e-12);  // both utilisations are right to 1e-12
    for (int trial = 0; trial < 500; ++trial) {
      const Eigen::Vector3d direction = random_direction(engine);
      const double exact = surface.support({direction.x(), direction.y(), direction.z() / arm}) / 7;
      EXPECT_GE(support_of(friction.vertices(), direction),
                friction.inner_bound() * exact * (1 - 1e-11));
      EXPECT_LE(support_of(friction.vertices(), direction), exact * (1 + 1e-11));
    }
  }
}

TEST(LinearisedFriction, VertexOnDemandDissipatesMost) {
  std::mt19937 engine(7);
  const FrictionEllipsoid ellipsoid{4, 0.002};
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d t = random_direction(engine), other = random_direction(engine);
    const Twist slip{t.x(), t.y(), t.z() / 0.002};
    const LimitWrench vertex = vertex_for_twist(ellipsoid, slip);
    EXPECT_NEAR(ellipsoid.utilisation(vertex.force_x_N, vertex.force_y_N, vertex.torque_Nm), 1,
                1e-15);
    const double power =
        vertex.force_x_N * t.x() + vertex.force_y_N * t.y() + vertex.torque_Nm * t.z() / 0.002;
    EXPECT_NEAR(power, 4, 1e-14);  // the support function, mu P |t|
    EXPECT_LE(4 * other.dot(t), power);
  }
  EXPECT_EQ(vertex_for_twist(ellipsoid, {0, 0, 0}).force_x_N, 0);
  EXPECT_EQ(vertex_for_twist({4, 0}, {0, 0, 1}).torque_Nm, 0);
  EXPECT_DOUBLE_EQ(vertex_for_twist(ellipsoid, {1e-310, 0, 0}).force_x_N, 4);
}

TEST(ConvexHull, HasTheFacetsOfACube) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  corners.emplace_back(0.2, -0.3, 0.1);
  const std::vector<HullFacet> facets = convex_hull(corners);
  EXPECT_EQ(facets.size(), 12u);
  for (const HullFacet& facet : facets) {
    EXPECT_NEAR(facet.offset, 1, 1e-15);
    EXPECT_NEAR(facet.normal.cwiseAbs().maxCoeff(), 1, 1e-15);
  }
}

TEST(ConvexHull, OfPointsInAPlaneIsEmpty) {
  EXPECT_TRUE(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}}).empty());
  EXPECT_TRUE(convex_hull({}).empty());
}

}  // namespace
}  // namespace softfinger
