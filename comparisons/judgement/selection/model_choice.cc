#include "comparisons/judgement/selection/model_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "comparisons/judgement/assessment.h"
#include "comparisons/judgement/atlas/error_atlas.h"
#include "comparisons/judgement/median.h"
#include "comparisons/prediction/answer_json.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/stack_models.h"

namespace softfinger::judgement {
namespace {

/// All models together answer within the time that a user does not notice.
constexpr double kShortBudget_ns = 2e5;

/// A smaller stated error than that is an accident of the atlas, not a better model.
constexpr double kBetter = 0.9;

void take(const prediction::Assessment& found, Candidate& candidate) {
  if (found.known()) {
    candidate.bound.emplace();
    for (std::size_t q = 0; q < kQuantities; ++q) (*candidate.bound)[q] = found.total(Quantity(q));
  }
  candidate.usable = found.usable;
  candidate.asked = true;
  candidate.remark = found.evidence;
}

Candidate candidate_of(const PressureModel& model, const input::Case& contact_case,
                       const prediction::LocalGeometry& geometry, double load_N,
                       const SelectionOptions& options) {
  Candidate candidate;
  candidate.model = std::string(model.card().name);
  if (!model.card().hot_path) {
    candidate.cost_us = error_atlas().cost_ns(candidate.model) * 1e-3;
    candidate.cost_class = cost_class(false, candidate.cost_us);
    if (options.models.empty()) {
      candidate.remark = "not asked, because of its time; --models " + candidate.model + " asks it";
      return candidate;
    }
    take(assess(contact_case, geometry,
                prediction::ask_model(model, contact_case, geometry, load_N, 0),
                prediction::TorqueRule::exact, options.demand),
         candidate);
    return candidate;
  }
  const prediction::ModelAnswer answer =
      prediction::ask_model(model, contact_case, geometry, load_N, kShortBudget_ns);
  candidate.cost_us = answer.cost_ns * 1e-3;
  take(assess(contact_case, geometry, answer, prediction::TorqueRule::exact, options.demand),
       candidate);
  return candidate;
}

/// The time of a run on level 2 in seconds: the median of the atlas's runs of that kind. A scan is
/// pressed again in perturbed versions, on all of its layer: the median of 22 runs
/// (docs/measurements/finite_elements.md).
double finite_element_cost_s(const input::Case& contact_case,
                             const prediction::LocalGeometry& geometry) {
  constexpr double kScan_s = 15;
  if (geometry.patch && contact_case.fem_curved) return kScan_s;
  const bool finite = contact_case.fem_finite.has_value();
  const AtlasKind kind = contact_case.fem_curved
                             ? (finite ? AtlasKind::finite_curved : AtlasKind::linear_curved)
                             : (finite ? AtlasKind::finite_pad : AtlasKind::linear_pad);
  std::vector<double> seconds;
  for (const AtlasRun& run : finite_strain_atlas().file().runs)
    if (run.kind == kind) seconds.push_back(run.cost_s);
  return median(seconds);
}

Candidate finite_elements(const input::Case& contact_case,
                          const prediction::LocalGeometry& geometry, double load_N,
                          const prediction::Demand& demand) {
  Candidate candidate;
  candidate.model = "fem";
  candidate.cost_us = 1e6 * finite_element_cost_s(contact_case, geometry);
  candidate.cost_class = cost_class(false, candidate.cost_us);
  take(assess_finite_elements(contact_case, geometry, load_N, demand), candidate);
  return candidate;
}

void judge(Candidate& candidate, const SelectionOptions& options) {
  candidate.affordable = options.budget_us <= 0 || candidate.cost_us <= options.budget_us;
  if (!candidate.bound) return;
  candidate.worst = -1;
  for (std::size_t q = 0; q < kQuantities; ++q) {
    if (!options.demand.quantities[q]) continue;
    const double total = (*candidate.bound)[q];
    // An unknown error is within no tolerance.
    if (!(total <= candidate.worst)) {
      candidate.worst = std::isnan(total) ? kInfinity : total;
      candidate.worst_quantity = Quantity(q);
    }
  }
}

std::string worst_text(const Candidate& candidate) {
  return fmt::format("{} within {} ({})", candidate.model, text::percent(candidate.worst),
                     kQuantityNames[std::size_t(candidate.worst_quantity)]);
}

/// Why none of them will do, in words.
std::string refusal(const Choice& choice, const SelectionOptions& options) {
  const Candidate* nearest = nullptr;
  const Candidate* accurate = nullptr;
  for (const Candidate& candidate : choice.candidates) {
    if (candidate.bound && (!nearest || candidate.worst < nearest->worst)) nearest = &candidate;
    if (candidate.usable && !accurate) accurate = &candidate;
  }
  if (accurate)
    return fmt::format(
        "none within {} costs at most {}: the cheapest that is accurate enough, {}, "
        "takes {}",
        text::percent(options.demand.tolerance), duration_text(options.budget_us),
        worst_text(*accurate), duration_text(accurate->cost_us));
  const auto is_untold_fem = [](const Candidate& candidate) {
    return candidate.model == "fem" && !candidate.bound;
  };
  const bool untold_fem =
      std::any_of(choice.candidates.begin(), choice.candidates.end(), is_untold_fem);
  if (nearest)
    return fmt::format("none of the allowed models is known to be within {}: the nearest is {}{}",
                       text::percent(options.demand.tolerance), worst_text(*nearest),
                       untold_fem ? "; fem states its own error when it has run" : "");
  // The slowest one's reason is the contact's, not a model's own.
  return "no error is known of any of the allowed models: " +
         (choice.candidates.empty() ? std::string("there is none")
                                    : choice.candidates.back().remark);
}

}  // namespace

std::string duration_text(double time_us) {
  if (time_us < 0.9995) return fmt::format("{:.3g} ns", time_us * 1e3);
  if (time_us < 999.5) return fmt::format("{:.3g} us", time_us);
  if (time_us < 999.5e3) return fmt::format("{:.3g} ms", time_us * 1e-3);
  return fmt::format("{:.3g} s", time_us * 1e-6);
}

/// 0 for the hot path, then one more for each decade of milliseconds. The costs of slow models are
/// those of stored runs, so that the class is the same from run to run.
int cost_class(bool hot_path, double cost_us) {
  return hot_path || !(cost_us > 1) ? 0 : 1 + std::max(0, int(std::floor(std::log10(cost_us))));
}

bool is_allowed(const SelectionOptions& options, std::string_view model) {
  return options.models.empty() ||
         std::find(options.models.begin(), options.models.end(), model) != options.models.end();
}

Choice choose_model(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                    double load_N, const SelectionOptions& options) {
  std::vector<Candidate> candidates;
  for (const PressureModel* model : all_pressure_models())
    if (is_allowed(options, model->card().name) &&
        (!is_for_stacks(*model) || has_several_layers(contact_case) || !options.models.empty()))
      candidates.push_back(candidate_of(*model, contact_case, geometry, load_N, options));
  if (is_allowed(options, "fem"))
    candidates.push_back(finite_elements(contact_case, geometry, load_N, options.demand));
  return choose_among(std::move(candidates), load_N, options);
}

Choice choose_among(std::vector<Candidate> candidates, double load_N,
                    const SelectionOptions& options) {
  Choice choice;
  choice.load_N = load_N;
  choice.candidates = std::move(candidates);
  for (Candidate& candidate : choice.candidates) judge(candidate, options);
  // Equal ones stay in the order of their names.
  const auto rank = [](const Candidate& candidate) {
    return std::pair(candidate.cost_class, candidate.bound ? candidate.worst : kInfinity);
  };
  std::stable_sort(
      choice.candidates.begin(), choice.candidates.end(),
      [&](const Candidate& left, const Candidate& right) { return rank(left) < rank(right); });

  const int count = int(choice.candidates.size());
  const auto at = [&](int i) -> const Candidate& { return choice.candidates[std::size_t(i)]; };
  for (int i = count - 1; i >= 0; --i)
    if (at(i).meets()) choice.chosen = i;
  if (choice.chosen < 0) {
    choice.reason = refusal(choice, options);
    return choice;
  }
  const Candidate& chosen = at(choice.chosen);
  for (int i = count - 1; i >= 0; --i)
    if (i != choice.chosen && at(i).bound && at(i).worst < kBetter * chosen.worst)
      choice.next_better = i;
  for (int i = count - 1; i >= 0; --i)
    if (at(i).bound && at(i).cost_class < chosen.cost_class) choice.next_cheaper = i;
  choice.reason = fmt::format(
      "{} meets {}: {}, {} per answer",
      chosen.cost_class == 0 ? "the best of the fast models" : "the cheapest that",
      text::percent(options.demand.tolerance), worst_text(chosen), duration_text(chosen.cost_us));
  if (choice.next_cheaper >= 0)
    choice.reason += fmt::format("; cheaper, but only {}, {}", worst_text(at(choice.next_cheaper)),
                                 duration_text(at(choice.next_cheaper).cost_us));
  if (choice.next_better >= 0)
    choice.reason += fmt::format("; better: {}, {}", worst_text(at(choice.next_better)),
                                 duration_text(at(choice.next_better).cost_us));
  return choice;
}

nlohmann::json to_json(const Choice& choice) {
  using nlohmann::json;
  const auto name = [&](int i) {
    return i < 0 ? json() : json(choice.candidates[std::size_t(i)].model);
  };
  json candidates = json::array();
  for (const Candidate& candidate : choice.candidates)
    candidates.push_back(
        {{"model", candidate.model},
         {"cost_us", text::finite_or_null(candidate.cost_us)},
         {"error_bound", prediction::to_json(candidate.bound)},
         {"usable", candidate.asked ? json(candidate.usable) : json()},
         {"worst", candidate.bound ? text::finite_or_null(candidate.worst) : json()},
         {"worst_quantity",
          candidate.bound ? json(kQuantityNames[std::size_t(candidate.worst_quantity)]) : json()},
         {"affordable", candidate.affordable},
         {"remark", candidate.remark.empty() ? json() : json(candidate.remark)}});
  const Candidate* chosen =
      choice.chosen < 0 ? nullptr : &choice.candidates[std::size_t(choice.chosen)];
  return {{"load_N", choice.load_N},
          {"model", name(choice.chosen)},
          {"error_bound", chosen ? prediction::to_json(chosen->bound) : json()},
          {"cost_us", chosen ? json(chosen->cost_us) : json()},
          {"next_better", name(choice.next_better)},
          {"next_cheaper", name(choice.next_cheaper)},
          {"reason", choice.reason},
          {"candidates", candidates}};
}

nlohmann::json results_json(const Choice& choice) {
  nlohmann::json results = nlohmann::json::array();
  for (std::size_t i = 0; i < choice.candidates.size(); ++i) {
    const Candidate& candidate = choice.candidates[i];
    results.push_back(
        {{"load_N", choice.load_N},
         {"model", candidate.model},
         {"usable", candidate.asked ? nlohmann::json(candidate.usable) : nlohmann::json()},
         {"recommended", int(i) == choice.chosen},
         {"error_bound", prediction::to_json(candidate.bound)},
         {"cost_us", text::finite_or_null(candidate.cost_us)}});
  }
  return results;
}

std::string answer_line(const Choice& choice) {
  if (choice.chosen < 0) return fmt::format("{:g} N: NONE: {}\n", choice.load_N, choice.reason);
  const Candidate& chosen = choice.candidates[std::size_t(choice.chosen)];
  return fmt::format("{:g} N: {}, {} per answer\n", choice.load_N, worst_text(chosen),
                     duration_text(chosen.cost_us));
}

std::string table(const Choice& choice, const SelectionOptions& options) {
  std::string text = fmt::format("\n{:g} N\n  {}\n", choice.load_N, choice.reason);
  text += fmt::format("  {:<20}{:>10}", "stated error", "cost");
  for (const char* name : kQuantityNames) text += fmt::format("{:>15}", name);
  text += "\n";
  std::string remarks;
  for (const Candidate& candidate : choice.candidates) {
    text += fmt::format("  {:<20}{:>10}", candidate.model, duration_text(candidate.cost_us));
    if (!candidate.bound) {
      text += fmt::format("{:>15}\n", "not known");
      remarks += fmt::format("  {}: {}\n", candidate.model, candidate.remark);
      continue;
    }
    for (const double bound : *candidate.bound)
      text += fmt::format("{:>15}", std::isnan(bound) ? "-" : text::percent(bound));
    text += candidate.meets()       ? "  meets it\n"
            : candidate.usable      ? "  too slow\n"
            : candidate.affordable  ? "\n"
            : options.budget_us > 0 ? "  too slow\n"
                                    : "\n";
  }
  return text + remarks;
}

}  // namespace softfinger::judgement
