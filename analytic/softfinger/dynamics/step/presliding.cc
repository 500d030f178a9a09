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
    const Eigen::Vector3d solid = element.wrench - element.fading.rowwise().sum();
    for (int i = 0; i < 3; ++i) {
      const double stiffness = shares[i] * stiffness_[i];
      if (!(stiffness > 0)) continue;
      energy_J += solid[i] * solid[i] / (2 * relaxation_.long_time_modulus() * stiffness);
      for (std::size_t t = 0; t < relaxation_.terms().size(); ++t)
        energy_J += std::pow(element.fading(i, Eigen::Index(t)), 2) /
                    (2 * relaxation_.terms()[t].share * stiffness);
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
    Eigen::Array3d softer = Eigen::Array3d::Ones();
    for (int i = 0; i < 3; ++i)
      if (stiffness[i] < stiffness_[i]) softer[i] = stiffness[i] / stiffness_[i];
    element.scale(softer);
    return_to_limit(element);
  }
  stiffness_ = stiffness;
}

void PreslidingElements::turn_axes(double angle_rad) {
  const double cosine = std::cos(angle_rad), sine = std::sin(angle_rad);
  Eigen::Matrix2d turn;
  turn << cosine, sine, -sine, cosine;
  for (Element& element : elements_) {
    element.wrench.head<2>() = (turn * element.wrench.head<2>()).eval();
    for (auto part : element.fading.colwise()) part.head<2>() = (turn * part.head<2>()).eval();
  }
}

void PreslidingElements::set_relaxation(const Relaxation& relaxation) {
  relaxation_ = relaxation;
  for (Element& element : elements_)
    element.fading.setZero(3, Eigen::Index(relaxation.terms().size()));
}

void PreslidingElements::relax(double time_s) {
  for (std::size_t i = 0; i < relaxation_.terms().size(); ++i) {
    const double lost = -std::expm1(-time_s / relaxation_.terms()[i].time_s);
    for (Element& element : elements_) {
      auto part = element.fading.col(Eigen::Index(i));
      element.wrench -= lost * part;
      part *= 1 - lost;
    }
  }
}

void PreslidingElements::move(const Eigen::Vector3d& displacement) {
  for (Element& element : elements_) {
    const Eigen::Vector3d change = -Eigen::Vector3d(element.force_stiffness * stiffness_.x(),
                                                    element.force_stiffness * stiffness_.y(),
                                                    element.torque_stiffness * stiffness_.z())
                                        .cwiseProduct(displacement);
    element.wrench += change;
    for (std::size_t i = 0; i < relaxation_.terms().size(); ++i)
      element.fading.col(Eigen::Index(i)) += relaxation_.terms()[i].share * change;
    return_to_limit(element);
  }
}

void PreslidingElements::Element::scale(const Eigen::Array3d& factors) {
  wrench.array() *= factors;
  fading.array().colwise() *= factors;
}

void PreslidingElements::return_to_limit(Element& element) const {
  const double force_N = element.force_limit * largest_force_N_,
               torque_Nm = element.torque_limit * largest_torque_Nm_;
  // An element that has no limit in one of the two does not take part in it.
  element.scale({double(force_N > 0), double(force_N > 0), double(torque_Nm > 0)});
  const double force = force_N > 0 ? element.wrench.head<2>().norm() / force_N : 0;
  const double torque = torque_Nm > 0 ? element.wrench.z() / torque_Nm : 0;
  const double used = std::hypot(force, torque);
  if (used > 1) element.scale(Eigen::Array3d::Constant(1 / used));
}

}  // namespace softfinger
