#include "comparisons/judgement/selection/selection_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "comparisons/judgement/atlas/atlas_overview.h"
#include "comparisons/judgement/atlas/error_atlas.h"
#include "comparisons/judgement/atlas/error_causes.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/system/clock.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"

namespace softfinger::judgement {
namespace {

using nlohmann::json;

std::vector<std::string> judged_models(const SelectionOptions& options) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (options.models.empty() ||
        std::find(options.models.begin(), options.models.end(), name) != options.models.end())
      names.push_back(name);
  };
  for (const PressureModel* model : all_pressure_models()) add(std::string(model->card().name));
  add("fem");
  return names;
}

/// The largest stated error of the chosen quantities, over loads from a fifth of the smallest to
/// five times the largest one.
json error_curves(const input::Case& contact_case, const prediction::GeometryResolver& resolver,
                  const SelectionOptions& options, const std::vector<LoadChoice>& choices) {
  constexpr int kLoads = 41;
  const auto [least, largest] =
      std::minmax_element(contact_case.loads_N.begin(), contact_case.loads_N.end());
  const double first_N = *least / 5, last_N = *largest * 5;
  json loads = json::array(), models = json::array();
  std::map<std::string, json> worst;
  for (int i = 0; i < kLoads; ++i) {
    const double load_N = first_N * std::pow(last_N / first_N, i / (kLoads - 1.));
    loads.push_back(load_N);
    // A mesh's region is fitted to each load anew, which takes long: the nearest fit will do.
    const LoadChoice& nearest = *std::min_element(
        choices.begin(), choices.end(), [load_N](const LoadChoice& left, const LoadChoice& right) {
          const auto distance = [load_N](const LoadChoice& choice) {
            return std::abs(std::log(choice.choice.load_N / load_N));
          };
          return distance(left) < distance(right);
        });
    const Choice choice = choose_model(
        contact_case, nearest.geometry.patch ? nearest.geometry : resolver.resolve(load_N), load_N,
        options);
    for (const Candidate& candidate : choice.candidates)
      worst[candidate.model].push_back(candidate.bound ? text::finite_or_null(candidate.worst)
                                                       : json());
  }
  for (const std::string& name : judged_models(options))
    if (worst.count(name) > 0) models.push_back({{"model", name}, {"worst", worst[name]}});
  return {{"load_N", loads}, {"models", models}};
}

/// The flat run of the atlas that is most like the contact; null for an empty atlas.
const AtlasRun* nearest_run(const AtlasFile& atlas, const ContactProblem& problem,
                            std::size_t& index) {
  const double s = contact_size(problem);
  const double ratio = problem.radii.major_m / problem.radii.minor_m;
  const auto stiffening = [](double poisson_ratio) { return -std::log(0.501 - poisson_ratio); };
  double best = INFINITY;
  const AtlasRun* found = nullptr;
  for (std::size_t r = 0; r < atlas.runs.size(); ++r) {
    const AtlasRun& run = atlas.runs[r];
    if (run.kind != AtlasKind::flat) continue;
    const double distance =
        std::hypot(std::log(run.s / s), std::log(run.radii_ratio / ratio),
                   stiffening(run.poisson_ratio) - stiffening(problem.layer.poisson_ratio));
    if (!(distance < best)) continue;
    best = distance;
    found = &run;
    index = r;
  }
  return found;
}

/// Relative standard deviation of the torque that the fitted radii leave; null without meshes.
json geometry_fit(const PressureModel& model, const LoadChoice& load) {
  if (!load.geometry.patch || !model.card().hot_path) return nullptr;
  prediction::ModelAnswer answer = prediction::ask_model(model, load.problem, 0);
  if (!answer.prediction.has_answer) return nullptr;
  prediction::propagate_radii_uncertainty(load.geometry.patch->relative, answer);
  if (!answer.deviations) return nullptr;
  return text::finite_or_null(
      answer.deviations->torque_exact_Nm /
      answer.friction_ellipsoid(prediction::TorqueRule::exact).max_torque_Nm());
}

json causes(const input::Case& contact_case, const SelectionOptions& options,
            const LoadChoice& load) {
  const AtlasFile& atlas = error_atlas().file();
  // Outside the atlas the nearest run may be too different from this contact.
  if (contact_case.fem_curved || contact_case.fem_finite || !contact_case.sublayers.empty() ||
      !contact_case.fem_mesh.empty() || !error_atlas().estimate("fem", load.problem).bound)
    return nullptr;
  std::size_t index = 0;
  const AtlasRun* run = nearest_run(atlas, load.problem, index);
  if (!run) return nullptr;
  const TorqueContact truth = contact_of(*run);
  json models = json::array();
  for (const std::string& name : judged_models(options)) {
    const auto errors = atlas.errors.find(name);
    const PressureModel* model = find_pressure_model(name);
    if (errors == atlas.errors.end() || !model) continue;
    const QuantityErrors& of_run = errors->second[index];
    const double torque = of_run[std::size_t(Quantity::max_torque)];
    if (!std::isfinite(torque)) continue;
    const TorqueCauses split = torque_causes(contact_of(*run, of_run), truth);
    models.push_back({{"model", name},
                      {"geometry_fit", geometry_fit(*model, load)},
                      {"ellipse", text::finite_or_null(split.ellipse)},
                      {"pressure", text::finite_or_null(split.pressure)},
                      {"circle_rule", text::finite_or_null(split.circle_rule)},
                      {"max_torque", torque}});
  }
  return {
      {"nearest_run",
       {{"poisson_ratio", run->poisson_ratio}, {"radii_ratio", run->radii_ratio}, {"s", run->s}}},
      {"ellipsoid",
       text::finite_or_null(ellipsoid_error(std::max(truth.a, truth.b) / std::min(truth.a, truth.b),
                                            exponent_of(truth)))},
      {"models", models}};
}

json cards() {
  json cards = json::array();
  for (const PressureModel* model : all_pressure_models())
    cards.push_back({{"name", model->card().name}, {"title", model->card().title}});
  return cards;
}

json provenance(const std::string& command) {
  return {
      {"version", system::program_version()}, {"date", system::utc_now()}, {"command", command}};
}

}  // namespace

std::string limits_in_words(const SelectionOptions& options) {
  std::string words;
  if (options.demand.quantities != kUsualQuantities)
    words = "Usable is what is " + prediction::in_words(options.demand) + ". ";
  if (options.budget_us > 0)
    words += fmt::format("At most {} per answer. ", duration_text(options.budget_us));
  if (!options.models.empty()) {
    words += "Allowed: ";
    for (std::size_t i = 0; i < options.models.size(); ++i)
      words += (i ? ", " : "") + options.models[i];
    words += ".";
  }
  return words;
}

json selection_report(const input::Case& contact_case, const prediction::GeometryResolver& resolver,
                      const SelectionOptions& options, const std::vector<LoadChoice>& choices,
                      const std::string& command) {
  json atlas = atlas_overview(error_atlas().file());
  json list = json::array(), marks = seed_marks();
  // Marked as the case of this page, also if it is a fingertip of Ciocarlie et al. (2007).
  marks.erase(std::remove_if(marks.begin(), marks.end(),
                             [&](const json& mark) { return mark["id"] == contact_case.id; }),
              marks.end());
  for (const LoadChoice& load : choices) {
    list.push_back(to_json(load.choice));
    list.back()["s"] = text::finite_or_null(contact_size(load.problem));
    list.back()["causes"] = causes(contact_case, options, load);
    marks.push_back(map_mark(contact_case, load.problem));
    marks.back()["seed"] = false;
  }
  if (atlas.is_object()) atlas["marks"] = marks;
  return {{"case", contact_case.id},
          {"question", contact_case.question},
          {"description", prediction::describe(contact_case)},
          {"limits", limits_in_words(options)},
          {"file", contact_case.file.filename().string()},
          {"case_toml", contact_case.text},
          {"tolerance", options.demand.tolerance},
          {"choices", list},
          {"models", cards()},
          {"curves", error_curves(contact_case, resolver, options, choices)},
          {"atlas", atlas},
          {"provenance", provenance(command)}};
}

json with_provenance(const json& choice, const std::string& command) {
  json report = choice;
  report["models"] = cards();
  report["provenance"] = provenance(command);
  return report;
}

}  // namespace softfinger::judgement
