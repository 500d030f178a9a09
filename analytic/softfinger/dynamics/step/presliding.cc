#include "softfinger/dynamics/step/presliding.h"

#include <algorithm>
#include <cmath>

namespace softfinger {

namespace {

/// Heights of a curve at which one element after the other slides: close at the start, so that the
/// first chord is nearly as steep as the curve, and at the end, where the curve is flat.
constexpr std::array<double, 16> kHeights = {0.01, 0.03, 0.07, 0.13, 0.2,  0.28, 0.36, 0.44,
                                             0.52, 0.6,  0.68, 0.76, 0.84, 0.91, 0.96, 0.995};

/// Finds the place at which a curve reaches a height.
template <class Curve>
double place_of(const Curve& curve, double height) {
  double low = 0, high = 1;
  while (curve(high) < height) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (curve(middle) < height ? low : high) = middle;
  }
  return high;
}

}  // namespace

PreslidingElements::PreslidingElements(const ShiftCurve& shift, const TwistCurve& twist) {
  const std::size_t count = elements_.size();
  const auto share = [&](const auto& curve, double Element::*stiffness, double Element::*limit) {
    std::array<double, kHeights.size() + 1> x{}, y{};
    for (std::size_t i = 0; i < count; ++i) {
      x[i + 1] = place_of(curve, kHeights[i]);
      // All elements together reach the limit.
      y[i + 1] = i + 1 < count ? kHeights[i] : 1;
    }
    const auto chord = [&](std::size_t i) {
      return i < count ? (y[i + 1] - y[i]) / (x[i + 1] - x[i]) : 0;
    };
    for (std::size_t i = 0; i < count; ++i) {
      elements_[i].*stiffness = std::max(0., chord(i) - chord(i + 1));
      elements_[i].*limit = elements_[i].*stiffness * x[i + 1];
    }
  };
  share(shift, &Element::force_stiffness, &Element::force_limit);
  share(twist, &Element::torque_stiffness, &Element::torque_limit);
}

Eigen::Vector3d PreslidingElements::stiffness() const {
  double force = 0, torque = 0;
  for (const Element& element : elements_) {
    force += element.force_stiffness;
    torque += element.torque_stiffness;
  }
  return stiffness_.cwiseProduct(Eigen::Vector3d(force, force, torque));
}

Eigen::Vector3d PreslidingElements::wrench() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Element& element : elements_) sum += element.wrench;
  return sum;
}

double PreslidingElements::energy_J() const {
  double energy_J = 0;
  for (const Element& element : elements_) {
    const Eigen::Vector3d shares(element.force_stiffness, element.force_stiffness,
                                 element.torque_stiffness);
    for (int i = 0; i < 3; ++i) {
      const double stiffness = shares[i] * stiffness_[i];
      if (stiffness > 0) energy_J += element.wrench[i] * element.wrench[i] / (2 * stiffness);
    }
  }
  return energy_J;
}

void PreslidingElements::set_limits(const StuckStiffness& stuck, double largest_force_N,
                                    double largest_torque_Nm) {
  const Eigen::Vector3d stiffness(stuck.tangential_x_N_per_m, stuck.tangential_y_N_per_m,
                                  stuck.torsional_Nm_per_rad);
  largest_force_N_ = largest_force_N;
  largest_torque_Nm_ = largest_torque_Nm;
  for (Element& element : elements_) {
    for (int i = 0; i < 3; ++i)
      if (stiffness[i] < stiffness_[i]) element.wrench[i] *= stiffness[i] / stiffness_[i];
    return_to_limit(element);
  }
  stiffness_ = stiffness;
}

void PreslidingElements::turn_axes(double angle_rad) {
  const double cosine = std::cos(angle_rad), sine = std::sin(angle_rad);
  for (Element& element : elements_) {
    const double x = element.wrench.x(), y = element.wrench.y();
    element.wrench.x() = cosine * x + sine * y;
    element.wrench.y() = cosine * y - sine * x;
  }
}

void PreslidingElements::move(const Eigen::Vector3d& displacement) {
  for (Element& element : elements_) {
    element.wrench -= Eigen::Vector3d(element.force_stiffness * stiffness_.x(),
                                      element.force_stiffness * stiffness_.y(),
                                      element.torque_stiffness * stiffness_.z())
                          .cwiseProduct(displacement);
    return_to_limit(element);
  }
}

void PreslidingElements::return_to_limit(Element& element) const {
  const double force_N = element.force_limit * largest_force_N_,
               torque_Nm = element.torque_limit * largest_torque_Nm_;
  // An element that has no limit in one of the two does not take part in it.
  if (!(force_N > 0)) element.wrench.head<2>().setZero();
  if (!(torque_Nm > 0)) element.wrench.z() = 0;
  const double force = force_N > 0 ? element.wrench.head<2>().norm() / force_N : 0;
  const double torque = torque_Nm > 0 ? element.wrench.z() / torque_Nm : 0;
  const double used = std::hypot(force, torque);
  if (used > 1) element.wrench /= used;
}

}  // namespace softfinger
