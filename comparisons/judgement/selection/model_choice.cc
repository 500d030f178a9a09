#include "comparisons/judgement/selection/model_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/judgement/assessment.h"
#include "comparisons/judgement/atlas/error_atlas.h"
#include "comparisons/judgement/median.h"
#include "comparisons/prediction/answer_json.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

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
  candidate.remark = found.evidence;
}

Candidate candidate_of(const PressureModel& model, const input::Case& contact_case,
                       const prediction::LocalGeometry& geometry, double load_N, double tolerance) {
  Candidate candidate;
  candidate.model = std::string(model.card().name);
  if (!model.card().hot_path) {
    candidate.cost_us = error_atlas().cost_ns(candidate.model) * 1e-3;
    candidate.remark = "not asked, because of its time; predict --model " + candidate.model +
                       " tells how far off it is";
    return candidate;
  }
  const prediction::ModelAnswer answer =
      prediction::ask_model(model, contact_case, geometry, load_N, kShortBudget_ns);
  candidate.cost_us = answer.cost_ns * 1e-3;
  take(assess(contact_case, geometry, answer, prediction::TorqueRule::exact, tolerance), candidate);
  return candidate;
}

/// The time of a run on level 2 in seconds: the median of the atlas's runs of that kind. A scan is
/// pressed again in other readings, on all of its layer: the median of 22 runs (fem/README.md).
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
                          double tolerance) {
  Candidate candidate;
  candidate.model = "fem";
  candidate.cost_us = 1e6 * finite_element_cost_s(contact_case, geometry);
  take(assess_finite_elements(contact_case, geometry, load_N, tolerance), candidate);
  return candidate;
}

void judge(Candidate& candidate, const SelectionOptions& options) {
  candidate.affordable = options.budget_us <= 0 || candidate.cost_us <= options.budget_us;
  if (!candidate.bound) return;
  candidate.worst = -1;
  for (std::size_t q = 0; q < kQuantities; ++q) {
    const auto quantity = Quantity(q);
    if (!options.quantities.empty() &&
        std::find(options.quantities.begin(), options.quantities.end(), quantity) ==
            options.quantities.end())
      continue;
    const double total = (*candidate.bound)[q];
    // What is not known is not within any tolerance.
    if (!(total <= candidate.worst)) {
      candidate.worst = std::isnan(total) ? kInfinity : total;
      candidate.worst_quantity = quantity;
    }
  }
  candidate.accurate = candidate.worst <= options.tolerance;
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
    if (candidate.accurate && !accurate) accurate = &candidate;
  }
  if (accurate)
    return fmt::format(
        "none within {} costs at most {}: the cheapest that is accurate enough, {}, "
        "takes {}",
        text::percent(options.tolerance), duration_text(options.budget_us), worst_text(*accurate),
        duration_text(accurate->cost_us));
  const auto is_untold_fem = [](const Candidate& candidate) {
    return candidate.model == "fem" && !candidate.bound;
  };
  const bool untold_fem =
      std::any_of(choice.candidates.begin(), choice.candidates.end(), is_untold_fem);
  if (nearest)
    return fmt::format("none of the allowed models is known to be within {}: the nearest is {}{}",
                       text::percent(options.tolerance), worst_text(*nearest),
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

std::vector<Quantity> quantities_by_name(const std::string& names) {
  const std::vector<std::string> known(kQuantityNames.begin(), kQuantityNames.end());
  std::vector<Quantity> quantities;
  for (std::size_t start = 0; start <= names.size();) {
    const std::size_t end = std::min(names.find(',', start), names.size());
    const std::string name = names.substr(start, end - start);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw InputError("command line",
                       "unknown quantity \"" + name + "\"" + text::did_you_mean(name, known), "",
                       text::joined(known));
    quantities.push_back(Quantity(found - known.begin()));
    start = end + 1;
  }
  return quantities;
}

Choice choose_model(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                    double load_N, const SelectionOptions& options) {
  Choice choice;
  choice.load_N = load_N;
  const auto allowed = [&](std::string_view name) {
    return options.models.empty() ||
           std::find(options.models.begin(), options.models.end(), name) != options.models.end();
  };
  for (const PressureModel* model : all_pressure_models())
    if (allowed(model->card().name))
      choice.candidates.push_back(
          candidate_of(*model, contact_case, geometry, load_N, options.tolerance));
  if (allowed("fem"))
    choice.candidates.push_back(finite_elements(contact_case, geometry, load_N, options.tolerance));
  for (Candidate& candidate : choice.candidates) judge(candidate, options);
  std::stable_sort(
      choice.candidates.begin(), choice.candidates.end(),
      [](const Candidate& left, const Candidate& right) { return left.cost_us < right.cost_us; });

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
  for (int i = 0; i < choice.chosen; ++i)
    if (at(i).bound) choice.next_cheaper = i;
  choice.reason =
      fmt::format("the cheapest that meets {}: {}, {} per answer", text::percent(options.tolerance),
                  worst_text(chosen), duration_text(chosen.cost_us));
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
         {"error_estimate", prediction::to_json(candidate.bound)},
         {"usable", candidate.usable},
         {"worst", candidate.bound ? text::finite_or_null(candidate.worst) : json()},
         {"worst_quantity",
          candidate.bound ? json(kQuantityNames[std::size_t(candidate.worst_quantity)]) : json()},
         {"accurate", candidate.accurate},
         {"affordable", candidate.affordable},
         {"remark", candidate.remark.empty() ? json() : json(candidate.remark)}});
  const Candidate* chosen =
      choice.chosen < 0 ? nullptr : &choice.candidates[std::size_t(choice.chosen)];
  return {{"load_N", choice.load_N},
          {"model", name(choice.chosen)},
          {"error_estimate", chosen ? prediction::to_json(chosen->bound) : json()},
          {"cost_us", chosen ? json(chosen->cost_us) : json()},
          {"next_better", name(choice.next_better)},
          {"next_cheaper", name(choice.next_cheaper)},
          {"reason", choice.reason},
          {"candidates", candidates}};
}

std::string table(const Choice& choice, const SelectionOptions& options) {
  std::string text = fmt::format(
      "\n{:g} N: {}\n  {}\n", choice.load_N,
      choice.chosen < 0 ? std::string("none") : choice.candidates[std::size_t(choice.chosen)].model,
      choice.reason);
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
    for (const double bound : *candidate.bound) text += fmt::format("{:>15}", text::percent(bound));
    text += candidate.meets()       ? "  meets it\n"
            : candidate.accurate    ? "  too slow\n"
            : candidate.affordable  ? "\n"
            : options.budget_us > 0 ? "  too slow\n"
                                    : "\n";
  }
  return text + remarks;
}

}  // namespace softfinger::judgement
