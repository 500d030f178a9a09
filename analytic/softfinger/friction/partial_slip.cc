#include "softfinger/friction/partial_slip.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <complex>

#include "softfinger/friction/max_torque.h"
#include "softfinger/input/constants.h"
#include "softfinger/math/gauss_legendre.h"

namespace softfinger {
namespace {

/// a/h: from here on the curves differ by 1.5 % of T_max or less, down to the thin layer's.
constexpr double kLargestSize = 30;

/// A point of a curve and its slope there.
struct CurvePoint {
  double x, y, slope;
};

/// Cubic between the points, which increase in x; beyond the last one its own y.
template <class Points>
double interpolate(const Points& points, double x) noexcept {
  const auto after = std::upper_bound(points.begin(), points.end(), x,
                                      [](double at, const auto& point) { return at < point.x; });
  if (after == points.end()) return points.back().y;
  const auto &left = *(after - 1), &right = *after;
  const double width = right.x - left.x, t = (x - left.x) / width;
  const double h00 = (1 + 2 * t) * (1 - t) * (1 - t), h10 = t * (1 - t) * (1 - t);
  const double h01 = t * t * (3 - 2 * t), h11 = t * t * (t - 1);
  return h00 * left.y + h10 * width * left.slope + h01 * right.y + h11 * width * right.slope;
}

/// Ends a curve at `limit`: by a parabola, which goes on with the last slope.
void finish(std::vector<CurvePoint>& points, double limit) {
  const CurvePoint last = points.back();
  // Round-off may leave nothing to the limit.
  const double width = std::max(2 * (limit - last.y) / last.slope, 1e-3 * last.x);
  points.push_back({last.x + width, limit, 0});
}

/// Radii of the disc that sticks, from nearly the whole contact to hardly any.
std::vector<double> stick_radii() {
  constexpr int kOuter = 70, kInner = 26;
  constexpr double kTurn = 0.45 * kPi, kLeast = 1e-2;  // the inner ones fall by this factor
  std::vector<double> radii;
  for (int i = 1; i <= kOuter; ++i) radii.push_back(std::cos(kTurn * i / kOuter));
  for (int i = 1; i <= kInner; ++i)
    radii.push_back(std::cos(kTurn) * std::pow(kLeast, double(i) / kInner));
  return radii;
}

/// p(r) of a circle under the load 1, a = 1: a share of the load by (1 - r²)^n, the rest by
/// (1 - r²)^(1/2), which is how every smooth contact ends at its edge.
struct CirclePressure {
  double exponent, share;

  /// The one with the largest torque of (1 - r²)^exponent.
  explicit CirclePressure(double exponent_of_torque)
      : exponent(std::max(1.5, exponent_of_torque)),
        share((torque_arm_exact_m(1, 1, 0.5) - torque_arm_exact_m(1, 1, exponent_of_torque)) /
              (torque_arm_exact_m(1, 1, 0.5) - torque_arm_exact_m(1, 1, exponent))) {}

  /// @param depth  1 - r²
  double operator()(double depth) const noexcept {
    return (share * (exponent + 1) * std::pow(depth, exponent) +
            (1 - share) * 1.5 * std::sqrt(depth)) /
           kPi;
  }
};

/// Angle (rad) and torque of the twist at which the disc r < c still sticks.
struct TwistState {
  double angle_rad, torque;
};

/// The circle on a half-space. Without units: a = G = mu P = 1.
TwistState half_space_twist(const CirclePressure& pressure, double c) {
  static const QuadratureRule rule = gauss_legendre(40);
  // r² = c² + (1 - c²) sin² phi takes the roots away, phi = g sinh z the near pole at phi = i g.
  const double depth = 1 - c * c, root = std::sqrt(depth);
  const double g = c / root, last = std::asinh(0.5 * kPi / g);
  TwistState state{0, 0};
  for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
    const double z = last * rule.nodes[i], phi = g * std::sinh(z);
    const double weight = rule.weights[i] * last * g * std::cosh(z);
    const double sine = std::sin(phi), cosine = std::max(0., std::cos(phi));
    const double r = std::sqrt(c * c + depth * sine * sine);
    // dr/sqrt(r² - c²) = root cos(phi)/r dphi
    const double element = weight * pressure(depth * cosine * cosine) * root * cosine / r;
    const double chord = root * sine;  // sqrt(r² - c²)
    state.angle_rad += 0.5 * element;
    state.torque += 8. / 3 *
                    (element * c * c * c +
                     1.5 * element * chord * (r * r * std::acos(std::min(1., c / r)) + c * chord));
  }
  return state;
}

/// C(x) = int_0^inf cos(x y)/(e^y + 1) dy = sum over n of (-1)^(n+1) n/(n² + x²): the first terms,
/// and Boole's sum of the others, Re(z/2 + z²/4 - z⁴/8 + z⁶/4) with z = 1/(7 + i x). Right to 1e-6.
double fermi_cosine(double x) noexcept {
  double sum = 0;
  for (int n = 1; n < 7; n += 2) sum += n / (n * n + x * x) - (n + 1) / ((n + 1) * (n + 1) + x * x);
  const std::complex<double> z = 1. / std::complex<double>(7, x), z2 = z * z;
  return sum + (z / 2. + z2 / 4. - z2 * z2 / 8. + z2 * z2 * z2 / 4.).real();
}

/// The circle on a layer that is bonded to a rigid base, a = G = mu P = 1.
///
/// A shear q(r) = -G d/dr int_r^1 f(t)/sqrt(t² - r²) dt turns the disc r < c by theta if
///   f(s) - int_0^1 K(s, t) f(t) dt = 4/pi theta s for s < c,
///   K(s, t) = (C(|s - t|/(2 h)) - C((s + t)/(2 h)))/(pi h),   C = fermi_cosine, h over a
/// (as Lebedev and Ufliand have it for pressure). Full slip, q = mu p, has f = 4/pi s theta_0(s),
/// where theta_0(c) is the angle at which the stuck disc of a half-space has shrunk to r < c. What
/// a growing twist adds belongs to the stuck disc alone. So f is the sum of what discs of all sizes
/// add, each by its own increment dtheta. With cells of s, whose weights are the diagonal W, W(I -
/// K W) = L L^T and z = L^-1 W s, the factors of all smaller discs are the leading parts of L, and
///   theta_i = pi/4 (L^T f)_i/z_i,   k_i = 16 (z_1² + ... + z_i²),   dT = k dtheta.
///
/// @param size  a/h, 0 to `kLargestSize`
std::vector<CurvePoint> circle_twist(double exponent, double size) {
  const CirclePressure pressure(exponent);
  std::vector<double> radii = stick_radii();
  std::reverse(radii.begin(), radii.end());
  const Eigen::Index count = Eigen::Index(radii.size());
  const Eigen::Map<const Eigen::VectorXd> s(radii.data(), count);

  // Cells around the radii. Their weights make int s² ds exact, so that a half-space has its k.
  Eigen::VectorXd cubes(count), weights(count), full_slip(count);
  std::vector<TwistState> half_space;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double edge = i + 1 < count ? 0.5 * (s[i] + s[i + 1]) : 1;
    cubes[i] = edge * edge * edge;
    weights[i] = (cubes[i] - (i > 0 ? cubes[i - 1] : 0)) / (3 * s[i] * s[i]);
    half_space.push_back(half_space_twist(pressure, s[i]));
    full_slip[i] = 4 / kPi * s[i] * half_space.back().angle_rad;
  }
  Eigen::MatrixXd system = weights.asDiagonal();
  for (Eigen::Index j = 0; j < count; ++j)
    for (Eigen::Index i = j; i < count; ++i)
      system(i, j) -=
          weights[i] * weights[j] * size / kPi *
          (fermi_cosine(0.5 * size * (s[i] - s[j])) - fermi_cosine(0.5 * size * (s[i] + s[j])));
  const Eigen::LLT<Eigen::MatrixXd> factor(system);
  const Eigen::VectorXd z = factor.matrixL().solve(weights.cwiseProduct(s));
  const Eigen::VectorXd angles_rad = 0.25 * kPi * (factor.matrixU() * full_slip).cwiseQuotient(z);

  const double max_torque = torque_arm_exact_m(1, 1, exponent);
  double inner = 16 * z.squaredNorm();  // k of the disc within a cell's outer edge
  const double stiffness = inner;
  std::vector<CurvePoint> points = {{0, 0, 1}};
  double angle_rad = 0, half_space_rad = 0, added = 0;
  for (Eigen::Index i = count - 1; i >= 0; --i) {
    // Adds to the half-space's exact torque the difference that the same sum gives between the
    // layer and the half-space.
    const TwistState& thick = half_space[std::size_t(i)];
    added += inner * (angles_rad[i] - angle_rad) -
             16. / 3 * cubes[i] * (thick.angle_rad - half_space_rad);
    angle_rad = angles_rad[i];
    half_space_rad = thick.angle_rad;
    inner -= 16 * z[i] * z[i];
    const double middle = inner + 16. / 3 * (s[i] * s[i] * s[i] - (i > 0 ? cubes[i - 1] : 0)) *
                                      z[i] * z[i] / (weights[i] * s[i] * s[i]);
    points.push_back({stiffness * angle_rad / max_torque, (thick.torque + added) / max_torque,
                      middle / stiffness});
  }
  finish(points, 1);
  return points;
}

/// Curve of one ring of a thin layer: int_0^1 min(z s, (1 - s²)^n) s² ds over z.
std::vector<CurvePoint> sheared_ring(double exponent) {
  static const QuadratureRule rule = gauss_legendre(24);
  std::vector<CurvePoint> points = {{0, 0, 0.25}};
  for (const double c : stick_radii()) {
    const double pressure = std::pow(1 - c * c, exponent);
    // s² = c² + (1 - c²) sin² phi once more, s ds = (1 - c²) sin cos dphi
    const double depth = 1 - c * c;
    double slipping = 0;
    for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
      const double phi = 0.5 * kPi * rule.nodes[i], sine = std::sin(phi), cosine = std::cos(phi);
      const double s = std::sqrt(c * c + depth * sine * sine);
      slipping += 0.5 * kPi * rule.weights[i] * std::pow(depth * cosine * cosine, exponent) * s *
                  depth * sine * cosine;
    }
    points.push_back({pressure / c, 0.25 * pressure * c * c * c + slipping, 0.25 * c * c * c * c});
  }
  // int_0^1 (1 - s²)^n s² ds
  finish(points, 0.5 * torque_arm_exact_m(1, 1, exponent) / (exponent + 1));
  return points;
}

/// T/T_max of a thin layer over x. Its ellipse has the semi-axes 1 and `aspect`.
class ThinTwist {
 public:
  ThinTwist(const std::vector<CurvePoint>& ring, double aspect) : ring_(ring) {
    constexpr int kDirections = 64;  // of a quarter; the integrand is smooth and periodic
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 0.5 * kPi * (i + 0.5) / kDirections;
      arms_.push_back(std::hypot(std::cos(angle), aspect * std::sin(angle)));
      sum_ += arms_.back();
      squares_ += arms_.back() * arms_.back();
    }
  }

  double operator()(double x) const noexcept {
    // T = sum R h(z R), T_max = h(inf) sum R; at first T = z/4 sum R².
    const double z = 4 * x * ring_.back().y * sum_ / squares_;
    double torque = 0;
    for (const double arm : arms_) torque += arm * interpolate(ring_, z * arm);
    return torque / (ring_.back().y * sum_);
  }

 private:
  const std::vector<CurvePoint>& ring_;
  std::vector<double> arms_;
  double sum_ = 0, squares_ = 0;
};

}  // namespace

TwistCurve::TwistCurve(double exponent, double aspect, double size) {
  const double n = std::clamp(exponent, 0.5, 50.), b = std::clamp(aspect, 1e-3, 1.);
  const std::vector<CurvePoint> circle = circle_twist(n, std::clamp(size, 0., kLargestSize));
  if (b == 1) {
    for (const CurvePoint& point : circle) knots_.push_back({point.x, point.y, point.slope});
    return;
  }
  const std::vector<CurvePoint> ring = sheared_ring(n);
  const ThinTwist long_one(ring, b), round_one(ring, 1);
  const auto ratio = [&](double x) { return long_one(x) / round_one(x); };
  const auto add = [&](const CurvePoint& point) {
    const double step = 1e-4 * point.x, here = ratio(point.x);
    const double slope = (ratio(point.x + step) - ratio(point.x - step)) / (2 * step);
    knots_.push_back({point.x, point.y * here, point.slope * here + point.y * slope});
  };
  knots_.push_back({0, 0, 1});
  for (std::size_t i = 1; i < circle.size(); ++i) add(circle[i]);
  // The middle of a thin layer is the last to slip, long after that of the half-space.
  constexpr int kMore = 60;
  constexpr double kFarther = 1.15;
  double x = circle.back().x;
  for (int i = 0; i < kMore; ++i) add({x *= kFarther, 1, 0});
  knots_.push_back({2 * x, 1, 0});
}

double TwistCurve::operator()(double x) const noexcept {
  const double y = interpolate(knots_, std::abs(x));
  return x < 0 ? -y : y;
}

ShiftCurve::ShiftCurve(double stiffness_growth) noexcept
    : growth_(std::clamp(stiffness_growth, 0., 0.9)) {}

double ShiftCurve::operator()(double x) const noexcept {
  const double rest = 1 - (1 - growth_) * std::abs(x);
  const double y = rest > 0 ? 1 - std::pow(rest, 1 / (1 - growth_)) : 1;
  return x < 0 ? -y : y;
}

}  // namespace softfinger
