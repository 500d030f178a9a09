// The tree's answers against those of all triangles, one by one.
#include "comparisons/simulation/triangle_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/meshes/test_surfaces.h"

namespace softfinger::simulation {
namespace {

using Eigen::Vector3d;

class TriangleTrees : public testing::Test {
 protected:
  double uniform(double lowest, double highest) {
    return lowest + (highest - lowest) * std::generate_canonical<double, 53>(random_);
  }
  Vector3d point(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  /// A tree of one triangle looks at it alone.
  double by_each_triangle(const TriangleTree::Core& core) const {
    double least_m = std::numeric_limits<double>::infinity();
    for (const auto& triangle : glass_.triangles) {
      TriangleSurface one{{}, {{0, 1, 2}}};
      for (const int v : triangle) one.vertices_m.push_back(glass_.vertices_m[std::size_t(v)]);
      least_m = std::min(least_m, TriangleTree(one).nearest(core, least_m).distance_m);
    }
    return least_m;
  }
  /// Points all over a core, the nearest one improved by halving steps.
  double by_sampling(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                     const TriangleTree::Core& core) {
    const auto on_core = [&](const Vector3d& at) -> Vector3d {
      if (const auto* segment = std::get_if<TriangleTree::Segment>(&core))
        return segment->from + (at.x() + 1) / 2 * (segment->to - segment->from);
      const auto& block = std::get<TriangleTree::Block>(core);
      return block.pose * Vector3d(block.half_size_m.cwiseProduct(at));
    };
    // Distance of two convex sets: a convex function of five parameters, descended from anywhere.
    Vector3d at = Vector3d::Zero(), share = Vector3d::Constant(1. / 3);
    const auto distance = [&](const Vector3d& where, const Vector3d& of) {
      return (of[0] * a + of[1] * b + of[2] * c - on_core(where)).norm();
    };
    double least = distance(at, share);
    for (double step = 1; step > 1e-9; step *= 0.9)
      for (int trial = 0; trial < 40; ++trial) {
        const Vector3d where = (at + point(step)).cwiseMax(-1).cwiseMin(1);
        Vector3d of = (share + point(step)).cwiseMax(0);
        if (!(of.sum() > 0)) continue;
        of /= of.sum();
        if (distance(where, of) >= least) continue;
        least = distance(where, of);
        at = where;
        share = of;
      }
    return least;
  }
  TriangleTree::Core core(int kind) {
    if (kind == 0) {
      const Vector3d at = point(0.08);
      return TriangleTree::Segment{at, at};
    }
    if (kind == 1) return TriangleTree::Segment{point(0.08), point(0.08)};
    TriangleTree::Block block;
    block.pose.translation() = point(0.1);
    block.pose.linear() =
        Eigen::Quaterniond(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))
            .normalized()
            .toRotationMatrix();
    block.half_size_m = Vector3d(uniform(0.001, 0.03), uniform(0.001, 0.03), uniform(0.001, 0.03));
    return block;
  }

  std::mt19937_64 random_{5};
  const TriangleSurface glass_ = meshes::glass_surface(0.025, 0.035, 0.1, 24);
  const TriangleTree tree_{glass_};
};

TEST_F(TriangleTrees, NearestIsTheLeastOfAllTriangles) {
  for (int kind = 0; kind < 3; ++kind)
    for (int trial = 0; trial < 20; ++trial) {
      const TriangleTree::Core at = core(kind);
      const double expected_m = by_each_triangle(at);
      const TriangleTree::Nearest found =
          tree_.nearest(at, std::numeric_limits<double>::infinity(),
                        trial % 2 ? int(uniform(0, double(glass_.triangles.size()))) : -1);
      ASSERT_GE(found.triangle, 0);
      EXPECT_EQ(found.distance_m, expected_m);
      EXPECT_NEAR((found.on_core - found.on_surface).norm(), found.distance_m, 1e-15);
      EXPECT_EQ(tree_.nearest(at, expected_m).triangle, -1) << "not nearer than the limit";
    }
}

TEST_F(TriangleTrees, DistanceOfOneTriangleIsThatOfConvexSets) {
  // The search finds pairs of points, none of which may be nearer. At edges it stops early, within
  // two millimetres of bodies of a hundred.
  for (int kind = 0; kind < 3; ++kind)
    for (int trial = 0; trial < 40; ++trial) {
      TriangleSurface one{{point(0.05), point(0.05), point(0.05)}, {{0, 1, 2}}};
      const TriangleTree::Core at = core(kind);
      const double found_m =
          TriangleTree(one).nearest(at, std::numeric_limits<double>::infinity()).distance_m;
      const double searched_m =
          by_sampling(one.vertices_m[0], one.vertices_m[1], one.vertices_m[2], at);
      EXPECT_LE(found_m, searched_m + 1e-12) << "the search found a nearer pair, kind " << kind;
      EXPECT_NEAR(found_m, searched_m, 2e-3) << kind;
    }
}

TEST_F(TriangleTrees, SupportIsTheFarthestVertex) {
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d direction = point(1);
    double farthest = -1;
    for (const Vector3d& vertex : glass_.vertices_m)
      farthest = std::max(farthest, vertex.dot(direction));
    EXPECT_EQ(tree_.support(direction).dot(direction), farthest);
  }
}

TEST_F(TriangleTrees, AGlassContainsItsWallAndNotItsInside) {
  EXPECT_TRUE(tree_.contains({0, 0, 0.002}));
  EXPECT_TRUE(tree_.contains({0.029, 0, 0.05}));
  EXPECT_FALSE(tree_.contains({0, 0, 0.05}));
  EXPECT_FALSE(tree_.contains({0.05, 0, 0.05}));
}

TEST_F(TriangleTrees, WithinIsWhatReachesIntoTheBall) {
  const Vector3d centre(0.03, 0, 0.05);
  const double radius_m = 0.01;
  int expected = 0;
  for (std::size_t t = 0; t < glass_.triangles.size(); ++t) {
    TriangleSurface one{{}, {{0, 1, 2}}};
    for (const int v : glass_.triangles[t])
      one.vertices_m.push_back(glass_.vertices_m[std::size_t(v)]);
    expected +=
        TriangleTree(one).nearest(TriangleTree::Segment{centre, centre}, 1).distance_m <= radius_m;
  }
  const TriangleSurface part = tree_.within(centre, radius_m);
  EXPECT_GT(expected, 10);
  EXPECT_EQ(int(part.triangles.size()), expected);
  EXPECT_LE(part.vertices_m.size(), 3 * part.triangles.size());
}

}  // namespace
}  // namespace softfinger::simulation
