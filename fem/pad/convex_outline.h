#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace softfinger::fem {

/// A convex region of the plane: a convex polygon and all points within a distance of it (its
/// rounding). A disc is a polygon of four corners in one point, rounded by the radius. Any unit of
/// length. Corners are listed counter-clockwise; side i runs from corner i to corner i + 1.
class ConvexOutline {
 public:
  /// @param radius  > 0
  static ConvexOutline disc(double radius);
  /// @param rounding  radius of its corners, 0 to half of the shorter length
  static ConvexOutline rectangle(double length_x, double length_y, double rounding);
  /// Corners in either sense; points on a straight side are dropped.
  /// @param where, field  for messages
  /// @throws InputError for fewer than three points, an outline that is not convex or crosses
  /// itself
  static ConvexOutline polygon(std::vector<Eigen::Vector2d> points, const std::string& where,
                               const std::string& field);

  ConvexOutline scaled(double factor) const;      ///< about the origin
  ConvexOutline expanded(double distance) const;  ///< by the points that near to it
  /// Turns about the origin, then moves.
  ConvexOutline placed(const Eigen::Vector2d& offset, double angle_rad) const;

  int corners() const { return static_cast<int>(corner_.size()); }
  bool is_rounded() const { return rounding_ > 0; }
  /// Whether it is its own mirror image at x = 0 and at y = 0, its first corner between the
  /// positive axes.
  bool is_symmetric() const { return symmetric_; }

  double area() const;
  Eigen::Vector2d centroid() const;
  /// Distance from the outline, negative inside.
  double distance(const Eigen::Vector2d& point) const;
  /// Distance from a point inside to the outline along a direction of length 1.
  double along_ray(const Eigen::Vector2d& point, const Eigen::Vector2d& direction) const;
  /// Length from one end to the other along a direction of length 1.
  double width(const Eigen::Vector2d& direction) const;
  double largest_width() const;
  double smallest_width() const;

  /// The middle of the side that ends at a corner.
  Eigen::Vector2d side_middle(int corner) const;
  /// The middle of a rounded corner, or the corner itself.
  Eigen::Vector2d corner_middle(int corner) const;
  /// A point of the outline from the middle of the side that ends at a corner (share 0) to the
  /// corner's middle (share 1).
  /// @param straight  share at which the rounding begins
  Eigen::Vector2d to_corner(int corner, double share, double straight) const;
  /// A point from the corner's middle (share 0) to the middle of the side that begins there (share
  /// 1).
  Eigen::Vector2d from_corner(int corner, double share, double straight) const;
  /// Lengths of the straight part and of the rounded one, in `to_corner` and in `from_corner`.
  Eigen::Vector2d lengths_to_corner(int corner) const;
  Eigen::Vector2d lengths_from_corner(int corner) const;
  const std::vector<Eigen::Vector2d>& corner_points() const { return corner_; }

 private:
  ConvexOutline() = default;
  std::size_t before(int corner) const {
    return static_cast<std::size_t>(corner + corners() - 1) % corner_.size();
  }
  std::size_t at(int corner) const { return static_cast<std::size_t>(corner) % corner_.size(); }
  Eigen::Vector2d on_rounding(int corner, double share) const;
  double turn(int corner) const;

  std::vector<Eigen::Vector2d> corner_;
  std::vector<Eigen::Vector2d> normal_;  ///< outward, of side i
  double rounding_ = 0;
  bool symmetric_ = false;
};

}  // namespace softfinger::fem
