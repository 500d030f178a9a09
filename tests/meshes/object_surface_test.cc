#include "meshes/generation/object_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "triangulated_ellipsoid.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

TEST(ObjectSurface, HeightsFollowTheirClosedForms) {
  EXPECT_EQ(*plane_object()->height(3, -7), 0);
  EXPECT_NEAR(*quadric_object(4, -2)->height(1, 3), 1 / 8.0 - 9 / 4.0, 1e-15);
  EXPECT_NEAR(*quadric_object(kInfinity, 2)->height(5, 3), 9 / 4.0, 1e-15);
  EXPECT_NEAR(*sphere_object(5)->height(3, 0), 1, 1e-15);
  EXPECT_NEAR(*sphere_object(5)->height(0, 4), 2, 1e-15);
  EXPECT_NEAR(*sphere_object(-5)->height(0, 4), -2, 1e-15);
  EXPECT_NEAR(*sphere_object(5)->height(1e-9, 0), 1e-19, 1e-34);  // no cancellation
  EXPECT_NEAR(*cylinder_object(5)->height(100, 3), 1, 1e-15);
  EXPECT_NEAR(*cylinder_object(-5)->height(100, 3), -1, 1e-15);
}

TEST(ObjectSurface, AnglesTurnCounterClockwise) {
  const double angle = kPi / 6, u = 2, v = 0.5;  // in the turned frame
  const double x = std::cos(angle) * u - std::sin(angle) * v,
               y = std::sin(angle) * u + std::cos(angle) * v;
  EXPECT_NEAR(*quadric_object(4, 3, angle)->height(x, y), *quadric_object(4, 3)->height(u, v),
              1e-15);
  EXPECT_NEAR(*cylinder_object(5, angle)->height(x, y), *cylinder_object(5)->height(u, v), 1e-15);
}

TEST(ObjectSurface, EndsWhereItDoesNotCover) {
  EXPECT_TRUE(sphere_object(5)->height(3, 3.9));
  EXPECT_FALSE(sphere_object(5)->height(3, 4.1));
  EXPECT_TRUE(cylinder_object(5)->height(1e3, -4.9));
  EXPECT_FALSE(cylinder_object(5)->height(0, -5.1));
  const auto ball = triangulated_ellipsoid({1, 1, 1}, {0, 0, 0}, 20);
  const auto object = triangulated_object(ball, {{0, 0, -1}, {0, 0, -1}, {1, 0, 0}});
  EXPECT_TRUE(object->height(0.9, 0));
  EXPECT_FALSE(object->height(1.1, 0));
}

TEST(ObjectSurface, RefusesRadiiWithoutAMeaning) {
  EXPECT_THROW(quadric_object(0, 1), InputError);
  EXPECT_THROW(quadric_object(1, std::nan("")), InputError);
  EXPECT_THROW(sphere_object(kInfinity), InputError);
  EXPECT_THROW(cylinder_object(0), InputError);
  EXPECT_THROW(cylinder_object(1, std::nan("")), InputError);
  const auto ball = triangulated_ellipsoid({1, 1, 1}, {0, 0, 0}, 4);
  EXPECT_THROW(triangulated_object(ball, {{0, 0, -1}, {0, 0, 1}, {1, 0, 0}}), InputError);
}

TEST(TriangulatedObject, FollowsTheExactOneWithTheChord) {
  // Touched at the body's -x end: radii b²/a along y and c²/a along z.
  const Vector3d axes(2, 1.5, 1), centre(3, 4, 5);
  const auto body = triangulated_ellipsoid(axes, centre, 40);
  const double edge = longest_edge(body), smallest = 0.5;
  for (const double angle : {0.0, 0.6}) {
    const SurfacePlacement placement{centre - Vector3d(2.01, 0, 0), {-1, 0, 0}, {0, 1, 0}, angle};
    const auto object = triangulated_object(body, placement);
    EXPECT_NEAR(*object->height(0, 0), 0, 1e-12);
    for (double x = -0.5; x <= 0.5; x += 0.09)
      for (double y = -0.5; y <= 0.5; y += 0.07) {
        const double u = std::cos(angle) * x + std::sin(angle) * y,
                     v = std::cos(angle) * y - std::sin(angle) * x;
        const double exact = 2 - 2 * std::sqrt(1 - u * u / 2.25 - v * v);
        // Facets' sagitta, circumradius² / (2 R), along z where the surface leans by 50 degrees.
        EXPECT_NEAR(*object->height(x, y), exact, edge * edge / (4 * smallest) * 1.6);
      }
  }
}

TEST(TriangulatedObject, OfAHollowBodyIsTheWallInContact) {
  TriangleSurface shell = triangulated_ellipsoid({1, 1, 1}, {0, 0, 0}, 20);
  const TriangleSurface cavity = triangulated_ellipsoid({0.9, 0.9, 0.9}, {0, 0, 0}, 20);
  const int offset = static_cast<int>(shell.vertices_m.size());
  shell.vertices_m.insert(shell.vertices_m.end(), cavity.vertices_m.begin(),
                          cavity.vertices_m.end());
  for (const auto& [a, b, c] : cavity.triangles)
    shell.triangles.push_back({offset + a, offset + c, offset + b});
  const Vector3d up(0, 0, 1), x(1, 0, 0);
  const auto outside = triangulated_object(shell, {{0, 0, -1}, -up, x});
  EXPECT_NEAR(*outside->height(0.1, 0.2), 1 - std::sqrt(0.95), 5e-3);
  // From within, the wall is a cup.
  const auto inside = triangulated_object(shell, {{0, 0, 0.9}, -up, x});
  EXPECT_NEAR(*inside->height(0.1, 0.2), std::sqrt(0.81 - 0.05) - 0.9, 5e-3);
}

}  // namespace
}  // namespace softfinger::meshes
