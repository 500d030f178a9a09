#include "comparisons/sweep/sweep_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <unordered_map>

#include "comparisons/judgement/assessment.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/reference/full_reference.h"
#include "comparisons/reference/theory_limits.h"
#include "comparisons/text/csv.h"
#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/hash.h"
#include "softfinger/input/visible_text.h"

namespace softfinger::sweep {
namespace {

using nlohmann::json;

constexpr const char* kQuantities[] = {
    "a_m", "b_m", "indentation_m", "peak_pressure_Pa", "area_m2", "max_torque_Nm"};
constexpr const char* kErrors[] = {"a", "b", "indentation", "peak_pressure", "area", "max_torque"};
/// Both of the finite elements, and whether their theory holds.
constexpr std::size_t kFemColumns = std::size(kQuantities) + std::size(kErrors) + 1;

void append_number(double value, std::string& text) {
  text += ',';
  // Ten digits: more than any model is worth, and half the file's size.
  if (std::isfinite(value)) fmt::format_to(std::back_inserter(text), "{:.10g}", value);
}

/// A number in as many digits as give exactly the same number back.
void append_exact(double value, std::string& text) {
  fmt::format_to(std::back_inserter(text), ",{}", value);
}

/// A cell without line breaks, because rows are counted by their line breaks.
std::string text_cell(std::string words) {
  std::replace(words.begin(), words.end(), '\n', ' ');
  return text::csv_cell(visible_text(words));
}

/// The columns of `kQuantities`, then those of `kErrors`.
void append_reference(const reference::ReferenceResult& result, std::string& text) {
  for (const double value : {result.a_m, result.b_m, result.indentation_m, result.peak_pressure_Pa,
                             result.area_projected_m2, result.max_torque_Nm})
    append_number(value, text);
  const reference::ReferenceErrors& error = result.error;
  for (const auto& stated :
       {error.a, error.b, error.indentation, error.peak_pressure, error.area, error.max_torque})
    append_number(stated.value_or(NAN), text);
}

/// Weight of a job, see FemRequest. Finite strain, contacts without symmetry and fine levels cost
/// most.
double weight_of(const input::Case& contact_case, const RelativeRadii& radii) {
  const double level = std::pow(4., contact_case.fem_level);
  const bool whole = contact_case.fem_curved || !contact_case.fem_mesh.empty();
  return level * std::sqrt(radii.major_m / radii.minor_m) * (contact_case.fem_finite ? 8 : 1) *
         (whole ? 4 : 1);
}

}  // namespace

std::vector<const PressureModel*> sweep_models(const Sweep& sweep) {
  std::vector<const PressureModel*> models;
  for (const std::string& name : sweep.models())
    for (const PressureModel* model : prediction::models_by_name(name))
      if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
  if (!models.empty()) return models;
  const input::Case& base = sweep.base();
  for (const PressureModel* model : prediction::models_by_name("all")) {
    if (model->card().is_empirical && !(base.options.power_law.radius_coefficient > 0)) continue;
    models.push_back(model);
  }
  return models;
}

SweepRows::SweepRows(const Sweep& sweep, const std::vector<const PressureModel*>& models,
                     const prediction::GeometryResolver& geometry, const prediction::Demand& demand)
    : sweep_(sweep), models_(models), geometry_(geometry), demand_(demand), cases_(sweep) {}

std::string SweepRows::header() const {
  std::string text = "point";
  for (const SweptKey& swept : sweep_.keys()) text += "," + swept.key;
  text += ",load_N,radius_major_m,radius_minor_m";
  for (const PressureModel* model : models_) {
    for (const char* quantity : kQuantities)
      text += fmt::format(",{}_{}", model->card().name, quantity);
    text += fmt::format(",{}_usable", model->card().name);
  }
  if (sweep_.fem()) {
    for (const char* quantity : kQuantities) text += std::string(",fem_") + quantity;
    for (const char* error : kErrors) text += std::string(",fem_error_") + error;
    text += ",fem_usable";
  }
  return text + ",failure\n";
}

void SweepRows::append(std::size_t point, const SweepFemJobs* fem,
                       const std::vector<std::string>& failures, std::string& text) {
  sweep_.values_at(point, values_);
  std::string start = std::to_string(point);
  for (const double value : values_) append_exact(value, start);
  const std::size_t loads = sweep_.base().loads_N.size();
  const std::size_t commas = 2 + 7 * models_.size() + (sweep_.fem() ? kFemColumns : 0);
  const auto append_failure = [&](const InputError& error, const std::vector<double>* loads_N) {
    const std::string words = error.field() + (error.value().empty() ? "" : " = " + error.value()) +
                              (error.allowed().empty() ? "" : ": allowed: " + error.allowed());
    for (std::size_t load = 0; load < loads; ++load) {
      text += start;
      append_exact(loads_N ? (*loads_N)[load] : sweep_.base().loads_N[load], text);
      text.append(commas, ',');
      text += "," + text_cell(words) + "\n";
    }
  };
  input::Case contact_case;
  try {
    contact_case = cases_.at(point);
  } catch (const InputError& error) {
    append_failure(error, nullptr);
    return;
  }
  const std::size_t row_begin = text.size();
  try {
    const prediction::GeometryResolver resolver(contact_case, &geometry_);
    for (std::size_t load = 0; load < loads; ++load) {
      const double load_N = contact_case.loads_N[load];
      const prediction::LocalGeometry geometry = resolver.resolve(load_N);
      text += start;
      append_exact(load_N, text);
      append_number(geometry.radii.major_m, text);
      append_number(geometry.radii.minor_m, text);
      for (const PressureModel* model : models_) {
        const prediction::ModelAnswer answer =
            prediction::ask_model(*model, contact_case, geometry, load_N);
        const Prediction& prediction = answer.prediction;
        if (!prediction.has_answer) {
          text.append(6, ',');
          text += ",no";
          continue;
        }
        const FrictionEllipsoid ellipsoid =
            answer.friction_ellipsoid(prediction::TorqueRule::exact);
        for (const double value :
             {prediction.a_m, prediction.b_m, prediction.indentation_m, prediction.peak_pressure_Pa,
              prediction.area_m2(), ellipsoid.max_torque_Nm()})
          append_number(value, text);
        const bool usable = judgement::assess_numbers(contact_case, geometry, answer,
                                                      prediction::TorqueRule::exact, demand_)
                                .usable;
        text += usable ? ",yes" : ",no";
      }
      std::string failure;
      if (fem) {
        const long job = fem->job_of_row[point * loads + load];
        std::optional<reference::ReferenceResult> result;
        if (job >= 0)
          result = reference::finished_result(fem->jobs[std::size_t(job)], fem->settings).result;
        if (!result) {
          text.append(kFemColumns, ',');
          failure = job < 0 ? "" : failures[std::size_t(job)];
          if (failure.empty()) failure = "no finite-element result";
        } else {
          append_reference(*result, text);
          const input::Case solved = reference::with_full_reference(contact_case, resolver, {});
          text += reference::theory_limits(solved, geometry, *result).holds() ? ",yes" : ",no";
        }
      }
      text += failure.empty() ? ",\n" : "," + text_cell(failure) + "\n";
    }
  } catch (const InputError& error) {
    text.resize(row_begin);
    append_failure(error, &contact_case.loads_N);
  }
}

std::vector<std::optional<SweepRows::FemRequest>> SweepRows::fem_requests(std::size_t point) {
  std::vector<std::optional<FemRequest>> requests(sweep_.base().loads_N.size());
  try {
    const input::Case typed = cases_.at(point);
    const prediction::GeometryResolver resolver(typed, &geometry_);
    const input::Case contact_case = reference::with_full_reference(typed, resolver, {});
    for (std::size_t load = 0; load < requests.size(); ++load) {
      const double load_N = contact_case.loads_N[load];
      const prediction::LocalGeometry geometry = resolver.resolve(load_N);
      requests[load] =
          FemRequest{reference::fem_problem(contact_case, geometry, load_N, contact_case.fem_level),
                     weight_of(contact_case, geometry.radii)};
    }
  } catch (const InputError&) {
    // The rows of this point say why.
  }
  return requests;
}

SweepFemJobs sweep_fem_jobs(const Sweep& sweep, SweepRows& rows,
                            const std::filesystem::path& folder) {
  SweepFemJobs all;
  std::unordered_map<std::string, long> known;
  const auto& loads_N = sweep.base().loads_N;
  for (std::size_t point = 0; point < sweep.points(); ++point) {
    const auto requests = rows.fem_requests(point);
    for (std::size_t load = 0; load < requests.size(); ++load) {
      if (!requests[load]) {
        all.job_of_row.push_back(-1);
        continue;
      }
      const std::string name = hash_text(hash_of(to_json(requests[load]->problem).dump()));
      const auto [entry, is_new] = known.emplace(name, long(all.jobs.size()));
      all.job_of_row.push_back(entry->second);
      if (!is_new) continue;
      reference::FemJob job;
      job.title = fmt::format("{} point {}", sweep.base().id, point);
      if (loads_N.size() > 1) job.title += fmt::format(", {} N", loads_N[load]);
      job.problem = requests[load]->problem;
      job.file = folder / (name + ".json");
      job.weight = requests[load]->weight;
      // Each job has a process of its own. In a shared process it would use the mesh of another
      // contact, and its numbers would differ in the last digits.
      job.group = all.jobs.size();
      all.jobs.push_back(std::move(job));
    }
  }
  return all;
}

}  // namespace softfinger::sweep
