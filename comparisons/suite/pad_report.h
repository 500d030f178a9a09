#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "comparisons/judgement/pad_comparison.h"

/// The part of `compare`'s files that flat pads have.
namespace softfinger::suite {

/// An entry of "cases" in report.json, with "contact": "patch" (comparisons/report/README.md).
nlohmann::json pad_json(const judgement::PadCaseComparison& compared);

/// The results of all loads as all commands have them (docs/json.md).
nlohmann::json pad_results_json(const judgement::PadCaseComparison& compared);

/// Names of the columns that pads have beside those of curved contacts, with the kind of contact.
extern const std::string kPadColumns;
/// The cells of a curved contact in these columns.
extern const std::string kEllipseInPadColumns;
/// Rows of results.csv; empty in the columns that only curved contacts have.
std::string pad_csv_rows(const judgement::PadCaseComparison& compared);

}  // namespace softfinger::suite
