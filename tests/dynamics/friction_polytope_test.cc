// The hull of friction vertices against what all of its vertices say.
#include "softfinger/dynamics/friction_polytope.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

using internal::FrictionPolytope;

constexpr double kRoundOff = 1e-11;  // of inverses of facets down to 1e-2 wide

Eigen::Vector3d random_direction(tests::RandomScenes& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

TEST(FrictionPolytope, FacetIsMetByTheRayAndNoVertexLiesAboveIt) {
  tests::RandomScenes random(1);
  FrictionPolytope polytope(128);
  for (const int count : {6, 8, 16, 33, 128}) {
    const Eigen::Matrix3Xd& vertices = tests::friction_vertices(count);
    polytope.set(vertices);
    for (int trial = 0; trial < 200; ++trial) {
      const double size = std::pow(10, random.uniform(-9, 9));
      const Eigen::Vector3d direction = size * random_direction(random);
      FrictionPolytope::Facet facet;
      ASSERT_TRUE(polytope.find_facet(direction, facet));
      Eigen::Matrix3d corners;
      for (int c = 0; c < 3; ++c) corners.col(c) = vertices.col(facet[std::size_t(c)]);
      const Eigen::Matrix3d inverse = corners.inverse();
      EXPECT_GE((inverse * direction).minCoeff(), -kRoundOff * size);
      const Eigen::RowVector3d normal = inverse.colwise().sum();
      EXPECT_LE((normal * vertices).maxCoeff(), 1 + kRoundOff);
    }
  }
}

TEST(FrictionPolytope, VertexBeyondIsTheFarthestOne) {
  tests::RandomScenes random(2);
  FrictionPolytope polytope(128);
  for (const int count : {1, 7, 128}) {
    const Eigen::Matrix3Xd vertices = tests::friction_vertices(128).leftCols(count);
    polytope.set(vertices);
    EXPECT_DOUBLE_EQ(polytope.radius(), vertices.colwise().norm().maxCoeff());
    for (int trial = 0; trial < 100; ++trial) {
      const Eigen::Vector3d direction = random_direction(random);
      int farthest = 0;
      const double most = (direction.transpose() * vertices).maxCoeff(&farthest);
      EXPECT_EQ(polytope.beyond(direction, most - kRoundOff), farthest);
      EXPECT_EQ(polytope.beyond(direction, most + kRoundOff), -1);
    }
  }
}

TEST(FrictionPolytope, KnowsTheLatestVertices) {
  FrictionPolytope polytope(16);
  polytope.set(tests::friction_vertices(16));
  const Eigen::Matrix3Xd longer = 2 * tests::friction_vertices(16);
  polytope.set(longer);
  EXPECT_DOUBLE_EQ(polytope.radius(), longer.colwise().norm().maxCoeff());
  polytope.set(longer.leftCols(8));
  EXPECT_EQ(polytope.count(), 8);
}

TEST(FrictionPolytope, HasNoFacetWhereVerticesDoNotSurroundTheOrigin) {
  FrictionPolytope polytope(16);
  FrictionPolytope::Facet facet;
  polytope.set(Eigen::Matrix3Xd(3, 0));
  EXPECT_FALSE(polytope.find_facet(Eigen::Vector3d::UnitX(), facet));
  EXPECT_EQ(polytope.beyond(Eigen::Vector3d::UnitX(), 0), -1);
  Eigen::Matrix3Xd forces(3, 4);  // no torque: flat
  forces << 1, -1, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0;
  polytope.set(forces);
  EXPECT_FALSE(polytope.find_facet(Eigen::Vector3d::UnitX(), facet));
  Eigen::Matrix3Xd corner = Eigen::Matrix3d::Identity();
  polytope.set(corner);
  EXPECT_TRUE(polytope.find_facet(Eigen::Vector3d::Ones(), facet));
  EXPECT_FALSE(polytope.find_facet(-Eigen::Vector3d::Ones(), facet));
  EXPECT_FALSE(polytope.find_facet(Eigen::Vector3d::Zero(), facet));
}

}  // namespace
}  // namespace softfinger
