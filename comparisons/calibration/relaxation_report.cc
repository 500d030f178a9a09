#include "comparisons/calibration/relaxation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "comparisons/text/json_text.h"

namespace softfinger::calibration {
namespace {

/// Standard deviations to a bound of 95 %.
constexpr double kDeviationsTo95 = 2;

double time_factor(const FittedTerm& term) { return std::exp(kDeviationsTo95 * term.log_time_std); }

/// An interval that spans less than a factor of two, as of the other parameters.
bool is_determined(const FittedTerm& term) {
  return time_factor(term) * time_factor(term) <= 2 &&
         kDeviationsTo95 * term.share_std < term.term.share / 3;
}

}  // namespace

std::vector<std::string> cannot_tell(const RelaxationFit& fit,
                                     const std::vector<HeldForce>& forces) {
  double first_s = std::numeric_limits<double>::infinity(), last_s = 0;
  for (const HeldForce& one : forces) {
    if (one.time_s > 0) first_s = std::min(first_s, one.time_s);
    last_s = std::max(last_s, one.time_s);
  }
  std::vector<std::string> sentences;
  if (fit.terms.empty())
    sentences.push_back(fmt::format(
        "whether the rubber relaxes: the forces do not fall beyond their scatter of {:.2g} %",
        100 * fit.scatter_N / fit.force_at_once_N));
  for (const FittedTerm& term : fit.terms)
    if (!is_determined(term))
      sentences.push_back(fmt::format(
          "the term of {:.3g} s well: its time is {:.2g} to {:.2g} s, its share {:.2g} ± {:.1g}",
          term.term.time_s, term.term.time_s / time_factor(term),
          term.term.time_s * time_factor(term), term.term.share, kDeviationsTo95 * term.share_std));
  sentences.push_back(fmt::format(
      "what is lost within {:.2g} s, the first reading, and while the finger still moved: "
      "youngs_modulus_kPa has to be that of this speed",
      first_s));
  sentences.push_back(fmt::format("what is lost after {:.3g} s, the last reading", last_s));
  sentences.push_back(
      "whether other loads relax by the same shares: that takes a second indentation");
  return sentences;
}

std::string relaxation_toml(const RelaxationFit& fit) {
  std::string terms;
  for (auto term = fit.terms.rbegin(); term != fit.terms.rend(); ++term)
    terms += fmt::format("{}{{ share = {:.4g}, time_s = {:.4g} }}", terms.empty() ? "" : ", ",
                         term->term.share, term->term.time_s);
  return terms.empty() ? "" : "[" + terms + "]";
}

std::string describe(const RelaxationFit& fit, const std::vector<HeldForce>& forces) {
  std::string text =
      fit.terms.empty() ? "no relaxation is seen\n" : "relaxation = " + relaxation_toml(fit) + "\n";
  text += fmt::format(
      "  {} forces, {:.3g} N at once, {:.1f} ± {:.1f} % of it in the end; scatter {:.2g} %\n",
      forces.size(), fit.force_at_once_N, 100 * fit.long_time_modulus,
      100 * kDeviationsTo95 * fit.long_time_modulus_std, 100 * fit.scatter_N / fit.force_at_once_N);
  for (auto term = fit.terms.rbegin(); term != fit.terms.rend(); ++term)
    text +=
        fmt::format("  share {:.4f} ± {:.4f}, time {:.3g} s ({:.3g} to {:.3g} s)\n",
                    term->term.share, kDeviationsTo95 * term->share_std, term->term.time_s,
                    term->term.time_s / time_factor(*term), term->term.time_s * time_factor(*term));
  text += "The data cannot tell\n";
  for (const std::string& sentence : cannot_tell(fit, forces)) text += "- " + sentence + "\n";
  return text;
}

nlohmann::json to_json(const RelaxationFit& fit, const std::vector<HeldForce>& forces) {
  nlohmann::json terms = nlohmann::json::array(), criterion = nlohmann::json::array();
  for (auto term = fit.terms.rbegin(); term != fit.terms.rend(); ++term)
    terms.push_back({{"share", term->term.share},
                     {"share_std", term->share_std},
                     {"time_s", term->term.time_s},
                     {"time_interval95_s",
                      {text::finite_or_null(term->term.time_s / time_factor(*term)),
                       text::finite_or_null(term->term.time_s * time_factor(*term))}},
                     {"determined", is_determined(*term)}});
  for (const double one : fit.criterion) criterion.push_back(text::finite_or_null(one));
  return {{"relaxation", terms},
          {"long_time_modulus", fit.long_time_modulus},
          {"long_time_modulus_std", fit.long_time_modulus_std},
          {"force_at_once_N", fit.force_at_once_N},
          {"scatter_N", fit.scatter_N},
          {"forces", forces.size()},
          {"criterion", criterion},
          {"cannot_tell", cannot_tell(fit, forces)}};
}

}  // namespace softfinger::calibration
