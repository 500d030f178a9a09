#include "softfinger/pressure/rubbed_prediction.h"

#include <algorithm>
#include <cmath>

#include "softfinger/pressure/equivalent_exponent.h"

namespace softfinger {
namespace {

/// Constants of one ratio, named as in the header.
struct RatioConstants {
  double c0, n1, s0, n3, p, c2, n2, c, q, k, b, n, j, g1, g2, g3;
  double per_strain;
};
constexpr RatioConstants kOfIndentation{0.03475, 1.182,  1.552, 1.112, 2.367, 0.4164,
                                        0.6843,  0.2799, 11.03, 2.647, 3.522, 0.9423,
                                        4.019,   0.5109, 5.278, 2.119, 1.45};
constexpr RatioConstants kOfSize{0.06093, 1.224, 2.075, 1.049, 1.731,  0.4782, 0.7129, 0.1343, 19.9,
                                 3.063,   4.023, 0.425, 3.864, 0.3717, 5.359,  0.9596, 2.2};
constexpr RatioConstants kOfArm{0.09249, 1.281,  1.511, 0.8185, 2.184, 0.3304,
                                0.7471,  0.1759, 23.26, 3.291,  3.457, 0.3372,
                                4.269,   0.2465, 5.504, 0,      2.2};

double ratio(const RatioConstants& of, double nu, double size, double mu, double strain) noexcept {
  // Powers of larger and smaller sizes do not fit into a double; the ratios no longer change there.
  constexpr double kSmallest = 1e-30, kLargest = 1e30;
  const double s = std::clamp(size, kSmallest, kLargest);
  const double thinner = std::clamp(size * (1 + of.per_strain * strain), kSmallest, kLargest);
  // Half of the root of pi: the error function then begins with the slope 1.
  constexpr double kUnitSlope = 0.886;
  const double t = 1 - 2 * nu;
  const double inward = of.c0 * std::pow(t, of.n1) /
                        (1 + std::pow(s / (of.s0 * std::pow(std::max(t, kSmallest), of.n3)), of.p));
  const double of_inward = of.c2 * std::pow(std::max(t, kSmallest), of.n2);
  const double flow = of.c / (of.q * std::pow(thinner, -of.k) + 1) /
                      (1 + of.b * t / (1 - nu) * std::pow(thinner, of.n)) *
                      std::max(0., 1 - of.j * t);
  const double of_flow = of.g1 * std::exp(-of.g2 * t) * thinner / (thinner + of.g3);
  return std::exp(-inward * std::erf(kUnitSlope * mu / of_inward) -
                  flow * std::erf(kUnitSlope * mu / of_flow));
}

}  // namespace

RubbedRatios rubbed_ratios(double poisson_ratio, double size_over_thickness,
                           double friction_coefficient, double strain) noexcept {
  if (!(size_over_thickness > 0) || !(friction_coefficient > 0)) return {};
  const auto of = [&](const RatioConstants& constants) {
    return ratio(constants, poisson_ratio, size_over_thickness, friction_coefficient, strain);
  };
  return {of(kOfSize), of(kOfIndentation), of(kOfArm)};
}

Prediction rubbed(const PressureModel& model, const Prediction& frictionless,
                  const ContactProblem& problem, double friction_coefficient) noexcept {
  const double s =
      std::sqrt(frictionless.a_m) * std::sqrt(frictionless.b_m) / problem.layer.thickness_m;
  const double strain =
      model.card().finite_strain ? frictionless.indentation_m / problem.layer.thickness_m : 0;
  const RubbedRatios ratios =
      rubbed_ratios(problem.layer.poisson_ratio, s, friction_coefficient, strain);
  Prediction result = frictionless;
  result.a_m *= ratios.size;
  result.b_m *= ratios.size;
  result.indentation_m *= ratios.indentation;
  result.torque_arm_exact_m *= ratios.torque_arm;
  result.torque_arm_paper_m *= ratios.torque_arm;
  const double flatter =
      (equivalent_exponent(result) + 1) / (equivalent_exponent(frictionless) + 1);
  result.peak_pressure_Pa *= flatter / (ratios.size * ratios.size);
  return result;
}

bool knows_pressing_friction(const PressureModel& model) noexcept {
  const ModelCard& card = model.card();
  return card.layer_constants == LayerConstants::all && !card.is_empirical;
}

}  // namespace softfinger
