#include "softfinger/friction/shear_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "softfinger/friction/limit_surface_newton.h"
#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

/// Tanh-sinh nodes on (0, 1) by their distance from the nearer end, and weights. The outermost is
/// 2e-17 of the length away; the step leaves 1e-10 for integrands like x ln x at the ends (see the
/// tests).
constexpr int kHalfNodes = 20;
struct DoubleExponential {
  DoubleExponential() {
    constexpr double kStep = 0.16;
    for (int i = 0; i <= kHalfNodes; ++i) {
      const double t = kStep * i, u = kPi / 2 * std::sinh(t);
      distance[i] = 1 / (1 + std::exp(2 * u));
      weight[i] = kStep * kPi * std::cosh(t) * distance[i] * (1 - distance[i]);
    }
  }
  std::array<double, kHalfNodes + 1> distance, weight;
};

/// Calls f(x, weight) for the nodes of an integral over [low, high].
template <class Function>
void integrate(double low, double high, Function f) noexcept {
  static const DoubleExponential rule;
  const double length = high - low;
  if (!(length > 0)) return;
  f(low + length / 2, length * rule.weight[0]);
  for (int i = 1; i <= kHalfNodes; ++i) {
    f(low + length * rule.distance[i], length * rule.weight[i]);
    f(high - length * rule.distance[i], length * rule.weight[i]);
  }
}

/// The part mu p, or none of it.
LimitSurface friction_part(const ShearLaw& law, const PressedEllipse& contact, bool limits) {
  const bool has = law.has_friction_coefficient() && !limits;
  return {contact.a_m, contact.b_m, contact.exponent,
          has ? law.friction_coefficient * contact.load_N : 0};
}

/// The part tau_0, or none of it.
LimitSurface uniform_part(const ShearLaw& law, const PressedEllipse& contact, bool limits) {
  const bool is_added =
      law.kind == ShearLaw::Kind::shear_strength || law.kind == ShearLaw::Kind::adhesive_shear;
  // If the pressure grows towards the rim, the strength limits the stress at the rim.
  const bool has = is_added || (limits && contact.exponent <= 0);
  return {contact.a_m, contact.b_m, 0,
          has ? kPi * contact.a_m * contact.b_m * law.shear_strength_Pa : 0};
}

/// Whether the strength limits the friction anywhere.
bool limits(const ShearLaw& law, const PressedEllipse& contact) {
  if (law.kind != ShearLaw::Kind::limited) return false;
  const double w = internal::depth_of_strength(law, contact);
  return contact.exponent < 0 ? w > 0 : w < 1;
}

/// The discs' variable is x = w^power, w = 1 - s²: neither w(x) nor dtau/dx, tau = mu p_0 w^n, is
/// then singular at the rim.
double depth_power(double exponent) { return exponent > 0 ? std::min(exponent, 1.0) : 1; }

/// Adds `share` of a uniform or pressed surface whose arm is `arm` of the whole one's.
void add_part(const LimitSurface& surface, double share, double arm, const Eigen::Vector3d& twist,
              Eigen::Vector3d& wrench, Eigen::Matrix3d* hessian) noexcept {
  Eigen::Matrix3d part;
  const Eigen::Vector3d scale(1, 1, arm);
  wrench += share * scale.cwiseProduct(surface.scaled_wrench(scale.cwiseProduct(twist),
                                                             hessian ? &part : nullptr));
  if (hessian) *hessian += share * (scale.asDiagonal() * part * scale.asDiagonal());
}

}  // namespace

ShearSurface::ShearSurface(const ShearLaw& law, const PressedEllipse& contact) noexcept
    : ellipsoid_(friction_ellipsoid(law, contact)),
      exponent_(contact.exponent),
      friction_(friction_part(law, contact, limits(law, contact))),
      uniform_(uniform_part(law, contact, limits(law, contact))) {
  if (!limits(law, contact) || contact.exponent == 0 || !(ellipsoid_.max_force_N > 0)) return;
  const double w = internal::depth_of_strength(law, contact);
  disc_force_ =
      (exponent_ + 1) * law.friction_coefficient * contact.load_N / ellipsoid_.max_force_N;
  lowest_ = exponent_ < 0 ? w : 0;
  highest_ = exponent_ < 0 ? 1 : std::pow(w, depth_power(exponent_));
}

auto ShearSurface::evaluator() const noexcept {
  return [this](const Eigen::Vector3d& twist, Eigen::Matrix3d* hessian) {
    return scaled_wrench(twist, hessian);
  };
}

void ShearSurface::add_discs(const Eigen::Vector3d& twist, Eigen::Vector3d& wrench,
                             Eigen::Matrix3d* hessian) const noexcept {
  const double n = exponent_, power = depth_power(n);
  const double arm = uniform_.eccentricity_m() / ellipsoid_.eccentricity_m;
  const auto add = [&](double x, double weight) {
    const double w = std::pow(x, 1 / power), s2 = 1 - w;
    if (!(s2 > 0)) return;
    const double slope = n / power * std::pow(x, n / power - 1);  // d(w^n)/dx
    add_part(uniform_, disc_force_ * weight * slope * s2, arm * std::sqrt(s2), twist, wrench,
             hessian);
  };
  // Centre of rotation, where the ellipse is the unit circle.
  const double aspect = uniform_.b_m() / uniform_.a_m();
  const double spin = std::abs(twist.z()) * uniform_.a_m() / ellipsoid_.eccentricity_m;
  const double x = std::abs(twist.y()) / spin, y = std::abs(twist.x()) / (aspect * spin);
  const auto disc_of_radius = [&](double s) {
    const double variable = s < 1 ? std::pow((1 - s) * (1 + s), power) : 0;
    return std::clamp(variable, lowest_, highest_);
  };
  // A disc's wrench is singular in s where its edge is at the centre of rotation, and, for complex
  // s, where a focus is: s sqrt(a² - b²) = x a + i y b, close to the real axis for long ellipses.
  double at_edge = disc_of_radius(std::hypot(x, y));
  double at_focus = disc_of_radius(x / std::sqrt((1 - aspect) * (1 + aspect)));
  if (at_focus < at_edge) std::swap(at_focus, at_edge);
  integrate(lowest_, at_edge, add);
  integrate(at_edge, at_focus, add);
  integrate(at_focus, highest_, add);
}

Eigen::Vector3d ShearSurface::scaled_wrench(const Eigen::Vector3d& twist,
                                            Eigen::Matrix3d* hessian) const noexcept {
  Eigen::Vector3d wrench = Eigen::Vector3d::Zero();
  if (hessian) hessian->setZero();
  if (!(max_torque_Nm() > 0)) return wrench;
  for (const LimitSurface* part : {&friction_, &uniform_})
    if (part->max_force_N() > 0)
      add_part(*part, part->max_force_N() / max_force_N(),
               part->eccentricity_m() / eccentricity_m(), twist, wrench, hessian);
  if (disc_force_ > 0) add_discs(twist, wrench, hessian);
  return wrench;
}

LimitWrench ShearSurface::wrench_for_twist(const Twist& twist) const noexcept {
  return limit_surface_newton::wrench_for_twist(twist, ellipsoid_, evaluator());
}

double ShearSurface::support(const Twist& twist) const noexcept {
  const LimitWrench wrench = wrench_for_twist(twist);
  return wrench.force_x_N * twist.velocity_x_m_per_s + wrench.force_y_N * twist.velocity_y_m_per_s +
         wrench.torque_Nm * twist.angular_velocity_rad_per_s;
}

double ShearSurface::utilisation(const LimitWrench& wrench) const noexcept {
  return limit_surface_newton::utilisation(wrench, ellipsoid_, evaluator());
}

bool ShearSurface::contains(const LimitWrench& wrench) const noexcept {
  return limit_surface_newton::contains(wrench, ellipsoid_, evaluator());
}

LimitWrench ShearSurface::project(const LimitWrench& wrench) const noexcept {
  return limit_surface_newton::project(wrench, ellipsoid_, evaluator());
}

std::vector<LimitWrench> ShearSurface::sample(int count) const {
  return limit_surface_newton::sample(count, ellipsoid_, evaluator());
}

std::vector<LimitWrench> ShearSurface::sample_section(double direction_rad, int count) const {
  return limit_surface_newton::sample_section(direction_rad, count, ellipsoid_, evaluator());
}

}  // namespace softfinger
