#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "softfinger/pressure/pressure_model.h"
#include "tests/extremes/extreme_problem.h"

/// Whether a model's numbers jump where it switches between series, asymptotes and tables.
namespace softfinger::testing {

constexpr int kNumbers = 5;
using Numbers = std::array<double, kNumbers>;  // NaN without an answer

inline Numbers logarithms(const Prediction& prediction) {
  if (!prediction.has_answer) return {NAN, NAN, NAN, NAN, NAN};
  return {std::log(prediction.a_m), std::log(prediction.b_m), std::log(prediction.indentation_m),
          std::log(prediction.peak_pressure_Pa), std::log(prediction.torque_arm_exact_m)};
}

/// Value at `t` of the polynomial through `values` at the points first, first + step, ...
inline double extrapolated(const std::array<double, 5>& values, double first, double step,
                           double t) {
  double sum = 0;
  for (int i = 0; i < 5; ++i) {
    double weight = 1;
    for (int j = 0; j < 5; ++j)
      if (j != i) weight *= (t - first - j * step) / ((i - j) * step);
    sum += weight * values[i];
  }
  return sum;
}

/// The largest jump of any number along a path, t from 0 to 1.
///
/// A jump lies between two samples. At the middle of each interval the polynomial through the five
/// samples before it is compared with the polynomial through the five samples after it. The
/// intervals where they differ most are bisected: the half is kept in which the number changes from
/// following the one polynomial to following the other. The difference over the last, vanishing
/// interval is the jump. A smooth curve and a kink have none.
inline double largest_jump(const std::function<Numbers(double)>& numbers, int samples) {
  constexpr std::size_t kSuspects =
      10;  // in the intervals beside a jump the polynomials differ, too
  const double step = 1.0 / samples;
  std::vector<Numbers> values;
  for (int i = 0; i <= samples; ++i) values.push_back(numbers(i * step));
  double worst = 0;
  for (int k = 0; k < kNumbers; ++k) {
    const auto before = [&](int i, double t) {
      return extrapolated(
          {values[i - 4][k], values[i - 3][k], values[i - 2][k], values[i - 1][k], values[i][k]},
          (i - 4) * step, step, t);
    };
    const auto after = [&](int i, double t) {
      return extrapolated({values[i + 1][k], values[i + 2][k], values[i + 3][k], values[i + 4][k],
                           values[i + 5][k]},
                          (i + 1) * step, step, t);
    };
    std::vector<std::pair<double, int>> suspects;  // difference, interval
    for (int i = 4; i + 5 <= samples; ++i) {
      const double middle = (i + 0.5) * step;
      const double departure = std::abs(before(i, middle) - after(i, middle));
      if (std::isfinite(departure)) suspects.push_back({departure, i});
    }
    std::sort(suspects.rbegin(), suspects.rend());
    if (suspects.size() > kSuspects) suspects.resize(kSuspects);
    for (const auto& [departure, i] : suspects) {
      double low = i * step, high = (i + 1) * step;
      while (high - low > 1e-13) {
        const double middle = (low + high) / 2, value = numbers(middle)[k];
        const bool still_before =
            std::abs(value - before(i, middle)) < std::abs(value - after(i, middle));
        (still_before ? low : high) = middle;
      }
      worst = std::max(worst, std::abs(numbers(high)[k] - numbers(low)[k]));
    }
  }
  return worst;
}

inline double largest_jump(const PressureModel& model,
                           const std::function<ContactProblem(double)>& path, int samples) {
  return largest_jump([&](double t) { return logarithms(model.predict(path(t))); }, samples);
}

/// A one-parameter family of problems, t from 0 to 1, over which a model should be continuous.
struct Path {
  const char* what;
  ContactProblem base;
  int samples;
  std::function<ContactProblem(double)> problem;
};

/// Six paths around a random problem, over up to 12 decades. The contacts of lines 0, 3, 6, ... are
/// round.
inline std::vector<Path> draw_paths(ExtremeProblems& problems, int line) {
  ContactProblem base = problems.draw();
  base.object_layer = {};
  const double minor_m = base.radii.minor_m;
  // The layer is about as thick as the contact, so that the edges of the models' tables lie on the
  // path.
  const double contact_m =
      std::cbrt(base.load.normal_force_N / base.layer.youngs_modulus_Pa * minor_m);
  base.radii.major_m = minor_m * (line % 3 ? problems.log_uniform(1, 1e3) : 1);
  base.layer.thickness_m = contact_m;
  std::vector<Path> paths;
  const auto add = [&](const char* what, int samples, auto change) {
    paths.push_back({what, base, samples, [base, change](double t) {
                       ContactProblem problem = base;
                       change(problem, t);
                       return problem;
                     }});
  };
  add("thickness", 2000, [contact_m](ContactProblem& problem, double t) {
    problem.layer.thickness_m = contact_m * std::pow(10, 6 - 12 * t);
  });
  add("load", 2000, [](ContactProblem& problem, double t) {
    problem.load.normal_force_N *= std::pow(10, 12 * t - 6);
  });
  base.layer.thickness_m = contact_m * problems.log_uniform(1e-3, 1e2);
  add("ratio of radii", 2000, [minor_m](ContactProblem& problem, double t) {
    problem.radii.major_m = minor_m * std::pow(10, 8 * t);
  });
  add("ratio of radii next to one", 500, [minor_m](ContactProblem& problem, double t) {
    problem.radii.major_m = minor_m * (1 + std::pow(10, -14 + 13 * t));
  });
  add("Poisson's ratio", 500,
      [](ContactProblem& problem, double t) { problem.layer.poisson_ratio = 0.4999 * t; });
  add("Poisson's ratio next to one half", 500, [](ContactProblem& problem, double t) {
    problem.layer.poisson_ratio = 0.5 - std::pow(10, -3 - 14 * t);
  });
  return paths;
}

}  // namespace softfinger::testing
