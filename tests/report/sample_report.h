#pragma once

#include <nlohmann/json.hpp>

namespace softfinger::tests {

/// A report of plausible numbers in the shape of comparisons/report/README.md: several loads, an
/// elongated contact, a mesh case with fits, a failed reference, a model without an answer, a flat
/// direction, missing profiles. Not computed by the models: the page must not depend on them.
nlohmann::json sample_report();

/// The largest report that the page must carry: `cases` cases with three loads and eight models.
nlohmann::json large_report(int cases);

}  // namespace softfinger::tests
