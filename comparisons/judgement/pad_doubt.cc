#include "comparisons/judgement/pad_doubt.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/input/errors.h"

namespace softfinger::judgement {
namespace {

using prediction::PadAnswer;

PadAnswer asked_again(const PadAnswer& answer, const input::Case& contact_case,
                      const PadShape& shape, double load_N) {
  return prediction::ask_pad_model(*answer.model, contact_case, shape, load_N, {}, 0);
}

}  // namespace

std::optional<InputDoubt> pad_doubt(const input::Case& contact_case, const PadAnswer& answer,
                                    std::size_t load) {
  if (contact_case.doubts.empty() || !answer.prediction.has_answer) return std::nullopt;
  const auto numbers_of = [](const PadAnswer& of) -> std::array<double, 5> {
    return {of.prediction.indentation_m, of.area_m2(), of.prediction.peak_pressure_Pa,
            of.friction_ellipsoid().max_torque_Nm(), of.prediction.eccentricity_m};
  };
  constexpr std::size_t kTorque = 3;
  const auto here = numbers_of(answer);
  std::array<double, 5> sum{};
  double down = 0, up = 0;
  for (const input::Doubt& doubt : contact_case.doubts) {
    std::array<double, 5> largest{};
    double lower = 0, upper = 0;
    bool any = false;
    std::optional<InputError> refusal;
    for (const double value : {doubt.lower, doubt.upper}) {
      try {
        const input::Case moved = with_value(contact_case, doubt, value);
        const PadShape shape(prediction::bearing_outline(moved));
        const auto there = numbers_of(asked_again(answer, moved, shape, moved.loads_N[load]));
        for (std::size_t n = 0; n < there.size(); ++n)
          largest[n] = std::max(largest[n], std::abs(there[n] / here[n] - 1));
        const double factor = std::log(there[kTorque] / here[kTorque]);
        lower = std::max(lower, -factor);
        upper = std::max(upper, factor);
        any = true;
      } catch (const InputError& error) {
        refusal = error;
      }
    }
    if (!any) throw *refusal;
    for (std::size_t n = 0; n < sum.size(); ++n) sum[n] = std::hypot(sum[n], largest[n]);
    down = std::hypot(down, lower);
    up = std::hypot(up, upper);
  }
  InputDoubt doubt;
  doubt.relative = {0, 0, sum[0], sum[1], sum[2], sum[3]};
  doubt.eccentricity = sum[4];
  doubt.torque_down = std::expm1(-down);
  doubt.torque_up = std::expm1(up);
  return doubt;
}

std::string pad_cost_of_inputs(const PadAnswer& answer) {
  std::string words;
  const auto add = [&](const char* what, const PadProblem& changed) {
    const PadPrediction there = answer.model->predict(changed);
    if (!there.has_answer) return;
    const double percent =
        100 * (there.eccentricity_m * changed.load.friction_coefficient /
                   (answer.prediction.eccentricity_m * answer.problem.load.friction_coefficient) -
               1);
    words += fmt::format("{}{}: {:+.1f} %", words.empty() ? "" : ", ", what,
                         std::abs(percent) < 0.05 ? 0 : percent);
  };
  PadProblem thicker = answer.problem, softer = answer.problem, rougher = answer.problem;
  softer.layer.poisson_ratio = std::max(0.0, softer.layer.poisson_ratio - 0.01);
  thicker.layer.thickness_m *= 1.1;
  rougher.load.friction_coefficient *= 1.1;
  add("h + 10 %", thicker);
  add("nu - 0.01", softer);
  add("mu + 10 %", rougher);
  if (!answer.problem.cylinder) return words + "; E counts for nothing";
  // A stiffer layer narrows the line.
  PadProblem stiffer = answer.problem;
  stiffer.layer.youngs_modulus_Pa *= 2;
  add("E x 2", stiffer);
  return words;
}

}  // namespace softfinger::judgement
