#include "meshes/generation/fingertip_layer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <string>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "triangulated_ellipsoid.h"

namespace softfinger::meshes {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Case {
  std::string name;
  std::shared_ptr<const PadSurface> pad;
  double thickness;
};

std::vector<Case> cases() {
  return {{"plane", paraboloid_pad(kInfinity, kInfinity), 1},
          {"ridge", paraboloid_pad(kInfinity, 10), 2},
          {"ridge across", paraboloid_pad(10, kInfinity), 2},
          {"paraboloid", paraboloid_pad(25, 10), 2},
          {"paraboloid across", paraboloid_pad(7, 25), 2},
          {"paraboloid, turned", paraboloid_pad(25, 10, 0.5), 2},
          {"sphere", sphere_pad(10), 3},
          {"thick sphere", sphere_pad(10), 8.5},
          {"thin sphere", sphere_pad(10), 0.1},
          {"ellipsoid", ellipsoid_pad(25, 10), 2},
          {"ellipsoid, turned", ellipsoid_pad(25, 10, 9, -0.7), 2},
          {"tapered", tapered_pad(25, 7, 0.03), 1}};
}

TEST(FingertipLayer, XAndYAreArcLengthsAtTheContactPoint) {
  for (const auto& [name, pad, thickness] : cases()) {
    const FingertipLayer layer(pad, thickness);
    EXPECT_LT(layer.position(0, 0, 0).norm(), 1e-15) << name;
    EXPECT_LT((layer.gradient(0, 0, 0) - Matrix3d::Identity()).norm(), 1e-9) << name;
    EXPECT_LT((layer.position(0, 0, -1) + thickness * Vector3d::UnitZ()).norm(), 1e-15) << name;
  }
}

TEST(FingertipLayer, TopHasThePadsRadii) {
  for (const auto& [name, pad, thickness] : cases()) {
    const FingertipLayer layer(pad, thickness);
    const double step = 1e-3 * std::min({pad->radius_x(), pad->radius_y(), 10.0});
    // On y = 0 a section's next order: taper and turn contribute odd powers, which the sum removes.
    const auto curvature = [&](double x, double y) {
      const Vector3d one = layer.position(x, y, 0), two = layer.position(-x, -y, 0);
      return -(one.z() + two.z()) / (one.head<2>().squaredNorm());
    };
    const double round_off = 1e-15 / (step * step);
    for (const auto& [k, radius] : {std::pair(curvature(step, 0), pad->radius_x()),
                                    std::pair(curvature(0, step), pad->radius_y())})
      EXPECT_NEAR(k, 1 / radius, 1e-5 / std::min(radius, 100.0) + round_off) << name;
  }
}

TEST(FingertipLayer, IsAsThickAsToldAlongTheNormal) {
  for (const auto& [name, pad, thickness] : cases()) {
    const FingertipLayer layer(pad, thickness);
    const double x = std::min(layer.reach_x(), 20.0), y = std::min(layer.reach_y(), 20.0);
    for (double s = -1; s <= 1; s += 0.125)
      for (double t = -1; t <= 1; t += 0.125) {
        const Vector3d top = layer.position(s * x, t * y, 0),
                       core = layer.position(s * x, t * y, -1), normal = layer.normal(s * x, t * y);
        EXPECT_NEAR((top - core).norm(), thickness, 1e-12);
        EXPECT_NEAR((top - core).dot(normal), thickness, 1e-12);
        const Matrix3d gradient = layer.gradient(s * x, t * y, 0);
        EXPECT_NEAR(gradient.col(0).dot(normal), 0, 1e-8 * gradient.norm()) << name;
        EXPECT_NEAR(gradient.col(1).dot(normal), 0, 1e-8 * gradient.norm()) << name;
        const auto again = pad->meet(top - 0.1 * normal, normal);
        ASSERT_TRUE(again) << name;
        EXPECT_LT((again->point - top).norm(), 1e-12 * std::max(1.0, top.norm())) << name;
      }
  }
}

TEST(FingertipLayer, IsRegularOverItsReach) {
  for (const auto& [name, pad, thickness] : cases()) {
    const FingertipLayer layer(pad, thickness);
    // The layer reaches as far as its contact can ever be wide.
    EXPECT_GT(layer.reach_x(), 0.5 * std::min(pad->radius_x(), 10 * thickness)) << name;
    EXPECT_GT(layer.reach_y(), 0.5 * std::min(pad->radius_y(), 10 * thickness)) << name;
    EXPECT_GT(layer.verify(layer.reach_x(), layer.reach_y(), 61), 0) << name;
  }
}

TEST(FingertipLayer, SphereIsCoveredUpToTheLargestTurn) {
  const double radius = 10, thickness = 3;
  const FingertipLayer layer(sphere_pad(radius), thickness);
  EXPECT_NEAR(layer.reach_x(), 75 * kPi / 180 * radius, 1e-12);
  EXPECT_NEAR(layer.reach_y(), 75 * kPi / 180 * radius, 1e-12);
  // The reference's meridians draw together with the cosine; the core is the smaller sphere.
  const double exact = std::pow(1 - thickness / radius, 2) * std::cos(75 * kPi / 180);
  EXPECT_NEAR(layer.verify(layer.reach_x(), layer.reach_y(), 20), exact, 1e-8);
}

TEST(FingertipLayer, HasTheVolumeOfASphericalShell) {
  const double radius = 10, x = 9, y = 6;
  for (const double thickness : {0.1, 3.0, 8.5}) {
    const FingertipLayer layer(sphere_pad(radius), thickness);
    // Gauss's rule with 3 points: exact in z, where the ratio is a parabola.
    const double root = std::sqrt(0.6), points[] = {-root, 0, root},
                 weights[] = {5 / 9.0, 8 / 9.0, 5 / 9.0};
    const int cells = 16;
    double volume = 0;
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b)
            for (int c = 0; c < 3; ++c) {
              const double at_x = x * ((2 * i + 1 + points[a]) / cells - 1),
                           at_y = y * ((2 * j + 1 + points[b]) / cells - 1),
                           at_z = (points[c] - 1) / 2;
              volume += weights[a] * weights[b] * weights[c] / 8 *
                        layer.gradient(at_x, at_y, at_z).determinant();
            }
    volume *= 4 * x * y * thickness / (cells * cells);
    // Latitudes up to y/R and longitudes up to x/R: the share of the sphere is their product.
    const double share = x / radius / kPi * std::sin(y / radius);
    const double shell = 4 * kPi / 3 * (std::pow(radius, 3) - std::pow(radius - thickness, 3));
    EXPECT_NEAR(volume / (share * shell), 1, 1e-8) << thickness;
  }
}

TEST(FingertipLayer, IsExactlySymmetricWhereItSaysSo) {
  int in_x = 0, in_y = 0;
  for (const auto& [name, pad, thickness] : cases()) {
    const FingertipLayer layer(pad, thickness);
    in_x += layer.symmetric_x();
    in_y += layer.symmetric_y();
    for (double x = 0; x < 7; x += 0.37)
      for (double y = 0; y < 6; y += 0.41) {
        const Vector3d one = layer.position(x, y, -0.3);
        if (layer.symmetric_x()) {
          const Vector3d other = layer.position(-x, y, -0.3);
          EXPECT_EQ(one, Vector3d(-other.x(), other.y(), other.z())) << name;
        }
        if (layer.symmetric_y()) {
          const Vector3d other = layer.position(x, -y, -0.3);
          EXPECT_EQ(one, Vector3d(other.x(), -other.y(), other.z())) << name;
        }
      }
    if (layer.symmetric_x()) {
      EXPECT_EQ(layer.position(0, 3, -1).x(), 0) << name;
    }
  }
  EXPECT_EQ(in_x, 9);   // all but the turned and the tapered ones
  EXPECT_EQ(in_y, 10);  // the tapered one as well
}

TEST(FingertipLayer, SwappingXAndYSwapsTheMap) {
  const FingertipLayer one(ellipsoid_pad(25, 10), 2), two(ellipsoid_pad(10, 25), 2);
  const Vector3d a = one.position(5, 3, -0.5), b = two.position(3, 5, -0.5);
  EXPECT_LT((a - Vector3d(b.y(), b.x(), b.z())).norm(), 1e-15 * 25);
  EXPECT_NEAR(one.reach_x(), two.reach_y(), 1e-12);
}

TEST(FingertipLayer, RefusesALayerThatLeavesNoCore) {
  try {
    FingertipLayer(sphere_pad(10), 9.5);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("9.5"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("radius, 10"), std::string::npos) << error.what();
  }
  // The smallest radius counts, whichever way it is turned.
  EXPECT_THROW(FingertipLayer(paraboloid_pad(100, 2, kPi / 4), 2), InputError);
  for (const double thickness : {0.0, -1.0, kInfinity, std::nan("")})
    EXPECT_THROW(FingertipLayer(sphere_pad(10), thickness), InputError);
}

TEST(FingertipLayer, NamesThePlaceWhereItIsInverted) {
  // Flat in the middle, turning with the radius C²/A = 2.5 at the side: a layer of 3 folds there.
  const FingertipLayer layer(ellipsoid_pad(10, 10, 4), 3);
  EXPECT_GT(layer.reach_x(), 2);
  EXPECT_LT(layer.reach_x(), 10);
  EXPECT_GT(layer.verify(layer.reach_x(), layer.reach_y(), 50), 0);
  try {
    layer.verify(10, 10, 50);
    FAIL();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("inverted"), std::string::npos) << what;
    EXPECT_NE(what.find("map at (x, y) = ("), std::string::npos) << what;
  }
  EXPECT_THROW(layer.verify(0, 1, 10), InputError);
  EXPECT_THROW(layer.verify(1, 1, 0), InputError);
}

TEST(TriangulatedLayer, ApproachesTheExactOneWithTheChord) {
  const Vector3d centre(0.01, -0.02, 0.03), axes(15.8e-3, 10e-3, 10e-3);  // radii 25 and 10 mm
  const double thickness = 2e-3, smallest = 6.3e-3;                       // b²/a at the ends
  const double radius_x = axes.x() * axes.x() / axes.z();
  const FingertipLayer exact(ellipsoid_pad(radius_x, axes.y(), axes.z()), thickness);
  for (const int n : {12, 24, 48}) {
    const auto body = triangulated_ellipsoid(axes, centre, n);
    const SurfacePlacement placement{centre + Vector3d(0, 0, axes.z()), {0, 0, 1}, {1, 0, 0}};
    const FingertipLayer layer(triangulated_pad(body, placement, radius_x, axes.y()), thickness);
    EXPECT_GT(layer.reach_x(), 10e-3);
    EXPECT_GT(layer.reach_y(), 8e-3);
    EXPECT_GT(layer.verify(layer.reach_x(), layer.reach_y(), 40), 0);
    EXPECT_FALSE(layer.symmetric_x() || layer.symmetric_y());
    // A facet lies below its arc by up to (circumradius)² / (2 R), the circumradius at most the
    // longest edge / sqrt(2); along a line that leans by 30 degrees at most a sixth more.
    const double edge = longest_edge(body), chord = edge * edge / (4 * smallest) * 7 / 6;
    double farthest = 0, tilt = 0;
    for (double x = -9e-3; x <= 9e-3; x += 0.61e-3)
      for (double y = -7e-3; y <= 7e-3; y += 0.53e-3) {
        farthest = std::max(farthest, (layer.position(x, y, 0) - exact.position(x, y, 0)).norm());
        tilt = std::max(tilt, (layer.normal(x, y) - exact.normal(x, y)).norm());
      }
    EXPECT_LT(farthest, chord) << n;
    // Vertex normals differ from the exact ones by the facets' own deviations, averaged.
    EXPECT_LT(tilt, edge / smallest / 2) << n;
  }
}

TEST(TriangulatedLayer, EndsWhereTheSurfaceEnds) {
  TriangleSurface square;  // 4 mm wide, flat
  square.vertices_m = {{-2e-3, -2e-3, 0}, {2e-3, -2e-3, 0}, {2e-3, 2e-3, 0}, {-2e-3, 2e-3, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const FingertipLayer layer(triangulated_pad(square, {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}), 1e-3);
  EXPECT_GT(layer.reach_x(), 0.9e-3);
  EXPECT_LT(layer.reach_x(), 2e-3);
  EXPECT_NO_THROW(layer.position(1.9e-3, -1.9e-3, -1));
  try {
    layer.position(2.5e-3, 0, 0);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("(0.0025, 0)"), std::string::npos) << error.what();
  }
  EXPECT_THROW(layer.verify(2.5e-3, 1e-3, 10), InputError);
}

TEST(TriangulatedLayer, SeesAFoldThatIsSmallerThanTheLattice) {
  // A bump's side turns by 45 degrees within 0.1 mm: 1 mm below, the core's normals cross.
  TriangleSurface bumpy;
  const int n = 40;
  const double spacing = 0.1e-3;
  for (int j = -n; j <= n; ++j)
    for (int i = -n; i <= n; ++i) {
      const bool bump = i == 27 && j == 21;
      bumpy.vertices_m.push_back({i * spacing, j * spacing, bump ? spacing : 0});
    }
  const int row = 2 * n + 1;
  for (int j = 0; j < 2 * n; ++j)
    for (int i = 0; i < 2 * n; ++i) {
      const int a = j * row + i;
      bumpy.triangles.push_back({a, a + 1, a + row + 1});
      bumpy.triangles.push_back({a, a + row + 1, a + row});
    }
  const SurfacePlacement placement{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
  const FingertipLayer layer(triangulated_pad(bumpy, placement, 50e-3, 50e-3), 1e-3);
  EXPECT_TRUE(layer.reach_x() < 2.7e-3 || layer.reach_y() < 2.1e-3);
  EXPECT_GT(layer.verify(1.9e-3, 1.9e-3, 7), 0);
  EXPECT_THROW(layer.verify(3e-3, 3e-3, 1), InputError);
}

}  // namespace
}  // namespace softfinger::meshes
