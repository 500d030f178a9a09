#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparisons/judgement/judgement.h"
#include "comparisons/report/html.h"

/// What the page claims about models, computed from report.json alone, so that every claim can be
/// checked against the tables below it.
namespace softfinger::report {

using judgement::Judgement;
using judgement::label;

/// The larger |relative error| of a prediction in area and maximal torque, the quantities that
/// verdicts judge by. Nothing when the model has no answer or the FEM failed.
struct Score {
  double error = 0;
  std::string quantity;  ///< "area" or "torque"
  double load_N = 0;
};
std::optional<Score> score(const Json& load, const Json& model);

/// The same from the report: `silent` without an answer or a reference.
Judgement judge(const Json& report, const Json& load, const Json& model);

/// A model over all loads of a case that have a reference; nothing when it misses one of them.
std::optional<Score> worst_score(const Json& report_case, const std::string& model);

/// The model with the smallest worst error in the case, those that are usable at every load first;
/// null when no model can be compared.
struct Best {
  std::string model;
  Score score;
  bool valid = false;  ///< at every load inside what the model itself claims
};
std::optional<Best> best_model(const Json& report, const Json& report_case);

/// A model over the whole report.
struct Usability {
  std::string model;
  int compared = 0, usable = 0;
  int accidents = 0;      ///< within the tolerance, outside its validity
  int valid = 0;          ///< loads at which the model claims to hold
  int broken_claims = 0;  ///< claims to hold, yet beyond the tolerance
  double worst = 0, median = 0;
  std::optional<double> smallest_s, largest_s;  ///< where it is usable, s = sqrt(a b)/h
  std::optional<double> smallest_nu, largest_nu;
};
std::vector<Usability> usability(const Json& report);

/// The reference over the whole report.
struct ReferenceSummary {
  int cases = 0, loads = 0, solved = 0, trusted = 0;
  int without_usable_model = 0;  ///< loads with a reference at which no model meets the tolerance
  double median_torque_error = 0, worst_torque_error = 0;  ///< stated by the FEM itself
  double worst_axis_error = 0;
};
ReferenceSummary reference_summary(const Json& report);

double tolerance(const Json& report);

/// Names in the order of the registry, then any that only the loads mention.
std::vector<std::string> model_names(const Json& report);

/// How a model is drawn, everywhere on the page; the reference is slot 0.
struct Style {
  std::string colour;  ///< CSS
  std::string dash;    ///< SVG stroke-dasharray
};
Style style(const Json& report, const std::string& model);

}  // namespace softfinger::report
