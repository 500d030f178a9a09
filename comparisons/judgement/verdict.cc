#include "comparisons/judgement/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "comparisons/judgement/judgement.h"
#include "comparisons/judgement/scoring.h"

namespace softfinger::judgement {
namespace {

using Loads = std::vector<std::size_t>;  // of those at which FEM finished

/// One model over all loads at which FEM finished.
struct Record {
  std::string name;
  bool hot_path = true;
  std::vector<ModelError> errors;
  std::vector<Judgement> judgements;

  Loads among(const Loads& loads, Judgement judgement) const {
    Loads found;
    for (std::size_t load : loads)
      if (judgements[load] == judgement) found.push_back(load);
    return found;
  }
};

/// The worst errors of a model over some loads, signed.
struct Worst {
  double contact = 0, torque = 0;
  prediction::Quantity quantity = prediction::Quantity::area;  ///< of the contact
  double larger() const { return std::max(std::abs(contact), std::abs(torque)); }
};

Worst worst(const Record& record, const Loads& loads) {
  Worst result;
  for (std::size_t load : loads) {
    const ModelError& error = record.errors[load];
    if (std::abs(error.contact) > std::abs(result.contact)) {
      result.contact = error.contact;
      result.quantity = error.contact_quantity;
    }
    if (std::abs(error.max_torque) > std::abs(result.torque)) result.torque = error.max_torque;
  }
  return result;
}

/// With a decimal up to twice the usual tolerance: "off by 10 %" would leave open on which side.
std::string percent(double relative) {
  const double value = 100 * std::abs(relative);
  return fmt::format(value < 20 ? "{:.1f} %" : "{:.0f} %", value);
}

/// The bound of a sentence "within ..", where zero would claim too much.
std::string percent_bound(double relative) { return percent(std::max(std::abs(relative), 1e-3)); }

std::string agreement(const Worst& errors) {
  return fmt::format("contact within {}, torque within {}", percent_bound(errors.contact),
                     percent_bound(errors.torque));
}

std::string departure(const Worst& errors) {
  const auto with_sign = [](double relative) {
    return (relative < 0 ? "-" : "+") + percent(relative);
  };
  return fmt::format("off by {} in {}, {} in torque", with_sign(errors.contact),
                     prediction::kQuantityNames[std::size_t(errors.quantity)],
                     with_sign(errors.torque));
}

std::vector<Record> collect(const std::vector<const LoadErrors*>& finished, double tolerance) {
  std::vector<Record> records;
  for (std::size_t i = 0; i < finished.front()->models.size(); ++i) {
    const ModelError& model = finished.front()->models[i];
    if (!model.applicable) continue;
    Record record{label(model.model), model.hot_path, {}, {}};
    for (const LoadErrors* load : finished) {
      const ModelError& error = load->models[i];
      record.errors.push_back(error);
      record.judgements.push_back(judge(*load, error, tolerance));
    }
    records.push_back(std::move(record));
  }
  return records;
}

/// The model of most use at `open` loads: usable at most of them, then a fast one, then the most
/// accurate there. Null when none is usable at any.
const Record* most_usable(const std::vector<Record>& records, const Loads& open) {
  const auto rank = [&](const Record& record) {
    const Loads usable = record.among(open, Judgement::usable);
    return std::make_tuple(open.size() - usable.size(), !record.hot_path,
                           worst(record, usable).larger());
  };
  const Record* best = nullptr;
  for (const Record& record : records)
    if (!record.among(open, Judgement::usable).empty() && (!best || rank(record) < rank(*best)))
      best = &record;
  return best;
}

/// "nearest is Hertz, off by ..." at loads where no model is usable.
std::string nearest(const std::vector<Record>& records, const Loads& open, bool& by_accident) {
  const auto rank = [&](const Record& record) {
    return std::make_tuple(record.among(open, Judgement::silent).size(),
                           worst(record, open).larger());
  };
  const auto best = std::min_element(
      records.begin(), records.end(),
      [&](const Record& one, const Record& other) { return rank(one) < rank(other); });
  if (best == records.end() || best->among(open, Judgement::silent).size() == open.size())
    return "none has an answer";
  by_accident = best->among(open, Judgement::accident).size() == open.size();
  const Worst errors = worst(*best, open);
  return by_accident
             ? fmt::format(
                   "nearest is {} ({}), outside its range, where its error may just cross zero",
                   best->name, agreement(errors))
             : fmt::format("nearest is {}, {}", best->name, departure(errors));
}

/// "; Winkler is off by ..." about the fast models that fail somewhere, and are not named yet.
std::string others(const std::vector<Record>& records, const Loads& all) {
  std::vector<const Record*> wrong;
  double least = 1e300, most = 0;
  const auto errors = [&](const Record& record) {
    return worst(record, record.among(all, Judgement::off));
  };
  for (const Record& record : records) {
    if (!record.hot_path || record.among(all, Judgement::off).empty()) continue;
    wrong.push_back(&record);
    least = std::min(least, errors(record).larger());
    most = std::max(most, errors(record).larger());
  }
  if (wrong.empty()) return "";
  if (wrong.size() == 1)
    return fmt::format("; {} is {}", wrong[0]->name, departure(errors(*wrong[0])));
  return fmt::format("; {} others are off by {} to {}", wrong.size(), percent(least),
                     percent(most));
}

/// "up to 35 % of contact or torque"
std::string open_in_words(const std::vector<const LoadErrors*>& finished, const Loads& loads) {
  double largest = 0;
  for (const std::size_t load : loads) largest = std::max(largest, finished[load]->geometry_error);
  if (!(largest < 1)) return "all of contact or torque";
  return fmt::format("up to {} of contact or torque", percent(largest));
}

}  // namespace

const char* name_of(VerdictClass verdict_class) {
  switch (verdict_class) {
    case VerdictClass::good:
      return "good";
    case VerdictClass::mixed:
      return "mixed";
    case VerdictClass::bad:
      return "bad";
    case VerdictClass::undetermined:
      return "undetermined";
    case VerdictClass::failed:
      break;
  }
  return "failed";
}

std::string load_list(const std::vector<double>& loads_N) {
  std::vector<double> sorted = loads_N;
  std::sort(sorted.begin(), sorted.end());
  if (sorted.size() > 3) return fmt::format("{:g} to {:g} N", sorted.front(), sorted.back());
  std::string text;
  for (std::size_t i = 0; i < sorted.size(); ++i)
    text += fmt::format("{}{:g}", i == 0 ? "" : i + 1 == sorted.size() ? " and " : ", ", sorted[i]);
  return text + " N";
}

Verdict compose_verdict(const std::vector<LoadErrors>& loads, double tolerance,
                        const std::string& reference) {
  std::vector<const LoadErrors*> finished;
  std::vector<double> failed_N, doubtful_N, undetermined_N;
  std::string failure;
  Loads all;
  for (const LoadErrors& load : loads) {
    if (!load.fem_finished) {
      failed_N.push_back(load.load_N);
      failure = load.fem_failure;
      continue;
    }
    all.push_back(finished.size());
    finished.push_back(&load);
    const bool is_determined = load.fem_geometry_error <= reference::kTrustLimits.geometry;
    if (!load.fem_trusted) (is_determined ? doubtful_N : undetermined_N).push_back(load.load_N);
  }
  if (finished.empty())
    return {fmt::format("No verdict: FEM failed at {} ({}).", load_list(failed_N), failure),
            VerdictClass::failed};
  const auto in_words = [&](const Loads& some) {
    std::vector<double> loads_N;
    for (std::size_t load : some) loads_N.push_back(finished[load]->load_N);
    return load_list(loads_N);
  };

  std::vector<Record> records = collect(finished, tolerance);
  Verdict verdict;
  const Record* const best = most_usable(records, all);
  if (best && best->among(all, Judgement::usable).size() == all.size()) {
    verdict.verdict_class = VerdictClass::good;
    verdict.sentence =
        fmt::format("Use {} ({} of {})", best->name, agreement(worst(*best, all)), reference);
    // A second fast model is a choice; a slow one beside a fast one is none.
    std::vector<Record> rest;
    for (const Record& record : records)
      if (&record != best && record.hot_path) rest.push_back(record);
    const Record* const second = most_usable(rest, all);
    if (best->hot_path && second && second->among(all, Judgement::usable).size() == all.size())
      verdict.sentence += fmt::format(" or {} ({})", second->name, agreement(worst(*second, all)));
    verdict.sentence += " at " + in_words(all) + others(records, all);
  } else {
    Loads open = all;
    while (const Record* const record = most_usable(records, open)) {
      const Loads usable = record->among(open, Judgement::usable);
      verdict.sentence +=
          fmt::format("{}{} at {} ({})", verdict.sentence.empty() ? "Use " : ", ", record->name,
                      in_words(usable), agreement(worst(*record, usable)));
      Loads left;
      std::set_difference(open.begin(), open.end(), usable.begin(), usable.end(),
                          std::back_inserter(left));
      open = left;
    }
    Loads undetermined, known;
    for (const std::size_t load : open)
      (finished[load]->geometry_error > tolerance ? undetermined : known).push_back(load);
    if (!undetermined.empty())
      verdict.sentence += fmt::format(
          "{} mesh does not determine the contact at {}: its radii leave {} open; a finer scan, "
          "another point or a larger load would",
          verdict.sentence.empty() ? "The" : "; the", in_words(undetermined),
          open_in_words(finished, undetermined));
    bool by_accident = false;
    if (!known.empty())
      verdict.sentence += fmt::format("{} model can be relied on at {}: {}",
                                      verdict.sentence.empty() ? "No" : "; no", in_words(known),
                                      nearest(records, known, by_accident)) +
                          "; ask the finite elements there";
    verdict.verdict_class = best || by_accident ? VerdictClass::mixed
                            : known.empty()     ? VerdictClass::undetermined
                                                : VerdictClass::bad;
  }
  if (!doubtful_N.empty())
    verdict.sentence +=
        fmt::format("; the FEM's own error is too large at {}", load_list(doubtful_N));
  if (!undetermined_N.empty())
    verdict.sentence +=
        fmt::format("; the mesh leaves the FEM's own answer open at {}", load_list(undetermined_N));
  if (!failed_N.empty()) verdict.sentence += fmt::format("; FEM failed at {}", load_list(failed_N));
  verdict.sentence += ".";
  return verdict;
}

}  // namespace softfinger::judgement
