// The hull of friction vertices against what all of its vertices say.
#include "softfinger/dynamics/facets/friction_polytope.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

using internal::FrictionPolytope;

constexpr double kFacetRoundOff = 1e-11;  // of inverses of facets down to 1e-2 wide
/// Vertices are moved along their own direction; weights of a unit direction, and a facet's normal
/// in multiples of its distance, are below 10 for those of 6 vertices and more.
constexpr double kMoved = 10 * FrictionPolytope::kMoved;

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
      EXPECT_GE((inverse * direction).minCoeff(), -kMoved * size);
      const Eigen::RowVector3d normal = inverse.colwise().sum();
      EXPECT_LE((normal * vertices).maxCoeff(), 1 + kMoved);
    }
  }
}

TEST(FrictionPolytope, FindsTheSameFacetWhateverWasAskedBefore) {
  tests::RandomScenes random(3);
  for (const int count : {6, 16, 128}) {
    const Eigen::Matrix3Xd& vertices = tests::friction_vertices(count);
    // Inside facets, on their edges and at their corners.
    std::vector<Eigen::Vector3d> directions = {Eigen::Vector3d::UnitX(), {0, -1, 0}, {1, 0, 1}};
    for (int j = 0; j < count; ++j) directions.push_back(vertices.col(j));
    for (int j = 1; j < count; ++j)  // of opposite ones there is no middle
      directions.push_back(vertices.col(j) + 0.9 * vertices.col(j - 1));
    for (int trial = 0; trial < 200; ++trial) directions.push_back(random_direction(random));
    FrictionPolytope asked(count);
    asked.set(vertices);
    for (int round = 0; round < 2; ++round)
      for (const Eigen::Vector3d& direction : directions) {
        FrictionPolytope fresh(count);
        fresh.set(vertices);
        FrictionPolytope::Facet first, again;
        ASSERT_TRUE(fresh.find_facet(direction, first))
            << count << " vertices, towards " << direction.transpose();
        ASSERT_TRUE(asked.find_facet(direction, again));
        std::sort(first.begin(), first.end());
        std::sort(again.begin(), again.end());
        EXPECT_EQ(first, again) << count << " vertices, towards " << direction.transpose();
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
      EXPECT_NEAR(polytope.farthest(direction), most, kFacetRoundOff);
      EXPECT_EQ(polytope.beyond(direction, most - kFacetRoundOff), farthest);
      EXPECT_EQ(polytope.beyond(direction, most + kFacetRoundOff), -1);
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
  EXPECT_EQ(polytope.farthest(Eigen::Vector3d::UnitX()), -std::numeric_limits<double>::infinity());
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
