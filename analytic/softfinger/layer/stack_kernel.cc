#include "softfinger/layer/stack_kernel.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

using Eigen::Matrix2d;

/// Waves of a material at their own origin, potentials exp(kz) cos kx (growing) and exp(-kz) cos
/// kx: a column for the gradient of the potential, one for kappa psi e_z - z grad psi, kappa = 3 -
/// 4 nu. Displacements (along x, along z) are times 2 G, tractions (normal, shear) over k.
struct Waves {
  Matrix2d growing_displacement, decaying_displacement, growing_traction, decaying_traction;

  explicit Waves(double nu) noexcept {
    const double kappa = 3 - 4 * nu, normal = 2 * (1 - nu), shear = 1 - 2 * nu;
    growing_displacement << -1, 0, 1, kappa;
    decaying_displacement << -1, 0, -1, kappa;
    growing_traction << 1, normal, -1, -shear;
    decaying_traction << 1, -normal, 1, -shear;
  }
};

}  // namespace

StackKernel::StackKernel(const LayerStack& stack) noexcept
    : surface_(stack.sublayers[0].poisson_ratio),
      thickness_m_(stack.sublayers[0].thickness_m),
      depth_(stack.thickness_m() / stack.sublayers[0].thickness_m),
      count_(stack.count) {
  const double modulus_Pa = stack.sublayers[0].plane_strain_modulus_Pa();
  for (std::size_t i = 0; i < count_; ++i) {
    if (count_ > 1)
      softest_ = std::max(softest_, modulus_Pa / stack.sublayers[i].youngs_modulus_Pa);
    const ElasticLayer& layer = stack.sublayers[i];
    sublayers_[i] = {layer.thickness_m / thickness_m_, layer.shear_modulus_Pa() / modulus_Pa,
                     layer.poisson_ratio};
  }
}

double StackKernel::compliance(double x) const noexcept {
  if (count_ == 1) return surface_.compliance(x);
  // Displacement by traction over k at the interface, of what lies below.
  Matrix2d compliance = Matrix2d::Zero();
  for (std::size_t i = count_; i-- > 0;) {
    const Sublayer& layer = sublayers_[i];
    const Waves waves(layer.poisson_ratio);
    const double twice_shear = 2 * layer.shear_modulus, y = x * layer.thickness;
    const Matrix2d from_below =
        -(waves.decaying_displacement - twice_shear * compliance * waves.decaying_traction)
             .inverse() *
        (waves.growing_displacement - twice_shear * compliance * waves.growing_traction);
    // Seen from an origin that is y higher, a second wave has -y of the first one in it.
    Matrix2d up, down;
    up << 1, -y, 0, 1;
    down << 1, y, 0, 1;
    const Matrix2d at_top = std::exp(-2 * y) * up * from_below * down;
    compliance = (waves.growing_displacement + waves.decaying_displacement * at_top) *
                 (waves.growing_traction + waves.decaying_traction * at_top).inverse() /
                 twice_shear;
  }
  return compliance(1, 0) / 2;
}

double StackKernel::stiffening(double x) const noexcept {
  return count_ == 1 ? surface_.stiffening(x) : 1 - compliance(x);
}

}  // namespace softfinger
