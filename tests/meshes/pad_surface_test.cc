#include "meshes/generation/pad_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "triangulated_ellipsoid.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

struct NamedPad {
  std::string name;
  std::shared_ptr<const PadSurface> pad;
  std::function<double(const Vector3d&)> level;  ///< 0 on the surface, of order 1 around it
};

std::vector<NamedPad> pads() {
  std::vector<NamedPad> all;
  const double angle = 0.4, c = std::cos(angle), s = std::sin(angle);
  all.push_back({"paraboloid", paraboloid_pad(3, 1.5, angle), [=](const Vector3d& p) {
                   const double u = c * p.x() + s * p.y(), v = c * p.y() - s * p.x();
                   return u * u / 6 + v * v / 3 + p.z();
                 }});
  all.push_back({"ridge", paraboloid_pad(kInfinity, 1.5),
                 [](const Vector3d& p) { return p.y() * p.y() / 3 + p.z(); }});
  all.push_back({"sphere", sphere_pad(2),
                 [](const Vector3d& p) { return (p + Vector3d(0, 0, 2)).squaredNorm() / 4 - 1; }});
  all.push_back({"ellipsoid", ellipsoid_pad(3, 1.5, 2.5, angle), [=](const Vector3d& p) {
                   const double u = c * p.x() + s * p.y(), v = c * p.y() - s * p.x();
                   return u * u / 7.5 + v * v / 3.75 + std::pow(p.z() / 2.5 + 1, 2) - 1;
                 }});
  all.push_back({"tapered", tapered_pad(3, 1.5, 0.3), [](const Vector3d& p) {
                   return p.x() * p.x() / 6 + p.y() * p.y() / (3 * (1 - 0.3 * p.x())) +
                          p.z() * p.z() / 3 + p.z();
                 }});
  return all;
}

TEST(PadSurface, PointsSatisfyTheEquationAndNormalsItsGradient) {
  const double round_off = 1e-12, step = 1e-5;
  for (const auto& [name, pad, level] : pads())
    for (double turn = 0; turn < 6.2; turn += 0.3)
      for (double tilt = 0; tilt < 1.5; tilt += 0.1) {
        const Vector3d direction(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn),
                                 std::cos(tilt));
        const Vector3d from(0.1, -0.2, -1);
        const auto hit = pad->meet(from, direction);
        // A line that leans this way never leaves a straight ridge.
        if (!hit && name == "ridge") continue;
        ASSERT_TRUE(hit) << name;
        EXPECT_NEAR(level(hit->point), 0, round_off * std::max(1.0, hit->point.squaredNorm()))
            << name;
        EXPECT_LT((hit->point - from).cross(direction).norm(),
                  round_off * hit->point.norm() + 1e-15);
        Vector3d gradient;
        for (int i = 0; i < 3; ++i)
          gradient[i] = level(hit->point + step * Vector3d::Unit(i)) -
                        level(hit->point - step * Vector3d::Unit(i));
        // Central differences: step² times the third derivative, and round-off over the step.
        EXPECT_LT((hit->normal - gradient.normalized()).norm(), 1e-9) << name;
        EXPECT_GT(hit->normal.dot(direction), 0);
      }
}

TEST(PadSurface, IsTheSameFromInsideAndFromOutside) {
  const Vector3d from(0.1, -0.2, -1), direction = Vector3d(0.3, 0.5, 1).normalized();
  for (const auto& [name, pad, level] : pads()) {
    const auto one = pad->meet(from, direction), two = pad->meet(from + 7 * direction, direction),
               longer = pad->meet(from, 5 * direction);
    ASSERT_TRUE(one && two && longer) << name;
    EXPECT_LT((one->point - two->point).norm(), 1e-12) << name;
    EXPECT_LT((one->point - longer->point).norm(), 1e-12) << name;
    EXPECT_FALSE(pad->meet({0, 0, 1}, {0, 1, 0})) << name;  // passes above
    EXPECT_FALSE(pad->meet({0, 100, 1}, {0, 1, 0})) << name;
  }
  EXPECT_FALSE(paraboloid_pad(3, 1.5)->meet({0, 0, -1}, {0, 0, -1}));  // open below
  EXPECT_FALSE(tapered_pad(3, 1.5, 0.3)->meet({9, 0, -1}, {0, 0, 1}));
}

TEST(PadSurface, TaperIsTheRelativeChangeOfTheCrossSectionsRadius) {
  const double taper = 0.3, radius_x = 3, radius_y = 1.5;
  const auto pad = tapered_pad(radius_x, radius_y, taper);
  const double length2 = radius_x * radius_y, step = 1e-3;
  const auto height = [&](double x, double y) {
    return pad->meet({x, y, -1}, Vector3d::UnitZ())->point.z();
  };
  for (const double x : {-1.5, -0.5, 0.0, 0.5, 1.5}) {
    const double radius = step * step / (2 * (height(x, 0) - height(x, step)));
    const double exact = radius_y * (1 - taper * x) * std::sqrt(1 - x * x / length2);
    // The section's next order is (step / radius)² / 4; the rest is round-off over step².
    EXPECT_NEAR(radius / exact, 1, step * step / (exact * exact) + 1e-9) << x;
  }
}

TEST(PadSurface, KnowsItsRadiiAndSymmetries) {
  const auto turned = paraboloid_pad(3, 1.5, kPi / 2);
  EXPECT_NEAR(turned->radius_x(), 1.5, 1e-15);
  EXPECT_NEAR(turned->radius_y(), 3, 1e-15);
  EXPECT_FALSE(turned->symmetric_x());
  const auto oblique = ellipsoid_pad(3, 1.5, 2, kPi / 4);
  EXPECT_NEAR(oblique->radius_x(), 2, 1e-15);  // Euler: 1/R = (1/3 + 1/1.5) / 2
  EXPECT_EQ(oblique->smallest_radius(), 1.5);
  const auto tapered = tapered_pad(3, 1.5, 0.3);
  EXPECT_FALSE(tapered->symmetric_x());
  EXPECT_TRUE(tapered->symmetric_y());
  for (const auto& pad : {paraboloid_pad(3, kInfinity), ellipsoid_pad(3, 1), sphere_pad(1)})
    EXPECT_TRUE(pad->symmetric_x() && pad->symmetric_y());
}

TEST(PadSurface, RefusesShapesThatAreNotConvex) {
  EXPECT_THROW(paraboloid_pad(-1, 1), InputError);
  EXPECT_THROW(paraboloid_pad(1, std::nan("")), InputError);
  EXPECT_THROW(paraboloid_pad(1, 1, kInfinity), InputError);
  EXPECT_THROW(ellipsoid_pad(kInfinity, kInfinity), InputError);
  EXPECT_THROW(ellipsoid_pad(1, 1, -1), InputError);
  EXPECT_THROW(sphere_pad(0), InputError);
  EXPECT_NO_THROW(tapered_pad(4, 1, 0.499));  // A = 2
  EXPECT_THROW(tapered_pad(4, 1, 0.5), InputError);
  EXPECT_THROW(tapered_pad(kInfinity, 1, 0), InputError);
}

TEST(TriangulatedPad, FindsWhatATestOfEachTriangleFinds) {
  // A ball with a bumpy skin, so that lines cross it several times; the frame is the body's own.
  const int n = 12;
  TriangleSurface bumpy = triangulated_ellipsoid({1, 1, 1}, {0, 0, 0}, n);
  for (Vector3d& v : bumpy.vertices_m)
    v *= 1 + 0.3 * std::sin(9 * v.x()) * std::sin(8 * v.y()) * (v.z() < 0.99);
  const auto pad = triangulated_pad(bumpy, {{0, 0, 1}, {0, 0, 1}, {1, 0, 0}});
  std::mt19937 random(7);
  const auto number = [&] { return random() / 2147483648.0 - 1; };
  int hits = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vector3d from(2 * number(), 2 * number(), 2 * number() - 1);
    const Vector3d direction = Vector3d(number(), number(), number()).normalized();
    double best = kInfinity;
    for (const auto& [i, j, l] : bumpy.triangles) {
      Eigen::Matrix3d columns;  // from + t direction = a + b (j - i) + c (l - i)
      const Vector3d a = bumpy.vertices_m[i] - Vector3d::UnitZ();
      columns << bumpy.vertices_m[j] - bumpy.vertices_m[i],
          bumpy.vertices_m[l] - bumpy.vertices_m[i], -direction;
      if (columns.col(0).cross(columns.col(1)).dot(direction) <= 0) continue;
      const Vector3d solution = columns.inverse() * (from - a);
      if (solution[0] >= 0 && solution[1] >= 0 && solution[0] + solution[1] <= 1 &&
          std::abs(solution[2]) < std::abs(best))
        best = solution[2];
    }
    const auto hit = pad->meet(from, direction);
    ASSERT_EQ(hit.has_value(), std::isfinite(best)) << k;
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR((hit->point - from).dot(direction), best, 1e-10);
    EXPECT_NEAR(hit->normal.norm(), 1, 1e-15);
  }
  EXPECT_GT(hits, 500);
}

TEST(TriangulatedPad, StandsInTheContactFrame) {
  // Contact at the end of the body's y axis, its z becomes the contact's x.
  const Vector3d centre(5, 6, 7), axes(1.5, 1, 3);
  const auto body = triangulated_ellipsoid(axes, centre, 40);
  const double edge = longest_edge(body), chord = edge * edge / 2;  // smallest radius: over 1/3
  SurfacePlacement placement{centre + Vector3d(0, 1.02, 0), {0, 3, 0}, {0, 0.5, 2}};
  const Vector3d along(0.8, 0, -1), across(0, 0.8, -1);
  const auto reach = [](const PadSurface& pad, const Vector3d& p) {
    return pad.meet({0, 0, -1}, p - Vector3d(0, 0, -1))->point.head<2>().norm();
  };
  const auto pad = triangulated_pad(body, placement);
  EXPECT_NEAR(pad->meet({0, 0, -1}, Vector3d::UnitZ())->point.norm(), 0, 1e-12);
  EXPECT_NEAR(reach(*pad, along), 3, 3 * chord);
  EXPECT_NEAR(reach(*pad, across), 1.5, 3 * chord);
  placement.angle_rad = kPi / 2;  // the body's long axis now lies along y
  const auto turned = triangulated_pad(body, placement);
  EXPECT_NEAR(reach(*turned, along), 1.5, 3 * chord);
  EXPECT_NEAR(reach(*turned, across), 3, 3 * chord);
}

TEST(TriangulatedPad, RefusesWhatCannotBePlaced) {
  const auto ball = triangulated_ellipsoid({1, 1, 1}, {0, 0, 0}, 8);
  const Vector3d top(0, 0, 1), up(0, 0, 1), x(1, 0, 0);
  EXPECT_NO_THROW(triangulated_pad(ball, {top, up, x}));
  EXPECT_THROW(triangulated_pad({}, {top, up, x}), InputError);
  EXPECT_THROW(triangulated_pad(ball, {top, -up, x}), InputError);
  EXPECT_THROW(triangulated_pad(ball, {top, up, up}), InputError);
  EXPECT_THROW(triangulated_pad(ball, {top, {0, 0, 0}, x}), InputError);
  EXPECT_THROW(triangulated_pad(ball, {1.5 * top, up, x}), InputError);
  EXPECT_THROW(triangulated_pad(ball, {{0, 0, std::nan("")}, up, x}), InputError);
  EXPECT_THROW(triangulated_pad(ball, {top, up, x}, 0, 1), InputError);
}

}  // namespace
}  // namespace softfinger::meshes
