#include "softfinger/friction/limit_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/friction/limit_surface_newton.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/input/constants.h"
#include "softfinger/math/elliptic_integrals.h"

namespace softfinger {
namespace {

/// Gauss' hypergeometric series; for 0 <= z <= 0.6 and the parameters here 70 terms suffice.
double hypergeometric(double a, double b, double c, double z) noexcept {
  constexpr int kMaxTerms = 120;
  double sum = 1, term = 1;
  for (int k = 0; k < kMaxTerms; ++k) {
    term *= (a + k) * (b + k) / ((c + k) * (k + 1.0)) * z;
    sum += term;
    if (std::abs(term) <= 1e-17 * std::abs(sum)) break;
  }
  return sum;
}

/// `vector` divided by a power of two near its largest component, so that squares neither overflow
/// nor underflow; zero for zero, and for anything not finite.
Eigen::Vector3d normalised(const Eigen::Vector3d& vector) noexcept {
  const double largest = vector.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !vector.allFinite()) return Eigen::Vector3d::Zero();
  // In two steps: the inverse of a subnormal number overflows.
  int exponent = 0;
  std::frexp(largest, &exponent);
  return {std::ldexp(vector.x(), -exponent), std::ldexp(vector.y(), -exponent),
          std::ldexp(vector.z(), -exponent)};
}

}  // namespace

/// A twist seen from the ellipse scaled to the unit circle, a = 1, turning counter-clockwise.
struct LimitSurface::Motion {
  double omega = 0;             ///< angular velocity times a
  double speed = 0;             ///< |(-v_y, v_x a/b)|: omega times the distance c of the centre
  double cosine = 1, sine = 0;  ///< of the direction from the middle to the centre of rotation
};

/// Results of the quadratures for mu P = a = 1.
struct LimitSurface::Integrals {
  double force_x = 0, force_y = 0, torque = 0;
  // Second derivatives of the support function with respect to (v_x, v_y, omega a).
  double xx = 0, xy = 0, yy = 0, xw = 0, yw = 0, ww = 0;
};

LimitSurface::LimitSurface(double a_m, double b_m, double exponent, double max_force_N) noexcept
    : exponent_(exponent) {
  // Thinner ellipses are replaced by this one, which is a line to a relative (b/a)² ln(a/b) =
  // 2e-12: they would only lose digits.
  constexpr double kSmallestAspect = 3e-7, kLargestExponent = 1000;
  constexpr double kLargest = std::numeric_limits<double>::max();
  if (max_force_N >= 0 && max_force_N <= kLargest) max_force_N_ = max_force_N;
  const bool in_range =
      b_m > 0 && a_m >= b_m && a_m <= kLargest && exponent > -1 && exponent <= kLargestExponent;
  if (!in_range) return;
  a_m_ = a_m;
  b_m_ = b_m;
  aspect_ = std::max(b_m / a_m, kSmallestAspect);
  const double circle_arm = torque_arm_exact_m(1, 1, exponent);
  prefactor_ = circle_arm * (2 * exponent + 3) / kPi;
  const EllipticIntegrals integrals = elliptic_integrals(aspect_ * aspect_);
  arm_over_a_ = circle_arm * integrals.E() * (2 / kPi);
  quarter_period_ = integrals.K();
  eccentricity_m_ = arm_over_a_ * a_m;
  if (2 * exponent == 0 || 2 * exponent == 1 || 2 * exponent == 2 || 2 * exponent == 4)
    twice_power_ = int(2 * exponent) + 1;
  // The integrand is about sech(w)^m, m = 2n+4: the rule's error, the least of
  // exp(-2 pi y/step) cos(y)^-m over the strip's y < pi/2, is then 1e-15 for every m.
  line_step_ = 0.75 / std::sqrt(2 * exponent + 13);

  // Quarter period halved again and again, by the half-argument formulas. In the second quarter,
  // where cn is negative, they are written so that nothing cancels.
  const int last = kNodes - 1;
  sn_[0] = 0, cn_[0] = 1, dn_[0] = 1;
  sn_[last] = 1, cn_[last] = 0, dn_[last] = aspect_;
  for (int stride = last; stride > 1; stride /= 2) {
    for (int j = stride / 2; j < last; j += stride) {
      const bool second = 2 * j > last;
      const int twice = second ? 2 * last - 2 * j : 2 * j;
      const double s = sn_[twice], c = cn_[twice], d = dn_[twice];
      const double one_plus_cn = second ? s * s / (1 + c) : 1 + c;
      const double dn_plus_cn = second ? aspect_ * s * (aspect_ * s) / (d + c) : d + c;
      sn_[j] = s / std::sqrt(one_plus_cn * (1 + d));
      cn_[j] = std::sqrt(dn_plus_cn / (1 + d));
      dn_[j] = std::sqrt(dn_plus_cn / one_plus_cn);
    }
  }
}

FrictionEllipsoid LimitSurface::paper_ellipsoid() const noexcept {
  return {max_force_N_, carries_torque() ? torque_arm_paper_m(a_m_, b_m_, exponent_) : 0};
}

/// base^(n + 1/2) for base >= 0.
inline double LimitSurface::power(double base) const noexcept {
  switch (twice_power_) {
    case 1:
      return std::sqrt(base);
    case 2:
      return base;
    case 3:
      return base * std::sqrt(base);
    case 5:
      return base * base * std::sqrt(base);
    default:
      return std::pow(base, exponent_ + 0.5);
  }
}

/// The hypergeometric closed forms of a circle, where their series converge fast and without
/// cancellation.
bool LimitSurface::circle_series(const Motion& motion, Integrals& integrals) const noexcept {
  constexpr double kLargestRatio = 0.75, kLargestExponent = 3;
  const double n = exponent_;
  double force;
  if (motion.speed <= kLargestRatio * motion.omega && n <= kLargestExponent) {
    const double c = motion.speed / motion.omega;
    force = prefactor_ * (kPi / 2) * c * hypergeometric(-n - 0.5, 0.5, 2, c * c);
    integrals.torque = arm_over_a_ * hypergeometric(-n - 1.5, 0.5, 1, c * c);
  } else if (motion.omega <= kLargestRatio * motion.speed) {
    const double inverse = motion.omega / motion.speed;
    force = hypergeometric(-0.5, 0.5, n + 2, inverse * inverse);
    integrals.torque = 0.5 / (n + 2) * inverse * hypergeometric(0.5, 0.5, n + 3, inverse * inverse);
  } else {
    return false;
  }
  integrals.force_x = force * motion.sine;
  integrals.force_y = -force * motion.cosine;
  return true;
}

/// Trapezoidal rule over a period of t = am(u): r = dn(u), dt = dn du. Starts with 2^4 nodes and
/// halves the step until two results agree to the root of the precision wanted, since halving
/// squares the error. False if the nodes at hand do not suffice: the centre is close to the edge.
bool LimitSurface::integrate_over_turn(const Motion& motion, Integrals& integrals,
                                       bool hessian) const noexcept {
  constexpr double kAgreement = 5e-8;
  constexpr int kFirstLevel = 3;
  const double c = motion.speed / motion.omega;
  // Too close to the branch points of (1 - q²)^(n + 1/2) the rule would not converge.
  if (twice_power_ != 2 && c > 0.93) return false;
  if (c > 1) return false;
  const double center_x = c * motion.cosine, center_y = c * motion.sine;
  const double power_of_aspect = aspect_ * aspect_;
  Integrals sum;
  double previous[3] = {0, 0, 0};
  const auto add = [&](double s, double cn, double dn) {
    const double q = center_y * cn - center_x * s;
    const double depth = (1 - q) * (1 + q);
    const double weight = power(depth);
    const double along = (center_x * cn + center_y * s) * weight;
    const double inverse = power_of_aspect / (dn * dn);
    sum.force_x += along * aspect_ * s;
    sum.force_y -= along * cn;
    sum.torque += weight * depth * inverse;
    if (hessian) {
      const double g = weight / (dn * dn), y = aspect_ * s, w = -aspect_ * q;
      sum.xx += g * cn * cn;
      sum.xy += g * cn * y;
      sum.yy += g * y * y;
      sum.xw += g * cn * w;
      sum.yw += g * y * w;
      sum.ww += g * w * w;
    }
  };
  const int last = kNodes - 1;
  for (int level = kFirstLevel; level <= kLevels; ++level) {
    const int stride = 1 << (kLevels - level);
    const bool first = level == kFirstLevel;
    if (first) {
      add(0, 1, 1);
      add(1, 0, aspect_);
    }
    for (int j = stride; j < last; j += first ? stride : 2 * stride) {
      add(sn_[j], cn_[j], dn_[j]);
      add(sn_[j], -cn_[j], dn_[j]);
    }
    const double step = prefactor_ * quarter_period_ * stride / last;
    const double torque_factor = 1 / (2 * exponent_ + 3);
    const double now[3] = {step * sum.force_x, step * sum.force_y,
                           step * torque_factor * sum.torque};
    const double change = std::max({std::abs(now[0] - previous[0]), std::abs(now[1] - previous[1]),
                                    std::abs(now[2] - previous[2]) / arm_over_a_});
    if (!first && change <= kAgreement) {
      integrals.force_x = now[0];
      integrals.force_y = now[1];
      integrals.torque = now[2];
      const double factor = step / motion.omega;
      integrals.xx = factor * sum.xx;
      integrals.xy = factor * sum.xy;
      integrals.yy = factor * sum.yy;
      integrals.xw = factor * sum.xw;
      integrals.yw = factor * sum.yw;
      integrals.ww = factor * sum.ww;
      return true;
    }
    std::copy(now, now + 3, previous);
  }
  return false;
}

/// Trapezoidal rule over the whole line, for a centre of rotation anywhere: with d the angle from
/// the direction to the centre, sin d = q/c, q = min(c, 1) tanh w.
void LimitSurface::integrate_over_line(const Motion& motion, Integrals& integrals,
                                       bool hessian) const noexcept {
  constexpr double kNegligible = 1e-16;
  constexpr int kMaxNodesPerSide = 4000;
  const bool outside = motion.speed >= motion.omega;
  const double c = outside ? 1 : motion.speed / motion.omega;        // min(c, 1)
  const double inverse = outside ? motion.omega / motion.speed : 1;  // min(1/c, 1)
  const double depth_at_end = outside ? 0 : (1 - c) * (1 + c);
  const double cosine_at_end = outside ? (1 - inverse) * (1 + inverse) : 0;

  // r² = cos² t + (b/a)² sin² t vanishes at t = pi/2 +- i eta. Its place in the plane of w:
  double x = 0, sin_y = 1, scale = 1;
  if (aspect_ < 1) {
    // cosh(eta), sinh(eta) of tanh(eta) = b/a; then q = c sin(direction - t) = c (re + i im).
    const double cosh_eta = 1 / std::sqrt((1 - aspect_) * (1 + aspect_));
    const double sinh_eta = aspect_ * cosh_eta;
    const double toward = motion.sine < 0 ? -1 : 1;  // of t and t + pi, the one in this half-turn
    const double distance = outside ? 1 / std::max(inverse, 1e-100) : 1;
    const double re = -toward * motion.cosine * cosh_eta * distance;
    const double im = std::abs(motion.sine) * sinh_eta * distance;
    if (std::abs(re) < 1e100 && im < 1e100) {
      const double im2 = im * im;
      const double plus = (1 + re) * (1 + re) + im2, minus = (1 - re) * (1 - re) + im2;
      // tanh(w) = re + i im: x within the reach of the weights, however far the zero is.
      x = std::clamp(0.25 * std::log(std::max(plus, 1e-300) / std::max(minus, 1e-300)), -40.0,
                     40.0);
      const double y = 0.5 * std::atan2(2 * im, (1 - re) * (1 + re) - im2);
      sin_y = std::clamp(std::sin(y), 1e-30, 1.0);
    }
    scale = aspect_;
  }
  const double exp_x = std::exp(x);
  // Beyond this |w| the integrand only decays.
  const double exp_features = 8 * std::max(exp_x, 1 / exp_x) / scale;

  Integrals sum;
  double torque_sum = 0, force_sum = 0;
  const double h = line_step_;
  const double growth = std::exp(h), decay = 1 / growth;
  // One node, at sinh(v); returns whether its contribution matters.
  const auto add = [&](double sinh_v, double cosh_v) {
    const double sinh_shift = sin_y * sinh_v;
    const double cosh_shift = std::sqrt(1 + sinh_shift * sinh_shift);
    const double reach = cosh_shift + std::abs(sinh_shift);
    // exp(w) as a ratio, so that one division does for all that follows.
    const double over = sinh_shift < 0 ? exp_x : exp_x * reach;
    const double under = sinh_shift < 0 ? reach : 1;
    const double over2 = over * over, under2 = under * under;
    const double inverse_sum = 1 / ((over2 + under2) * cosh_shift);
    const double sech = 2 * over * under * cosh_shift * inverse_sum;
    const double tanh = (over2 - under2) * cosh_shift * inverse_sum;
    const double jacobian = sin_y * cosh_v * (over2 + under2) * inverse_sum;  // dw/dv
    const double sech2 = sech * sech;
    const double q = c * tanh;
    const double depth = outside ? sech2 : depth_at_end + c * c * sech2;
    const double sin_d = inverse * tanh;
    const double cos_d = outside ? std::sqrt(cosine_at_end + inverse * inverse * sech2) : sech;
    // (1 - q²)^(n+1/2) |dt/dv| max(c, 1) cos d
    const double weight_cos_d =
        outside ? jacobian * power(sech2) * sech2 : jacobian * power(depth) * sech2;
    const double cos_t = motion.cosine * cos_d + motion.sine * sin_d;
    const double sin_t = motion.sine * cos_d - motion.cosine * sin_d;
    const double y = aspect_ * sin_t;
    const double r2 = cos_t * cos_t + y * y;
    const double inverse_r = 1 / std::sqrt(r2);
    const double along = weight_cos_d * inverse_r;
    sum.force_x += along * y;
    sum.force_y -= along * cos_t;
    // (1 - q²)^(n+1/2) |dt/dv| max(c, 1) / r³
    const double g = along / (r2 * cos_d);
    const double torque = g * depth;
    sum.torque += torque;
    torque_sum += torque;
    force_sum += weight_cos_d;
    if (hessian) {
      const double w = -aspect_ * q;
      sum.xx += g * cos_t * cos_t;
      sum.xy += g * cos_t * y;
      sum.yy += g * y * y;
      sum.xw += g * cos_t * w;
      sum.yw += g * y * w;
      sum.ww += g * w * w;
    }
    return torque > kNegligible * torque_sum || weight_cos_d > kNegligible * force_sum ||
           (over < exp_features * under && under < exp_features * over);
  };
  add(0, 1);
  for (const double side : {1.0, -1.0}) {
    double exp_v = growth, exp_minus_v = decay;
    for (int i = 1; i <= kMaxNodesPerSide && exp_v < 1e60; ++i) {
      if (!add(side * 0.5 * (exp_v - exp_minus_v), 0.5 * (exp_v + exp_minus_v))) break;
      exp_v *= growth;
      exp_minus_v *= decay;
    }
  }
  const double factor = prefactor_ * h;
  integrals.force_x = c * factor * sum.force_x;
  integrals.force_y = c * factor * sum.force_y;
  integrals.torque = inverse * factor * aspect_ * aspect_ / (2 * exponent_ + 3) * sum.torque;
  const double per_speed = factor / std::max(motion.speed, motion.omega);
  integrals.xx = per_speed * sum.xx;
  integrals.xy = per_speed * sum.xy;
  integrals.yy = per_speed * sum.yy;
  integrals.xw = per_speed * sum.xw;
  integrals.yw = per_speed * sum.yw;
  integrals.ww = per_speed * sum.ww;
}

Eigen::Vector3d LimitSurface::scaled_wrench(const Eigen::Vector3d& twist,
                                            Eigen::Matrix3d* hessian) const noexcept {
  // Counter-clockwise, by symmetry; (v, omega a) with the twist's largest component near one.
  const double sign = twist.z() < 0 ? -1 : 1;
  Eigen::Vector3d t = sign * normalised(twist);
  if (!(t.cwiseAbs().maxCoeff() > 0)) {
    if (hessian) hessian->setZero();
    return Eigen::Vector3d::Zero();
  }
  t.z() /= arm_over_a_;
  Motion motion;
  motion.omega = t.z();
  const double center_x = -t.y(), center_y = t.x() / aspect_;
  motion.speed = std::hypot(center_x, center_y);
  if (motion.speed > 0) {
    motion.cosine = center_x / motion.speed;
    motion.sine = center_y / motion.speed;
  }
  Integrals integrals;
  const bool series = aspect_ == 1 && !hessian && circle_series(motion, integrals);
  const bool turn = !series && motion.speed < motion.omega &&
                    integrate_over_turn(motion, integrals, hessian != nullptr);
  if (!series && !turn) integrate_over_line(motion, integrals, hessian != nullptr);

  if (hessian) {
    const double e = arm_over_a_;
    *hessian << integrals.xx, integrals.xy, integrals.xw / e,  //
        integrals.xy, integrals.yy, integrals.yw / e,          //
        integrals.xw / e, integrals.yw / e, integrals.ww / (e * e);
    // The derivative belongs to the normalised twist.
    int exponent = 0;
    std::frexp(twist.cwiseAbs().maxCoeff(), &exponent);
    *hessian *= std::ldexp(1.0, -exponent);
  }
  return sign *
         Eigen::Vector3d(integrals.force_x, integrals.force_y, integrals.torque / arm_over_a_);
}

/// Returns the `evaluate` argument of limit_surface_newton.h: gradient and Hessian of the support
/// function.
auto LimitSurface::evaluator() const noexcept {
  return [this](const Eigen::Vector3d& twist, Eigen::Matrix3d* hessian) {
    return scaled_wrench(twist, hessian);
  };
}

LimitWrench LimitSurface::wrench_for_twist(const Twist& twist) const noexcept {
  return limit_surface_newton::wrench_for_twist(twist, ellipsoid(), evaluator());
}

LimitWrench LimitSurface::wrench_for_center_of_rotation(double x_m, double y_m) const noexcept {
  // v = omega z x (0 - center) = omega (y, -x)
  const bool x_infinite = std::isinf(x_m), y_infinite = std::isinf(y_m);
  if (x_infinite || y_infinite)
    return wrench_for_twist(
        {y_infinite ? std::copysign(1, y_m) : 0, x_infinite ? -std::copysign(1, x_m) : 0, 0});
  return wrench_for_twist({y_m, -x_m, 1});
}

double LimitSurface::support(const Twist& twist) const noexcept {
  const LimitWrench wrench = wrench_for_twist(twist);
  return wrench.force_x_N * twist.velocity_x_m_per_s + wrench.force_y_N * twist.velocity_y_m_per_s +
         wrench.torque_Nm * twist.angular_velocity_rad_per_s;
}

double LimitSurface::utilisation(const LimitWrench& wrench) const noexcept {
  return limit_surface_newton::utilisation(wrench, ellipsoid(), evaluator());
}

bool LimitSurface::contains(const LimitWrench& wrench) const noexcept {
  return limit_surface_newton::contains(wrench, ellipsoid(), evaluator());
}

LimitWrench LimitSurface::project(const LimitWrench& wrench) const noexcept {
  return limit_surface_newton::project(wrench, ellipsoid(), evaluator());
}

std::vector<LimitWrench> LimitSurface::sample(int count) const {
  return limit_surface_newton::sample(count, ellipsoid(), evaluator());
}

std::vector<LimitWrench> LimitSurface::sample_section(double direction_rad, int count) const {
  return limit_surface_newton::sample_section(direction_rad, count, ellipsoid(), evaluator());
}

}  // namespace softfinger
