#pragma once

#include "softfinger/layer/layer_limits.h"

namespace softfinger {

/// Tensor cubic B-spline of the corrections to `LayerBlend` over `TableCoordinates`. Equidistant
/// knots, one coefficient more than knots on either side.
struct BondedLayerTable {
  static constexpr int kSizeKnots = 37, kCompressibilityKnots = 12, kElongationKnots = 8;
  static constexpr int kSizes = kSizeKnots + 2, kCompressibilities = kCompressibilityKnots + 2,
                       kElongations = kElongationKnots + 2;
  static constexpr int kCount = kCompressibilities * kElongations * kSizes * kLayerQuantities;

  /// R'/R'' of the last knot is 100.003.
  static constexpr double kElongationMax = 3.7125292;

  /// [compressibility][elongation][size][quantity], in units of `unit`. The correction to kAspect
  /// is divided by ln(R'/R''), which makes it even in that logarithm like the others. Whole
  /// numbers to 32767; as floats, which take one instruction less to become doubles.
  static const double unit[kLayerQuantities];
  static const float coefficients[kCount];
};

}  // namespace softfinger
