#include "softfinger/taxels/corner_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "softfinger/fft/influence.h"
#include "softfinger/input/constants.h"
#include "softfinger/math/bessel_j0.h"
#include "softfinger/math/even_table.h"
#include "softfinger/math/gauss_legendre.h"
#include "softfinger/taxels/layer_stress.h"

namespace softfinger::taxels {
namespace {

/// Distance, in thicknesses, at which the layer's stress has decayed like exp(-0.739 r/h) (the
/// slowest pole of the kernel, at nu = 1/2) to 1e-13 of what it is below the force.
constexpr double kStressReach = 40;
/// Steps of the tables, in thicknesses. The functions have singularities at a distance of at least
/// h from the real axis near r = 0, and none near it farther out.
constexpr double kNearReach = 6, kNearStep = 0.05, kFarStep = 0.25;
/// Largest k h that counts: the excess of a layer's stress at its base, about x² exp(-x), is below
/// 1e-16 there.
constexpr double kLargestStressWaveNumber = 45;

/// An even function of the distance r/h, on two tables.
struct RadialTable {
  std::vector<double> near, far;
  double operator()(double r) const {
    return r < kNearReach ? at_even_table(near, r / kNearStep) : at_even_table(far, r / kFarStep);
  }
};

/// Samples both tables.
template <class Function>
RadialTable tabulate_radially(const Function& f) {
  constexpr int kBeyond = 3;  // samples past the reach that interpolation takes
  RadialTable table;
  const int near = int(kNearReach / kNearStep) + kBeyond,
            far = int(kStressReach / kFarStep) + kBeyond;
  for (int i = 0; i <= near; ++i) table.near.push_back(f(i * kNearStep));
  for (int i = 0; i <= far; ++i) table.far.push_back(f(i * kFarStep));
  return table;
}

/// Hankel transforms of several functions of x = kh at once,
///   1/(2 pi) int_0^inf f_i(x) J0(x r) dx,
/// for waves that have decayed at `kLargestStressWaveNumber`.
template <std::size_t N, class Waves>
std::array<RadialTable, N> hankel_transforms(const Waves& waves) {
  using Values = std::array<double, N>;
  QuadratureRule rule;
  std::vector<Values> weighted;
  double rule_end = -1;
  const auto transform = [&](double r) {
    constexpr double kBand = 5;  // of distances that share one rule
    if (r > rule_end || r < rule_end - kBand) {
      rule_end = kBand * (1 + std::floor(r / kBand));
      // About one and a half periods of J0 per panel of 16 points, and the kernel resolved.
      rule = composite_gauss_legendre(kLargestStressWaveNumber, std::min(1.5, 10 / rule_end));
      weighted.clear();
      for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
        weighted.push_back(waves(rule.nodes[i]));
        for (double& value : weighted.back()) value *= rule.weights[i] / (2 * kPi);
      }
    }
    Values sums{};
    for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
      const double bessel = bessel_j0(rule.nodes[i] * r);
      for (std::size_t n = 0; n < N; ++n) sums[n] += weighted[std::size_t(i)][n] * bessel;
    }
    return sums;
  };
  // `mean_within` reads past the reach of the tables that it makes.
  constexpr int kBeyond = 8;
  std::array<RadialTable, N> tables;
  const auto sample = [&](std::vector<double> RadialTable::*part, double step, double reach) {
    const int last = int(reach / step) + kBeyond;
    for (int i = 0; i <= last; ++i) {
      const Values values = transform(i * step);
      for (std::size_t n = 0; n < N; ++n) (tables[n].*part).push_back(values[n]);
    }
  };
  sample(&RadialTable::near, kNearStep, kNearReach);
  sample(&RadialTable::far, kFarStep, kStressReach);
  return tables;
}

/// For a field f(r): m(r) = 1/r² int_0^r f(s) s ds, even and as smooth as f. The integral of f over
/// the rectangle from 0 to (X, Y), cut into two triangles, is then
///   X int_0^Y m(r) dy + Y int_0^X m(r) dx.
template <class Function>
RadialTable mean_within(const Function& f) {
  static const QuadratureRule rule = gauss_legendre(8);
  double reached = 0, moment = 0;
  return tabulate_radially([&](double r) {
    // The second table starts at 0 again.
    if (r < reached) reached = moment = 0;
    const int panels = std::max(1, int(std::ceil((r - reached) / kFarStep)));
    const double width = (r - reached) / panels;
    for (int panel = 0; panel < panels; ++panel)
      for (Eigen::Index q = 0; q < rule.nodes.size(); ++q) {
        const double s = reached + width * (panel + rule.nodes[q]);
        moment += width * rule.weights[q] * f(s) * s;
      }
    reached = r;
    return r > 0 ? moment / (r * r) : 0.5 * f(0);
  });
}

/// int_0^Y f(sqrt(X² + y²)) dy for all offsets of the lattice, which are in thicknesses here.
/// @param along_y  else the integral goes along x: int_0^X f dx
template <class Function>
CornerTable line_integrals(const OffsetLattice& lattice, double step_x, double step_y, bool along_y,
                           const Function& f) {
  static const QuadratureRule rule = gauss_legendre(4);
  constexpr double kLongestPanel = 0.5;  // of a smooth function on the scale of h
  CornerTable table(lattice.count_x, lattice.count_y);
  const int across = along_y ? lattice.count_x : lattice.count_y;
  const int along = along_y ? lattice.count_y : lattice.count_x;
  const double across_step = along_y ? step_x : step_y, step = along_y ? step_y : step_x;
  const int panels = std::max(1, int(std::ceil(step / kLongestPanel)));
  for (int i = 0; i < across; ++i) {
    const double fixed = (i + 0.5) * across_step;
    double sum = 0, reached = 0;
    for (int j = 0; j < along; ++j) {
      const double width = ((j + 0.5) * step - reached) / panels;
      for (int panel = 0; panel < panels; ++panel)
        for (Eigen::Index q = 0; q < rule.nodes.size(); ++q) {
          const double at = reached + width * (panel + rule.nodes[q]);
          sum += width * rule.weights[q] * f(std::sqrt(fixed * fixed + at * at));
        }
      reached = (j + 0.5) * step;
      (along_y ? table(i, j) : table(j, i)) = sum;
    }
  }
  return table;
}

/// int_0^X int_0^Y of the field whose `mean_within` is m, in h².
template <class Function>
CornerTable area_integrals(const OffsetLattice& lattice, double step_x, double step_y,
                           const Function& m) {
  CornerTable table = line_integrals(lattice, step_x, step_y, true, m);
  const CornerTable other = line_integrals(lattice, step_x, step_y, false, m);
  for (int i = 0; i < lattice.count_x; ++i)
    for (int j = 0; j < lattice.count_y; ++j)
      table(i, j) = (i + 0.5) * step_x * table(i, j) + (j + 0.5) * step_y * other(i, j);
  return table;
}

/// Mean over a cell around each offset, of a smooth response that is odd in X and in Y: a 24th of
/// the second differences more.
/// @param wider  the response with one more offset along each axis
CornerTable mean_over_cells(const CornerTable& wider, const OffsetLattice& lattice) {
  CornerTable mean(lattice.count_x, lattice.count_y);
  for (int i = 0; i < lattice.count_x; ++i)
    for (int j = 0; j < lattice.count_y; ++j) {
      const double here = wider(i, j), left = i > 0 ? wider(i - 1, j) : -here,
                   below = j > 0 ? wider(i, j - 1) : -here;
      mean(i, j) = here + (wider(i + 1, j) + left + wider(i, j + 1) + below - 4 * here) / 24;
    }
  return mean;
}

}  // namespace

StressCorners stress_corners(const ElasticLayer& layer, double depth_m,
                             const OffsetLattice& lattice) {
  const double h = layer.thickness_m, z = depth_m / h;
  const double step_x = lattice.step_x_m / h, step_y = lattice.step_y_m / h;
  const LayerStress stress(layer.poisson_ratio, z);
  // The layer's excess over the half-space of the normal stress, and of the potential whose
  // gradient is minus the shear.
  const auto [normal_excess, potential_excess] = hankel_transforms<2>([&](double x) {
    const LayerStress::Wave excess = stress.excess(x);
    return std::array{excess.normal * x, excess.shear};
  });
  const RadialTable mean = mean_within(normal_excess);
  // The sum of both is nothing beyond the reach, so that the excess is the half-space's, negative.
  StressCorners corners;
  corners.normal = area_integrals(lattice, step_x, step_y, [&](double r) {
    if (r < kStressReach) return mean(r);
    const double R = std::sqrt(r * r + z * z);
    return z * z * z / (2 * kPi * R * R * R * r * r);
  });
  const auto potential = [&, &excess = potential_excess](double r) {
    if (r < kStressReach) return excess(r);
    const double R = std::sqrt(r * r + z * z);
    return -z * z / (2 * kPi * R * R * R);
  };
  corners.shear_x = -line_integrals(lattice, step_x, step_y, true, potential);
  corners.shear_y = -line_integrals(lattice, step_x, step_y, false, potential);
  for (int i = 0; i < lattice.count_x; ++i)
    for (int j = 0; j < lattice.count_y; ++j) {
      const double X = (i + 0.5) * step_x, Y = (j + 0.5) * step_y;
      const double to_x = X * X + z * z, to_y = Y * Y + z * z, R = std::sqrt(to_x + Y * Y);
      corners.normal(i, j) +=
          (std::atan2(X * Y, z * R) + X * Y * z * (1 / to_x + 1 / to_y) / R) / (2 * kPi);
      corners.shear_x(i, j) -= z * z * Y / (2 * kPi * to_x * R);
      corners.shear_y(i, j) -= z * z * X / (2 * kPi * to_y * R);
    }
  return corners;
}

ShearCorners shear_corners(const ElasticLayer& layer, double depth_m,
                           const OffsetLattice& lattice) {
  const double h = layer.thickness_m, z = depth_m / h;
  const double step_x = lattice.step_x_m / h, step_y = lattice.step_y_m / h;
  const LayerStress stress(layer.poisson_ratio, z);
  // Excess over the half-space, per point force along x: of the potential whose derivative along x
  // is minus the normal stress; of the stress c along the force; and of l - c, whose potential is
  // theta: l - c adds the shear -grad(d theta/dx), and r theta' = -int_0^r (l - c) s ds.
  const auto tables = hankel_transforms<4>([&](double x) {
    const LayerStress::ShearWave excess = stress.shear_excess(x);
    const double difference = excess.along - excess.across;
    return std::array{excess.normal, excess.across * x, difference * x, difference / x};
  });
  const RadialTable across_mean = mean_within(tables[1]), difference_mean = mean_within(tables[2]);
  // The sum of both is nothing beyond the reach.
  const auto within = [&](const RadialTable& table, const auto& half_space) {
    return [&table, half_space, z](double r) {
      return r < kStressReach ? table(r) : -half_space(r, std::sqrt(r * r + z * z));
    };
  };
  const auto potential =
      within(tables[0], [z](double, double R) { return z * z / (2 * kPi * R * R * R); });
  const auto of_across =
      within(across_mean, [z](double r, double R) { return (1 - z / R) / (2 * kPi * r * r); });
  const auto of_difference =
      within(difference_mean, [z](double, double R) { return -z / (2 * kPi * R * R * R); });
  const auto theta = within(tables[3], [z](double, double R) { return -z / (2 * kPi * R); });

  ShearCorners corners;
  corners.normal_x = -line_integrals(lattice, step_x, step_y, true, potential);
  corners.normal_y = -line_integrals(lattice, step_x, step_y, false, potential);
  corners.along_x = area_integrals(lattice, step_x, step_y, of_across);
  corners.along_y = corners.along_x;
  const CornerTable difference_y = line_integrals(lattice, step_x, step_y, true, of_difference),
                    difference_x = line_integrals(lattice, step_x, step_y, false, of_difference);
  corners.across.resize(lattice.count_x, lattice.count_y);
  for (int i = 0; i < lattice.count_x; ++i)
    for (int j = 0; j < lattice.count_y; ++j) {
      const double X = (i + 0.5) * step_x, Y = (j + 0.5) * step_y;
      const double to_x = X * X + z * z, to_y = Y * Y + z * z, R = std::sqrt(to_x + Y * Y);
      corners.normal_x(i, j) -= z * z * Y / (2 * kPi * to_x * R);
      corners.normal_y(i, j) -= z * z * X / (2 * kPi * to_y * R);
      const double across = std::atan2(X * Y, z * R) / (2 * kPi);
      corners.along_x(i, j) += across + X * difference_y(i, j) - z * X * Y / (2 * kPi * to_x * R);
      corners.along_y(i, j) += across + Y * difference_x(i, j) - z * X * Y / (2 * kPi * to_y * R);
      corners.across(i, j) = z / (2 * kPi * R) - theta(std::hypot(X, Y));
    }
  return corners;
}

LiftCorners lift_corners(const ElasticLayer& layer, const OffsetLattice& lattice) {
  const double h = layer.thickness_m;
  const double step_x = lattice.step_x_m / h, step_y = lattice.step_y_m / h;
  const LayerStress stress(layer.poisson_ratio, 0);
  const double limit = stress.lift_of_half_space();
  // The part limit (1 - exp(-x))²/x of the waves w/x has a closed transform, 2 asinh(1/r) -
  // asinh(2/r), which is -ln r and a smooth function; nothing of w is left beyond the reach.
  const auto [excess] = hankel_transforms<1>([&](double x) {
    const double rise = -std::expm1(-x);
    return std::array{(stress.lift(x) - limit * rise * rise) / x};
  });
  const auto smooth = [&, &table = excess](double r) {
    const double log_r = std::log(std::max(r, 1e-300));
    if (r > kStressReach) return limit * log_r / (2 * kPi);
    return table(r) +
           limit * (2 * std::log(1 + std::sqrt(1 + r * r)) - std::log(2 + std::sqrt(4 + r * r))) /
               (2 * kPi);
  };
  LiftCorners corners{line_integrals(lattice, step_x, step_y, true, smooth),
                      line_integrals(lattice, step_x, step_y, false, smooth)};
  const auto log_integral = [](double across, double along) {
    return along * (std::log(std::hypot(across, along)) - 1) + across * std::atan2(along, across);
  };
  for (int i = 0; i < lattice.count_x; ++i)
    for (int j = 0; j < lattice.count_y; ++j) {
      const double X = (i + 0.5) * step_x, Y = (j + 0.5) * step_y;
      corners.x(i, j) -= limit / (2 * kPi) * log_integral(X, Y);
      corners.y(i, j) -= limit / (2 * kPi) * log_integral(Y, X);
    }
  const double shear_modulus_Pa = layer.youngs_modulus_Pa / (2 * (1 + layer.poisson_ratio));
  corners.x *= -h / shear_modulus_Pa;
  corners.y *= -h / shear_modulus_Pa;
  return corners;
}

CornerTable displacement_corners(const LayerStack& layer, const OffsetLattice& lattice) {
  const StackKernel kernel(layer);
  const double h = kernel.thickness_m();
  const double step_x = lattice.step_x_m / h, step_y = lattice.step_y_m / h;
  const double largest = std::hypot(lattice.count_x * step_x, lattice.count_y * step_y);
  // The moments of S up to its reach on a regular table, for which S is tabulated a little farther;
  // beyond the reach S = 1/t.
  constexpr double kStep = 0.1;
  const fft::LayerStiffening stiffening(kernel, largest + 10 * kStep);
  const double reach = std::min(largest + 6 * kStep, stiffening.reach());
  const QuadratureRule rule = gauss_legendre(4);
  std::vector<double> mean{0.5 * stiffening(0)};
  double moment = 0;
  for (int i = 1; i <= int(reach / kStep) + 4; ++i) {
    for (Eigen::Index q = 0; q < rule.nodes.size(); ++q) {
      const double s = (i - 1 + rule.nodes[q]) * kStep;
      moment += kStep * rule.weights[q] * (s < reach ? stiffening(s) : 1 / s) * s;
    }
    mean.push_back(moment / (i * kStep * i * kStep));
  }
  const double last = double(mean.size() - 4) * kStep;
  const double at_last = mean[mean.size() - 4] * last * last;
  OffsetLattice wider = lattice;
  ++wider.count_x;
  ++wider.count_y;
  const CornerTable smooth = area_integrals(wider, step_x, step_y, [&](double r) {
    return r < last ? at_even_table(mean, r / kStep) : (at_last + r - last) / (r * r);
  });
  CornerTable table = -mean_over_cells(smooth, lattice);
  Eigen::Array<long double, Eigen::Dynamic, Eigen::Dynamic> F(lattice.count_x + 1,
                                                              lattice.count_y + 1);
  for (int i = 0; i < F.rows(); ++i)
    for (int j = 0; j < F.cols(); ++j)
      F(i, j) = fft::fourfold_integral(static_cast<long double>(i) * step_x,
                                       static_cast<long double>(j) * step_y);
  for (int i = 0; i < lattice.count_x; ++i)
    for (int j = 0; j < lattice.count_y; ++j)
      table(i, j) += static_cast<double>(F(i + 1, j + 1) - F(i, j + 1) - F(i + 1, j) + F(i, j)) /
                     (step_x * step_y);
  return table * (h / (kPi * layer.surface().plane_strain_modulus_Pa()));
}

}  // namespace softfinger::taxels
