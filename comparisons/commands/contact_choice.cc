#include "comparisons/commands/contact_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/commands/answer_lines.h"
#include "comparisons/commands/commands.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/prediction/answer_in_time.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/text/nearest_name.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

/// Null: the recommended one.
const PressureModel* model_by_name(const std::string& name) {
  if (name.empty()) return nullptr;
  const auto models = prediction::models_by_name(name);
  if (models.size() != 1)
    throw InputError("command line", "--model", name, "the name of one model; see: list models");
  return models.front();
}

exporting::LoadChoice load_choice(const ContactChoice& options) {
  exporting::LoadChoice choice;
  // Whether they are valid loads is checked in choose_loads.
  if (!options.load.empty())
    choice.nominal_N = number_of("--load", options.load, "a number > 0, in N");
  if (!options.load_range.empty())
    choice.range_N =
        numbers_of("--load-range", options.load_range, "LOW,HIGH in N with 0 < LOW < HIGH");
  return choice;
}

}  // namespace

exporting::Fit ContactChoice::kind_of_fit() const {
  return fit == "range" ? exporting::Fit::range : exporting::Fit::nominal;
}

const exporting::Simulator& simulator_by_name(const std::string& name) {
  if (const exporting::Simulator* simulator = exporting::find_simulator(name)) return *simulator;
  std::vector<std::string> known;
  for (const exporting::Simulator& simulator : exporting::all_simulators())
    known.emplace_back(simulator.name);
  throw InputError("command line", "--to " + name + text::did_you_mean(name, known), "",
                   text::joined(known));
}

void add_contact_choice(CLI::App& command, ContactChoice& choice) {
  command.add_option("--model,--models", choice.model,
                     "the model whose torque is taken; default: the recommended one, which predict "
                     "names first; see: list models");
  command.add_option("--load", choice.load,
                     "nominal load in N, > 0, that the constants are made for (default: the "
                     "middle one of the case's loads)");
  command.add_option("--load-range", choice.load_range,
                     "LOW,HIGH in N, 0 < LOW < HIGH, over which the error is stated (default: the "
                     "case's loads, or P/3 to 3P if it has one)");
  command
      .add_option("--fit", choice.fit,
                  "\"nominal\" (default): exact at the nominal load; \"range\": the smallest worst "
                  "error over the range")
      ->check(CLI::IsMember({"nominal", "range"}));
  add_demand(command, choice.demand);
  command.add_flag("--force", choice.force,
                   "the lines also where the answer is not usable: nobody vouches for them");
}

void check_contact_choice(const ContactChoice& choice) {
  choice.demand.demand();
  model_by_name(choice.model);
  load_choice(choice);
}

input::Case read_contact_case(const ContactChoice& choice) {
  check_contact_choice(choice);
  CaseInput typed_case = choice.typed_case;
  if (typed_case.file.empty()) typed_case.load_N = choice.load;
  input::Case read = read_case(typed_case);
  if (!choice.at_time.empty()) refuse_time_without_times(read, choice.at_time);
  return read;
}

exporting::LoadRange loads_of(const input::Case& contact_case, const ContactChoice& choice) {
  const input::ContactTimes& times = contact_case.times;
  std::optional<double> time_s;
  if (!choice.at_time.empty()) {
    time_s = number_of("--at-time", choice.at_time, "a finite number of seconds");
  }
  if (!times.are_given()) return exporting::choose_loads(contact_case.loads_N, load_choice(choice));
  std::vector<double> loads_N = contact_case.loads_N;
  if (!times.history.empty() && !time_s) time_s = times.history.back().time_s;
  const double at_s = time_s.value_or(0);
  // Refuses what nothing is known of, in the words of predict.
  if (!times.history.empty() && times.drive == ContactHistory::Drive::load)
    loads_N = {prediction::moments_of(contact_case, at_s).front().history.value(at_s)};
  exporting::LoadRange loads =
      exporting::choose_loads(loads_N.empty() ? std::vector{1.} : loads_N, load_choice(choice));
  loads.time_s = at_s;
  return loads;
}

exporting::ContactCurve ask_contact_curve(const input::Case& contact_case,
                                          const ContactChoice& choice) {
  return ask_contact_curve(contact_case, prediction::GeometryResolver(contact_case), choice);
}

exporting::ContactCurve ask_contact_curve(const input::Case& contact_case,
                                          const prediction::GeometryResolver& resolver,
                                          const ContactChoice& choice) {
  const PressureModel* const model = model_by_name(choice.model);
  const auto loads = loads_of(contact_case, choice);
  for (const std::string& line : resolver.remarks()) remark(line);
  return exporting::ask_contact_curve(contact_case, resolver, model, loads, choice.demand.demand());
}

std::string short_error(const exporting::LoadPoint& point) {
  const double error = point.error_bound();
  return std::isfinite(error) ? "± " + text::percent(error) : "± ?";
}

std::string answer_line(const exporting::ContactCurve& curve) {
  const exporting::LoadPoint& point = curve.nominal;
  const std::string answer =
      fmt::format("torque {:.3g} mN·m {}{}, by {}; contact {:.3g} x {:.3g} mm; e_n {:.3g} mm",
                  1e3 * point.max_torque_Nm(), short_error(point), in_words(point.inputs),
                  curve.model, 2e3 * point.a_m, 2e3 * point.b_m, 1e3 * point.eccentricity_m);
  return curve.advice.empty() ? fmt::format("{:g} N{}: {}\n", point.load_N, curve.when, answer)
                              : fmt::format("NOT USABLE: {} ({:g} N{}: {})\n", curve.advice,
                                            point.load_N, curve.when, answer);
}

}  // namespace softfinger::commands
