#include "compared_cases.h"

#include <algorithm>
#include <cmath>

#include "comparisons/report/pad_section.h"
#include "comparisons/report/report_page.h"

namespace softfinger::tests {

using namespace report;

judgement::ModelError compared_model(const Json& model) {
  judgement::ModelError error;
  const Json& relative = child(model, "relative_error");
  error.model = text(model, "model");
  error.has_answer = flag(model, "has_answer");
  error.sound = flag(model, "sound");
  error.hot_path = flag(model, "hot_path");
  error.set_contact(number(relative, "a").value_or(NAN), number(relative, "b").value_or(NAN),
                    number(relative, "area").value_or(NAN));
  error.max_torque = number(relative, "max_torque").value_or(NAN);
  return error;
}

judgement::LoadErrors compared_load(const Json& load) {
  judgement::LoadErrors errors;
  const Json& fem = child(load, "fem");
  const Json& stated = child(fem, "error");
  errors.load_N = number(load, "load_N").value_or(0);
  errors.fem_finished = !fem.is_null();
  errors.fem_trusted = flag(fem, "trusted");
  if (fem.contains("geometry_error"))
    for (const char* key : {"a", "b", "area", "max_torque"})
      errors.fem_geometry_error = std::max(
          errors.fem_geometry_error, number(child(fem, "geometry_error"), key).value_or(INFINITY));
  errors.fem_failure = text(load, "fem_failure");
  const Json& geometry = child(load, "geometry");
  errors.size = number(geometry, "s");
  if (const Json& open = child(geometry, "error"); open.is_object())
    for (const char* quantity : {"a", "b", "area", "max_torque"})
      errors.geometry_error =
          std::max(errors.geometry_error, number(open, quantity).value_or(INFINITY));
  errors.stated.a = number(stated, "a");
  errors.stated.b = number(stated, "b");
  errors.stated.indentation = number(stated, "indentation");
  errors.stated.area = number(stated, "area");
  errors.stated.peak_pressure = number(stated, "peak_pressure");
  errors.stated.max_torque = number(stated, "max_torque");
  for (const Json& model : child(load, "models")) errors.models.push_back(compared_model(model));
  return errors;
}

judgement::CaseErrors compared_case(const Json& report_case) {
  judgement::CaseErrors errors;
  errors.id = text(report_case, "id");
  errors.poisson_ratio = number(child(report_case, "layer"), "poisson_ratio");
  for (const Json& load : child(report_case, "loads")) errors.loads.push_back(compared_load(load));
  return errors;
}

std::vector<judgement::CaseErrors> compared_cases(const Json& report) {
  std::vector<judgement::CaseErrors> cases;
  for (const Json& report_case : child(report, "cases"))
    if (!is_pad(report_case)) cases.push_back(compared_case(report_case));
  return cases;
}

std::string page_of(const Json& report) { return render_report(report, compared_cases(report)); }

}  // namespace softfinger::tests
