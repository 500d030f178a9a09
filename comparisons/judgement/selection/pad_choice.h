#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/judgement/selection/model_choice.h"
#include "softfinger/pads/pad_shape.h"

/// Chooses the cheapest answer that is accurate enough for a flat pad, out of the pads' closed
/// forms and finite elements of the whole pad.
namespace softfinger::judgement {

/// @param shape  of the case's contact
Choice choose_pad_model(const input::Case& contact_case, const PadShape& shape, double load_N,
                        const SelectionOptions& options);

/// Data of select.html (report/README.md): what `selection_report` has for curved contacts, without
/// an atlas.
nlohmann::json pad_selection_report(const input::Case& contact_case,
                                    const SelectionOptions& options,
                                    const std::vector<Choice>& choices, const std::string& command);

}  // namespace softfinger::judgement
