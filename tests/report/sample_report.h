#pragma once

#include <nlohmann/json.hpp>

namespace softfinger::tests {

/// A report of plausible numbers in the shape of comparisons/report/README.md: several loads, an
/// elongated contact, a mesh case with fits, a failed reference, a model without an answer, a flat
/// direction, missing profiles. Not computed by the models: the page must not depend on them.
nlohmann::json sample_report();

/// The first of its cases alone, and an atlas without the model that is recommended.
nlohmann::json one_case_report();

/// A report of two flat pads: one with two loads, one over a smaller face, of which the reference
/// failed at its second load.
nlohmann::json sample_pads();

/// The largest report that the page must carry: `cases` cases with three loads and eight models.
nlohmann::json large_report(int cases);

/// Input of the page of `softfinger select`: three loads, of which one has no choice.
nlohmann::json sample_selection();

/// Answer of `softfinger calibrate` on the built-in measurements of a silicone fingertip.
nlohmann::json sample_calibration();

}  // namespace softfinger::tests
