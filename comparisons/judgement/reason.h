#pragma once

#include <string>

#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/quantity.h"

namespace softfinger::judgement {

/// Why an assessed answer is not usable, in words: what its largest error may be and what causes
/// it, or why nothing is known of it.
std::string reason_not_usable(const prediction::ModelAnswer& answer,
                              const prediction::Demand& demand);

}  // namespace softfinger::judgement
