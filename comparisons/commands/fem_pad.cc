#include "comparisons/commands/fem_pad.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "comparisons/commands/commands.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/pad_answer.h"
#include "comparisons/reference/pad_elements.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/progress.h"
#include "comparisons/system/terminal.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"

namespace softfinger::commands {
namespace {

using nlohmann::json;
using prediction::PadAnswer;
using reference::PadElements;

std::string error_words(const std::optional<double>& error) {
  return error ? "± " + text::percent(*error) : "± ?";
}

std::string first_line(const PadElements& pad, const PadAnswer& model) {
  const auto& half_m = pad.contact_half_lengths_m;
  const bool is_curved = half_m[0] > 0;
  const Eigen::Vector2d extent_mm =
      is_curved ? Eigen::Vector2d(2e3 * half_m[0], 2e3 * half_m[1]) : 1e3 * model.face.extent_m();
  return fmt::format(
      "{:g} N: torque {:.4g} mN·m {}, by finite elements; {} contact {:.3g} x {:.3g} mm{}; e_n "
      "{:.4g} mm\n",
      pad.load_N, 1e3 * pad.max_torque_Nm, error_words(pad.error.max_torque),
      model.problem.cylinder ? "line" : "pad", extent_mm.x(), extent_mm.y(),
      pad.lifted_share > 0 ? fmt::format(", {:.0f} % of it lifted off", 100 * pad.lifted_share)
                           : "",
      1e3 * pad.eccentricity_m);
}

/// No limit: a frictionless rim lifts off by pressing alone; of a stuck one these elements are too
/// coarse to tell.
std::string limit_words(const std::optional<double>& limit_Nm) {
  return limit_Nm ? fmt::format("{:.4g}", 1e3 * *limit_Nm) : std::string("?");
}

/// Errors of the closed form.
std::string model_text(const PadElements& pad, const PadAnswer& model) {
  const PadPrediction& p = model.prediction;
  if (!p.has_answer || pad.lifted_share > 0) return "";
  const auto apart = [](double predicted, double found) {
    return fmt::format("{:+.1f} %", 100 * (predicted / found - 1));
  };
  return fmt::format("  {} is off by: torque {}, d {}, stiffness {}, arm as pressed {}{}\n",
                     model.model->card().name, apart(p.eccentricity_m, pad.eccentricity_m),
                     apart(indentation_at_load_m(model), pad.indentation_m),
                     apart(p.normal_stiffness_N_per_m, pad.normal_stiffness_N_per_m),
                     apart(p.pressure_arm_m, pad.pressure_arm_m),
                     model.bound
                         ? "; it states torque ± " + text::percent(model.bound->max_torque) +
                               ", d ± " + text::percent(model.bound->indentation)
                         : "; no bound is known for it here");
}

std::string cost_text(const PadElements& pad) {
  return fmt::format("  {:.0f} unknowns, {:.1f} s, {:.0f} MB\n", pad.unknowns, pad.wall_s,
                     pad.peak_memory_MB);
}

std::string curved_text(const PadElements& pad) {
  return fmt::format(
      "  d {:.4g} mm {}, stiffness {:.4g} N/mm {}, peak {:.4g} kPa {}\n"
      "  tilt stiffness about x {:.4g}, about y {:.4g} N·m/rad, of the contact as it is; the "
      "contact's lengths are known to the distance of two nodes\n",
      1e3 * pad.indentation_m, error_words(pad.error.indentation),
      1e-3 * pad.normal_stiffness_N_per_m, error_words(pad.error.normal_stiffness),
      1e-3 * pad.peak_pressure_Pa, error_words(pad.error.peak_pressure),
      pad.tilt_stiffness_Nm_per_rad[0], pad.tilt_stiffness_Nm_per_rad[1]);
}

std::string flat_text(const PadElements& pad) {
  return fmt::format(
      "  d {:.4g} mm {}, stiffness {:.4g} N/mm {}, arm as pressed {:.4g} mm {}, peak within 0.95 "
      "of the outline {:.4g} kPa {}\n"
      "  tilt stiffness about x {:.4g}, about y {:.4g} N·m/rad; without lift-off at most {} and {} "
      "mN·m\n"
      "  stuck: torsional stiffness {:.4g} N·m/rad, tangential {:.4g} and {:.4g} N/mm\n",
      1e3 * pad.indentation_m, error_words(pad.error.indentation),
      1e-3 * pad.normal_stiffness_N_per_m, error_words(pad.error.normal_stiffness),
      1e3 * pad.pressure_arm_m, error_words(pad.error.pressure_arm), 1e-3 * pad.peak_pressure_Pa,
      error_words(pad.error.peak_pressure), pad.tilt_stiffness_Nm_per_rad[0],
      pad.tilt_stiffness_Nm_per_rad[1], limit_words(pad.tilt_limit_Nm[0]),
      limit_words(pad.tilt_limit_Nm[1]), pad.torsional_stiffness_Nm_per_rad,
      1e-3 * pad.tangential_stiffness_N_per_m[0], 1e-3 * pad.tangential_stiffness_N_per_m[1]);
}

std::string elements_text(const PadElements& pad, const PadAnswer& model) {
  const bool is_curved = pad.contact_half_lengths_m[0] > 0;
  return (is_curved ? curved_text(pad) : flat_text(pad)) + model_text(pad, model) + cost_text(pad);
}

}  // namespace

int fem_pad(const PadFemQuestion& question, const input::Case& contact_case) {
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  const int level = question.level > 0 ? question.level : contact_case.fem_level;
  if (const auto left_out = reference::elements_remark(contact_case)) remark(*left_out);
  const std::string program = system::fem_program().string();
  reference::FemDocuments problems;
  problems.single_thread = false;
  problems.limits = question.limits;
  for (const double load_N : contact_case.loads_N)
    problems.problems.push_back(
        reference::pad_problem(contact_case, load_N, level, question.limit_surface));
  system::Progress progress;
  std::vector<reference::PadSolution> solutions;
  reference::PadCallbacks callbacks;
  const auto title = [&](std::size_t load) {
    return fmt::format("{} {:g} N", contact_case.id, contact_case.loads_N[load]);
  };
  callbacks.on_line = [&](reference::FemIndex index, const std::string& line) {
    progress.say(title(index.problem) + ": " + line);
  };
  callbacks.on_solution = [&](reference::FemIndex, reference::PadSolution solution) {
    solutions.push_back(std::move(solution));
  };
  if (const int signal = reference::run_pads(program, {problems}, 1, callbacks))
    return 128 + signal;
  for (std::size_t load = 0; load < solutions.size(); ++load)
    if (!solutions[load].elements) {
      progress.fail("softfinger: error: " + title(load) + ": " + solutions[load].failure);
      return solutions[load].exit_status;
    }
  const PadShape shape(prediction::bearing_outline(contact_case));
  std::string answers, evidence;
  json results = json::array();
  for (std::size_t load = 0; load < solutions.size(); ++load) {
    PadElements pad = *solutions[load].elements;
    pad.load_N = contact_case.loads_N[load];  // as typed
    PadAnswer model =
        prediction::ask_pad_model(pair.curved ? line_layer() : *find_pad_model("pad_layer"),
                                  contact_case, shape, pad.load_N, {}, 0);
    answers += first_line(pad, model);
    evidence += (solutions.size() > 1 ? fmt::format("\n{:g} N\n", pad.load_N) : "") +
                elements_text(pad, model);
    results.push_back(reference::to_json(pad, contact_case));
  }
  if (question.json)
    system::write_to_stdout(text::printed(json({{"case", contact_case.id}, {"results", results}})));
  else
    system::write_text_to_stdout(system::within_terminal(
        answers + evidence + "\n" + prediction::describe(contact_case) + "\n" +
        prediction::describe(pair, contact_case.layer) +
        fmt::format("\nfinite elements: of the whole pad, linear, level {}; ± is their own "
                    "error\n",
                    level)));
  return 0;
}

}  // namespace softfinger::commands
