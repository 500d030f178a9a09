#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparisons/judgement/judgement.h"
#include "comparisons/judgement/model_errors.h"
#include "comparisons/prediction/quantity.h"

/// Summaries of errors over loads, cases and the whole suite, as reports state them.
namespace softfinger::judgement {

/// The largest |relative error| of a prediction in a, b, area and maximal torque, by which models
/// are compared. Nothing when the model has no answer or the finite elements failed.
struct Score {
  double error = 0;
  prediction::Quantity quantity = prediction::Quantity::area;  ///< which one it is
  double load_N = 0;
};
std::optional<Score> score(const LoadErrors& load, const ModelError& model);

/// `silent` without an answer or a reference, `off` where an error is no number.
Judgement judge(const LoadErrors& load, const ModelError& model, double tolerance);

/// A model over all loads of a case that have a reference; nothing when it misses one of them.
std::optional<Score> worst_score(const CaseErrors& errors, const std::string& model);

/// The model with the smallest worst error in the case; those that are usable at every load first,
/// and of them the fast ones, as in the verdict.
struct Best {
  std::string model;
  Score score;
  bool sound = false;  ///< at every load
  bool hot_path = true;
};
std::optional<Best> best_model(const CaseErrors& errors, double tolerance);

/// A model over the whole suite.
struct Usability {
  std::string model;
  int compared = 0, usable = 0;
  int accidents = 0;      ///< within the tolerance, outside its range
  int sound = 0;          ///< loads at which it is
  int broken_claims = 0;  ///< sound, yet beyond the tolerance
  double worst = 0, median = 0;
  std::optional<double> smallest_s, largest_s;  ///< where it is usable, s = sqrt(a b)/h
  std::optional<double> smallest_nu, largest_nu;
};
/// @param models  names, in the order of the result
std::vector<Usability> usability(const std::vector<CaseErrors>& cases,
                                 const std::vector<std::string>& models, double tolerance);

/// The reference over the whole suite.
struct ReferenceSummary {
  int cases = 0, loads = 0, solved = 0, trusted = 0;
  int without_usable_model = 0;  ///< loads with a reference at which no model meets the tolerance
  double median_torque_error = 0, worst_torque_error = 0;  ///< stated by the finite elements
  double worst_axis_error = 0;
  double worst_geometry_error = 0;  ///< of scans; infinite where one does not state it
};
ReferenceSummary reference_summary(const std::vector<CaseErrors>& cases, double tolerance);

}  // namespace softfinger::judgement
