#include "softfinger/friction/sampled_pressure.h"

#include <cmath>
#include <limits>

#include "softfinger/friction/limit_surface_newton.h"

namespace softfinger {
namespace {

bool counts(const PressureSample& sample) {
  return sample.normal_force_N > 0 && std::isfinite(sample.normal_force_N) &&
         std::isfinite(sample.x_m) && std::isfinite(sample.y_m);
}

}  // namespace

SampledPressure::SampledPressure(const std::vector<PressureSample>& samples, double friction,
                                 double patch_radius_m)
    : friction_(friction >= 0 && std::isfinite(friction) ? friction : 0),
      patch_arm_m_(patch_radius_m > 0 && std::isfinite(patch_radius_m) ? patch_radius_m * 2 / 3
                                                                       : 0) {
  samples_.reserve(samples.size());
  for (const PressureSample& sample : samples) {
    if (!counts(sample)) continue;
    samples_.push_back(sample);
    normal_force_N_ += sample.normal_force_N;
  }
  for (const PressureSample& sample : samples_) {
    const double weight = sample.normal_force_N / normal_force_N_;
    center_x_m_ += weight * sample.x_m;
    center_y_m_ += weight * sample.y_m;
  }
  set_reference(center_x_m_, center_y_m_);
}

void SampledPressure::set_reference(double x_m, double y_m) noexcept {
  reference_x_m_ = x_m;
  reference_y_m_ = y_m;
  eccentricity_m_ = 0;
  for (const PressureSample& sample : samples_)
    eccentricity_m_ += sample.normal_force_N / normal_force_N_ *
                       std::hypot(std::hypot(sample.x_m - x_m, sample.y_m - y_m), patch_arm_m_);
}

/// Like LimitSurface: twist (v, e_n omega) to (f, tau/e_n) / (mu P).
Eigen::Vector3d SampledPressure::scaled_wrench(const Eigen::Vector3d& twist,
                                               Eigen::Matrix3d* hessian) const noexcept {
  if (hessian) hessian->setZero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const double largest = twist.cwiseAbs().maxCoeff();
  if (!(largest > 0) || samples_.empty()) return sum;
  const double inverse_arm = eccentricity_m_ > 0 ? 1 / eccentricity_m_ : 0;
  const Eigen::Vector3d t = twist / largest;
  for (const PressureSample& sample : samples_)
    limit_surface_newton::add_piece(
        t, (sample.x_m - reference_x_m_) * inverse_arm, (sample.y_m - reference_y_m_) * inverse_arm,
        patch_arm_m_ * inverse_arm, sample.normal_force_N / normal_force_N_, sum, hessian);
  if (hessian) *hessian /= largest;
  return sum;
}

LimitWrench SampledPressure::wrench_for_twist(const Twist& twist) const noexcept {
  const double arm = eccentricity_m_ > 0 ? eccentricity_m_ : 0;
  const Eigen::Vector3d scaled(twist.velocity_x_m_per_s, twist.velocity_y_m_per_s,
                               twist.angular_velocity_rad_per_s * arm);
  if (!scaled.allFinite()) return {};
  const Eigen::Vector3d wrench = scaled_wrench(scaled, nullptr);
  return {max_force_N() * wrench.x(), max_force_N() * wrench.y(), max_torque_Nm() * wrench.z()};
}

LimitWrench SampledPressure::wrench_for_center_of_rotation(double x_m, double y_m) const noexcept {
  return wrench_for_twist({y_m - reference_y_m_, reference_x_m_ - x_m, 1});
}

double SampledPressure::support(const Twist& twist) const noexcept {
  const LimitWrench wrench = wrench_for_twist(twist);
  return wrench.force_x_N * twist.velocity_x_m_per_s + wrench.force_y_N * twist.velocity_y_m_per_s +
         wrench.torque_Nm * twist.angular_velocity_rad_per_s;
}

double SampledPressure::utilisation(const LimitWrench& wrench) const noexcept {
  return limit_surface_newton::utilisation(
      wrench, ellipsoid(), [this](const Eigen::Vector3d& twist, Eigen::Matrix3d* hessian) {
        return scaled_wrench(twist, hessian);
      });
}

LimitWrench SampledPressure::project(const LimitWrench& wrench) const noexcept {
  return limit_surface_newton::project(
      wrench, ellipsoid(), [this](const Eigen::Vector3d& twist, Eigen::Matrix3d* hessian) {
        return scaled_wrench(twist, hessian);
      });
}

}  // namespace softfinger
