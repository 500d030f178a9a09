// Mass properties against closed forms from textbooks, integrals and each other.
#include "softfinger/dynamics/bodies/mass_properties.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "tests/meshes/triangulated_ellipsoid.h"

namespace softfinger {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
constexpr double kMassRoundOff = 64 * std::numeric_limits<double>::epsilon();

void expect_near(const Matrix3d& value, const Matrix3d& expected, double relative) {
  EXPECT_LE((value - expected).norm(), relative * expected.norm()) << value << "\nexpected\n"
                                                                   << expected;
}

/// Two triangles per face, counter-clockwise from outside.
TriangleSurface box_mesh(const Vector3d& size, const Vector3d& center) {
  TriangleSurface surface;
  for (int i = 0; i < 8; ++i)
    surface.vertices_m.push_back(
        center +
        size.cwiseProduct(Vector3d(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5)));
  surface.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return surface;
}

/// Moments of a solid of revolution of mass 1 about its z axis and across it, from its radius(z) on
/// [-half, half] by the midpoint rule: errors (range/count)² where radius² is smooth.
Vector3d moments_of_revolution(const std::function<double(double)>& radius, double half,
                               int count) {
  double volume = 0, along = 0, across = 0;
  for (int i = 0; i < count; ++i) {
    const double z = half * (2 * (i + 0.5) / count - 1), r2 = std::pow(radius(z), 2);
    volume += r2;
    along += r2 * r2 / 2;
    across += r2 * (r2 / 4 + z * z);
  }
  return Vector3d(across, across, along) / volume;
}

TEST(MassProperties, OfPrimitivesAreTheTextbooks) {
  const double x = 0.02, y = 0.05, z = 0.11;
  const MassProperties box = unit_mass_of_box({x, y, z});
  EXPECT_EQ(box.mass_kg, 1);
  EXPECT_EQ(box.center_m, Vector3d::Zero().eval());
  expect_near(
      box.inertia_kg_m2,
      Vector3d((y * y + z * z) / 12, (x * x + z * z) / 12, (x * x + y * y) / 12).asDiagonal(),
      kMassRoundOff);
  expect_near(unit_mass_of_ellipsoid({x, x, x}).inertia_kg_m2, 0.4 * x * x * Matrix3d::Identity(),
              kMassRoundOff);
  expect_near(unit_mass_of_ellipsoid({x, y, z}).inertia_kg_m2,
              Vector3d((y * y + z * z) / 5, (x * x + z * z) / 5, (x * x + y * y) / 5).asDiagonal(),
              kMassRoundOff);
  const double thin = 1e-9;
  expect_near(unit_mass_of_cylinder(thin, z).inertia_kg_m2.topLeftCorner<2, 2>().norm() *
                  Matrix3d::Identity(),
              std::sqrt(2.) * z * z / 12 * Matrix3d::Identity(), kMassRoundOff);
  expect_near(unit_mass_of_cylinder(x, thin).inertia_kg_m2,
              Vector3d(x * x / 4, x * x / 4, x * x / 2).asDiagonal(), thin);
}

TEST(MassProperties, OfRoundBodiesAreTheIntegrals) {
  const int count = 20000;
  const double midpoint = std::pow(2. / count, 2) * 10;
  for (const auto& [r, length] : {std::pair(0.01, 0.05), {0.04, 0.01}, {0.02, 1e-9}}) {
    const double half = length / 2, h = half + r;
    const auto capsule = [&, r = r](double z) {
      const double beyond = std::max(0., std::abs(z) - half);
      return std::sqrt(std::max(0., r * r - beyond * beyond));
    };
    expect_near(unit_mass_of_capsule(r, length).inertia_kg_m2,
                moments_of_revolution(capsule, h, count).asDiagonal(), midpoint);
    const auto cylinder = [r = r](double) { return r; };
    expect_near(unit_mass_of_cylinder(r, length).inertia_kg_m2,
                moments_of_revolution(cylinder, half, count).asDiagonal(), midpoint);
  }
}

TEST(MassProperties, OfAMeshedBoxAreExactAnywhere) {
  const Vector3d size(0.02, 0.05, 0.11);
  for (const Vector3d& center :
       {Vector3d(0, 0, 0), Vector3d(0.3, -0.2, 0.1), Vector3d(100, 0, 7)}) {
    double volume_m3 = 0;
    const MassProperties mass =
        unit_mass_of_closed_surface(box_mesh(size, center), "box", &volume_m3);
    // Coordinates have absolute round-off of the distance, which the smallest size magnifies.
    const double round_off = kMassRoundOff * (1 + center.norm() / size.minCoeff());
    EXPECT_NEAR(volume_m3, size.prod(), round_off * size.prod());
    EXPECT_LE((mass.center_m - center).norm(), round_off * size.norm());
    expect_near(mass.inertia_kg_m2, unit_mass_of_box(size).inertia_kg_m2, round_off);
  }
}

TEST(MassProperties, OfAMeshConvergeToThoseOfTheEllipsoid) {
  const Vector3d axes(0.01, 0.02, 0.03), center(0.1, 0, -0.05);
  const MassProperties exact = unit_mass_of_ellipsoid(axes);
  double last = 0;
  for (const int n : {8, 16, 32}) {
    double volume_m3 = 0;
    const MassProperties mass = unit_mass_of_closed_surface(
        meshes::triangulated_ellipsoid(axes, center, n), "ellipsoid", &volume_m3);
    EXPECT_LE((mass.center_m - center).norm(), kMassRoundOff * center.norm());
    const double error = (mass.inertia_kg_m2 - exact.inertia_kg_m2).norm();
    EXPECT_LT(volume_m3, 4 * kPi / 3 * axes.prod()) << "inscribed";
    // Facets lie below the surface by the square of their edge: order 2, pre-asymptotic at n = 8.
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.1);
    }
    last = error;
  }
  EXPECT_LT(last, 2e-3 * exact.inertia_kg_m2.norm());
}

TEST(MassProperties, TurnWithTheMesh) {
  const Vector3d size(0.02, 0.05, 0.11), center(0.03, 0.01, -0.02);
  const Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -3).normalized()).toRotationMatrix();
  TriangleSurface mesh = box_mesh(size, center);
  for (Vector3d& vertex : mesh.vertices_m) vertex = turn * vertex;
  const MassProperties mass = unit_mass_of_closed_surface(mesh, "box");
  EXPECT_LE((mass.center_m - turn * center).norm(), kMassRoundOff * size.norm());
  expect_near(mass.inertia_kg_m2, turn * unit_mass_of_box(size).inertia_kg_m2 * turn.transpose(),
              4 * kMassRoundOff);
}

TEST(MassProperties, ScaleWithUnitsAndMass) {
  const Vector3d axes(0.01, 0.02, 0.03);
  TriangleSurface mesh = meshes::triangulated_ellipsoid(axes, Vector3d(0.1, 0, 0), 6);
  const MassProperties metres = unit_mass_of_closed_surface(mesh, "mesh");
  for (const double scale : {1e-9, 1e3, 1e9}) {
    TriangleSurface scaled = mesh;
    for (Vector3d& vertex : scaled.vertices_m) vertex *= scale;
    const MassProperties other = unit_mass_of_closed_surface(scaled, "mesh");
    expect_near(other.inertia_kg_m2 / (scale * scale), metres.inertia_kg_m2, kMassRoundOff);
  }
  const MassProperties heavy = with_mass(with_mass(metres, 3), 250);
  EXPECT_EQ(heavy.mass_kg, 250);
  EXPECT_EQ(heavy.center_m, metres.center_m);
  expect_near(heavy.inertia_kg_m2, 250 * metres.inertia_kg_m2, kMassRoundOff);
}

TEST(MassProperties, OfAHollowBodyLeaveOutTheHole) {
  TriangleSurface mesh = box_mesh({0.1, 0.1, 0.1}, Vector3d::Zero());
  const TriangleSurface hole = box_mesh({0.04, 0.04, 0.04}, Vector3d::Zero());
  for (const auto& t : hole.triangles) mesh.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
  mesh.vertices_m.insert(mesh.vertices_m.end(), hole.vertices_m.begin(), hole.vertices_m.end());
  double volume_m3 = 0;
  const MassProperties mass = unit_mass_of_closed_surface(mesh, "shell", &volume_m3);
  const double whole = 1e-3, missing = 6.4e-5;
  EXPECT_NEAR(volume_m3, whole - missing, kMassRoundOff * whole);
  const double moment = (whole * 0.01 - missing * 0.0016) / 6 / (whole - missing);
  expect_near(mass.inertia_kg_m2, moment * Matrix3d::Identity(), 4 * kMassRoundOff);
}

TEST(MassProperties, RefuseWhatIsNotClosedOrInsideOut) {
  const TriangleSurface good = box_mesh({0.1, 0.1, 0.1}, Vector3d::Zero());
  const auto refused = [](const TriangleSurface& surface) {
    try {
      unit_mass_of_closed_surface(surface, "thing.stl");
    } catch (const InputError& error) {
      return error.where() == "thing.stl";
    }
    return false;
  };
  EXPECT_FALSE(refused(good));
  TriangleSurface bad = good;
  bad.triangles.pop_back();
  EXPECT_TRUE(refused(bad)) << "a hole";
  bad = good;
  std::swap(bad.triangles[3][0], bad.triangles[3][1]);
  EXPECT_TRUE(refused(bad)) << "one triangle the other way round";
  bad = good;
  for (auto& t : bad.triangles) std::swap(t[0], t[1]);
  EXPECT_TRUE(refused(bad)) << "inside out";
  bad = good;
  for (Vector3d& vertex : bad.vertices_m) vertex.z() = 0;
  EXPECT_TRUE(refused(bad)) << "flat";
  EXPECT_TRUE(refused({})) << "empty";
  bad = good;
  bad.triangles.push_back({0, 3, 5});
  EXPECT_TRUE(refused(bad)) << "a triangle inside";
}

TEST(MassProperties, RefuseWhatNoMassDistributionHas) {
  const auto physical = [](double mass_kg, const Matrix3d& inertia) {
    try {
      require_physical({mass_kg, Vector3d::Zero(), inertia}, "body");
    } catch (const InputError& error) {
      EXPECT_EQ(error.where(), "body");
      return false;
    }
    return true;
  };
  const auto diagonal = [](double a, double b, double c) {
    return Matrix3d(Vector3d(a, b, c).asDiagonal());
  };
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const double unit : {1e-12, 1., 1e12}) {
    EXPECT_TRUE(physical(unit, unit * diagonal(1, 1, 1)));
    EXPECT_TRUE(physical(unit, unit * diagonal(1, 1, 2))) << "a disc, the limit";
    EXPECT_TRUE(physical(unit, unit * diagonal(1, 1, 1e-6))) << "a rod";
    EXPECT_FALSE(physical(unit, unit * diagonal(1, 1, 2.001)));
    EXPECT_FALSE(physical(unit, unit * diagonal(1, 1, -0.1)));
    EXPECT_FALSE(physical(unit, unit * diagonal(1, 1, 0)));
    const Matrix3d turn = Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    EXPECT_FALSE(physical(unit, unit * turn * diagonal(1, 1, 2.001) * turn.transpose()));
    EXPECT_TRUE(physical(unit, unit * turn * diagonal(1, 1, 2) * turn.transpose()));
    Matrix3d skew = diagonal(1, 1, 1);
    skew(0, 1) = 0.1;
    EXPECT_FALSE(physical(unit, unit * skew));
  }
  EXPECT_FALSE(physical(0, diagonal(1, 1, 1)));
  EXPECT_FALSE(physical(-1, diagonal(1, 1, 1)));
  EXPECT_FALSE(physical(nan, diagonal(1, 1, 1)));
  EXPECT_FALSE(physical(infinity, diagonal(1, 1, 1)));
  EXPECT_FALSE(physical(1, diagonal(1, nan, 1)));
  EXPECT_FALSE(physical(1, Matrix3d::Zero()));
}

}  // namespace
}  // namespace softfinger
