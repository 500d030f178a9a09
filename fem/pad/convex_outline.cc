#include "fem/pad/convex_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fem/base/formatted.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

double cross(const Eigen::Vector2d& one, const Eigen::Vector2d& other) {
  return one.x() * other.y() - one.y() * other.x();
}

Eigen::Vector2d turned(const Eigen::Vector2d& vector, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * vector.x() - s * vector.y(), s * vector.x() + c * vector.y()};
}

double distance_to_segment(const Eigen::Vector2d& point, const Eigen::Vector2d& from,
                           const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = to - from;
  const double squared = along.squaredNorm();
  const double share =
      squared > 0 ? std::clamp((point - from).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (point - from - share * along).norm();
}

/// Returns twice the area that a closed line of points encloses, positive if it runs
/// counter-clockwise.
double twice_area(const std::vector<Eigen::Vector2d>& points) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    sum += cross(points[i], points[(i + 1) % points.size()]);
  return sum;
}

}  // namespace

ConvexOutline ConvexOutline::disc(double radius) {
  return rectangle(2 * radius, 2 * radius, radius);
}

ConvexOutline ConvexOutline::rectangle(double length_x, double length_y, double rounding) {
  ConvexOutline outline;
  const double x = std::max(0.0, length_x / 2 - rounding);
  const double y = std::max(0.0, length_y / 2 - rounding);
  outline.corner_ = {{x, y}, {-x, y}, {-x, -y}, {x, -y}};
  outline.normal_ = {{0, 1}, {-1, 0}, {0, -1}, {1, 0}};
  outline.rounding_ = rounding;
  outline.symmetric_ = true;
  return outline;
}

ConvexOutline ConvexOutline::polygon(std::vector<Eigen::Vector2d> points, const std::string& where,
                                     const std::string& field) {
  const auto text = [](std::size_t number, const Eigen::Vector2d& point) {
    return formatted("point %zu at (%g, %g) m", number + 1, point.x(), point.y());
  };
  if (points.size() < 3)
    throw InputError(where, field, formatted("%zu points", points.size()), "3 points or more");
  Eigen::Vector2d low = points.front(), high = low;
  for (const Eigen::Vector2d& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const double size = (high - low).norm();
  constexpr double same = 1e-6;  // of the size: closer points are one
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!((points[i] - points[(i + 1) % points.size()]).norm() > same * size))
      throw InputError(where, field, text((i + 1) % points.size(), points[(i + 1) % points.size()]),
                       "no point twice (the outline closes by itself)");
  constexpr double least_area = 1e-6;  // of the size squared
  if (!(std::abs(twice_area(points)) > least_area * size * size))
    throw InputError(where, field, "no area enclosed",
                     "a convex outline that runs around once and does not cross itself");
  const std::vector<Eigen::Vector2d> given = points;
  if (twice_area(points) < 0) std::reverse(points.begin(), points.end());
  const auto number_of = [&](const Eigen::Vector2d& point) {
    return static_cast<std::size_t>(std::find(given.begin(), given.end(), point) - given.begin());
  };
  // Points on a straight side tell nothing.
  std::vector<Eigen::Vector2d> corners;
  double turning_rad = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& point = points[i];
    const Eigen::Vector2d in = point - points[(i + points.size() - 1) % points.size()];
    const Eigen::Vector2d out = points[(i + 1) % points.size()] - point;
    const double angle_rad = std::atan2(cross(in, out), in.dot(out));
    constexpr double straight_rad = 1e-6;
    if (std::abs(angle_rad) < straight_rad) continue;
    if (angle_rad < 0)
      throw InputError(where, field, "not convex at " + text(number_of(point), point),
                       "a convex outline, its points in order around it");
    turning_rad += angle_rad;
    corners.push_back(point);
  }
  constexpr double once = 1.5 * 2 * kPi;
  if (turning_rad > once || corners.size() < 3)
    throw InputError(where, field, "it crosses itself", "a convex outline that runs around once");
  ConvexOutline outline;
  outline.corner_ = corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d along = (corners[(i + 1) % corners.size()] - corners[i]).normalized();
    outline.normal_.emplace_back(along.y(), -along.x());
  }
  return outline;
}

ConvexOutline ConvexOutline::expanded(double distance) const {
  ConvexOutline result = *this;
  result.rounding_ += distance;
  return result;
}

ConvexOutline ConvexOutline::scaled(double factor) const {
  ConvexOutline result = *this;
  for (Eigen::Vector2d& corner : result.corner_) corner *= factor;
  result.rounding_ *= factor;
  return result;
}

ConvexOutline ConvexOutline::placed(const Eigen::Vector2d& offset, double angle_rad) const {
  ConvexOutline result = *this;
  for (Eigen::Vector2d& corner : result.corner_) corner = turned(corner, angle_rad) + offset;
  for (Eigen::Vector2d& normal : result.normal_) normal = turned(normal, angle_rad);
  // A disc's corners may be turned, too: they decide where cells lie, and are left as they were.
  const bool is_disc = (corner_[0] - corner_[2]).norm() == 0;
  if (is_disc) result.normal_ = normal_;
  result.symmetric_ = symmetric_ && offset.norm() == 0 && (is_disc || angle_rad == 0);
  return result;
}

double ConvexOutline::area() const {
  double around = 0;
  for (std::size_t i = 0; i < corner_.size(); ++i)
    around += (corner_[(i + 1) % corner_.size()] - corner_[i]).norm();
  return twice_area(corner_) / 2 + rounding_ * around + kPi * rounding_ * rounding_;
}

Eigen::Vector2d ConvexOutline::centroid() const {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : corner_) mean += corner / static_cast<double>(corners());
  // Rounded outlines are symmetric about the mean of their corners.
  if (is_rounded()) return mean;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  double area = 0;
  for (std::size_t i = 0; i < corner_.size(); ++i) {
    const Eigen::Vector2d one = corner_[i] - mean, other = corner_[(i + 1) % corner_.size()] - mean;
    area += cross(one, other) / 2;
    moment += cross(one, other) / 2 * (one + other) / 3;
  }
  return mean + moment / area;
}

double ConvexOutline::distance(const Eigen::Vector2d& point) const {
  double beyond = -std::numeric_limits<double>::infinity(), nearest = -beyond;
  for (std::size_t i = 0; i < corner_.size(); ++i) {
    beyond = std::max(beyond, normal_[i].dot(point - corner_[i]));
    nearest = std::min(nearest,
                       distance_to_segment(point, corner_[i], corner_[(i + 1) % corner_.size()]));
  }
  return (beyond <= 0 ? beyond : nearest) - rounding_;
}

double ConvexOutline::along_ray(const Eigen::Vector2d& point,
                                const Eigen::Vector2d& direction) const {
  double inside = 0, outside = 2 * largest_width();
  constexpr int halvings = 60;
  for (int i = 0; i < halvings; ++i) {
    const double middle = (inside + outside) / 2;
    (distance(point + middle * direction) < 0 ? inside : outside) = middle;
  }
  return (inside + outside) / 2;
}

double ConvexOutline::width(const Eigen::Vector2d& direction) const {
  double low = corner_.front().dot(direction), high = low;
  for (const Eigen::Vector2d& corner : corner_) {
    low = std::min(low, corner.dot(direction));
    high = std::max(high, corner.dot(direction));
  }
  return high - low + 2 * rounding_;
}

double ConvexOutline::largest_width() const {
  double largest = 0;
  for (const Eigen::Vector2d& one : corner_)
    for (const Eigen::Vector2d& other : corner_) largest = std::max(largest, (one - other).norm());
  return largest + 2 * rounding_;
}

double ConvexOutline::smallest_width() const {
  // It is reached across one of the sides.
  double smallest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& normal : normal_) smallest = std::min(smallest, width(normal));
  return smallest;
}

double ConvexOutline::turn(int corner) const {
  const Eigen::Vector2d &in = normal_[before(corner)], &out = normal_[at(corner)];
  return std::atan2(cross(in, out), in.dot(out));
}

Eigen::Vector2d ConvexOutline::on_rounding(int corner, double share) const {
  return corner_[at(corner)] + rounding_ * turned(normal_[before(corner)], share * turn(corner));
}

Eigen::Vector2d ConvexOutline::side_middle(int corner) const {
  return (corner_[before(corner)] + corner_[at(corner)]) / 2 + rounding_ * normal_[before(corner)];
}

Eigen::Vector2d ConvexOutline::corner_middle(int corner) const { return on_rounding(corner, 0.5); }

Eigen::Vector2d ConvexOutline::to_corner(int corner, double share, double straight) const {
  if (share >= straight && straight < 1)
    return on_rounding(corner, 0.5 * (share - straight) / (1 - straight));
  const Eigen::Vector2d from = side_middle(corner), to = on_rounding(corner, 0);
  return from + share / straight * (to - from);
}

Eigen::Vector2d ConvexOutline::from_corner(int corner, double share, double straight) const {
  const double left = 1 - share;
  if (left >= straight && straight < 1)
    return on_rounding(corner, 1 - 0.5 * (left - straight) / (1 - straight));
  const Eigen::Vector2d from = side_middle(corner + 1), to = on_rounding(corner, 1);
  return from + left / straight * (to - from);
}

Eigen::Vector2d ConvexOutline::lengths_to_corner(int corner) const {
  return {(corner_[at(corner)] - corner_[before(corner)]).norm() / 2, rounding_ * turn(corner) / 2};
}

Eigen::Vector2d ConvexOutline::lengths_from_corner(int corner) const {
  return {(corner_[at(corner + 1)] - corner_[at(corner)]).norm() / 2, rounding_ * turn(corner) / 2};
}

}  // namespace softfinger::fem
