#include "meshes/scans/scanned_layer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "meshes/generation/surfaces.h"
#include "meshes/scans/doubted.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

constexpr double R = 8e-3;

/// A sphere's mesh that touches the origin at a place where its triangles lie as they may.
TriangleSurface ball(double edge, double noise = 0) {
  TriangleSurface surface = sphere(R, edge);
  const Vector3d top = Vector3d(0.3, 0.5, 0.8).normalized();
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond::FromTwoVectors(top, Vector3d::UnitZ()).toRotationMatrix();
  std::mt19937 engine(5);
  std::normal_distribution<double> normal(0, 1);
  for (Vector3d& vertex : surface.vertices_m) {
    vertex = turn * vertex - R * Vector3d::UnitZ();
    for (int c = 0; c < 3; ++c) vertex[c] += noise * normal(engine);
  }
  return surface;
}

/// Root mean square distance of projected points from the sphere, up to 30 degrees from the top.
double position_error(const SmoothSurface& surface) {
  const Vector3d centre(0, 0, -R);
  double squares = 0;
  int count = 0;
  for (double polar = 0; polar < 0.5; polar += 0.05)
    for (double azimuth = 0; azimuth < 6; azimuth += 0.5) {
      const Vector3d out(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                         std::cos(polar));
      const auto on = surface.project(centre + 1.01 * R * out, out);
      EXPECT_TRUE(on);
      squares += std::pow((on->position - centre).norm() - R, 2);
      ++count;
    }
  return std::sqrt(squares / count);
}

TEST(SmoothSurface, ConvergesToTheSphereBehindTheFacets) {
  // Facets lie up to e²/(8 R) below the sphere; the smooth surface a tenth of that or less, and
  // ever less as they become smaller.
  double before = 1;
  for (const double edge : {4e-3, 2e-3, 1e-3, 0.5e-3}) {
    const SmoothSurface surface(ball(edge), {1e-3, 1.05, 15e-3});
    const double error = position_error(surface), of_facets = edge * edge / (8 * R);
    EXPECT_LT(error, 0.12 * of_facets) << edge;
    EXPECT_LT(error, before / 4);  // of second order
    before = error;
  }
}

TEST(SmoothSurface, IsSmootherThanTheNoiseOfItsVertices) {
  // 10 micrometres, 5 % of an indentation of 0.2 mm.
  constexpr double noise = 1e-5;
  const SmoothSurface surface(ball(0.3e-3, noise), {1e-3, 1.05, 15e-3});
  EXPECT_LT(position_error(surface), noise / 2);
}

TEST(SmoothSurface, TurnsWithItsEdgesAndItsCurvature) {
  // An open bowl: the part of the sphere over a plane, so that it has an edge as well.
  TriangleSurface bowl = ball(1e-3);
  const auto is_below = [&](int vertex) {
    return bowl.vertices_m[static_cast<std::size_t>(vertex)].z() < -0.4 * R;
  };
  bowl.triangles.erase(std::remove_if(bowl.triangles.begin(), bowl.triangles.end(),
                                      [&](const auto& facet) {
                                        return std::any_of(facet.begin(), facet.end(), is_below);
                                      }),
                       bowl.triangles.end());
  const SmoothSurface surface(bowl, {1e-3, 1.05, 15e-3});
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()));
  const SmoothSurface turned = surface.turned(turn);
  EXPECT_EQ(turned.width(), surface.width());
  const Vector3d centre(0, 0, -R);
  for (const double polar : {0.0, 0.4, 0.8, 0.9}) {
    const Vector3d normal(std::sin(polar), 0, std::cos(polar));
    const auto before = surface.project(centre + 1.02 * R * normal, normal);
    const auto after = turned.project(turn * (centre + 1.02 * R * normal), turn * normal);
    ASSERT_TRUE(before && after) << polar;
    // Newton's method ends at 1e-7 of the width.
    EXPECT_LT((after->position - turn * before->position).norm(), 1e-6 * surface.width());
    EXPECT_LT((after->normal - turn * before->normal).norm(), 1e-6);
    const auto beyond = surface.beyond_edge(*before), beyond_after = turned.beyond_edge(*after);
    ASSERT_TRUE(beyond && beyond_after) << polar;
    EXPECT_NEAR(*beyond_after, *beyond, 1e-6 * surface.width());
    const auto edge = surface.edge_near(*before, R), edge_after = turned.edge_near(*after, R);
    ASSERT_EQ(edge.has_value(), edge_after.has_value());
    if (edge) {
      EXPECT_LT((*edge_after - turn * *edge).norm(), 1e-12);
    }
  }
  EXPECT_NEAR(turned.departure({turn * Vector3d::Zero(), turn * Vector3d::UnitZ()}, R).rms,
              surface.departure({Vector3d::Zero(), Vector3d::UnitZ()}, R).rms,
              1e-6 * surface.width());
}

TEST(Doubted, VerticesOfASphereMoveByWhatFacetsLieBelowIt) {
  constexpr double edge = 2e-3;
  const TriangleSurface surface = ball(edge);
  const TriangleSurface moved = doubted(surface, 1, 1, 7);
  const Vector3d centre(0, 0, -R);
  double mean = 0;
  int outwards = 0;
  for (const Vector3d& vertex : moved.vertices_m) {
    const double by = (vertex - centre).norm() - R;
    mean += std::abs(by);
    outwards += by > 0;
  }
  const auto count = static_cast<double>(moved.vertices_m.size());
  // Edges of the mesher are as long as asked for to a third or so, and their squares count.
  EXPECT_NEAR(mean / count / (edge * edge / (8 * R)), 1, 0.7);
  EXPECT_NEAR(outwards / count, 0.5, 3 * 0.5 / std::sqrt(count)) << "a fair coin";
  const TriangleSurface less = doubted(surface, 1, 0.25, 7);
  for (std::size_t i = 0; i < moved.vertices_m.size(); ++i) {
    const Vector3d& at = surface.vertices_m[i];
    EXPECT_LT((less.vertices_m[i] - at - (moved.vertices_m[i] - at) / 4).norm(), 1e-15 + 1e-14 * R);
  }
}

TEST(Doubted, NeitherPlanesNorCreasesMove) {
  // Two halves of a square, folded by 90 degrees along the diagonal.
  const TriangleSurface fold{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  const TriangleSurface flat{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(doubted(flat, 1, 1, 1).vertices_m[i], flat.vertices_m[i]);
    // The vertices of the crease have normals between those of the facets.
    EXPECT_LT((doubted(fold, 0.5, 1, 1).vertices_m[i] - fold.vertices_m[i]).norm(), 1e-12);
  }
}

/// A box's top, sides and ends from z = -depth to 0, with corners at these x and y, and a shelf
/// inside it that ends somewhere under the top.
TriangleSurface box_with_shelf(double low_x, double high_x, double low_y, double high_y,
                               double depth) {
  TriangleSurface surface;
  const auto add = [&](const Vector3d& corner, const Vector3d& one, const Vector3d& other) {
    const int first = static_cast<int>(surface.vertices_m.size());
    for (const Vector3d& at :
         {corner, Vector3d(corner + one), Vector3d(corner + one + other), Vector3d(corner + other)})
      surface.vertices_m.push_back(at);
    surface.triangles.push_back({first, first + 1, first + 2});
    surface.triangles.push_back({first, first + 2, first + 3});
  };
  const Vector3d x = (high_x - low_x) * Vector3d::UnitX(), y = (high_y - low_y) * Vector3d::UnitY(),
                 z = depth * Vector3d::UnitZ();
  const Vector3d low(low_x, low_y, -depth), top(low_x, low_y, 0);
  add(top, x, y);
  add(low, x, z);
  add(low + y, z, x);
  add(low, z, y);
  add(low + x, y, z);
  add(low + 0.7 * z, 0.6 * x, y);
  return surface;
}

TEST(SmoothSurface, KnowsHowFarItsSharpEdgesAre) {
  constexpr double low_x = -6e-3, high_x = 7e-3, low_y = -2e-3, high_y = 9e-3;
  constexpr double shelf_end = low_x + 0.6 * (high_x - low_x);  // ends nothing, but is an edge
  constexpr double depth = 4e-3, shelf_depth = 0.3 * depth;
  const SmoothSurface surface(box_with_shelf(low_x, high_x, low_y, high_y, depth),
                              {0.5e-3, 1.05, 30e-3});
  for (const double x : {-5e-3, -1e-3, 1.6e-3, 3e-3, 6.5e-3})
    for (const double y : {-1.5e-3, 0.0, 4e-3, 8e-3}) {
      const auto beyond = surface.beyond_edge({{x, y, 0}, Vector3d::UnitZ()});
      ASSERT_TRUE(beyond);
      const double of_box = std::min({x - low_x, high_x - x, y - low_y, high_y - y});
      const double of_shelf = std::abs(x - shelf_end);
      // The nearest edge counts, by how far the point lies from it along the surface.
      const double distance = std::hypot(of_shelf, shelf_depth) < of_box ? of_shelf : of_box;
      EXPECT_NEAR(*beyond, -distance, 1e-9) << x << ' ' << y;
    }
  for (const double x : {-5e-3, 1.6e-3, 6e-3})
    for (const double distance : {-0.4e-3, 0.2e-3, 0.6e-3}) {
      const auto beyond = surface.beyond_edge({{x, low_y - distance, 0}, Vector3d::UnitZ()});
      ASSERT_TRUE(beyond);
      EXPECT_NEAR(*beyond, distance, 1e-9);
    }
  const auto along = surface.edge_near({Vector3d::Zero(), Vector3d::UnitZ()}, 3e-3);
  ASSERT_TRUE(along);
  EXPECT_NEAR(std::abs(along->x()), 1, 1e-9);
  EXPECT_FALSE(surface.edge_near({Vector3d(0, 3.5e-3, 0), Vector3d::UnitZ()}, 0.5e-3));
}

TEST(SmoothSurface, RefusesAPlaceWithoutFacets) {
  TriangleSurface far = ball(2e-3);
  for (Vector3d& vertex : far.vertices_m) vertex.x() += 1;
  EXPECT_THROW(SmoothSurface(far, {1e-3, 1.05, 15e-3}), InputError);
}

class ScannedSphere : public testing::Test {
 protected:
  static ScannedLayer layer(const SmoothSurface& surface, double thickness, double radius) {
    return {surface, *surface.project(Vector3d::Zero(), Vector3d::UnitZ()), Vector3d::UnitX(),
            thickness, radius};
  }
  const SmoothSurface surface{ball(0.5e-3), {1e-3, 1.05, 30e-3}};
  const Vector3d centre{0, 0, -R};
};

TEST_F(ScannedSphere, LayerHasItsThicknessEverywhere) {
  constexpr double h = 2e-3;
  const ScannedLayer found = layer(surface, h, 8e-3);
  for (double x = -5e-3; x < 5e-3; x += 0.7e-3)
    for (double y = -5e-3; y < 5e-3; y += 0.7e-3) {
      // Bicubic patches over cells of 1 mm on a radius of 8 mm: of fourth order.
      const double of_patches = std::pow(1e-3 / R, 4) * R;
      EXPECT_NEAR((found.position(x, y, 0) - centre).norm(), R, of_patches + 1e-3 * h);
      EXPECT_NEAR((found.position(x, y, -1) - centre).norm(), R - h, of_patches + 5e-3 * h);
      EXPECT_GT(found.normal(x, y).dot((found.position(x, y, 0) - centre).normalized()), 0.999);
    }
  EXPECT_NEAR(found.depths(5e-3).low, 1, 0.01);
  EXPECT_NEAR(found.depths(5e-3).high, 1, 0.01);
}

TEST_F(ScannedSphere, ClothKeepsLengthsNearTheContact) {
  const ScannedLayer found = layer(surface, 2e-3, 8e-3);
  // The circumference of a disc of the radius r on a sphere is (r/R)²/6 shorter than a flat one's.
  // The cloth shares that out between its middle, which widens, and its edge.
  const double shortening = std::pow(8e-3 / R, 2) / 6;
  EXPECT_NEAR(found.area_ratio(0, 0), 1, shortening);
  EXPECT_NEAR(found.position(1e-3, 0, 0).x(), 1e-3, shortening / 2 * 1e-3);
}

TEST_F(ScannedSphere, LayerGoesRoundTheFingerAndSaysWhereItEnds) {
  // 115 degrees from the contact it has turned away; a cloth of 20 mm would go farther.
  const ScannedLayer found = layer(surface, 1e-3, 20e-3);
  const ScannedLayer::Reach reach = found.reach(0.3);
  EXPECT_GT(reach.distance, 1.2 * R);
  EXPECT_NE(reach.end, ClothEnd::none);
  EXPECT_EQ(found.end_in(-1e-3, 1e-3, -1e-3, 1e-3), ClothEnd::none);
}

TEST_F(ScannedSphere, LayerEndsOnItsCore) {
  // A ball of three quarters, in the finger but not in its middle: the layer is between 1 and 3 mm
  // thick, and 1.6 mm at the contact.
  constexpr double h = 2e-3, core_radius = 0.75 * R;
  const Vector3d core_centre = centre + Vector3d(0.8e-3, 0, 0.4e-3);
  TriangleSurface ball_of_core = ball(0.5e-3);
  for (Vector3d& vertex : ball_of_core.vertices_m)
    vertex = core_centre + (vertex - centre) * (core_radius / R);
  const SmoothSurface core(ball_of_core, {1e-3, 1.05, 30e-3});
  const ScannedLayer found(surface, *surface.project(Vector3d::Zero(), Vector3d::UnitZ()),
                           Vector3d::UnitX(), h, 6e-3, &core);
  ASSERT_EQ(found.end_in(-4e-3, 4e-3, -4e-3, 4e-3), ClothEnd::none);
  for (double x = -4e-3; x < 4e-3; x += 0.7e-3)
    for (double y = -4e-3; y < 4e-3; y += 0.7e-3) {
      EXPECT_NEAR((found.position(x, y, 0) - centre).norm(), R, 1e-3 * h);
      EXPECT_NEAR((found.position(x, y, -1) - core_centre).norm(), core_radius, 5e-3 * h);
    }
}

TEST_F(ScannedSphere, LayerEndsWhereItsCoreDoes) {
  TriangleSurface half = ball(0.5e-3);
  for (Vector3d& vertex : half.vertices_m) vertex = centre + 0.75 * (vertex - centre);
  const auto& at = half.vertices_m;
  half.triangles.erase(std::remove_if(half.triangles.begin(), half.triangles.end(),
                                      [&](const std::array<int, 3>& triangle) {
                                        return at[static_cast<std::size_t>(triangle[0])].x() > 2e-3;
                                      }),
                       half.triangles.end());
  const SmoothSurface core(half, {1e-3, 1.05, 30e-3});
  const ScannedLayer found(surface, *surface.project(Vector3d::Zero(), Vector3d::UnitZ()),
                           Vector3d::UnitX(), 2e-3, 6e-3, &core);
  EXPECT_EQ(found.end_in(-4e-3, 1e-3, -2e-3, 2e-3), ClothEnd::none);
  EXPECT_NE(found.end_in(5e-3, 5.5e-3, 0, 0.5e-3), ClothEnd::none);
}

/// Half-axes of a spheroid whose tip, at the origin, has a radius of curvature of 2.2 mm.
constexpr double spheroid_across = 5.5e-3, spheroid_along = 14e-3;

/// Depth of a point below the spheroid, along its meridian.
double depth_below_spheroid(const Vector3d& point) {
  const double from_axis = point.head<2>().norm(), height = point.z() + spheroid_along;
  double nearest = 1;
  for (double polar = -1.5; polar < 1.5; polar += 1e-4)
    nearest = std::min(nearest, std::hypot(spheroid_across * std::sin(polar) - from_axis,
                                           spheroid_along * std::cos(polar) - height));
  return nearest;
}

TEST(ErodedCore, OfATipThatBendsMoreSharplyThanTheLayerIsThick) {
  constexpr double h = 3e-3, radius = 10e-3, edge = 0.03;
  TriangleSurface tip = sphere(radius, edge * radius);
  for (Vector3d& vertex : tip.vertices_m) {
    const Vector3d unit = vertex / radius;
    vertex = {spheroid_across * unit.x(), spheroid_across * unit.y(),
              spheroid_along * (unit.z() - 1)};
  }
  const SmoothSurface surface(tip, {h / 2, 1.05, 30e-3});
  const ScannedLayer layer(surface, *surface.project(Vector3d::Zero(), Vector3d::UnitZ()),
                           Vector3d::UnitX(), h, 8e-3, nullptr, Erosion{0.5, 0.25});
  ASSERT_EQ(layer.end_in(-4e-3, 4e-3, -4e-3, 4e-3), ClothEnd::none);
  double shallowest = 1, deepest = 0;
  for (double x = -4e-3; x < 4e-3; x += 0.7e-3)
    for (double y = -4e-3; y < 4e-3; y += 0.7e-3) {
      const double depth = depth_below_spheroid(layer.position(x, y, -1)) / h;
      shallowest = std::min(shallowest, depth);
      deepest = std::max(deepest, depth);
    }
  // Bicubic patches over cells of h/2 round the ridge off: the cone's sides, inclined by 24 degrees
  // where the normals begin to cross, are up to h/4 away from a node.
  constexpr double of_ridge = 0.25 * 0.1, of_ways = 2e-3, of_facets = 1e-3;
  EXPECT_GT(shallowest, 1 - of_ridge - of_ways - of_facets);
  EXPECT_LT(deepest, 1 + of_ways + of_facets);
  // The exact cone's tip is 1.070 h below the finger's.
  EXPECT_NEAR(layer.position(0, 0, -1).z() / h, -1.070, of_ways + of_facets);
}

TEST_F(ScannedSphere, ErodedCoreIsAConcentricSphere) {
  constexpr double h = 2e-3;
  const ScannedLayer found(surface, *surface.project(Vector3d::Zero(), Vector3d::UnitZ()),
                           Vector3d::UnitX(), h, 8e-3, nullptr, Erosion{});
  for (double x = -5e-3; x < 5e-3; x += 0.7e-3)
    for (double y = -5e-3; y < 5e-3; y += 0.7e-3)
      // Accuracy: 0.2 % of the depth of 2 h that the search directions lead to, and that of patches
      // as above.
      EXPECT_NEAR((found.position(x, y, -1) - centre).norm(), R - h,
                  std::pow(1e-3 / R, 4) * R + 2 * 5e-3 * h);
}

TEST(ScannedLayerRim, EndsWhereTheMeshEnds) {
  TriangleSurface half = ball(0.5e-3);
  std::vector<std::array<int, 3>> kept;
  for (const auto& triangle : half.triangles)
    if (half.vertices_m[static_cast<std::size_t>(triangle[0])].x() < 3e-3) kept.push_back(triangle);
  half.triangles = kept;
  const SmoothSurface surface(half, {1e-3, 1.05, 30e-3});
  const ScannedLayer layer(surface, *surface.project(Vector3d::Zero(), Vector3d::UnitZ()),
                           Vector3d::UnitX(), 1e-3, 8e-3);
  const ScannedLayer::Reach towards = layer.reach(0), away = layer.reach(M_PI);
  EXPECT_EQ(towards.end, ClothEnd::rim);
  EXPECT_NEAR(towards.distance, R * std::asin(3e-3 / R), 1e-3);  // a cell or two
  EXPECT_GT(away.distance, 6e-3);
}

}  // namespace
}  // namespace softfinger::meshes
