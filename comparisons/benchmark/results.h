#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "comparisons/benchmark/engine.h"
#include "comparisons/benchmark/problems.h"

namespace softfinger::benchmark {

/// All problems of all engines.
struct Results {
  std::vector<const Engine*> engines;
  std::vector<const Problem*> problems;
  std::vector<std::vector<Score>> scores;  ///< by engine, then by problem
  std::string version, machine, command;
};

/// "+0.01 %", "0.02 mm": the largest error. Empty without one.
std::string worst_in_words(const Problem& problem, const Score& score);

/// SI beside the units that are stated.
nlohmann::json to_json(const Results& results);

/// One self-contained page: engines as rows, problems as columns, then all numbers.
std::string render_page(const Results& results);

}  // namespace softfinger::benchmark
