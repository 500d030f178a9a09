#pragma once

#include "comparisons/judgement/model_errors.h"
#include "comparisons/report/html.h"

namespace softfinger::report {

/// One case: question, verdict, places for the charts, every number as a table.
/// @param errors  of the same case
Html case_section(const Json& report, const Json& report_case, const judgement::CaseErrors& errors,
                  bool has_overview);

/// A line above a case's heading: its name, and the way back.
Html kicker(const std::string& id, bool has_overview);

/// Fragment identifier of a case's section.
std::string case_anchor(const Json& report_case);

/// Text that the filter of cases searches.
std::string searched_text(const Json& report_case);

/// "0.4436 mN·m ± 0.095 %": largest torque by the finite elements, with what they and a mesh leave
/// open of it. Empty without a reference.
Html torque_of_elements(const Json& load);

/// These torques in a sentence: of one case at each load, of several from the least to the largest.
Html torques_sentence(const Json& cases);

/// A cell of a table with the torques of one case.
Html torques_cell(const Json& report_case);

/// A coloured label that says its meaning in words too.
Html verdict_badge(const Json& report_case);

/// Name of a model with the line that stands for it in the charts.
Html model_key(const Json& report, const std::string& model);

}  // namespace softfinger::report
