#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace softfinger {

/// Convex outline of a flat contact: a polygon in the contact plane, counter-clockwise, without
/// repeated or straight vertices. Arcs are polygons of the same area as the arc's own figure. SI.
class ConvexOutline {
 public:
  /// @param vertices_m  at least three, in either direction, finite, convex; straight and repeated
  ///                    ones are dropped
  /// @throws InputError for an outline that crosses itself, is not convex or has no area
  static ConvexOutline polygon(std::vector<Eigen::Vector2d> vertices_m);
  /// The 40-gon of the circle's area. @param diameter_m  > 0
  static ConvexOutline disc(double diameter_m);
  /// Rectangle around the origin, its corners arcs of four chords each.
  /// @param corner_radius_m  0 to half the shorter side
  /// @throws InputError
  static ConvexOutline rounded_rectangle(double length_m, double width_m,
                                         double corner_radius_m = 0);

  const std::vector<Eigen::Vector2d>& vertices_m() const noexcept { return vertices_m_; }
  double area_m2() const noexcept { return area_m2_; }
  double perimeter_m() const noexcept { return perimeter_m_; }
  const Eigen::Vector2d& centroid_m() const noexcept { return centroid_m_; }
  /// int (r - c)(r - c)^T dA about the centroid c.
  const Eigen::Matrix2d& second_moments_m4() const noexcept { return second_moments_m4_; }
  /// Largest and smallest distance of two parallel lines that hold the outline between them.
  double largest_width_m() const noexcept { return largest_width_m_; }
  double least_width_m() const noexcept { return least_width_m_; }
  /// Extent along x and y.
  Eigen::Vector2d extent_m() const noexcept;

  /// int |r - point| dA in closed form. Over the area it is the arm of uniform pressure.
  /// @param point_m  anywhere
  double radius_integral_m3(const Eigen::Vector2d& point_m) const noexcept;

  bool contains(const Eigen::Vector2d& point_m) const noexcept;
  /// Turned about the origin, counter-clockwise, then shifted.
  ConvexOutline moved(double angle_rad, const Eigen::Vector2d& shift_m) const;
  /// The overlap of both; null where they have no area in common.
  std::optional<ConvexOutline> common_with(const ConvexOutline& other) const;
  /// The outline that lies everywhere `distance_m` further inside; null where nothing is left.
  std::optional<ConvexOutline> shrunk(double distance_m) const;
  /// The outline whose sides lie `distance_m` >= 0 further outside, with sharp corners.
  ConvexOutline expanded(double distance_m) const;

 private:
  explicit ConvexOutline(std::vector<Eigen::Vector2d> counter_clockwise_m);

  std::vector<Eigen::Vector2d> vertices_m_;
  double area_m2_ = 0, perimeter_m_ = 0, largest_width_m_ = 0, least_width_m_ = 0;
  Eigen::Vector2d centroid_m_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second_moments_m4_ = Eigen::Matrix2d::Zero();
};

}  // namespace softfinger
