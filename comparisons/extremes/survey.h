#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger::extremes {

struct SurveyOptions {
  int points = 20000;     ///< problems for every model of the hot path
  int slow_points = 120;  ///< for every other one
  int lines = 4;          ///< along which jumps are looked for, six paths each
  unsigned seed = 20070322;
};

/// Asks every model problems far beyond any fingertip, as tests/extremes does, and counts what it
/// answered and whether it kept its promises: finite, positive, refusals in words, larger under
/// more load, the same in all units, no jumps. The keys are in report/README.md. The problems are
/// the same for the same options; a second for 20000 points.
nlohmann::json survey(const SurveyOptions& options);

/// Whether all models kept all promises.
bool kept_all_promises(const nlohmann::json& survey);

/// The survey as a table to read.
std::string table(const nlohmann::json& survey);

}  // namespace softfinger::extremes
