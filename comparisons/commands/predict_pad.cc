#include "comparisons/commands/predict_pad.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "comparisons/commands/answer_lines.h"
#include "comparisons/exporting/mujoco_friction.h"
#include "comparisons/input/layer_json.h"
#include "comparisons/judgement/input_doubt.h"
#include "comparisons/judgement/pad_doubt.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/pad_answer.h"
#include "comparisons/system/files.h"
#include "comparisons/system/terminal.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

using input::PadPair;
using prediction::PadAnswer;

const PadPair& pads_of(const input::Case& contact_case) {
  return std::get<PadPair>(contact_case.geometry);
}

std::string bound_words(double bound) { return std::isfinite(bound) ? text::percent(bound) : "?"; }

double four_digits(double value) { return std::stod(fmt::format("{:.4g}", value)); }

std::string lifted_words(const PadAnswer& answer) {
  const double lifted = answer.prediction.lifted_share;
  return lifted > 0 ? fmt::format(", {} of it lifted off", text::percent(lifted)) : "";
}

std::string pad_answer_line(const PadAnswer* answer, double load_N,
                            const prediction::Demand& demand,
                            const std::optional<judgement::InputDoubt>& inputs) {
  if (!answer) return fmt::format("{:g} N: NO ANSWER by any of these models\n", load_N);
  const FrictionEllipsoid limit = answer->friction_ellipsoid();
  const Eigen::Vector2d extent_mm = 1e3 * answer->contact().extent_m();
  const std::string lines =
      answer->usable
          ? "; MuJoCo " + exporting::mujoco_friction(four_digits(limit.max_force_N / load_N),
                                                     four_digits(limit.max_torque_Nm() / load_N))
          : "";
  return fmt::format(
      "{:g} N: {}torque {:.3g} mN·m ± {}{}, by {}; {} contact {:.3g} x {:.3g} mm{}; e_n {:.3g} "
      "mm{}\n",
      load_N, answer->usable ? "" : "NOT USABLE within " + text::percent(demand.tolerance) + ": ",
      1e3 * limit.max_torque_Nm(), bound_words(answer->bound_of(prediction::Quantity::max_torque)),
      in_words(inputs), answer->model->card().name, answer->problem.cylinder ? "line" : "pad",
      extent_mm.x(), extent_mm.y(), lifted_words(*answer), 1e3 * limit.eccentricity_m, lines);
}

constexpr const char* kPadRow = "  {:<13} {:>7} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8}\n";

std::string three_digits(double value) {
  return std::abs(value) < 1000 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

std::string pad_rows(const std::vector<PadAnswer>& answers, const prediction::Demand& demand) {
  std::string text, others;
  for (const PadAnswer& answer : answers) {
    const PadPrediction& p = answer.prediction;
    if (!p.has_answer || !answer.usable) {
      const double worst = answer.bound ? answer.bound_of(prediction::Quantity::max_torque) : kNaN;
      others += fmt::format(
          "  {:<13} no, {}\n", answer.model->card().name,
          answer.bound && worst > demand.tolerance
              ? fmt::format("its torque may be {} off", bound_words(worst))
          : answer.bound ? "a demanded quantity is not known to " + text::percent(demand.tolerance)
                         : answer.evidence);
      continue;
    }
    if (text.empty())
      text += fmt::format(fmt::runtime(kPadRow), "usable", "d mm", "kPa", "N/mm", "mN·m", "e_n mm",
                          "pressed±", "torque±");
    text += fmt::format(
        fmt::runtime(kPadRow), answer.model->card().name, three_digits(1e3 * p.indentation_m),
        three_digits(1e-3 * p.peak_pressure_Pa), three_digits(1e-3 * p.normal_stiffness_N_per_m),
        three_digits(1e3 * answer.friction_ellipsoid().max_torque_Nm()),
        three_digits(1e3 * p.eccentricity_m),
        bound_words(answer.bound_of(prediction::Quantity::indentation)),
        bound_words(answer.bound_of(prediction::Quantity::max_torque)));
  }
  return text + others;
}

/// Numbers of a pad under a flat face.
std::string flat_numbers(const PadAnswer& answer) {
  const PadPrediction& p = answer.prediction;
  std::string text = fmt::format(
      "    arm as pressed {:.4g} mm, at full slip (e_n) {:.4g} mm: a twist lets the radial shear "
      "go, "
      "so that the largest torque is that of frictionless pressing\n"
      "    tilt stiffness about x {:.4g}, about y {:.4g} N·m/rad; without lift-off at most {:.4g} "
      "and {:.4g} mN·m, which is the load {:.3g} and {:.3g} mm off the middle. Beyond, the rim "
      "lifts off and the contact shrinks; it tips where the load leaves the outline\n"
      "    stuck pad: torsional stiffness {:.4g} N·m/rad, tangential {:.4g} and {:.4g} N/mm with "
      "faces kept parallel\n",
      1e3 * p.pressure_arm_m, 1e3 * p.eccentricity_m, p.tilt_stiffness_Nm_per_rad[0],
      p.tilt_stiffness_Nm_per_rad[1], 1e3 * p.tilt_limit_Nm[0], 1e3 * p.tilt_limit_Nm[1],
      1e3 * p.tilt_limit_Nm[0] / answer.problem.load.normal_force_N,
      1e3 * p.tilt_limit_Nm[1] / answer.problem.load.normal_force_N,
      p.torsional_stiffness_Nm_per_rad, 1e-3 * p.tangential_stiffness_N_per_m[0],
      1e-3 * p.tangential_stiffness_N_per_m[1]);
  if (p.lifted_share > 0)
    text += fmt::format(
        "    the load is {:.2f} times as far from the middle as the rim bears: {} of the face has "
        "lifted off and carries nothing, and the stiffnesses are those of the whole face\n",
        p.tilt_utilisation, text::percent(p.lifted_share));
  return text;
}

/// Numbers of a line contact.
std::string line_numbers(const PadAnswer& answer) {
  const PadPrediction& p = answer.prediction;
  return fmt::format(
      "    arm {:.4g} mm, half-width {:.4g} mm in the middle of the line; per length it would be "
      "{:.4g} N/mm if no end counted\n"
      "    tilt stiffness about y {:.4g} N·m/rad, the line being along x; about its own axis a "
      "cylinder rolls\n",
      1e3 * p.pressure_arm_m, 1e3 * p.half_width_m,
      1e-3 * answer.problem.load.normal_force_N / answer.contact().extent_m().x(),
      p.tilt_stiffness_Nm_per_rad[1]);
}

/// All that the answers rest on.
std::string pad_evidence(const PadAnswer& answer) {
  const PadPrediction& p = answer.prediction;
  std::string text = fmt::format("  {}: {}\n", answer.model->card().name, answer.evidence);
  if (!p.has_answer) return text;
  text += answer.problem.cylinder ? line_numbers(answer) : flat_numbers(answer);
  if (answer.bound)
    text += fmt::format(
        "    bounds: torque {}, arm as pressed {}, indentation and stiffness {}, peak{} {}, tilt "
        "{}\n",
        bound_words(answer.bound->max_torque), bound_words(answer.bound->pressure_arm),
        bound_words(answer.bound->indentation),
        answer.problem.cylinder ? "" : " (within 0.95 of the outline)",
        bound_words(answer.bound->peak_pressure), bound_words(answer.bound->tilt_stiffness));
  for (const ValidityCheck& check : p.validity)
    if (!check.holds())
      text += fmt::format("    {} = {:.3g}, limit {:.3g}: {}\n", check.check, check.value,
                          check.limit, check.message);
  return text;
}

std::string pad_surface_text(const nlohmann::json& result) {
  if (result["limit_surface"].empty()) return "";
  std::string text = fmt::format(
      "\nLimit surface, {} at {:g} N: exact for the pad's own pressure; the friction ellipsoid is "
      "up to {:.1f} % outside of it and {:.1f} % inside\n  {:>12}{:>12}{:>14}\n",
      result["model"].get<std::string>(), result["load_N"].get<double>(),
      -100 * result["ellipsoid_deviation"][0].get<double>(),
      100 * result["ellipsoid_deviation"][1].get<double>(), "fx N", "fy N", "torque mN·m");
  for (const auto& point : result["limit_surface"])
    text += fmt::format("  {:>12.5g}{:>12.5g}{:>13.5g}\n", point["fx_N"].get<double>(),
                        point["fy_N"].get<double>(), 1e3 * point["torque_Nm"].get<double>());
  return text;
}

}  // namespace

int predict_pad(const PadQuestion& question, const input::Case& contact_case) {
  const PadPair& pair = pads_of(contact_case);
  const auto models =
      prediction::pad_models_by_name(question.models, pair.curved && pair.curved->is_cylinder());
  const PadShape shape(prediction::bearing_outline(contact_case));
  const double budget_ns = 3e5 / double(models.size() * contact_case.loads_N.size());
  nlohmann::json results = nlohmann::json::array();
  std::string first_lines, blocks, surfaces;
  std::string evidence = prediction::describe(contact_case) + "\n" +
                         prediction::describe(pair, contact_case.layer) + "\n";
  for (std::size_t load = 0; load < contact_case.loads_N.size(); ++load) {
    const double load_N = contact_case.loads_N[load];
    std::vector<PadAnswer> answers;
    for (const PadModel* model : models) {
      answers.push_back(prediction::ask_pad_model(*model, contact_case, shape, load_N,
                                                  question.demand, budget_ns));
      if (answers.size() == 1) prediction::refuse_tipping(pair, answers.back());
    }
    // The models are in the order of their worth.
    const auto answered = std::find_if(answers.begin(), answers.end(), [](const PadAnswer& answer) {
      return answer.prediction.has_answer;
    });
    const PadAnswer* first = answered == answers.end() ? nullptr : &*answered;
    for (const PadAnswer& answer : answers) {
      results.push_back(to_json(answer, question.limit_surface));
      results.back()["recommended"] = &answer == first;
      results.back()["input_doubt"] = to_json(judgement::pad_doubt(contact_case, answer, load));
      if (question.limit_surface > 0) surfaces += pad_surface_text(results.back());
    }
    first_lines +=
        pad_answer_line(first, load_N, question.demand,
                        first ? judgement::pad_doubt(contact_case, *first, load) : std::nullopt);
    if (contact_case.loads_N.size() > 1) blocks += fmt::format("\n{:g} N\n", load_N);
    if (first) blocks += "  torque by the inputs: " + judgement::pad_cost_of_inputs(*first) + "\n";
    blocks += pad_rows(answers, question.demand);
    evidence += fmt::format("\n{:g} N\n", load_N);
    for (const PadAnswer& answer : answers) evidence += pad_evidence(answer);
  }
  if (question.json) {
    system::write_to_stdout(
        text::printed({{"case", contact_case.id},
                       {"layer", input::layer_json(contact_case.layer)},
                       {"layer_on", "finger"},
                       {"object_layer", nullptr},
                       {"power_law_fit", nullptr},
                       {"shear_law", "coulomb"},
                       {"friction_coefficient", contact_case.shear_law.friction_coefficient},
                       {"shear_strength_Pa", nullptr},
                       {"geometry", nlohmann::json::array()},
                       {"results", results}}));
    return 0;
  }
  system::write_text_to_stdout(system::within_terminal(
      first_lines + blocks + (question.explain ? "\n" + evidence : "") + surfaces));
  return 0;
}

}  // namespace softfinger::commands
