#pragma once

#include "comparisons/report/html.h"

namespace softfinger::report {

/// Cost of every idealisation at one load: a waterfall from the closed form to the reference, with
/// all numbers in words, and the uncertainty of the reference's own numbers. Empty where the load
/// has no ladder.
Html ladder_section(const Json& load);

}  // namespace softfinger::report
