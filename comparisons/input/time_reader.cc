#include "comparisons/input/time_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

constexpr std::size_t kMostRelaxationTerms = 50, kMostHistoryPoints = 1000;
/// Thirty thousand years, and a time that no load can follow.
constexpr double kLongest_s = 1e12, kShortest_s = 1e-9;
constexpr const char* kRelaxationForms =
    "[{ share = 0.12, time_s = 0.5 }, ..], or { exponent = 0.03, time_s = 0.01, until_s = 1e4 } "
    "for the power law (1 + t/time_s)^-exponent";
constexpr const char* kHistoryForms =
    "[{ time_s = 0, load_N = 0 }, { time_s = 0.2, load_N = 5 }, ..], or approach_mm in place of "
    "load_N";

const toml::table& table_entry(const TomlReader& reader, const toml::node& node,
                               const std::string& field, const char* allowed) {
  if (!node.is_table()) reader.refuse(node, field, allowed);
  return *node.as_table();
}

double share_of(const TomlReader& reader, const toml::table& entry) {
  const toml::node& node = reader.required(entry, "relaxation", "share");
  const std::string allowed = "a number between 0 and 1, the part of the modulus that is lost";
  const double share = reader.number(node, "relaxation.share", allowed);
  if (!(share > 0 && share < 1)) reader.refuse(node, "relaxation.share", allowed);
  return share;
}

/// The library's refusals, at the line of the file.
template <class Make>
void at_line_of(const TomlReader& reader, const toml::node& node, const Make& make) {
  try {
    make();
  } catch (const InputError& error) {
    throw InputError(reader.where(node), error.where() + ": " + error.field(), error.value(),
                     error.allowed());
  }
}

}  // namespace

Relaxation read_relaxation(const TomlReader& reader, const toml::table& layer) {
  const toml::node* node = layer.get("relaxation");
  if (!node) return {};
  std::vector<RelaxationTerm> terms;
  if (const toml::table* law = node->as_table()) {
    reader.check_keys(*law, "relaxation", {"exponent", "time_s", "until_s"});
    const auto number = [&](const char* key) {
      return reader.positive(reader.required(*law, "relaxation", key),
                             std::string("relaxation.") + key, 1);
    };
    const double exponent = number("exponent"), time_s = number("time_s");
    at_line_of(reader, *node,
               [&] { terms = power_law_relaxation(exponent, time_s, number("until_s")); });
  } else {
    const toml::array& list =
        reader.list(*node, "relaxation", kMostRelaxationTerms, kRelaxationForms);
    if (list.empty()) reader.refuse(*node, "relaxation", kRelaxationForms);
    for (const toml::node& one : list) {
      const toml::table& entry = table_entry(reader, one, "relaxation", kRelaxationForms);
      reader.check_keys(entry, "relaxation", {"share", "time_s"});
      const toml::node& typed = reader.required(entry, "relaxation", "time_s");
      const char* const allowed = "1e-9 to 1e12 s";
      const double time_s = reader.number(typed, "relaxation.time_s", allowed);
      if (!(time_s >= kShortest_s && time_s <= kLongest_s))
        reader.refuse(typed, "relaxation.time_s", allowed);
      terms.push_back({share_of(reader, entry), time_s});
    }
  }
  Relaxation result;
  at_line_of(reader, *node, [&] { result = Relaxation(terms); });
  return result;
}

void read_history(const TomlReader& reader, const toml::node& node, Case& result) {
  ContactTimes& times = result.times;
  const toml::array& list = reader.list(node, "history", kMostHistoryPoints, kHistoryForms);
  if (list.empty()) reader.refuse(node, "history", kHistoryForms);
  for (const toml::node& one : list) {
    const toml::table& entry = table_entry(reader, one, "history", kHistoryForms);
    reader.check_keys(entry, "history", {"time_s", "load_N", "approach_mm"});
    const bool by_approach = entry.contains("approach_mm");
    if (by_approach == entry.contains("load_N"))
      reader.say(one, "history: each entry has time_s and one of load_N, approach_mm");
    const auto drive = by_approach ? ContactHistory::Drive::approach : ContactHistory::Drive::load;
    if (!times.history.empty() && drive != times.drive)
      reader.say(one, "history: load_N in all entries, or approach_mm in all");
    times.drive = drive;
    const char* const key = by_approach ? "approach_mm" : "load_N";
    const std::string field = std::string("history.") + key;
    const toml::node& typed = *entry.get(key);
    const double value = reader.number(typed, field, "a finite number >= 0");
    if (!(value >= 0)) reader.refuse(typed, field, "a finite number >= 0");
    const toml::node& when = reader.required(entry, "history", "time_s");
    const double time_s = reader.number(when, "history.time_s", "a finite number of seconds");
    if (!(std::abs(time_s) <= kLongest_s)) reader.refuse(when, "history.time_s", "-1e12 to 1e12 s");
    times.history.push_back({time_s, by_approach ? value * kMillimetre : value});
  }
  at_line_of(reader, node, [&] { times.of(0); });
  if (!times.are_given()) times.where = reader.where(node);
  if (times.drive == ContactHistory::Drive::approach) return;
  double load_N = times.history.back().value;
  if (load_N == 0)
    for (const HistoryPoint& point : times.history) load_N = std::max(load_N, point.value);
  result.loads_N = {load_N};
}

void check_times(const TomlReader& reader, const toml::table& root, const Case& result) {
  if (!result.times.are_given()) return;
  if (const toml::node* other = root.get("object_layer"))
    reader.say(*other,
               "relaxation and history take one [layer] on a rigid core: two layers that relax "
               "differently have no common modulus");
  if (root["layer"].is_array())
    reader.say(*root.get("layer"),
               "relaxation and history take one [layer]: sublayers that relax differently have no "
               "common modulus");
}

void refuse_times(const Case& contact_case, const std::string& command) {
  if (!contact_case.times.are_given()) return;
  throw InputError(
      contact_case.times.where,
      command +
          " does not know time yet, and the case has relaxation or history: softfinger "
          "predict and export do; without these keys the rubber is elastic",
      "", "");
}

}  // namespace softfinger::input
