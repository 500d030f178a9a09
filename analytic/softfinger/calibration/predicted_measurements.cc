#include "softfinger/calibration/predicted_measurements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "softfinger/friction/shear_limit.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/equivalent_exponent.h"
#include "softfinger/pressure/rubbed_prediction.h"

namespace softfinger {
namespace {

constexpr double kNoAnswer = 1e3;  ///< the logarithm of what no model predicts

/// A positive number's logarithm and its derivatives by all parameters.
struct LogNumber {
  double value = kNoAnswer;
  std::array<double, kParameters> slope{};

  static LogNumber of(double value) noexcept {
    LogNumber result;
    if (value > 0 && std::isfinite(value)) result.value = std::log(value);
    return result;
  }
  bool exists() const noexcept { return value != kNoAnswer; }
  double& by(Parameter parameter) noexcept { return slope[std::size_t(parameter)]; }
};

LogNumber product(const LogNumber& one, const LogNumber& other) noexcept {
  LogNumber result;
  result.value = one.value + other.value;
  for (std::size_t i = 0; i < kParameters; ++i) result.slope[i] = one.slope[i] + other.slope[i];
  return result;
}

struct ContactLogarithms {
  LogNumber a, b, indentation, arm;
};

/// Logarithm of a number with its slopes by those parameters that the model's derivatives cover.
LogNumber logarithm(const DifferentiatedNumber& number, const ContactProblem& problem,
                    bool is_elastic) noexcept {
  LogNumber result = LogNumber::of(number.value);
  if (!result.exists()) return result;
  const auto by = [&](ContactVariable variable, double at) {
    return number.slope[std::size_t(variable)] * at / number.value;
  };
  const SurfaceCurvature& finger = problem.finger_curvature;
  result.by(Parameter::youngs_modulus) =
      is_elastic ? -by(kNormalForce, problem.load.normal_force_N) : 0;
  result.by(Parameter::thickness) = by(kThickness, problem.layer.thickness_m);
  result.by(Parameter::poisson_ratio) = by(kPoissonRatio, 1);
  // All lengths of the bodies grow alike.
  result.by(Parameter::radius) =
      by(kRadiusMajor, problem.radii.major_m) + by(kRadiusMinor, problem.radii.minor_m) -
      by(kFingerCurvatureX, finger.xx_per_m) - by(kFingerCurvatureY, finger.yy_per_m) -
      by(kFingerCurvatureXY, finger.xy_per_m);
  for (const double slope : result.slope)
    if (!std::isfinite(slope)) return {};
  return result;
}

/// Adds the slopes by the two parameters of a power law, for which no model has derivatives:
/// central differences, exact for powers but for rounding.
void add_power_law_slopes(const PressureModel& model, const ContactProblem& problem,
                          ContactLogarithms& contact) noexcept {
  constexpr double kStep = 1e-4;
  for (const Parameter parameter : {Parameter::radius_coefficient, Parameter::radius_exponent}) {
    const auto moved = [&](double step) {
      ContactProblem other = problem;
      PowerLaw& law = other.options.power_law;
      if (parameter == Parameter::radius_coefficient)
        law.radius_coefficient *= std::exp(step);
      else
        law.radius_exponent += step;
      return model.predict(other);
    };
    const Prediction more = moved(kStep), less = moved(-kStep);
    if (!more.has_answer || !less.has_answer) continue;
    const auto slope = [&](double above, double below) {
      return std::log(above / below) / (2 * kStep);
    };
    contact.a.by(parameter) = slope(more.a_m, less.a_m);
    contact.b.by(parameter) = slope(more.b_m, less.b_m);
    contact.indentation.by(parameter) = slope(more.indentation_m, less.indentation_m);
    contact.arm.by(parameter) = slope(more.torque_arm_exact_m, less.torque_arm_exact_m);
  }
}

/// Logarithms without derivatives: a prediction takes a quarter of the time.
ContactLogarithms contact_logarithms_alone(const PressureModel& model,
                                           const ContactProblem& problem) noexcept {
  const Prediction contact = model.predict(problem);
  if (!contact.has_answer) return {};
  return {LogNumber::of(contact.a_m), LogNumber::of(contact.b_m),
          LogNumber::of(contact.indentation_m), LogNumber::of(contact.torque_arm_exact_m)};
}

ContactLogarithms contact_logarithms(const PressureModel& model,
                                     const ContactProblem& problem) noexcept {
  std::optional<DifferentiatedContact> contact;
  if (!model.predict_differentiated(problem, &contact).has_answer || !contact) return {};
  const auto known = [&](const DifferentiatedNumber& number) {
    return logarithm(number, problem, contact->is_elastic);
  };
  const auto& numbers = contact->numbers;
  ContactLogarithms result{known(numbers.a_m), known(numbers.b_m), known(numbers.indentation_m),
                           known(numbers.torque_arm_exact_m)};
  if (problem.options.power_law.radius_coefficient > 0)
    add_power_law_slopes(model, problem, result);
  return result;
}

/// Changes semi-axes and indentation to those of pressing with friction. The arm of the largest
/// torque stays. Slopes by central differences of the ratios, right to 1e-8.
void press_with_friction(const PressureModel& model, const ContactProblem& problem,
                         PressingFriction pressing, bool with_slopes,
                         ContactLogarithms& contact) noexcept {
  if (pressing == PressingFriction::none || !contact.a.exists() || !contact.b.exists() ||
      !contact.indentation.exists() || !knows_pressing_friction(model))
    return;
  // The logarithms of size and strain over the thickness, nu, and the logarithm of mu.
  using Point = std::array<double, 4>;
  const double log_thickness = std::log(problem.layer.thickness_m);
  const double mu = pressing_friction_coefficient(pressing, problem.load.friction_coefficient);
  const Point here = {(contact.a.value + contact.b.value) / 2 - log_thickness,
                      contact.indentation.value - log_thickness, problem.layer.poisson_ratio,
                      std::log(mu)};
  const auto ratios_at = [&](const Point& at) {
    return rubbed_ratios(at[2], std::exp(at[0]), std::exp(at[3]),
                         model.card().finite_strain ? std::exp(at[1]) : 0);
  };
  const auto change = [&](double RubbedRatios::*ratio) {
    LogNumber result = LogNumber::of(ratios_at(here).*ratio);
    if (!with_slopes) return result;
    constexpr double kStep = 1e-5;
    const auto slope = [&](std::size_t coordinate) {
      Point above = here, below = here;
      above[coordinate] += kStep;
      below[coordinate] -= kStep;
      // Nothing is known beyond nu = 1/2.
      if (coordinate == 2) above[2] = std::min(above[2], 0.5);
      if (coordinate == 2) below[2] = std::max(below[2], 0.);
      return std::log(ratios_at(above).*ratio / (ratios_at(below).*ratio)) /
             (above[coordinate] - below[coordinate]);
    };
    const double by_size = slope(0), by_strain = slope(1);
    for (std::size_t i = 0; i < kParameters; ++i)
      result.slope[i] = by_size * (contact.a.slope[i] + contact.b.slope[i]) / 2 +
                        by_strain * contact.indentation.slope[i];
    result.by(Parameter::thickness) -= by_size + by_strain;
    result.by(Parameter::poisson_ratio) += slope(2);
    if (pressing == PressingFriction::coulomb)
      result.by(Parameter::friction_coefficient) = slope(3);
    return result;
  };
  const LogNumber size = change(&RubbedRatios::size);
  const LogNumber indentation = change(&RubbedRatios::indentation);
  contact.a = product(contact.a, size);
  contact.b = product(contact.b, size);
  contact.indentation = product(contact.indentation, indentation);
}

/// The largest force or torque under the law, on the ellipse with a pressure that has the contact's
/// torque arm.
double limit_of(MeasuredQuantity quantity, const ShearLaw& law, double a_m, double b_m,
                double arm_m, double load_N) noexcept {
  Prediction prediction;
  prediction.has_answer = true;
  prediction.a_m = std::max(a_m, b_m);
  prediction.b_m = std::min(a_m, b_m);
  prediction.torque_arm_exact_m = arm_m;
  const PressedEllipse contact{prediction.a_m, prediction.b_m, equivalent_exponent(prediction),
                               load_N};
  return quantity == MeasuredQuantity::max_torque ? max_torque_Nm(law, contact)
                                                  : max_force_N(law, contact);
}

LogNumber friction(MeasuredQuantity quantity, const ContactLogarithms& contact, ShearLaw::Kind kind,
                   const ParameterValues& values, double load_N, bool with_slopes) noexcept {
  if (!contact.a.exists() || !contact.b.exists() || !contact.arm.exists()) return {};
  const ShearLaw law{kind, values[index_of(Parameter::friction_coefficient)],
                     values[index_of(Parameter::shear_strength)]};
  if (kind == ShearLaw::Kind::coulomb) {
    LogNumber result = LogNumber::of(law.friction_coefficient * load_N);
    result.by(Parameter::friction_coefficient) = 1;
    return quantity == MeasuredQuantity::max_torque ? product(result, contact.arm) : result;
  }
  const double a_m = std::exp(contact.a.value), b_m = std::exp(contact.b.value);
  const double arm_m = std::exp(contact.arm.value);
  LogNumber result = LogNumber::of(limit_of(quantity, law, a_m, b_m, arm_m, load_N));
  if (!with_slopes || !result.exists()) return result;
  // By the logarithms of a, b, the arm and mu: central differences, right to 1e-8.
  constexpr double kStep = 1e-4;
  const double up = std::exp(kStep), down = std::exp(-kStep);
  const auto slope = [&](double a, double b, double arm, double mu) {
    const auto moved = [&](double factor) {
      const ShearLaw other{kind, law.friction_coefficient * (mu == 0 ? 1 : factor),
                           law.shear_strength_Pa};
      return limit_of(quantity, other, a_m * (a == 0 ? 1 : factor), b_m * (b == 0 ? 1 : factor),
                      arm_m * (arm == 0 ? 1 : factor), load_N);
    };
    return std::log(moved(up) / moved(down)) / (2 * kStep);
  };
  const double by_a = slope(1, 0, 0, 0), by_b = slope(0, 1, 0, 0);
  const double by_arm = kind == ShearLaw::Kind::shear_strength ? 0 : slope(0, 0, 1, 0);
  for (std::size_t i = 0; i < kParameters; ++i)
    result.slope[i] =
        by_a * contact.a.slope[i] + by_b * contact.b.slope[i] + by_arm * contact.arm.slope[i];
  // Twice mu and twice tau_0 carry twice as much.
  const double by_friction = law.has_friction_coefficient() ? slope(0, 0, 0, 1) : 0;
  result.by(Parameter::friction_coefficient) = by_friction;
  result.by(Parameter::shear_strength) = 1 - by_friction;
  return result;
}

/// The reading of an approach: that of the bodies, behind the zero of the scale, and what machine
/// and mount give.
LogNumber reading(const LogNumber& approach, const ParameterValues& values,
                  double load_N) noexcept {
  const double zero_m = values[index_of(Parameter::zero)];
  const double given_m = values[index_of(Parameter::compliance)] * load_N;
  if (!approach.exists()) return approach;
  const double approach_m = std::exp(approach.value);
  const double reading_m = approach_m + zero_m + given_m;
  if (!(reading_m > 0)) return {};
  LogNumber result = approach;
  if (zero_m != 0 || given_m != 0) {
    result = LogNumber::of(reading_m);
    for (std::size_t i = 0; i < kParameters; ++i)
      result.slope[i] = approach.slope[i] * approach_m / reading_m;
  }
  result.by(Parameter::zero) = 1 / reading_m;
  result.by(Parameter::compliance) = load_N / reading_m;
  return result;
}

LogNumber predicted(MeasuredQuantity quantity, const ContactLogarithms& contact, ShearLaw::Kind law,
                    const ParameterValues& values, double load_N, bool with_slopes) noexcept {
  switch (quantity) {
    case MeasuredQuantity::a:
      return contact.a;
    case MeasuredQuantity::b:
      return contact.b;
    case MeasuredQuantity::area:
      return product(LogNumber::of(kPi), product(contact.a, contact.b));
    case MeasuredQuantity::indentation:
      return reading(contact.indentation, values, load_N);
    case MeasuredQuantity::max_torque:
    case MeasuredQuantity::tangential_force:
      return friction(quantity, contact, law, values, load_N, with_slopes);
  }
  return {};
}

}  // namespace

ContactProblem PredictedMeasurements::problem(std::size_t contact,
                                              const ParameterValues& values) const noexcept {
  const auto value = [&](Parameter parameter) { return values[std::size_t(parameter)]; };
  ContactProblem problem = measurements.contacts[contact];
  problem.layer = {value(Parameter::thickness), value(Parameter::youngs_modulus),
                   value(Parameter::poisson_ratio)};
  problem.load.friction_coefficient = value(Parameter::friction_coefficient);
  // All radii are scaled as the first contact's, so that those fitted to different regions of a
  // mesh keep their ratio.
  const RelativeRadii& first = measurements.contacts[0].radii;
  const double scale =
      value(Parameter::radius) / (std::sqrt(first.major_m) * std::sqrt(first.minor_m));
  // A scale within rounding of 1 counts as 1: results are those of the contact as it is.
  if (std::abs(scale - 1) > 1e-15) {
    problem.radii.major_m *= scale;
    problem.radii.minor_m *= scale;
    problem.finger_curvature.xx_per_m /= scale;
    problem.finger_curvature.yy_per_m /= scale;
    problem.finger_curvature.xy_per_m /= scale;
  }
  if (problem.options.power_law.radius_coefficient > 0) {
    problem.options.power_law.radius_coefficient = value(Parameter::radius_coefficient);
    problem.options.power_law.radius_exponent = value(Parameter::radius_exponent);
  }
  return problem;
}

void PredictedMeasurements::evaluate(const ParameterValues& values, Eigen::VectorXd& log_values,
                                     Eigen::MatrixXd* log_slopes) const {
  const std::size_t count = measurements.values.size();
  log_values.resize(Eigen::Index(count));
  if (log_slopes) log_slopes->resize(Eigen::Index(count), Eigen::Index(kParameters));
  std::vector<ContactLogarithms> contacts(measurements.contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ContactProblem contact = problem(i, values);
    contacts[i] =
        log_slopes ? contact_logarithms(model, contact) : contact_logarithms_alone(model, contact);
    press_with_friction(model, contact, pressing, log_slopes != nullptr, contacts[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Measurement& measurement = measurements.values[i];
    const LogNumber number = predicted(
        measurement.quantity, contacts[measurement.contact], shear_law, values,
        measurements.contacts[measurement.contact].load.normal_force_N, log_slopes != nullptr);
    log_values[Eigen::Index(i)] = number.value;
    if (!log_slopes) continue;
    for (std::size_t k = 0; k < kParameters; ++k)
      (*log_slopes)(Eigen::Index(i), Eigen::Index(k)) = number.exists() ? number.slope[k] : 0;
  }
}

double PredictedMeasurements::log_compression(const ParameterValues& values,
                                              Eigen::RowVectorXd* slopes) const {
  const auto hardest =
      std::max_element(measurements.contacts.begin(), measurements.contacts.end(),
                       [](const ContactProblem& one, const ContactProblem& other) {
                         return one.load.normal_force_N < other.load.normal_force_N;
                       });
  const ContactProblem contact =
      problem(std::size_t(hardest - measurements.contacts.begin()), values);
  LogNumber depth =
      (slopes ? contact_logarithms(model, contact) : contact_logarithms_alone(model, contact))
          .indentation;
  if (slopes) {
    depth.by(Parameter::thickness) -= 1;
    *slopes = Eigen::Map<const Eigen::RowVectorXd>(depth.slope.data(), Eigen::Index(kParameters));
  }
  return depth.value - std::log(values[std::size_t(Parameter::thickness)]);
}

}  // namespace softfinger
