#include "meshes/generation/surfaces.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <map>

#include "meshes/io/read_surface.h"
#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

double volume(const TriangleSurface& s) {
  double sum = 0;
  for (const auto& [a, b, c] : s.triangles)
    sum += s.vertices_m[a].dot(s.vertices_m[b].cross(s.vertices_m[c])) / 6;
  return sum;
}

/// Every edge is run through once in each direction: closed, and consistently oriented.
void expect_watertight(const TriangleSurface& s) {
  std::map<std::pair<int, int>, int> directed;
  for (const auto& t : s.triangles)
    for (int i = 0; i < 3; ++i) ++directed[{t[i], t[(i + 1) % 3]}];
  int open = 0, doubled = 0;
  for (const auto& [edge, count] : directed) {
    doubled += count > 1;
    open += directed.count({edge.second, edge.first}) == 0;
  }
  EXPECT_EQ(open, 0);
  EXPECT_EQ(doubled, 0);
}

/// Radii, normal and direction fitted at a point whose exact ones are known.
void expect_fits(const TriangleSurface& surface, const SurfacePoint& exact, double radius,
                 double tolerance) {
  const auto fit = fit_quadric(surface, exact.point_m, nullptr, radius);
  EXPECT_NEAR(exact.minor_m / fit.principal.radii_m[0], exact.minor_m / exact.major_m, tolerance);
  EXPECT_NEAR(exact.minor_m / fit.principal.radii_m[1], 1, tolerance);
  EXPECT_GT(fit.normal.dot(exact.normal), 1 - tolerance);
  const Vector3d y_axis = fit.normal.cross(fit.x_axis);
  const Vector3d major =
      std::cos(fit.principal.axis_rad) * fit.x_axis + std::sin(fit.principal.axis_rad) * y_axis;
  EXPECT_GT(std::abs(major.dot(exact.major_direction)), 1 - tolerance);
}

TEST(Surfaces, PadIsClosedConvexAndTapersToItsTip) {
  FingertipPad shape;
  shape.edge_length_m = 1e-3;
  const auto pad = fingertip_pad(shape);
  expect_watertight(pad);
  EXPECT_GT(volume(pad), 0);
  double tip = 0, base = 0;
  for (const auto& v : pad.vertices_m) {
    const double quarter = shape.length_m / 4;
    if (std::abs(v.z() - quarter) < 0.5e-3) tip = std::max(tip, v.x());
    if (std::abs(v.z() + quarter) < 0.5e-3) base = std::max(base, v.x());
  }
  // Vertices fall up to half an edge beside the two planes and beside the widest point.
  EXPECT_NEAR(tip / base, shape.tip_to_base_width, 0.03);
  // Vertices lie on the surface that the header gives; the middle of any two lies inside: convex.
  const double half = shape.length_m / 2, r = shape.across_radius_m;
  const double alpha = half * half / (r * shape.along_radius_m);
  const double slope =
      (1 - shape.tip_to_base_width) / (1 + shape.tip_to_base_width) * 4 / shape.length_m;
  const auto level = [&](const Vector3d& p) {  // 1 on the surface, less inside
    const double w = p.z() / half, s = r * std::sqrt(1 + (1 - alpha) * w * w);
    return std::pow(p.x() / (s * (1 - slope * p.z())), 2) + std::pow(p.y() / s, 2) + w * w;
  };
  const double round_off = 1e-12;
  for (const auto& v : pad.vertices_m) {
    ASSERT_NEAR(level(v), 1, round_off);
    for (std::size_t i = 0; i < pad.vertices_m.size(); i += 7)
      ASSERT_LT(level((v + pad.vertices_m[i]) / 2), 1 + round_off);
  }
}

TEST(Surfaces, PadHasItsNamedRadiiAtItsMiddle) {
  const FingertipPad shape;
  const double region = 2e-3;
  // The rest is the next order of the shape itself, about (region / smaller radius)² / 2, and the
  // chords, (edge / radius)².
  const double tolerance = std::pow(region / shape.across_radius_m, 2) / 2 +
                           std::pow(shape.edge_length_m / shape.across_radius_m, 2);
  expect_fits(fingertip_pad(shape), fingertip_pad_middle(shape), region, tolerance);
}

TEST(Surfaces, PadRefusesShapesThatAreNotConvex) {
  FingertipPad shape;
  shape.length_m = 60e-3;
  EXPECT_THROW(fingertip_pad(shape), InputError);
  shape = {};
  shape.edge_length_m = 0;
  EXPECT_THROW(fingertip_pad(shape), InputError);
}

TEST(Surfaces, GlassIsClosedHollowAndHasAConesRadiusOnItsWall) {
  const double foot = 25e-3, rim = 35e-3, height = 80e-3, edge = 2e-3;
  const auto mesh = glass(foot, rim, height, edge);
  expect_watertight(mesh);
  const double full = kPi * height * (foot * foot + foot * rim + rim * rim) / 3;
  EXPECT_GT(volume(mesh), 0.05 * full);
  EXPECT_LT(volume(mesh), 0.3 * full);
  const double region = 6e-3;
  const auto middle = glass_wall_middle(foot, rim, height);
  expect_fits(mesh, middle, region,
              std::pow(region / middle.minor_m, 2) / 2 + std::pow(edge / middle.minor_m, 2));
}

TEST(Surfaces, RoundedBoxIsACylinderAlongItsEdges) {
  const double side = 20e-3, rounding = 4e-3, edge = 0.6e-3, region = 1.5e-3;
  const auto mesh = rounded_box(side, rounding, edge);
  expect_watertight(mesh);
  EXPECT_NEAR(volume(mesh) / std::pow(side, 3), 1, 0.1);
  expect_fits(mesh, rounded_box_edge_middle(side, rounding), region,
              std::pow(region / rounding, 2) / 2 + std::pow(edge / rounding, 2));
  EXPECT_THROW(rounded_box(10e-3, 6e-3, 1e-3), InputError);
}

TEST(Surfaces, CylinderAndSphereEncloseTheirVolumes) {
  const double r = 10e-3, edge = 1e-3;
  // A chord lies below its arc by up to edge²/(8 R), on the whole surface.
  const double chords = 3 * edge * edge / (8 * r * r);
  const auto rod = cylinder(r, 30e-3, edge);
  expect_watertight(rod);
  EXPECT_NEAR(volume(rod) / (kPi * r * r * 30e-3), 1, chords);
  const auto ball = sphere(r, edge);
  expect_watertight(ball);
  EXPECT_NEAR(volume(ball) / (4 * kPi / 3 * r * r * r), 1, chords);
  for (const auto& v : ball.vertices_m) ASSERT_NEAR(v.norm(), r, 1e-9);  // the kernel's tolerance
}

TEST(Surfaces, AreTheSameEachTime) {
  const auto one = sphere(5e-3, 1e-3), two = sphere(5e-3, 1e-3);
  EXPECT_EQ(one.vertices_m, two.vertices_m);
  EXPECT_EQ(one.triangles, two.triangles);
}

TEST(Surfaces, SurviveTheWayThroughAFile) {
  const auto ball = sphere(10e-3, 1e-3);
  const auto path = (std::filesystem::temp_directory_path() /
                     ("softfinger_sphere_" + std::to_string(::getpid()) + ".stl"))
                        .string();
  write_stl_mm(ball, path);
  const auto read = read_surface(path, 1e-3);
  std::filesystem::remove(path);
  EXPECT_EQ(read.surface.vertices_m.size(), ball.vertices_m.size());
  EXPECT_EQ(read.surface.triangles.size(), ball.triangles.size());
  EXPECT_EQ(read.degenerate_triangles + read.duplicate_triangles, 0);
  EXPECT_FALSE(read.was_inside_out());
  expect_watertight(read.surface);
}

}  // namespace
}  // namespace softfinger::meshes
