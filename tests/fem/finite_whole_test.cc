// Contacts without symmetry at finite strain, on all of the layer: against the quarter, against
// linear elasticity for small loads, and against what has to hold for any.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/contact/pressing.h"
#include "fem/finite/deformed_contact.h"
#include "fem/finite/finite_pressing.h"
#include "fem/levels/error_model.h"
#include "fem/program/reference_solver.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "softfinger/input/errors.h"
#include "tests/fem/energy_balance.h"

namespace softfinger::fem {
namespace {

using finite::DeformedContact;
using finite::FinitePressing;

const Progress silent = [](const std::string&) {};

/// A mesh with cells of a third of the contact.
LayerDiscretisation mesh_for(double a, double b) {
  LayerDiscretisation mesh;
  mesh.a = a;
  mesh.b = b;
  mesh.elements_per_semi_axis = 3;
  mesh.patch = 1.6;
  mesh.extent = 2;
  return mesh;
}

FinitePressing layer_under(std::shared_ptr<const RigidObject> object,
                           const LayerDiscretisation& mesh, std::shared_ptr<const LayerShape> shape,
                           double poisson_ratio, MirrorPlanes planes = no_plane,
                           const MaterialChoice& choice = {}) {
  return {std::make_shared<finite::FiniteLayer>(mesh, std::move(shape), planes,
                                                finite::make_material(choice, 1.0, poisson_ratio)),
          std::move(object)};
}

/// The layer on a finger, in units of its thickness.
std::shared_ptr<const LayerShape> bent_onto(std::shared_ptr<const meshes::PadSurface> pad,
                                            LayerDiscretisation& mesh) {
  Fingertip fingertip;
  fingertip.pad = std::move(pad);
  const FingertipShape bent = shape_fingertip(fingertip, 1);
  mesh.reach_x = bent.reach_x;
  mesh.reach_y = bent.reach_y;
  return bent.shape;
}

std::unique_ptr<const RigidObject> sampled_object(
    std::shared_ptr<const meshes::ObjectSurface> object) {
  // Quadrics have no error from it: wide, against round-off.
  constexpr double step = 0.1;
  return sampled([object](double x, double y) { return object->height(x, y); }, step);
}

/// Two presses that Newton's method ends at 1e-9, through factors of condition about 1e5 whose
/// springs cost two digits.
constexpr double kSameDiscretisation = 1e-7;

void expect_the_same(FinitePressing& quarter, FinitePressing& whole, double approach) {
  for (FinitePressing* pressing : {&quarter, &whole}) pressing->press({0, approach});
  const finite::Equilibrium &expected = quarter.equilibrium(), &found = whole.equilibrium();
  EXPECT_NEAR(found.load / expected.load, 1, kSameDiscretisation);
  EXPECT_NEAR(found.energy / expected.energy, 1, kSameDiscretisation);
  EXPECT_NEAR(found.moment_a / expected.moment_a, 1, kSameDiscretisation);
  EXPECT_NEAR(found.moment_b / expected.moment_b, 1, kSameDiscretisation);
  const DeformedContact fitted = *measure(quarter, 1), measured = *measure(whole, 1);
  EXPECT_NEAR(measured.torque_arm / fitted.torque_arm, 1, kSameDiscretisation);
  EXPECT_NEAR(measured.projected_arm / fitted.projected_arm, 1, kSameDiscretisation);
  EXPECT_NEAR(measured.shape.turn_rad, 0, 1e-6);
  // Errors that the solver states for an edge between nodes, and for the fit on so coarse a mesh.
  const double of_edge = 0.1 / quarter.layer().discretisation().elements_per_semi_axis;
  constexpr double of_fit = 0.01;
  EXPECT_NEAR(measured.shape.a / fitted.shape.a, 1, of_edge + of_fit);
  EXPECT_NEAR(measured.shape.b / fitted.shape.b, 1, of_edge + of_fit);
  EXPECT_NEAR(measured.area / fitted.area, 1, 2 * (of_edge + of_fit));
}

TEST(FiniteWhole, IsTheQuarterOfASymmetricContact) {
  LayerDiscretisation mesh = mesh_for(1.4, 0.9);
  auto quarter = layer_under(quadric(8, 4), mesh, nullptr, 0.49, both_planes);
  auto whole = layer_under(quadric(8, 4), mesh, nullptr, 0.49);
  expect_the_same(quarter, whole, 0.2);
  mesh = mesh_for(1.3, 1.2);
  const auto shape = bent_onto(meshes::ellipsoid_pad(6, 5), mesh);
  auto bent_quarter = layer_under(sphere(20), mesh, shape, 0.3, both_planes);
  auto bent_whole = layer_under(sphere(20), mesh, shape, 0.3);
  expect_the_same(bent_quarter, bent_whole, 0.2);
}

/// A half has the whole's nodes and measurement: nothing but round-off is between them.
void expect_the_same_measured(FinitePressing& half, FinitePressing& whole, double approach) {
  for (FinitePressing* pressing : {&half, &whole}) pressing->press({0, approach});
  const finite::Equilibrium &expected = whole.equilibrium(), &found = half.equilibrium();
  EXPECT_NEAR(found.load / expected.load, 1, kSameDiscretisation);
  EXPECT_NEAR(found.energy / expected.energy, 1, kSameDiscretisation);
  const DeformedContact of_whole = *measure(whole, 1), of_half = *measure(half, 1);
  EXPECT_NEAR(of_half.torque_arm / of_whole.torque_arm, 1, kSameDiscretisation);
  EXPECT_NEAR(of_half.projected_arm / of_whole.projected_arm, 1, kSameDiscretisation);
  EXPECT_NEAR(of_half.area / of_whole.area, 1, kSameDiscretisation);
  for (const auto quantity :
       {&ContactShape::a, &ContactShape::b, &ContactShape::block_a, &ContactShape::block_b,
        &ContactShape::peak, &ContactShape::centre_pressure, &ContactShape::projected_area})
    EXPECT_NEAR(of_half.shape.*quantity / of_whole.shape.*quantity, 1, kSameDiscretisation);
  EXPECT_NEAR(of_half.shape.departure, of_whole.shape.departure, kSameDiscretisation);
  // An ellipse's long axis has no sense.
  EXPECT_NEAR(std::sin(of_half.shape.turn_rad - of_whole.shape.turn_rad), 0, kSameDiscretisation);
}

TEST(FiniteHalf, IsTheWholeOfAContactWithOneMirrorPlane) {
  LayerDiscretisation mesh = mesh_for(1.3, 1.0);
  const auto tapered = bent_onto(meshes::tapered_pad(8, 4, 0.1), mesh);
  const MirrorPlanes across_y{false, true}, across_x{true, false};
  auto half = layer_under(sphere(20), mesh, tapered, 0.45, across_y);
  auto whole = layer_under(sphere(20), mesh, tapered, 0.45);
  expect_the_same_measured(half, whole, 0.2);
  // Longer along y, by halves about either plane.
  mesh = mesh_for(1.0, 1.3);
  const auto ellipsoid = bent_onto(meshes::ellipsoid_pad(4, 8), mesh);
  auto whole_ellipse = layer_under(sphere(20), mesh, ellipsoid, 0.3);
  for (const MirrorPlanes planes : {across_x, across_y}) {
    auto half_ellipse = layer_under(sphere(20), mesh, ellipsoid, 0.3, planes);
    expect_the_same_measured(half_ellipse, whole_ellipse, 0.2);
    EXPECT_EQ(measure(half_ellipse, 1)->shape.turn_rad, M_PI / 2);
  }
}

TEST(FiniteHalf, IsWhereTheWholeGoesOnFrom) {
  LayerDiscretisation mesh = mesh_for(1.3, 1.0);
  const auto shape = bent_onto(meshes::tapered_pad(8, 4, 0.1), mesh);
  auto half = layer_under(sphere(20), mesh, shape, 0.45, {false, true});
  half.press({0, 0.2});
  auto whole = layer_under(sphere(20), mesh, shape, 0.45);
  whole.continue_from(half);
  whole.press({0, 0.2});
  EXPECT_EQ(whole.history().steps, 1);
  EXPECT_EQ(whole.history().cuts, 0);
  EXPECT_NEAR(whole.equilibrium().load / half.equilibrium().load, 1, kSameDiscretisation);
}

TEST(FiniteWhole, TurnsWithFingerAndObject) {
  // The layer's mesh does not turn: its error, of cells of a third of the contact; and for a and b
  // what both state for an edge between nodes.
  constexpr double angle = 0.4, meshes_error = 0.02, of_edges = 2 * 0.04 / 3;
  DeformedContact contact[2];
  double load[2];
  for (const int i : {0, 1}) {
    LayerDiscretisation mesh = mesh_for(1.4, 1.1);
    const auto shape = bent_onto(meshes::paraboloid_pad(9, 5, i * angle), mesh);
    auto pressing =
        layer_under(sampled_object(meshes::quadric_object(40, 12, i * angle)), mesh, shape, 0.45);
    pressing.press({0, 0.2});
    contact[i] = *measure(pressing, 1);
    load[i] = pressing.equilibrium().load;
  }
  EXPECT_NEAR(load[1] / load[0], 1, meshes_error);
  EXPECT_NEAR(contact[1].shape.a / contact[0].shape.a, 1, of_edges);
  EXPECT_NEAR(contact[1].shape.b / contact[0].shape.b, 1, of_edges);
  EXPECT_NEAR(contact[1].torque_arm / contact[0].torque_arm, 1, meshes_error);
  // A direction is the less certain the rounder the contact is.
  const double of_direction = of_edges / (contact[0].shape.a / contact[0].shape.b -
                                          contact[0].shape.b / contact[0].shape.a);
  EXPECT_NEAR(contact[1].shape.turn_rad - contact[0].shape.turn_rad, angle, of_direction);
}

TEST(FiniteWhole, WorkOfTheIndenterIsTheStrainEnergy) {
  for (const double nu : {0.3, 0.4999}) {
    LayerDiscretisation mesh = mesh_for(1.6, 1.0);
    const auto shape = bent_onto(meshes::tapered_pad(8, 4, 0.1), mesh);
    auto pressing = layer_under(quadric(30, 12), mesh, shape, nu);
    const auto [departure, kinks] = tests::energy_balance(pressing, 0.2);
    EXPECT_NEAR(departure, 0, kinks) << nu;
  }
}

TEST(SmoothedObject, IsASmoothSurfaceThroughTheFacets) {
  // Smoothing leaves planes unchanged. A quadric keeps its slope and curvature and moves along the
  // load.
  constexpr double spacing = 0.05, slope = 0.3, curvature = 0.2;
  const auto object = smoothed(
      [](double x, double y) { return slope * x + 0.5 * curvature * (x * x + y * y); }, spacing);
  const auto at = object->over(0.123, -0.456);
  ASSERT_TRUE(at);
  EXPECT_NEAR(at->slope.x(), slope + curvature * 0.123, 1e-12);
  EXPECT_NEAR(at->slope.y(), curvature * -0.456, 1e-12);
  EXPECT_NEAR((at->curvature - curvature * Eigen::Matrix2d::Identity()).norm(), 0, 1e-9);
  EXPECT_NEAR(at->height,
              slope * 0.123 + 0.5 * curvature * (0.123 * 0.123 + 0.456 * 0.456) +
                  spacing * spacing * curvature / 3,
              1e-12);
  // Across an edge slope and curvature are the height's own derivatives, without a jump.
  const auto edge = smoothed([](double x, double y) { return std::abs(x + 0.3 * y); }, spacing);
  constexpr double step = 1e-5;
  for (double x = -0.2; x < 0.2; x += 0.013) {
    const auto here = edge->over(x, 0.1), there = edge->over(x + step, 0.1);
    EXPECT_NEAR((there->height - here->height) / step, here->slope.x(), 50 * step);
    EXPECT_NEAR((there->slope.x() - here->slope.x()) / step, here->curvature(0, 0), 2000 * step);
  }
}

/// A sphere's lower half in facets, as a scan has them.
class FacetedSphere : public meshes::ObjectSurface {
 public:
  FacetedSphere(double radius, double facet)
      : sphere_(meshes::sphere_object(radius)), facet_(facet) {}
  std::optional<double> height(double x, double y) const override {
    const double column = std::floor(x / facet_), row = std::floor(y / facet_);
    const double u = x / facet_ - column, v = y / facet_ - row;
    const auto corner = [&](double i, double j) {
      return sphere_->height(facet_ * (column + i), facet_ * (row + j)).value();
    };
    return u > v ? corner(0, 0) + u * (corner(1, 0) - corner(0, 0)) +
                       v * (corner(1, 1) - corner(1, 0))
                 : corner(0, 0) + v * (corner(0, 1) - corner(0, 0)) +
                       u * (corner(1, 1) - corner(0, 1));
  }
  bool faceted() const override { return true; }

 private:
  std::unique_ptr<const meshes::ObjectSurface> sphere_;
  double facet_;
};

TEST(FiniteWhole, FacetedObjectIsTheSmoothOneWithinItsFacets) {
  // Facets of 0.3 h, with edges of 0.06 rad, on a sphere of R = 5 h: within facet²/(4 R), seen from
  // the first touch.
  constexpr double h = 2e-3, R = 5 * h, facet = 0.3 * h;
  Problem problem;
  problem.contact = {{R * 0.8, R * 0.6, 0}, {h, 3e5, 0.45}, {0, 0.5}};
  problem.approach_m = 0.15 * h;
  problem.level = 1;
  problem.finite_strain = MaterialChoice();
  problem.fingertip.pad = meshes::tapered_pad(4 * R, 2 * R, 0.02 / h);
  problem.fingertip.pad_name = "tapered";
  problem.fingertip.object = meshes::sphere_object(R);
  const Result smooth = solve(problem, silent);
  problem.fingertip.object = std::make_shared<FacetedSphere>(R, facet);
  const Result faceted = solve(problem, silent);
  const double of_facets = facet * facet / (4 * R) / problem.approach_m;
  // The load goes with the approach's power 3/2 to 2 or so.
  EXPECT_NEAR(faceted.finest.load_N / smooth.finest.load_N, 1,
              2.5 * of_facets + smooth.error.load + faceted.error.load);
  EXPECT_NEAR(faceted.finest.a_m / smooth.finest.a_m, 1,
              of_facets + smooth.error.a + faceted.error.a);
  const double scatter = finite_strain.outline.axes * smooth.finest.cell_m / smooth.finest.a_m;
  EXPECT_GE(smooth.error.a, scatter) << "as stated for whole contacts";
}

/// An icosahedron's facets, each divided n times a side, on a sphere that touches the origin at a
/// place between its vertices.
TriangleSurface sphere_scan(double radius, int n) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  const std::vector<Eigen::Vector3d> corner{{-1, t, 0}, {1, t, 0}, {-1, -t, 0}, {1, -t, 0},
                                            {0, -1, t}, {0, 1, t}, {0, -1, -t}, {0, 1, -t},
                                            {t, 0, -1}, {t, 0, 1}, {-t, 0, -1}, {-t, 0, 1}};
  constexpr int facets[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(0.3, 0.5, 0.81), Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  TriangleSurface surface;
  std::map<std::array<long, 3>, int> known;
  for (const auto& facet : facets) {
    const auto vertex = [&](int i, int j) {
      const Eigen::Vector3d at = (corner[static_cast<std::size_t>(facet[0])] * (n - i - j) +
                                  corner[static_cast<std::size_t>(facet[1])] * i +
                                  corner[static_cast<std::size_t>(facet[2])] * j)
                                     .normalized();
      const auto round = [](double x) { return std::lround(1e6 * x); };
      const auto [entry, is_new] = known.try_emplace({round(at.x()), round(at.y()), round(at.z())},
                                                     static_cast<int>(known.size()));
      if (is_new) surface.vertices_m.push_back(radius * (turn * at - Eigen::Vector3d::UnitZ()));
      return entry->second;
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        surface.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
        if (i + j < n - 1)
          surface.triangles.push_back({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
      }
  }
  return surface;
}

TEST(ScannedSphere, IsTheSphereWithinWhatItsFacetsLeaveOpen) {
  // On a plane, a = 1.5 h = 3 mm. Edges of 1.9 and 0.97 mm: two thirds and a third of a.
  constexpr double h = 2e-3, R = 8e-3, infinity = std::numeric_limits<double>::infinity();
  Problem problem;
  problem.contact = {{R, R, 0}, {h, 1e5, 0.45}, {1, 0.8}};
  problem.level = 1;
  problem.fingertip.object = meshes::quadric_object(infinity, infinity, 0);
  problem.fingertip.pad = meshes::sphere_pad(R);
  problem.fingertip.pad_name = "sphere";
  problem.fingertip.symmetric_object = true;
  const Result sphere = solve(problem, silent);
  EXPECT_FALSE(sphere.geometry_error);
  problem.fingertip.pad.reset();
  double before = infinity;
  for (const int n : {5, 10}) {
    problem.fingertip.scan = std::make_shared<TriangleSurface>(sphere_scan(R, n));
    problem.fingertip.pad_name = "scan " + std::to_string(n);
    const Result scan = solve(problem, silent);
    ASSERT_TRUE(scan.geometry_error);
    const RelativeError& geometry = *scan.geometry_error;
    EXPECT_NEAR(scan.finest.a_m / sphere.finest.a_m, 1, scan.error.a + sphere.error.a + geometry.a);
    EXPECT_NEAR(scan.finest.max_torque_Nm / sphere.finest.max_torque_Nm, 1,
                scan.error.max_torque + sphere.error.max_torque + geometry.max_torque);
    EXPECT_NEAR(scan.finest.max_torque_Nm / sphere.finest.max_torque_Nm, 1, 0.01);
    // The facets' uncertainty falls with the square of their edges; its four samples scatter.
    EXPECT_LT(geometry.indentation, before / 1.5);
    before = geometry.indentation;
  }
}

/// A table that ends.
class Ledge : public meshes::ObjectSurface {
 public:
  explicit Ledge(double edge) : edge_(edge) {}
  std::optional<double> height(double x, double) const override {
    return x < edge_ ? std::optional<double>(0) : std::nullopt;
  }

 private:
  double edge_;
};

TEST(FiniteWhole, ObjectThatEndsInTheContactIsRefused) {
  constexpr double h = 2e-3, R = 5 * h;
  Problem problem;
  problem.contact = {{R, R, 0}, {h, 3e5, 0.45}, {0, 0.5}};
  problem.approach_m = 0.1 * h;
  problem.level = 1;
  problem.finite_strain = MaterialChoice();
  problem.fingertip.pad = meshes::sphere_pad(R);
  problem.fingertip.pad_name = "sphere";
  // The contact's radius is 0.8 h or so.
  problem.fingertip.object = std::make_shared<Ledge>(0.4 * h);
  for (const bool finite_strain : {true, false}) {
    problem.finite_strain.reset();
    if (finite_strain) problem.finite_strain = MaterialChoice();
    try {
      solve(problem, silent);
      FAIL() << "no refusal";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("covers the contact"), std::string::npos)
          << error.what();
    }
  }
}

/// A block above the plane z = 0 as twelve triangles. Its lower face holds the origin; the finger
/// touches it from below.
TriangleSurface table(double side) {
  TriangleSurface box;
  for (const double z : {2 * side, 0.0})
    for (const double y : {-side, side})
      for (const double x : {-side, side}) box.vertices_m.emplace_back(x, y, z);
  // Corner 4 and up lie on the plane z = 0, from where the finger comes.
  for (const auto& [a, b, c, d] :
       {std::array{4, 6, 7, 5}, std::array{0, 1, 3, 2}, std::array{0, 4, 5, 1},
        std::array{1, 5, 7, 3}, std::array{3, 7, 6, 2}, std::array{2, 6, 4, 0}}) {
    box.triangles.push_back({a, b, c});
    box.triangles.push_back({a, c, d});
  }
  return box;
}

/// Problem of a scanned sphere, R = 4 h, pressed against an object at small strain.
Problem scan_against(std::shared_ptr<const meshes::ObjectSurface> object) {
  constexpr double h = 2e-3, R = 4 * h;
  Problem problem;
  problem.contact = {{R, R, 0}, {h, 1e5, 0.45}, {0.3, 0.8}};
  problem.level = 1;
  problem.fingertip.scan = std::make_shared<TriangleSurface>(sphere_scan(R, 10));
  problem.fingertip.pad_name = "scan";
  problem.fingertip.object = std::move(object);
  return problem;
}

void expect_same(const Result& one, const Result& other) {
  EXPECT_NEAR(one.finest.a_m / other.finest.a_m, 1, one.error.a + other.error.a);
  EXPECT_NEAR(one.finest.b_m / other.finest.b_m, 1, one.error.b + other.error.b);
  EXPECT_NEAR(one.finest.indentation_m / other.finest.indentation_m, 1,
              one.error.indentation + other.error.indentation);
  EXPECT_NEAR(one.finest.max_torque_Nm / other.finest.max_torque_Nm, 1,
              one.error.max_torque + other.error.max_torque);
}

TEST(ScanAgainst, ABoxThatEndsBesideTheContactIsAPlane) {
  const double infinity = std::numeric_limits<double>::infinity();
  const meshes::SurfacePlacement face{
      {1e-4, 2e-4, 0}, -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), 0};
  const Result plane = solve(scan_against(meshes::quadric_object(infinity, infinity, 0)), silent);
  expect_same(solve(scan_against(meshes::triangulated_object(table(6e-3), face)), silent), plane);
  // A contact of 1.5 mm or so; the table ends within the layer that is solved.
  EXPECT_LT(plane.finest.a_m, 3e-3);
}

TEST(ScanAgainst, AHollowIsHollow) {
  // The sphere lies in a dish, once an exact paraboloid and once a mesh.
  constexpr double R = 20e-3, wide = 12e-3;
  constexpr int rings = 40, sectors = 90;
  TriangleSurface dish;
  dish.vertices_m.emplace_back(0, 0, 0);
  for (int i = 1; i <= rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double r = wide * i / rings, angle = 2 * M_PI * j / sectors;
      dish.vertices_m.emplace_back(r * std::cos(angle), r * std::sin(angle), -r * r / (2 * R));
    }
  const auto at = [&](int i, int j) { return i == 0 ? 0 : 1 + (i - 1) * sectors + j % sectors; };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      dish.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
      if (i > 0) dish.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
    }
  const meshes::SurfacePlacement middle{Eigen::Vector3d::Zero(), -Eigen::Vector3d::UnitZ(),
                                        Eigen::Vector3d::UnitX(), 0};
  const Result exact = solve(scan_against(meshes::quadric_object(-R, -R, 0)), silent);
  const Result mesh = solve(scan_against(meshes::triangulated_object(dish, middle)), silent);
  // Facets of 0.3 mm on 20 mm: their sag, 0.6 um, is below a hundredth of the indentation.
  EXPECT_NEAR(mesh.finest.a_m / exact.finest.a_m, 1, mesh.error.a + exact.error.a);
  EXPECT_NEAR(mesh.finest.max_torque_Nm / exact.finest.max_torque_Nm, 1,
              mesh.error.max_torque + exact.error.max_torque);
  const double infinity = std::numeric_limits<double>::infinity();
  const Result plane = solve(scan_against(meshes::quadric_object(infinity, infinity, 0)), silent);
  EXPECT_GT(exact.finest.a_m, 1.1 * plane.finest.a_m);
}

TEST(ScanAgainst, ANarrowRidgeIsTheSameAlongXAndY) {
  // Cells along the ridge are longer than those across it.
  const auto ridge = [](double turn_rad) {
    Problem problem = scan_against(meshes::cylinder_object(1.2e-3, turn_rad));
    problem.contact.load.normal_force_N = 0.15;
    return solve(problem, silent);
  };
  const Result along_x = ridge(0), along_y = ridge(M_PI / 2);
  EXPECT_GT(along_x.finest.a_m, 3 * along_x.finest.b_m);
  EXPECT_NEAR(
      along_y.finest.a_m / along_x.finest.a_m, 1,
      along_x.error.a + along_y.error.a + along_x.geometry_error->a + along_y.geometry_error->a);
  EXPECT_NEAR(along_y.finest.max_torque_Nm / along_x.finest.max_torque_Nm, 1,
              along_x.error.max_torque + along_y.error.max_torque +
                  along_x.geometry_error->max_torque + along_y.geometry_error->max_torque);
}

TEST(ScannedFinger, ANormalThatItsRegionLeavesOpenIsPartOfTheGeometrysError) {
  // An egg, twice as long as wide, aimed at beside its blunt end by a normal that is 10 degrees
  // off: the touch moves to where its curvature differs.
  constexpr double h = 2e-3, R = 4 * h, infinity = std::numeric_limits<double>::infinity();
  constexpr double beside = 30 * M_PI / 180, off = 10 * M_PI / 180;
  const TriangleSurface egg = sphere_scan(R, 16);
  const Eigen::Vector3d aimed(2 * R * std::sin(beside), 0, R * std::cos(beside) - R);
  // Inclination of the ellipse x = 2 R sin, z = R cos.
  const double inclined = std::atan2(std::sin(beside), 2 * std::cos(beside));
  Problem problem = scan_against(meshes::quadric_object(infinity, infinity, 0));
  const auto solve_turned = [&](double angle, double region_excess) {
    TriangleSurface held = egg;
    const Eigen::AngleAxisd turn(-inclined + angle, Eigen::Vector3d::UnitY());
    for (Eigen::Vector3d& vertex : held.vertices_m) {
      vertex.x() *= 2;
      vertex = turn * (vertex - aimed);
    }
    problem.fingertip.scan = std::make_shared<TriangleSurface>(held);
    problem.fingertip.region_excess = region_excess;
    return solve(problem, silent);
  };
  const Result own = solve_turned(0, 0), trusted = solve_turned(off, 0),
               doubted = solve_turned(off, 1);
  EXPECT_EQ(trusted.finest.a_m, doubted.finest.a_m) << "the answer itself is the same";
  for (const auto quantity : {&RelativeError::a, &RelativeError::indentation}) {
    const bool is_a = quantity == &RelativeError::a;
    const auto value = [&](const Result& of) {
      return is_a ? of.finest.a_m : of.finest.indentation_m;
    };
    const double change = std::abs(value(own) / value(doubted) - 1);
    EXPECT_GT(change, 2 * (*trusted.geometry_error).*quantity) << "a case that shows nothing";
    EXPECT_LT(change,
              (*doubted.geometry_error).*quantity + own.error.*quantity + doubted.error.*quantity);
  }
}

/// Results at finite strain relative to those of linear elasticity on the same mesh, minus one. The
/// radii of finger and object are chosen by the approach, so that the size of the contact does not
/// depend on it.
struct Departure {
  double load, torque_arm, peak, stretch, turn_rad;
  double a;
};

Departure departure(double approach) {
  constexpr double nu = 0.45;
  LayerDiscretisation mesh = mesh_for(1.2, 0.8);
  Pressing pressing;
  pressing.fingertip.pad = meshes::tapered_pad(1.2 / approach, 0.6 / approach, 0.3 * approach);
  pressing.fingertip.object = meshes::quadric_object(3 / approach, 1 / approach, 0.5);
  pressing.approach = approach;
  pressing.poisson_ratio = nu;
  pressing.bent = shape_fingertip(pressing.fingertip, 1);
  const Pressed linear = *press_on(*make_layer(mesh, pressing), pressing);
  const ContactShape shape = *measure_shape(linear, pressing);
  // About the undeformed state this energy has the very element of linear elasticity.
  MaterialChoice choice;
  choice.volumetric = VolumetricLaw::logarithmic;
  auto finite_strain = layer_under(sampled_object(pressing.fingertip.object), mesh,
                                   pressing.bent.shape, nu, no_plane, choice);
  finite_strain.press({0, approach});
  const DeformedContact contact = *measure(finite_strain, 1 / (1 - nu * nu), choice);
  return {finite_strain.equilibrium().load / linear.load() - 1,
          contact.torque_arm / linear.torque_arm() - 1,
          contact.shape.peak / shape.peak - 1,
          (contact.shape.a / contact.shape.b) / (shape.a / shape.b) - 1,
          contact.shape.turn_rad - shape.turn_rad,
          contact.shape.a / shape.a - 1};
}

TEST(FiniteWhole, IsLinearElasticityForSmallLoads) {
  const Departure at_2 = departure(1e-3), at_1 = departure(5e-4);
  for (double Departure::*quantity : {&Departure::load, &Departure::torque_arm, &Departure::peak,
                                      &Departure::a, &Departure::stretch, &Departure::turn_rad}) {
    EXPECT_LT(std::abs(at_2.*quantity), 1e-3);
    // It departs in proportion to the load: nothing else is left.
    EXPECT_NEAR(at_1.*quantity / (at_2.*quantity), 0.5, 0.02);
  }
}

}  // namespace
}  // namespace softfinger::fem
