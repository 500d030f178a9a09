#include "comparisons/judgement/input_doubt.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "comparisons/prediction/answer_json.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

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
  for (ElasticLayer& one : stiffer.problem.stack.sublayers) one.youngs_modulus_Pa *= 2;
  for (ElasticLayer& one : thicker.problem.stack.sublayers) one.thickness_m *= 1.1;
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

DoubtedCases::DoubtedCases(const input::Case& contact_case,
                           const prediction::GeometryResolver& known)
    : loads_N_(contact_case.loads_N), doubts_(contact_case.doubts.size()) {
  for (std::size_t doubt = 0; doubt < doubts_; ++doubt) {
    const input::Doubt& of = contact_case.doubts[doubt];
    std::optional<InputError> refusal;
    bool any = false;
    for (const double value : {of.lower, of.upper}) {
      try {
        auto moved = std::make_unique<const input::Case>(with_value(contact_case, of, value));
        auto geometry = std::make_unique<const prediction::GeometryResolver>(*moved, &known);
        varied_.push_back({doubt, std::move(moved), std::move(geometry)});
        any = true;
      } catch (const InputError& error) {
        refusal = error;
      }
    }
    if (!any) throw *refusal;
  }
}

double DoubtedCases::load_N(const Varied& varied, double asked_N) const {
  const auto found = std::find(loads_N_.begin(), loads_N_.end(), asked_N);
  return found == loads_N_.end()
             ? asked_N
             : varied.contact_case->loads_N[std::size_t(found - loads_N_.begin())];
}

std::optional<InputDoubt> DoubtedCases::move(const ModelAnswer& answer, TorqueRule rule) const {
  if (doubts_ == 0 || !answer.prediction.has_answer || !answer.model->card().hot_path)
    return std::nullopt;
  constexpr std::size_t kNumbers = prediction::kQuantities + 1;
  const auto numbers_of = [&](const ModelAnswer& of) -> std::array<double, kNumbers> {
    const Prediction& p = of.prediction;
    const FrictionEllipsoid limit = of.friction_ellipsoid(rule);
    return {p.a_m,
            p.b_m,
            p.indentation_m,
            p.area_m2(),
            p.peak_pressure_Pa,
            limit.max_torque_Nm(),
            limit.eccentricity_m};
  };
  const auto here = numbers_of(answer);
  std::vector<std::array<double, kNumbers>> largest(doubts_);
  constexpr std::size_t kTorque = std::size_t(prediction::Quantity::max_torque);
  std::vector<double> down(doubts_), up(doubts_);  // logarithms of the torque's factors
  for (const Varied& varied : varied_) {
    const double there_N = load_N(varied, answer.problem.load.normal_force_N);
    const ModelAnswer moved = prediction::ask_model(*answer.model, *varied.contact_case,
                                                    varied.geometry->resolve(there_N), there_N);
    const auto there = numbers_of(moved);
    for (std::size_t n = 0; n < kNumbers; ++n) {
      const double change = moved.prediction.has_answer ? std::abs(there[n] / here[n] - 1) : kNaN;
      double& known = largest[varied.doubt][n];
      if (std::isnan(change) || change > known) known = change;
    }
    const double factor =
        moved.prediction.has_answer ? std::log(there[kTorque] / here[kTorque]) : kNaN;
    for (auto [side, sign] : {std::pair(&down, -1.), std::pair(&up, 1.)}) {
      double& most = (*side)[varied.doubt];
      if (std::isnan(factor) || sign * factor > most) most = sign * factor;
    }
  }
  std::array<double, kNumbers> sum{};
  for (const auto& changes : largest)
    for (std::size_t n = 0; n < kNumbers; ++n) sum[n] = std::hypot(sum[n], changes[n]);
  InputDoubt doubt;
  std::copy_n(sum.begin(), doubt.relative.size(), doubt.relative.begin());
  doubt.eccentricity = sum.back();
  const auto together = [](const std::vector<double>& logs) {
    double all = 0;
    for (const double one : logs) all = std::hypot(all, one);
    return all;
  };
  doubt.torque_down = std::expm1(-together(down));
  doubt.torque_up = std::expm1(together(up));
  return doubt;
}

nlohmann::json to_json(const std::optional<InputDoubt>& doubt) {
  if (!doubt) return nullptr;
  nlohmann::json json = prediction::to_json(std::optional(doubt->relative));
  json["eccentricity"] = text::finite_or_null(doubt->eccentricity);
  json["max_torque_interval"] = {text::finite_or_null(doubt->torque_down),
                                 text::finite_or_null(doubt->torque_up)};
  return json;
}

}  // namespace softfinger::judgement
