#include "comparisons/commands/demand_input.h"

#include <algorithm>
#include <vector>

#include "comparisons/commands/commands.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {

prediction::Demand DemandInput::demand() const {
  using prediction::kQuantityNames;
  prediction::Demand demand;
  demand.tolerance = tolerance;
  if (quantities.empty()) return demand;
  demand.quantities.fill(false);
  const std::vector<std::string> known(kQuantityNames.begin(), kQuantityNames.end());
  for (std::size_t start = 0; start <= quantities.size();) {
    const std::size_t end = std::min(quantities.find(',', start), quantities.size());
    const std::string name = quantities.substr(start, end - start);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw InputError(
          "command line",
          "--quantities: unknown quantity \"" + name + "\"" + text::did_you_mean(name, known), "",
          text::joined(known));
    demand.quantities[std::size_t(found - known.begin())] = true;
    start = end + 1;
  }
  return demand;
}

void add_demand(CLI::App& command, DemandInput& typed) {
  command
      .add_option("--tolerance", typed.tolerance,
                  "relative error, geometry included, within which an answer is usable, 1e-6 "
                  "to 10; 0.05 is 5 %; default: 0.1")
      ->check(CLI::Range(1e-6, 10.));
  command
      .add_option("--quantities", typed.quantities,
                  "what has to be within the tolerance, separated by commas: a, b, indentation, "
                  "area, peak_pressure, max_torque; default: a,b,area,max_torque")
      ->check([](const std::string& names) {
        return names.empty() ? std::string("\"\": allowed: at least one quantity") : "";
      });
}

}  // namespace softfinger::commands
