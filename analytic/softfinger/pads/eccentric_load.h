#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/friction/sampled_pressure.h"

namespace softfinger {

/// Pressure of a flat pad whose load acts beside its middle, and the arm of friction that follows.
///
/// With w the pressure of a load in the middle, the pressure is
///   p = w max(0, alpha + beta . r),
/// with alpha, beta such that force and centre of pressure are those of the load. That is exact for
/// columns (w uniform) and for thin incompressible pads (w and w r are both solutions there), and
/// it knows where the rim lifts off. The numbers minimise a convex function, by Newton's method.
class EccentricLoad {
 public:
  /// @param middle  of the load in the middle; samples without force are left out
  explicit EccentricLoad(std::vector<PressureSample> middle);

  struct Answer {
    Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();  ///< that was reached
    double eccentricity_m = 0;                           ///< int p r dA / P about it
    double lifted_share = 0;  ///< part of the samples that carry nothing, 0 to 1
  };
  /// @param centre_m  of pressure; one nearer to the outline than a fiftieth of its distance from
  ///                  the middle, or outside, is drawn in towards the middle until there is a
  ///                  pressure
  /// No allocation; some microseconds.
  Answer at(const Eigen::Vector2d& centre_m) const noexcept;

  const Eigen::Vector2d& middle_m() const noexcept { return middle_m_; }

 private:
  bool solve(const Eigen::Vector2d& centre_m, Eigen::Vector3d& plane) const noexcept;

  // Each over the pad's size, from the middle, and with forces that sum up to 1.
  std::vector<double> x_, y_, weight_;
  Eigen::Vector2d middle_m_ = Eigen::Vector2d::Zero();
  double size_m_ = 1;
};

}  // namespace softfinger
