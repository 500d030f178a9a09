#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace softfinger {

/// Parameters that a calibration can determine from measurements.
enum class Parameter {
  youngs_modulus,  ///< E in Pa
  thickness,       ///< h in m
  poisson_ratio,   ///< nu
  radius,  ///< R = sqrt(R'R'') of the first contact in m; the radii of all change in proportion
  friction_coefficient,  ///< mu
  shear_strength,        ///< tau_0 in Pa
  radius_coefficient,    ///< c of a = c P^gamma, in m for P in N; of the model power_law
  radius_exponent,       ///< gamma
  zero,       ///< reading of the approach at the first touch, in m: a nuisance of the measurement
  compliance  ///< of machine and mount, in m/N: they give by this times the load; likewise
};
constexpr std::size_t kParameters = 10;

/// Range within which a fit searches for a parameter. It is wider than any real finger needs, so
/// that the interval of an undetermined parameter ends at its border.
struct ParameterRange {
  Parameter parameter;
  std::string_view name;  ///< as on the command line
  std::string_view unit;  ///< SI; empty for a number
  double lowest, highest;
  bool logarithmic;  ///< fitted as its logarithm
  bool is_nuisance;  ///< of the measurement, not of the finger
};

constexpr std::array<ParameterRange, kParameters> kParameterRanges{{
    {Parameter::youngs_modulus, "youngs_modulus", "Pa", 1e2, 1e11, true, false},
    {Parameter::thickness, "thickness", "m", 1e-5, 1, true, false},
    {Parameter::poisson_ratio, "poisson_ratio", "", 0, 0.5, false, false},
    {Parameter::radius, "radius", "m", 1e-4, 10, true, false},
    {Parameter::friction_coefficient, "friction_coefficient", "", 1e-3, 100, true, false},
    {Parameter::shear_strength, "shear_strength", "Pa", 1, 1e9, true, false},
    {Parameter::radius_coefficient, "radius_coefficient", "m", 1e-7, 1, true, false},
    {Parameter::radius_exponent, "radius_exponent", "", 0.01, 0.99, false, false},
    {Parameter::zero, "zero", "m", -0.05, 0.05, false, true},
    {Parameter::compliance, "compliance", "m/N", 0, 0.01, false, true},
}};

constexpr const ParameterRange& range_of(Parameter parameter) {
  return kParameterRanges[std::size_t(parameter)];
}

/// One number for each parameter, by `index_of` it.
using ParameterValues = std::array<double, kParameters>;

constexpr std::size_t index_of(Parameter parameter) { return std::size_t(parameter); }

inline bool contains(const std::vector<Parameter>& parameters, Parameter parameter) {
  return std::find(parameters.begin(), parameters.end(), parameter) != parameters.end();
}

}  // namespace softfinger
