#include "comparisons/calibration/calibration_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/input/measured_silicones.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/calibration/statistics.h"

namespace softfinger::calibration {
namespace {

using nlohmann::json;

std::string name_of(Parameter parameter) { return std::string(range_of(parameter).name); }
std::string name_of(MeasuredQuantity quantity) {
  return std::string(kMeasuredQuantityNames[std::size_t(quantity)]);
}

struct Unit {
  const char* name;
  double per_SI;
};
Unit unit_of(Parameter parameter) {
  const std::string_view unit = range_of(parameter).unit;
  if (unit == "m") return {"mm", 1e3};
  if (unit == "Pa") return {"kPa", 1e-3};
  if (unit == "m/N") return {"mm/N", 1e3};
  return {"", 1};
}
Unit unit_of(MeasuredQuantity quantity) {
  switch (quantity) {
    case MeasuredQuantity::area:
      return {"mm²", 1e6};
    case MeasuredQuantity::max_torque:
      return {"mN·m", 1e3};
    case MeasuredQuantity::tangential_force:
      return {"N", 1};
    default:
      return {"mm", 1e3};
  }
}

/// "312 kPa"
template <class Kind>
std::string in_words(Kind kind, double value) {
  const Unit unit = unit_of(kind);
  return fmt::format("{:.4g}{}{}", value * unit.per_SI, *unit.name ? " " : "", unit.name);
}

std::string words(MeasuredQuantity quantity) {
  switch (quantity) {
    case MeasuredQuantity::a:
      return "a";
    case MeasuredQuantity::b:
      return "b";
    case MeasuredQuantity::area:
      return "the area";
    case MeasuredQuantity::indentation:
      return "the indentation";
    case MeasuredQuantity::max_torque:
      return "the largest torque";
    case MeasuredQuantity::tangential_force:
      return "the tangential force at slip";
  }
  return {};
}

std::string words(Parameter parameter) {
  switch (parameter) {
    case Parameter::youngs_modulus:
      return "Young's modulus E";
    case Parameter::thickness:
      return "the thickness h";
    case Parameter::poisson_ratio:
      return "Poisson's ratio nu";
    case Parameter::radius:
      return "the radius R";
    case Parameter::friction_coefficient:
      return "the friction coefficient mu";
    case Parameter::shear_strength:
      return "the shear strength tau_0";
    case Parameter::zero:
      return "the zero of the indentation";
    case Parameter::compliance:
      return "the compliance of machine and mount";
    default:
      return name_of(parameter);
  }
}

double load_of(const CaseCalibration& calibration, std::size_t value) {
  return calibration.table.loads_N[calibration.table.values[value].contact];
}

double std_of(const CaseCalibration& calibration, std::size_t value) {
  const Weight& weight = calibration.found.weights[value];
  return weight.is_relative ? weight.std * calibration.found.predicted[value] : weight.std;
}

std::size_t counted(const CaseCalibration& calibration) {
  return calibration.table.values.size() - calibration.found.outliers.size();
}

std::string percent(double part) { return fmt::format("{:.2g} %", 100 * part); }

bool has_scatter(const Calibration& found) {
  return *std::max_element(found.scatter.begin(), found.scatter.end()) > 0;
}

std::string scatter_sentence(const Calibration& found) {
  if (!has_scatter(found)) return {};
  std::vector<std::string> scatters;
  double least = INFINITY, largest = 0;
  for (std::size_t i = 0; i < kMeasuredQuantities; ++i) {
    if (found.scatter[i] == 0) continue;
    scatters.push_back(words(MeasuredQuantity(i)) + " by " + percent(found.scatter[i]));
    least = std::min(least, found.scatter[i]);
    largest = std::max(largest, found.scatter[i]);
  }
  return "Values without an error of their own scatter about the fit, " +
         (largest == least ? "by " + percent(least) : text::joined(scatters)) +
         "; this was taken as their standard deviation.";
}

bool has_own_errors(const CaseCalibration& calibration) {
  return std::any_of(calibration.table.values.begin(), calibration.table.values.end(),
                     [](const Measurement& value) { return value.std > 0; });
}

std::string goodness_sentence(const CaseCalibration& calibration) {
  const Calibration& found = calibration.found;
  std::string scatter = scatter_sentence(found);
  if (!has_own_errors(calibration)) return scatter;
  if (!scatter.empty()) scatter = " " + scatter;
  if (found.error_factor > 1)
    return fmt::format(
               "The stated errors are too small for this fit, by a factor of {:.3g}: they were "
               "multiplied by it. Chance makes fits this bad with a probability of {:.2g}; see "
               "whether another model fits better.",
               found.error_factor, found.goodness) +
           scatter;
  return fmt::format(
             "The fit agrees with the stated errors: chance makes worse ones with a probability of "
             "{:.0f} %.",
             100 * found.goodness) +
         scatter;
}

std::string outlier_sentence(const CaseCalibration& calibration, std::size_t value) {
  const Measurement& measurement = calibration.table.values[value];
  return fmt::format(
      "Left out as an outlier: {} at {:g} N (line {}), {} where the fit to the "
      "others has {}, {:.1f} standard deviations off.",
      words(measurement.quantity), load_of(calibration, value), calibration.table.lines[value],
      in_words(measurement.quantity, measurement.value),
      in_words(measurement.quantity, calibration.found.predicted[value]),
      std::abs(calibration.found.deviation[value]));
}

/// Whether a standard deviation says anything: of nu half its range does not.
bool is_informative(Parameter parameter, double std, double value) {
  if (range_of(parameter).is_nuisance) return std::isfinite(std);
  return range_of(parameter).logarithmic ? std < 2 * value : std < 0.25;
}

std::string next_sentence(const NextMeasurement& next) {
  if (!next.exists)
    return "No single further measurement would help much; repeat those that are there.";
  const bool relative = range_of(next.parameter).logarithmic;
  const auto error = [&](double std) {
    return !is_informative(next.parameter, std, 1) ? std::string("not known at all")
           : relative                              ? percent(std)
                                                   : fmt::format("{:.2g}", std);
  };
  const std::string what = next.is_thickness
                               ? std::string("the thickness itself, with a caliper")
                               : fmt::format("{} at {:.3g} N", words(next.quantity), next.load_N);
  return fmt::format(
      "The one measurement that would help most: {}, to {}. The standard deviation of {} would go "
      "from {} to {}.",
      what, percent(next.relative_std), words(next.parameter), error(next.std_now),
      error(next.std_then));
}

std::string geometry_sentence(const CaseCalibration& calibration) {
  if (calibration.geometry_rounds == 1) return {};
  return fmt::format(
      "The radii of the mesh depend on the contact's size: fit and geometry were repeated {} "
      "times{}.",
      calibration.geometry_rounds,
      calibration.is_geometry_settled ? ", until they agreed"
                                      : " and still do not agree; the parameters' last digits mean "
                                        "nothing");
}

/// Warns where the compression comes near the limit of LeastSquares, which then affects the
/// numbers; else empty.
std::string compression_sentence(const CaseCalibration& calibration) {
  const CalibrationProblem& problem = calibration.problem;
  if (!contains(problem.free, Parameter::thickness)) return {};
  const double compression = std::exp(PredictedMeasurements{*problem.model, problem.measurements,
                                                            problem.shear_law, problem.pressing}
                                          .log_compression(calibration.found.values, nullptr));
  if (!(compression > 0.8 * kMostCompression)) return {};
  return fmt::format(
      "At {:g} N this layer is pressed together by {:.0f} %. The models are not trusted beyond "
      "{:.0f} "
      "%, and thinner layers were ruled out for that reason alone.",
      calibration.table.loads_N.back(), 100 * compression, 100 * kMostCompression);
}

std::string growth_sentence(const GrowthExponent& growth) {
  if (!growth.is_known) return {};
  return fmt::format("The contact's width grows as P^({:.3f} ± {:.3f}).", growth.value, growth.std);
}

/// The sentence that names the fitted branch and what the other one says; empty where there is one
/// branch only.
std::string branches_sentence(const CaseCalibration& calibration) {
  if (!calibration.branches) return {};
  const MeasuredBranches& branches = *calibration.branches;
  std::string out = fmt::format("The {} values of loading are used, the {} of unloading are not.",
                                branches.loading, branches.unloading);
  if (!branches.loop.is_known) return out;
  const Loop& loop = branches.loop;
  return out + fmt::format(
                   " Backlash {:.2g} mm, hysteresis {:.2g} % of the work; at equal force the "
                   "unloading lies {:+.2g}, {:+.2g}, {:+.2g} mm off the loading (10, 50, 90 % of "
                   "the largest load).",
                   1e3 * loop.backlash_m, 100 * loop.hysteresis_share, 1e3 * loop.shift_m[0],
                   1e3 * loop.shift_m[1], 1e3 * loop.shift_m[2]);
}

/// Silicones with such a modulus in tension; empty where E was not found or none is like that.
std::string silicone_sentence(const CaseCalibration& calibration) {
  const ParameterEstimate* const modulus = calibration.estimate(Parameter::youngs_modulus);
  if (!modulus || !modulus->is_determined()) return {};
  constexpr std::size_t kMostNamed = 3;
  std::vector<std::string> named;
  for (const input::MeasuredSilicone* silicone : input::silicones_like(modulus->value))
    if (named.size() < kMostNamed)
      named.push_back(fmt::format("{} ({:g} to {:g} kPa)", silicone->name, silicone->low_kPa(),
                                  silicone->high_kPa()));
  if (named.empty()) return {};
  return "Silicones with such a modulus in tension: " + text::joined(named) +
         "; a hardness overestimates it.";
}

/// Warns where a fitted mount explains most of the travel; else empty.
std::string mount_sentence(const CaseCalibration& calibration) {
  const ParameterEstimate* const compliance = calibration.estimate(Parameter::compliance);
  if (!compliance) return {};
  const double given_m = compliance->value * calibration.table.loads_N.back();
  double largest_m = 0;
  for (const Measurement& value : calibration.table.values)
    if (value.quantity == MeasuredQuantity::indentation)
      largest_m = std::max(largest_m, value.value);
  const double share = given_m / (largest_m - calibration.found.values[index_of(Parameter::zero)]);
  if (!(share > 0.5)) return {};
  return fmt::format(
      "Machine and mount would take {:.0f} % of the travel at the largest load: is the finger "
      "hollow? Press something rigid to know what they give, and --fix mount_N_per_mm.",
      100 * share);
}

std::size_t inside_count(const std::vector<ForecastValue>& values) {
  return std::size_t(std::count_if(values.begin(), values.end(), [](const ForecastValue& value) {
    return value.forecast.is_known && value.is_inside();
  }));
}

/// "Kept from the fit: 12 values above 3 N; 12 of them lie in the band, worst ...".
std::string held_out_sentence(const CaseCalibration& calibration) {
  const std::vector<ForecastValue>& held = calibration.held_out;
  if (held.empty()) return {};
  double worst = 0;
  for (const ForecastValue& value : held)
    worst = std::max(worst, std::abs(value.forecast.value / *value.measured - 1));
  return fmt::format(
      "Kept from the fit: {} values above {:.4g} N; {} of them lie in the band that was predicted "
      "(chance and the model's misfit, 95 %), the worst is {} off.",
      held.size(), calibration.held_out_above_N, inside_count(held), percent(worst));
}

std::string forecast_table(const std::vector<ForecastValue>& values) {
  if (values.empty()) return {};
  std::string out = fmt::format("\n  {:<22}{:>8}{:>14}{:>22}{:>12}\n", "predicted", "N", "value",
                                "band", "measured");
  for (const ForecastValue& value : values) {
    const Forecast& forecast = value.forecast;
    const Unit unit = unit_of(value.quantity);
    const auto number = [&](double si) { return fmt::format("{:.4g}", si * unit.per_SI); };
    out += fmt::format(
        "  {:<22}{:>8.4g}{:>14}{:>22}{:>12}{}\n", name_of(value.quantity), value.load_N,
        forecast.is_known ? in_words(value.quantity, forecast.value) : "not known",
        forecast.is_known ? number(forecast.low()) + " to " + number(forecast.high()) : "",
        value.measured ? number(*value.measured) : "",
        value.measured && forecast.is_known && !value.is_inside() ? "   outside" : "");
  }
  return out;
}

/// "It grows", "No"; sentences of the library begin with small letters and have no full stop.
std::string as_sentence(std::string text) {
  // "E", "nu" and "mu" are symbols.
  if (text.rfind("nu ", 0) != 0 && text.rfind("mu ", 0) != 0 && text.rfind("tau_0 ", 0) != 0)
    text[0] = char(std::toupper(static_cast<unsigned char>(text[0])));
  return text + ".";
}

json estimate_json(const ParameterEstimate& estimate) {
  return {{"value", estimate.value},
          {"std", text::finite_or_null(estimate.std)},
          {"interval95", {estimate.low, estimate.high}},
          {"interval_open", {estimate.is_low_open, estimate.is_high_open}},
          {"determined", estimate.is_determined()}};
}

json covariance_json(const CaseCalibration& calibration) {
  const Calibration& found = calibration.found;
  if (found.covariance.size() == 0) return nullptr;
  const std::vector<Parameter>& free = calibration.problem.free;
  const auto scale = [&](Parameter parameter) {
    return range_of(parameter).logarithmic ? found.values[index_of(parameter)] : 1;
  };
  json rows = json::object();
  for (std::size_t i = 0; i < free.size(); ++i)
    for (std::size_t k = 0; k < free.size(); ++k)
      rows[name_of(free[i])][name_of(free[k])] = text::finite_or_null(
          found.covariance(Eigen::Index(i), Eigen::Index(k)) * scale(free[i]) * scale(free[k]));
  return rows;
}

json comparison_json(const Comparison& comparison, const char* key, const std::string& name) {
  json parameters = json::object();
  for (const Parameter parameter : comparison.free)
    parameters[name_of(parameter)] = comparison.values[index_of(parameter)];
  return {{key, name},
          {"aic", text::finite_or_null(comparison.aic)},
          {"held_out_error", text::finite_or_null(comparison.held_out_error)},
          {"scatter", comparison.scatter},
          {"parameters", parameters}};
}

json branches_json(const CaseCalibration& calibration) {
  if (!calibration.branches) return nullptr;
  const MeasuredBranches& branches = *calibration.branches;
  const Loop& loop = branches.loop;
  return {{"loading", branches.loading},
          {"unloading", branches.unloading},
          {"backlash_m", loop.is_known ? json(loop.backlash_m) : json()},
          {"hysteresis_share", loop.is_known ? json(loop.hysteresis_share) : json()},
          {"shift_m", loop.is_known ? json(loop.shift_m) : json()}};
}

json forecast_json(const std::vector<ForecastValue>& values) {
  json rows = json::array();
  for (const ForecastValue& value : values) {
    const Forecast& forecast = value.forecast;
    const auto known = [&](double number) {
      return forecast.is_known ? text::finite_or_null(number) : json();
    };
    rows.push_back({{"load_N", value.load_N},
                    {"quantity", name_of(value.quantity)},
                    {"predicted", known(forecast.value)},
                    {"band95", {known(forecast.low()), known(forecast.high())}},
                    {"chance", known(forecast.chance)},
                    {"misfit", known(forecast.misfit)}});
    if (!value.measured) continue;
    rows.back()["measured"] = *value.measured;
    rows.back()["line"] = value.line;
    rows.back()["inside"] = forecast.is_known ? json(value.is_inside()) : json();
  }
  return rows;
}

json next_json(const NextMeasurement& next) {
  if (!next.exists) return nullptr;
  return {{"sentence", next_sentence(next)},
          {"quantity", next.is_thickness ? "thickness" : name_of(next.quantity)},
          {"load_N", next.is_thickness ? json() : json(next.load_N)},
          {"relative_std", next.relative_std},
          {"parameter", name_of(next.parameter)},
          {"std_now", text::finite_or_null(next.std_now)},
          {"std_then", text::finite_or_null(next.std_then)}};
}

/// The parameters of the case that were not looked for.
std::vector<Parameter> known_parameters(const CaseCalibration& calibration) {
  const ShearLaw& law = calibration.fitted.shear_law;
  std::vector<Parameter> known;
  for (const Parameter parameter :
       {Parameter::youngs_modulus, Parameter::thickness, Parameter::poisson_ratio,
        Parameter::radius, Parameter::friction_coefficient, Parameter::shear_strength,
        Parameter::zero, Parameter::compliance})
    if (!calibration.estimate(parameter) &&
        (!range_of(parameter).is_nuisance || calibration.found.values[index_of(parameter)] != 0) &&
        (parameter != Parameter::friction_coefficient || law.has_friction_coefficient()) &&
        (parameter != Parameter::shear_strength || law.has_shear_strength()))
      known.push_back(parameter);
  return known;
}

/// "27 values at 8 loads, 0.2 to 10 N, fitted with fingertip_layer; 1 of them left out".
std::string headline(const CaseCalibration& calibration) {
  const std::size_t outliers = calibration.found.outliers.size();
  const std::vector<double>& loads_N = calibration.table.loads_N;
  return fmt::format("{} values at {} loads, {:g} to {:g} N, fitted with {}{}",
                     calibration.table.values.size(), loads_N.size(), loads_N.front(),
                     loads_N.back(), calibration.problem.model->card().name,
                     outliers == 0 ? "" : fmt::format("; {} of them left out", outliers));
}

/// "304 to 321 kPa", "above 1.3 mm", "any".
std::string interval_text(const ParameterEstimate& estimate) {
  if (estimate.is_low_open && estimate.is_high_open) return "any";
  const Unit unit = unit_of(estimate.parameter);
  const auto number = [&](double value) { return fmt::format("{:.4g}", value * unit.per_SI); };
  const std::string end = *unit.name ? std::string(" ") + unit.name : "";
  if (estimate.is_high_open) return "above " + number(estimate.low) + end;
  if (estimate.is_low_open) return "below " + number(estimate.high) + end;
  return number(estimate.low) + " to " + number(estimate.high) + end;
}

std::string parameter_table(const CaseCalibration& calibration) {
  std::string out = fmt::format("  {:<22}{:>16}{:>14}   {}\n", "", "value", "std", "95 % interval");
  for (const ParameterEstimate& estimate : calibration.found.parameters) {
    const Parameter parameter = estimate.parameter;
    out +=
        fmt::format("  {:<22}{:>16}{:>14}   {}{}\n", range_of(parameter).name,
                    in_words(parameter, estimate.value),
                    is_informative(parameter, estimate.std, estimate.value)
                        ? fmt::format("{:.2g}", estimate.std * unit_of(parameter).per_SI)
                        : "not known",
                    interval_text(estimate), estimate.is_determined() ? "" : "   not determined");
  }
  for (const Parameter parameter : known_parameters(calibration))
    out += fmt::format("  {:<22}{:>16}{:>14}   taken as known\n", range_of(parameter).name,
                       in_words(parameter, calibration.found.values[index_of(parameter)]), "");
  return out;
}

std::string model_table(const std::vector<Comparison>& comparisons, bool laws) {
  std::string out = fmt::format("  {:<18}{:>8}{:>10}{:>32}\n", laws ? "shear law" : "model", "AIC",
                                "scatter", "upper third of loads, off by");
  for (const Comparison& comparison : comparisons)
    out += fmt::format("  {:<18}{:>8}{:>10}{:>32}\n",
                       laws ? std::string(ShearLaw{comparison.shear_law}.name())
                            : std::string(comparison.model->card().name),
                       fmt::format("+{:.1f}", comparison.aic - comparisons.front().aic),
                       percent(comparison.scatter),
                       std::isfinite(comparison.held_out_error) ? percent(comparison.held_out_error)
                                                                : "not known");
  return out;
}

/// Meaning of the calibration, one sentence for each aspect.
std::vector<std::string> sentences(const CaseCalibration& calibration) {
  std::vector<std::string> result = {branches_sentence(calibration), goodness_sentence(calibration),
                                     mount_sentence(calibration), held_out_sentence(calibration)};
  if (calibration.exponent_doubt.exists)
    result.push_back(
        "Not the curve of a solid finger: " + exponent_sentence(calibration.exponent_doubt) + ".");
  for (const std::size_t outlier : calibration.found.outliers)
    result.push_back(outlier_sentence(calibration, outlier));
  result.push_back(geometry_sentence(calibration));
  result.push_back(compression_sentence(calibration));
  result.push_back(growth_sentence(calibration.growth));
  result.push_back(silicone_sentence(calibration));
  result.erase(std::remove(result.begin(), result.end(), std::string()), result.end());
  return result;
}

}  // namespace

/// "youngs_modulus 556.2 kPa (498.2 to 615.6 kPa), thickness ..."
std::string answer_line(const CaseCalibration& calibration) {
  std::string out;
  for (const ParameterEstimate& estimate : calibration.found.parameters) {
    const Unit unit = unit_of(estimate.parameter);
    out += fmt::format("{}{} {:.4g}{}{} ({}{})", out.empty() ? "" : ", ",
                       range_of(estimate.parameter).name, estimate.value * unit.per_SI,
                       *unit.name ? " " : "", unit.name,
                       estimate.is_determined() ? "" : "NOT DETERMINED: ", interval_text(estimate));
  }
  return out + "\n";
}

std::string describe(const CaseCalibration& calibration) {
  std::string out =
      answer_line(calibration) + calibration.fitted.id + ": " + headline(calibration) + "\n";
  if (!calibration.unit_doubt.empty()) out += calibration.unit_doubt + "\n";
  out += "\n" + parameter_table(calibration) + "\n";
  for (const std::string& sentence : sentences(calibration)) out += sentence + "\n";
  if (calibration.cannot_tell.empty())
    out += "The data determine every parameter to better than a factor of two.\n";
  else
    out += "What these data cannot tell:\n";
  for (const std::string& sentence : calibration.cannot_tell)
    out += "  " + as_sentence(sentence) + "\n";
  out += next_sentence(calibration.next) + "\n";
  out += forecast_table(calibration.held_out) + forecast_table(calibration.forecasts);
  out += "\nModels on the same data, best first (AIC above the best; 2 is little, 10 is much):\n" +
         model_table(calibration.models, false);
  if (!calibration.shear_laws.empty()) out += "\n" + model_table(calibration.shear_laws, true);
  return out;
}

nlohmann::json to_json(const CaseCalibration& calibration) {
  const Calibration& found = calibration.found;
  json parameters = json::object(), fixed = json::object();
  for (const ParameterEstimate& estimate : found.parameters)
    parameters[name_of(estimate.parameter)] = estimate_json(estimate);
  for (const Parameter parameter : known_parameters(calibration))
    fixed[name_of(parameter)] = found.values[index_of(parameter)];

  json residuals = json::array(), outliers = json::array();
  for (std::size_t i = 0; i < calibration.table.values.size(); ++i) {
    const Measurement& measurement = calibration.table.values[i];
    residuals.push_back({{"load_N", load_of(calibration, i)},
                         {"quantity", name_of(measurement.quantity)},
                         {"line", calibration.table.lines[i]},
                         {"measured", measurement.value},
                         {"std", text::finite_or_null(std_of(calibration, i))},
                         {"std_given", measurement.std > 0},
                         {"predicted", text::finite_or_null(found.predicted[i])},
                         {"sigma", text::finite_or_null(found.deviation[i])},
                         {"outlier", found.is_outlier(i)}});
    if (!found.is_outlier(i)) continue;
    outliers.push_back(residuals.back());
    outliers.back()["sentence"] = outlier_sentence(calibration, i);
  }
  json scatter = json::object();
  for (std::size_t i = 0; i < kMeasuredQuantities; ++i)
    if (found.scatter[i] > 0) scatter[name_of(MeasuredQuantity(i))] = found.scatter[i];
  json models = json::array(), laws = json::array();
  for (const Comparison& comparison : calibration.models)
    models.push_back(
        comparison_json(comparison, "model", std::string(comparison.model->card().name)));
  for (const Comparison& comparison : calibration.shear_laws)
    laws.push_back(comparison_json(comparison, "shear_law", ShearLaw{comparison.shear_law}.name()));
  json cannot_tell = json::array();
  for (const std::string& sentence : calibration.cannot_tell)
    cannot_tell.push_back(as_sentence(sentence));
  const GrowthExponent& growth = calibration.growth;
  return {
      {"case", calibration.fitted.id},
      {"data", calibration.table.file},
      {"model", calibration.problem.model->card().name},
      {"shear_law", calibration.fitted.shear_law.name()},
      {"parameters", parameters},
      {"fixed", fixed},
      {"covariance", covariance_json(calibration)},
      {"unit_doubt", calibration.unit_doubt.empty() ? json() : json(calibration.unit_doubt)},
      {"branches", branches_json(calibration)},
      {"held_out", forecast_json(calibration.held_out)},
      {"forecasts", forecast_json(calibration.forecasts)},
      {"exponent_doubt", calibration.exponent_doubt.exists
                             ? json(exponent_sentence(calibration.exponent_doubt))
                             : json()},
      {"cannot_tell", cannot_tell},
      {"next_measurement", next_json(calibration.next)},
      {"models", models},
      {"shear_laws", laws},
      {"outliers", outliers},
      {"residuals", residuals},
      {"goodness",
       {{"sentence", goodness_sentence(calibration)},
        {"probability", has_own_errors(calibration) ? json(found.goodness) : json()},
        {"error_factor", found.error_factor},
        {"sum_of_squares", found.sum_of_squares},
        {"degrees_of_freedom", int(counted(calibration)) - int(calibration.problem.free.size())},
        {"scatter", scatter}}},
      {"growth_exponent",
       growth.is_known ? json({{"value", growth.value}, {"std", growth.std}}) : json()},
      {"geometry_rounds", calibration.geometry_rounds},
      {"geometry_settled", calibration.is_geometry_settled}};
}

nlohmann::json page_data(const CaseCalibration& calibration, const std::string& data_text) {
  json result = to_json(calibration);
  json curves = json::array(), ellipses = json::array();
  const auto numbers = [](const std::vector<double>& values) {
    json list = json::array();
    for (const double value : values) list.push_back(text::finite_or_null(value));
    return list;
  };
  for (const FittedCurve& curve : fitted_curves(calibration))
    curves.push_back({{"quantity", name_of(curve.quantity)},
                      {"load_N", numbers(curve.loads_N)},
                      {"value", numbers(curve.value)},
                      {"low", numbers(curve.low)},
                      {"high", numbers(curve.high)}});
  for (const ConfidenceEllipse& ellipse : confidence_ellipses(calibration)) {
    json points = json::array();
    for (const auto& [x, y] : ellipse.points) points.push_back({x, y});
    ellipses.push_back({{"x", name_of(ellipse.x)}, {"y", name_of(ellipse.y)}, {"points", points}});
  }
  result["curves"] = curves;
  result["ellipses"] = ellipses;
  std::vector<std::string> all = sentences(calibration);
  if (!calibration.unit_doubt.empty()) all.insert(all.begin(), calibration.unit_doubt);
  result["sentences"] = all;
  result["next_sentence"] = next_sentence(calibration.next);
  result["description"] = headline(calibration);
  result["question"] = calibration.fitted.question;
  result["data_csv"] = data_text;
  return result;
}

}  // namespace softfinger::calibration
