#include "softfinger/accuracy/error_bound.h"

#include <algorithm>
#include <cmath>

#include "softfinger/accuracy/finger_departure.h"

namespace softfinger {
namespace {

ErrorBound outside(const char* reason) {
  ErrorBound nothing;
  nothing.outside = reason;
  return nothing;
}

BoundedErrors numbers_of(const Prediction& prediction) {
  return {prediction.a_m,
          prediction.b_m,
          prediction.indentation_m,
          prediction.area_m2(),
          prediction.peak_pressure_Pa,
          prediction.torque_arm_exact_m};
}

double strain(const ContactProblem& problem, const Prediction& flat) {
  return flat.indentation_m / problem.layer.thickness_m;
}

const PressureModel& bonded_layer() {
  static const PressureModel& model = *find_pressure_model("bonded_layer");
  return model;
}

/// Of the quantities, the one that the finite elements tell to a tenth of a per cent.
constexpr std::size_t kTorque = 5;

/// Where strain, slope and curvature are small, bonded_layer is known better than the finite
/// elements that tested it: by the spectral solution, from which it is 0.002 % away. What is left
/// of the departure is at most a few times its terms, whose signs differ. In a, b, area and peak
/// pressure the scatter of the finite elements would lie outside such a bound, so that no run could
/// confirm it.
double width_of_small_departures(const DepartureFit& fit,
                                 const std::array<double, kDepartureTerms>& terms) {
  constexpr double kSpectral = 5e-5, kTimes = 3;
  double sum = 0;
  for (std::size_t t = 0; t < kDepartureTerms; ++t) sum += std::abs(fit.coefficients[t] * terms[t]);
  return kSpectral + kTimes * sum;
}

const char* reason_outside(const ContactProblem& problem, const Prediction& flat,
                           const FingerShare& share) {
  const auto is_share = [](double value) { return value >= 0 && value <= 1; };
  if (!is_share(share.x) || !is_share(share.y))
    return "not known where finger or object is hollow: the runs are of convex ones";
  const RelativeRadii& radii = problem.radii;
  if (radii.major_m > kDepartureRange.largest_radii_ratio * radii.minor_m)
    return "not known for R'/R'' above 20";
  const double thickness =
      problem.layer.thickness_m / (std::sqrt(radii.major_m) * std::sqrt(radii.minor_m));
  if (share.x == 0 && share.y == 0) {
    if (thickness > kDepartureRange.largest_flat_thickness)
      return "not known for flat layers thicker than five times the relative radius";
  } else if (thickness > kDepartureRange.largest_thickness) {
    return "not known for fingers' layers thicker than 0.6 of the relative radius";
  }
  if (std::sqrt(flat.a_m) * std::sqrt(flat.b_m) >
      kDepartureRange.largest_size * problem.layer.thickness_m)
    return "not known for contacts larger than 20 h";
  if (flat.a_m > kDepartureRange.largest_slope * radii.major_m ||
      flat.b_m > kDepartureRange.largest_slope * radii.minor_m)
    return "not known for slopes above 0.6 at the edge of the contact";
  if (strain(problem, flat) > kDepartureRange.largest_strain)
    return "not known for layers compressed by more than 40 %";
  return nullptr;
}

}  // namespace

std::array<double, kDepartureTerms> departure_terms(const ContactProblem& problem,
                                                    const Prediction& flat,
                                                    const FingerShare& share) noexcept {
  const double h = problem.layer.thickness_m;
  const double n = 2 * problem.layer.poisson_ratio;
  const double s = std::sqrt(flat.a_m) * std::sqrt(flat.b_m) / h;
  const double l = s / (1 + s);
  const double e = strain(problem, flat);
  const double slope_x = flat.a_m / problem.radii.major_m;
  const double slope_y = flat.b_m / problem.radii.minor_m;
  const double bent_x = share.x * h / problem.radii.major_m;
  const double bent_y = share.y * h / problem.radii.minor_m;
  const double bent = bent_x + bent_y;
  const std::array<double, 6> shapes = {1, n, l, n * l, n * n, l * l};
  std::array<double, kDepartureTerms> terms;
  std::size_t next = 0;
  for (const double effect : {e, slope_x * slope_x, slope_y * slope_y, bent_x * l, bent_y * l})
    for (const double shape : shapes) terms[next++] = effect * shape;
  for (const double product :
       {e * e, e * e * n, bent * e, bent * e * n, bent * bent * l, bent * bent * l * n})
    terms[next++] = product;
  return terms;
}

ErrorCause cause_of_term(std::size_t term) noexcept {
  // Six shapes of each of five effects, then products: of strain with itself and with curvature,
  // of curvature with itself.
  if (term < 6 || term == 30 || term == 31) return ErrorCause::strain;
  return term < 18 ? ErrorCause::slope : ErrorCause::curvature;
}

double departure_size(const ContactProblem& problem, const Prediction& flat,
                      const FingerShare& share) noexcept {
  const double h = problem.layer.thickness_m;
  const double s = std::sqrt(flat.a_m) * std::sqrt(flat.b_m) / h;
  const double slope_x = flat.a_m / problem.radii.major_m;
  const double slope_y = flat.b_m / problem.radii.minor_m;
  const double bent = share.x * h / problem.radii.major_m + share.y * h / problem.radii.minor_m;
  return strain(problem, flat) + slope_x * slope_x + slope_y * slope_y + bent * s / (1 + s);
}

ErrorBound error_bound(const ContactProblem& problem, const Prediction& prediction,
                       const FingerShare& share) noexcept {
  if (!prediction.has_answer) return outside("the model has no answer");
  if (problem.has_object_layer()) return outside("not known for two layers");
  const Prediction flat = bonded_layer().predict(problem);
  if (!flat.has_answer) return outside("bonded_layer, by which bounds are known, has no answer");
  if (const char* reason = reason_outside(problem, flat, share)) return outside(reason);
  const auto terms = departure_terms(problem, flat, share);
  const double size = departure_size(problem, flat, share);
  const BoundedErrors answer = numbers_of(prediction), reference = numbers_of(flat);
  ErrorBound result;
  result.known = true;
  for (std::size_t q = 0; q < kBoundedQuantities; ++q) {
    const DepartureFit& fit = kDepartureFits[q];
    // (model / flat) (flat / finger)
    const double ratio = answer[q] / reference[q];
    result.causes[std::size_t(ErrorCause::model)][q] = ratio - 1;
    for (std::size_t t = 0; t < kDepartureTerms; ++t)
      result.causes[std::size_t(cause_of_term(t))][q] += ratio * fit.coefficients[t] * terms[t];
    for (const BoundedErrors& cause : result.causes) result.expected[q] += cause[q];
    double width = fit.width_least + fit.width_per_size * size;
    if (q == kTorque) width = std::min(width, width_of_small_departures(fit, terms));
    result.bound[q] = std::abs(result.expected[q]) + ratio * width;
  }
  return result;
}

ErrorBound error_bound(const PressureModel& model, const ContactProblem& problem,
                       const FingerShare& share) noexcept {
  return error_bound(problem, model.predict(problem), share);
}

}  // namespace softfinger
