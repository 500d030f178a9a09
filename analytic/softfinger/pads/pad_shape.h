#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "softfinger/pads/convex_outline.h"

namespace softfinger {

/// An outline's part in a pad's pressure, once for all thicknesses and materials: solutions
/// of
///   k² U - lap U = s,   U = 0 on the outline,   s = 1, x or y from the centroid,
/// for any k². Each is a sum over at most ten modes, U = sum_i c_i/(k² + l_i) u_i(x, y): the modes
/// span the solutions at ten k² from 0 to 4096 over the square of the outline's size (area over
/// half the perimeter), which quadratic finite elements on a star of eight rings around the
/// centroid compute. Integrals of U are then sums of ten fractions.
///
/// Accuracy (measured, see the test): mean and arm of U within 2e-4 of the series for discs and
/// rectangles to 10 : 1 for k times size up to 30; beyond, where U is 1/k² all over, 1e-3.
/// Cost: construction some ten milliseconds, 1 MB; a sum 20 ns.
class PadShape {
 public:
  static constexpr int kMostModes = 10;
  enum Source { constant, linear_x, linear_y };
  static constexpr int kSources = 3;
  /// Points where pressures are looked at: the centroid, then twelve directions at 0.95 of the way
  /// to the outline, where a centric load has its peak, then at 0.3, 0.6 and 0.8 of it.
  static constexpr int kProbeRays = 12, kCentricProbes = 1 + kProbeRays,
                       kProbes = 1 + 4 * kProbeRays;
  /// One sum: `weights` over k² + `stiffness`.
  using Row = std::array<double, kMostModes>;
  struct Sums {
    Row stiffness_per_m2{};               ///< l_i; unused modes have weight 0
    Row integral{};                       ///< int U dA, m^4 for the source 1 (one m more for x, y)
    Row moment_x{}, moment_y{};           ///< int x U, int y U
    Row radius{};                         ///< int r U, r from the centroid
    Row radius_by_x{}, radius_by_y{};     ///< int x/r U, int y/r U: how the arm moves
    std::array<Row, kProbes> at_probe{};  ///< U at `probes_m`
  };

  /// @param outline  any convex one; scales by its own size, so that it may be tiny or huge
  explicit PadShape(const ConvexOutline& outline);

  const ConvexOutline& outline() const noexcept { return outline_; }
  const Sums& sums(Source source) const noexcept { return sums_[source]; }
  const std::array<Eigen::Vector2d, kProbes>& probes_m() const noexcept { return probes_m_; }
  /// int r dA about the centroid, and its change when the point moves: int x/r, int y/r dA.
  double radius_integral_m3() const noexcept { return radius_integral_m3_; }
  const Eigen::Vector2d& radius_by_point_m2() const noexcept { return radius_by_point_m2_; }
  /// Saint-Venant's torsion constant, 4 int U dA at k = 0.
  double torsion_constant_m4() const noexcept { return torsion_constant_m4_; }
  /// Area over half the perimeter: the radius of a disc, half the side of a square.
  double size_m() const noexcept { return 2 * outline_.area_m2() / outline_.perimeter_m(); }

  /// Points that stand for a part of the area each.
  struct Samples {
    std::vector<Eigen::Vector2d> points_m;  ///< from the centroid
    std::vector<double> areas_m2;
    std::array<Eigen::MatrixXd, kSources> modes;  ///< u_i there, with c_i multiplied in
  };
  const Samples& samples() const noexcept { return samples_; }
  /// U at any point of the outline by interpolation in its element; 0 outside of it.
  /// @param rows  destination: weights over k² + stiffness, one row per source
  void at(const Eigen::Vector2d& point_m, std::array<Row, kSources>& rows) const noexcept;

 private:
  ConvexOutline outline_;
  std::array<Sums, kSources> sums_;
  std::array<Eigen::Vector2d, kProbes> probes_m_;
  double radius_integral_m3_ = 0, torsion_constant_m4_ = 0;
  Eigen::Vector2d radius_by_point_m2_ = Eigen::Vector2d::Zero();
  Samples samples_;
  std::vector<Eigen::Vector2d> rim_m_;                ///< nodes on the outline, from the centroid
  std::array<Eigen::MatrixXd, kSources> node_modes_;  ///< rows: nodes, as `samples_.modes`
};

}  // namespace softfinger
