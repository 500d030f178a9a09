#include "softfinger/accuracy/pressing_error.h"

#include <cmath>

#include "softfinger/accuracy/pressing_error_core.h"
#include "softfinger/pressure/rubbed_prediction.h"

namespace softfinger {

BoundedErrors missed_of_pressing_friction(const PressureModel& model, const ContactProblem& problem,
                                          double friction_coefficient,
                                          const Prediction& frictionless,
                                          const Prediction& pressed) noexcept {
  const ElasticLayer& layer = problem.layer;
  const double size_m = std::sqrt(frictionless.a_m) * std::sqrt(frictionless.b_m);
  const RatiosOf<double> known =
      ratios_of(layer.poisson_ratio, size_m / layer.thickness_m, friction_coefficient,
                frictionless.indentation_m / layer.thickness_m);
  return missed_of_pressing_friction(
      known, contact_numbers(frictionless),
      contact_numbers(rubbed(model, frictionless, problem, friction_coefficient)),
      contact_numbers(pressed));
}

ErrorBound error_bound(const PressureModel& model, const ContactProblem& problem,
                       double pressing_friction_coefficient) noexcept {
  const Prediction frictionless = model.predict(problem);
  ErrorBound result = error_bound(problem, frictionless);
  if (!result.known || !(pressing_friction_coefficient > 0)) return result;
  const Prediction pressed =
      as_pressed(model, frictionless, problem, pressing_friction_coefficient);
  const BoundedErrors missed = missed_of_pressing_friction(
      model, problem, pressing_friction_coefficient, frictionless, pressed);
  for (std::size_t q = 0; q < kBoundedQuantities; ++q) result.bound[q] += missed[q];
  return result;
}

}  // namespace softfinger
