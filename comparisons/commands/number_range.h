#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>

namespace softfinger::commands {

/// As CLI::Range, which lets nan through: it is neither below nor above.
inline CLI::Validator number_range(double least, double largest) {
  const std::string range = fmt::format("{:g} to {:g}", least, largest);
  return CLI::Validator(
      [=](const std::string& typed) {
        double value = 0;
        const bool is_inside =
            CLI::detail::lexical_cast(typed, value) && value >= least && value <= largest;
        return is_inside ? std::string() : fmt::format("Value {} not in range {}", typed, range);
      },
      "FLOAT in [" + range + "]", "NUMBER_RANGE");
}

}  // namespace softfinger::commands
