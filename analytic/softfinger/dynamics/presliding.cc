#include "softfinger/dynamics/presliding.h"

#include <algorithm>
#include <cmath>

namespace softfinger {

PreslidingElements::PreslidingElements(const ShiftCurve& shift, const TwistCurve& twist,
                                       int elements)
    : elements_(std::size_t(std::clamp(elements, 2, 100))) {
  // Where one element after the other slides: evenly in ln x, and closely enough at the start that
  // the first chord is nearly as steep as the curve.
  constexpr double kFirst = 0.03, kLast = 12;
  const std::size_t count = elements_.size();
  std::vector<double> x(count + 2, 0.);
  for (std::size_t i = 0; i < count; ++i)
    x[i + 1] = kFirst * std::pow(kLast / kFirst, double(i) / double(count - 1));
  x[count + 1] = 2 * kLast;
  const auto share = [&](const auto& curve, double Element::*stiffness, double Element::*limit) {
    const double last = curve(kLast);
    // What the curve gains beyond the last place would be a spring that never slides.
    const auto value = [&](std::size_t i) { return i > count ? 1. : curve(x[i]) / last; };
    const auto chord = [&](std::size_t i) { return (value(i + 1) - value(i)) / (x[i + 1] - x[i]); };
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
