#include "softfinger/pressure/power_law_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "softfinger/input/errors.h"

namespace softfinger {

PowerLawFit fit_power_law(const std::vector<LoadAndRadius>& data, double pressure_exponent) {
  const std::string where = "power law";
  const auto require = [&](bool condition, const char* field, double value, const char* allowed) {
    if (condition) return;
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    throw InputError(where, field, text, allowed);
  };
  require(data.size() >= 2, "number of points", static_cast<double>(data.size()), "at least 2");
  require(pressure_exponent >= 1 && std::isfinite(pressure_exponent), "pressure exponent",
          pressure_exponent, "a finite number >= 1");
  PowerLawFit fit;
  fit.least_load_N = fit.largest_load_N = data.front().load_N;
  const double n = static_cast<double>(data.size());
  double mean_x = 0, mean_y = 0;
  for (const LoadAndRadius& point : data) {
    require(point.load_N > 0 && std::isfinite(point.load_N), "load", point.load_N,
            "finite numbers > 0");
    require(point.radius_m > 0 && std::isfinite(point.radius_m), "radius", point.radius_m,
            "finite numbers > 0");
    fit.least_load_N = std::min(fit.least_load_N, point.load_N);
    fit.largest_load_N = std::max(fit.largest_load_N, point.load_N);
    mean_x += std::log(point.load_N) / n;
    mean_y += std::log(point.radius_m) / n;
  }
  double sum_xx = 0, sum_xy = 0;
  for (const LoadAndRadius& point : data) {
    const double x = std::log(point.load_N) - mean_x;
    sum_xx += x * x;
    sum_xy += x * (std::log(point.radius_m) - mean_y);
  }
  require(fit.largest_load_N > fit.least_load_N && sum_xx > 0, "load", fit.largest_load_N,
          "at least two different loads");
  const double gamma = sum_xy / sum_xx;
  require(gamma > 0 && gamma < 1, "fitted exponent gamma", gamma,
          "between 0 and 1: the radius must grow with the load, more slowly than it");
  fit.law = {std::exp(mean_y - gamma * mean_x), gamma, pressure_exponent};

  double sum_residuals = 0;
  for (const LoadAndRadius& point : data) {
    const double residual =
        std::log(point.radius_m) - mean_y - gamma * (std::log(point.load_N) - mean_x);
    sum_residuals += residual * residual;
  }
  fit.residual_rms = std::sqrt(sum_residuals / n);
  if (data.size() > 2) {
    const double variance = sum_residuals / (n - 2);
    fit.log_radius_std = std::sqrt(variance / n);
    fit.exponent_std = std::sqrt(variance / sum_xx);
  }
  return fit;
}

}  // namespace softfinger
