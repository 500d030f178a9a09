#include "comparisons/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <tuple>

namespace softfinger {
namespace {

/// One model over all loads at which FEM finished.
struct Record {
  std::string name;
  bool hot_path = true, applicable = true;
  std::vector<double> usable_N, accidental_N, wrong_N, silent_N;
  double area = 0, torque = 0;  ///< the worst of all answers, signed
  double usable_area = 0,
         usable_torque = 0;                 ///< the worst where it is usable or agrees by accident
  double wrong_area = 0, wrong_torque = 0;  ///< the worst where it is not

  bool is_silent() const { return usable_N.empty() && accidental_N.empty() && wrong_N.empty(); }
  double worst() const { return std::max(std::abs(area), std::abs(torque)); }
};

void keep_worst(double& worst, double value) {
  if (std::abs(value) > std::abs(worst)) worst = value;
}

std::string display_name(std::string model) {
  std::replace(model.begin(), model.end(), '_', ' ');
  if (!model.empty())
    model[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(model[0])));
  return model;
}

std::string percent(double relative) {
  const double value = 100 * std::abs(relative);
  return fmt::format(value < 10 ? "{:.1f} %" : "{:.0f} %", value);
}

/// For "within": a bound of zero would claim too much.
std::string percent_bound(double relative) { return percent(std::max(std::abs(relative), 1e-3)); }

std::string signed_percent(double relative) {
  return (relative < 0 ? "-" : "+") + percent(relative);
}

std::vector<Record> collect(const std::vector<LoadErrors>& loads, double tolerance) {
  std::vector<Record> records;
  for (const LoadErrors& load : loads) {
    if (!load.fem_finished) continue;
    records.resize(load.models.size());
    for (std::size_t i = 0; i < load.models.size(); ++i) {
      const ModelError& error = load.models[i];
      Record& record = records[i];
      record.name = display_name(error.model);
      record.hot_path = error.hot_path;
      record.applicable = error.applicable;
      if (!error.has_answer) {
        record.silent_N.push_back(load.load_N);
        continue;
      }
      keep_worst(record.area, error.area);
      keep_worst(record.torque, error.max_torque);
      const bool agrees =
          std::abs(error.area) <= tolerance && std::abs(error.max_torque) <= tolerance;
      keep_worst(agrees ? record.usable_area : record.wrong_area, error.area);
      keep_worst(agrees ? record.usable_torque : record.wrong_torque, error.max_torque);
      (agrees ? error.valid ? record.usable_N : record.accidental_N : record.wrong_N)
          .push_back(load.load_N);
    }
  }
  records.erase(std::remove_if(records.begin(), records.end(),
                               [](const Record& record) { return !record.applicable; }),
                records.end());
  return records;
}

std::string agreement(const Record& record) {
  return fmt::format("area within {} and torque within {} of FEM",
                     percent_bound(record.usable_area), percent_bound(record.usable_torque));
}

/// "Hertz: area -3 %, torque +12 %; Winkler: no answer"
/// `others`: whether other models were named before.
std::string shortcomings(const std::vector<const Record*>& records, bool others) {
  constexpr std::size_t kReadable = 3;
  std::string text;
  if (records.size() > kReadable) {
    double least = 1e300, most = 0;
    std::size_t silent = 0;
    const char* const which = others ? "the other" : "the";
    for (const Record* record : records) {
      silent += record->is_silent();
      if (record->is_silent()) continue;
      least = std::min(least, record->worst());
      most = std::max(most, record->worst());
    }
    if (silent == records.size()) return fmt::format("{} {} models have no answer", which, silent);
    text = fmt::format("{} {} models are off by {} to {}", which, records.size() - silent,
                       percent(least), percent(most));
    return silent == 0 ? text : text + fmt::format("; {} without an answer", silent);
  }
  for (const Record* record : records) {
    if (!text.empty()) text += "; ";
    if (record->is_silent())
      text += record->name + " has no answer";
    else
      text += fmt::format("{} is off by {} in area and {} in torque", record->name,
                          signed_percent(record->wrong_area), signed_percent(record->wrong_torque));
  }
  return text;
}

}  // namespace

std::string load_list(const std::vector<double>& loads_N) {
  std::vector<double> sorted = loads_N;
  std::sort(sorted.begin(), sorted.end());
  if (sorted.size() > 3) return fmt::format("{:g} to {:g} N", sorted.front(), sorted.back());
  std::string text;
  for (std::size_t i = 0; i < sorted.size(); ++i)
    text += fmt::format("{}{:g}", i == 0 ? "" : i + 1 == sorted.size() ? " and " : ", ", sorted[i]);
  return text + " N";
}

Verdict compose_verdict(const std::vector<LoadErrors>& loads, double tolerance) {
  std::vector<double> finished_N, failed_N, doubtful_N;
  std::string failure;
  for (const LoadErrors& load : loads) {
    (load.fem_finished ? finished_N : failed_N).push_back(load.load_N);
    if (load.fem_finished && !load.fem_trusted) doubtful_N.push_back(load.load_N);
    if (!load.fem_finished) failure = load.fem_failure;
  }
  if (finished_N.empty())
    return {fmt::format("No verdict: FEM failed at {} ({}).", load_list(failed_N), failure),
            "failed"};

  const std::vector<Record> records = collect(loads, tolerance);
  std::vector<const Record*> always, sometimes, accidents, never;
  for (const Record& record : records) {
    if (record.usable_N.size() == finished_N.size())
      always.push_back(&record);
    else if (!record.usable_N.empty())
      sometimes.push_back(&record);
    else if (record.wrong_N.empty() && record.silent_N.empty())
      accidents.push_back(&record);
    else
      never.push_back(&record);
  }
  const auto by_worst = [](const Record* one, const Record* other) {
    return std::make_tuple(one->is_silent(), !one->hot_path, one->worst()) <
           std::make_tuple(other->is_silent(), !other->hot_path, other->worst());
  };
  for (auto* list : {&always, &sometimes, &accidents, &never})
    std::sort(list->begin(), list->end(), by_worst);
  if (!always.empty()) {
    // What else would do, or has nothing to say, or takes longer, only hides the answer.
    if (always[0]->hot_path) {
      const auto slow = std::partition_point(always.begin(), always.end(),
                                             [](const Record* record) { return record->hot_path; });
      always.erase(slow, always.end());
      const auto is_slow = [](const Record* record) { return !record->hot_path; };
      never.erase(std::remove_if(never.begin(), never.end(), is_slow), never.end());
    }
    if (always.size() > 2) always.resize(2);
    never.erase(std::remove_if(never.begin(), never.end(),
                               [](const Record* record) { return record->is_silent(); }),
                never.end());
  }

  Verdict verdict;
  std::vector<std::string> clauses;
  const std::string at_loads = load_list(finished_N);
  if (!always.empty()) {
    verdict.verdict_class = "good";
    std::string text = "Use ";
    for (std::size_t i = 0; i < always.size(); ++i)
      text +=
          fmt::format("{}{} ({})", i == 0 ? "" : " or ", always[i]->name, agreement(*always[i]));
    clauses.push_back(text + " at " + at_loads);
  } else if (!sometimes.empty()) {
    verdict.verdict_class = "mixed";
    for (const Record* record : sometimes) {
      std::string text =
          fmt::format("Use {} at {} only", record->name, load_list(record->usable_N));
      text += fmt::format(" ({})", agreement(*record));
      if (!record->wrong_N.empty())
        text += fmt::format("; at {} it is off by {} in area and {} in torque",
                            load_list(record->wrong_N), signed_percent(record->wrong_area),
                            signed_percent(record->wrong_torque));
      else if (!record->accidental_N.empty())
        text += fmt::format("; at {} it agrees outside its stated validity",
                            load_list(record->accidental_N));
      clauses.push_back(text);
    }
  } else {
    verdict.verdict_class = accidents.empty() ? "bad" : "mixed";
    clauses.push_back(fmt::format("No model can be relied on at {}", at_loads));
  }
  if (always.empty())
    for (const Record* record : accidents)
      clauses.push_back(
          fmt::format("{} agrees ({}) outside its stated validity, which may be an accident",
                      record->name, agreement(*record)));
  if (!never.empty()) clauses.push_back(shortcomings(never, never.size() < records.size()));

  // "No model ...: Hertz is off by ...": the first clause introduces the reasons.
  const std::string first_separator = verdict.verdict_class == "bad" ? ": " : "; ";
  for (std::size_t i = 0; i < clauses.size(); ++i)
    verdict.sentence += (i == 0 ? "" : i == 1 ? first_separator : "; ") + clauses[i];
  if (!doubtful_N.empty())
    verdict.sentence +=
        fmt::format("; the FEM's own error is too large at {}", load_list(doubtful_N));
  if (!failed_N.empty()) verdict.sentence += fmt::format("; FEM failed at {}", load_list(failed_N));
  verdict.sentence += ".";
  return verdict;
}

}  // namespace softfinger
