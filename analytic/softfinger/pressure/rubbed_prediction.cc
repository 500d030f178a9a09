#include "softfinger/pressure/rubbed_prediction.h"

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/pressure/equivalent_exponent.h"
#include "softfinger/pressure/rubbed_core.h"

namespace softfinger {
namespace {

/// The variables of a gradient, and the friction coefficient.
constexpr int kSlopes = kContactVariables + 1;
using Slopes = Dual<kSlopes>;

/// A number of a prediction with its derivatives.
Slopes with_slopes(double value, const Derivatives& derivatives) noexcept {
  Slopes result(value);
  std::copy(derivatives.by.begin(), derivatives.by.end(), result.slope.begin());
  result.slope[kContactVariables] = derivatives.by_friction_coefficient;
  return result;
}

Derivatives slopes_of(const Slopes& number) noexcept {
  Derivatives result;
  std::copy_n(number.slope.begin(), kContactVariables, result.by.begin());
  result.by_friction_coefficient = number.slope[kContactVariables];
  return result;
}

/// The stiffness of the stuck contact on the ellipse as pressed.
void set_stuck_stiffness(const Slopes& a_m, const Slopes& b_m, const ElasticLayer& layer,
                         PredictionGradient& gradient) noexcept {
  // First by the five numbers that it depends on.
  using Number = Dual<5>;
  const StuckStiffnessOf<Number> stuck = stuck_stiffness<Number>(
      Number::variable(a_m.value, 0), Number::variable(b_m.value, 1),
      Number::variable(layer.thickness_m, 2), Number::variable(layer.youngs_modulus_Pa, 3),
      Number::variable(layer.poisson_ratio, 4));
  const auto set = [&](const Number& number, double& value, Derivatives& derivatives) {
    Slopes chained = number.value;
    for (std::size_t i = 0; i < kSlopes; ++i)
      chained.slope[i] = number.slope[0] * a_m.slope[i] + number.slope[1] * b_m.slope[i];
    chained.slope[kThickness] += number.slope[2];
    chained.slope[kYoungsModulus] += number.slope[3];
    chained.slope[kPoissonRatio] += number.slope[4];
    value = number.value;
    derivatives = slopes_of(chained);
  };
  set(stuck.torsional_Nm_per_rad, gradient.stuck.torsional_Nm_per_rad,
      gradient.torsional_stiffness_Nm_per_rad);
  set(stuck.tangential_x_N_per_m, gradient.stuck.tangential_x_N_per_m,
      gradient.tangential_stiffness_x_N_per_m);
  set(stuck.tangential_y_N_per_m, gradient.stuck.tangential_y_N_per_m,
      gradient.tangential_stiffness_y_N_per_m);
}

}  // namespace

RubbedRatios rubbed_ratios(double poisson_ratio, double size_over_thickness,
                           double friction_coefficient, double strain) noexcept {
  if (!(size_over_thickness > 0) || !(friction_coefficient > 0)) return {};
  const RatiosOf<double> found =
      ratios_of(poisson_ratio, size_over_thickness, friction_coefficient, strain);
  return {found.size, found.indentation, found.torque_arm};
}

ContactNumbers rubbed_numbers(const ContactNumbers& frictionless, double poisson_ratio,
                              double thickness_m, double friction_coefficient,
                              bool has_finite_strain) noexcept {
  if (!(friction_coefficient > 0)) return frictionless;
  return with_friction<double>(frictionless, poisson_ratio, thickness_m, friction_coefficient,
                               has_finite_strain);
}

Prediction rubbed(const PressureModel& model, const Prediction& frictionless,
                  const ContactProblem& problem, double friction_coefficient) noexcept {
  const ContactNumbers found =
      rubbed_numbers(contact_numbers(frictionless), problem.layer.poisson_ratio,
                     problem.layer.thickness_m, friction_coefficient, model.card().finite_strain);
  Prediction result = frictionless;
  result.a_m = found.a_m;
  result.b_m = found.b_m;
  result.indentation_m = found.indentation_m;
  result.peak_pressure_Pa = found.peak_pressure_Pa;
  result.torque_arm_exact_m = found.torque_arm_exact_m;
  result.torque_arm_paper_m = found.torque_arm_paper_m;
  return result;
}

PredictionWithGradient rubbed(const PressureModel& model,
                              const PredictionWithGradient& frictionless,
                              const ContactProblem& problem, double friction_coefficient) noexcept {
  PredictionWithGradient result = frictionless;
  if (!frictionless.gradient.known || !(friction_coefficient > 0)) return result;
  const Prediction& at = frictionless.prediction;
  const PredictionGradient& by = frictionless.gradient;
  const ContactNumbersOf<Slopes> found = with_friction<Slopes>(
      {with_slopes(at.a_m, by.a_m), with_slopes(at.b_m, by.b_m),
       with_slopes(at.indentation_m, by.indentation_m),
       with_slopes(at.peak_pressure_Pa, by.peak_pressure_Pa),
       with_slopes(at.torque_arm_exact_m, by.torque_arm_exact_m),
       with_slopes(at.torque_arm_paper_m, by.torque_arm_paper_m)},
      Slopes::variable(problem.layer.poisson_ratio, kPoissonRatio),
      Slopes::variable(problem.layer.thickness_m, kThickness),
      Slopes::variable(friction_coefficient, kContactVariables), model.card().finite_strain);
  result.prediction = rubbed(model, at, problem, friction_coefficient);
  result.gradient.a_m = slopes_of(found.a_m);
  result.gradient.b_m = slopes_of(found.b_m);
  result.gradient.indentation_m = slopes_of(found.indentation_m);
  result.gradient.area_m2 = slopes_of(kPi * found.a_m * found.b_m);
  result.gradient.peak_pressure_Pa = slopes_of(found.peak_pressure_Pa);
  result.gradient.torque_arm_exact_m = slopes_of(found.torque_arm_exact_m);
  result.gradient.torque_arm_paper_m = slopes_of(found.torque_arm_paper_m);
  set_stuck_stiffness(found.a_m, found.b_m, problem.layer, result.gradient);
  return result;
}

double rubbed_pressure_Pa(const PressureModel& model, const ContactProblem& problem,
                          const Prediction& pressed, double x_m, double y_m) noexcept {
  if (model.card().hot_path) return model.pressure_Pa(problem, pressed, x_m, y_m);
  const double x = x_m / pressed.a_m, y = y_m / pressed.b_m, inside = 1 - x * x - y * y;
  return inside > 0 ? pressed.peak_pressure_Pa * std::pow(inside, equivalent_exponent(pressed)) : 0;
}

bool knows_pressing_friction(const PressureModel& model) noexcept {
  const ModelCard& card = model.card();
  return card.layer_constants == LayerConstants::all && !card.is_empirical;
}

Prediction as_pressed(const PressureModel& model, const Prediction& frictionless,
                      const ContactProblem& problem, double friction_coefficient) noexcept {
  return frictionless.has_answer && knows_pressing_friction(model)
             ? rubbed(model, frictionless, problem, friction_coefficient)
             : frictionless;
}

ValidityCheck check_frictionless_pressing(const PressureModel& model,
                                          const Prediction& frictionless,
                                          const ContactProblem& problem,
                                          double friction_coefficient) noexcept {
  // Half of the default tolerance.
  constexpr double kCounts = 0.05;
  const double indentation_m =
      rubbed(model, frictionless, problem, friction_coefficient).indentation_m;
  return {
      "frictionless_pressing", 1 - indentation_m / frictionless.indentation_m, kCounts, true,
      "presses without friction, which would make the indentation smaller by more than half of the "
      "default tolerance, in linear elasticity. fingertip_layer, bonded_layer and the finite "
      "elements (softfinger fem) press "
      "with friction"};
}

}  // namespace softfinger
