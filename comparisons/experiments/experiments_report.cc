#include "comparisons/experiments/experiments_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::experiments {
namespace {

using nlohmann::json;
using text::finite_or_null;

json optional_number(const std::optional<double>& value) {
  return value ? finite_or_null(*value) : json();
}

json interval(const Interval& value) {
  return {finite_or_null(value.low), finite_or_null(value.high)};
}

json to_json(const Finding& finding) {
  return {{"test", finding.test},
          {"model", finding.model},
          {"role", words_of(finding.role)},
          {"unit", finding.unit},
          {"measured", optional_number(finding.measured)},
          {"measured_uncertainty", optional_number(finding.uncertainty)},
          {"predicted", finite_or_null(finding.predicted.value)},
          {"predicted_interval", interval(finding.predicted)},
          {"verdict", words_of(finding.verdict)},
          {"reason", finding.reason}};
}

json to_json(const Inferred& inferred) {
  return {{"name", inferred.name},
          {"unit", inferred.unit},
          {"condition", inferred.condition},
          {"reading", inferred.reading.empty() ? json() : json(inferred.reading)},
          {"value", finite_or_null(inferred.value.value)},
          {"interval", interval(inferred.value)}};
}

json to_json(const Examined& examined) {
  const Experiment& experiment = examined.experiment;
  json findings = json::array(), inferred = json::array();
  for (const Finding& finding : examined.findings) findings.push_back(to_json(finding));
  for (const Inferred& number : examined.inferred) inferred.push_back(to_json(number));
  return {{"id", experiment.id},           {"what", experiment.what},
          {"source", experiment.source},   {"certainty", experiment.certainty},
          {"unknown", experiment.unknown}, {"verdict", words_of(examined.verdict)},
          {"sentence", examined.sentence}, {"findings", findings},
          {"inferred", inferred}};
}

/// "3.85 (3.43 to 4.29) mm"
std::string with_interval(const Interval& interval, const std::string& unit) {
  if (interval.low == interval.high) return shown(interval.value, unit);
  const std::string value = shown(interval.value, unit);
  const std::size_t end = std::min(value.find(' '), value.size());
  const auto number = [&](double of) {
    const std::string text = shown(of, unit);
    return text.substr(0, text.find(' '));
  };
  return fmt::format("{} ({} to {}){}", value.substr(0, end), number(interval.low),
                     number(interval.high), value.substr(end));
}

/// One line for each number, with all interpretations where there are several.
std::string inferred_text(const std::vector<Inferred>& inferred) {
  std::string text;
  std::set<std::pair<std::string, std::string>> written;
  for (const Inferred& number : inferred) {
    if (!written.insert({number.name, number.condition}).second) continue;
    text += fmt::format("  {}, {}:", number.name, number.condition);
    std::string separator = " ";
    for (const Inferred& other : inferred) {
      if (other.name != number.name || other.condition != number.condition) continue;
      text += separator + with_interval(other.value, other.unit);
      if (!other.reading.empty()) text += " if the " + other.reading;
      separator = "; ";
    }
    text += "\n";
  }
  return text;
}

std::string noise_sentence(const std::vector<Examined>& examined) {
  for (const Examined& one : examined)
    for (const Inferred& number : one.inferred)
      if (number.name == "noise_floor")
        return fmt::format("in hand, two fingers of one gripper differ by {:.0f} to {:.0f} % ({})",
                           100 * number.value.low, 100 * number.value.high, one.experiment.id);
  return "";
}

}  // namespace

std::string shown(double value, const std::string& unit) {
  if (!std::isfinite(value)) return "?";
  if (unit == "m") return fmt::format("{:.3g} mm", value * 1e3);
  if (unit == "Pa") return fmt::format("{:.3g} kPa", value * 1e-3);
  if (unit == "%") return fmt::format("{:.0f} %", value * 100);
  return fmt::format("{:.4g}", value);
}

std::vector<Examined> examine_builtin() {
  std::vector<Examined> found;
  for (const auto& file : system::builtin_experiment_files())
    found.push_back(examine(read_experiment(file)));
  return found;
}

json to_json(const std::vector<Examined>& examined) {
  json experiments = json::array();
  for (const Examined& one : examined) experiments.push_back(to_json(one));
  const std::string noise = noise_sentence(examined);
  return {{"experiments", experiments}, {"noise_floor", noise.empty() ? json() : json(noise)}};
}

std::string table(const std::vector<Examined>& examined) {
  const auto count = [&](Verdict verdict) {
    return std::count_if(examined.begin(), examined.end(),
                         [&](const Examined& one) { return one.verdict == verdict; });
  };
  // One data set is its own answer.
  std::string text;
  if (examined.size() > 1)
    text =
        fmt::format("The theory agrees with {} of {} data sets and fails on {}; {} cannot tell.\n",
                    count(Verdict::agrees), examined.size(), count(Verdict::fails),
                    count(Verdict::cannot_tell));
  for (const Examined& one : examined)
    text +=
        fmt::format("{:<12} {:<24} {}\n", words_of(one.verdict), one.experiment.id, one.sentence);
  for (const Examined& one : examined) {
    text += fmt::format("\n{}: {}\n  source: {}\n  {}\n", one.experiment.id, one.experiment.what,
                        one.experiment.source, one.experiment.certainty);
    if (!one.experiment.unknown.empty()) {
      text += "  not known:";
      for (const std::string& unknown : one.experiment.unknown)
        text += (&unknown == &one.experiment.unknown.front() ? " " : "; ") + unknown;
      text += "\n";
    }
    std::string test;
    for (const Finding& finding : one.findings) {
      if (finding.test != test) {
        test = finding.test;
        text += "  " + test;
        if (finding.measured) text += ": measured " + shown(*finding.measured, finding.unit);
        if (finding.uncertainty) text += " ± " + shown(*finding.uncertainty, finding.unit);
        text += "\n";
      }
      text += fmt::format("    {:<12} {:<8} {:<36} {}{}{}\n", words_of(finding.verdict),
                          words_of(finding.role), finding.model,
                          with_interval(finding.predicted, finding.unit),
                          finding.reason.empty() ? "" : "  ", finding.reason);
    }
    text += inferred_text(one.inferred);
  }
  return text;
}

std::string noise_remark() {
  try {
    for (const auto& file : system::builtin_experiment_files()) {
      // To examine the others would cost more than most predictions.
      if (file.stem() != "waltersson_2024_in_hand") continue;
      return "\nTorques have more digits than measurements: " +
             noise_sentence({examine(read_experiment(file))}) + ".\n";
    }
  } catch (const InputError&) {
    // A remark beside a result: without it, the result stands.
  }
  return "";
}

}  // namespace softfinger::experiments
