#include <fmt/format.h>

#include <limits>

#include "comparisons/experiments/examine.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/rubbed_prediction.h"

namespace softfinger::experiments {
namespace {

/// Standard deviations within which a measurement is taken to lie.
constexpr double kDeviations = 2;

}  // namespace

void examine_indentation(const Indentation& data, Examined& examined) {
  const auto predicted = [&](const PressureModel& model, double modulus_Pa) {
    ContactProblem problem;
    problem.radii = {data.sphere_radius_m, data.sphere_radius_m, 0};
    problem.layer = {data.thickness_m, modulus_Pa, data.poisson_ratio};
    problem.load.normal_force_N = data.load_N;
    problem.is_object_spherical = true;
    const Prediction found = model.predict(problem);
    // A gel sticks to what is pressed into it.
    return found.has_answer && knows_pressing_friction(model)
               ? rubbed(model, found, problem, std::numeric_limits<double>::infinity())
               : found;
  };
  std::string numbers;
  std::vector<std::string> excluded, possible;
  for (const auto& [name, role] :
       {std::pair("fingertip_layer", Role::theory), std::pair("bonded_layer", Role::rival),
        std::pair("hertz", Role::rival), std::pair("winkler", Role::rival)}) {
    const PressureModel& model = *find_pressure_model(name);
    const double factor = data.youngs_modulus_factor;
    const Prediction middle = predicted(model, data.youngs_modulus_Pa),
                     soft = predicted(model, data.youngs_modulus_Pa / factor),
                     hard = predicted(model, data.youngs_modulus_Pa * factor);
    if (!middle.has_answer || !soft.has_answer || !hard.has_answer) continue;
    Finding finding;
    finding.test = fmt::format("indentation at {:g} N", data.load_N);
    finding.model = name;
    finding.role = role;
    finding.unit = "m";
    finding.measured = data.indentation_m;
    finding.uncertainty = kDeviations * data.indentation_std_m;
    finding.predicted = {middle.indentation_m, hard.indentation_m, soft.indentation_m};
    finding.verdict = compared(finding);
    if (finding.verdict == Verdict::fails && data.includes_other_compliance &&
        finding.predicted.high < data.indentation_m) {
      finding.verdict = Verdict::cannot_tell;
      finding.reason = "Less than measured, but the measured approach is not the gel's alone.";
    }
    (finding.verdict == Verdict::fails ? excluded : possible).push_back(name);
    if (!middle.valid() && finding.reason.empty())
      for (const ValidityCheck& check : middle.validity)
        if (!check.holds()) {
          finding.reason = fmt::format("Outside its range: {}.", check.message);
          break;
        }
    numbers +=
        fmt::format("{}{} {:.2f} ({:.2f} to {:.2f})", numbers.empty() ? "" : ", ", name,
                    middle.indentation_m * 1e3, hard.indentation_m * 1e3, soft.indentation_m * 1e3);
    examined.findings.push_back(finding);
  }
  examined.sentence = fmt::format(
      "Excluded: {}; not told apart: {}. Measured {:.2g} ± {:.1g} mm; predicted in mm, with E "
      "known to a "
      "factor of {:g}: {}.",
      excluded.empty() ? "none" : text::joined(excluded),
      possible.empty() ? "none" : text::joined(possible), data.indentation_m * 1e3,
      kDeviations * data.indentation_std_m * 1e3, data.youngs_modulus_factor, numbers);
}

}  // namespace softfinger::experiments
