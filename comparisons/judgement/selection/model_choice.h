#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
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
  double tolerance = 0.05;           ///< of every chosen quantity, relative
  double budget_us = 0;              ///< per answer; 0: any
  std::vector<std::string> models;   ///< allowed ones, by name, "fem" too; empty: all and fem
  std::vector<Quantity> quantities;  ///< that have to meet the tolerance; empty: all
};

/// A model as a candidate for one contact.
struct Candidate {
  std::string model;
  double cost_us = 0;
  std::optional<QuantityErrors> bound;  ///< `Assessment::total`: what the fit leaves open included
  bool usable = false;  ///< area and torque within the tolerance, as predict says it
  double worst = 0;     ///< largest bound among the chosen quantities
  Quantity worst_quantity = Quantity::a;
  std::string remark;  ///< the evidence for the bound, or why there is none
  bool accurate = false, affordable = false;

  bool meets() const { return accurate && affordable; }
};

/// The answer for one load. Indices into `candidates`, which are ordered by cost; -1: none.
struct Choice {
  double load_N = 0;
  std::vector<Candidate> candidates;
  int chosen = -1;
  int next_better = -1;   ///< the cheapest whose stated error is at least a tenth smaller
  int next_cheaper = -1;  ///< the most expensive of those that cost less
  std::string reason;     ///< one or two sentences
};

/// Models that take longer than microseconds are not asked, and have no bound.
Choice choose_model(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                    double load_N, const SelectionOptions& options);

/// The names of the quantities that were typed, separated by commas.
/// @throws InputError for an unknown one
std::vector<Quantity> quantities_by_name(const std::string& names);

/// "420 ns", "1.7 s"
std::string duration_text(double time_us);

/// The contract's keys of one choice, and all candidates.
nlohmann::json to_json(const Choice& choice);

/// The same as a table to read.
std::string table(const Choice& choice, const SelectionOptions& options);

}  // namespace softfinger::judgement
