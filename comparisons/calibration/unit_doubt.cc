#include "comparisons/calibration/unit_doubt.h"

#include <fmt/format.h>

#include <vector>

#include "comparisons/text/nearest_name.h"
#include "softfinger/calibration/advice.h"
#include "softfinger/input/errors.h"

namespace softfinger::calibration {
namespace {

/// The range from the softest gels and skin to hard rubber, and from wet skin to a clean silicone
/// that clings.
constexpr double kSoftest_Pa = 1e4, kHardest_Pa = 3e7;
constexpr double kLeastFriction = 0.1, kMostFriction = 5;

/// Factors that correct a column's numbers if they were meant in another unit.
struct Misreading {
  const char* meant;
  double load = 1, width = 1, indentation = 1, torque = 1;
};
constexpr double kNewtonsPerGram = 9.80665e-3;
constexpr Misreading kMisreadings[] = {
    {"with the loads in g", kNewtonsPerGram},
    {"with the loads in kg", 1e3 * kNewtonsPerGram},
    {"with the loads in mN", 1e-3},
    {"with all lengths in m", 1, 1e3, 1e3},
    {"with all lengths in µm", 1, 1e-3, 1e-3},
    {"with widths in place of semi-axes", 1, 0.5},
    {"with the torques in N·m", 1, 1, 1, 1e3},
};

double factor_of(const Misreading& misreading, MeasuredQuantity quantity) {
  switch (quantity) {
    case MeasuredQuantity::a:
    case MeasuredQuantity::b:
      return misreading.width;
    case MeasuredQuantity::area:
      return misreading.width * misreading.width;
    case MeasuredQuantity::indentation:
      return misreading.indentation;
    case MeasuredQuantity::max_torque:
      return misreading.torque;
    case MeasuredQuantity::tangential_force:
      return misreading.load;
  }
  return 1;
}

/// The problem as it would have been meant.
CalibrationProblem meant(const CalibrationProblem& problem, const Misreading& misreading) {
  CalibrationProblem changed = problem;
  for (ContactProblem& contact : changed.measurements.contacts)
    contact.load.normal_force_N *= misreading.load;
  for (Measurement& value : changed.measurements.values) {
    value.value *= factor_of(misreading, value.quantity);
    value.std *= factor_of(misreading, value.quantity);
  }
  return changed;
}

std::string modulus_in_words(double modulus_Pa) {
  return modulus_Pa < 1e6 ? fmt::format("{:.3g} kPa", 1e-3 * modulus_Pa)
                          : fmt::format("{:.3g} MPa", 1e-6 * modulus_Pa);
}

/// Values found for E and mu, in words: all of them, and those that no soft fingertip has.
struct Found {
  std::vector<std::string> all, strange;
  explicit Found(const Calibration& calibration) {
    for (const ParameterEstimate& estimate : calibration.parameters) {
      const double value = estimate.value;
      if (estimate.parameter == Parameter::youngs_modulus) {
        all.push_back("E = " + modulus_in_words(value));
        if (!(value >= kSoftest_Pa && value <= kHardest_Pa)) strange.push_back(all.back());
      } else if (estimate.parameter == Parameter::friction_coefficient) {
        all.push_back(fmt::format("mu = {:.3g}", value));
        if (!(value >= kLeastFriction && value <= kMostFriction)) strange.push_back(all.back());
      }
    }
  }
};

}  // namespace

std::string better_units(const CalibrationProblem& problem) {
  std::string better;
  for (const Misreading& misreading : kMisreadings) {
    try {
      const CalibrationProblem changed = meant(problem, misreading);
      const Calibration calibration = calibrate(changed);
      const Found found(calibration);
      if (!found.strange.empty() || found.all.empty() ||
          !contradiction(changed, calibration).empty())
        continue;
      better += fmt::format("{}{} the data give {}", better.empty() ? "" : "; ", misreading.meant,
                            text::joined(found.all, " and "));
    } catch (const InputError&) {
      // The model has no answer for such numbers: they were not meant so.
    }
  }
  return better;
}

std::string unit_doubt(const CalibrationProblem& problem, const Calibration& found) {
  const Found values(found);
  if (values.strange.empty()) return "";
  const std::string better = better_units(problem);
  return fmt::format(
      "{}: far outside of rubber (E 10 kPa to 30 MPa, mu 0.1 to 5). Are the loads in newtons, and "
      "the lengths in the units of their columns?{}",
      text::joined(values.strange, " and "), better.empty() ? "" : " Read " + better + ".");
}

}  // namespace softfinger::calibration
