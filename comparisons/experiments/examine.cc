#include "comparisons/experiments/examine.h"

#include <algorithm>

namespace softfinger::experiments {
namespace {

/// Verdict of all findings: fails as soon as one number of the theory does, and agrees where all
/// that can be decided agree.
Verdict combined(const std::vector<Finding>& findings) {
  Verdict verdict = Verdict::cannot_tell;
  for (const Finding& finding : findings) {
    if (finding.role != Role::theory) continue;
    if (finding.verdict == Verdict::fails) return Verdict::fails;
    if (finding.verdict == Verdict::agrees) verdict = Verdict::agrees;
  }
  return verdict;
}

/// Agreement says something only where the same test excludes a rival.
void require_power(std::vector<Finding>& findings) {
  for (Finding& finding : findings) {
    if (finding.role == Role::rival || finding.verdict != Verdict::agrees) continue;
    bool has_rivals = false, excludes = false;
    for (const Finding& other : findings)
      if (other.test == finding.test && other.role != finding.role) {
        has_rivals = true;
        excludes |= other.verdict == Verdict::fails;
      }
    if (!has_rivals || excludes) continue;
    finding.verdict = Verdict::cannot_tell;
    finding.reason += std::string(finding.reason.empty() ? "" : " ") +
                      "Within the uncertainty, but so are the simpler theories.";
  }
}

}  // namespace

const char* words_of(Verdict verdict) {
  constexpr std::array<const char*, 3> kWords = {"agrees", "fails", "cannot tell"};
  return kWords[std::size_t(verdict)];
}

const char* words_of(Role role) {
  constexpr std::array<const char*, 3> kWords = {"theory", "option", "rival"};
  return kWords[std::size_t(role)];
}

Verdict compared(const Finding& finding) {
  if (!finding.measured || !finding.uncertainty) return Verdict::cannot_tell;
  return finding.predicted.low <= *finding.measured + *finding.uncertainty &&
                 finding.predicted.high >= *finding.measured - *finding.uncertainty
             ? Verdict::agrees
             : Verdict::fails;
}

Examined examine(const Experiment& experiment) {
  Examined examined;
  examined.experiment = experiment;
  if (const auto* data = std::get_if<Growth>(&experiment.data)) examine_growth(*data, examined);
  if (const auto* data = std::get_if<Indentation>(&experiment.data))
    examine_indentation(*data, examined);
  if (const auto* data = std::get_if<Hardness>(&experiment.data)) examine_hardness(*data, examined);
  if (const auto* data = std::get_if<Repeated>(&experiment.data)) examine_repeated(*data, examined);
  if (const auto* data = std::get_if<Observation>(&experiment.data))
    examine_observation(*data, examined);
  if (const auto* data = std::get_if<PressCurves>(&experiment.data))
    examine_press_curves(*data, examined);
  if (const auto* data = std::get_if<Tension>(&experiment.data)) examine_tension(*data, examined);
  if (const auto* data = std::get_if<BondedDisc>(&experiment.data))
    examine_bonded_disc(*data, examined);
  require_power(examined.findings);
  examined.verdict = combined(examined.findings);
  return examined;
}

}  // namespace softfinger::experiments
