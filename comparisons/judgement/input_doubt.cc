#include "comparisons/judgement/input_doubt.h"

#include <fmt/format.h>

#include <cmath>

namespace softfinger::judgement {
namespace {

using prediction::ModelAnswer;
using prediction::TorqueRule;

/// The answer's model asked again; its shear law keeps its constants, as the caller changed them.
double torque_Nm(ModelAnswer answer, TorqueRule rule) {
  answer.prediction = answer.model->predict(answer.problem);
  return answer.prediction.has_answer ? answer.friction_ellipsoid(rule).max_torque_Nm() : kNaN;
}

}  // namespace

std::string cost_of_inputs(const ModelAnswer& answer, TorqueRule rule) {
  if (!answer.prediction.has_answer || !answer.model->card().hot_path) return "";
  const double here_Nm = answer.friction_ellipsoid(rule).max_torque_Nm();
  std::string words;
  const auto add = [&](const char* what, const ModelAnswer& changed) {
    const double percent = 100 * (torque_Nm(changed, rule) / here_Nm - 1);
    if (!std::isfinite(percent)) return;
    words += fmt::format(std::abs(percent) < 9.95 ? "{}{}: {:+.1f} %" : "{}{}: {:+.0f} %",
                         words.empty() ? "" : ", ", what, percent);
  };
  ModelAnswer stiffer = answer, thicker = answer, rougher = answer, heavier = answer;
  stiffer.problem.layer.youngs_modulus_Pa *= 2;
  thicker.problem.layer.thickness_m *= 1.1;
  rougher.problem.load.friction_coefficient *= 1.1;
  rougher.shear_law.friction_coefficient *= 1.1;
  rougher.shear_law.shear_strength_Pa *= 1.1;
  add("E x 2", stiffer);
  add("h + 10 %", thicker);
  const bool has_strength = answer.shear_law.has_shear_strength();
  add(!has_strength                                 ? "mu + 10 %"
      : answer.shear_law.has_friction_coefficient() ? "mu and tau_0 + 10 %"
                                                    : "tau_0 + 10 %",
      rougher);
  return words;
}

}  // namespace softfinger::judgement
