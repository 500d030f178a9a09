#include "softfinger/pads/convex_outline.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pads/outline_refusal.h"

namespace softfinger {
namespace {

using Eigen::Vector2d;

double outline_cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Drops vertices that repeat their neighbour or lie straight between two.
std::vector<Vector2d> without_idle_vertices(const std::vector<Vector2d>& vertices, double size) {
  constexpr double kSame = 1e-9;
  std::vector<Vector2d> kept;
  for (const Vector2d& vertex : vertices)
    if (kept.empty() || (vertex - kept.back()).norm() > kSame * size) kept.push_back(vertex);
  while (kept.size() > 1 && (kept.front() - kept.back()).norm() <= kSame * size) kept.pop_back();
  std::vector<Vector2d> corners;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Vector2d before = kept[i] - kept[(i + kept.size() - 1) % kept.size()];
    const Vector2d after = kept[(i + 1) % kept.size()] - kept[i];
    const double turn = outline_cross(before, after) / (before.norm() * after.norm());
    if (std::abs(turn) > kSame || before.dot(after) < 0) corners.push_back(kept[i]);
  }
  return corners;
}

double extent_of(const std::vector<Vector2d>& vertices) {
  Vector2d least = vertices.front(), largest = least;
  for (const Vector2d& vertex : vertices) {
    least = least.cwiseMin(vertex);
    largest = largest.cwiseMax(vertex);
  }
  return (largest - least).norm();
}

/// The part of a convex polygon to the left of a directed line.
std::vector<Vector2d> cut_by_line(const std::vector<Vector2d>& polygon, const Vector2d& from,
                                  const Vector2d& direction) {
  std::vector<Vector2d> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &here = polygon[i], &next = polygon[(i + 1) % polygon.size()];
    const double left = outline_cross(direction, here - from);
    const double left_next = outline_cross(direction, next - from);
    if (left >= 0) kept.push_back(here);
    if ((left > 0 && left_next < 0) || (left < 0 && left_next > 0))
      kept.push_back(here + left / (left - left_next) * (next - here));
  }
  return kept;
}

/// int r dA over the triangle of the origin and an edge, signed: (h³/6) [tan sec + asinh tan].
double radius_integral_of_triangle(const Vector2d& from, const Vector2d& to) {
  const Vector2d edge = to - from;
  const double length = edge.norm(), height = outline_cross(from, to) / length;
  if (height == 0 || !std::isfinite(height)) return 0;
  const auto part = [&](const Vector2d& end) {
    const double along = end.dot(edge) / length;
    return along * end.norm() + height * height * std::asinh(along / std::abs(height));
  };
  return height / 6 * (part(to) - part(from));
}

constexpr int kDiscCorners = 40, kChordsOfCorner = 4;

}  // namespace

ConvexOutline::ConvexOutline(std::vector<Vector2d> counter_clockwise_m)
    : vertices_m_(std::move(counter_clockwise_m)) {
  // About the first vertex, so that an outline far from the origin loses no digits.
  const Vector2d origin = vertices_m_.front();
  const std::size_t count = vertices_m_.size();
  Vector2d first = Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  least_width_m_ = kInfinity;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d from = vertices_m_[i] - origin, to = vertices_m_[(i + 1) % count] - origin;
    const double twice = outline_cross(from, to);
    area_m2_ += twice / 2;
    perimeter_m_ += (to - from).norm();
    first += twice / 6 * (from + to);
    second +=
        twice / 24 *
        (from * from.transpose() + to * to.transpose() + (from + to) * (from + to).transpose());
    double width = 0;
    for (const Vector2d& vertex : vertices_m_) {
      width =
          std::max(width, outline_cross(to - from, vertex - origin - from) / (to - from).norm());
      largest_width_m_ = std::max(largest_width_m_, (vertex - vertices_m_[i]).norm());
    }
    least_width_m_ = std::min(least_width_m_, width);
  }
  centroid_m_ = origin + first / area_m2_;
  const Vector2d shift = first / area_m2_;
  second_moments_m4_ = second - area_m2_ * shift * shift.transpose();
}

ConvexOutline ConvexOutline::polygon(std::vector<Vector2d> vertices_m) {
  const char* const convex = "a convex outline of at least three points, in order around it";
  for (const Vector2d& vertex : vertices_m)
    if (!vertex.allFinite()) refuse_outline("points", "not finite", convex);
  if (vertices_m.size() < 3) refuse_outline("points", std::to_string(vertices_m.size()), convex);
  const double size = extent_of(vertices_m);
  std::vector<Vector2d> corners = without_idle_vertices(vertices_m, size);
  double twice_area = 0, turned = 0;
  int left = 0, right = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d& here = corners[i];
    const Vector2d before = here - corners[(i + corners.size() - 1) % corners.size()];
    const Vector2d after = corners[(i + 1) % corners.size()] - here;
    twice_area += outline_cross(here - corners[0], here + after - corners[0]);
    const double turn = std::atan2(outline_cross(before, after), before.dot(after));
    turned += turn;
    (turn > 0 ? left : right) += 1;
  }
  if (corners.size() < 3) refuse_outline("points", "a line without an area", convex);
  if (left > 0 && right > 0)
    refuse_outline("points", "an outline that crosses itself or has a hollow corner", convex);
  if (!(std::abs(twice_area) > 1e-12 * size * size)) refuse_outline("points", "no area", convex);
  if (std::abs(std::abs(turned) - 2 * kPi) > 1e-6)
    refuse_outline("points", "an outline that runs around more than once", convex);
  if (twice_area < 0) std::reverse(corners.begin(), corners.end());
  return ConvexOutline(std::move(corners));
}

ConvexOutline ConvexOutline::disc(double diameter_m) {
  // The circumscribed radius of the regular polygon with the circle's area.
  const double radius_m =
      diameter_m / 2 * std::sqrt(2 * kPi / kDiscCorners / std::sin(2 * kPi / kDiscCorners));
  std::vector<Vector2d> vertices;
  for (int i = 0; i < kDiscCorners; ++i) {
    const double angle = 2 * kPi * (i + 0.5) / kDiscCorners;
    vertices.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle));
  }
  return polygon(std::move(vertices));
}

ConvexOutline ConvexOutline::rounded_rectangle(double length_m, double width_m,
                                               double corner_radius_m) {
  const double most = std::min(length_m, width_m) / 2;
  if (!(length_m > 0) || !(width_m > 0) || !std::isfinite(length_m) || !std::isfinite(width_m))
    refuse_outline("sides", internal::number_text(std::min(length_m, width_m), 6),
                   "finite numbers > 0");
  if (!(corner_radius_m >= 0) || corner_radius_m > most)
    refuse_outline("corner radius", internal::number_text(corner_radius_m, 6),
                   "0 to half of the shorter side, " + internal::number_text(most, 6));
  const double x = length_m / 2 - corner_radius_m, y = width_m / 2 - corner_radius_m;
  std::vector<Vector2d> vertices;
  const double step = kPi / 2 / kChordsOfCorner;
  // The arc's ends stay where they are, so that the sides keep their length; the points between are
  // moved outwards until the corner has the arc's area, sin(step) (r R + R²) = pi/4 r².
  const double radius_m = corner_radius_m * (std::sqrt(1 + kPi / std::sin(step)) - 1) / 2;
  for (int corner = 0; corner < 4; ++corner) {
    const Vector2d middle((corner == 0 || corner == 3 ? 1 : -1) * x, (corner < 2 ? 1 : -1) * y);
    if (corner_radius_m == 0) {
      vertices.push_back(middle);
      continue;
    }
    for (int i = 0; i <= kChordsOfCorner; ++i) {
      const double angle = kPi / 2 * corner + step * i;
      const bool is_end = i == 0 || i == kChordsOfCorner;
      vertices.push_back(middle + (is_end ? corner_radius_m : radius_m) *
                                      Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  return polygon(std::move(vertices));
}

Vector2d ConvexOutline::extent_m() const noexcept {
  Vector2d least = vertices_m_.front(), largest = least;
  for (const Vector2d& vertex : vertices_m_) {
    least = least.cwiseMin(vertex);
    largest = largest.cwiseMax(vertex);
  }
  return largest - least;
}

double ConvexOutline::radius_integral_m3(const Vector2d& point_m) const noexcept {
  double integral = 0;
  for (std::size_t i = 0; i < vertices_m_.size(); ++i)
    integral += radius_integral_of_triangle(vertices_m_[i] - point_m,
                                            vertices_m_[(i + 1) % vertices_m_.size()] - point_m);
  return integral;
}

bool ConvexOutline::contains(const Vector2d& point_m) const noexcept {
  for (std::size_t i = 0; i < vertices_m_.size(); ++i)
    if (!(outline_cross(vertices_m_[(i + 1) % vertices_m_.size()] - vertices_m_[i],
                        point_m - vertices_m_[i]) >= 0))
      return false;
  return true;
}

ConvexOutline ConvexOutline::moved(double angle_rad, const Vector2d& shift_m) const {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle_rad).toRotationMatrix();
  std::vector<Vector2d> vertices;
  for (const Vector2d& vertex : vertices_m_) vertices.push_back(turn * vertex + shift_m);
  return ConvexOutline(std::move(vertices));
}

std::optional<ConvexOutline> ConvexOutline::common_with(const ConvexOutline& other) const {
  std::vector<Vector2d> common = vertices_m_;
  for (std::size_t i = 0; i < other.vertices_m_.size() && common.size() > 2; ++i) {
    const Vector2d& from = other.vertices_m_[i];
    common =
        cut_by_line(common, from, other.vertices_m_[(i + 1) % other.vertices_m_.size()] - from);
  }
  if (common.size() < 3) return std::nullopt;
  common = without_idle_vertices(common, std::min(largest_width_m_, other.largest_width_m_));
  if (common.size() < 3) return std::nullopt;
  const ConvexOutline result(std::move(common));
  if (!(result.area_m2_ > 1e-12 * std::min(area_m2_, other.area_m2_))) return std::nullopt;
  return result;
}

std::optional<ConvexOutline> ConvexOutline::shrunk(double distance_m) const {
  std::vector<Vector2d> left = vertices_m_;
  for (std::size_t i = 0; i < vertices_m_.size() && left.size() > 2; ++i) {
    const Vector2d& from = vertices_m_[i];
    const Vector2d edge = vertices_m_[(i + 1) % vertices_m_.size()] - from;
    left = cut_by_line(left, from + distance_m / edge.norm() * Vector2d(-edge.y(), edge.x()), edge);
  }
  if (left.size() < 3) return std::nullopt;
  left = without_idle_vertices(left, largest_width_m_);
  if (left.size() < 3) return std::nullopt;
  const ConvexOutline result(std::move(left));
  if (!(result.area_m2_ > 1e-9 * area_m2_)) return std::nullopt;
  return result;
}

ConvexOutline ConvexOutline::expanded(double distance_m) const {
  const std::size_t count = vertices_m_.size();
  const auto outward = [&](std::size_t side) -> Vector2d {
    const Vector2d along = vertices_m_[(side + 1) % count] - vertices_m_[side % count];
    return Vector2d(along.y(), -along.x()).normalized();
  };
  std::vector<Vector2d> moved;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d before = outward(i + count - 1), after = outward(i);
    moved.push_back(vertices_m_[i] + distance_m / (1 + before.dot(after)) * (before + after));
  }
  return ConvexOutline(std::move(moved));
}

}  // namespace softfinger
