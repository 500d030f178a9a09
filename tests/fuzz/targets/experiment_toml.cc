// Data sets of published measurements, and what the theory says of them.

#include <cmath>
#include <stdexcept>
#include <variant>

#include "comparisons/experiments/experiments_report.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

void require_numbers(const experiments::Examined& examined) {
  for (const experiments::Finding& finding : examined.findings)
    if (!std::isfinite(finding.predicted.value)) throw std::logic_error(finding.test);
  for (const experiments::Inferred& number : examined.inferred)
    if (!std::isfinite(number.value.value)) throw std::logic_error(number.name);
}

bool read(std::string_view bytes) {
  try {
    const experiments::Experiment experiment =
        experiments::parse_experiment(std::string(bytes), "fuzzed.toml");
    // Each exponent is that of hundreds of contacts, and each curve three calibrations, which take
    // seconds with sanitizers.
    if (std::holds_alternative<experiments::Growth>(experiment.data) ||
        std::holds_alternative<experiments::PressCurves>(experiment.data))
      return true;
    const experiments::Examined examined = experiments::examine(experiment);
    require_numbers(examined);
    experiments::table({examined});
    return true;
  } catch (const InputError&) {
    return false;
  } catch (const ConvergenceError&) {
    return true;
  }
}

std::vector<std::string> seeds() { return texts_of(SOFTFINGER_EXPERIMENTS, ".toml"); }

}  // namespace

const Target experiment_toml = {"experiment_toml", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
