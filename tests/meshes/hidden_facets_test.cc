#include "meshes/scans/hidden_facets.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "meshes/generation/surfaces.h"
#include "meshes/scans/smooth_surface.h"
#include "tests/meshes/test_surfaces.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

constexpr double skin_m = 7e-3;

void add_to(TriangleSurface& surface, const TriangleSurface& other) {
  const int first = static_cast<int>(surface.vertices_m.size());
  surface.vertices_m.insert(surface.vertices_m.end(), other.vertices_m.begin(),
                            other.vertices_m.end());
  for (std::array<int, 3> triangle : other.triangles) {
    for (int& corner : triangle) corner += first;
    surface.triangles.push_back(triangle);
  }
}

TriangleSurface inside_out(TriangleSurface surface) {
  for (auto& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
  return surface;
}

std::vector<bool> hidden_of(const TriangleSurface& surface) {
  std::vector<std::size_t> all(surface.triangles.size());
  std::iota(all.begin(), all.end(), std::size_t(0));
  std::vector<Vector3d> normals;
  for (const auto& triangle : surface.triangles) {
    const auto corner = [&](std::size_t c) {
      return surface.vertices_m[static_cast<std::size_t>(triangle[c])];
    };
    normals.push_back((corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized());
  }
  return hidden_facets(surface, all, normals);
}

long count(const std::vector<bool>& hidden, std::size_t from, std::size_t to) {
  return std::count(hidden.begin() + static_cast<long>(from),
                    hidden.begin() + static_cast<long>(to), true);
}

TEST(HiddenFacets, AreThoseOfAnInnerWallAndOfACore) {
  TriangleSurface surface = sphere(skin_m, 1e-3);
  const std::size_t skin = surface.triangles.size();
  add_to(surface, inside_out(sphere(0.9 * skin_m, 1e-3)));
  add_to(surface, sphere(0.75 * skin_m, 1e-3));
  const std::vector<bool> hidden = hidden_of(surface);
  EXPECT_EQ(count(hidden, 0, skin), 0);
  EXPECT_EQ(count(hidden, skin, hidden.size()), static_cast<long>(hidden.size() - skin));
}

TEST(HiddenFacets, AreNoneOfACupOrOfABodyInsideOut) {
  // A cup as deep as wide, with walls a tenth as thick: one sees its bottom from above.
  const TriangleSurface cup = revolved_surface({{0, 0},
                                                {skin_m, 0},
                                                {skin_m, 2 * skin_m},
                                                {0.9 * skin_m, 2 * skin_m},
                                                {0.9 * skin_m, 0.2 * skin_m},
                                                {0, 0.2 * skin_m}},
                                               40);
  const std::vector<bool> of_cup = hidden_of(cup);
  EXPECT_EQ(count(of_cup, 0, of_cup.size()), 0);
  const std::vector<bool> of_inside = hidden_of(inside_out(sphere(skin_m, 1e-3)));
  EXPECT_EQ(count(of_inside, 0, of_inside.size()), 0);
}

TEST(HiddenFacets, AreNoneOfASurfaceGivenTwiceOrFromBothSides) {
  for (const bool turned : {false, true}) {
    TriangleSurface surface = sphere(skin_m, 1e-3);
    const std::size_t skin = surface.triangles.size();
    add_to(surface, turned ? inside_out(surface) : surface);
    EXPECT_EQ(count(hidden_of(surface), 0, skin), 0) << turned;
  }
}

TEST(SeenSurface, KnowsNothingOfACoreUnderTheSkin) {
  TriangleSurface surface = sphere(skin_m, 1e-3);
  add_to(surface, sphere(0.8 * skin_m, 1e-3));
  for (Vector3d& vertex : surface.vertices_m) vertex.z() -= skin_m;
  const TriangleSurface seen = seen_surface(surface, 15e-3);
  EXPECT_EQ(seen.vertices_m.size(), surface.vertices_m.size());
  EXPECT_EQ(seen.triangles.size(), sphere(skin_m, 1e-3).triangles.size());
  EXPECT_LT(seen_surface(surface, 3e-3).triangles.size(), seen.triangles.size() / 3);
  const SmoothSurface smooth(seen, {1e-3, 60 * M_PI / 180, 15e-3});
  for (double polar = 0; polar < 0.5; polar += 0.1) {
    const Vector3d out(std::sin(polar), 0, std::cos(polar)), centre(0, 0, -skin_m);
    const auto on = smooth.project(centre + skin_m * out, out);
    ASSERT_TRUE(on);
    // Facets lie up to e²/(8 skin_m) below the sphere.
    EXPECT_NEAR((on->position - centre).norm(), skin_m, 1e-6 / (8 * skin_m));
  }
}

TEST(SmoothSurface, IsStraightAlongTheSliversOfACylinder) {
  // As CAD programs export a finger: a cylinder in strips that end in a cap and in a bevel, whose
  // facets are small. The corners' normals lean towards these.
  constexpr int strips = 20;
  constexpr double length = 20e-3;
  std::vector<Eigen::Vector2d> profile{{0, -2e-3}, {skin_m - 1e-3, -2e-3}, {skin_m, 0}};
  for (const Eigen::Vector2d& point : arc({0, length}, skin_m, 0, kPi / 2, 12))
    profile.push_back(point);
  profile.back().x() = 0;
  TriangleSurface surface = revolved_surface(profile, strips);
  // The middle of the cylinder to the origin, its outside up.
  for (Vector3d& vertex : surface.vertices_m)
    vertex = Vector3d(vertex.z() - length / 2, vertex.y(), vertex.x() - skin_m);
  for (auto& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
  const SmoothSurface smooth(surface, {1e-3, 60 * M_PI / 180, 30e-3});
  // Facets whose normals lean towards the small ones are ten times as far off.
  const double facets_depth = skin_m * (1 - std::cos(kPi / strips));
  for (double along = -7e-3; along < 7.5e-3; along += 1e-3)
    for (double angle = -0.5; angle < 0.51; angle += 0.1) {
      const Vector3d out(0, std::sin(angle), std::cos(angle));
      const auto on = smooth.project(Vector3d(along, 0, -skin_m) + skin_m * out, out);
      ASSERT_TRUE(on);
      EXPECT_NEAR(std::hypot(on->position.y(), on->position.z() + skin_m), skin_m, facets_depth)
          << along << " " << angle;
    }
}

}  // namespace
}  // namespace softfinger::meshes
