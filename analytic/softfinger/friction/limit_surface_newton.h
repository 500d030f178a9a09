#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/input/constants.h"

/// Internal to the limit surfaces: the two questions about a convex set that is known by its
/// support function h alone, both as maximisations over the unit sphere of directions t.
/// `evaluate(t, &hessian)` returns the gradient of h, that is the point of the set's boundary whose
/// outward normal is t, and the second derivatives of h (`hessian` may be null); h is homogeneous
/// of degree one. Bounded iterations, no allocation.
namespace softfinger::limit_surface_newton {

enum class Question {
  gauge,    ///< largest w . t / h(t): the factor by which w exceeds the set
  distance  ///< largest w . t - h(t): the distance of w from the set, t the direction of it
};

/// Newton's iteration in the tangent plane, with a line search that makes the objective grow in
/// every step, from `direction`, where it has to be positive. Stops when the step falls below 1e-9:
/// the objective is stationary in t, so that this error enters squared.
template <Question question, class Evaluate>
Eigen::Vector3d maximise(const Eigen::Vector3d& wrench, Eigen::Vector3d direction,
                         Evaluate evaluate) noexcept {
  // kRounding: relative error of `evaluate`. The line search cannot tell smaller improvements.
  constexpr int kMaxIterations = 60, kMaxHalvings = 40;
  constexpr double kConverged = 1e-9, kRounding = 1e-12;
  const auto objective = [&](const Eigen::Vector3d& t, double support) {
    return question == Question::gauge ? wrench.dot(t) / support : wrench.dot(t) - support;
  };
  direction.normalize();
  Eigen::Matrix3d hessian;
  Eigen::Vector3d boundary = evaluate(direction, &hessian);
  double value = objective(direction, boundary.dot(direction));
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    // Both are orthogonal to the direction, because h is homogeneous.
    const Eigen::Vector3d ascent = question == Question::gauge
                                       ? Eigen::Vector3d(wrench - value * boundary)
                                       : Eigen::Vector3d(wrench - boundary - value * direction);
    const Eigen::Vector3d e1 = direction.unitOrthogonal(), e2 = direction.cross(e1);
    const double weight = question == Question::gauge ? value : 1;
    const double shift = question == Question::gauge ? 0 : value;
    const double m11 = weight * e1.dot(hessian * e1) + shift;
    const double m22 = weight * e2.dot(hessian * e2) + shift;
    const double m12 = weight * e1.dot(hessian * e2);
    const double r1 = e1.dot(ascent), r2 = e2.dot(ascent);
    // Positive but for rounding, when one curvature is far below the other.
    const double determinant = std::max(m11 * m22 - m12 * m12, 1e-15 * m11 * m22);
    if (!(determinant > 0)) break;
    Eigen::Vector3d step = ((m22 * r1 - m12 * r2) * e1 + (m11 * r2 - m12 * r1) * e2) / determinant;
    const double length = step.norm();
    if (!std::isfinite(length)) break;
    if (length > 1) step /= length;
    double fraction = 1;
    bool moved = false;
    for (int halving = 0; halving < kMaxHalvings; ++halving, fraction *= 0.5) {
      const Eigen::Vector3d next = (direction + fraction * step).normalized();
      Eigen::Matrix3d next_hessian;
      const Eigen::Vector3d next_boundary = evaluate(next, &next_hessian);
      const double next_value = objective(next, next_boundary.dot(next));
      if (!(next_value >= value - kRounding * wrench.norm())) continue;
      direction = next;
      hessian = next_hessian;
      boundary = next_boundary;
      value = next_value;
      moved = true;
      break;
    }
    if (!moved || fraction * length <= kConverged) break;
  }
  return direction;
}

/// Gauge of the set at `wrench` (not zero), and the direction in which it is reached.
template <class Evaluate>
double gauge(const Eigen::Vector3d& wrench, Evaluate evaluate,
             Eigen::Vector3d* direction = nullptr) noexcept {
  // First guess: as on the unit ball, which a scaled limit surface resembles.
  const Eigen::Vector3d t = maximise<Question::gauge>(wrench, wrench, evaluate);
  if (direction) *direction = t;
  return wrench.dot(t) / evaluate(t, nullptr).dot(t);
}

/// load / limit, where a vanishing limit carries nothing.
inline double fraction(double load, double limit) noexcept {
  if (limit > 0) return load / limit;
  return load == 0 ? 0 : std::copysign(std::numeric_limits<double>::infinity(), load);
}

/// Factor by which a wrench exceeds a surface with the given pure force and pure torque, whose
/// shape in the scaled space (f / limit, tau / limit) `evaluate` knows.
template <class Evaluate>
double utilisation(const LimitWrench& wrench, const FrictionEllipsoid& limits,
                   Evaluate evaluate) noexcept {
  const Eigen::Vector3d scaled(fraction(wrench.force_x_N, limits.max_force_N),
                               fraction(wrench.force_y_N, limits.max_force_N),
                               fraction(wrench.torque_Nm, limits.max_torque_Nm()));
  const double largest = scaled.cwiseAbs().maxCoeff();
  if (!scaled.allFinite()) return std::numeric_limits<double>::infinity();
  if (largest == 0) return 0;
  if (!(limits.max_torque_Nm() > 0)) return std::hypot(scaled.x(), scaled.y());
  // A gauge scales with the wrench.
  return largest * gauge(Eigen::Vector3d(scaled / largest), evaluate);
}

/// The nearest wrench of the set in the scaled space; the wrench itself if it lies inside. Zero for
/// a wrench that is not finite.
template <class Evaluate>
LimitWrench project(const LimitWrench& wrench, const FrictionEllipsoid& limits,
                    Evaluate evaluate) noexcept {
  const Eigen::Vector3d load(wrench.force_x_N, wrench.force_y_N, wrench.torque_Nm);
  if (!load.allFinite() || !(limits.max_force_N > 0)) return {};
  if (!(limits.max_torque_Nm() > 0)) {
    const double norm = std::hypot(load.x(), load.y());
    const double shrink = norm > limits.max_force_N ? limits.max_force_N / norm : 1;
    return {load.x() * shrink, load.y() * shrink, 0};
  }
  // So far out, the nearest point no longer depends on the distance: a limit keeps squares finite.
  constexpr double kFar = 1e6;
  const Eigen::Vector3d limit(limits.max_force_N, limits.max_force_N, limits.max_torque_Nm());
  Eigen::Vector3d scaled = load.cwiseQuotient(limit);
  const double largest = scaled.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return wrench;
  if (!(largest <= kFar)) {
    scaled = load / load.cwiseAbs().maxCoeff();
    scaled = scaled.cwiseQuotient(limit / limit.maxCoeff());
    const double norm = scaled.cwiseAbs().maxCoeff();
    if (!(norm <= std::numeric_limits<double>::max()))
      return {0, 0, std::copysign(limit.z(), load.z())};
    scaled *= kFar / norm;
  }
  Eigen::Vector3d direction;
  if (gauge(scaled, evaluate, &direction) <= 1) return wrench;
  const Eigen::Vector3d nearest =
      evaluate(maximise<Question::distance>(scaled, direction, evaluate), nullptr);
  return {limit.x() * nearest.x(), limit.y() * nearest.y(), limit.z() * nearest.z()};
}

/// Whether utilisation <= 1, which most wrenches show without computing it.
template <class Evaluate>
bool contains(const LimitWrench& wrench, const FrictionEllipsoid& limits,
              Evaluate evaluate) noexcept {
  const double force = std::hypot(fraction(wrench.force_x_N, limits.max_force_N),
                                  fraction(wrench.force_y_N, limits.max_force_N));
  const double torque = std::abs(fraction(wrench.torque_Nm, limits.max_torque_Nm()));
  // The cylinder around the surface, and the double cone inside it, which is convex.
  if (force > 1 || torque > 1) return false;
  if (force + torque <= 1) return true;
  return utilisation(wrench, limits, evaluate) <= 1;
}

/// The twist in the scaled space, (v, arm omega), times a power of two: the product of a rate and a
/// tiny arm may underflow. Zero for a twist that is not finite.
inline Eigen::Vector3d scaled_twist(const Twist& twist, double arm_m) noexcept {
  const double speed =
      std::max(std::abs(twist.velocity_x_m_per_s), std::abs(twist.velocity_y_m_per_s));
  const double rate = twist.angular_velocity_rad_per_s;
  if (!(std::isfinite(speed) && std::isfinite(rate))) return Eigen::Vector3d::Zero();
  int arm_exponent = 0, exponent = 0;
  const double arm = std::frexp(arm_m, &arm_exponent);
  if (speed > 0) {
    std::frexp(speed, &exponent);
  } else {
    std::frexp(rate, &exponent);
    exponent += arm_exponent;
  }
  return {std::ldexp(twist.velocity_x_m_per_s, -exponent),
          std::ldexp(twist.velocity_y_m_per_s, -exponent),
          std::clamp(std::ldexp(rate * arm, arm_exponent - exponent), -1e300, 1e300)};
}

inline LimitWrench unscaled(const Eigen::Vector3d& wrench,
                            const FrictionEllipsoid& limits) noexcept {
  return {limits.max_force_N * wrench.x(), limits.max_force_N * wrench.y(),
          limits.max_torque_Nm() * wrench.z()};
}

/// Load that keeps the slider moving with this twist; see LimitSurface.
template <class Evaluate>
LimitWrench wrench_for_twist(const Twist& twist, const FrictionEllipsoid& limits,
                             Evaluate evaluate) noexcept {
  if (limits.max_torque_Nm() > 0)
    return unscaled(evaluate(scaled_twist(twist, limits.eccentricity_m), nullptr), limits);
  Eigen::Vector3d v = scaled_twist({twist.velocity_x_m_per_s, twist.velocity_y_m_per_s, 0}, 1);
  const double norm = v.norm();
  if (norm > 0) v /= norm;
  return unscaled(v, limits);
}

/// The point of the surface in this direction of the scaled space.
template <class Evaluate>
Eigen::Vector3d surface_point(const Eigen::Vector3d& direction, const FrictionEllipsoid& limits,
                              Evaluate evaluate) noexcept {
  if (!(limits.max_torque_Nm() > 0)) {
    const double force = std::hypot(direction.x(), direction.y());
    return force > 0 ? Eigen::Vector3d(direction.x() / force, direction.y() / force, 0)
                     : Eigen::Vector3d::Zero();
  }
  if (direction.z() == 0 || (direction.x() == 0 && direction.y() == 0))
    return direction.normalized();
  return direction / gauge(direction, evaluate);
}

/// See LimitSurface::sample.
template <class Evaluate>
std::vector<LimitWrench> sample(int count, const FrictionEllipsoid& limits, Evaluate evaluate) {
  constexpr double kGoldenAngle = 2.39996322972865332223;
  std::vector<LimitWrench> points;
  if (count <= 0) return points;
  points.reserve(count);
  const int half = count / 2;
  for (int i = 0; i < half; ++i) {
    const double z = (i + 0.5) / half, radius = std::sqrt((1 - z) * (1 + z));
    const Eigen::Vector3d direction(radius * std::cos(kGoldenAngle * i),
                                    radius * std::sin(kGoldenAngle * i), z);
    points.push_back(unscaled(surface_point(direction, limits, evaluate), limits));
  }
  for (int i = 0; i < half; ++i)
    points.push_back({-points[i].force_x_N, -points[i].force_y_N, -points[i].torque_Nm});
  if (count % 2) points.push_back({0, 0, limits.max_torque_Nm()});
  return points;
}

/// See LimitSurface::sample_section.
template <class Evaluate>
std::vector<LimitWrench> sample_section(double direction_rad, int count,
                                        const FrictionEllipsoid& limits, Evaluate evaluate) {
  std::vector<LimitWrench> section(count > 0 ? count : 0);
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * kPi * i / count;
    const Eigen::Vector3d direction(std::cos(angle) * std::cos(direction_rad),
                                    std::cos(angle) * std::sin(direction_rad), std::sin(angle));
    section[i] = unscaled(surface_point(direction, limits, evaluate), limits);
  }
  return section;
}

/// A piece of a contact, of a `share` of the load at (x, y), with a friction ellipsoid of its own
/// of the given arm (lengths over e_n): adds its wrench and the derivative of it. Its support
/// function is `share` times the norm of a linear map of the twist with the columns (1, 0, 0), (0,
/// 1, 0),
/// (-y, x, arm). A piece that does not move, without an arm, adds nothing.
inline void add_piece(const Eigen::Vector3d& twist, double x, double y, double arm, double share,
                      Eigen::Vector3d& wrench, Eigen::Matrix3d* hessian) noexcept {
  // A velocity that is rounding error has no direction.
  constexpr double kStill = 1e-15;
  const double vx = twist.x() - twist.z() * y, vy = twist.y() + twist.z() * x;
  const double spin = twist.z() * arm;
  const double speed = std::sqrt(vx * vx + vy * vy + spin * spin);
  if (!(speed > kStill * (std::abs(twist.x()) + std::abs(twist.y()) +
                          std::abs(twist.z()) * (std::abs(x) + std::abs(y)))))
    return;
  const double ux = vx / speed, uy = vy / speed, us = spin / speed;
  const Eigen::Vector3d gradient(ux, uy, x * uy - y * ux + arm * us);
  wrench += share * gradient;
  if (!hessian) return;
  Eigen::Matrix3d metric;
  metric << 1, 0, -y, 0, 1, x, -y, x, x * x + y * y + arm * arm;
  *hessian += share / speed * (metric - gradient * gradient.transpose());
}

}  // namespace softfinger::limit_surface_newton
