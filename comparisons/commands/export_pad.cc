#include "comparisons/commands/export_pad.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "comparisons/commands/number_option.h"
#include "comparisons/prediction/pad_answer.h"
#include "comparisons/system/files.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

constexpr const char* kOnePoint =
    "these numbers belong to ONE contact point in the middle of the pad (a small sphere or capsule "
    "there). A box on a plane makes four points at its corners, whose forces alone carry about "
    "twice "
    "a pad's torque: with a box take condim 3 and no spinning friction, and know that it holds too "
    "much";

}  // namespace

int export_pad(const exporting::Simulator& simulator, const input::Case& contact_case,
               const ContactChoice& choice, bool json) {
  if (simulator.name != "mujoco")
    throw InputError("command line", "--to", std::string(simulator.name),
                     "mujoco for a flat pad so far; for others softfinger predict states mu and "
                     "e_n, which do not depend on the load");
  if (!choice.model.empty())
    throw InputError("command line", "--model", choice.model, "none for a flat pad: pad_layer");
  if (!choice.load_range.empty())
    throw InputError("command line", "--load-range", choice.load_range,
                     "none for a flat pad: its e_n does not depend on the load");
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  const PadShape shape(pair.contact);
  double load_N = contact_case.loads_N.front();
  if (!choice.load.empty()) load_N = number_of("--load", choice.load, "a number > 0, in N");
  if (!(load_N > 0) || !std::isfinite(load_N))
    throw InputError("command line", "--load", choice.load, "a number > 0, in N");
  const prediction::PadAnswer answer = prediction::ask_pad_model(
      *find_pad_model("pad_layer"), contact_case, shape, load_N, choice.demand.demand(), 0);
  const FrictionEllipsoid limit = answer.friction_ellipsoid();
  exporting::SoftContact contact;
  contact.friction_coefficient = answer.problem.load.friction_coefficient;
  contact.load_N = load_N;
  contact.eccentricity_m = limit.eccentricity_m;
  contact.indentation_m = answer.prediction.indentation_m;
  contact.normal_stiffness_N_per_m = answer.prediction.normal_stiffness_N_per_m;
  contact.origin = fmt::format("{}, pad_layer, {:g} N", contact_case.id, load_N);
  const exporting::Lines lines = simulator.lines(contact);
  const bool told = answer.usable || choice.force;
  const double bound = answer.bound ? answer.bound->max_torque : kNaN;
  if (json) {
    nlohmann::json values = nlohmann::json::object();
    for (const auto& [name, value] : lines.values) values[name] = text::finite_or_null(value);
    nlohmann::json result = to_json(answer, 0);
    result["recommended"] = true;
    nlohmann::json traps = nlohmann::json::array({kOnePoint});
    for (const auto trap : simulator.traps) traps.push_back(trap);
    system::write_to_stdout(text::printed(
        {{"case", contact_case.id},
         {"simulator", simulator.name},
         {"model", "pad_layer"},
         {"load_N", load_N},
         {"friction_coefficient", contact.friction_coefficient},
         {"eccentricity_m", text::finite_or_null(limit.eccentricity_m)},
         {"usable", answer.usable},
         {"error_bound", text::finite_or_null(bound)},
         {"error_evidence", answer.evidence},
         {"normal_stiffness_N_per_m", text::finite_or_null(contact.normal_stiffness_N_per_m)},
         {"lines", told ? nlohmann::json(lines.text) : nlohmann::json()},
         {"values", told ? values : nlohmann::json()},
         {"results", {result}},
         {"traps", traps}}));
    return answer.usable ? 0 : 1;
  }
  std::string text =
      fmt::format("{:g} N: {}torque {:.3g} mN·m ± {}, by pad_layer; e_n {:.3g} mm at any load{}\n",
                  load_N, answer.usable ? "" : "NOT USABLE: ", 1e3 * limit.max_torque_Nm(),
                  std::isfinite(bound) ? text::percent(bound) : "?", 1e3 * limit.eccentricity_m,
                  answer.usable ? "" : "; " + answer.evidence);
  if (told) {
    text += fmt::format("\n{}\n{}: {}\nNormal stiffness dP/dd {:.4g} N/mm\n- {}\n", lines.text,
                        simulator.title, simulator.law, 1e-3 * contact.normal_stiffness_N_per_m,
                        kOnePoint);
    for (const auto trap : simulator.traps) text += fmt::format("- {}\n", trap);
  } else {
    text += kHowToForce;
  }
  system::write_text_to_stdout(text);
  return answer.usable ? 0 : 1;
}

}  // namespace softfinger::commands
