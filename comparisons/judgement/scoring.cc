#include "comparisons/judgement/scoring.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "comparisons/judgement/median.h"

namespace softfinger::judgement {

using prediction::Quantity;

namespace {

const ModelError* find_model(const LoadErrors& load, const std::string& name) {
  const auto found = std::find_if(load.models.begin(), load.models.end(),
                                  [&](const ModelError& model) { return model.model == name; });
  return found == load.models.end() ? nullptr : &*found;
}

void widen(std::optional<double>& low, std::optional<double>& high, std::optional<double> value) {
  if (!value) return;
  low = low ? std::min(*low, *value) : *value;
  high = high ? std::max(*high, *value) : *value;
}

std::vector<std::string> model_names(const CaseErrors& errors) {
  std::vector<std::string> names;
  for (const LoadErrors& load : errors.loads)
    for (const ModelError& model : load.models)
      if (std::find(names.begin(), names.end(), model.model) == names.end())
        names.push_back(model.model);
  return names;
}

bool is_sound_at_all_loads(const CaseErrors& errors, const std::string& name) {
  return std::all_of(errors.loads.begin(), errors.loads.end(), [&](const LoadErrors& load) {
    const ModelError* model = find_model(load, name);
    return !model || !load.fem_finished || model->sound;
  });
}

}  // namespace

std::optional<Score> score(const LoadErrors& load, const ModelError& model) {
  if (!load.fem_finished || !model.has_answer) return std::nullopt;
  std::optional<Score> worst;
  for (const auto& [quantity, error] : {std::pair(model.contact_quantity, model.contact),
                                        std::pair(Quantity::max_torque, model.max_torque)})
    if (!std::isnan(error) && (!worst || std::abs(error) > worst->error))
      worst = Score{std::abs(error), quantity, load.load_N};
  return worst;
}

Judgement judge(const LoadErrors& load, const ModelError& model, double tolerance) {
  if (!load.fem_finished || !model.has_answer) return Judgement::silent;
  const Judgement judgement = judge(model.larger(), model.sound, tolerance);
  const bool determined = load.geometry_error <= tolerance;
  return judgement == Judgement::usable && !determined ? Judgement::undetermined : judgement;
}

std::optional<Score> worst_score(const CaseErrors& errors, const std::string& model) {
  std::optional<Score> worst;
  for (const LoadErrors& load : errors.loads) {
    if (!load.fem_finished) continue;
    const ModelError* error = find_model(load, model);
    const auto here = error ? score(load, *error) : std::nullopt;
    if (!here) return std::nullopt;
    if (!worst || here->error > worst->error) worst = here;
  }
  return worst;
}

std::optional<Best> best_model(const CaseErrors& errors, double tolerance) {
  const auto rank = [&](const Best& one) {
    const bool usable = judge(one.score.error, one.sound, tolerance) == Judgement::usable;
    return std::tuple(!usable, usable && !one.hot_path, one.score.error);
  };
  std::optional<Best> best;
  for (const std::string& name : model_names(errors)) {
    const auto worst = worst_score(errors, name);
    if (!worst) continue;
    const Best here{name, *worst, is_sound_at_all_loads(errors, name),
                    find_model(errors.loads.front(), name)->hot_path};
    if (!best || rank(here) < rank(*best)) best = here;
  }
  return best;
}

std::vector<Usability> usability(const std::vector<CaseErrors>& cases,
                                 const std::vector<std::string>& models, double tolerance) {
  std::vector<Usability> all;
  for (const std::string& name : models) {
    Usability use;
    use.model = name;
    std::vector<double> errors;
    for (const CaseErrors& one : cases)
      for (const LoadErrors& load : one.loads) {
        const ModelError* model = find_model(load, name);
        const auto here = model ? score(load, *model) : std::nullopt;
        if (!here) continue;
        ++use.compared;
        errors.push_back(here->error);
        const Judgement judgement = judge(load, *model, tolerance);
        if (model->sound) ++use.sound;
        if (model->sound && judgement == Judgement::off) ++use.broken_claims;
        if (judgement == Judgement::accident) ++use.accidents;
        if (judgement != Judgement::usable) continue;
        ++use.usable;
        widen(use.smallest_s, use.largest_s, load.size);
        widen(use.smallest_nu, use.largest_nu, one.poisson_ratio);
      }
    use.worst = errors.empty() ? 0 : *std::max_element(errors.begin(), errors.end());
    use.median = errors.empty() ? 0 : median(errors);
    all.push_back(use);
  }
  return all;
}

ReferenceSummary reference_summary(const std::vector<CaseErrors>& cases, double tolerance) {
  ReferenceSummary sum;
  std::vector<double> torque_errors;
  for (const CaseErrors& one : cases) {
    ++sum.cases;
    for (const LoadErrors& load : one.loads) {
      ++sum.loads;
      if (!load.fem_finished) continue;
      ++sum.solved;
      if (load.fem_trusted) ++sum.trusted;
      sum.worst_geometry_error = std::max(sum.worst_geometry_error, load.fem_geometry_error);
      if (load.stated.max_torque) torque_errors.push_back(*load.stated.max_torque);
      for (const auto& stated : {load.stated.a, load.stated.b})
        sum.worst_axis_error = std::max(sum.worst_axis_error, stated.value_or(0));
      if (std::none_of(load.models.begin(), load.models.end(), [&](const ModelError& model) {
            return judge(load, model, tolerance) == Judgement::usable;
          }))
        ++sum.without_usable_model;
    }
  }
  sum.median_torque_error = torque_errors.empty() ? 0 : median(torque_errors);
  for (const double error : torque_errors)
    sum.worst_torque_error = std::max(sum.worst_torque_error, error);
  return sum;
}

}  // namespace softfinger::judgement
