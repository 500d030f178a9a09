#include "comparisons/calibration/case_calibration.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>

#include "comparisons/calibration/unit_doubt.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/calibration/statistics.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::calibration {
namespace {

bool has_mesh(const input::Case& contact_case) {
  const auto* pair = std::get_if<input::BodyPair>(&contact_case.geometry);
  return pair && (std::holds_alternative<input::MeshBody>(pair->finger) ||
                  std::holds_alternative<input::MeshBody>(pair->object));
}

bool is_of_friction(Parameter parameter) {
  return parameter == Parameter::friction_coefficient || parameter == Parameter::shear_strength;
}

std::vector<Parameter> default_parameters(const Request& request, const input::Case& contact_case,
                                          const input::MeasurementTable& table,
                                          bool measures_friction) {
  std::vector<Parameter> free = {Parameter::youngs_modulus};
  // A travel from an unknown zero tells a modulus, and seldom a thickness besides.
  const bool is_curve_alone =
      table.has_unknown_zero &&
      std::all_of(table.values.begin(), table.values.end(), [](const Measurement& value) {
        return value.quantity == MeasuredQuantity::indentation;
      });
  if (request.model->card().layer_constants == LayerConstants::all && !is_curve_alone)
    free.push_back(Parameter::thickness);
  if (table.has_unknown_zero) free.push_back(Parameter::zero);
  if (measures_friction) {
    if (contact_case.shear_law.has_friction_coefficient())
      free.push_back(Parameter::friction_coefficient);
    if (contact_case.shear_law.has_shear_strength()) free.push_back(Parameter::shear_strength);
  }
  return free;
}

std::vector<Parameter> free_parameters(const Request& request, const input::Case& contact_case,
                                       const input::MeasurementTable& table) {
  const bool measures_friction =
      std::any_of(table.values.begin(), table.values.end(),
                  [](const Measurement& value) { return is_frictional(value.quantity); });
  const bool measures_travel = std::any_of(
      table.values.begin(), table.values.end(),
      [](const Measurement& value) { return value.quantity == MeasuredQuantity::indentation; });
  std::vector<Parameter> free = request.fit;
  if (free.empty()) free = default_parameters(request, contact_case, table, measures_friction);
  const auto refuse = [](const char* option, Parameter parameter, const std::string& allowed) {
    throw InputError("command line", option, std::string(range_of(parameter).name), allowed);
  };
  const auto require_in_case = [&](const char* option, Parameter parameter) {
    const ShearLaw& law = contact_case.shear_law;
    if ((parameter == Parameter::friction_coefficient && !law.has_friction_coefficient()) ||
        (parameter == Parameter::shear_strength && !law.has_shear_strength()))
      refuse(option, parameter,
             fmt::format("a case whose shear law has it; its law is {}", law.name()));
    if (parameter == Parameter::radius && has_mesh(contact_case))
      refuse(option, parameter, "a case without meshes: their radii are those of the surface");
  };
  for (const Parameter parameter : free) {
    require_in_case("--fit", parameter);
    if (is_of_friction(parameter) && !measures_friction)
      refuse("--fit", parameter, "max_torque or tangential_force among the measurements");
    if (range_of(parameter).is_nuisance && !measures_travel)
      refuse("--fit", parameter, "indentation_mm or position_mm among the measurements");
  }
  for (const auto& fixed : request.fixed) {
    const Parameter parameter = fixed.first;
    require_in_case("--fix", parameter);
    if (contains(request.fit, parameter))
      refuse("--fit", parameter, "either --fit or --fix of a parameter");
    free.erase(std::remove(free.begin(), free.end(), parameter), free.end());
  }
  if (free.empty())
    throw InputError("command line", "--fix", "every parameter", "at least one left to fit");
  if (table.values.size() <= free.size()) {
    std::vector<std::string> names;
    for (const Parameter parameter : free) names.emplace_back(range_of(parameter).name);
    throw InputError(table.file, "number of measured values", std::to_string(table.values.size()),
                     fmt::format("more than the {} parameters to find ({}); --fit chooses fewer",
                                 free.size(), text::joined(names)));
  }
  return free;
}

ParameterValues starting_values(const input::Case& contact_case, const RelativeRadii& radii,
                                const Request& request) {
  // A guess where the case has none; the search leaves it at once.
  constexpr double kStrength_Pa = 2e4, kCoefficient_m = 2e-3, kExponent = 0.3,
                   kCompliance_m_per_N = 5e-5;
  ParameterValues start{};
  const auto set = [&](Parameter parameter, double value) { start[index_of(parameter)] = value; };
  const ShearLaw& law = contact_case.shear_law;
  const PowerLaw& power_law = contact_case.options.power_law;
  set(Parameter::youngs_modulus, contact_case.layer.youngs_modulus_Pa);
  set(Parameter::thickness, contact_case.layer.thickness_m);
  set(Parameter::poisson_ratio, contact_case.layer.poisson_ratio);
  set(Parameter::radius, std::sqrt(radii.major_m) * std::sqrt(radii.minor_m));
  set(Parameter::friction_coefficient,
      law.has_friction_coefficient() ? std::max(1e-3, law.friction_coefficient) : 0.5);
  set(Parameter::shear_strength,
      law.has_shear_strength() ? std::max(1., law.shear_strength_Pa) : kStrength_Pa);
  const bool has_power_law = power_law.radius_coefficient > 0;
  set(Parameter::radius_coefficient, has_power_law ? power_law.radius_coefficient : kCoefficient_m);
  set(Parameter::radius_exponent, has_power_law ? power_law.radius_exponent : kExponent);
  if (contains(request.fit, Parameter::compliance)) set(Parameter::compliance, kCompliance_m_per_N);
  for (const auto& [parameter, value] : request.fixed) set(parameter, value);
  return start;
}

/// The case with these parameters; the radius is left to `fitted_case_text`.
void put_into(input::Case& contact_case, const ParameterValues& values) {
  const auto value = [&](Parameter parameter) { return values[index_of(parameter)]; };
  contact_case.layer = {value(Parameter::thickness), value(Parameter::youngs_modulus),
                        value(Parameter::poisson_ratio)};
  ShearLaw& law = contact_case.shear_law;
  if (law.has_friction_coefficient())
    law.friction_coefficient = value(Parameter::friction_coefficient);
  if (law.has_shear_strength()) law.shear_strength_Pa = value(Parameter::shear_strength);
}

/// Largest change of a parameter between two fits, relative to what is known of it: the smaller of
/// its interval's width and its magnitude.
double largest_move(const Calibration& before, const Calibration& now) {
  double largest = 0;
  for (std::size_t i = 0; i < now.parameters.size(); ++i) {
    const ParameterEstimate& one = before.parameters[i];
    const ParameterEstimate& other = now.parameters[i];
    const double known = std::min(other.high - other.low, std::abs(other.value));
    largest = std::max(largest, std::abs(other.value - one.value) / std::max(known, 1e-12));
  }
  return largest;
}

bool is_in_range(Parameter parameter, double at) {
  return at >= coordinate(parameter, range_of(parameter).lowest) &&
         at <= coordinate(parameter, range_of(parameter).highest);
}

ContactProblem contact_at(const CaseCalibration& calibration,
                          const prediction::GeometryResolver& resolver, double load_N) {
  ContactProblem problem = contact_problem(calibration.fitted, resolver.resolve(load_N), load_N);
  problem.options.power_law = {};
  return problem;
}

/// Values of the loading branch; notes what the other one says.
input::MeasurementTable loading_branch(const input::MeasurementTable& table,
                                       std::optional<MeasuredBranches>& branches) {
  std::vector<double> travel_m;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    if (table.values[i].quantity != MeasuredQuantity::indentation) continue;
    travel_m.push_back(table.values[i].value);
    rows.push_back(i);
  }
  const std::size_t turn = first_unloading_row(travel_m);
  if (turn == travel_m.size()) return table;
  PressCurve loading, unloading;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    PressCurve& branch = i < turn ? loading : unloading;
    branch.travel_m.push_back(travel_m[i]);
    branch.force_N.push_back(table.loads_N[table.values[rows[i]].contact]);
  }
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < table.values.size(); ++i)
    if (table.lines[i] < table.lines[rows[turn]]) kept.push_back(i);
  branches = MeasuredBranches{kept.size(), table.values.size() - kept.size(),
                              loop_between(loading, unloading)};
  return table.only(kept);
}

/// Takes the values above the part of the largest load out of the table.
input::MeasurementTable take_held_out(input::MeasurementTable& table, double above_N) {
  std::vector<std::size_t> kept, held;
  for (std::size_t i = 0; i < table.values.size(); ++i)
    (table.loads_N[table.values[i].contact] > above_N ? held : kept).push_back(i);
  input::MeasurementTable taken = table.only(held);
  if (kept.empty())
    throw InputError(table.file, "number of values below the held-out loads", "0",
                     "some to calibrate from");
  table = table.only(kept);
  return taken;
}

/// Forecasts of the values that were kept back, and at the loads that were asked for.
void add_forecasts(CaseCalibration& calibration, const prediction::GeometryResolver& resolver,
                   const input::MeasurementTable& held, const std::vector<double>& loads_N) {
  const CalibrationProblem& problem = calibration.problem;
  // The first contact is the one whose radius the parameter is.
  Measurements asked{{problem.measurements.contacts[0]}, {}};
  std::vector<ForecastValue> values;
  const auto add = [&](const ForecastValue& value) {
    asked.values.push_back({value.quantity, asked.contacts.size(), 1, 0});
    asked.contacts.push_back(contact_at(calibration, resolver, value.load_N));
    values.push_back(value);
  };
  for (std::size_t i = 0; i < held.values.size(); ++i)
    add({held.values[i].quantity,
         held.loads_N[held.values[i].contact],
         held.values[i].value,
         held.lines[i],
         {}});
  std::set<MeasuredQuantity> quantities;
  for (const Measurement& value : problem.measurements.values) quantities.insert(value.quantity);
  for (const double load_N : loads_N)
    for (const MeasuredQuantity quantity : quantities) add({quantity, load_N, std::nullopt, 0, {}});
  if (values.empty()) return;
  const std::vector<Forecast> found = forecast(problem, calibration.found, asked);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i].forecast = found[i];
    (values[i].measured ? calibration.held_out : calibration.forecasts).push_back(values[i]);
  }
}

}  // namespace

std::string exponent_sentence(const ExponentDoubt& doubt) {
  const bool is_low = doubt.measured.value < doubt.least;
  return fmt::format(
      "above {:.3g} N the force grows as the indentation to the power {:.2f} (95 %: {:.2f} to "
      "{:.2f}), "
      "that of a solid finger to the power {:.2g} or {}",
      doubt.from_load_N, doubt.measured.value, doubt.measured.low, doubt.measured.high,
      is_low ? doubt.least : doubt.most, is_low ? "more" : "less");
}

const ParameterEstimate* CaseCalibration::estimate(Parameter parameter) const {
  for (const ParameterEstimate& estimate : found.parameters)
    if (estimate.parameter == parameter) return &estimate;
  return nullptr;
}

CaseCalibration calibrate_case(const input::Case& contact_case,
                               const input::MeasurementTable& whole, const Request& request) {
  if (!contact_case.sublayers.empty())
    throw InputError(contact_case.file.string(), "[[layer]]",
                     fmt::format("{} layers", contact_case.sublayers.size()),
                     "one homogeneous layer for calibrate: measurements of the whole finger do not "
                     "tell its parts");
  if (contact_case.object_layer.thickness_m > 0)
    throw InputError(contact_case.file.string(), "[object_layer]", "",
                     "one compliant body for calibrate: the models have no derivatives for two");
  CaseCalibration result;
  result.fitted = contact_case;
  result.table = loading_branch(whole, result.branches);
  result.held_out_above_N = request.fitted_part * result.table.loads_N.back();
  const input::MeasurementTable held = take_held_out(result.table, result.held_out_above_N);
  const input::MeasurementTable& table = result.table;
  result.fixed = request.fixed;
  CalibrationProblem& problem = result.problem;
  problem.model = request.model;
  problem.shear_law = contact_case.shear_law.kind;
  problem.pressing = contact_case.pressing;
  problem.free = free_parameters(request, contact_case, table);
  problem.measurements.values = table.values;

  const prediction::GeometryResolver resolver(result.fitted);
  result.remarks = resolver.remarks();
  problem.start = starting_values(contact_case, resolver.resolve(table.loads_N[0]).radii, request);
  put_into(result.fitted, problem.start);
  const auto doubted = [&](const Calibration* calibration) {
    const ExponentDoubt doubt = exponent_doubt(problem, calibration);
    if (doubt.exists && !request.takes_any_exponent)
      throw InputError(
          table.file, exponent_sentence(doubt), "",
          doubt.measured.value < doubt.least
              ? "the curve of a solid finger, not a hollow one's; if the mount gives, --fix "
                "mount_N_per_mm=.. or --fit compliance; --force calibrates all the same"
              : "the curve of a solid finger, not of one that bears on something stiffer; --force "
                "calibrates all the same");
    return doubt;
  };
  for (const double load_N : table.loads_N)
    problem.measurements.contacts.push_back(contact_at(result, resolver, load_N));
  result.exponent_doubt = doubted(nullptr);
  const bool depends_on_size = has_mesh(contact_case);
  constexpr int kMostRounds = 12;
  constexpr double kStill = 0.01;  // of an interval, or of a value
  for (int round = 1;; ++round) {
    problem.measurements.contacts.clear();
    for (const double load_N : table.loads_N)
      problem.measurements.contacts.push_back(contact_at(result, resolver, load_N));
    if (depends_on_size) {
      const RelativeRadii& first = problem.measurements.contacts[0].radii;
      problem.start[index_of(Parameter::radius)] =
          std::sqrt(first.major_m) * std::sqrt(first.minor_m);
    }
    const Calibration before = std::move(result.found);
    result.found = calibrate(problem);
    result.geometry_rounds = round;
    const double move = before.parameters.empty() ? 1 : largest_move(before, result.found);
    result.is_geometry_settled = !depends_on_size || move < kStill;
    if (result.is_geometry_settled || round == kMostRounds) break;
    problem.start = result.found.values;
    put_into(result.fitted, result.found.values);
  }
  if (const std::string reason = contradiction(problem, result.found); !reason.empty()) {
    const std::string better = better_units(problem);
    throw InputError(table.file, reason, "",
                     "data that some model explains; are the case's geometry and the units right?" +
                         (better.empty() ? "" : " Read " + better));
  }
  if (!result.exponent_doubt.exists) result.exponent_doubt = doubted(&result.found);
  put_into(result.fitted, result.found.values);
  add_forecasts(result, resolver, held, request.forecast_loads_N);
  result.models = compare_models(problem, result.found);
  result.shear_laws = compare_shear_laws(problem, result.found);
  result.growth = growth_exponent(problem, result.found);
  result.next = next_measurement(problem, result.found);
  result.unit_doubt = unit_doubt(problem, result.found);
  result.cannot_tell = softfinger::cannot_tell(problem, result.found);
  return result;
}

std::vector<FittedCurve> fitted_curves(const CaseCalibration& calibration) {
  constexpr int kPoints = 41;
  constexpr double kMargin = 1.3;  // beyond the loads
  const CalibrationProblem& problem = calibration.problem;
  const std::vector<double>& loads_N = calibration.table.loads_N;
  const double margin = has_mesh(calibration.fitted) ? 1 : kMargin;
  const double least = loads_N.front() / margin, largest = loads_N.back() * margin;
  const prediction::GeometryResolver resolver(calibration.fitted);
  // The first contact is the one whose radius the parameter is.
  Measurements asked{{problem.measurements.contacts[0]}, {}};
  std::set<MeasuredQuantity> quantities;
  for (const Measurement& value : problem.measurements.values) quantities.insert(value.quantity);
  for (int i = 0; i < kPoints; ++i)
    asked.contacts.push_back(contact_at(
        calibration, resolver, least * std::pow(largest / least, double(i) / (kPoints - 1))));
  for (const MeasuredQuantity quantity : quantities)
    for (std::size_t contact = 1; contact < asked.contacts.size(); ++contact)
      asked.values.push_back({quantity, contact, 1, 0});
  Eigen::VectorXd logs;
  Eigen::MatrixXd all_slopes;
  const ParameterValues& values = calibration.found.values;
  PredictedMeasurements{*problem.model, asked, problem.shear_law, problem.pressing}.evaluate(
      values, logs, &all_slopes);
  // The data's information in each direction, which is zero for combinations that they do not
  // determine.
  const PredictedMeasurements measured{*problem.model, problem.measurements, problem.shear_law,
                                       problem.pressing};
  const Eigen::MatrixXd jacobian = LeastSquares(measured, calibration.found.weights,
                                                contains(problem.free, Parameter::thickness))
                                       .jacobian(values, problem.free);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> known(jacobian.transpose() * jacobian);
  const double t = statistics::student_quantile(0.05, calibration.found.freedom);
  std::vector<FittedCurve> curves;
  for (Eigen::Index i = 0; i < logs.size(); ++i) {
    const Measurement& point = asked.values[std::size_t(i)];
    if (curves.empty() || curves.back().quantity != point.quantity)
      curves.push_back({point.quantity, {}, {}, {}, {}});
    Eigen::VectorXd slopes(Eigen::Index(problem.free.size()));
    for (std::size_t k = 0; k < problem.free.size(); ++k)
      slopes[Eigen::Index(k)] = all_slopes(i, Eigen::Index(index_of(problem.free[k])));
    double variance = 0;
    for (Eigen::Index k = 0; k < slopes.size(); ++k) {
      const double along = slopes.dot(known.eigenvectors().col(k));
      if (std::abs(along) < 1e-9 * slopes.norm()) continue;
      const double information = known.eigenvalues()[k];
      variance += information > 1e-12 * known.eigenvalues()[slopes.size() - 1]
                      ? along * along / information
                      : std::numeric_limits<double>::infinity();
    }
    const double value = logs[i] < 300 ? std::exp(logs[i]) : std::nan("");
    const double reach = t * std::sqrt(variance);
    FittedCurve& curve = curves.back();
    curve.loads_N.push_back(asked.contacts[point.contact].load.normal_force_N);
    curve.value.push_back(value);
    curve.low.push_back(std::isfinite(reach) ? value * std::exp(-reach) : std::nan(""));
    curve.high.push_back(reach < 300 ? value * std::exp(reach) : std::nan(""));
  }
  return curves;
}

std::vector<ConfidenceEllipse> confidence_ellipses(const CaseCalibration& calibration) {
  const Calibration& found = calibration.found;
  if (found.covariance.size() == 0) return {};
  // 95 % of two numbers together: chi squared with two degrees of freedom, or Fisher's F where the
  // scatter itself is estimated; both have closed forms.
  const double m = found.freedom;
  const double level = std::isfinite(m) ? m * (std::pow(0.05, -2 / m) - 1) : -2 * std::log(0.05);
  std::vector<ConfidenceEllipse> ellipses;
  const std::vector<Parameter>& free = calibration.problem.free;
  for (std::size_t i = 0; i < free.size(); ++i)
    for (std::size_t k = i + 1; k < free.size(); ++k) {
      if (is_of_friction(free[i]) || is_of_friction(free[k])) continue;
      const auto entry = [&](std::size_t row, std::size_t column) {
        return found.covariance(Eigen::Index(row), Eigen::Index(column));
      };
      Eigen::Matrix2d pair;
      pair << entry(i, i), entry(i, k), entry(k, i), entry(k, k);
      const Eigen::LLT<Eigen::Matrix2d> root(pair);
      if (root.info() != Eigen::Success) continue;
      ConfidenceEllipse ellipse{free[i], free[k], {}};
      constexpr int kPoints = 360;
      for (int n = 0; n <= kPoints; ++n) {
        const double angle = 2 * kPi * n / kPoints;
        Eigen::Vector2d from_centre =
            root.matrixL() * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        from_centre *= std::sqrt(level);
        const double x = coordinate(free[i], found.values[index_of(free[i])]) + from_centre[0];
        const double y = coordinate(free[k], found.values[index_of(free[k])]) + from_centre[1];
        if (is_in_range(free[i], x) && is_in_range(free[k], y))
          ellipse.points.push_back({value_at(free[i], x), value_at(free[k], y)});
      }
      ellipses.push_back(std::move(ellipse));
    }
  return ellipses;
}

}  // namespace softfinger::calibration
