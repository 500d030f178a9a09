#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger::extremes {

struct SurveyOptions {
  int points = 20000;     ///< problems for each model that takes microseconds (card().hot_path)
  int slow_points = 120;  ///< problems for each slower model
  int lines = 4;          ///< random problems around which jumps are searched, along six paths each
  unsigned seed = 20070322;
};

/// Asks every model random problems far beyond any fingertip, as tests/extremes does. Counts
/// answers and refusals and checks invariants: numbers are finite and positive, a refusal gives a
/// reason, more load gives a larger contact, units do not change the answer, there are no jumps.
/// The keys of the result are in report/README.md (the key "promise" there names an invariant). The
/// same options give the same problems. 20000 points take about a second.
nlohmann::json survey(const SurveyOptions& options);

/// Whether no model violated an invariant.
bool all_invariants_hold(const nlohmann::json& survey);

/// The survey as a table to read.
std::string table(const nlohmann::json& survey);

}  // namespace softfinger::extremes
