#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "comparisons/benchmark/engine.h"
#include "comparisons/benchmark/problems.h"

namespace softfinger::benchmark {

/// The creep of a hold, measured by creep/creep.mjs in engines that are not linked here.
struct Drift {
  std::string engine, setting, scene;
  double load_N = 0, from_s = 0, to_s = 0;
  double moves_um_per_s = NAN, turns_mrad_per_s = NAN;  ///< NaN: lost
};

/// Reads what `creep.mjs --json` writes.
/// @param where  names the file in a message
/// @throws InputError for anything else.
std::vector<Drift> read_drifts(const std::string& text, const std::string& where);

/// All problems of all engines.
struct Results {
  std::vector<const Engine*> engines;
  std::vector<const Problem*> problems;
  std::vector<std::vector<Score>> scores;  ///< by engine, then by problem
  std::string version, machine, command;
  std::vector<Drift> drifts;  ///< empty: none were read
};

/// "+0.01 %", "0.02 mm": the largest error. Empty without one.
std::string worst_in_words(const Problem& problem, const Score& score);

/// SI beside the units that are stated.
nlohmann::json to_json(const Results& results);

/// One self-contained page: engines as rows, problems as columns, then all numbers.
std::string render_page(const Results& results);

}  // namespace softfinger::benchmark
