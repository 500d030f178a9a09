#include <cmath>
#include <cstdlib>
#include <memory>
#include <variant>

#include "comparisons/calibration/calibration_report.h"
#include "comparisons/calibration/relaxation_report.h"
#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/input/held_forces.h"
#include "comparisons/report/calibration_page.h"
#include "comparisons/system/clock.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct CalibrateOptions {
  std::string data, case_file, fit, model = "fingertip_layer", output, page, command_line;
  std::vector<std::string> fixed;
  bool json = false, force = false;
  double hold_out_above = 1;
  std::vector<double> at_loads_N;
  std::vector<std::string> settings;
};

/// Parameters that `--fit` may name. A power law has parameters of its own.
constexpr std::array<Parameter, 8> kFitted{Parameter::youngs_modulus,
                                           Parameter::thickness,
                                           Parameter::poisson_ratio,
                                           Parameter::radius,
                                           Parameter::friction_coefficient,
                                           Parameter::shear_strength,
                                           Parameter::zero,
                                           Parameter::compliance};

std::vector<std::string> split(const std::string& typed) {
  std::vector<std::string> parts;
  for (std::size_t start = 0; start <= typed.size();) {
    const std::size_t end = std::min(typed.find(',', start), typed.size());
    parts.push_back(typed.substr(start, end - start));
    start = end + 1;
  }
  return parts;
}

std::vector<Parameter> fitted(const std::string& typed) {
  std::vector<Parameter> result;
  if (typed.empty()) return result;
  for (const std::string& name : split(typed)) {
    std::vector<std::string> names;
    const Parameter* found = nullptr;
    for (const Parameter& parameter : kFitted) {
      names.emplace_back(range_of(parameter).name);
      // The key of --fix, with its unit, is understood as well.
      if (names.back() == name || names.back() + "_mm" == name ||
          names.back() + "_mm_per_N" == name)
        found = &parameter;
    }
    if (!found)
      throw InputError("command line",
                       "--fit: unknown parameter \"" + text::shortened(name) + "\"" +
                           text::did_you_mean(name, names),
                       "", text::joined(names));
    if (contains(result, *found))
      throw InputError("command line", "--fit", name, "each parameter once");
    result.push_back(*found);
  }
  return result;
}

/// A key of `--fix`: the parameter's name, with a unit where it has one.
struct FixKey {
  std::string name;
  Parameter parameter;
  double si_per_unit;
  bool is_inverse = false;  ///< a stiffness, whose inverse is the parameter
};
std::vector<FixKey> fix_keys() {
  std::vector<FixKey> keys;
  for (const Parameter parameter : kFitted) {
    const std::string name(range_of(parameter).name);
    const std::string_view unit = range_of(parameter).unit;
    if (unit == "m") {
      keys.push_back({name + "_mm", parameter, 1e-3, false});
      keys.push_back({name + "_m", parameter, 1, false});
    } else if (unit == "m/N") {
      keys.push_back({name + "_mm_per_N", parameter, 1e-3, false});
      keys.push_back({"mount_N_per_mm", parameter, 1e-3, true});
    } else if (unit == "Pa") {
      keys.push_back({name + "_kPa", parameter, 1e3, false});
      keys.push_back({name + "_Pa", parameter, 1, false});
    } else {
      keys.push_back({name, parameter, 1, false});
    }
  }
  return keys;
}

std::pair<Parameter, double> fixed_value(const std::string& typed) {
  const std::size_t equals = typed.find('=');
  if (equals == std::string::npos)
    throw InputError("command line", "--fix", "\"" + text::shortened(typed) + "\"",
                     "key=value, as poisson_ratio=0.49 or thickness_mm=3");
  const std::string key = typed.substr(0, equals), value_text = typed.substr(equals + 1);
  std::vector<std::string> names, with_unit;
  for (const FixKey& known : fix_keys()) {
    names.push_back(known.name);
    if (known.name.rfind(key + "_", 0) == 0 && range_of(known.parameter).name == key)
      with_unit.push_back(known.name);
    if (known.name != key) continue;
    const ParameterRange& range = range_of(known.parameter);
    const std::string allowed =
        known.is_inverse
            ? "a stiffness of " + internal::number_text(known.si_per_unit / range.highest, 3) +
                  " N/mm or more"
            : internal::number_text(range.lowest / known.si_per_unit, 3) + " to " +
                  internal::number_text(range.highest / known.si_per_unit, 3);
    const double typed_value = number_of("--fix " + key, value_text, allowed);
    const double value =
        known.is_inverse ? known.si_per_unit / typed_value : typed_value * known.si_per_unit;
    if (!(value >= range.lowest && value <= range.highest))
      throw InputError("command line", "--fix " + key, "\"" + text::shortened(value_text) + "\"",
                       allowed);
    return {known.parameter, value};
  }
  if (!with_unit.empty())
    throw InputError("command line", "--fix " + key, value_text,
                     "a key with its unit, " + text::joined(with_unit, " or "));
  throw InputError(
      "command line",
      "--fix: unknown key \"" + text::shortened(key) + "\"" + text::did_you_mean(key, names), "",
      text::joined(names));
}

const PressureModel* chosen_model(const std::string& name) {
  std::vector<std::string> names;
  for (const PressureModel* model : all_pressure_models())
    if (model->card().is_calibrated && !model->card().is_empirical)
      names.emplace_back(model->card().name);
  for (const std::string& known : names)
    if (known == name) return find_pressure_model(name);
  throw InputError("command line", "--model", "\"" + text::shortened(name) + "\"",
                   text::joined(names));
}

/// Force against time at constant approach: how the layer relaxes, which no model is needed for.
int calibrate_relaxation(const CalibrateOptions& options, const std::string& data_text,
                         const std::string& file) {
  const auto refuse = [](const char* flag, const std::string& value) {
    throw InputError("command line", flag, value,
                     "nothing for force against time: shares and times of relaxation are found");
  };
  if (!options.fit.empty()) refuse("--fit", options.fit);
  if (!options.fixed.empty()) refuse("--fix", options.fixed.front());
  if (!options.page.empty()) refuse("--page", options.page);
  const std::vector<HeldForce> forces = input::parse_held_forces(data_text, file);
  input::Settings settings = settings_of(options.settings);
  const auto read = [&] {
    return input::read_case(system::find_case_file(options.case_file), settings,
                            input::FlatPads::taken, input::Times::taken);
  };
  const input::Case typed = read();
  refuse_pad(typed, "softfinger calibrate with force against time");
  RelaxationFit fit;
  try {
    fit = fit_relaxation(forces);
  } catch (const InputError& error) {
    throw InputError(file, error.field(), error.value(), error.allowed());
  }
  if (!options.output.empty()) {
    if (fit.terms.empty())
      throw InputError("command line", "--output", options.output,
                       "forces that fall: no relaxation is seen in these");
    settings.push_back(
        {"layer.relaxation", calibration::relaxation_toml(fit), "found by softfinger calibrate"});
    if (options.case_file == "-")
      throw InputError("command line", "--output", options.output,
                       "a case in a file, which is read a second time");
    const std::string text = read().text;
    input::parse_case(text, options.output, {}, input::FlatPads::taken, input::Times::taken);
    system::write_file_atomically(options.output, text);
    remark("the case with relaxation is " + options.output);
  }
  nlohmann::json object = calibration::to_json(fit, forces);
  object["case"] = typed.id;
  if (options.json)
    system::write_to_stdout(text::printed(object));
  else
    system::write_text_to_stdout(calibration::describe(fit, forces));
  return 0;
}

int run_calibrate(const CalibrateOptions& options) {
  calibration::Request request;
  request.model = chosen_model(options.model);
  request.fit = fitted(options.fit);
  for (const std::string& typed : options.fixed) {
    request.fixed.push_back(fixed_value(typed));
    for (std::size_t i = 0; i + 1 < request.fixed.size(); ++i)
      if (request.fixed[i].first == request.fixed.back().first)
        throw InputError("command line", "--fix", typed, "each parameter once");
  }
  const auto refuse_number = [](const char* option, double value, const char* allowed) {
    throw InputError("command line", option, value, allowed);
  };
  if (!(options.hold_out_above > 0 && options.hold_out_above <= 1))
    refuse_number("--hold-out-above", options.hold_out_above,
                  "a part of the largest load, above 0 to 1");
  for (const double load_N : options.at_loads_N)
    if (!(load_N > 0 && load_N <= 1e6))
      refuse_number("--at-load", load_N, "loads in N, above 0 to 1e6");
  request.fitted_part = options.hold_out_above;
  request.forecast_loads_N = options.at_loads_N;
  request.takes_any_exponent = options.force;
  if (options.data == "-" && options.case_file == "-")
    throw InputError("command line", "DATA and CASE", "\"-\" for both",
                     "standard input for one of them");
  // Read as text once: standard input cannot be read again, and the page shows it.
  const bool from_standard_input = options.data == "-";
  const std::filesystem::path path =
      from_standard_input ? "standard input" : system::find_measurement_file(options.data);
  const std::string data_text = from_standard_input
                                    ? system::read_standard_input(input::kLargestMeasurementFile)
                                    : system::read_text_file(path, input::kLargestMeasurementFile);
  if (input::has_times(data_text)) return calibrate_relaxation(options, data_text, path.string());
  const input::MeasurementTable table = input::parse_measurements(data_text, path.string());
  const input::Case contact_case =
      input::read_case(system::find_case_file(options.case_file), settings_of(options.settings),
                       input::FlatPads::taken, input::Times::taken);
  input::refuse_times(contact_case, "softfinger calibrate");
  if (std::holds_alternative<input::PadPair>(contact_case.geometry))
    throw InputError(
        contact_case.geometry_where,
        "softfinger calibrate does not take flat pads yet: their area is the outline's "
        "and says nothing of the layer; indentation goes with 1/E, so that E is the "
        "case's, times predicted over measured indentation",
        "", "");
  const calibration::CaseCalibration result =
      calibration::calibrate_case(contact_case, table, request);
  for (const std::string& line : result.remarks) remark(line);
  // The text on standard output says it, too.
  if (options.json && !result.unit_doubt.empty()) remark(result.unit_doubt);

  std::vector<std::pair<std::filesystem::path, std::string>> files;
  if (!options.output.empty())
    files.push_back({options.output, calibration::fitted_case_text(result, options.output)});
  if (!options.page.empty()) {
    nlohmann::json data = calibration::page_data(result, data_text);
    data["provenance"] = {{"version", system::program_version()},
                          {"date", system::utc_now()},
                          {"command", options.command_line}};
    files.push_back({options.page, report::render_calibration(data)});
  }
  system::write_files_together(files);
  if (!options.output.empty()) remark("the fitted case is " + options.output);
  if (!options.page.empty()) remark("the page is " + options.page);
  if (options.json)
    system::write_to_stdout(text::printed(calibration::to_json(result)));
  else
    system::write_text_to_stdout(calibration::describe(result));
  return 0;
}

}  // namespace

void add_calibrate(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<CalibrateOptions>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "Modulus, thickness and friction of a fingertip from measured contacts, with intervals");
  command
      ->add_option("DATA", options->data,
                   "measurements (CSV), the name of a built-in file, or - for standard input")
      ->required();
  command
      ->add_option("CASE", options->case_file,
                   "case file (TOML) with the geometry and starting values, the name of a "
                   "built-in case, or - for standard input")
      ->required();
  add_settings(*command, options->settings, "case");
  command->add_option("--fix", options->fixed,
                      "key=value in place of the case's own, not fitted: poisson_ratio=0.49, "
                      "thickness_mm=3, youngs_modulus_kPa, radius_mm, friction_coefficient, "
                      "shear_strength_kPa, zero_mm, compliance_mm_per_N or mount_N_per_mm of the "
                      "machine; may be repeated");
  command->add_option(
      "--fit", options->fit,
      "what to find, separated by commas: youngs_modulus, thickness, "
      "poisson_ratio, radius, friction_coefficient, shear_strength, zero (of the "
      "indentation, also zero_mm), compliance (of machine and mount, also "
      "compliance_mm_per_N); default: the first two, and where friction was "
      "measured those of the case's shear law; of position_mm alone E and the zero");
  command->add_option("--hold-out-above", options->hold_out_above,
                      "part of the largest load above which values are kept from the fit and then "
                      "predicted, with the band of 95 %; default: 1, none are");
  command
      ->add_option("--at-load", options->at_loads_N,
                   "N, or several separated by commas: also predict what was measured at these "
                   "loads, with the band")
      ->delimiter(',');
  command->add_flag("--force", options->force,
                    "calibrate also where the curve is not that of a solid finger");
  command->add_option("--model,--models", options->model,
                      "fingertip_layer (default), bonded_layer, winkler or hertz");
  command->add_option("-o,--output", options->output,
                      "file (TOML) for the case with what was found, for the other commands");
  command->add_option("--page", options->page,
                      "file (HTML) with data, fit, residuals, confidence and comparison of models");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "DATA begins with a line of column names: load_N, and any of a_mm or a_m, b_mm or b_m\n"
      "(semi-axes), area_mm2 or area_m2, indentation_mm or indentation_m (of the "
      "bodies),\n"
      "max_torque_mNm or max_torque_Nm (about the normal, at slip), tangential_force_N (at slip).\n"
      "In place of indentation_mm there may be position_mm, a machine's reading: its zero is then\n"
      "fitted, and rows with a load or position of 0 or less are skipped. Where the indentation "
      "rises "
      "and falls\n"
      "again, loading is fitted; backlash and hysteresis are named.\n"
      "Each may have its standard deviation in a column of the same name with _std. Cells may be\n"
      "empty. Values without an error get one from their scatter about the fit. Lines that begin\n"
      "with # are skipped. At most 1000 rows and 1 MiB.\n"
      "Or time_s and load_N, the force while the finger stands still: shares and times of\n"
      "[layer] relaxation are found, at most three, and what the data cannot tell.\n"
      "An interval holds the truth in 95 % of all cases, if the model is right. A parameter is\n"
      "determined where its interval spans less than a factor of two. Areas come from ink prints\n"
      "by `softfinger area`.\n"
      "Samples:\n"
      "  softfinger calibrate inked_fingertip.csv silicone_pad_2mm\n"
      "  softfinger calibrate inked_fingertip.csv silicone_pad_2mm --output fitted.toml --page "
      "fit.html\n"
      "  softfinger calibrate inked_fingertip.csv silicone_pad_2mm --fix thickness_mm=2 --fit "
      "youngs_modulus,poisson_ratio,friction_coefficient --json\n"
      "  softfinger calibrate inked_fingertip.csv silicone_pad_2mm --hold-out-above 0.5");
  command->callback([options, &action] { action = [options] { return run_calibrate(*options); }; });
}

}  // namespace softfinger::commands
