#include "comparisons/judgement/selection/pad_choice.h"

#include <array>
#include <cmath>
#include <utility>

#include "comparisons/judgement/selection/selection_report.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/pad_answer.h"
#include "comparisons/reference/pad_elements.h"
#include "softfinger/input/constants.h"

namespace softfinger::judgement {
namespace {

using nlohmann::json;

/// Both models together answer within the time that a user does not notice.
constexpr double kPadBudget_ns = 1e5;

double& at(QuantityErrors& errors, Quantity quantity) { return errors[std::size_t(quantity)]; }

/// A pad has no semi-axes; its area is that of the outline.
QuantityErrors pad_bound(double indentation, double peak_pressure, double max_torque) {
  QuantityErrors bound{};
  at(bound, Quantity::a) = at(bound, Quantity::b) = kNaN;
  at(bound, Quantity::indentation) = indentation;
  at(bound, Quantity::peak_pressure) = peak_pressure;
  at(bound, Quantity::max_torque) = max_torque;
  return bound;
}

Candidate pad_candidate(const prediction::PadAnswer& answer) {
  Candidate candidate;
  candidate.model = std::string(answer.model->card().name);
  candidate.cost_us = 1e-3 * answer.cost_ns;
  candidate.asked = true;
  candidate.usable = answer.usable;
  candidate.remark = answer.evidence;
  if (answer.bound)
    candidate.bound =
        pad_bound(answer.bound->indentation, answer.bound->peak_pressure, answer.bound->max_torque);
  return candidate;
}

/// The elements before they have run: twice what they state of themselves on discs, rectangles and
/// smaller faces (fem/pad/README.md), level 1 to 3.
Candidate pad_elements(const input::Case& contact_case, double strain,
                       const prediction::Demand& demand) {
  constexpr std::array<double, 3> kIndentation = {8e-3, 2e-3, 1e-3}, kTorque = {6e-3, 1.2e-3, 1e-3},
                                  kPeak = {0.16, 0.08, 0.06};
  constexpr double kLargestStrain = 0.1;
  const auto level = std::size_t(contact_case.fem_level - 1);
  Candidate candidate;
  candidate.model = "fem";
  candidate.cost_us = 1e6 * reference::expected_pad_s(contact_case);
  candidate.cost_class = cost_class(false, candidate.cost_us);
  candidate.asked = true;
  if (const auto refusal = reference::elements_refusal(contact_case)) {
    candidate.remark = *refusal;
  } else if (!(strain <= kLargestStrain)) {
    candidate.remark =
        "the pad is compressed by more than a tenth: rubber stiffens, and these elements are "
        "linear";
  } else {
    candidate.remark = "the elements state their own error when they have run; linear theory";
    candidate.bound = pad_bound(kIndentation[level], kPeak[level], kTorque[level]);
    candidate.usable = demand.is_met_by(*candidate.bound);
  }
  return candidate;
}

}  // namespace

Choice choose_pad_model(const input::Case& contact_case, const PadShape& shape, double load_N,
                        const SelectionOptions& asked) {
  SelectionOptions options = asked;
  for (const Quantity axis : {Quantity::a, Quantity::b})
    options.demand.quantities[std::size_t(axis)] = false;
  std::vector<Candidate> candidates;
  double strain = 0;
  for (const PadModel* model : all_pad_models()) {
    const prediction::PadAnswer answer = prediction::ask_pad_model(
        *model, contact_case, shape, load_N, options.demand, kPadBudget_ns);
    // The first one is the default.
    if (candidates.empty() && model == all_pad_models().front())
      strain = answer.prediction.indentation_m / contact_case.layer.thickness_m;
    if (is_allowed(options, model->card().name)) candidates.push_back(pad_candidate(answer));
  }
  if (is_allowed(options, "fem"))
    candidates.push_back(pad_elements(contact_case, strain, options.demand));
  return choose_among(std::move(candidates), load_N, options);
}

json pad_selection_report(const input::Case& contact_case, const SelectionOptions& options,
                          const std::vector<Choice>& choices, const std::string& command) {
  json list = json::array();
  for (const Choice& choice : choices) list.push_back(to_json(choice));
  const json report = {
      {"case", contact_case.id},
      {"contact", "patch"},
      {"question", contact_case.question},
      {"description",
       prediction::describe(std::get<input::PadPair>(contact_case.geometry), contact_case.layer)},
      {"limits", limits_in_words(options)},
      {"file", contact_case.file.filename().string()},
      {"case_toml", contact_case.text},
      {"tolerance", options.demand.tolerance},
      {"choices", list}};
  return with_provenance(report, command);
}

}  // namespace softfinger::judgement
