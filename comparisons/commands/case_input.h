#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "comparisons/input/case.h"

/// Input files of commands: a path, a built-in name or "-", with values replaced.
namespace softfinger::commands {

/// A case from a file, or from numbers on the command line, which also replace those of a file.
struct CaseInput {
  std::string command;  ///< that takes them: "predict"
  input::FlatPads pads = input::FlatPads::refused;
  input::Times times = input::Times::refused;
  std::string file;  ///< as typed; empty: all by numbers
  std::vector<std::string> settings;
  std::string radii_mm, pad_mm, pad_diameter_mm, thickness_mm, youngs_modulus_kPa, poisson_ratio,
      load_N, friction;
};

/// Adds --set.
/// @param of  what the values are of: "case", "scene"
void add_settings(CLI::App& command, std::vector<std::string>& settings, const std::string& of);

/// Adds CASE, --set and the numbers in its place.
/// @param has_load  whether the command has a --load of its own
/// @param pads      whether it can do with a flat pad; if so, it may be typed as numbers, too
void add_case(CLI::App& command, CaseInput& typed, bool has_load = false,
              input::FlatPads pads = input::FlatPads::refused);

/// @throws InputError(where "--set ..."), also for a key that is set twice
input::Settings settings_of(const std::vector<std::string>& typed);

/// Settings and numbers.
/// @throws InputError when there is neither a file nor all numbers that a case needs, for a number
/// that is none, and for a value that is typed twice
input::Settings settings_of(const CaseInput& typed);

/// @throws InputError
input::Case read_case(const CaseInput& typed);

/// @throws InputError where --at-time has been typed for a case in which nothing changes with time
void refuse_time_without_times(const input::Case& contact_case, const std::string& at_time);

}  // namespace softfinger::commands
