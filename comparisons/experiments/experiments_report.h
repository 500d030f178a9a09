#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "comparisons/experiments/examine.h"

/// Experiments as JSON and as text for people.
namespace softfinger::experiments {

/// All built-in data sets, by name.
/// @throws InputError for a file that cannot be read
std::vector<Examined> examine_builtin();

/// {"experiments": [..], "noise_floor": ..}; README.md of comparisons/report describes the keys.
nlohmann::json to_json(const std::vector<Examined>& examined);

/// One verdict line for each data set, then its numbers.
std::string table(const std::vector<Examined>& examined);

/// A line that tells what a torque can be measured to, for wherever one is printed more finely:
/// "Torques have more digits than measurements: in hand, two fingers of one gripper differ by 26 to
/// 51 % (waltersson_2024_in_hand)." From the built-in data set; empty where it is not installed or
/// cannot be read.
std::string noise_remark();

/// A number of a finding in the unit that people read: mm, kPa, %.
std::string shown(double value, const std::string& unit);

}  // namespace softfinger::experiments
