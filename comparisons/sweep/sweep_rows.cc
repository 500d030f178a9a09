#include "comparisons/sweep/sweep_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <unordered_map>
#include <variant>

#include "comparisons/text/csv.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/hash.h"
#include "softfinger/input/visible_text.h"

namespace softfinger::sweep {
namespace {

using nlohmann::json;

/// A number in as many digits as give exactly the same number back.
void append_exact(double value, std::string& text) {
  fmt::format_to(std::back_inserter(text), ",{}", value);
}

/// A cell without line breaks, because rows are counted by their line breaks.
std::string text_cell(std::string words) {
  std::replace(words.begin(), words.end(), '\n', ' ');
  return text::csv_cell(visible_text(words));
}

}  // namespace

SweepRows::SweepRows(const Sweep& sweep, const SweptContact& contact)
    : sweep_(sweep), contact_(contact), cases_(sweep) {}

std::string SweepRows::header() const {
  const ContactColumns& columns = contact_.columns();
  std::string text = "point";
  for (const SweptKey& swept : sweep_.keys()) text += "," + swept.key;
  text += ",load_N";
  for (const std::string& name : columns.geometry) text += "," + name;
  for (const ModelCard* model : contact_.models()) {
    for (const std::string& quantity : columns.quantities)
      text += fmt::format(",{}_{}", model->name, quantity);
    text += fmt::format(",{}_usable", model->name);
  }
  if (sweep_.fem()) {
    for (const std::string& quantity : columns.quantities) text += ",fem_" + quantity;
    for (const std::string& error : columns.errors) text += ",fem_error_" + error;
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
  const ContactColumns& columns = contact_.columns();
  const std::size_t fem_columns = columns.quantities.size() + columns.errors.size() + 1;
  const std::size_t commas = columns.geometry.size() +
                             (columns.quantities.size() + 1) * contact_.models().size() +
                             (sweep_.fem() ? fem_columns : 0);
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
    const auto contact = contact_.at(contact_case);
    for (std::size_t load = 0; load < loads; ++load) {
      const double load_N = contact_case.loads_N[load];
      text += start;
      append_exact(load_N, text);
      contact->append_answers(load_N, text);
      std::string failure;
      if (fem) {
        const long job = fem->job_of_row[point * loads + load];
        failure = job < 0 ? contact->without_job()
                          : contact->append_reference(*fem, std::size_t(job), text);
        if (job < 0 && failure.empty()) failure = "no finite-element result";
        if (!failure.empty()) text.append(fem_columns, ',');
        if (job >= 0 && !failure.empty() && !failures[std::size_t(job)].empty())
          failure = failures[std::size_t(job)];
      }
      text += failure.empty() ? ",\n" : "," + text_cell(failure) + "\n";
    }
  } catch (const InputError& error) {
    text.resize(row_begin);
    append_failure(error, &contact_case.loads_N);
  }
}

std::vector<std::optional<FemRequest>> SweepRows::fem_requests(std::size_t point) {
  std::vector<std::optional<FemRequest>> requests(sweep_.base().loads_N.size());
  try {
    const input::Case contact_case = cases_.at(point);
    const auto contact = contact_.at(contact_case);
    if (!contact->without_job().empty()) return requests;
    for (std::size_t load = 0; load < requests.size(); ++load)
      requests[load] = contact->fem_request(contact_case.loads_N[load]);
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
      const auto* bodies = std::get_if<reference::FemProblem>(&requests[load]->problem);
      const json document = bodies ? to_json(*bodies) : std::get<json>(requests[load]->problem);
      const std::string name = hash_text(hash_of(document.dump()));
      const auto [entry, is_new] = known.emplace(name, long(all.count()));
      all.job_of_row.push_back(entry->second);
      if (!is_new) continue;
      std::string title = fmt::format("{} point {}", sweep.base().id, point);
      if (loads_N.size() > 1) title += fmt::format(", {} N", loads_N[load]);
      const std::filesystem::path file = folder / (name + ".json");
      // Each job has a process of its own. In a shared process it would use the mesh of another
      // contact, and its numbers would differ in the last digits.
      const std::size_t group = all.count();
      if (bodies)
        all.jobs.push_back({title, *bodies, file, {}, requests[load]->weight, group});
      else
        all.pads.push_back({title, document, file, group});
    }
  }
  return all;
}

}  // namespace softfinger::sweep
