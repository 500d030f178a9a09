#pragma once

#include <string>

#include "comparisons/prediction/ask_model.h"

/// What the numbers of a case cost: how far the answer moves when they do.
namespace softfinger::judgement {

/// "E x 2: -16 %, h + 10 %: +2.6 %, mu + 10 %: +10 %": changes of the largest torque, each by the
/// answer's own model at the changed number. Twice the modulus is a usual difference between a data
/// sheet and a fingertip. Empty without an answer, and for models slower than the hot path.
std::string cost_of_inputs(const prediction::ModelAnswer& answer, prediction::TorqueRule rule);

}  // namespace softfinger::judgement
