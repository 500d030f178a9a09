#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "fem/contact/normal_contact.h"
#include "fem/contact/pressing.h"
#include "fem/layer/fingertip_shape.h"
#include "fem/layer/layer_model.h"
#include "fem/program/reference_solver.h"
#include "meshes/generation/layer_mesh.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "meshes/generation/surfaces.h"
#include "meshes/placement/placed_surface.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

const Progress quiet = [](const std::string&) {};
constexpr double flat = std::numeric_limits<double>::infinity();

Problem small_contact() {
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.1, 0.1, 0}, {2e-3, 3e5, 0.45}, {0.1, 0.5}};
  return problem;
}

TEST(Fingertip, ThatIsFlatIsTheFlatLayer) {
  Problem problem = small_contact();
  const Result plain = solve(problem, quiet);
  problem.fingertip.pad = meshes::paraboloid_pad(flat, flat);
  problem.fingertip.object = meshes::quadric_object(0.1, 0.1);
  problem.fingertip.symmetric_object = true;
  const Result bent = solve(problem, quiet);
  // The mesh is the same, made by other code: round-off through a condition of about 1e5.
  EXPECT_NEAR(bent.finest.indentation_m / plain.finest.indentation_m, 1, 1e-9);
  EXPECT_NEAR(bent.finest.max_torque_Nm / plain.finest.max_torque_Nm, 1, 1e-9);
  EXPECT_NEAR(bent.finest.a_m / plain.finest.a_m, 1, 1e-9);
}

TEST(Fingertip, OfLargeRadiusOnAPlaneIsALayerUnderTheRelativeRadius) {
  Problem problem = small_contact();
  const Result layer = solve(problem, quiet);
  problem.fingertip.pad = meshes::sphere_pad(0.1);
  problem.fingertip.object = meshes::plane_object();
  problem.fingertip.symmetric_object = true;
  const Result sphere = solve(problem, quiet);
  // Bending a layer of thickness h to the radius R changes lengths by h/R through the thickness.
  const double bending = problem.contact.layer.thickness_m / 0.1;
  EXPECT_NEAR(sphere.finest.indentation_m / layer.finest.indentation_m, 1,
              2 * bending + sphere.error.indentation + layer.error.indentation);
  EXPECT_NEAR(sphere.finest.max_torque_Nm / layer.finest.max_torque_Nm, 1,
              2 * bending + sphere.error.max_torque + layer.error.max_torque);
  EXPECT_NEAR(sphere.finest.a_m / layer.finest.a_m, 1,
              2 * bending + sphere.error.a + layer.error.a);
}

TEST(Fingertip, UnderATurnedObjectIsTheQuarterWithinOnePercent) {
  Problem problem;
  problem.contact = {{0.031, 0.0134, 0}, {2e-3, 3e5, 0.46}, {1.4, 0.5}};
  problem.fingertip.pad = meshes::paraboloid_pad(flat, flat);
  problem.fingertip.object = meshes::quadric_object(0.031, 0.0134);
  problem.fingertip.symmetric_object = true;
  const Result quarter = solve(problem, quiet);
  constexpr double turn_rad = 1.34;
  problem.fingertip.object = meshes::quadric_object(0.031, 0.0134, turn_rad);
  problem.fingertip.symmetric_object = false;
  const Result whole = solve(problem, quiet);
  EXPECT_NEAR(whole.finest.a_m / quarter.finest.a_m, 1, whole.error.a + quarter.error.a);
  EXPECT_NEAR(whole.finest.b_m / quarter.finest.b_m, 1, whole.error.b + quarter.error.b);
  EXPECT_NEAR(whole.finest.area_m2 / quarter.finest.area_m2, 1,
              whole.error.area + quarter.error.area);
  EXPECT_NEAR(whole.finest.indentation_m / quarter.finest.indentation_m, 1,
              whole.error.indentation + quarter.error.indentation);
  // Tangent of the angle by which a semi-axis's error turns the ellipse.
  const double of_direction = whole.error.a / (1 - whole.finest.b_m / whole.finest.a_m);
  EXPECT_NEAR(whole.finest.turn_rad, turn_rad, of_direction);
  EXPECT_LT(std::max(whole.error.a, whole.error.b), 0.01);
  EXPECT_LT(whole.error.area, 0.02);
  EXPECT_LT(whole.error.indentation, 0.005);
  EXPECT_LT(whole.error.max_torque, 0.003);
}

/// Largest relative difference of what two results say of a contact.
double largest_difference(const Result& one, const Result& other) {
  double largest = 0;
  const auto compare = [&](double left, double right) {
    largest = std::max(largest, std::abs(left / right - 1));
  };
  for (const auto quantity :
       {&LevelResult::a_m, &LevelResult::b_m, &LevelResult::indentation_m, &LevelResult::load_N,
        &LevelResult::peak_pressure_Pa, &LevelResult::centre_pressure_Pa,
        &LevelResult::max_torque_Nm, &LevelResult::max_force_N, &LevelResult::area_m2,
        &LevelResult::area_projected_m2})
    compare(one.finest.*quantity, other.finest.*quantity);
  for (const auto error :
       {&RelativeError::a, &RelativeError::b, &RelativeError::area, &RelativeError::indentation,
        &RelativeError::peak_pressure, &RelativeError::max_torque})
    largest = std::max(largest, std::abs(one.error.*error - other.error.*error));
  const Eigen::Matrix2Xd &outline = one.finest.outlines_m.at(0),
                         &of_other = other.finest.outlines_m.at(0);
  for (Eigen::Index i = 0; i < outline.cols(); ++i)
    largest = std::max(largest, (of_other.colwise() - outline.col(i)).colwise().norm().minCoeff() /
                                    other.finest.b_m);
  return largest;
}

/// Round-off through a condition of about 1e5; at finite strain Newton's method ends at 1e-9, and
/// the springs that hold its surface cost two digits.
constexpr double same_discretisation = 1e-7;

/// Solves a finger with one mirror plane by half of it and as a whole, as if the object had no
/// mirror plane.
std::pair<Result, Result> by_half_and_whole(Problem problem) {
  problem.fingertip.symmetric_object = true;
  Result half = solve(problem, quiet);
  problem.fingertip.symmetric_object = false;
  return {std::move(half), solve(problem, quiet)};
}

TEST(Fingertip, WithOneMirrorPlaneIsTheWholeByHalfOfIt) {
  Problem problem;
  problem.level = 1;
  problem.contact = {{10.4e-3, 6.3e-3, 0}, {1.5e-3, 3e5, 0.45}, {1.5, 0.7}};
  problem.fingertip.pad = meshes::tapered_pad(16e-3, 8e-3, 20);
  problem.fingertip.pad_name = "tapered";
  problem.fingertip.object = meshes::sphere_object(30e-3);
  // A strength that mu p passes in the middle: torque and force are sums over the nodes' areas.
  problem.shear_law = ShearLaw::Kind::limited;
  problem.shear_strength_Pa = 5e4;
  for (const bool is_finite : {false, true}) {
    if (is_finite) problem.finite_strain = MaterialChoice();
    const auto [half, whole] = by_half_and_whole(problem);
    EXPECT_EQ(half.planes, (MirrorPlanes{false, true}));
    EXPECT_EQ(whole.planes, no_plane);
    EXPECT_LT(half.finest.unknowns, 0.55 * static_cast<double>(whole.finest.unknowns));
    EXPECT_EQ(half.finest.turn_rad, 0);
    EXPECT_NEAR(whole.finest.turn_rad, 0, same_discretisation);
    EXPECT_LT(largest_difference(half, whole), same_discretisation) << is_finite;
  }
}

TEST(Fingertip, WithOneMirrorPlaneRubsAsTheWhole) {
  Problem problem;
  problem.level = 1;
  problem.contact = {{16e-3, 8e-3, 0}, {2e-3, 3e5, 0.45}, {1, 0.7}};
  problem.fingertip.pad = meshes::tapered_pad(16e-3, 8e-3, 20);
  problem.fingertip.pad_name = "tapered";
  problem.fingertip.object = meshes::plane_object();
  problem.friction.torsion = true;
  problem.friction.increments = 3;
  problem.friction.limit_surface = 4;
  const auto [half, whole] = by_half_and_whole(problem);
  EXPECT_EQ(half.planes, (MirrorPlanes{false, true}));
  EXPECT_LT(largest_difference(half, whole), same_discretisation);
  EXPECT_NEAR(half.torsion->stiffness_Nm_per_rad / whole.torsion->stiffness_Nm_per_rad, 1,
              same_discretisation);
  const double force = whole.finest.max_force_N, torque = whole.finest.max_torque_Nm;
  const auto expect_same = [&](const Wrench& one, const Wrench& other) {
    // Friction and pressure are found in turn until neither changes by more.
    constexpr double enough = 1e-6;
    EXPECT_NEAR(one.force_x_N, other.force_x_N, enough * force);
    EXPECT_NEAR(one.force_y_N, other.force_y_N, enough * force);
    EXPECT_NEAR(one.torque_Nm, other.torque_Nm, enough * torque);
  };
  for (std::size_t i = 0; i < whole.torsion->increments.size(); ++i)
    expect_same(half.torsion->increments[i].wrench, whole.torsion->increments[i].wrench);
  for (std::size_t i = 0; i < whole.limit_surface.size(); ++i)
    expect_same(half.limit_surface[i].wrench, whole.limit_surface[i].wrench);
}

TEST(Fingertip, RefusesALayerThickerThanItsCurvatureBears) {
  Fingertip fingertip;
  fingertip.pad = meshes::sphere_pad(0.005);
  fingertip.object = meshes::plane_object();
  EXPECT_THROW(shape_fingertip(fingertip, 0.006), InputError);
}

/// A flat pad that is cut off obliquely beside the origin: mm.
struct CutPad {
  double thickness = 2, half_width = 8, end = 10, cut = -1.2, slope = 0.36;

  /// @param across,along  0 to 1
  /// @param depth         below the surface
  Eigen::Vector3d at(double across, double along, double depth) const {
    const double x = (2 * across - 1) * half_width, from = cut + slope * x;
    return 1e-3 * Eigen::Vector3d(x, from + along * (end - from), -depth);
  }
};

/// The surface alone, which ends at the cut.
TriangleSurface facets_of(const CutPad& pad) {
  TriangleSurface surface;
  for (const double along : {0.0, 1.0})
    for (const double across : {0.0, 1.0}) surface.vertices_m.push_back(pad.at(across, along, 0));
  surface.triangles = {{0, 1, 3}, {0, 3, 2}};
  return surface;
}

/// The layer under it.
meshes::LayerMesh hexahedra_of(const CutPad& pad) {
  constexpr int across = 14, along = 10, deep = 2;
  meshes::LayerMesh mesh;
  for (int k = 0; k <= deep; ++k)
    for (int j = 0; j <= along; ++j)
      for (int i = 0; i <= across; ++i)
        mesh.hexahedra.vertices.push_back(
            pad.at(double(i) / across, double(j) / along, pad.thickness * (deep - k) / deep));
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < across; ++i) {
      const auto face = [&](int k) -> std::array<int, 4> {
        const int row = across + 1, low = i + row * (j + (along + 1) * k);
        return {low, low + 1, low + 1 + row, low + row};
      };
      for (int k = 0; k < deep; ++k) {
        const auto bottom = face(k), top = face(k + 1);
        mesh.hexahedra.cells.push_back(
            {bottom[0], bottom[1], bottom[2], bottom[3], top[0], top[1], top[2], top[3]});
        mesh.hexahedra.region.push_back(0);
      }
      mesh.core.push_back(face(0));
      mesh.contact.push_back(face(deep));
    }
  return mesh;
}

// Solves the same contact on a mesh of hexahedra that ends at the cut by itself, without a cloth,
// without a search for edges.
TEST(ScannedFinger, IsPressedUpToItsSharpEdge) {
  const CutPad pad;
  constexpr double sphere_m = 15e-3, youngs_modulus_Pa = 1e5, load_N = 1;
  Problem problem;
  problem.level = 1;
  const double h = 1e-3 * pad.thickness;
  problem.contact = {{0.1, 0.1, 0}, {h, youngs_modulus_Pa, 0.45}, {load_N, 0.5}};
  problem.fingertip.scan = std::make_shared<const TriangleSurface>(facets_of(pad));
  problem.fingertip.object = meshes::sphere_object(sphere_m);
  const Result scan = solve(problem, quiet);

  LayerDiscretisation discretisation;
  discretisation.a = discretisation.b = scan.finest.a_m / h;
  discretisation.patch = 1.5;
  discretisation.elements_per_semi_axis = 8;
  const LayerModel model(discretisation, {{1, 0.45}}, hexahedra_of(pad), h);
  const auto& nodes = model.nodes();
  const auto count = static_cast<Eigen::Index>(nodes.size());
  Eigen::Matrix2Xd place(2, count);
  for (Eigen::Index i = 0; i < count; ++i)
    place.col(i) = nodes[static_cast<std::size_t>(i)].position.head<2>();
  const double radius = sphere_m / h;
  const Eigen::VectorXd gap =
      radius - (radius * radius - place.colwise().squaredNorm().array()).sqrt();
  const NormalContact contact =
      solve_normal_contact(model.compliance(), gap, load_N / (youngs_modulus_Pa * h * h));
  const Eigen::VectorXd share = contact.force / contact.force.sum();
  const Eigen::Vector2d centre = place * share;
  const double arm = share.dot((place.colwise() - centre).colwise().norm().transpose());
  EXPECT_NEAR(scan.finest.indentation_m / (h * contact.approach), 1, 2 * scan.error.indentation);
  EXPECT_NEAR(scan.finest.torque_arm_m / (h * arm), 1, 2 * scan.error.max_torque);
  // It is cut off there: the outline's straight part lies on the edge.
  const Eigen::Matrix2Xd& outline = scan.finest.outlines_m.front();
  const Eigen::ArrayXd beyond =
      1e-3 * pad.cut + pad.slope * outline.row(0).array() - outline.row(1).array();
  EXPECT_NEAR(beyond.maxCoeff(), 0, 0.01 * h);
  EXPECT_GT((beyond > -0.01 * h).count(), outline.cols() / 10);
}

Problem sphere_at_edge() {
  const CutPad pad;
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.1, 0.1, 0}, {1e-3 * pad.thickness, 1e5, 0.45}, {1, 0.5}};
  problem.fingertip.scan = std::make_shared<const TriangleSurface>(facets_of(pad));
  problem.fingertip.object = meshes::sphere_object(15e-3);
  return problem;
}

// At the edge the pressure's centre lies beside the first touch. Motions turn about it: every part
// of the contact then slips across its arm.
TEST(ScannedFinger, IsTwistedAboutThePressuresCentre) {
  Problem problem = sphere_at_edge();
  const Result pressed = solve(problem, quiet);
  problem.friction.torsion = true;
  problem.friction.increments = 3;
  bool is_moved = false;
  const Result twisted = solve(problem, [&](const std::string& line) {
    is_moved = is_moved || line.find("once more in coordinates that begin there") != line.npos;
  });
  EXPECT_TRUE(is_moved);
  const double beside_m = std::hypot(twisted.friction_centre_m[0], twisted.friction_centre_m[1]);
  EXPECT_GT(beside_m, 0.1 * pressed.finest.b_m);
  EXPECT_NEAR(twisted.torsion->full_slip_Nm / pressed.finest.max_torque_Nm, 1,
              twisted.torsion->full_slip_error + pressed.error.max_torque);
  // Outlines are given relative to the first touch, as without friction.
  const Eigen::Matrix2Xd &one = pressed.finest.outlines_m.front(),
                         &other = twisted.finest.outlines_m.front();
  EXPECT_NEAR(other.row(0).maxCoeff(), one.row(0).maxCoeff(), 0.1 * beside_m);
  EXPECT_NEAR(other.row(1).maxCoeff(), one.row(1).maxCoeff(), 0.1 * beside_m);
}

// The largest torque is about that centre whether friction is followed or not, and where a law
// other than Coulomb's bounds it.
TEST(ScannedFinger, HasOneLargestTorqueWithFrictionAndWithout) {
  Problem problem = sphere_at_edge();
  problem.finite_strain = MaterialChoice();
  problem.shear_law = ShearLaw::Kind::limited;
  problem.shear_strength_Pa = 2e4;
  const Result pressed = solve(problem, quiet);
  problem.friction.limit_surface = 2;
  const Result rubbed = solve(problem, quiet);
  EXPECT_GT(std::hypot(rubbed.friction_centre_m[0], rubbed.friction_centre_m[1]),
            0.1 * pressed.finest.b_m);
  EXPECT_NEAR(rubbed.finest.max_torque_Nm / pressed.finest.max_torque_Nm, 1,
              rubbed.error.max_torque + pressed.error.max_torque);
}

// A plane touches a straight finger along a line, and presses it up to both of its ends, wherever
// it is aimed at.
TEST(ScannedFinger, WithStraightSidesIsPressedAlongItsLength) {
  constexpr double radius_m = 8e-3, length_m = 12e-3, edge_m = 1e-3, aside_m = 2e-3;
  const TriangleSurface finger = meshes::cylinder(radius_m, length_m, edge_m);
  const auto press = [&](double along_m) {
    Problem problem;
    problem.level = 1;
    // The first guess: of these radii alone no contact could be meshed.
    problem.contact = {{2, radius_m, 0}, {2e-3, 3e5, 0.45}, {5, 0.5}};
    problem.fingertip.scan = std::make_shared<const TriangleSurface>(
        meshes::PlacedSurface(
            finger, {{radius_m, 0, along_m}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), 0},
            meshes::PlacedSurface::Body::below)
            .in_contact_frame());
    problem.fingertip.object = meshes::plane_object();
    return solve(problem, quiet);
  };
  const Result middle = press(0), beside = press(aside_m);
  EXPECT_NEAR(beside.first_touch_m[0], 0, 1e-6 * length_m);
  const auto expect_same = [&](double LevelResult::*quantity, double RelativeError::*error) {
    EXPECT_NEAR(beside.finest.*quantity / (middle.finest.*quantity), 1,
                beside.error.*error + middle.error.*error);
  };
  expect_same(&LevelResult::indentation_m, &RelativeError::indentation);
  expect_same(&LevelResult::area_projected_m2, &RelativeError::area);
  expect_same(&LevelResult::torque_arm_m, &RelativeError::max_torque);
  const Eigen::Matrix2Xd& outline = beside.finest.outlines_m.front();
  EXPECT_NEAR(outline.row(0).maxCoeff() - outline.row(0).minCoeff(), length_m, 0.01 * length_m);
}

/// A spheroid's mesh with its tip at the origin, upwards.
TriangleSurface spheroid(double across_m, double along_m) {
  constexpr double radius_m = 10e-3, edge = 0.05;
  TriangleSurface surface = meshes::sphere(radius_m, edge * radius_m);
  for (Eigen::Vector3d& vertex : surface.vertices_m) {
    const Eigen::Vector3d unit = vertex / radius_m;
    vertex = {across_m * unit.x(), across_m * unit.y(), along_m * (unit.z() - 1)};
  }
  return surface;
}

Problem tip_on_plane(double across_m) {
  Problem problem;
  problem.contact = {{0.1, 0.1, 0}, {3e-3, 1e5, 0.3}, {0.5, 0.5}};
  problem.fingertip.scan = std::make_shared<const TriangleSurface>(spheroid(across_m, 14e-3));
  problem.fingertip.object = meshes::plane_object();
  return problem;
}

Outcome<Pressed, FoldedLayer> press_tip(const Problem& problem, CoreWays ways) {
  const Pressing pressing = pressing_of(problem, ways);
  LayerDiscretisation mesh = first_guess(pressing);
  mesh.a = mesh.b = 0.75;
  choose_elements(mesh, 1);
  auto layer = make_layer(mesh, pressing);
  if (!layer) return layer.reason();
  return press_on(*std::move(layer), pressing);
}

// Tips whose radius b²/c goes from above the thickness of 3 mm to 0.72 of it. The reference: the
// same linear problem by biquadratic elements on the meridian of the exact spheroid, up to 120
// degrees from its tip, with columns that end on the exact eroded core, at the tip of its cone
// where normals cross (100 x 16 elements; 60 x 12 differ by less than 1e-4).
TEST(ScannedFinger, TipMayBendMoreSharplyThanItsLayerIsThick) {
  struct Reference {
    double across_m, approach, arm_m;
  };
  // Errors of the facets, and of four cells along the radius.
  constexpr double of_facets = 0.01, of_cells = 0.01;
  for (const Reference& tip :
       {Reference{7e-3, 0.3992, 1.3395e-3}, Reference{6.5e-3, 0.4421, 1.2861e-3},
        Reference{6e-3, 0.4958, 1.2306e-3}, Reference{5.5e-3, 0.5642, 1.1730e-3}}) {
    const Problem problem = tip_on_plane(tip.across_m);
    for (const CoreWays ways :
         {CoreWays::smoothed, CoreWays::eroded_nearer, CoreWays::eroded_smoother}) {
      const Pressed pressed = *press_tip(problem, ways);
      const double arm_m = pressed.torque_arm() * problem.contact.layer.thickness_m;
      EXPECT_NEAR(pressed.contact.approach / tip.approach, 1, of_facets + of_cells);
      EXPECT_NEAR(arm_m / tip.arm_m, 1, of_facets + of_cells);
    }
  }
}

TEST(ScannedFinger, HasNoCoreThatLiesDeeperThanItIsThick) {
  // In a finger thinner than twice the thickness, the core's search directions find no place at
  // that depth.
  EXPECT_FALSE(press_tip(tip_on_plane(5.5e-3), CoreWays::eroded));
  // Half as thick as the layer at its tip, the finger bears none.
  EXPECT_THROW(solve(tip_on_plane(4e-3), quiet), InputError);
}

/// A finger of the survey that becomes thinner towards its tip, pressed beside it.
/// @param place  on the unit sphere that it is made of
Problem tapered_finger(double taper, const Eigen::Vector3d& place, double load_N) {
  const auto map = [&](const Eigen::Vector3d& unit) -> Eigen::Vector3d {
    const double width = 1 - taper * unit.z();
    return {8e-3 * width * unit.x(), 7e-3 * width * unit.y(), 14e-3 * unit.z()};
  };
  constexpr double radius_m = 10e-3, edge = 0.08, step = 1e-4;
  TriangleSurface surface = meshes::sphere(radius_m, edge * radius_m);
  for (Eigen::Vector3d& vertex : surface.vertices_m) vertex = map(vertex / radius_m);
  const Eigen::Vector3d at = place.normalized(), one = at.unitOrthogonal(), two = at.cross(one);
  const auto along = [&](const Eigen::Vector3d& tangent) -> Eigen::Vector3d {
    return map((at + step * tangent).normalized()) - map((at - step * tangent).normalized());
  };
  const Eigen::Vector3d normal = along(one).cross(along(two)).normalized();
  Problem problem;
  problem.contact = {{0.1, 0.1, 0}, {3e-3, 1e5, 0.3}, {load_N, 0.8}};
  problem.fingertip.scan = std::make_shared<const TriangleSurface>(
      meshes::PlacedSurface(surface, {map(at), normal, normal.unitOrthogonal(), 0},
                            meshes::PlacedSurface::Body::below)
          .in_contact_frame());
  return problem;
}

// Under 5.3 N the contact reaches where the tip's curvature exceeds one over the layer's thickness,
// and its layer folds unless the core has a ridge there. Under less it does not.
TEST(ScannedFinger, IsPressedOverItsCoresRidge) {
  const auto press = [](double load_N, bool& needs_ridge) {
    Problem problem = tapered_finger(0.15, {0.055, -0.786, 0.607}, load_N);
    problem.fingertip.object = meshes::plane_object();
    return solve(problem, [&](const std::string& line) {
      needs_ridge = needs_ridge || line.find("core that has a ridge") != std::string::npos;
    });
  };
  bool low_needs = false, middle_needs = false, high_needs = false;
  const Result low = press(3, low_needs), middle = press(4, middle_needs);
  EXPECT_FALSE(low_needs || middle_needs);
  // Close to the largest load that fits, the last digits of a processor decide which loads need the
  // ridge, and which are refused.
  for (const double load_N : {4.4, 4.6, 4.8, 5.0, 5.15, 5.3}) {
    SCOPED_TRACE(load_N);
    Result high;
    try {
      high = press(load_N, high_needs);
    } catch (const InputError&) {
      continue;
    }
    // Powers of the load go on.
    const double further = std::log(load_N / 4) / std::log(4.0 / 3);
    const auto expect_power = [&](double LevelResult::*quantity, double RelativeError::*error) {
      const double before = low.finest.*quantity, now = middle.finest.*quantity;
      EXPECT_NEAR(high.finest.*quantity / (now * std::pow(now / before, further)), 1,
                  high.error.*error + 2 * middle.error.*error);
    };
    expect_power(&LevelResult::indentation_m, &RelativeError::indentation);
    expect_power(&LevelResult::a_m, &RelativeError::a);
    expect_power(&LevelResult::b_m, &RelativeError::b);
    expect_power(&LevelResult::torque_arm_m, &RelativeError::max_torque);
    if (high_needs) break;
  }
  EXPECT_TRUE(high_needs);
}

// The tip is pressed flat, until it is touched where it turns away.
TEST(ScannedFinger, IsNotPressedOverItsTip) {
  Problem problem = tapered_finger(0.3, {0.246, -0.74, 0.629}, 5);
  problem.fingertip.object = meshes::sphere_object(15e-3);
  EXPECT_THROW(solve(problem, quiet), InputError);
}

void expect_series(Problem problem, const std::string& name) {
  problem.friction.torsion = true;
  problem.friction.increments = 3;
  const auto folder = std::filesystem::temp_directory_path() / name;
  std::filesystem::remove_all(folder);
  problem.output_directory = folder;
  const Result result = solve(problem, quiet);
  const auto content_of = [](const std::filesystem::path& path) {
    std::ifstream file(path);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string collection = content_of(result.pvd_file);
  EXPECT_NE(collection.find("<VTKFile type=\"Collection\""), std::string::npos);
  std::size_t at = 0;
  int files = 0;
  for (const std::string key = "file=\""; (at = collection.find(key, at)) != std::string::npos;) {
    at += key.size();
    const std::string content =
        content_of(folder / collection.substr(at, collection.find('"', at) - at));
    for (const char* field : {"contact_pressure_Pa", "contact_shear_Pa", "slip_m", "state"})
      EXPECT_NE(content.find(field), std::string::npos) << field;
    EXPECT_NE(content.find("</VTKFile>"), std::string::npos);
    ++files;
  }
  EXPECT_EQ(files, problem.friction.increments);
  std::filesystem::remove_all(folder);
}

TEST(SurfaceSeries, HasAFilePerIncrementAndOneThatNamesThem) {
  expect_series(small_contact(), "softfinger_surface_series_test");
}

TEST(SurfaceSeries, IsWrittenAtFiniteStrainToo) {
  Problem problem = small_contact();
  problem.finite_strain = MaterialChoice();
  expect_series(problem, "softfinger_surface_series_finite_test");
}

}  // namespace
}  // namespace softfinger::fem
