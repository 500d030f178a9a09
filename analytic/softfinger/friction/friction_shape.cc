#include "softfinger/friction/friction_shape.h"

#include <algorithm>
#include <cmath>

#include "softfinger/friction/limit_surface_newton.h"

namespace softfinger {
namespace {

/// Euclid's length. Eigen's stable one takes several times as long, and is needed only where
/// squares leave the range of doubles.
inline double length_of(const Eigen::Vector3d& vector) noexcept {
  const double squares = vector.squaredNorm();
  return squares > 1e-200 && squares < 1e200 ? std::sqrt(squares) : vector.stableNorm();
}

/// Largest kappa with f = sum (target_i/(kappa + radius_i))² = 1, where that sum is above 1 at 0:
/// the length of the excess of a ball. 1/sqrt f is increasing and concave in kappa, so that
/// Newton's iteration comes from below and does not overshoot. With the radii's mean, each with the
/// weight target_i², in place of all radii f is less (Jensen), which gives a start below kappa.
double excess_length(const Eigen::Vector3d& target, const Eigen::Vector3d& radii) noexcept {
  constexpr int kMostIterations = 60;
  constexpr double kSmall = 1e-8;  // of kappa: the next step is its square
  const double reach = length_of(target);
  const double mean = (target / reach).array().square().matrix().dot(radii);
  double kappa = std::max(0., reach - mean);
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    const Eigen::Array3d inverse = (radii.array() + kappa).inverse();
    const Eigen::Vector3d ratio = target.array() * inverse;
    const double length = length_of(ratio);
    const double slope = (ratio.array().square() * inverse).sum();
    const double step = (length - 1) * length * length / slope;
    if (!(step > 0)) break;
    kappa += step;
    if (step <= kSmall * kappa) break;
  }
  return kappa;
}

}  // namespace

FrictionExcess friction_excess(const FrictionShape* shape, const Eigen::Vector3d& target,
                               double radius, const Eigen::Vector3d& metric) noexcept {
  FrictionExcess result;
  if (!(target.squaredNorm() > 0)) return result;
  const Eigen::Vector3d radii = radius * metric;
  if (!shape) {
    if (radius > 0 && length_of(target.cwiseQuotient(radii)) <= 1) return result;
    const double length = radius > 0 ? excess_length(target, radii) : length_of(target);
    if (!(length > 0)) return result;
    result.boundary = target.cwiseQuotient((radii.array() + length).matrix());
    result.boundary *= 1 / length_of(result.boundary);
    result.excess = length * result.boundary;
    result.hessian = (Eigen::Matrix3d::Identity() - result.boundary * result.boundary.transpose()) *
                     (1 / length);
    return result;
  }
  // With x = A^(1/2) s the distance is Euclid's, and the set's support function is h(A^(1/2) t).
  using namespace limit_surface_newton;
  const Eigen::Vector3d root = metric.cwiseSqrt();
  const auto evaluate = [&](const Eigen::Vector3d& t, Eigen::Matrix3d* hessian) {
    const Eigen::Vector3d point = shape->boundary(root.cwiseProduct(t), hessian);
    if (hessian) *hessian = root.asDiagonal() * *hessian * root.asDiagonal();
    return Eigen::Vector3d(root.cwiseProduct(point));
  };
  const Eigen::Vector3d reach = target.cwiseQuotient(root);
  Eigen::Vector3d direction = reach;
  // Far outside, the distance would be a difference of large numbers. There the point reached does
  // not depend on it: it is that of the target's own direction.
  constexpr double kFar = 1e9;
  if (radius > 0 && reach.norm() < kFar * radius * root.maxCoeff()) {
    const Eigen::Vector3d scaled = reach / radius, load = scaled.cwiseQuotient(root);
    // Shapes contain the double cone |f| + |tau| <= 1.
    if (std::hypot(load.x(), load.y()) + std::abs(load.z()) <= 1 ||
        friction_gauge(shape, load) <= 1)
      return result;
    gauge(scaled, evaluate, &direction);
    direction = maximise<Question::distance>(scaled, direction, evaluate);
    const double distance = direction.dot(scaled - evaluate(direction, nullptr));
    if (!(distance > 0)) return result;
    direction *= radius * distance;
  } else {
    direction -= radius * evaluate(direction, nullptr);
  }
  result.excess = root.cwiseProduct(direction);
  result.boundary = shape->boundary(result.excess, &result.hessian);
  return result;
}

double friction_gauge(const FrictionShape* shape, const Eigen::Vector3d& wrench) noexcept {
  const double size = wrench.stableNorm();
  if (!shape || !(size > 0)) return size;
  // A gauge is proportional to the wrench, which is scaled so that squares stay finite.
  return size *
         limit_surface_newton::gauge(Eigen::Vector3d(wrench / size),
                                     [shape](const Eigen::Vector3d& t, Eigen::Matrix3d* hessian) {
                                       return shape->boundary(t, hessian);
                                     });
}

}  // namespace softfinger
