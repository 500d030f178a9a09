#include "comparisons/prediction/gap_sampling.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "meshes/io/read_surface.h"
#include "softfinger/fft/layer_contact.h"
#include "softfinger/input/errors.h"
#include "tests/meshes/triangulated_ellipsoid.h"

namespace softfinger {
namespace {

using Eigen::Vector3d;

const ElasticLayer kLayer{2e-3, 3e5, 0.45};
constexpr double kLoad_N = 1;

/// A mesh pressed against a plane, and what it answers.
class GapSampling : public ::testing::Test {
 protected:
  input::Case mesh_case(const TriangleSurface& surface, const Vector3d& point_m,
                        const Vector3d& normal, double load_N = kLoad_N,
                        const std::string& object = "radii_mm = [inf, inf]") {
    // A file of its own each time: what was read is not written again.
    const std::string file = fmt::format("mesh_{}.stl", files_++);
    meshes::write_stl_mm(surface, (folder_ / file).string());
    return input::parse_case(
        fmt::format("id = \"mesh\"\n[geometry]\nfinger = {{ mesh = \"{}\", point_mm = [{}, "
                    "{}, {}], normal = [{}, {}, {}] }}\nobject = {{ {} }}\n[layer]\nthickness_mm = "
                    "2.0\nyoungs_modulus_kPa = 300.0\npoisson_ratio = 0.45\n[contact]\nload_N = "
                    "{:.17g}\nfriction_coefficient = 0.8\n",
                    file, 1e3 * point_m.x(), 1e3 * point_m.y(), 1e3 * point_m.z(), normal.x(),
                    normal.y(), normal.z(), object, load_N),
        folder_ / "mesh.toml");
  }

  static prediction::ModelAnswer ask(const input::Case& contact_case) {
    const prediction::GeometryResolver resolver(contact_case);
    const double load_N = contact_case.loads_N.front();
    return prediction::ask_sampled_gap(resolver, resolver.resolve(load_N), contact_case, load_N);
  }

  static std::string refusal(const input::Case& contact_case) {
    try {
      ask(contact_case);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  const std::filesystem::path folder_ = [] {
    std::string name = ::testing::TempDir() + "/softfinger-gap-XXXXXX";
    return std::filesystem::path(mkdtemp(name.data()));
  }();
  int files_ = 0;
};

/// Facets lie up to this far inside a body whose largest curvature is 1/R.
double sag_m(const TriangleSurface& surface, double radius_m) {
  return std::pow(meshes::longest_edge(surface), 2) / (8 * radius_m);
}

/// A gap that is between g and g + sag needs, under the same load, an approach that differs by at
/// most the sag (pressure grows with the overlap). Contact and torque grow with a power of the
/// approach that is below one.
void expect_within_facets(const Prediction& sampled, const LayerContact& exact, double sag_m) {
  const double relative = sag_m / exact.approach_m;
  EXPECT_NEAR(sampled.indentation_m, exact.approach_m, sag_m);
  EXPECT_NEAR(sampled.torque_arm_exact_m / exact.torque_arm_m, 1, relative);
  EXPECT_NEAR(sampled.a_m / exact.edge.a, 1, relative);
  EXPECT_NEAR(sampled.b_m / exact.edge.b, 1, relative);
}

double sphere_gap(double radius_m, double x_m, double y_m) {
  const double r2 = x_m * x_m + y_m * y_m;
  return r2 / (radius_m + std::sqrt(radius_m * radius_m - r2));
}

TEST_F(GapSampling, MeshesOfASphereConvergeToTheExactSphereWithTheirFacets) {
  const double R = 0.01;
  const LayerContact exact =
      solve_layer_contact([=](double x, double y) { return sphere_gap(R, x, y); },
                          {0, 0, 0.7 * R, 0.7 * R}, kLayer, {}, kLoad_N);
  std::printf("edges/a   sag/d   error of a, b, d, torque and its estimate for d, torque (%%)\n");
  // Inside a facet, across an edge, beside a vertex: nothing of the mesh is aligned with the
  // contact.
  const Vector3d direction = Vector3d(0.3, -0.55, 0.7).normalized();
  for (const int n : {12, 24, 48, 96}) {
    const TriangleSurface mesh = meshes::triangulated_ellipsoid({R, R, R}, {0.001, 0, 0.002}, n);
    const prediction::ModelAnswer answer =
        ask(mesh_case(mesh, Vector3d(0.001, 0, 0.002) + R * direction, direction));
    const auto percent = [](double value, double truth) { return 100 * (value / truth - 1); };
    const Prediction& p = answer.prediction;
    const auto& changes = answer.sampled->changes_by_rounding;
    std::printf("%.2f   %.4f   %.2f %.2f %.2f %.2f   %.2f %.2f\n",
                meshes::longest_edge(mesh) / exact.edge.a, sag_m(mesh, R) / exact.approach_m,
                percent(p.a_m, exact.edge.a), percent(p.b_m, exact.edge.b),
                percent(p.indentation_m, exact.approach_m),
                percent(p.torque_arm_exact_m, exact.torque_arm_m), 100 * changes.indentation,
                100 * changes.torque);
    expect_within_facets(p, exact, sag_m(mesh, R));
    // The error is known: rounding leaves a small part of it.
    EXPECT_NEAR(changes.indentation, std::abs(p.indentation_m / exact.approach_m - 1),
                0.5 * sag_m(mesh, R) / exact.approach_m);
    EXPECT_LT(answer.sampled->centre_m.norm(), 0.05 * exact.edge.a);
  }
}

TEST_F(GapSampling, EllipsoidKeepsItsAxesInATurnedFrame) {
  // The exact gap at the pole of the semi-axis C.
  const double A = 0.02, B = 0.012, C = 0.01;
  const TriangleSurface mesh = meshes::triangulated_ellipsoid({A, B, C}, {0, 0, 0}, 120);
  const LayerContact exact = solve_layer_contact(
      [=](double x, double y) {
        const double q = x * x / (A * A) + y * y / (B * B);
        return C * q / (1 + std::sqrt(1 - q));
      },
      {0, 0, 0.7 * A, 0.7 * B}, kLayer, {}, kLoad_N);
  // Larger than on the sphere of radius C by the squares of the axes: the smallest radius is
  // C (C/A)² at the ends, but B²/C at the pole.
  const double sag = sag_m(mesh, B * B / C);
  const prediction::ModelAnswer answer = ask(mesh_case(mesh, {0, 0, C}, Vector3d::UnitZ()));
  expect_within_facets(answer.prediction, exact, sag);
  // The fit's x axis is the global x, along which the ellipsoid is longest.
  EXPECT_NEAR(answer.problem.radii.axis_rad, 0, sag / exact.approach_m);

  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.9, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Vector3d shift(0.03, -0.01, 0.02);
  TriangleSurface turned = mesh;
  for (Vector3d& vertex : turned.vertices_m) vertex = turn * vertex + shift;
  const prediction::ModelAnswer again =
      ask(mesh_case(turned, turn * Vector3d(0, 0, C) + shift, turn * Vector3d::UnitZ()));
  // Through seven digits of an STL file.
  EXPECT_NEAR(again.prediction.a_m / answer.prediction.a_m, 1, 2e-3);
  EXPECT_NEAR(again.prediction.b_m / answer.prediction.b_m, 1, 2e-3);
  EXPECT_NEAR(again.prediction.indentation_m / answer.prediction.indentation_m, 1, 1e-3);
  const Vector3d normal = turn.col(2);
  const Vector3d x = (Vector3d::UnitX() - normal.x() * normal).normalized();
  const double axis =
      std::remainder(std::atan2(turn.col(0).dot(normal.cross(x)), turn.col(0).dot(x)), M_PI);
  EXPECT_NEAR(std::remainder(again.problem.radii.axis_rad - axis, M_PI), 0, 0.01);
}

TEST_F(GapSampling, SphereAsTheObjectIsExact) {
  const double R = 0.02, object_R = 0.03;
  const TriangleSurface mesh = meshes::triangulated_ellipsoid({R, R, R}, {0, 0, 0}, 96);
  const LayerContact exact = solve_layer_contact(
      [=](double x, double y) { return sphere_gap(R, x, y) + sphere_gap(object_R, x, y); },
      {0, 0, 0.7 * R, 0.7 * R}, kLayer, {}, kLoad_N);
  expect_within_facets(
      ask(mesh_case(mesh, {0, 0, R}, Vector3d::UnitZ(), kLoad_N, "sphere_radius_mm = 30"))
          .prediction,
      exact, sag_m(mesh, R));
}

TEST_F(GapSampling, RefusesAMeshThatDoesNotCoverTheContact) {
  const double R = 0.01;
  const Vector3d pole(0, 0, R);
  const TriangleSurface whole = meshes::triangulated_ellipsoid({R, R, R}, {0, 0, 0}, 48);
  const double a = ask(mesh_case(whole, pole, Vector3d::UnitZ())).prediction.a_m;
  const auto without = [&](auto remove) {
    TriangleSurface part = whole;
    part.triangles.erase(
        std::remove_if(
            part.triangles.begin(), part.triangles.end(),
            [&](const auto& t) {
              return remove(
                  (whole.vertices_m[t[0]] + whole.vertices_m[t[1]] + whole.vertices_m[t[2]]) / 3);
            }),
        part.triangles.end());
    return part;
  };
  const auto cap = [&](double radius_m) {
    return without(
        [=](const Vector3d& at) { return at.z() < 0 || std::hypot(at.x(), at.y()) > radius_m; });
  };
  EXPECT_NE(refusal(mesh_case(cap(0.8 * a), pole, Vector3d::UnitZ())).find("mesh has to cover it"),
            std::string::npos);
  // The mesh need not cover places that the contact does not reach.
  EXPECT_EQ(refusal(mesh_case(cap(1.9 * a), pole, Vector3d::UnitZ())), "");

  const auto hole = [&](double distance_m) {
    return without([=](const Vector3d& at) {
      return at.z() > 0 && std::hypot(at.x() - distance_m, at.y()) < 0.15 * a;
    });
  };
  const std::string inside = refusal(mesh_case(hole(0.6 * a), pole, Vector3d::UnitZ()));
  EXPECT_NE(inside.find("mesh.toml:3: the finger's mesh ends, or has a hole or a step"),
            std::string::npos)
      << inside;
  EXPECT_EQ(inside.find('\n'), std::string::npos);
}

TEST_F(GapSampling, RefusesACaseWithoutMeshes) {
  const input::Case contact_case = input::parse_case(
      "id = \"radii\"\n[geometry]\nrelative_radii_mm = [20.0, 5.0]\n[layer]\nthickness_mm = "
      "2.0\nyoungs_modulus_kPa = 300.0\npoisson_ratio = 0.45\n[contact]\nload_N = "
      "1.0\nfriction_coefficient = 0.8\n",
      "radii.toml");
  const std::string said = refusal(contact_case);
  EXPECT_NE(said.find("radii.toml:2: --gap = sampled"), std::string::npos) << said;
  EXPECT_NE(said.find("mesh"), std::string::npos) << said;
}

}  // namespace
}  // namespace softfinger
