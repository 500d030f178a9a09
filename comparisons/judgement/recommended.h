#pragma once

#include <vector>

#include "comparisons/prediction/ask_model.h"

namespace softfinger::judgement {

/// The answer to give first, of assessed answers to one contact: that of `default_model`. Where the
/// user asked for other models only, the usable one with the smallest error, else the one with the
/// smallest known error, else any; null only where none has an answer.
const prediction::ModelAnswer* recommended(const std::vector<prediction::ModelAnswer>& answers);

/// The answers that are usable, best first, but for `first`, which stands before all.
std::vector<const prediction::ModelAnswer*> usable_ones(
    const std::vector<prediction::ModelAnswer>& answers, const prediction::ModelAnswer* first);

}  // namespace softfinger::judgement
