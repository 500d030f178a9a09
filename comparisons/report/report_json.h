#pragma once

#include "comparisons/report/html.h"

/// Values of a report.json or select.json that several pages read.
namespace softfinger::report {

/// Whether the model was given anything to answer with: a law that was not measured has nothing to
/// say, and is not shown.
bool is_asked(const Json& model);

/// The error up to which a model is usable; a tenth where the file does not say.
double tolerance(const Json& report);

}  // namespace softfinger::report
