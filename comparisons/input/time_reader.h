#pragma once

#include "comparisons/input/case.h"
#include "comparisons/input/toml_reader.h"

/// Internal to the reader of cases: the keys `[layer] relaxation` (of scenes, too) and `[contact]
/// history`.
namespace softfinger::input {

/// Reads `relaxation = [{ share, time_s }, ..]` or `{ exponent, time_s, until_s }` of a layer.
/// @returns elastic where it has none
Relaxation read_relaxation(const TomlReader& reader, const toml::table& layer);

/// Reads `history = [{ time_s, load_N or approach_mm }, ..]`, which stands in place of load_N.
void read_history(const TomlReader& reader, const toml::node& node, Case& result);

/// Refuses what relaxing layers do not know yet: layers of several kinds, doubts of loads.
void check_times(const TomlReader& reader, const toml::table& root, const Case& result);

}  // namespace softfinger::input
