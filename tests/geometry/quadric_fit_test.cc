#include "softfinger/geometry/quadric_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "sample_surfaces.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using Eigen::Vector3d;

// The facets of a smooth surface are chords: the radii they show differ by about (edge/R)².
double chord_bias(double edge, double radius) { return edge * edge / (radius * radius); }

TEST(PrincipalCurvature, KeepsTheDigitsOfANearlyFlatDirection) {
  const auto p = principal_curvature(quadric_from_radii(1e-2, 1e6));
  EXPECT_DOUBLE_EQ(p.radii_m[0], 1e6);
  EXPECT_DOUBLE_EQ(p.radii_m[1], 1e-2);
  EXPECT_DOUBLE_EQ(p.axis_rad, kPi / 2);
}

TEST(PrincipalCurvature, NamesFlatConcaveAndSaddleDirectionsBySign) {
  EXPECT_EQ(principal_curvature(quadric_from_radii(kInfinity, kInfinity)).radii_m[0], kInfinity);
  EXPECT_EQ(principal_curvature(quadric_from_radii(0.02, kInfinity)).radii_m[0], kInfinity);
  const auto saddle = principal_curvature(quadric_from_radii(0.02, -0.05));
  EXPECT_DOUBLE_EQ(saddle.radii_m[0], -0.05);  // the smallest curvature is the negative one
  EXPECT_DOUBLE_EQ(saddle.radii_m[1], 0.02);
  const auto bowl = principal_curvature(quadric_from_radii(-0.02, -0.05));
  EXPECT_DOUBLE_EQ(bowl.radii_m[0], -0.02);
  EXPECT_DOUBLE_EQ(bowl.axis_rad, 0);
}

TEST(PrincipalCurvature, HasTheAxisOfTheSmallestCurvatureForEveryRotation) {
  for (double axis = -1.5; axis < 1.6; axis += 0.1) {
    const double c = std::cos(axis), s = std::sin(axis), k1 = 10, k2 = 40;
    const Quadric q{(k1 * c * c + k2 * s * s) / 2, (k1 * s * s + k2 * c * c) / 2,
                    (k1 - k2) * c * s};
    const auto p = principal_curvature(q);
    const double rounding = 10 * std::numeric_limits<double>::epsilon();
    EXPECT_NEAR(p.axis_rad, axis, rounding);
    EXPECT_NEAR(p.radii_m[0], 0.1, rounding);
    EXPECT_NEAR(p.radii_m[1], 0.025, rounding);
  }
  EXPECT_EQ(principal_curvature(quadric_from_radii(0.01, 0.01)).axis_rad, 0);
}

TEST(QuadricFit, RecoversARotatedQuadricUpToItsChordsFromANormalTenDegreesOff) {
  const double edge = 1e-3;
  const auto surface = samples::quadric(15e-3, 30, 40e-3, 15e-3, 0.4);
  for (double off_degrees : {0.0, 10.0}) {
    const double t = off_degrees * kPi / 180;
    const Vector3d normal(std::sin(t), 0, std::cos(t));
    const auto fit = fit_quadric(surface, Vector3d::Zero(), &normal, 6e-3);
    // Relative to the larger curvature, whose chords stand out most.
    EXPECT_NEAR(15e-3 / fit.principal.radii_m[0], 15.0 / 40, chord_bias(edge, 15e-3));
    EXPECT_NEAR(15e-3 / fit.principal.radii_m[1], 1, chord_bias(edge, 15e-3));
    EXPECT_NEAR(fit.principal.axis_rad, 0.4, chord_bias(edge, 15e-3));
    EXPECT_NEAR(fit.normal.z(), 1, chord_bias(edge, 15e-3));
    EXPECT_LT(fit.origin_m.norm(), edge * edge / 15e-3);  // a chord's sagitta
    EXPECT_LT(fit.residual_rms_m, edge * edge / 15e-3);
  }
}

TEST(QuadricFit, DoesNotDependOnTheGivenNormal) {
  const auto surface = samples::quadric(15e-3, 30, 40e-3, 15e-3, 0.4);
  const Vector3d tilted(0.5, -0.3, 1);
  const auto given = fit_quadric(surface, {1e-3, 2e-3, 0}, &tilted, 6e-3);
  const auto found = fit_quadric(surface, {1e-3, 2e-3, 0}, nullptr, 6e-3);
  EXPECT_DOUBLE_EQ(given.quadric.A_per_m, found.quadric.A_per_m);
}

TEST(QuadricFit, IsExactForAQuadricHoweverCoarseItsMesh) {
  // QR of columns of unit length, none nearly dependent: a few hundred roundings.
  const double round_off = 1e3 * std::numeric_limits<double>::epsilon();
  for (int n : {4, 7, 20, 80}) {
    const auto fit =
        fit_quadric(samples::quadric(10e-3, n, 20e-3, 10e-3), Vector3d::Zero(), nullptr, 8e-3);
    EXPECT_NEAR(fit.principal.radii_m[0] / 20e-3, 1, round_off) << n;
    EXPECT_NEAR(fit.principal.radii_m[1] / 10e-3, 1, round_off) << n;
    // The quality measure is of the facets as they are: chords, up to a sagitta away.
    const double edge = std::sqrt(2) * 20e-3 / n;
    EXPECT_LT(fit.residual_rms_m, edge * edge / (8 * 10e-3) * 2) << n;
  }
}

TEST(QuadricFit, TakesLargeFlatFacetsForTheSurfaceItself) {
  // As design programs tessellate: a flat of one facet's width between rounded shoulders. Between
  // chords of a quadric the flat would have to bulge; as it lies it has a known least-squares fit.
  const double flat = 2e-3, radius = 5e-3, r = 3.5e-3;
  const auto height = [=](double x) {
    const double beyond = std::max(0.0, std::abs(x) - flat);
    return -beyond * beyond / (2 * radius);
  };
  const auto strip = [&](const std::vector<double>& xs) {
    TriangleSurface s;
    const int rows = 4;
    for (double x : xs)
      for (int j = 0; j <= rows; ++j)
        s.vertices_m.emplace_back(x, (2.0 * j / rows - 1) * 5e-3, height(x));
    for (int i = 0; i + 1 < static_cast<int>(xs.size()); ++i) {
      for (int j = 0; j < rows; ++j) {
        const int a = i * (rows + 1) + j, b = a + rows + 1;
        s.triangles.push_back({a, b, b + 1});
        s.triangles.push_back({a, b + 1, a + 1});
      }
    }
    return s;
  };
  std::vector<double> adapted, uniform;
  for (double x = flat; x < 5.1e-3; x += 0.25e-3) adapted.insert(adapted.end(), {-x, x});
  std::sort(adapted.begin(), adapted.end());
  for (int i = -41; i <= 41; ++i) uniform.push_back(i * 0.125e-3);
  const auto coarse = fit_quadric(strip(adapted), Vector3d::Zero(), nullptr, r);
  const auto fine = fit_quadric(strip(uniform), Vector3d::Zero(), nullptr, r);
  // The rounded part's own chords are worth (edge/R)²; the clipping at the rim 1 %.
  EXPECT_NEAR(coarse.quadric.A_per_m / fine.quadric.A_per_m, 1, 0.02);
}

TEST(QuadricFit, LeavesOutASpike) {
  auto surface = samples::quadric(10e-3, 14, 30e-3, 12e-3, 0.3);
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 2e-6);
  for (auto& v : surface.vertices_m) v.z() += noise(random);
  const auto clean = fit_quadric(surface, Vector3d::Zero(), nullptr, 6e-3);
  EXPECT_EQ(clean.outliers, 0);
  surface.vertices_m[15 * 9 + 9].z() += 0.2e-3;  // a hundred times the noise
  const auto fit = fit_quadric(surface, Vector3d::Zero(), nullptr, 6e-3);
  EXPECT_EQ(fit.outliers, 1);
  for (int i : {0, 1}) {
    EXPECT_NEAR(fit.principal.radii_m[i], clean.principal.radii_m[i], 2 * clean.radii_std_m[i]);
    EXPECT_LT(fit.radii_std_m[i], 2 * clean.radii_std_m[i]);
  }
}

TEST(QuadricFit, RecognisesSharpEdgesButNotCoarseOrNoisyMeshes) {
  const double slope = std::tan(25 * kPi / 180);  // of a ridge: a kink of 50 degrees
  const auto ridge =
      samples::graph(5e-3, 20, [=](double x, double) { return -slope * std::abs(x); });
  const auto on_ridge = fit_quadric(ridge, Vector3d::Zero(), nullptr, 3e-3);
  EXPECT_EQ(on_ridge.surface_kind, SurfaceKind::sharp_edge);
  EXPECT_NEAR(on_ridge.sharpest_kink_rad, 50 * kPi / 180, 1e-9);
  // An edge of 90 degrees, at which the region ends.
  TriangleSurface step = samples::graph(5e-3, 20, [](double, double) { return 0.0; });
  const int first = static_cast<int>(step.vertices_m.size());
  for (int j = 0; j <= 20; ++j) step.vertices_m.emplace_back(5e-3, (j - 10) * 0.5e-3, -5e-3);
  for (int j = 0; j < 20; ++j) {
    const int above = 20 * 21 + j, below = first + j;
    step.triangles.push_back({above, below, below + 1});
    step.triangles.push_back({above, below + 1, above + 1});
  }
  const auto near_edge = fit_quadric(step, {3.5e-3, 0, 0}, nullptr, 3e-3);
  EXPECT_EQ(near_edge.surface_kind, SurfaceKind::sharp_edge);
  EXPECT_NEAR(near_edge.sharpest_kink_rad, kPi / 2, 1e-9);
  EXPECT_EQ(fit_quadric(step, {-1e-3, 0, 0}, nullptr, 3e-3).surface_kind, SurfaceKind::smooth);

  const auto coarse = fit_quadric(samples::sphere(10e-3, 2), {0, 0, 10e-3}, nullptr, 8e-3);
  EXPECT_EQ(coarse.surface_kind, SurfaceKind::smooth);
}

TEST(QuadricFit, TellsHowTheRadiiChangeWithTheRegion) {
  const auto exact = samples::quadric(10e-3, 20, 20e-3, 10e-3);
  const auto fit = fit_quadric(exact, Vector3d::Zero(), nullptr, 5e-3);
  for (double change : radii_region_change_m(exact, Vector3d::Zero(), nullptr, fit))
    EXPECT_LT(change, 1e-9 * 20e-3);
  // A cap's depth is x²/(2R) + x⁴/(8R³) + ..., and x⁴ fitted by x² over a disc of radius r is r²
  // x²: the curvature is 1/R (1 + r²/(4R²) + ...), of which 1.25² - 1 = 0.56 is the change, and
  // more by the next order, a share of r²/R².
  const auto ball = samples::sphere(10e-3, 5);
  const Vector3d top(0, 0, 10e-3);
  const auto cap = fit_quadric(ball, top, nullptr, 4e-3);
  const auto change = radii_region_change_m(ball, top, nullptr, cap);
  const double second = 4e-3 * 4e-3 / (4 * 10e-3 * 10e-3);
  EXPECT_GT(change[0], 0.5 * second * 10e-3);
  EXPECT_LT(change[0], 0.8 * second * 10e-3);
  EXPECT_FALSE(is_whole_surface(ball, top, nullptr, 4e-3));

  // Beyond 12.2 mm the ball leans by more than 75 degrees: larger regions are all the same, and
  // there is nothing to compare.
  const auto whole = fit_quadric(ball, top, nullptr, 16e-3);
  EXPECT_TRUE(is_whole_surface(ball, top, nullptr, 16e-3));
  for (const double unknown : radii_region_change_m(ball, top, nullptr, whole))
    EXPECT_TRUE(std::isinf(unknown)) << unknown;
}

TEST(QuadricFit, IsExactWhereFacetsAre) {
  // A plane has no chords: what is left is round-off, tilt and offset included.
  const auto plane =
      samples::graph(10e-3, 20, [](double x, double y) { return 0.2 * x - 0.1 * y; });
  const Vector3d above(1e-3, 0, 1e-3);
  const auto fit = fit_quadric(plane, above, nullptr, 5e-3);
  const double round_off = 1e3 * std::numeric_limits<double>::epsilon();
  EXPECT_LT(std::abs(fit.quadric.A_per_m) * 5e-3, round_off);
  EXPECT_EQ(fit.principal.radii_m[0], kInfinity);
  EXPECT_EQ(fit.principal.radii_m[1], kInfinity);
  EXPECT_LT((fit.normal - Vector3d(-0.2, 0.1, 1).normalized()).norm(), round_off);
  EXPECT_NEAR(fit.area_m2, kPi * 25e-6, 2e-3 * kPi * 25e-6);  // the ball's rim is cut straight
  const Vector3d to_foot = fit.origin_m - above;
  EXPECT_LT(to_foot.cross(fit.normal).norm(), round_off * 5e-3);
}

TEST(QuadricFit, FindsSphereCylinderSaddleAndBowl) {
  const double edge = 0.5e-3, r = 3e-3;
  // The second term is the quadric's own error on a sphere: its next order is r²/R² of the first.
  const double ball_tolerance = chord_bias(edge, 10e-3) + r * r / 100e-6;
  const auto ball = fit_quadric(samples::sphere(10e-3, 5), {10e-3, 0, 0}, nullptr, r);
  EXPECT_NEAR(ball.principal.radii_m[0] / 10e-3, 1, ball_tolerance);
  EXPECT_NEAR(ball.principal.radii_m[1] / 10e-3, 1, ball_tolerance);
  EXPECT_NEAR(ball.x_axis.y(), 1, 1e-3);  // normal along x: the global y axis takes over

  const auto cylinder =
      fit_quadric(samples::quadric(5e-3, 20, 10e-3, kInfinity), Vector3d::Zero(), nullptr, r);
  EXPECT_GT(cylinder.principal.radii_m[0], 1e3 * 10e-3);
  EXPECT_NEAR(cylinder.principal.radii_m[1] / 10e-3, 1, chord_bias(edge, 10e-3));

  const auto saddle =
      fit_quadric(samples::quadric(5e-3, 20, 10e-3, -20e-3), Vector3d::Zero(), nullptr, r);
  EXPECT_NEAR(saddle.principal.radii_m[0] / -20e-3, 1, 4 * chord_bias(edge, 10e-3));
  EXPECT_NEAR(saddle.principal.radii_m[1] / 10e-3, 1, chord_bias(edge, 10e-3));

  const auto bowl =
      fit_quadric(samples::quadric(5e-3, 20, -10e-3, -20e-3), Vector3d::Zero(), nullptr, r);
  EXPECT_NEAR(bowl.principal.radii_m[0] / -10e-3, 1, chord_bias(edge, 10e-3));
}

TEST(QuadricFit, IsTheSameFarFromTheOriginAndForAnyPose) {
  auto surface = samples::quadric(15e-3, 30, 40e-3, 15e-3, 0.4);
  const auto here = fit_quadric(surface, Vector3d::Zero(), nullptr, 6e-3);
  const Vector3d away(100, -200, 300);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (auto& v : surface.vertices_m) v = turn * v + away;
  const auto there = fit_quadric(surface, away, nullptr, 6e-3);
  // Coordinates of 300 m carry an error of 3e-14 m, over a depth of r²/(2R) = 1e-3 m.
  for (int i : {0, 1}) EXPECT_NEAR(there.principal.radii_m[i] / here.principal.radii_m[i], 1, 1e-8);
  EXPECT_LT((there.normal - turn * here.normal).norm(), 1e-8);
}

TEST(QuadricFit, DoesNotLeakThroughAThinPlate) {
  // Two spherical caps back to back, a tenth of the region's radius apart, joined at their rims.
  const double w = 4e-3, radius = 50e-3, thickness = 0.5e-3;
  const int n = 16;
  auto plate = samples::quadric(w, n, radius, radius);
  const int count = static_cast<int>(plate.vertices_m.size());
  const auto bottom = plate;
  for (const auto& v : bottom.vertices_m)
    plate.vertices_m.emplace_back(v.x(), v.y(), v.z() - thickness);
  for (const auto& [a, b, c] : bottom.triangles)
    plate.triangles.push_back({a + count, c + count, b + count});
  for (int i = 0; i < n; ++i) {  // the sides
    for (const auto& [a, b] : {std::array<int, 2>{i, i + 1},
                               {(i + 1) * (n + 1), i * (n + 1)},
                               {n * (n + 1) + i + 1, n * (n + 1) + i},
                               {i * (n + 1) + n, (i + 1) * (n + 1) + n}}) {
      plate.triangles.push_back({a, b, b + count});
      plate.triangles.push_back({a, b + count, a + count});
    }
  }
  const double r = 5.7e-3;  // reaches round the whole plate
  const auto top = fit_quadric(plate, Vector3d::Zero(), nullptr, r);
  const auto alone = fit_quadric(bottom, Vector3d::Zero(), nullptr, r);
  EXPECT_EQ(top.points, alone.points);
  EXPECT_DOUBLE_EQ(top.quadric.A_per_m, alone.quadric.A_per_m);
  const auto below = fit_quadric(plate, {0, 0, -thickness}, nullptr, r);
  EXPECT_NEAR(below.normal.z(), -1, 1e-6);
  EXPECT_LT(below.principal.radii_m[1], 0);  // seen from below the plate is hollow
}

TEST(QuadricFit, NormalDecidesBetweenCoincidentSheets) {
  auto sheets = samples::quadric(5e-3, 10, 20e-3, 20e-3);
  const int count = static_cast<int>(sheets.vertices_m.size());
  const auto one = sheets;
  for (const auto& v : one.vertices_m) sheets.vertices_m.push_back(v);
  for (const auto& [a, b, c] : one.triangles)
    sheets.triangles.push_back({a + count, c + count, b + count});
  const Vector3d up(0, 0, 1), down(0, 0, -1);
  EXPECT_GT(fit_quadric(sheets, Vector3d::Zero(), &up, 3e-3).principal.radii_m[0], 0);
  EXPECT_LT(fit_quadric(sheets, Vector3d::Zero(), &down, 3e-3).principal.radii_m[0], 0);
}

TEST(QuadricFit, UncertaintyCoversTheTruthOnNoisyMeshes) {
  std::mt19937 random(1);
  const double noise_m = 20e-6, r = 5e-3, major = 30e-3, minor = 12e-3;
  std::normal_distribution<double> noise(0, noise_m);
  const int trials = 100;
  double sum2 = 0, std2 = 0, mean = 0;
  int covered = 0;
  std::vector<double> values;
  for (int trial = 0; trial < trials; ++trial) {
    auto surface = samples::quadric(7e-3, 16, major, minor, 0.3);
    for (auto& v : surface.vertices_m) v.z() += noise(random);
    const auto fit = fit_quadric(surface, Vector3d::Zero(), nullptr, r);
    values.push_back(fit.principal.radii_m[1]);
    mean += fit.principal.radii_m[1] / trials;
    std2 += fit.radii_std_m[1] * fit.radii_std_m[1] / trials;
    covered += std::abs(fit.principal.radii_m[1] - minor) < 2 * fit.radii_std_m[1];
  }
  for (double value : values) sum2 += (value - mean) * (value - mean) / (trials - 1);
  // Both radii shall lie within two of the stated deviations in 95 %: 2.236 of the scatter's own.
  // The scatter of 100 trials is itself known to 1/sqrt(2 * 100) = 7 %: three of those, and a
  // little for Student's factor and the propagation to the radius.
  EXPECT_NEAR(std::sqrt(std2 / sum2) / (2.236 / 2), 1, 0.25);
  // Two standard deviations hold 95 %; a bias of up to half of one leaves 93 %, and three standard
  // deviations of 100 draws are 8 %.
  EXPECT_GE(covered, 0.85 * trials);
}

TEST(QuadricFit, SixVerticesHaveNoKnownUncertainty) {
  TriangleSurface fan;  // a pentagon around its middle
  fan.vertices_m.push_back(Vector3d::Zero());
  for (int i = 0; i < 5; ++i) {
    const double t = 2 * kPi * i / 5;
    fan.vertices_m.emplace_back(1e-3 * std::cos(t), 1e-3 * std::sin(t), -1e-5);
    fan.triangles.push_back({0, i + 1, (i + 1) % 5 + 1});
  }
  const auto fit = fit_quadric(fan, Vector3d::Zero(), nullptr, 2e-3);
  EXPECT_EQ(fit.points, 6);
  EXPECT_EQ(fit.radii_std_m[1], kInfinity);
}

// Each error is one line that names what was wrong and what would do.
template <typename Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    EXPECT_FALSE(error.allowed().empty());
    return error.what();
  }
  return "nothing was thrown";
}

TEST(QuadricFit, RefusesWhatDoesNotDetermineAQuadric) {
  const auto surface = samples::quadric(5e-3, 10, 20e-3, 20e-3);
  const auto expect = [&](const std::string& part, const TriangleSurface& s, const Vector3d& point,
                          const Vector3d* normal, double radius) {
    const std::string line = error_of([&] { fit_quadric(s, point, normal, radius); });
    EXPECT_NE(line.find(part), std::string::npos) << line;
  };
  const Vector3d origin(0, 0, 0), up(0, 0, 1), down(0, 0, -1), zero(0, 0, 0);
  expect("nearest triangle", surface, {0, 0, 1}, nullptr, 3e-3);
  expect("at least 6", surface, origin, nullptr, 0.5e-3);
  expect("positive", surface, origin, nullptr, -1e-3);
  expect("positive", surface, origin, nullptr, std::nan(""));
  expect("finite", surface, {std::nan(""), 0, 0}, nullptr, 3e-3);
  expect("not zero", surface, origin, &zero, 3e-3);
  expect("inside out", surface, origin, &down, 3e-3);
  expect("at least one triangle", {}, origin, &up, 3e-3);

  TriangleSurface strip;  // all vertices on two lines
  for (int i = 0; i < 10; ++i) {
    strip.vertices_m.emplace_back(1e-3 * i, 0, 0);
    strip.vertices_m.emplace_back(1e-3 * i, 1e-3, 0);
  }
  for (int i = 0; i < 18; i += 2) {
    strip.triangles.push_back({i, i + 2, i + 1});
    strip.triangles.push_back({i + 1, i + 2, i + 3});
  }
  expect("conic", strip, {5e-3, 0.5e-3, 0}, nullptr, 4e-3);
}

TEST(QuadricFit, PassesOverDegenerateTriangles) {
  auto surface = samples::quadric(5e-3, 10, 20e-3, 20e-3);
  const auto clean = fit_quadric(surface, Vector3d::Zero(), nullptr, 3e-3);
  surface.triangles.push_back({60, 60, 61});
  surface.triangles.push_back({48, 60, 72});
  const auto fit = fit_quadric(surface, Vector3d::Zero(), nullptr, 3e-3);
  EXPECT_NEAR(fit.quadric.A_per_m, clean.quadric.A_per_m, 1e-9 * clean.quadric.A_per_m);
}

}  // namespace
}  // namespace softfinger
