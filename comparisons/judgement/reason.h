#pragma once

#include <string>

#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/quantity.h"

namespace softfinger::judgement {

/// Why an assessed answer is not usable, in words: what its largest error may be and what causes
/// it, or why nothing is known of it.
/// "the mesh leaves 1.9 % open" of the demanded quantities.
std::string geometry_in_words(const prediction::Assessment& assessment,
                              const prediction::Demand& demand);

std::string reason_not_usable(const prediction::ModelAnswer& answer,
                              const prediction::Demand& demand);

}  // namespace softfinger::judgement
