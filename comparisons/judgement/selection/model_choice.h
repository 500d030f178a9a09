#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/quantity.h"

/// Which model is enough for a contact: the cheapest one whose stated error meets a tolerance.
namespace softfinger::judgement {

using prediction::kQuantities;
using prediction::kQuantityNames;
using prediction::Quantity;
using prediction::QuantityErrors;

struct SelectionOptions {
  prediction::Demand demand;
  double budget_us = 0;             ///< per answer; 0: any
  std::vector<std::string> models;  ///< allowed ones, by name, "fem" too; empty: all and fem
};

/// A model as a candidate for one contact.
struct Candidate {
  std::string model;
  double cost_us = 0;  ///< as measured, or of an earlier run
  /// The rank by which costs are compared: all models of the hot path are equal, since what they
  /// differ by is less than what one measurement differs from the next; the others differ by
  /// decades.
  int cost_class = 0;
  std::optional<QuantityErrors> bound;  ///< `Assessment::total`: what the fit leaves open included
  bool asked = false;
  bool usable = false;  ///< the demand is met: what predict says for the same demand
  double worst = 0;     ///< largest bound among the demanded quantities
  Quantity worst_quantity = Quantity::a;
  std::string remark;  ///< the evidence for the bound, or why there is none
  bool affordable = false;

  bool meets() const { return usable && affordable; }
};

/// The answer for one load. Indices into `candidates`, which are ordered by their class of cost,
/// within it by their worst bound; -1: none.
struct Choice {
  double load_N = 0;
  std::vector<Candidate> candidates;
  int chosen = -1;
  int next_better = -1;   ///< the cheapest whose stated error is at least a tenth smaller
  int next_cheaper = -1;  ///< the best of those of a lower class of cost
  std::string reason;     ///< one or two sentences
};

/// The cheapest of candidates that were asked, and its neighbours in cost and error.
Choice choose_among(std::vector<Candidate> candidates, double load_N,
                    const SelectionOptions& options);

/// The rank of a model's cost (`Candidate::cost_class`).
int cost_class(bool hot_path, double cost_us);

/// Whether a model is among the allowed ones.
bool is_allowed(const SelectionOptions& options, std::string_view model);

/// Models that take longer than microseconds are asked only where they are named.
Choice choose_model(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                    double load_N, const SelectionOptions& options);

/// "420 ns", "1.7 s"
std::string duration_text(double time_us);

/// The contract's keys of one choice, and all candidates.
nlohmann::json to_json(const Choice& choice);

/// The candidates as a list of results, as other commands have it (docs/json.md).
nlohmann::json results_json(const Choice& choice);

/// "2 N: fingertip_layer within 1 % (area), 1.2 us per answer", or why there is none.
std::string answer_line(const Choice& choice);

/// The choice as a table to read.
std::string table(const Choice& choice, const SelectionOptions& options);

}  // namespace softfinger::judgement
