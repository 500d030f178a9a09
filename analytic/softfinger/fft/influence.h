#pragma once

#include <vector>

#include "softfinger/fft/convolution.h"
#include "softfinger/layer/stack_kernel.h"

namespace softfinger::fft {

/// Stiffening of a layer by its rigid base: the amount by which its surface displacement under a
/// point force falls short of a half-space's, as a function of the distance. With t = r/h,
///   E* pi h (u_halfspace - u)(r) / F = S(t) = int_0^inf (1 - w(x)) J0(x t) dx
/// (the Hankel transform of the kernel in layer_kernel.h). Smooth, S ~ 1/t far away, where it
/// cancels the half-space's 1/r. Of a stack h is the thickness of the surface's sublayer.
class LayerStiffening {
 public:
  /// Tabulates S for distances up to `largest` (or `reach()`, if that is less): at most 10 ms, of a
  /// stack that is ten times as deep as its first sublayer 0.2 s.
  LayerStiffening(const StackKernel& kernel, double largest);

  /// S(t), 0 <= t <= largest, absolute error about 3e-8. Beyond `reach()` 1/t, that is u = 0: the
  /// rest of the displacement decays exponentially and is below 1e-10 F/(E* h).
  double operator()(double t) const;
  double reach() const { return kReach * depth_; }
  /// Reach of a kernel's stiffening, over its h.
  static double reach(const StackKernel& kernel) { return kReach * kernel.depth(); }

 private:
  static constexpr double kReach = 30, kStep = 0.1;

  double depth_;                    ///< of all sublayers, over h
  std::vector<double> near_, far_;  ///< by steps of h up to kReach, and of the depth beyond
};

/// F with d^4 F / dx² dy² = 1/r, even in x and y: its second differences in both directions are the
/// integral of 1/r over two equal cells. Extended precision, since the differences cancel.
long double fourfold_integral(long double x, long double y);

/// Displacement of the surface of a half-space or a bonded layer, averaged over one rectangular
/// cell, under a pressure that is one on another cell and zero elsewhere (what a Galerkin method
/// with constant pressure per cell needs), for all offsets between cells 0 .. rows, 0 .. columns.
///
/// The half-space's part is the fourfold integral of 1/(pi E* r) over both cells, in closed form
/// where the cells are near; the layer's part is smooth and integrated numerically.
/// @param size_x, size_y  of a cell, in any unit of length; `thickness` in the same
/// @param stiffening      null for a half-space
/// @return displacement times E*, in the unit of length; relative error about 1e-9
KernelQuadrant influence_of_cells(int rows, int columns, double size_x, double size_y,
                                  double thickness, const LayerStiffening* stiffening);

}  // namespace softfinger::fft
