#include "softfinger/layer/stack_contact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/layer/spherical_bessel.h"
#include "softfinger/math/always_inline.h"
#include "softfinger/math/gauss_legendre.h"
#include "softfinger/math/pack.h"
#include "softfinger/math/wide.h"

namespace softfinger {
namespace {

constexpr int kPressures = 5;  ///< phi_n = (1 - t²)^n, n = 1 to 5
constexpr int kPacks = 5, kWaves = kPacks * Pack::kSize;
/// Pairs (i, j), i = 0 to 5, j = 1 to 5, i <= j, and the place of each in the tables below.
constexpr int kPairs = 20;
static_assert(kPairs == kPressures * (kPressures + 3) / 2 && kPairs % Pack::kSize == 0);
constexpr int pair_of(int i, int j) {
  const int low = i < j ? i : j, high = i < j ? j : i;
  return low == 0 ? high - 1 : low * kPressures - (low - 1) * (low - 2) / 2 + (high - low);
}

/// int_0^1 (1 - t²)^n dt
constexpr double beta(int n) {
  double value = 1;
  for (int m = 1; m <= n; ++m) value *= 2. * m / (2 * m + 1);
  return value;
}

/// int_0^infinity C(q/a) Phi_i Phi_j dq (2/pi) as weights of C at the wave numbers q_m/a, Phi_n the
/// cosine transform of phi_n, with C between them the polynomial in ln(1 + q/kFirst) and constant
/// beyond the last; `first` and `second` likewise of the derivatives of C(q/a) by ln a.
struct GalerkinTable {
  alignas(32) std::array<double, kWaves> wave_numbers;  ///< q_m
  alignas(32) std::array<std::array<double, kPairs>, kWaves> value, first, second;

  GalerkinTable() noexcept;
};

GalerkinTable::GalerkinTable() noexcept {
  constexpr double kFirst = 0.1, kLast = 60;
  const double length = std::log1p(kLast / kFirst);
  std::array<double, kWaves> x, barycentric;
  for (int m = 0; m < kWaves; ++m) {
    x[std::size_t(m)] = -std::cos(kPi * (m + 0.5) / kWaves);
    wave_numbers[std::size_t(m)] = kFirst * std::expm1((x[std::size_t(m)] + 1) / 2 * length);
    barycentric[std::size_t(m)] = (m % 2 ? -1 : 1) * std::sin(kPi * (m + 0.5) / kWaves);
  }
  // Row m: derivative by ln q at the point m of the polynomials that are 1 at the others.
  std::array<std::array<double, kWaves>, kWaves> derivative{};
  for (std::size_t m = 0; m < kWaves; ++m) {
    const double stretch = 2 / length * wave_numbers[m] / (wave_numbers[m] + kFirst);
    for (std::size_t n = 0; n < kWaves; ++n) {
      if (m == n) continue;
      derivative[m][n] = stretch * barycentric[n] / barycentric[m] / (x[m] - x[n]);
      derivative[m][m] -= derivative[m][n];
    }
  }
  for (auto& row : value) row.fill(0);
  // The transforms are 2^n n! j_n(q)/q^n; panels of a sixth of their period.
  const auto add_panel = [&](double from, double to) {
    static const QuadratureRule kRule = gauss_legendre(12);
    for (int k = 0; k < 12; ++k) {
      const double q = from + (to - from) * kRule.nodes[k];
      double even[kPressures], odd[kPressures], transform[kPressures + 1];
      spherical_bessel(q, 0, kPressures / 2, even);
      spherical_bessel(q, 1, kPressures / 2, odd);
      double factor = 1;
      for (int n = 0; n <= kPressures; ++n) {
        if (n > 0) factor *= 2 * n / q;
        transform[n] = factor * (n % 2 ? odd[n / 2] : even[n / 2]);
      }
      const double at = 2 * std::log1p(q / kFirst) / length - 1;
      std::array<double, kWaves> lagrange;
      double sum = 0;
      for (std::size_t m = 0; m < kWaves; ++m)
        sum += lagrange[m] = barycentric[m] / (at == x[m] ? 1e-300 : at - x[m]);
      const double weight = 2 / kPi * (to - from) * kRule.weights[k];
      for (int i = 0; i <= kPressures; ++i)
        for (int j = std::max(i, 1); j <= kPressures; ++j) {
          const std::size_t pair = std::size_t(pair_of(i, j));
          const double product = weight * transform[i] * transform[j];
          for (std::size_t m = 0; m < kWaves; ++m) value[m][pair] += product * lagrange[m] / sum;
        }
    }
  };
  // Small q too: the polynomial's first points are 0.002 apart. j_n/q^n loses digits below 1e-3,
  // where nothing changes: the first panel is one.
  double from = 1e-3;
  add_panel(1e-9, from);
  for (double to : {3e-3, 1e-2, 3e-2, 0.1, 0.2, 0.4, 0.7, 1.}) {
    add_panel(from, to);
    from = to;
  }
  for (; from < kLast - 0.25; from += 0.5) add_panel(from, from + 0.5);
  // Constant beyond: all of the integral is int phi_i phi_j dt.
  for (int i = 0; i <= kPressures; ++i)
    for (int j = std::max(i, 1); j <= kPressures; ++j) {
      const std::size_t pair = std::size_t(pair_of(i, j));
      double rest = beta(i + j);
      for (const auto& row : value) rest -= row[pair];
      value[kWaves - 1][pair] += rest;
    }
  // C(q/a) falls by ln a as it grows by ln q.
  const auto minus_derivative = [&](const auto& of, auto& result) {
    for (std::size_t m = 0; m < kWaves; ++m)
      for (std::size_t pair = 0; pair < kPairs; ++pair) {
        double sum = 0;
        for (std::size_t n = 0; n < kWaves; ++n) sum -= derivative[n][m] * of[n][pair];
        result[m][pair] = sum;
      }
  };
  minus_derivative(value, first);
  minus_derivative(first, second);
}

const GalerkinTable& galerkin_table() noexcept {
  static const GalerkinTable table;
  return table;
}

/// A stack in the units of the layer that stands for it: lengths over its thickness, stresses over
/// its E*.
struct ScaledStack {
  struct Sublayer {
    double thickness, twice_shear, poisson_ratio;
  };
  std::size_t count = 0;
  std::array<Sublayer, LayerStack::kMost> sublayers{};  ///< from the surface
  double depth = 0;                                     ///< of all
  double column = 0, flow = 0;                          ///< int dz/M, int z² dz/G
};

ScaledStack scaled(const LayerStack& stack, const ElasticLayer& unit) noexcept {
  ScaledStack result;
  result.count = stack.count;
  const double modulus_Pa = unit.plane_strain_modulus_Pa();
  for (std::size_t i = 0; i < stack.count; ++i) {
    const ElasticLayer& layer = stack.sublayers[i];
    const double h = layer.thickness_m / unit.thickness_m;
    const double nu = layer.poisson_ratio, shear = layer.shear_modulus_Pa() / modulus_Pa;
    result.sublayers[i] = {h, 2 * shear, nu};
    const double z = result.depth;
    result.depth += h;
    result.column += h * (1 - 2 * nu) / (2 * (1 - nu) * shear);
    result.flow += h * (z * z + z * h + h * h / 3) / shear;
  }
  return result;
}

/// Two stacks that face each other, the second one with `count` 0 where the object is rigid.
struct FacingStacks {
  ScaledStack finger, object;
};

FacingStacks scaled(const LayerStack& finger, const LayerStack& object,
                    const ElasticLayer& unit) noexcept {
  return {scaled(finger, unit), scaled(object, unit)};
}

/// Compliance C = w/E* of the stack's surface against pressure of wave number k: u^ = 2 C/k p^. As
/// StackKernel's, by the 2 x 2 compliance of each interface from the base upwards, on any kind of
/// number. Waves much longer than the stack have C = k/2 (int dz/M + k² int z² dz/G), without the
/// recursion's cancellation.
template <class Real>
SOFTFINGER_ALWAYS_INLINE inline Real stack_compliance(const ScaledStack& stack,
                                                      const Real& k) noexcept {
  using plain::exp;
  using plain::smaller;
  // Rows: displacement along x, along z; columns: normal and shear traction over k.
  Real xn{}, xs{}, zn{}, zs{};
  for (std::size_t i = stack.count; i-- > 0;) {
    const ScaledStack::Sublayer& layer = stack.sublayers[i];
    const double g = layer.twice_shear, nu = layer.poisson_ratio;
    const double kappa = 3 - 4 * nu, n = 2 * (1 - nu), s = 1 - 2 * nu;
    // Decaying waves (columns: first, second potential) as the interface below has them, less its
    // own compliance; growing ones likewise. The decaying are -decaying^-1 growing.
    const Real d00 = -1. - g * (xn + xs), d01 = g * (n * xn + s * xs);
    const Real d10 = -1. - g * (zn + zs), d11 = kappa + g * (n * zn + s * zs);
    const Real g00 = -1. - g * (xn - xs), g01 = -g * (n * xn - s * xs);
    const Real g10 = 1. - g * (zn - zs), g11 = kappa - g * (n * zn - s * zs);
    const Real y = smaller(k * layer.thickness, 300.), decay = exp(-2. * y);
    const Real factor = decay / (d01 * d10 - d00 * d11);
    const Real f00 = factor * (d11 * g00 - d01 * g10), f10 = factor * (d00 * g10 - d10 * g00);
    const Real f01 = factor * (d11 * g01 - d01 * g11), f11 = factor * (d00 * g11 - d10 * g01);
    // Seen from an origin that is y higher, a second wave has -y of the first one in it.
    const Real t00 = f00 - y * f10, t10 = f10;
    const Real t01 = f01 - y * f11 + y * t00, t11 = f11 + y * f10;
    // Displacements (times 2 G) and tractions at the top; both kinds of waves.
    const Real x0 = -1. - t00, x1 = 0. - t01;
    const Real z0 = 1. - t00 + kappa * t10, z1 = kappa - t01 + kappa * t11;
    const Real p0 = 1. + t00 - n * t10, p1 = n + t01 - n * t11;
    const Real q0 = -1. + t00 - s * t10, q1 = -s + t01 - s * t11;
    const Real inverse = 1. / (g * (p0 * q1 - p1 * q0));
    xn = inverse * (x0 * q1 - x1 * q0);
    xs = inverse * (x1 * p0 - x0 * p1);
    zn = inverse * (z0 * q1 - z1 * q0);
    zs = inverse * (z1 * p0 - z0 * p1);
  }
  constexpr double kLong = 0.02;
  const Real k2 = k * k, x2 = k2 * (stack.depth * stack.depth) * (1 / (kLong * kLong));
  const Real share = 1. / (1. + x2 * x2);  // of the limit
  return 0.5 * (share * (k * (stack.column + k2 * stack.flow)) + (1. - share) * zn);
}

/// Pressed against each other, both give way.
template <class Real>
SOFTFINGER_ALWAYS_INLINE inline Real stack_compliance(const FacingStacks& stacks,
                                                      const Real& k) noexcept {
  const Real of_finger = stack_compliance(stacks.finger, k);
  return stacks.object.count == 0 ? of_finger : of_finger + stack_compliance(stacks.object, k);
}

/// Least d ln P/d ln a that is counted with.
constexpr double kLeastExponent = 1;

/// A logarithm, and its derivative by ln a.
struct Logarithm {
  double value, slope;
};

/// The contact of size exp(log_size) with R = 1.
struct SizedContact {
  Logarithm load;              ///< ln P
  Logarithm depth, arm, peak;  ///< ln of d/a², of (int p r dA)/(P a), of p(0) a²/P
};

/// Round contacts are solved. An ellipse of the same size sqrt(ab) and with the same pressure over
/// the scaled coordinates x/a, y/b makes the energy stationary, to the second order in L =
/// ln(R'/R''), with the exponent m = d ln P/d ln a of the round one and m' = dm/d ln a, at
///   ln(a/b) = 2 L/m,  ln(P/P_round) = L² [(4 - m)/(8 m) + m'/(4 m²)],
///   (d - d_round)/G = (d_round/G - 1) ln(P/P_round) + (4 - m) L²/m² [(4 - m)/8 - 1],
/// G = <r²> a²/(2 R) the mean gap under the pressure. (At equal size the kernel's energy is f(ln a)
/// + (a/b)-dependent part ln²(a/b) (f'/8 + f''/16), that of the gap grows as cosh(ln(a/b) - L/2).)
SizedContact sized_contact(const FacingStacks& stack, double log_size,
                           double log_radii_ratio) noexcept {
  const GalerkinTable& table = galerkin_table();
  const double a = plain::exp(log_size), per_a = 1 / a;
  alignas(32) double compliance[kWaves];
  for (int m = 0; m < kWaves; m += Pack::kSize)
    stack_compliance(stack, per_a * Pack::from(&table.wave_numbers[std::size_t(m)]))
        .write(compliance + m);
  const auto integrate = [&](const auto& weights, double* integrals) {
    std::array<Pack, kPairs / Pack::kSize> sums{};
    for (std::size_t m = 0; m < kWaves; ++m)
      for (std::size_t p = 0; p < sums.size(); ++p)
        sums[p] += compliance[m] * Pack::from(&weights[m][Pack::kSize * p]);
    for (std::size_t p = 0; p < sums.size(); ++p) sums[p].write(integrals + Pack::kSize * p);
  };
  alignas(32) double matrix[kPairs], change[kPairs];
  integrate(table.value, matrix);
  integrate(table.first, change);
  // sum_j A_ij c_j = d I_i - J_i, i = 0 to 5, for c_1 to c_5 and d in units of a²/pi; phi(a) = 0
  // has no c_0. Rows 1 to 5 are symmetric: L D L^T.
  double lower[kPressures][kPressures], pivot[kPressures];
  for (int i = 0; i < kPressures; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = matrix[pair_of(i + 1, j + 1)];
      for (int k = 0; k < j; ++k) sum -= lower[i][k] * lower[j][k] * pivot[k];
      if (j < i)
        lower[i][j] = sum / pivot[j];
      else
        pivot[i] = sum;
    }
  using Vector = std::array<double, kPressures>;
  const auto solve = [&](Vector right) {
    for (int i = 0; i < kPressures; ++i)
      for (int k = 0; k < i; ++k) right[std::size_t(i)] -= lower[i][k] * right[std::size_t(k)];
    for (int i = kPressures; i-- > 0;) {
      right[std::size_t(i)] /= pivot[i];
      for (int k = i + 1; k < kPressures; ++k)
        right[std::size_t(i)] -= lower[k][i] * right[std::size_t(k)];
    }
    return right;
  };
  const auto dot = [](const double* row, const Vector& column) {
    double sum = 0;
    for (int i = 0; i < kPressures; ++i) sum += row[i] * column[std::size_t(i)];
    return sum;
  };
  // int phi_n dt, and int phi_n t² dt.
  Vector unit, parabola;
  for (int i = 0; i < kPressures; ++i) {
    unit[std::size_t(i)] = beta(i + 1);
    parabola[std::size_t(i)] = beta(i + 1) - beta(i + 2);
  }
  const Vector by_depth = solve(unit), by_parabola = solve(parabola);
  const double edge = dot(matrix, by_depth) - beta(0);
  const double depth = (dot(matrix, by_parabola) - (beta(0) - beta(1))) / edge;
  Vector c;
  for (std::size_t i = 0; i < kPressures; ++i) c[i] = depth * by_depth[i] - by_parabola[i];
  // The derivative of all equations by ln a, in the same units.
  const auto times = [](const double* of, const Vector& column) {
    Vector product{};
    for (int i = 0; i < kPressures; ++i)
      for (int j = 0; j < kPressures; ++j)
        product[std::size_t(i)] += of[pair_of(i + 1, j + 1)] * column[std::size_t(j)];
    return product;
  };
  const Vector changed = solve(times(change, c));
  const double depth_slope = (dot(matrix, changed) - dot(change, c)) / edge;
  // phi = (a²/pi) sum c_n phi_n(t/a); P = 2 pi int phi dt; moment = pi² int t phi dt.
  double load = 0, moment = 0, peak = 0, load_slope = 0, moment_slope = 0, peak_slope = 0;
  double square = 0;
  Vector slope;
  for (std::size_t i = 0; i < kPressures; ++i) {
    const int n = int(i) + 1;
    slope[i] = depth_slope * by_depth[i] - changed[i];
    const double of_moment = kPi / 4 / (n + 1), of_peak = n * beta(n - 1) / kPi;
    load += c[i] * unit[i];
    moment += c[i] * of_moment;
    peak += c[i] * of_peak;
    square += c[i] * unit[i] / (n + 1.5);
    load_slope += slope[i] * unit[i];
    moment_slope += slope[i] * of_moment;
    peak_slope += slope[i] * of_peak;
  }
  load_slope /= load;
  SizedContact contact{{plain::log(2 * load) + 3 * log_size, 3 + load_slope},
                       {plain::log(depth), depth_slope / depth},
                       {plain::log(moment / load), moment_slope / moment - load_slope},
                       {plain::log(peak / load), peak_slope / peak - load_slope}};
  const double L2 = log_radii_ratio * log_radii_ratio;
  if (!(L2 > 0)) return contact;
  alignas(32) double second[kPairs];
  integrate(table.second, second);
  Vector right = times(second, c);
  const Vector of_slope = times(change, slope);
  for (std::size_t i = 0; i < kPressures; ++i) right[i] += 2 * of_slope[i];
  right = solve(right);
  const double depth_curvature =
      (dot(matrix, right) - 2 * dot(change, slope) - dot(second, c)) / edge;
  double load_curvature = 0;
  for (std::size_t i = 0; i < kPressures; ++i)
    load_curvature += (depth_curvature * by_depth[i] - right[i]) * unit[i];
  const double exponent_slope = load_curvature / load - load_slope * load_slope;
  const double m = std::max(3 + load_slope, kLeastExponent), rest = (4 - m) / m;
  const double more_load = L2 * (rest / 8 + exponent_slope / (4 * m * m));
  const double gap_in_depth = square / load / (2 * depth);
  contact.load.value += more_load;
  contact.depth.value +=
      (1 - gap_in_depth) * more_load + gap_in_depth * L2 * rest * (rest / 8 - 1 / m);
  return contact;
}

/// ln(a) that Hertz's formula with the compliance at one wave number of the order 1/a gives; where
/// the round contact is to be sought. Four sizes are tried at once, twice, and the loads between
/// and beyond them are powers of the size.
double first_guess(const FacingStacks& stack, double log_load) noexcept {
  constexpr double kWave = 2.5, kRounds = 2, kRatios[] = {4, 1.3};
  double x = (log_load - plain::log(4. / 3)) * (1. / 3);
  for (int round = 0; round < kRounds; ++round) {
    const double step = plain::log(kRatios[round]), first = x - 1.5 * step;
    Pack waves;
    for (int i = 0; i < Pack::kSize; ++i) waves.set(i, kWave * plain::exp(-(first + i * step)));
    const Pack logs = log(stack_compliance(stack, waves));
    const auto load_at = [&](int i) {
      return plain::log(4. / 3) + 3 * (first + i * step) - logs[i];
    };
    // The first interval that the load lies in or before, else the last.
    int at = 0;
    while (at < Pack::kSize - 2 && log_load > load_at(at + 1)) ++at;
    const double exponent = std::max((load_at(at + 1) - load_at(at)) / step, kLeastExponent);
    x = first + at * step + (log_load - load_at(at)) / exponent;
  }
  return x;
}

/// ln(a/b) between the limits of one layer, of the exponent m: x = 12/m - 3 is 1 for a half-space
/// (m = 3), 0 for columns (4) and -1 for a layer that flows (6).
double aspect_by_exponent(const LimitShapes& shapes, double exponent) noexcept {
  const double x = 12 / exponent - 3;
  return 0.5 * x * (x + 1) * shapes.log_hertz_aspect + (1 - x * x) * 0.5 * shapes.log_radii_ratio +
         0.5 * x * (x - 1) * shapes.log_incompressible_aspect;
}

StackContact solve_stack(const ContactInputOf<double>& input, const LayerStack& finger,
                         const LayerStack& object, const ElasticLayer& unit) noexcept {
  // A last step is taken to first order, without the change of the ellipse's part of the load.
  constexpr double kLastStep = 1e-3;
  constexpr int kMostSteps = 12;
  const LayerArguments<double> at = layer_arguments(input);
  const FacingStacks sublayers = scaled(finger, object, unit);
  double x = first_guess(sublayers, at.log_load), step = 0;
  SizedContact of_stack{};
  for (int i = 0; i < kMostSteps; ++i) {
    x += step;
    of_stack = sized_contact(sublayers, x, at.log_radii_ratio);
    step = (at.log_load - of_stack.load.value) / std::max(of_stack.load.slope, kLeastExponent);
    step = std::min(std::max(step, -1.), 1.);
    if (std::abs(step) <= kLastStep && i > 0) break;
  }
  const SizedContact of_unit = sized_contact(scaled(unit, {}, unit), x, at.log_radii_ratio);
  const double excess = of_stack.load.slope - of_unit.load.slope;
  // The load at which the homogeneous layer has the contact's size, ln a = x + step; that of an
  // ellipse, and by the error of either solution, is a little further.
  const auto load_of_unit = [&](double shift) {
    return at.log_load - (of_stack.load.value - of_unit.load.value) - excess * shift;
  };
  const auto of_layer = [&](double log_load) {
    return bonded_layer_logarithms(log_load, unit.poisson_ratio, at.log_radii_ratio);
  };
  const double further = (of_layer(load_of_unit(step))[kSize] - (x + step)) * of_unit.load.slope /
                         std::max(of_stack.load.slope, kLeastExponent);
  const double shift = step + further, log_load = load_of_unit(shift);
  LayerQuantities logarithms = of_layer(log_load);
  const auto change = [&](Logarithm SizedContact::*which) {
    const Logarithm &one = of_stack.*which, &other = of_unit.*which;
    return one.value - other.value + (one.slope - other.slope) * shift;
  };
  logarithms[kDepth] += change(&SizedContact::depth);
  logarithms[kArm] += change(&SizedContact::arm);
  logarithms[kPeak] += change(&SizedContact::peak);
  const LimitShapes shapes = tabulated_limit_shapes(at.log_radii_ratio);
  logarithms[kAspect] =
      std::max(0., logarithms[kAspect] + aspect_by_exponent(shapes, of_stack.load.slope) -
                       aspect_by_exponent(shapes, of_unit.load.slope));
  StackContact result;
  constexpr double kRough = 0.01;  // changes the answer by less than the stated errors
  result.is_solved = std::abs(step) <= kRough;
  result.logarithms = logarithms;
  result.numbers = contact_of_logarithms(logarithms, at.mean_radius_m, input);
  result.equivalent = unit;
  result.equivalent.youngs_modulus_Pa *= plain::exp(at.log_load - log_load);
  result.load_exponent = of_stack.load.slope;
  result.exponent_change = excess;
  return result;
}

/// Neighbours of one material are one sublayer.
LayerStack merged(const LayerStack& stack) noexcept {
  LayerStack result;
  for (std::size_t i = 0; i < stack.count; ++i) {
    const ElasticLayer& layer = stack.sublayers[i];
    if (result.count > 0) {
      ElasticLayer& above = result.sublayers[result.count - 1];
      if (above.youngs_modulus_Pa == layer.youngs_modulus_Pa &&
          above.poisson_ratio == layer.poisson_ratio) {
        above.thickness_m += layer.thickness_m;
        continue;
      }
    }
    result.sublayers[result.count++] = layer;
  }
  return result;
}

void add_contrasts(const LayerStack& stack, StackContact& contact) noexcept {
  double least = kInfinity, most = 0;
  for (std::size_t i = 0; i < stack.count; ++i) {
    const double modulus_Pa = stack.sublayers[i].plane_strain_modulus_Pa();
    least = std::min(least, modulus_Pa);
    most = std::max(most, modulus_Pa);
  }
  contact.log_contrast = std::log(most / least);
  contact.log_softening = std::log(stack.surface().plane_strain_modulus_Pa() / least);
}

}  // namespace

namespace {

/// int dz/M, int dz/G and int z² dz/G over stacks, each from its own surface.
struct DepthIntegrals {
  double column = 0, shear = 0, flow = 0;

  void add(const LayerStack& stack, double unit_m, double unit_Pa) noexcept {
    double z = 0;
    for (std::size_t i = 0; i < stack.count; ++i) {
      const ElasticLayer& layer = stack.sublayers[i];
      const double h = layer.thickness_m / unit_m, G = layer.shear_modulus_Pa() / unit_Pa;
      const double nu = layer.poisson_ratio;
      column += h * (1 - 2 * nu) / (2 * (1 - nu) * G);
      shear += h / G;
      flow += h * (z * z + z * h + h * h / 3) / G;
      z += h;
    }
  }
};

}  // namespace

ElasticLayer large_contact_layer(const LayerStack& stack, const LayerStack& object) noexcept {
  if (stack.count == 1 && object.count == 0) return stack.surface();
  // In units of the surface's sublayer, so that nothing overflows.
  const double unit_m = stack.surface().thickness_m, unit_Pa = stack.surface().shear_modulus_Pa();
  DepthIntegrals sums;
  sums.add(stack, unit_m, unit_Pa);
  sums.add(object, unit_m, unit_Pa);
  const double h = std::sqrt(3 * sums.flow / sums.shear);
  const double softness = sums.column / sums.shear;  // G/M = (1 - 2 nu)/(2 (1 - nu)) <= 1/2
  ElasticLayer layer;
  layer.thickness_m = unit_m * h;
  layer.poisson_ratio = std::max(0., (1 - 2 * softness) / (2 * (1 - softness)));
  layer.youngs_modulus_Pa = 2 * (1 + layer.poisson_ratio) * unit_Pa * h / sums.shear;
  return layer;
}

StackContact stack_contact(const RelativeRadii& radii, const LayerStack& stack,
                           double normal_force_N, const LayerStack& object) noexcept {
  const LayerStack sublayers = merged(stack);
  const ElasticLayer unit = large_contact_layer(sublayers, object);
  const ContactInputOf<double> input = contact_input(radii, unit, normal_force_N);
  StackContact result;
  if (sublayers.count == 1 && object.count == 0) {
    const LayerArguments<double> at = layer_arguments(input);
    with_best_instructions([&] {
      result.logarithms =
          bonded_layer_logarithms(at.log_load, input.poisson_ratio, at.log_radii_ratio);
    });
    result.numbers = contact_of_logarithms(result.logarithms, at.mean_radius_m, input);
    result.equivalent = unit;
    return result;
  }
  with_best_instructions([&] { result = solve_stack(input, sublayers, object, unit); });
  add_contrasts(sublayers, result);
  return result;
}

ContactProblem with_equivalent_layer(ContactProblem problem) noexcept {
  if (problem.stack.count == 0) return problem;
  problem.layer =
      stack_contact(problem.radii, problem.stack, problem.load.normal_force_N).equivalent;
  problem.stack = {};
  return problem;
}

}  // namespace softfinger
