#include "softfinger/pads/eccentric_load.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace softfinger {

EccentricLoad::EccentricLoad(std::vector<PressureSample> middle) {
  double force = 0, square = 0;
  for (const PressureSample& sample : middle) {
    if (!(sample.normal_force_N > 0) || !std::isfinite(sample.normal_force_N)) continue;
    force += sample.normal_force_N;
    middle_m_ += sample.normal_force_N * Eigen::Vector2d(sample.x_m, sample.y_m);
  }
  if (!(force > 0)) return;
  middle_m_ /= force;
  for (const PressureSample& sample : middle)
    if (sample.normal_force_N > 0)
      square += sample.normal_force_N / force *
                (Eigen::Vector2d(sample.x_m, sample.y_m) - middle_m_).squaredNorm();
  if (square > 0) size_m_ = std::sqrt(square);
  for (const PressureSample& sample : middle) {
    if (!(sample.normal_force_N > 0) || !std::isfinite(sample.normal_force_N)) continue;
    x_.push_back((sample.x_m - middle_m_.x()) / size_m_);
    y_.push_back((sample.y_m - middle_m_.y()) / size_m_);
    weight_.push_back(sample.normal_force_N / force);
  }
}

/// Minimises sum w max(0, u)²/2 - (alpha + beta . c) over the plane u = alpha + beta . r.
bool EccentricLoad::solve(const Eigen::Vector2d& centre, Eigen::Vector3d& plane) const noexcept {
  constexpr int kMostSteps = 60;
  constexpr double kArrived = 1e-10;
  const Eigen::Vector3d load(1, centre.x(), centre.y());
  const auto look = [&](const Eigen::Vector3d& at, Eigen::Matrix3d* hessian,
                        Eigen::Vector3d* gradient) {
    double energy = -load.dot(at);
    if (hessian) hessian->setZero();
    if (gradient) *gradient = -load;
    for (std::size_t i = 0; i < weight_.size(); ++i) {
      const double u = at[0] + at[1] * x_[i] + at[2] * y_[i];
      if (!(u > 0)) continue;
      energy += weight_[i] * u * u / 2;
      if (!hessian) continue;
      const Eigen::Vector3d row(1, x_[i], y_[i]);
      hessian->noalias() += weight_[i] * row * row.transpose();
      *gradient += weight_[i] * u * row;
    }
    return energy;
  };
  plane = Eigen::Vector3d(1, 0, 0);
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::Matrix3d hessian;
    Eigen::Vector3d gradient;
    const double energy = look(plane, &hessian, &gradient);
    if (gradient.lpNorm<Eigen::Infinity>() <= kArrived) return true;
    // Few samples that still carry leave the plane open.
    hessian.diagonal().array() += 1e-12 * hessian.trace();
    const Eigen::Vector3d change = -hessian.ldlt().solve(gradient);
    if (!change.allFinite()) return false;
    double part = 1;
    while (part > 1e-6 && !(look(plane + part * change, nullptr, nullptr) <=
                            energy + 1e-4 * part * gradient.dot(change)))
      part /= 2;
    plane += part * change;
  }
  return false;
}

EccentricLoad::Answer EccentricLoad::at(const Eigen::Vector2d& centre_m) const noexcept {
  Answer answer;
  answer.centre_m = middle_m_;
  if (weight_.empty()) return answer;
  constexpr double kDrawnIn = 0.98;
  constexpr int kMostTries = 40;
  Eigen::Vector2d centre = (centre_m - middle_m_) / size_m_;
  if (!centre.allFinite()) centre.setZero();
  Eigen::Vector3d plane;
  for (int tries = 0; !solve(centre, plane); ++tries) {
    if (tries == kMostTries) centre.setZero();
    if (tries > kMostTries) return answer;
    centre *= kDrawnIn;
  }
  double arm = 0;
  int lifted = 0;
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    const double u = plane[0] + plane[1] * x_[i] + plane[2] * y_[i];
    if (u > 0)
      arm += weight_[i] * u * std::hypot(x_[i] - centre.x(), y_[i] - centre.y());
    else
      ++lifted;
  }
  answer.centre_m = middle_m_ + size_m_ * centre;
  answer.eccentricity_m = size_m_ * arm;
  answer.lifted_share = double(lifted) / double(weight_.size());
  return answer;
}

}  // namespace softfinger
