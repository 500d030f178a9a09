#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "sample_surfaces.h"
#include "softfinger/input/triangle_surface.h"

/// Quadrics under noise, on random points: the surfaces that a fit meets in practice.
namespace softfinger::samples {

/// Delaunay triangulation of points in the plane, counter-clockwise (Bowyer 1981, Watson 1981:
/// every point in turn replaces the triangles whose circumcircle holds it). Quadratic in the number
/// of points.
inline std::vector<std::array<int, 3>> delaunay(std::vector<Eigen::Vector2d> points) {
  const int count = static_cast<int>(points.size());
  double size = 0;
  for (const auto& p : points) size = std::max(size, p.norm());
  // So large that hardly a triangle of the hull is lost to its corners.
  const double far = 1e4 * size;
  points.insert(points.end(), {{-far, -far}, {far, -far}, {0, far}});
  struct Triangle {
    std::array<int, 3> corners;
    Eigen::Vector2d centre;
    double radius2;
  };
  const auto make = [&](int a, int b, int c) {
    const Eigen::Vector2d ab = points[b] - points[a], ac = points[c] - points[a];
    const double twice = 2 * (ab.x() * ac.y() - ab.y() * ac.x());
    const Eigen::Vector2d offset((ac.y() * ab.squaredNorm() - ab.y() * ac.squaredNorm()) / twice,
                                 (ab.x() * ac.squaredNorm() - ac.x() * ab.squaredNorm()) / twice);
    return Triangle{{a, b, c}, points[a] + offset, offset.squaredNorm()};
  };
  std::vector<Triangle> triangles{make(count, count + 1, count + 2)};
  for (int p = 0; p < count; ++p) {
    std::map<std::pair<int, int>, int> border;  // edges of the hole as it is run through
    std::vector<Triangle> left;
    for (const Triangle& t : triangles) {
      if ((points[p] - t.centre).squaredNorm() >= t.radius2) {
        left.push_back(t);
        continue;
      }
      for (std::size_t i = 0; i < 3; ++i) {
        const int a = t.corners[i], b = t.corners[(i + 1) % 3];
        if (border.erase({b, a}) == 0) border[{a, b}] = 0;
      }
    }
    for (const auto& edge : border) left.push_back(make(edge.first.first, edge.first.second, p));
    triangles = std::move(left);
  }
  std::vector<std::array<int, 3>> result;
  for (const Triangle& t : triangles)
    if (*std::max_element(t.corners.begin(), t.corners.end()) < count) result.push_back(t.corners);
  return result;
}

/// The length that a noise of, say, 1 % refers to.
enum class NoiseScale { none, spacing, sagitta, region_radius, own_depth, curvature_radius };

/// A noisy quadric on random points around the origin, facing +z, and where to fit it.
struct RandomQuadric {
  TriangleSurface surface;
  std::array<double, 2> radii_m;  ///< the larger one first
  double region_radius_m = 0;
};

struct RandomQuadricOptions {
  NoiseScale noise = NoiseScale::spacing;
  double noise_level = 0.01;
  int fewest_points = 30, most_points = 300;
  double largest_ratio = 5;  ///< of the radii, logarithmically uniform from 1
  bool umbilic = false;
  bool square = false;          ///< points in a square instead of a disc
  double points_beyond = 1;     ///< radius of the disc over that of the region
  bool noise_in_space = false;  ///< instead of along z only
  bool vertex_at_contact = false;
};

inline RandomQuadric random_quadric(std::mt19937& random, const RandomQuadricOptions& options) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  RandomQuadric result;
  const double minor = 10e-3;  // a quadric's shape has no scale of its own
  const double major =
      options.umbilic ? minor : minor * std::pow(options.largest_ratio, unit(random));
  result.radii_m = {major, minor};
  result.region_radius_m = minor * (0.2 + 0.5 * unit(random));
  const double width = result.region_radius_m * options.points_beyond;
  const int count = static_cast<int>(std::lround(
      options.fewest_points *
      std::pow(static_cast<double>(options.most_points) / options.fewest_points, unit(random))));
  const double turn = kPi * unit(random), c = std::cos(turn), s = std::sin(turn);
  std::vector<Eigen::Vector2d> points;
  if (options.vertex_at_contact) points.emplace_back(0, 0);
  while (static_cast<int>(points.size()) < count) {
    const Eigen::Vector2d p(2 * unit(random) - 1, 2 * unit(random) - 1);
    if (options.square || p.norm() <= 1) points.push_back(width * p);
  }
  const double area = options.square ? 4 * width * width : kPi * width * width;
  const double sagitta = result.region_radius_m * result.region_radius_m / (2 * minor);
  for (const auto& p : points) {
    const double u = c * p.x() + s * p.y(), v = c * p.y() - s * p.x();
    const double depth = (u * u / major + v * v / minor) / 2;
    double scale = 0;
    switch (options.noise) {
      case NoiseScale::none:
        break;
      case NoiseScale::spacing:
        scale = std::sqrt(area / count);
        break;
      case NoiseScale::sagitta:
        scale = sagitta;
        break;
      case NoiseScale::region_radius:
        scale = result.region_radius_m;
        break;
      case NoiseScale::own_depth:
        scale = depth;
        break;
      case NoiseScale::curvature_radius:
        scale = minor;
        break;
    }
    const double noise = options.noise_level * scale;
    Eigen::Vector3d vertex(p.x(), p.y(), -depth + noise * normal(random));
    if (options.noise_in_space)
      vertex += Eigen::Vector3d(noise * normal(random), noise * normal(random), 0);
    result.surface.vertices_m.push_back(vertex);
  }
  result.surface.triangles = delaunay(points);
  return result;
}

}  // namespace softfinger::samples
