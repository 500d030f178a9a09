#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparisons/judgement/input_doubt.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/quantity.h"

/// Text that commands print about predictions: the answer first.
namespace softfinger::commands {

/// "2 N: torque 4.49 mN·m ± 1.4 %, by fingertip_layer; contact 5.1 x 3.7 mm; e_n 1.87 mm; MuJoCo
/// friction="0.8 0.0015 0.0001"", or the same after "NOT USABLE within 10 %". `±` is the bound
/// against the finger itself, with what the geometry leaves open. Without an answer it says why.
/// @param answer  assessed; null where no model has an answer
/// @param inputs  what the case's own doubts move, where it has any
/// @param when    " held 10 s", after the load
std::string answer_line(double load_N, const prediction::ModelAnswer* answer,
                        prediction::TorqueRule rule, const prediction::Demand& demand,
                        const std::optional<judgement::InputDoubt>& inputs,
                        const std::string& when = "");

/// "", or " (by the inputs ± 18 %)".
std::string in_words(const std::optional<judgement::InputDoubt>& inputs);

/// The usable models in a table, best first; of each other one a line that says why not.
std::string models_text(const std::vector<prediction::ModelAnswer>& answers,
                        const prediction::ModelAnswer* recommended, prediction::TorqueRule rule,
                        const prediction::Demand& demand);

}  // namespace softfinger::commands
