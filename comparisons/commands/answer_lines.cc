#include "comparisons/commands/answer_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/exporting/mujoco_friction.h"
#include "comparisons/judgement/reason.h"
#include "comparisons/judgement/recommended.h"
#include "comparisons/text/percent.h"

namespace softfinger::commands {
namespace {

using prediction::ModelAnswer;
using prediction::Quantity;

/// "1.4 %", "?" where it is not known.
std::string bound_in_words(const ModelAnswer& answer, std::initializer_list<Quantity> quantities) {
  double largest = 0;
  for (const Quantity quantity : quantities) {
    const double total = answer.assessment ? answer.assessment->total(quantity) : kNaN;
    if (!std::isfinite(total)) return "?";
    largest = std::max(largest, total);
  }
  return text::percent(largest);
}

/// Rounds to the four digits that the answer is worth at most.
double rounded(double value) { return std::stod(fmt::format("{:.4g}", value)); }

/// Narrow enough for a terminal of 80 columns.
constexpr const char* kRow = "  {:<19} {:>5} {:>5} {:>6} {:>5} {:>6} {:>6} {:>8} {:>7}\n";

std::string short_number(double value) {
  return std::abs(value) < 1000 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

std::string model_row(const ModelAnswer& answer, prediction::TorqueRule rule) {
  const Prediction& p = answer.pressed();
  const FrictionEllipsoid limit = answer.friction_ellipsoid(rule);
  return fmt::format(fmt::runtime(kRow), answer.model->card().name, short_number(2e3 * p.a_m),
                     short_number(2e3 * p.b_m), short_number(1e3 * p.indentation_m),
                     short_number(1e-3 * p.peak_pressure_Pa),
                     short_number(1e3 * limit.max_torque_Nm()),
                     short_number(1e3 * limit.eccentricity_m),
                     bound_in_words(answer, {Quantity::a, Quantity::b, Quantity::area}),
                     bound_in_words(answer, {Quantity::max_torque}));
}

}  // namespace

std::string in_words(const std::optional<judgement::InputDoubt>& inputs) {
  if (!inputs) return "";
  const double down = -inputs->torque_down, up = inputs->torque_up;
  if (!std::isfinite(down) || !std::isfinite(up)) return " (by the inputs ± ?)";
  if (down == 0 && up == 0) return "";
  // Up to a few per cent both sides are the same.
  constexpr double kSame = 1.1;
  if (std::max(down, up) < kSame * std::min(down, up))
    return " (by the inputs ± " + text::percent(std::max(down, up)) + ")";
  return " (by the inputs -" + text::percent(down) + " to +" + text::percent(up) + ")";
}

std::string answer_line(double load_N, const ModelAnswer* answer, prediction::TorqueRule rule,
                        const prediction::Demand& demand,
                        const std::optional<judgement::InputDoubt>& inputs,
                        const std::string& when) {
  if (!answer) return fmt::format("{:g} N{}: NO ANSWER by any of these models\n", load_N, when);
  const Prediction& p = answer->pressed();
  const FrictionEllipsoid limit = answer->friction_ellipsoid(rule);
  const bool usable = answer->assessment && answer->assessment->usable;
  const std::string force = answer->shear_law.kind == ShearLaw::Kind::coulomb
                                ? ""
                                : fmt::format("; largest force {:.3g} N", limit.max_force_N);
  // MuJoCo's line is printed only for a usable answer, because users paste it.
  const std::string lines =
      usable ? "; MuJoCo " + exporting::mujoco_friction(rounded(limit.max_force_N / load_N),
                                                        rounded(limit.max_torque_Nm() / load_N))
             : "";
  return fmt::format(
      "{:.6g} N{}: {}torque {:.3g} mN·m ± {}{}, by {}; contact {:.3g} x {:.3g} mm; e_n {:.3g} mm"
      "{}{}\n",
      when.empty() ? load_N : rounded(load_N), when,
      usable ? "" : "NOT USABLE within " + text::percent(demand.tolerance) + ": ",
      1e3 * limit.max_torque_Nm(), bound_in_words(*answer, {Quantity::max_torque}),
      in_words(inputs), answer->model->card().name, 2e3 * p.a_m, 2e3 * p.b_m,
      1e3 * limit.eccentricity_m, force, lines);
}

std::string models_text(const std::vector<ModelAnswer>& answers, const ModelAnswer* recommended,
                        prediction::TorqueRule rule, const prediction::Demand& demand) {
  const auto usable = judgement::usable_ones(answers, recommended);
  std::string text;
  if (!usable.empty())
    text += fmt::format(fmt::runtime(kRow), "usable", "2a mm", "2b mm", "d mm", "kPa", "mN·m",
                        "e_n mm", "contact±", "torque±");
  for (const ModelAnswer* answer : usable) text += model_row(*answer, rule);
  for (const ModelAnswer& answer : answers)
    if (!answer.assessment || !answer.assessment->usable)
      text += fmt::format("  {:<19} no, {}\n", answer.model->card().name,
                          judgement::reason_not_usable(answer, demand));
  return text;
}

}  // namespace softfinger::commands
