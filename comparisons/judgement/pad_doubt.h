#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "comparisons/input/case.h"
#include "comparisons/judgement/input_doubt.h"
#include "comparisons/prediction/pad_answer.h"

/// Effect of a flat pad's uncertain numbers, as input_doubt.h has it for curved contacts.
namespace softfinger::judgement {

/// Changes by the case's own doubts, each at both bounds; see `DoubtedCases`.
/// @param load  index of the answer's load
std::optional<InputDoubt> pad_doubt(const input::Case& contact_case,
                                    const prediction::PadAnswer& answer, std::size_t load);

/// "h + 10 %: +0.8 %, nu - 0.01: .., mu + 10 %: +10 %": changes of the largest torque.
std::string pad_cost_of_inputs(const prediction::PadAnswer& answer);

}  // namespace softfinger::judgement
