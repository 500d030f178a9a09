#pragma once

#include <Eigen/Core>

namespace softfinger::fft {

/// Edge of one contact region whose edge is a smooth closed curve, star-shaped from its centre.
struct ContactEdge {
  /// The best-fitting ellipse: the edge's deviation from it, in coordinates in which it is the unit
  /// circle, has no mean and no first and second harmonics.
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double a = 0, b = 0;   ///< semi-axes, a >= b
  double axis_rad = 0;   ///< direction of a, in (-pi/2, pi/2]
  double area = 0;       ///< of the region, not of the ellipse
  double deviation = 0;  ///< largest deviation from the ellipse over the radius, scaled coordinates
  double diamond = 0;    ///< e4 of the edge 1 + e4 cos 4t in scaled polar coordinates
  /// Column k: point of the edge at the scaled polar angle 2 pi k / columns.
  Eigen::Matrix2Xd points;

  /// Transforms the plane to coordinates in which the ellipse is the unit circle.
  Eigen::Matrix2d to_scaled = Eigen::Matrix2d::Identity();
  /// Coefficients of 1, cos t, sin t, cos 2t, ... At the scaled angle t the edge lies at the scaled
  /// radius 1 + their sum.
  Eigen::VectorXd harmonics;
  /// Distance from the centre over that of the edge in the same direction: below 1 inside.
  double relative_radius(double x, double y) const;
};

/// Rectangular grid of cells, in any unit of length.
struct CellGrid {
  int rows = 0, columns = 0;
  double size_x = 0, size_y = 0;    ///< of a cell
  double first_x = 0, first_y = 0;  ///< centre of cell (0, 0)
  double x(int column) const { return first_x + column * size_x; }
  double y(int row) const { return first_y + row * size_y; }
  double cell_area() const { return size_x * size_y; }
};

/// Finds the edge to a few hundredths of a cell.
///
/// A cell of the discrete contact carries pressure when its middle lies inside the true edge, for
/// thick and thin layers alike. As the edge moves inwards, the pressure of the last cell inside
/// vanishes when the edge reaches that cell's middle. As it moves outwards, the gap of the first
/// cell outside vanishes when the edge reaches that cell's middle. Between the two middles the edge
/// is placed by the ratio of two displacements: that which the last cell's pressure gives to its
/// own cell, and the first gap. (The pressure follows a root near the edge, but over less than a
/// cell on thin layers, so that it cannot be extrapolated.) The points where the edge crosses grid
/// lines are then fitted by harmonics of the angle.
/// @param pressure  mean pressure of each cell, row by row; zero outside
/// @param gap       mean gap of each cell between the deformed surfaces; zero inside
/// @param compliance  1/E* of the bodies together: displacement = compliance * pressure * length
/// @param even      the grid is the quarter x > 0, y > 0 of a contact even in both
/// @throws ConvergenceError when the contact has fewer than 16 cells or no such edge, or reaches
///         the grid's border
ContactEdge fit_contact_edge(const CellGrid& grid, const Eigen::ArrayXd& pressure,
                             const Eigen::ArrayXd& gap, double compliance, bool even);

}  // namespace softfinger::fft
