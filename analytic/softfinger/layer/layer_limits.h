#pragma once

#include <array>

namespace softfinger {

/// Results of `bonded_layer` for a contact, as logarithms of dimensionless numbers.
enum LayerQuantity { kSize, kAspect, kDepth, kArm, kPeak, kLayerQuantities };
/// kSize:   ln(sqrt(ab)/h)
/// kAspect: ln(a/b)
/// kDepth:  ln(d R/(a b)): 1 (Hertz, circle), 1/2 (Winkler), 1/4 (thin incompressible)
/// kArm:    ln of the torque arm over that of a ring, (2/pi) a E(m): 3 pi/16, 8/15, 16/35
/// kPeak:   ln of the peak over the mean pressure: 3/2, 2, 3
using LayerQuantities = std::array<double, kLayerQuantities>;

/// Smooth blend of the three exact limits of a quadric on a bonded layer (thick: Hertz; thin:
/// confined Winkler; thin and incompressible). It is exact in each limit and off by a few to 20 %
/// between them. The table of corrections is read at coordinates that come from it.
struct LayerBlend {
  LayerQuantities value{};
  LayerQuantities slope{};  ///< derivatives with respect to ln P
};

/// Exponents: 1/s^k = 1/s_thick^k + 1/s_thin^k and s_thin^n = s_Winkler^n + s_incompressible^n.
/// Chosen to follow the circular contact within 12 %; n = 4 keeps it smooth in nu at nu = 1/2.
constexpr double kThickThinExponent = 2.5;
constexpr double kThinExponent = 4;

/// The limits' properties that depend on the shape alone: computed once per R'/R''.
struct LimitShapes {
  double log_radii_ratio = 0;
  std::array<double, 3> log_aspect{};      ///< Hertz, Winkler, incompressible
  std::array<double, 3> log_depth{};       ///< ln(d R/(a b))
  double log_hertz_size_at_unit_load = 0;  ///< ln(sqrt(ab)/h) at P R/(E* h³) = 1
  double log_incompressible_size_at_unit_load = 0;
};

/// `radii_ratio` = R'/R'' >= 1. About 250 ns: it solves for Hertz's ellipse.
LimitShapes limit_shapes(double radii_ratio) noexcept;

/// `log_load` = ln(P R/(E* h³)), `compressibility` = 1 - 2 nu in [0, 1]. A few exponentials.
LayerBlend layer_blend(const LimitShapes& shapes, double log_load, double compressibility) noexcept;

/// Where the table of corrections is read: in the blend's ln(sqrt(ab)/h), in a coordinate of the
/// compressibility that follows the change from compressible to incompressible thin layers, which
/// happens at s² (1 - 2 nu) ~ 8, and in ln(R'/R''). The first grows from `kTableSizeMin` to
/// `kTableSizeMax`, the second from 0 to 1, the third from 0.
struct TableCoordinates {
  double log_size, compressibility, elongation;
  double compressibility_slope;  ///< d(compressibility)/d(log_size)
};

constexpr double kTableLogSizeMin = -5.3;  ///< s = 0.005
constexpr double kTableLogSizeMax = 4.9;   ///< s = 134
constexpr double kTableRadiiRatioMax = 100;

/// `log_size` within the table's range.
TableCoordinates table_coordinates(double log_size, double compressibility,
                                   double log_radii_ratio) noexcept;

/// The inverse of the second coordinate: 1 - 2 nu.
double compressibility_at(double log_size, double coordinate) noexcept;
/// The inverse of the third: ln(R'/R'').
double log_radii_ratio_at(double elongation) noexcept;

}  // namespace softfinger
