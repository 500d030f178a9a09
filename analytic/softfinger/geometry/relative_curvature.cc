#include "softfinger/geometry/relative_curvature.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/geometry/quadric_fit_internal.h"

namespace softfinger {
namespace {

/// (A, B, C) of the same surface in a frame from which it appears turned counter-clockwise by the
/// angle.
Eigen::Matrix3d turned_by(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Eigen::Matrix3d turn;
  // Own coordinates are u = c x + s y, v = c y - s x; expand A u² + B v² + C u v.
  turn << c * c, s * s, -c * s,  //
      s * s, c * c, c * s,       //
      2 * c * s, -2 * c * s, c * c - s * s;
  return turn;
}

Eigen::Vector3d coefficients(const Quadric& q) { return {q.A_per_m, q.B_per_m, q.C_per_m}; }

double largest_curvature(const Quadric& q) {
  const auto k = internal::principal_curvatures_per_m(q);
  return std::max(std::abs(k[0]), std::abs(k[1]));
}

}  // namespace

RelativeCurvature relative_curvature(const Quadric& finger,
                                     const Eigen::Matrix3d& finger_covariance_per_m2,
                                     const Quadric& object,
                                     const Eigen::Matrix3d& object_covariance_per_m2,
                                     double angle_rad) {
  const Eigen::Matrix3d turn = turned_by(angle_rad);
  const Eigen::Vector3d gap = coefficients(finger) + turn * coefficients(object);
  const Quadric sum{gap[0], gap[1], gap[2]};
  const Eigen::Matrix3d covariance =
      object_covariance_per_m2.allFinite()
          ? Eigen::Matrix3d(finger_covariance_per_m2 +
                            turn * object_covariance_per_m2 * turn.transpose())
          : object_covariance_per_m2;

  RelativeCurvature result;
  result.curvatures_per_m = internal::principal_curvatures_per_m(sum);
  const auto& k = result.curvatures_per_m;

  // Where the bodies' curvatures cancel, what is left is round-off or the fit's noise.
  const double size = std::max(largest_curvature(finger), largest_curvature(object));
  const double round_off = 1e-9 * size;
  if (k[1] - k[0] > 1e-12 * size) result.radii.axis_rad = principal_curvature(sum).axis_rad;
  const auto std = internal::principal_curvature_std_per_m(result.radii.axis_rad, covariance);
  const auto vanishes_below = [&](int i) {
    return std::max(round_off, std::min(3 * std[i], 1e-3 * size));
  };
  if (std::abs(k[0]) <= vanishes_below(0) && std::abs(k[1]) <= vanishes_below(1)) {
    result.kind = ContactKind::conforming;
  } else if (k[0] > vanishes_below(0)) {
    result.kind = ContactKind::elliptic;
  } else if (k[1] <= 0 || k[0] < -std::max(vanishes_below(0), std::min(std[0], size))) {
    result.kind = ContactKind::saddle;
  } else {
    result.kind = ContactKind::line;
  }
  if (result.kind == ContactKind::elliptic) {
    result.radii.major_m = 1 / k[0];
    result.radii.minor_m = 1 / k[1];
    result.radii_std_m = {std[0] / (k[0] * k[0]), std[1] / (k[1] * k[1])};
  }
  return result;
}

}  // namespace softfinger
