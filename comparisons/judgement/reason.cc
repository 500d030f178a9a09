#include "comparisons/judgement/reason.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "comparisons/text/percent.h"

namespace softfinger::judgement {
namespace {

using prediction::Assessment;
using prediction::Quantity;

/// The demanded quantity with the largest error.
Quantity worst_quantity(const Assessment& assessment, const prediction::Demand& demand) {
  Quantity worst = Quantity::max_torque;
  double largest = -1;
  for (std::size_t q = 0; q < prediction::kQuantities; ++q) {
    const double total = assessment.total(Quantity(q));
    if (!demand.quantities[q] || !(total > largest)) continue;
    largest = total;
    worst = Quantity(q);
  }
  return worst;
}

/// The first assumption of the model that fails, without its explanation; empty: none does.
std::string failed_assumption(const prediction::ModelAnswer& answer) {
  for (const ValidityCheck& check : answer.prediction.validity)
    if (!check.holds()) {
      std::string message = check.message;
      constexpr std::string_view kNoAnswer = "no answer: ";
      if (message.rfind(kNoAnswer, 0) == 0) message.erase(0, kNoAnswer.size());
      if (!answer.prediction.has_answer) return message;
      message.resize(std::min(message.size(), message.find_first_of(":;,(")));
      return message.substr(0, message.find_last_not_of(' ') + 1);
    }
  return "";
}

std::string main_cause(const prediction::ModelAnswer& answer, Quantity quantity) {
  constexpr std::array<const char*, kErrorCauses> words = {
      "the model itself", "large strain of the layer", "steep surfaces at the contact's edge",
      "curvature of the layer"};
  const auto& causes = answer.assessment->causes;
  std::size_t largest = 0;
  const auto part = [&](std::size_t cause) {
    return std::abs(causes[cause][std::size_t(quantity)]);
  };
  for (std::size_t cause = 1; cause < kErrorCauses; ++cause)
    if (part(cause) > part(largest)) largest = cause;
  const std::string failed = failed_assumption(answer);
  return largest == std::size_t(ErrorCause::model) && !failed.empty() ? failed : words[largest];
}

}  // namespace

std::string geometry_in_words(const Assessment& assessment, const prediction::Demand& demand) {
  const double open =
      assessment.geometry ? worst_of(*assessment.geometry, demand.quantities) : kNaN;
  return std::isfinite(open) ? fmt::format("the mesh leaves {} open", text::percent(open))
                             : "what the mesh leaves open is not known";
}

std::string reason_not_usable(const prediction::ModelAnswer& answer,
                              const prediction::Demand& demand) {
  if (!answer.prediction.has_answer) return failed_assumption(answer);
  if (!answer.assessment) return "its error is not known";
  const Assessment& assessment = *answer.assessment;
  if (!assessment.bound) return assessment.evidence;
  if (!assessment.determined) return geometry_in_words(assessment, demand);
  const Quantity worst = worst_quantity(assessment, demand);
  return fmt::format("up to {} off in {}: {}", text::percent(assessment.total(worst)),
                     prediction::kQuantityNames[std::size_t(worst)], main_cause(answer, worst));
}

}  // namespace softfinger::judgement
