// Touching points of two bodies against closed forms, brute force, and each other.
#include "comparisons/simulation/collision.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <fstream>
#include <random>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "tests/meshes/triangulated_ellipsoid.h"

namespace softfinger::simulation {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct BodyText {
  std::string shape;  ///< "sphere_radius_mm = 10"
  Isometry3d pose = Isometry3d::Identity();
};

Isometry3d at(double x, double y, double z) {
  Isometry3d result = Isometry3d::Identity();
  result.translation() = Vector3d(x, y, z);
  return result;
}

Isometry3d turned(Isometry3d pose, double angle, const Vector3d& axis) {
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return pose;
}

/// The scene, its bodies at exactly the given poses, fast enough that the detector looks far.
struct Detection {
  explicit Detection(const std::vector<BodyText>& bodies, const std::string& more = "",
                     const fs::path& file = "test.toml") {
    std::string text = "id = \"test\"\n[simulation]\ntime_step_ms = 1\nduration_s = 1\n" + more;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const bool fixed = bodies[b].shape == "half_space = true";
      text += fmt::format("[[body]]\nname = \"b{}\"\nshapes = [{{ {} }}]\n{}\n", b, bodies[b].shape,
                          fixed ? "fixed = true" : "mass_g = 100\ninertia_kg_mm2 = [1, 1, 1]");
    }
    scene = input::parse_scene(text, file);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      scene.descriptions[b].pose = bodies[b].pose;
      if (!scene.descriptions[b].fixed) scene.descriptions[b].velocity_m_per_s = Vector3d(1, 0, 0);
    }
  }
  std::vector<TouchingPoint> find(double reach_m = 1) {
    const Multibody multibody(scene.descriptions, scene.joints);
    if (!detector) detector = std::make_unique<CollisionDetector>(scene);
    std::vector<TouchingPoint> points;
    detector->find(multibody, reach_m / 2, points);
    return points;
  }
  void move(int body, const Isometry3d& pose) { scene.descriptions[std::size_t(body)].pose = pose; }

  input::Scene scene;
  std::unique_ptr<CollisionDetector> detector;
};

std::vector<TouchingPoint> find(const std::vector<BodyText>& bodies, double reach_m = 1) {
  return Detection(bodies).find(reach_m);
}

void expect_frame(const TouchingPoint& point) {
  EXPECT_LE((point.axes.transpose() * point.axes - Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_GT(point.axes.determinant(), 0) << "right-handed";
  EXPECT_LT(point.a, point.b);
}

// --- single points in closed form ----------------------------------------------------------------

TEST(Touching, ABallOnAPlane) {
  for (const double gap : {0.0, 1e-3, 0.05, -1e-4}) {
    const Isometry3d tilt = turned(at(0.1, -0.2, 0.3), 0.7, Vector3d(1, 2, 0));
    const Vector3d up = tilt.linear().col(2);
    const Vector3d center = tilt * Vector3d(0.04, 0.05, 0.01 + gap);
    const auto points = find({{"half_space = true", tilt},
                              {"sphere_radius_mm = 10", at(center.x(), center.y(), center.z())}});
    ASSERT_EQ(points.size(), 1u);
    const TouchingPoint& point = points[0];
    expect_frame(point);
    EXPECT_NEAR(point.gap_m, gap, 4 * kEpsilon);
    EXPECT_LE((point.axes.col(2) - up).norm(), 8 * kEpsilon) << "from the plane to the ball";
    EXPECT_LE((point.point_m - (center - (0.01 + gap / 2) * up)).norm(), 8 * kEpsilon);
    ASSERT_TRUE(point.elliptic);
    EXPECT_NEAR(point.radii.major_m, 0.01, 64 * kEpsilon);
    EXPECT_NEAR(point.radii.minor_m, 0.01, 64 * kEpsilon);
  }
}

TEST(Touching, TwoBalls) {
  for (const double gap : {1e-9, 1e-3, 0.05, -1e-4}) {
    const Vector3d direction = Vector3d(1, 2, -2) / 3;
    const Vector3d other = Vector3d(0.1, 0.1, 0.1) + (0.03 + gap) * direction;
    const auto points = find({{"sphere_radius_mm = 10", at(0.1, 0.1, 0.1)},
                              {"sphere_radius_mm = 20", at(other.x(), other.y(), other.z())}});
    ASSERT_EQ(points.size(), 1u);
    expect_frame(points[0]);
    EXPECT_NEAR(points[0].gap_m, gap, 1e-15);
    EXPECT_LE((points[0].axes.col(2) - direction).norm(), 1e-13);
    ASSERT_TRUE(points[0].elliptic);
    const double radius = 1 / (1 / 0.01 + 1 / 0.02);
    EXPECT_NEAR(points[0].radii.major_m / radius, 1, 1e-12);
    EXPECT_NEAR(points[0].radii.minor_m / radius, 1, 1e-12);
  }
}

TEST(Touching, ABallOnALyingCylinder) {
  const auto points = find(
      {{"sphere_radius_mm = 10", at(0.1, 0, 0.0301)},
       {"cylinder_radius_length_mm = [20, 300]", turned(at(0, 0, 0), kPi / 2, Vector3d::UnitY())}});
  ASSERT_EQ(points.size(), 1u);
  expect_frame(points[0]);
  EXPECT_NEAR(points[0].gap_m, 1e-4, 1e-15);
  EXPECT_LE((points[0].axes.col(2) + Vector3d::UnitZ()).norm(), 1e-12);
  ASSERT_TRUE(points[0].elliptic);
  EXPECT_NEAR(points[0].radii.major_m, 0.01, 1e-13);
  EXPECT_NEAR(points[0].radii.minor_m, 1 / (1 / 0.01 + 1 / 0.02), 1e-13);
  EXPECT_NEAR(std::abs(points[0].axes.col(0).x()), 1, 1e-10) << "long axis along the cylinder";
}

TEST(Touching, CrossedCapsulesAreJohnsonsFormula) {
  // K. L. Johnson, Contact Mechanics, eq. (4.4).
  const double r1 = 0.02, r2 = 0.01, k1 = 1 / r1, k2 = 1 / r2;
  for (const double angle : {0.3, 1.0, kPi / 2}) {
    Isometry3d lower = turned(at(0, 0, 0), kPi / 2, Vector3d::UnitY());
    Isometry3d upper = at(0, 0, r1 + r2 + 1e-5);
    upper.linear() =
        Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix() * lower.linear();
    const auto points = find({{"capsule_radius_length_mm = [20, 200]", lower},
                              {"capsule_radius_length_mm = [10, 200]", upper}});
    ASSERT_EQ(points.size(), 1u);
    EXPECT_NEAR(points[0].gap_m, 1e-5, 1e-14);
    ASSERT_TRUE(points[0].elliptic);
    const double difference = std::sqrt(k1 * k1 + k2 * k2 + 2 * k1 * k2 * std::cos(2 * angle));
    EXPECT_NEAR(1 / points[0].radii.minor_m, (k1 + k2 + difference) / 2, 1e-9 * k2);
    EXPECT_NEAR(1 / points[0].radii.major_m, (k1 + k2 - difference) / 2, 1e-9 * k2);
  }
}

TEST(Touching, AnEllipsoidOnABoxWithItsEnd) {
  const double a = 0.01, b = 0.02, c = 0.03;
  const auto points = find({{"box_size_mm = [200, 200, 20]", at(0, 0, -0.01)},
                            {"ellipsoid_semi_axes_mm = [10, 20, 30]",
                             turned(at(0.02, 0.01, c + 1e-4), 0.5, Vector3d::UnitZ())}});
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].gap_m, 1e-4, 1e-14);
  ASSERT_TRUE(points[0].elliptic);
  EXPECT_NEAR(points[0].radii.major_m, b * b / c, 1e-12);
  EXPECT_NEAR(points[0].radii.minor_m, a * a / c, 1e-12);
  const Vector3d long_axis = Eigen::AngleAxisd(0.5, Vector3d::UnitZ()) * Vector3d::UnitY();
  EXPECT_NEAR(std::abs(points[0].axes.col(0).dot(long_axis)), 1, 1e-10);
}

// --- against alternating projections ------------------------------------------------------------

/// The nearest point of a solid, written down for the test.
Vector3d nearest_point(const std::string& kind, const Vector3d& size, const Isometry3d& pose,
                       const Vector3d& world) {
  const Vector3d p = pose.inverse() * world;
  Vector3d q = p;
  if (kind == "box") {
    q = p.cwiseMax(-size / 2).cwiseMin(size / 2);
  } else if (kind == "capsule") {
    const Vector3d core(0, 0, std::clamp(p.z(), -size[1] / 2, size[1] / 2));
    const double far = (p - core).norm();
    if (far > size[0]) q = core + size[0] / far * (p - core);
  } else if (kind == "cylinder") {
    const double across = std::hypot(p.x(), p.y());
    if (across > size[0]) q.head<2>() *= size[0] / across;
    q.z() = std::clamp(p.z(), -size[1] / 2, size[1] / 2);
  } else if (p.cwiseQuotient(size).squaredNorm() > 1) {
    // q_i = a_i² p_i / (a_i² + t), t the root of |q / a| = 1; convex and falling: Newton from 0.
    const Vector3d squares = size.cwiseAbs2();
    double t = 0;
    for (int round = 0; round < 100; ++round) {
      const Vector3d weights = (squares.array() + t).inverse();
      const Vector3d scaled = size.cwiseProduct(p).cwiseProduct(weights);
      const double step = (scaled.squaredNorm() - 1) / (2 * scaled.cwiseAbs2().dot(weights));
      t += step;
      if (std::abs(step) < 1e-17) break;
    }
    q = squares.cwiseProduct(p).cwiseQuotient((squares.array() + t).matrix());
  }
  return pose * q;
}

struct Closest {
  Vector3d on_a, on_b;
  double gap_m() const { return (on_b - on_a).norm(); }
  Vector3d normal() const { return (on_b - on_a).normalized(); }
};

struct Solid {
  std::string kind, text;
  Vector3d size;
};

const std::vector<Solid> kSolids = {
    {"ellipsoid", "ellipsoid_semi_axes_mm = [10, 20, 30]", {0.01, 0.02, 0.03}},
    {"ellipsoid", "ellipsoid_semi_axes_mm = [25, 8, 12]", {0.025, 0.008, 0.012}},
    {"capsule", "capsule_radius_length_mm = [12, 40]", {0.012, 0.04, 0}},
    {"cylinder", "cylinder_radius_length_mm = [15, 50]", {0.015, 0.05, 0}},
    {"box", "box_size_mm = [20, 30, 40]", {0.02, 0.03, 0.04}}};

/// Projections to and fro converge to the closest points of convex bodies that are apart.
Closest closest(const Solid& a, const Isometry3d& pose_a, const Solid& b,
                const Isometry3d& pose_b) {
  Closest result{pose_a.translation(), pose_b.translation()};
  for (int round = 0; round < 20000; ++round) {
    const Vector3d before = result.on_a;
    result.on_b = nearest_point(b.kind, b.size, pose_b, result.on_a);
    result.on_a = nearest_point(a.kind, a.size, pose_a, result.on_b);
    if ((result.on_a - before).norm() < 1e-16) break;
  }
  return result;
}

/// Two bodies at random poses, a gap apart.
struct Pair {
  Pair(int trial, double gap_m)
      : one(kSolids[std::size_t(trial) % kSolids.size()]),
        two(kSolids[std::size_t(trial / 5) % kSolids.size()]) {
    std::mt19937_64 random(trial);
    std::uniform_real_distribution<double> uniform(-1, 1);
    // Drawn one after the other, last first: the arguments of a call are drawn in an order that
    // each compiler chooses, and the same pairs are wanted of all.
    const auto vector = [&] {
      const double z = uniform(random), y = uniform(random), x = uniform(random);
      return Vector3d(x, y, z);
    };
    for (Isometry3d& p : pose) {
      const Vector3d axis = vector();
      p = turned(at(0, 0, 0), 3 * uniform(random), axis);
    }
    const Vector3d direction = vector().normalized();
    double distance = 0.2;
    for (int round = 0; round < 50; ++round) {
      pose[1].translation() = distance * direction;
      exact = closest(one, pose[0], two, pose[1]);
      if (std::abs(exact.gap_m() - gap_m) < 1e-9) break;
      distance -= (exact.gap_m() - gap_m) / exact.normal().dot(direction);
    }
  }
  Solid one, two;
  std::array<Isometry3d, 2> pose;
  Closest exact;
};

const TouchingPoint& nearest_of(const std::vector<TouchingPoint>& points) {
  return *std::min_element(
      points.begin(), points.end(),
      [](const TouchingPoint& p, const TouchingPoint& q) { return p.gap_m < q.gap_m; });
}

TEST(Touching, RandomPairsAgreeWithAlternatingProjections) {
  int compared = 0, round = 0;
  double worst_gap = 0, worst_normal = 0, worst_edge_gap = 0, worst_edge_normal = 0;
  for (int trial = 0; trial < 125; ++trial) {
    const Pair pair(trial, 1e-4);
    if (std::abs(pair.exact.gap_m() - 1e-4) > 1e-8) continue;  // not brought to that gap
    const auto points = find({{pair.one.text, pair.pose[0]}, {pair.two.text, pair.pose[1]}}, 1e-3);
    const std::string what =
        fmt::format("trial {}: {} and {}", trial, pair.one.text, pair.two.text);
    ASSERT_GE(points.size(), 1u) << what;
    for (const TouchingPoint& point : points) expect_frame(point);
    const TouchingPoint& nearest = nearest_of(points);
    ++compared;
    round += nearest.elliptic;
    const double gap_error = std::abs(nearest.gap_m - pair.exact.gap_m());
    const double normal_error = (nearest.axes.col(2) - pair.exact.normal()).norm();
    const bool point = pair.one.kind == "ellipsoid" || pair.two.kind == "ellipsoid";
    double& gap = nearest.elliptic ? worst_gap : worst_edge_gap;
    double& normal = nearest.elliptic ? worst_normal : worst_edge_normal;
    gap = std::max(gap, gap_error);
    normal = std::max(normal, normal_error);
    // Both round: to round-off, of 20 mm in the gap, magnified by 20 mm over it in the normal of
    // the projections. Edges and rims: FCL finds them to 1e-5 of the size, and the normal to the
    // root of that; nearly flat contacts have the face's normal, within acos(1 - 1e-3).
    EXPECT_LE(gap_error, nearest.elliptic ? 1e-14 : 1e-5 * 0.02) << what;
    EXPECT_LE(normal_error, nearest.elliptic ? 1e-10 : point ? std::sqrt(1e-4) : 0.045) << what;
  }
  std::printf(
      "%d pairs: %d round, gap within %.1e m, normal within %.1e; edges and corners, %.1e m, "
      "%.1e\n",
      compared, round, worst_gap, worst_normal, worst_edge_gap, worst_edge_normal);
  EXPECT_GT(compared, 100);
  EXPECT_GT(round, 25);
}

TEST(Touching, EllipsoidsHaveTheRelativeCurvatureOfTheirHeights) {
  // Heights of both over the tangent plane by intersecting lines with the ellipsoids; the second
  // derivatives of their difference by differences, h² = 1e-8 of it.
  const Vector3d one_axes(0.01, 0.02, 0.03), two_axes(0.025, 0.008, 0.012);
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 20; ++trial) {
    std::array<Isometry3d, 2> pose;
    for (Isometry3d& p : pose)
      p = turned(at(0, 0, 0), 2 * uniform(random),
                 Vector3d(uniform(random), uniform(random), uniform(random)));
    // Touching where the normal is z.
    const auto top = [](const Isometry3d& p, const Vector3d& axes, double sign) -> Vector3d {
      const Vector3d n = p.linear().transpose() * (sign * Vector3d::UnitZ());
      return p.linear() * axes.cwiseAbs2().cwiseProduct(n) / axes.cwiseProduct(n).norm();
    };
    const double gap = 1e-5;
    pose[1].translation() =
        top(pose[0], one_axes, 1) + Vector3d(0, 0, gap) - top(pose[1], two_axes, -1);
    const auto height = [](const Isometry3d& p, const Vector3d& axes, double sign,
                           const Vector3d& base) {
      const Vector3d from = (p.inverse() * base).cwiseQuotient(axes);
      const Vector3d along =
          (p.linear().transpose() * Vector3d::UnitZ()).eval().cwiseQuotient(axes);
      const double a = along.squaredNorm(), b = from.dot(along), c = from.squaredNorm() - 1;
      return (-b + sign * std::sqrt(b * b - a * c)) / a;
    };
    const Vector3d touch = top(pose[0], one_axes, 1);
    const auto apart = [&](double x, double y) {
      const Vector3d base = touch + Vector3d(x, y, 0);
      return height(pose[1], two_axes, -1, base) - height(pose[0], one_axes, 1, base);
    };
    const double h = 2e-6;
    Eigen::Matrix2d bends;
    bends(0, 0) = (apart(h, 0) - 2 * apart(0, 0) + apart(-h, 0)) / (h * h);
    bends(1, 1) = (apart(0, h) - 2 * apart(0, 0) + apart(0, -h)) / (h * h);
    bends(0, 1) = bends(1, 0) =
        (apart(h, h) - apart(h, -h) - apart(-h, h) + apart(-h, -h)) / (4 * h * h);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal(bends);
    const auto points = find({{"ellipsoid_semi_axes_mm = [10, 20, 30]", pose[0]},
                              {"ellipsoid_semi_axes_mm = [25, 8, 12]", pose[1]}});
    ASSERT_EQ(points.size(), 1u);
    ASSERT_TRUE(points[0].elliptic);
    EXPECT_NEAR(points[0].gap_m, gap, 1e-14);
    EXPECT_LE((points[0].axes.col(2) - Vector3d::UnitZ()).norm(), 1e-10);
    EXPECT_LE((points[0].point_m - touch - Vector3d(0, 0, gap / 2)).norm(), 1e-11);
    const double accuracy = 1e-4;  // (h / 1 mm)², and epsilon 10 mm / h² against 100/m
    EXPECT_NEAR(points[0].radii.major_m * principal.eigenvalues()[0], 1, accuracy);
    EXPECT_NEAR(points[0].radii.minor_m * principal.eigenvalues()[1], 1, accuracy);
    if (principal.eigenvalues()[1] > 1.2 * principal.eigenvalues()[0]) {
      EXPECT_NEAR(std::abs(points[0].axes.col(0).head<2>().dot(principal.eigenvectors().col(0))), 1,
                  accuracy);
    }
  }
}

// --- flat contacts -------------------------------------------------------------------------------

TEST(Bearing, ABoxOnABoxIsHeldByFourPoints) {
  const std::string large = "box_size_mm = [100, 100, 20]", small = "box_size_mm = [40, 30, 20]";
  for (const bool small_above : {true, false})
    for (const double angle : {0.0, 0.3}) {
      const auto points =
          find({{small_above ? large : small, at(0, 0, 0)},
                {small_above ? small : large, turned(at(0.01, 0, 0.02), angle, Vector3d::UnitZ())}},
               0);
      ASSERT_EQ(points.size(), 4u);
      Vector3d mean = Vector3d::Zero();
      for (const TouchingPoint& point : points) {
        expect_frame(point);
        EXPECT_NEAR(point.gap_m, 0, 1e-15);
        EXPECT_LE((point.axes.col(2) - Vector3d::UnitZ()).norm(), 1e-12);
        EXPECT_FALSE(point.elliptic);
        EXPECT_NEAR(point.point_m.z(), 0.01, 1e-12);
        mean += point.point_m / 4;
      }
      EXPECT_LE((mean - Vector3d(small_above ? 0.01 : 0, 0, 0.01)).norm(), 1e-12);
    }
}

TEST(Bearing, EqualBoxesInAStackAreHeldByTheirCommonRectangle) {
  // Shifted along both edges: corners of both, and crossings of edges, bear.
  const double shift_x = 0.013, shift_y = 0.007;
  const auto points = find({{"box_size_mm = [40, 30, 20]", at(0, 0, 0)},
                            {"box_size_mm = [40, 30, 20]", at(shift_x, shift_y, 0.02)}},
                           0);
  ASSERT_GE(points.size(), 3u);
  Vector3d least = points[0].point_m, most = least;
  for (const TouchingPoint& point : points) {
    least = least.cwiseMin(point.point_m);
    most = most.cwiseMax(point.point_m);
  }
  EXPECT_LE((least - Vector3d(-0.02 + shift_x, -0.015 + shift_y, 0.01)).norm(), 1e-12);
  EXPECT_LE((most - Vector3d(0.02, 0.015, 0.01)).norm(), 1e-12);
  EXPECT_EQ(points.size(), 4u) << "the crossings of the edges bear too";
}

TEST(Bearing, CrossedPlanksAreHeldByTheirCommonRectangle) {
  const auto points = find({{"box_size_mm = [200, 20, 20]", at(0, 0, 0)},
                            {"box_size_mm = [20, 200, 20]", at(0.01, 0, 0.02)}},
                           0);
  ASSERT_EQ(points.size(), 4u);
  Vector3d mean = Vector3d::Zero();
  for (const TouchingPoint& point : points) {
    EXPECT_NEAR(std::abs(point.point_m.x() - 0.01), 0.01, 1e-12);
    EXPECT_NEAR(std::abs(point.point_m.y()), 0.01, 1e-12);
    EXPECT_NEAR(point.gap_m, 0, 1e-12);
    mean += point.point_m / 4;
  }
  EXPECT_LE((mean - Vector3d(0.01, 0, 0.01)).norm(), 1e-12);
}

TEST(Bearing, ABoxOnItsEdgeAndOnItsCorner) {
  Isometry3d pose = turned(at(0, 0, 0.02 * std::sqrt(0.5)), kPi / 4, Vector3d::UnitX());
  auto points = find({{"half_space = true"}, {"box_size_mm = [40, 20, 20]", pose}}, 1e-4);
  ASSERT_EQ(points.size(), 2u);
  for (const TouchingPoint& point : points) {
    EXPECT_NEAR(point.gap_m, 0, 1e-15);
    EXPECT_NEAR(std::abs(point.point_m.x()), 0.02, 1e-15);
  }
  pose.linear() =
      Eigen::Quaterniond::FromTwoVectors(Vector3d(1, 1, 1), -Vector3d::UnitZ()).toRotationMatrix();
  pose.translation().z() = 0.01 * std::sqrt(3.);
  points = find({{"half_space = true"}, {"box_size_mm = [20, 20, 20]", pose}}, 1e-4);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].gap_m, 0, 1e-15);
}

TEST(Bearing, CylindersStandOnTheirRims) {
  for (const bool on_box : {false, true}) {
    const auto points = find({on_box ? BodyText{"box_size_mm = [100, 100, 20]", at(0, 0, -0.01)}
                                     : BodyText{"half_space = true"},
                              {"cylinder_radius_length_mm = [20, 60]", at(0.01, 0.005, 0.03)}},
                             0);
    ASSERT_GE(points.size(), 3u);
    ASSERT_LE(points.size(), 8u);
    Vector3d mean = Vector3d::Zero();
    for (const TouchingPoint& point : points) {
      EXPECT_NEAR(point.gap_m, 0, 1e-14);
      EXPECT_NEAR((point.point_m - Vector3d(0.01, 0.005, 0)).norm(), 0.02, 1e-12);
      EXPECT_LE((point.axes.col(2) - Vector3d::UnitZ()).norm(), 1e-12);
      mean += point.point_m / double(points.size());
    }
    EXPECT_LE((mean - Vector3d(0.01, 0.005, 0)).norm(), 1e-12) << "around the centre";
  }
}

TEST(Bearing, RodsLieOnTheEndsOfALine) {
  for (const char* rod :
       {"cylinder_radius_length_mm = [20, 60]", "capsule_radius_length_mm = [20, 60]"})
    for (const bool on_box : {false, true}) {
      const auto points = find({on_box ? BodyText{"box_size_mm = [100, 100, 20]", at(0, 0, -0.01)}
                                       : BodyText{"half_space = true"},
                                {rod, turned(at(0, 0, 0.02), kPi / 2, Vector3d::UnitY())}},
                               0);
      ASSERT_EQ(points.size(), 2u) << rod << on_box;
      for (const TouchingPoint& point : points) {
        EXPECT_NEAR(point.gap_m, 0, 1e-14);
        EXPECT_NEAR(std::abs(point.point_m.x()), 0.03, 1e-9);
        EXPECT_NEAR(point.point_m.y(), 0, 1e-9) << "of FCL's normal";
      }
    }
}

/// A rod that is longer than the face it lies on, and turned on it.
TEST(Bearing, RodsAreHeldWhereTheirLineLeavesAFace) {
  const double half = 0.01;  // of the square, or the radius of the disc
  for (const char* rod :
       {"cylinder_radius_length_mm = [20, 60]", "capsule_radius_length_mm = [20, 60]"})
    for (const bool on_disc : {false, true})
      for (const double angle : {0.0, 0.4, -0.7}) {
        SCOPED_TRACE(fmt::format("{} {} {}", rod, on_disc, angle));
        const std::string block =
            on_disc ? "cylinder_radius_length_mm = [10, 20]" : "box_size_mm = [20, 20, 20]";
        Isometry3d lying = turned(at(0, 0, 0.02), kPi / 2, Vector3d::UnitY());
        lying.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitZ()) * lying.linear();
        const auto points = find({{block, at(0, 0, -0.01)}, {rod, lying}}, 0);
        ASSERT_EQ(points.size(), 2u);
        const double leaves = on_disc ? half : half / std::cos(angle);
        for (const TouchingPoint& point : points) {
          expect_frame(point);
          EXPECT_NEAR(point.gap_m, 0, 1e-12);
          const Vector3d expected = leaves * Vector3d(std::cos(angle), std::sin(angle), 0);
          const double side = point.point_m.dot(expected) > 0 ? 1 : -1;
          EXPECT_LE((point.point_m - side * expected).norm(), 1e-8) << "of FCL's normal";
        }
        EXPECT_LT(points[0].point_m.dot(points[1].point_m), 0) << "both ends";
      }
}

/// A can that stands half beside another one: the two tips of the lens that they share.
TEST(Bearing, RimsCrossAtTheTipsOfTheirLens) {
  const std::string can = "cylinder_radius_length_mm = [20, 40]";
  const auto points = find({{can, at(0, 0, 0)}, {can, at(0.02, 0, 0.04)}}, 0);
  for (const double side : {-1, 1}) {
    const Vector3d tip(0.01, side * 0.01 * std::sqrt(3), 0.02);
    EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const TouchingPoint& point) {
      return (point.point_m - tip).norm() < 1e-9 && std::abs(point.gap_m) < 1e-12;
    })) << side;
  }
}

// --- identity, order, meshes ---------------------------------------------------------------------

TEST(CollisionDetector, DoesNotDependOnTheOrderOfTheBodies) {
  for (int trial = 0; trial < 60; ++trial) {
    const Pair pair(trial, 1e-4);
    const BodyText a{pair.one.text, pair.pose[0]}, b{pair.two.text, pair.pose[1]};
    const auto forward = find({a, b}, 1e-3), backward = find({b, a}, 1e-3);
    ASSERT_GE(forward.size(), 1u);
    ASSERT_GE(backward.size(), 1u);
    const TouchingPoint &one = nearest_of(forward), &other = nearest_of(backward);
    ASSERT_EQ(one.elliptic, other.elliptic);
    if (one.elliptic) {
      EXPECT_EQ(forward.size(), backward.size());
    }
    // Edges and rims: as FCL finds them, see above; the normal's error, times 20 mm, is that of the
    // point.
    const double gap_accuracy = one.elliptic ? 1e-13 : 2 * 1e-5 * 0.02;
    const double normal_accuracy = one.elliptic ? 1e-10 : 2 * std::sqrt(1e-4);
    EXPECT_NEAR(one.gap_m, other.gap_m, gap_accuracy) << trial;
    EXPECT_LE((one.axes.col(2) + other.axes.col(2)).norm(), normal_accuracy) << trial;
    EXPECT_LE((one.point_m - other.point_m).norm(), 0.02 * normal_accuracy) << trial;
  }
}

TEST(CollisionDetector, GivesTheCurvatureOfTheBodyNamedFirst) {
  const double radius = 0.01;
  const std::string ball = "sphere_radius_mm = 10", plane = "half_space = true";
  const auto ball_first = find({{ball, at(0, 0, radius)}, {plane}});
  const auto plane_first = find({{plane}, {ball, at(0, 0, radius)}});
  ASSERT_EQ(ball_first.size(), 1u);
  ASSERT_EQ(plane_first.size(), 1u);
  EXPECT_NEAR(ball_first[0].curvature_of_a.xx_per_m * radius, 1, 1e-12);
  EXPECT_NEAR(ball_first[0].curvature_of_a.yy_per_m * radius, 1, 1e-12);
  EXPECT_NEAR(plane_first[0].curvature_of_a.xx_per_m * radius, 0, 1e-12);
  EXPECT_NEAR(plane_first[0].curvature_of_a.yy_per_m * radius, 0, 1e-12);
}

TEST(CollisionDetector, KeepsTheIdOfAContactThatLasts) {
  Detection detection({{"half_space = true"},
                       {"box_size_mm = [40, 30, 20]", at(0, 0, 0.01)},
                       {"sphere_radius_mm = 10", at(0, 0, 0.03)}});
  const auto before = detection.find(0);
  ASSERT_EQ(before.size(), 5u);
  std::vector<long> ids;
  for (const TouchingPoint& point : before) ids.push_back(point.id);
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(std::unique(ids.begin(), ids.end()), ids.end()) << "all different";
  detection.move(1, turned(at(1e-4, 0, 0.01), 1e-3, Vector3d::UnitZ()));
  const auto after = detection.find(0);
  ASSERT_EQ(after.size(), 5u);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i].id, before[i].id);
    EXPECT_LT((after[i].point_m - before[i].point_m).norm(), 1e-3) << "of the same point";
  }
}

TEST(CollisionDetector, LooksAsFarAsItIsAskedTo) {
  const std::vector<BodyText> bodies = {{"half_space = true"},
                                        {"sphere_radius_mm = 10", at(0, 0, 0.02)}};
  EXPECT_EQ(find(bodies, 0.02).size(), 1u);
  EXPECT_EQ(find(bodies, 0.008).size(), 0u);
}

/// Pairs that are far apart are not looked at until something has moved far enough, by its path or
/// by a turn about something far.
TEST(CollisionDetector, MissesNoPairHoweverTheBodiesMove) {
  constexpr int kBalls = 30;
  const double radius_m = 0.008;
  const Vector3d arm_m(0.06, 0, 0);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return Vector3d(unit(random), unit(random), unit(random)); };
  std::vector<BodyText> bodies;
  for (int b = 0; b < kBalls; ++b)
    bodies.push_back({"sphere_radius_mm = 8, position_mm = [60, 0, 0]", at(0.04 * b, 0, 0)});
  Detection detection(bodies);
  int near = 0;
  for (int step = 0; step < 400; ++step) {
    // Steps of all lengths, from those at rest to leaps.
    const double part = std::pow(10, 2 * unit(random) - 2);
    std::vector<Vector3d> centres;
    for (int b = 0; b < kBalls; ++b) {
      Isometry3d pose = detection.scene.descriptions[std::size_t(b)].pose;
      pose.translation() += part * (0.1 * vector() - 0.2 * pose.translation());
      pose.rotate(Eigen::AngleAxisd(2 * part * unit(random), vector().normalized()));
      detection.move(b, pose);
      centres.push_back(pose * arm_m);
    }
    const double reach_m = 0.01 * std::pow(10, unit(random) - 0.5);
    const std::vector<TouchingPoint> points = detection.find(reach_m / 2);  // two of them approach
    for (int a = 0; a < kBalls; ++a)
      for (int b = a + 1; b < kBalls; ++b) {
        const double gap_m =
            (centres[std::size_t(a)] - centres[std::size_t(b)]).norm() - 2 * radius_m;
        if (!(gap_m > 0 && gap_m < reach_m)) continue;
        ++near;
        EXPECT_TRUE(
            std::any_of(points.begin(), points.end(),
                        [&](const TouchingPoint& point) { return point.a == a && point.b == b; }))
            << "step " << step << ", gap " << gap_m << " of " << reach_m;
      }
  }
  EXPECT_GT(near, 100) << "hardly anything came near";
}

TEST(CollisionDetector, FindsBodiesThatOverlapDeeply) {
  // A ball pressed through most of a plate between two steps, known from before.
  Detection detection({{"box_size_mm = [100, 100, 20]", at(0, 0, 0)},
                       {"sphere_radius_mm = 10", at(0.003, 0.002, 0.0201)}});
  ASSERT_EQ(detection.find().size(), 1u);
  for (const double z : {0.019, 0.017, 0.0145, 0.011}) {
    detection.move(1, at(0.003, 0.002, z));
    const auto points = detection.find();
    ASSERT_EQ(points.size(), 1u) << z;
    EXPECT_NEAR(points[0].gap_m, z - 0.02, 1e-12);
    EXPECT_LE((points[0].axes.col(2) - Vector3d::UnitZ()).norm(), 1e-9) << z;
    EXPECT_LE((points[0].point_m - Vector3d(0.003, 0.002, (0.01 + z - 0.01) / 2)).norm(), 1e-9);
  }
}

struct Folder {
  Folder() : path(fs::temp_directory_path() / fmt::format("softfinger_collision_{}", getpid())) {
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  void write(const std::string& name, const TriangleSurface& surface) const {
    std::ofstream file(path / name);
    file.precision(17);
    for (const Vector3d& v : surface.vertices_m)
      file << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
    for (const auto& t : surface.triangles)
      file << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  }
  fs::path path;
};

/// A load so small that the contact, over which a mesh is fitted, is small against the ball.
const char* const kSoft =
    "nominal_load_N = 0.05\n[[layer]]\nname = \"foam\"\nthickness_mm = 2\nyoungs_modulus_kPa = "
    "100\n"
    "poisson_ratio = 0.3\n";

TEST(MeshContact, OfAFineBallIsThatOfTheBall) {
  const Folder folder;
  const double radius = 0.01;
  const TriangleSurface ball =
      meshes::triangulated_ellipsoid(Vector3d::Constant(radius), Vector3d::Zero(), 40);
  folder.write("ball.obj", ball);
  // Facets miss edge²/(8 R) of the height; the fit sees (edge/R)² of the curvature.
  const double edge = meshes::longest_edge(ball), sag = edge * edge / (8 * radius);
  for (const bool on_plane : {true, false}) {
    Detection detection(
        {on_plane ? BodyText{"half_space = true"}
                  : BodyText{"sphere_radius_mm = 15", at(0, 0, -0.015)},
         {"mesh = \"ball.obj\", unit = \"m\"", turned(at(0, 0, radius), 0.4, Vector3d(1, 2, 3))}},
        kSoft, folder.path / "scene.toml");
    detection.scene.bodies[1].layer = ElasticLayer{};
    detection.scene.bodies[1].layer->thickness_m = 2e-3;
    detection.scene.bodies[1].layer->youngs_modulus_Pa = 1e5;
    detection.scene.bodies[1].layer->poisson_ratio = 0.3;
    const auto points = detection.find();
    ASSERT_EQ(points.size(), 1u);
    EXPECT_NEAR(points[0].gap_m, 0, 2 * sag);
    EXPECT_LE((points[0].axes.col(2) - Vector3d::UnitZ()).norm(), edge / radius);
    ASSERT_TRUE(points[0].elliptic);
    const double expected = on_plane ? radius : 1 / (1 / radius + 1 / 0.015);
    EXPECT_NEAR(points[0].radii.major_m / expected, 1, 0.05);
    EXPECT_NEAR(points[0].radii.minor_m / expected, 1, 0.05);
    const int fits = detection.detector->fits();
    EXPECT_GE(fits, 1);
    for (int i = 0; i < 5; ++i) detection.find();
    EXPECT_EQ(detection.detector->fits(), fits) << "a contact that stays keeps its fit";
    detection.move(1, turned(at(0, 0, radius), 1.4, Vector3d(1, 0, 0)));
    detection.find();
    const int fits_of_two = detection.detector->fits();
    EXPECT_GT(fits_of_two, fits) << "elsewhere on the mesh";
    for (const bool back : {true, false, true}) {
      detection.move(1, back ? turned(at(0, 0, radius), 0.4, Vector3d(1, 2, 3))
                             : turned(at(0, 0, radius), 1.4, Vector3d(1, 0, 0)));
      EXPECT_EQ(detection.find().size(), 1u);
    }
    EXPECT_EQ(detection.detector->fits(), fits_of_two) << "where it was before";
  }
}

TEST(MeshContact, OfABoxIsHeldByItsCorners) {
  const Folder folder;
  TriangleSurface box;
  for (int i = 0; i < 8; ++i)
    box.vertices_m.emplace_back(i & 1 ? 0.02 : -0.02, i & 2 ? 0.015 : -0.015, i & 4 ? 0.01 : -0.01);
  box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  folder.write("box.obj", box);
  for (const bool on_plane : {true, false}) {
    Detection detection({on_plane ? BodyText{"half_space = true"}
                                  : BodyText{"box_size_mm = [100, 100, 20]", at(0, 0, -0.01)},
                         {"mesh = \"box.obj\", unit = \"m\"", at(0, 0, 0.01)}},
                        "", folder.path / "scene.toml");
    const auto points = detection.find(0);
    ASSERT_EQ(points.size(), 4u);
    for (const TouchingPoint& point : points) {
      EXPECT_NEAR(point.gap_m, 0, 0.02 * 1e-7) << "files are read in single precision";
      EXPECT_NEAR(std::abs(point.point_m.x()), 0.02, 1e-9);
    }
    // Turned onto another side it is held by that side's corners, not by those it remembers. Beside
    // a box the direction in which they touched is kept, too, for bodies that turn little by
    // little.
    if (!on_plane) continue;
    detection.move(1, turned(at(0, 0, 0.02), kPi / 2, Vector3d::UnitY()));
    const auto on_its_side = detection.find(1e-6);
    ASSERT_EQ(on_its_side.size(), 4u);
    for (const TouchingPoint& point : on_its_side) {
      EXPECT_NEAR(point.gap_m, 0, 0.02 * 1e-7);
      EXPECT_NEAR(std::abs(point.point_m.x()), 0.01, 1e-9);
    }
  }
}

/// A plank across a cube that is a mesh, and one across the gap between two feet of another.
TEST(MeshContact, APlankIsHeldWhereItCrossesTheEdges) {
  const Folder folder;
  TriangleSurface boxes;
  const auto add_box = [&](const Vector3d& low, const Vector3d& high) {
    const int first = int(boxes.vertices_m.size());
    for (int i = 0; i < 8; ++i)
      boxes.vertices_m.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                                    i & 4 ? high.z() : low.z());
    for (const auto& [a, b, c] : std::vector<std::array<int, 3>>{{0, 2, 3},
                                                                 {0, 3, 1},
                                                                 {4, 5, 7},
                                                                 {4, 7, 6},
                                                                 {0, 1, 5},
                                                                 {0, 5, 4},
                                                                 {2, 6, 7},
                                                                 {2, 7, 3},
                                                                 {0, 4, 6},
                                                                 {0, 6, 2},
                                                                 {1, 3, 7},
                                                                 {1, 7, 5}})
      boxes.triangles.push_back({first + a, first + b, first + c});
  };
  add_box({-0.02, -0.01, -0.02}, {0.02, 0.01, 0});
  folder.write("block.obj", boxes);
  boxes = {};
  add_box({-0.02, -0.01, -0.02}, {-0.01, 0.01, 0});
  add_box({0.01, -0.01, -0.02}, {0.02, 0.01, 0});
  folder.write("feet.obj", boxes);
  for (const bool on_feet : {false, true}) {
    // Along y: over the gap of the feet the hull's edges span nothing.
    Detection detection(
        {{on_feet ? "mesh = \"feet.obj\", unit = \"m\"" : "mesh = \"block.obj\", unit = \"m\""},
         {on_feet ? "box_size_mm = [10, 60, 20]" : "box_size_mm = [20, 60, 20]", at(0, 0, 0.01)}},
        "", folder.path / "scene.toml");
    const auto points = detection.find(0);
    if (on_feet) {
      for (const TouchingPoint& point : points) EXPECT_GT(std::abs(point.point_m.x()), 0.0099);
      continue;
    }
    ASSERT_EQ(points.size(), 4u);
    for (const TouchingPoint& point : points) {
      EXPECT_NEAR(std::abs(point.point_m.x()), 0.01, 1e-9);
      EXPECT_NEAR(std::abs(point.point_m.y()), 0.01, 1e-9);
      EXPECT_NEAR(point.gap_m, 0, 0.02 * 1e-7) << "files are read in single precision";
    }
  }
}

// --- overlap at the start ------------------------------------------------------------------------

TEST(CollisionDetector, RefusesBodiesThatOverlapAtTheStart) {
  const auto refused = [](const std::vector<BodyText>& bodies) {
    Detection detection(bodies);
    CollisionDetector detector(detection.scene);
    try {
      detector.require_no_overlap(Multibody(detection.scene.descriptions, {}));
    } catch (const InputError& error) {
      EXPECT_EQ(error.where(), "test.toml");
      EXPECT_NE(error.field().find("\"b0\" and \"b1\""), std::string::npos) << error.what();
      return true;
    }
    return false;
  };
  const std::string ball = "sphere_radius_mm = 10", box = "box_size_mm = [40, 40, 40]";
  EXPECT_FALSE(refused({{"half_space = true"}, {ball, at(0, 0, 0.01)}}));
  EXPECT_TRUE(refused({{"half_space = true"}, {ball, at(0, 0, 0.0099)}}));
  EXPECT_TRUE(refused({{"half_space = true"}, {ball, at(0, 0, -5)}})) << "all below";
  EXPECT_FALSE(refused({{box, at(0, 0, 0)}, {ball, at(0, 0, 0.03)}}));
  EXPECT_TRUE(refused({{box, at(0, 0, 0)}, {ball, at(0, 0, 0.029)}}));
  EXPECT_TRUE(refused({{box, at(0, 0, 0)}, {ball, at(0.001, 0.002, 0.003)}})) << "inside";
  EXPECT_TRUE(refused({{box, at(0, 0, 0)}, {ball, at(0, 0, 0)}})) << "concentric";
  EXPECT_TRUE(refused({{box, at(0, 0, 0)}, {box, at(0.02, 0.02, 0.02)}}));
  for (const Solid& one : kSolids)
    for (const Solid& two : kSolids) {
      EXPECT_TRUE(refused({{one.text, at(0, 0, 0)}, {two.text, at(0.004, 0.003, 0.002)}}))
          << one.text << " " << two.text;
      EXPECT_FALSE(refused({{one.text, at(0, 0, 0)}, {two.text, at(0.06, 0.06, 0.06)}}))
          << one.text << " " << two.text;
    }
}

}  // namespace
}  // namespace softfinger::simulation
