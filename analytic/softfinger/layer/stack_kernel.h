#pragma once

#include <array>

#include "softfinger/input/contact_problem.h"
#include "softfinger/layer/layer_kernel.h"

namespace softfinger {

/// Compliance of sublayers that are bonded to each other and to a rigid base, under frictionless
/// normal pressure, against that of a half-space of the surface's material: with k h, h the
/// thickness of the surface's sublayer,
///   u^ = 2 w(k h) / (E* k) p^,
/// where E* is the surface's. One sublayer has w of LayerKernel. Over a soft base w exceeds 1.
///
/// In each sublayer displacement and traction are sums of two growing and two decaying waves
/// (Papkovich and Neuber's potentials). From the base upwards the decaying ones are what the
/// interface below makes of the growing ones, so that no exponential grows.
class StackKernel {
 public:
  explicit StackKernel(const LayerStack& stack) noexcept;
  /// One layer.
  StackKernel(const LayerKernel& layer, double thickness_m) noexcept
      : surface_(layer), thickness_m_(thickness_m) {}

  double thickness_m() const noexcept { return thickness_m_; }  ///< h, of the surface's sublayer
  double depth() const noexcept { return depth_; }              ///< of all, over h
  /// At least the largest w: the surface's E* over the smallest E of a sublayer, 1 of one layer.
  double softest() const noexcept { return softest_; }

  /// w(x), x = k h >= 0: absolute error 1e-14 times the largest ratio of moduli.
  double compliance(double x) const noexcept;
  /// 1 - w(x), as accurate; of one layer as LayerKernel's.
  double stiffening(double x) const noexcept;

 private:
  struct Sublayer {
    double thickness = 1;      ///< over h
    double shear_modulus = 0;  ///< over the surface's E*
    double poisson_ratio = 0;
  };

  LayerKernel surface_;
  double thickness_m_, depth_ = 1, softest_ = 1;
  std::size_t count_ = 1;
  std::array<Sublayer, LayerStack::kMost> sublayers_{};  ///< from the surface; read if several
};

}  // namespace softfinger
