#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/reference/reference_result.h"

/// Cost of every idealisation, from a closed form to the finger itself, at one load.
namespace softfinger::judgement {

struct Comparison;

constexpr std::array<const char*, 5> kLadderQuantities = {"a", "b", "area", "indentation",
                                                          "max_torque"};
using LadderNumbers = std::array<double, 5>;  ///< relative; NaN: not known

/// A step of the ladder: an answer with fewer idealisations than the one before.
struct LadderStep {
  std::string step;         ///< as report.json calls it
  std::string words;        ///< "Hertz", "flat layer, linear"
  LadderNumbers departure;  ///< from the reference, signed
};

struct Ladder {
  std::vector<LadderStep> steps;  ///< the last is the reference, whose departures are 0
  /// Uncertainties of the reference's own numbers, without sign: fit of the radii, facets,
  /// elements; those that are known.
  std::vector<LadderStep> doubts;
  std::string sentence;  ///< names the largest step
};

/// References of the same contact with fewer effects than the case's own. Each is absent where the
/// case's own reference is that one, and where it failed.
struct IdealisedReferences {
  std::optional<reference::ReferenceResult> flat_linear, flat_finite;
};

/// @returns nothing without a reference
std::optional<Ladder> make_ladder(const Comparison& comparison,
                                  const IdealisedReferences& idealised);

}  // namespace softfinger::judgement
