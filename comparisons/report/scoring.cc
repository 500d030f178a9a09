#include "comparisons/report/scoring.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace softfinger::report {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

const Json* find_model(const Json& load, const std::string& name) {
  for (const Json& model : child(load, "models"))
    if (text(model, "model") == name) return &model;
  return nullptr;
}

void widen(std::optional<double>& low, std::optional<double>& high, std::optional<double> value) {
  if (!value) return;
  low = low ? std::min(*low, *value) : *value;
  high = high ? std::max(*high, *value) : *value;
}

}  // namespace

std::optional<Score> score(const Json& load, const Json& model) {
  if (!flag(model, "has_answer")) return std::nullopt;
  static constexpr std::array<std::pair<const char*, const char*>, 2> kJudged{
      {{"area", "area"}, {"max_torque", "torque"}}};
  std::optional<Score> worst;
  for (const auto& [key, name] : kJudged) {
    const auto error = number(child(model, "relative_error"), key);
    if (error && (!worst || std::abs(*error) > worst->error))
      worst = Score{std::abs(*error), name, number(load, "load_N").value_or(0)};
  }
  return worst;
}

Judgement judge(const Json& report, const Json& load, const Json& model) {
  const auto here = score(load, model);
  return here ? judgement::judge(here->error, flag(model, "valid"), tolerance(report))
              : Judgement::silent;
}

std::optional<Score> worst_score(const Json& report_case, const std::string& model) {
  std::optional<Score> worst;
  for (const Json& load : child(report_case, "loads")) {
    if (child(load, "fem").is_null()) continue;
    const Json* entry = find_model(load, model);
    const auto here = entry ? score(load, *entry) : std::nullopt;
    if (!here) return std::nullopt;
    if (!worst || here->error > worst->error) worst = here;
  }
  return worst;
}

std::optional<Best> best_model(const Json& report, const Json& report_case) {
  std::vector<std::string> names;
  for (const Json& load : child(report_case, "loads"))
    for (const Json& model : child(load, "models"))
      if (const std::string name = text(model, "model");
          std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(name);
  std::optional<Best> best;
  for (const std::string& name : names) {
    const auto candidate = worst_score(report_case, name);
    if (!candidate) continue;
    bool valid = true;
    for (const Json& load : child(report_case, "loads"))
      if (const Json* entry = find_model(load, name); entry && !child(load, "fem").is_null())
        valid = valid && flag(*entry, "valid");
    const auto rank = [&](const Best& one) {
      return std::pair(
          judgement::judge(one.score.error, one.valid, tolerance(report)) != Judgement::usable,
          one.score.error);
    };
    const Best here{name, *candidate, valid};
    if (!best || rank(here) < rank(*best)) best = here;
  }
  return best;
}

std::vector<Usability> usability(const Json& report) {
  std::vector<Usability> all;
  for (const std::string& name : model_names(report)) {
    Usability use;
    use.model = name;
    std::vector<double> errors;
    for (const Json& report_case : child(report, "cases"))
      for (const Json& load : child(report_case, "loads")) {
        const Json* entry = find_model(load, name);
        const auto here = entry ? score(load, *entry) : std::nullopt;
        if (!here) continue;
        ++use.compared;
        errors.push_back(here->error);
        const Judgement judgement = judge(report, load, *entry);
        if (flag(*entry, "valid")) ++use.valid;
        if (flag(*entry, "valid") && judgement == Judgement::off) ++use.broken_claims;
        if (judgement == Judgement::accident) ++use.accidents;
        if (judgement != Judgement::usable) continue;
        ++use.usable;
        widen(use.smallest_s, use.largest_s, number(child(load, "geometry"), "s"));
        widen(use.smallest_nu, use.largest_nu,
              number(child(report_case, "layer"), "poisson_ratio"));
      }
    use.worst = errors.empty() ? 0 : *std::max_element(errors.begin(), errors.end());
    use.median = median(errors);
    all.push_back(use);
  }
  return all;
}

ReferenceSummary reference_summary(const Json& report) {
  ReferenceSummary sum;
  std::vector<double> torque_errors;
  for (const Json& report_case : child(report, "cases")) {
    ++sum.cases;
    for (const Json& load : child(report_case, "loads")) {
      ++sum.loads;
      const Json& fem = child(load, "fem");
      if (fem.is_null()) continue;
      ++sum.solved;
      if (flag(fem, "trusted")) ++sum.trusted;
      const Json& error = child(fem, "error");
      if (const auto torque = number(error, "max_torque")) torque_errors.push_back(*torque);
      for (const char* axis : {"a", "b"})
        sum.worst_axis_error = std::max(sum.worst_axis_error, number(error, axis).value_or(0));
      bool any = false;
      for (const Json& model : child(load, "models"))
        any = any || judge(report, load, model) == Judgement::usable;
      if (!any) ++sum.without_usable_model;
    }
  }
  sum.median_torque_error = median(torque_errors);
  for (const double error : torque_errors)
    sum.worst_torque_error = std::max(sum.worst_torque_error, error);
  return sum;
}

double tolerance(const Json& report) { return number(report, "tolerance").value_or(0.10); }

std::vector<std::string> model_names(const Json& report) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  };
  for (const Json& model : child(report, "models")) add(text(model, "name"));
  for (const Json& report_case : child(report, "cases"))
    for (const Json& load : child(report_case, "loads"))
      for (const Json& model : child(load, "models")) add(text(model, "model"));
  for (const Json& model : child(child(report, "atlas"), "models"))
    if (const std::string name = text(model, "model"); name.rfind("fem", 0) != 0) add(name);
  return names;
}

Style style(const Json& report, const std::string& model) {
  if (model == "fem") return {"var(--fem)", "none"};
  if (model == "fem_coarse") return {"var(--muted)", "4 3"};
  // Colour and dash pattern differ together, so that curves can be told apart in grey print too.
  static constexpr std::array<const char*, 8> kDashes{"none", "7 3",       "2 2.5", "9 3 2 3",
                                                      "12 3", "5 2 1.5 2", "4 4",   "1.5 4"};
  const auto names = model_names(report);
  const auto slot =
      static_cast<std::size_t>(std::find(names.begin(), names.end(), model) - names.begin()) %
      kDashes.size();
  return {fmt::format("var(--model-{})", slot + 1), kDashes[slot]};
}

}  // namespace softfinger::report
