#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace softfinger::fem {

/// The edge of a contact as a smooth closed curve about a centre,
///   (centre_x + a rho cos t, centre_y + b rho sin t),
///   rho(t) = 1 + sum_k (cosine_k cos k t + sine_k sin k t),
/// t the scaled polar angle. An ellipse along the axes has no harmonics.
struct ContactEdge {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double a = 1, b = 1;
  Eigen::VectorXd cosine, sine;  ///< of the harmonics 0, 1, ...; may be empty

  /// rho(t)
  double radius(double angle_rad) const;
  /// The curve's point at this angle, or the point at this fraction of the way to it.
  Eigen::Vector2d at(double angle_rad, double fraction = 1) const;
  /// Points around it, counter-clockwise.
  Eigen::Matrix2Xd outline(Eigen::Index points) const;
};

/// The area that closed outlines enclose, and the ellipse of the same area, centre and ratio of
/// second moments.
struct OutlineShape {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double area = 0;
  double a = 0, b = 0;   ///< semi-axes of the ellipse, a >= b, pi a b the area
  double turn_rad = 0;   ///< of its long axis from x, from -pi/2 to pi/2
  double departure = 0;  ///< largest distance of an outline from the ellipse, over b
};

/// A smooth curve through an outline that winds once around its centre, as seen from there: the
/// Fourier series of rho that fits its points best.
/// @returns none where the points lie farther than `tolerance` from it, root mean square over b
std::optional<ContactEdge> smooth_edge(const Eigen::Matrix2Xd& outline, int harmonics,
                                       double tolerance);

/// A closed outline with each of its points moved to the left of its direction: inwards where it
/// runs counter-clockwise.
Eigen::Matrix2Xd moved_left(const Eigen::Matrix2Xd& outline, double distance);

/// @param outlines  polygons of at least three points, counter-clockwise; a hole runs clockwise
OutlineShape shape_of(const std::vector<Eigen::Matrix2Xd>& outlines);

}  // namespace softfinger::fem
