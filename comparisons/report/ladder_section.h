#pragma once

#include "comparisons/report/html.h"

namespace softfinger::report {

/// What every idealisation costs at one load: a waterfall from the closed form to the reference,
/// with all numbers in words, and how far the reference's own numbers are uncertain. Empty where
/// the load has no ladder.
Html ladder_section(const Json& load);

}  // namespace softfinger::report
