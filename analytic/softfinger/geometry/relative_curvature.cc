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

  // If the bodies' curvatures cancel, the remainder is round-off or the fit's noise.
  const double size = std::max(largest_curvature(finger), largest_curvature(object));
  const double round_off = 1e-9 * size;
  if (k[1] - k[0] > 1e-12 * size) result.radii.axis_rad = principal_curvature(sum).axis_rad;
  const Eigen::Matrix2d curvature_covariance =
      internal::principal_curvature_covariance_per_m2(sum, covariance);
  const std::array<double, 2> std{std::sqrt(curvature_covariance(0, 0)),
                                  std::sqrt(curvature_covariance(1, 1))};
  const auto vanishes_below = [&](int i) {
    return std::max(round_off, std::min(3 * std[i], 1e-3 * size));
  };
  const bool known = std::isfinite(std[0]) && std::isfinite(std[1]);
  const auto within = [&](int i, double deviations) {
    return std::abs(k[i]) <= std::max(vanishes_below(i), known ? deviations * std[i] : 0.0);
  };
  if (within(0, 2) && within(1, 2)) {
    result.kind = ContactKind::conforming;
  } else if (k[0] > 0 && !within(0, 0.5)) {
    result.kind = ContactKind::elliptic;
  } else if (k[1] <= 0 || (k[0] < 0 && !within(0, 2))) {
    result.kind = ContactKind::saddle;
  } else {
    result.kind = ContactKind::line;
  }
  if (result.kind == ContactKind::elliptic) {
    result.radii.major_m = 1 / k[0];
    result.radii.minor_m = 1 / k[1];
    for (int i : {0, 1}) result.radii_std_m[i] = internal::radius_std_m(k[i], std[i]);
    const Eigen::Vector2d radii(1 / k[0], 1 / k[1]);  // d ln R = -dk / k
    if (known)
      result.log_radii_covariance = radii.asDiagonal() * curvature_covariance * radii.asDiagonal();
    else
      result.log_radii_covariance =
          Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()).asDiagonal();
  }
  return result;
}

Eigen::VectorXd propagated_std(
    const RelativeCurvature& relative,
    const std::function<Eigen::VectorXd(const RelativeRadii&)>& quantities) {
  const Eigen::VectorXd here = quantities(relative.radii);
  const auto all = [&](double value) { return Eigen::VectorXd::Constant(here.size(), value); };
  if (relative.kind != ContactKind::elliptic) return all(std::numeric_limits<double>::quiet_NaN());
  const Eigen::Matrix2d& covariance = relative.log_radii_covariance;
  if (covariance.isZero(0)) return all(0);
  if (!covariance.allFinite()) return all(std::numeric_limits<double>::infinity());
  // Three points on one side: second order, and R' stays the larger one also where both are equal.
  // The third order leaves 1e-6 of the result; errors of the quantity itself are multiplied by a
  // thousand.
  const double step = 1e-3;
  Eigen::MatrixX2d gradients(here.size(), 2);
  for (int i : {0, 1}) {
    const auto at = [&](double steps) {
      RelativeRadii radii = relative.radii;
      if (i == 0)
        radii.major_m *= std::exp(steps * step);
      else
        radii.minor_m *= std::exp(-steps * step);
      return quantities(radii);
    };
    const Eigen::VectorXd outwards = (4 * at(1) - at(2) - 3 * here) / (2 * step);
    gradients.col(i) = i == 0 ? outwards : Eigen::VectorXd(-outwards);
  }
  const Eigen::VectorXd variances =
      (gradients * covariance).cwiseProduct(gradients).rowwise().sum();
  // Round-off may leave a variance below zero; NaN stays.
  return variances.unaryExpr(
      [](double variance) { return std::sqrt(variance < 0 ? 0 : variance); });
}

}  // namespace softfinger
