#include "softfinger/friction/six_patch_surface.h"

#include <algorithm>
#include <cmath>

#include "softfinger/friction/limit_surface_newton.h"
#include "softfinger/friction/max_torque.h"

namespace softfinger {

SixPatchSurface::SixPatchSurface(double a_m, double b_m, double exponent,
                                 double max_force_N) noexcept {
  constexpr double kLargest = 1.7e308;
  if (max_force_N >= 0 && max_force_N <= kLargest) max_force_N_ = max_force_N;
  const bool in_range = b_m > 0 && a_m >= b_m && a_m <= kLargest && exponent > -1;
  for (Patch& patch : patches_) patch.share = 1.0 / 6;
  if (!in_range) return;
  eccentricity_m_ = torque_arm_exact_m(a_m, b_m, exponent);

  // One row per quantity: constant, (1 - b/a), (1 - b/a)², s = 1/(n+2) - 2/5, s (1 - b/a).
  constexpr double kFit[6][5] = {
      {0.8525, 0.9877, -0.4775, 0.2121, 0.1120},    // distance of the outer two
      {0.4506, -0.0288, -0.1323, -0.3897, 0},       // their eccentricity
      {0.2810, 0.1005, 0.1952, -0.0413, 0},         // their share, together
      {0.4383, 0.1072, -0.2032, 0.1664, 0},         // x of the inner four
      {0.6998, 0.4668, -0.6551, 0.2689, 0},         // their y, over b/a
      {0.5251, -0.0905, -0.3010, -0.1584, 0.4087},  // their eccentricity
  };
  const double aspect = b_m / a_m, k = 1 - aspect;
  const double s = 1 / (std::min(exponent, 50.0) + 2) - 0.4;
  const auto fitted = [&](int row) {
    const double* c = kFit[row];
    return c[0] + k * (c[1] + k * c[2]) + s * (c[3] + k * c[4]);
  };
  const double outer_x = fitted(0), outer_arm = fitted(1), outer_share = fitted(2);
  const double inner_x = fitted(3), inner_y = aspect * fitted(4), inner_arm = fitted(5);
  const double pure_torque =
      outer_share * std::hypot(outer_x, outer_arm) +
      (1 - outer_share) * std::hypot(std::hypot(inner_x, inner_y), inner_arm);
  const double unit_m = eccentricity_m_ / pure_torque;
  for (int i = 0; i < 2; ++i)
    patches_[i] = {(i ? -1 : 1) * outer_x * unit_m, 0, outer_share / 2, outer_arm * unit_m};
  for (int i = 0; i < 4; ++i)
    patches_[2 + i] = {(i & 1 ? -1 : 1) * inner_x * unit_m, (i & 2 ? -1 : 1) * inner_y * unit_m,
                       (1 - outer_share) / 4, inner_arm * unit_m};
}

/// Like LimitSurface: twist (v, e_n omega) to (f, tau/e_n) / (mu P).
Eigen::Vector3d SixPatchSurface::scaled_wrench(const Eigen::Vector3d& twist,
                                               Eigen::Matrix3d* hessian) const noexcept {
  if (hessian) hessian->setZero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const double largest = twist.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return sum;
  const double inverse_arm = eccentricity_m_ > 0 ? 1 / eccentricity_m_ : 0;
  const Eigen::Vector3d t = twist / largest;
  for (const Patch& patch : patches_)
    limit_surface_newton::add_piece(t, patch.x_m * inverse_arm, patch.y_m * inverse_arm,
                                    patch.eccentricity_m * inverse_arm, patch.share, sum, hessian);
  if (hessian) *hessian /= largest;
  return sum;
}

LimitWrench SixPatchSurface::wrench_for_twist(const Twist& twist) const noexcept {
  const Eigen::Vector3d scaled(twist.velocity_x_m_per_s, twist.velocity_y_m_per_s,
                               twist.angular_velocity_rad_per_s * eccentricity_m_);
  if (!scaled.allFinite()) return {};
  const Eigen::Vector3d wrench = scaled_wrench(scaled, nullptr);
  return {max_force_N_ * wrench.x(), max_force_N_ * wrench.y(), max_torque_Nm() * wrench.z()};
}

double SixPatchSurface::support(const Twist& twist) const noexcept {
  const LimitWrench wrench = wrench_for_twist(twist);
  return wrench.force_x_N * twist.velocity_x_m_per_s + wrench.force_y_N * twist.velocity_y_m_per_s +
         wrench.torque_Nm * twist.angular_velocity_rad_per_s;
}

double SixPatchSurface::utilisation(const LimitWrench& wrench) const noexcept {
  return limit_surface_newton::utilisation(
      wrench, {max_force_N_, eccentricity_m_},
      [this](const Eigen::Vector3d& twist, Eigen::Matrix3d* hessian) {
        return scaled_wrench(twist, hessian);
      });
}

LimitWrench SixPatchSurface::project(const LimitWrench& wrench) const noexcept {
  return limit_surface_newton::project(
      wrench, {max_force_N_, eccentricity_m_},
      [this](const Eigen::Vector3d& twist, Eigen::Matrix3d* hessian) {
        return scaled_wrench(twist, hessian);
      });
}

}  // namespace softfinger
