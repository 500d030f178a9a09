#pragma once

#include "comparisons/report/html.h"

/// Flat pads on the page of `compare`: what report.json has with "contact": "patch".
namespace softfinger::report {

bool is_pad(const Json& report_case);

/// A paragraph that says which model to use for the pads; empty without any.
Html pads_summary(const Json& pads);

/// A row for each pad: nearest model, its error, verdict.
Html pads_overview(const Json& report, const Json& pads);

/// One pad: question, verdict, places for the charts, every number as a table.
Html pad_section(const Json& report, const Json& pad, bool has_overview);

/// Data of the charts of the pads (report.js).
Json pads_chart_data(const Json& pads);

}  // namespace softfinger::report
