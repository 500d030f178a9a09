#include "comparisons/commands/contact_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "comparisons/commands/commands.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

const PressureModel& model_by_name(const std::string& name) {
  const auto models = prediction::models_by_name(name);
  if (models.size() != 1)
    throw InputError("command line", "--model", name, "the name of one model; see: list models");
  return *models.front();
}

/// The numbers of "1,5". Whether they are valid loads is checked in choose_loads.
std::vector<double> numbers(const std::string& flag, const std::string& text) {
  std::vector<double> values;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::string word = text.substr(start, end - start);
    char* rest = nullptr;
    values.push_back(std::strtod(word.c_str(), &rest));
    if (word.empty() || *rest != '\0')
      throw InputError(
          "command line", flag, "\"" + text + "\"",
          flag == "--load" ? "a number > 0, in N" : "LOW,HIGH in N with 0 < LOW < HIGH");
    start = end + 1;
  }
  return values;
}

exporting::LoadChoice load_choice(const ContactChoice& options) {
  exporting::LoadChoice choice;
  if (!options.load.empty()) {
    const auto values = numbers("--load", options.load);
    if (values.size() != 1)
      throw InputError("command line", "--load", "\"" + options.load + "\"", "a number > 0, in N");
    choice.nominal_N = values.front();
  }
  if (!options.load_range.empty()) choice.range_N = numbers("--load-range", options.load_range);
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
  command.add_option("--model", choice.model,
                     "the model whose torque is taken (default bonded_layer); see: list models");
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
  command
      .add_option("--tolerance", choice.tolerance,
                  "of the torque, within which an answer is usable, relative; default: 0.1")
      ->check(CLI::Range(1e-6, 10.));
}

input::Case read_contact_case(const ContactChoice& choice) {
  refuse_nan(choice.tolerance, "--tolerance", "1e-6 to 10");
  model_by_name(choice.model);
  load_choice(choice);
  CaseInput typed_case = choice.typed_case;
  if (typed_case.file.empty()) typed_case.load_N = choice.load;
  return read_case(typed_case);
}

exporting::ContactCurve ask_contact_curve(const input::Case& contact_case,
                                          const ContactChoice& choice) {
  const PressureModel& model = model_by_name(choice.model);
  const auto loads = exporting::choose_loads(contact_case.loads_N, load_choice(choice));
  const prediction::GeometryResolver resolver(contact_case);
  for (const std::string& line : resolver.remarks()) remark(line);
  exporting::ContactCurve curve =
      exporting::ask_contact_curve(contact_case, resolver, model, loads, choice.tolerance);
  for (const exporting::LoadPoint& point : curve.points)
    if (!(point.error_bound() <= choice.tolerance)) {
      remark(fmt::format(
          "{} is not known to be within {:g} % everywhere, at {:.4g} N for one: {}{}", curve.model,
          100 * choice.tolerance, point.load_N, error_in_words(point),
          (point.assessment.determined || !point.assessment.bound) && !point.objection.empty()
              ? "; " + point.objection
              : ""));
      break;
    }
  return curve;
}

std::string short_error(const exporting::LoadPoint& point) {
  const double error = point.error_bound();
  if (!std::isfinite(error)) return "±?";
  return fmt::format(error < 0.0995 ? "±{:.1f} %" : "±{:.0f} %", 100 * error);
}

std::string error_in_words(const exporting::LoadPoint& point) {
  const std::string error = short_error(point);
  return point.assessment.bound && point.assessment.determined
             ? error + " of the finger's"
             : error + ": " + point.assessment.evidence;
}

}  // namespace softfinger::commands
