#include "fem/contact/contact_edge.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace softfinger::fem {

using Eigen::Index;
using Eigen::Vector2d;

double ContactEdge::radius(double angle_rad) const {
  double rho = 1;
  for (Index k = 0; k < cosine.size(); ++k)
    rho += cosine[k] * std::cos(static_cast<double>(k) * angle_rad);
  for (Index k = 0; k < sine.size(); ++k)
    rho += sine[k] * std::sin(static_cast<double>(k) * angle_rad);
  return rho;
}

Vector2d ContactEdge::at(double angle_rad, double fraction) const {
  const double reach = fraction * radius(angle_rad);
  return centre + Vector2d(a * reach * std::cos(angle_rad), b * reach * std::sin(angle_rad));
}

Eigen::Matrix2Xd ContactEdge::outline(Index points) const {
  Eigen::Matrix2Xd result(2, points);
  for (Index i = 0; i < points; ++i)
    result.col(i) = at(2 * M_PI * static_cast<double>(i) / static_cast<double>(points));
  return result;
}

namespace {

/// Integrals of 1, (x, y) and (x², x y, y²) over what polygons enclose, by Green's theorem.
struct AreaIntegrals {
  double area = 0;
  Vector2d first = Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();

  void add(const Eigen::Matrix2Xd& polygon) {
    for (Index i = 0; i < polygon.cols(); ++i) {
      const Vector2d p = polygon.col(i), q = polygon.col((i + 1) % polygon.cols());
      const double twice_area = p.x() * q.y() - q.x() * p.y();  // of the triangle with the origin
      area += twice_area / 2;
      first += twice_area / 6 * (p + q);
      second +=
          twice_area / 24 * (p * p.transpose() + q * q.transpose() + (p + q) * (p + q).transpose());
    }
  }
};

/// Distance of a point from an ellipse along the axes, along the ray from its centre: as good as
/// the nearest distance for points near a curve that is not very long.
double distance(const Vector2d& point, double a, double b) {
  const double level = std::hypot(point.x() / a, point.y() / b);
  if (level == 0) return b;
  const Vector2d gradient(point.x() / (a * a), point.y() / (b * b));
  return std::abs(level - 1) * level / gradient.norm();
}

}  // namespace

OutlineShape shape_of(const std::vector<Eigen::Matrix2Xd>& outlines) {
  AreaIntegrals integrals;
  for (const Eigen::Matrix2Xd& outline : outlines) integrals.add(outline);
  OutlineShape shape;
  shape.area = integrals.area;
  if (!(shape.area > 0)) return shape;
  shape.centre = integrals.first / shape.area;
  const Eigen::Matrix2d variance =
      integrals.second / shape.area - shape.centre * shape.centre.transpose();
  // Mohr's circle.
  const double middle = variance.trace() / 2;
  const double half_difference = (variance(0, 0) - variance(1, 1)) / 2;
  const double spread = std::hypot(half_difference, variance(0, 1));
  const double stretch =
      std::pow((middle + spread) / std::max(middle - spread, 1e-12 * middle), 0.25);
  const double mean = std::sqrt(shape.area / M_PI);
  shape.a = mean * stretch;
  shape.b = mean / stretch;
  shape.turn_rad = spread > 0 ? std::atan2(variance(0, 1), half_difference) / 2 : 0;
  const double c = std::cos(shape.turn_rad), s = std::sin(shape.turn_rad);
  for (const Eigen::Matrix2Xd& outline : outlines)
    for (Index i = 0; i < outline.cols(); ++i) {
      const Vector2d from = outline.col(i) - shape.centre;
      const Vector2d along(c * from.x() + s * from.y(), c * from.y() - s * from.x());
      shape.departure = std::max(shape.departure, distance(along, shape.a, shape.b) / shape.b);
    }
  return shape;
}

Eigen::Matrix2Xd moved_left(const Eigen::Matrix2Xd& outline, double distance) {
  const Index points = outline.cols();
  Eigen::Matrix2Xd moved = outline;
  for (Index i = 0; i < points; ++i) {
    const Vector2d along = outline.col((i + 1) % points) - outline.col((i + points - 1) % points);
    if (const double length = along.norm(); length > 0)
      moved.col(i) += distance / length * Vector2d(-along.y(), along.x());
  }
  return moved;
}

std::optional<ContactEdge> smooth_edge(const Eigen::Matrix2Xd& outline, int harmonics,
                                       double tolerance) {
  const Index points = outline.cols(), unknowns = 2 * harmonics + 1;
  const OutlineShape shape = shape_of({outline});
  if (points < 2 * unknowns || !(shape.area > 0)) return std::nullopt;
  ContactEdge edge;
  edge.centre = shape.centre;
  const Eigen::Matrix2Xd from = outline.colwise() - shape.centre;
  // Semi-axes along x and y of the ellipse with these second moments.
  const double c = std::cos(shape.turn_rad), s = std::sin(shape.turn_rad);
  edge.a = std::hypot(shape.a * c, shape.b * s);
  edge.b = std::hypot(shape.a * s, shape.b * c);
  Eigen::MatrixXd terms(points, unknowns);
  Eigen::VectorXd radii(points);
  double turned = 0, before = 0;
  for (Index i = 0; i < points; ++i) {
    const double angle = std::atan2(from(1, i) / edge.b, from(0, i) / edge.a);
    if (i > 0) turned += std::remainder(angle - before, 2 * M_PI);
    if (i > 0 && std::remainder(angle - before, 2 * M_PI) < -0.1) return std::nullopt;
    before = angle;
    radii[i] = std::hypot(from(0, i) / edge.a, from(1, i) / edge.b) - 1;
    terms(i, 0) = 1;
    for (int k = 1; k <= harmonics; ++k) {
      terms(i, 2 * k - 1) = std::cos(k * angle);
      terms(i, 2 * k) = std::sin(k * angle);
    }
  }
  if (!(turned > M_PI)) return std::nullopt;
  const Eigen::VectorXd found = terms.householderQr().solve(radii);
  const double off = (terms * found - radii).norm() / std::sqrt(static_cast<double>(points));
  if (!(off <= tolerance)) return std::nullopt;
  edge.cosine = edge.sine = Eigen::VectorXd::Zero(harmonics + 1);
  edge.cosine[0] = found[0];
  for (int k = 1; k <= harmonics; ++k) {
    edge.cosine[k] = found[2 * k - 1];
    edge.sine[k] = found[2 * k];
  }
  return edge;
}

}  // namespace softfinger::fem
