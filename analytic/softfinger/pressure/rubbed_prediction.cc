#include "softfinger/pressure/rubbed_prediction.h"

#include <algorithm>
#include <cmath>

#include "softfinger/pressure/equivalent_exponent.h"

namespace softfinger {
namespace {

/// Constants of one ratio, named as in the header.
struct RatioConstants {
  double c0, s0, c, q, k, b, n, j, g1, g2, g3, c2;
};
constexpr RatioConstants kOfIndentation{0.104, 0.3547, 0.2982, 10.44, 2.369,  2.183,
                                        1.255, 4.186,  0.354,  6.356, 0.5781, 0.2074};
constexpr RatioConstants kOfSize{0.116,  0.7347, 0.1457, 16.63, 2.666,  2.505,
                                 0.7499, 4,      0.3131, 6.204, 0.4026, 0.2286};
constexpr RatioConstants kOfArm{0.2161, 0.5143, 0.1902, 18.23, 2.858, 2.887,
                                0.5468, 4.055,  0.2215, 5.034, 0,     0.1538};

double ratio(const RatioConstants& of, double nu, double size, double mu) noexcept {
  // Powers of larger and smaller sizes do not fit into a double; the ratios no longer change there.
  const double s = std::clamp(size, 1e-30, 1e30);
  // Half of the root of pi: the error function then begins with the slope 1.
  constexpr double kUnitSlope = 0.886;
  const double t = 1 - 2 * nu;
  const double inward = of.c0 * t * t / (1 + (s / of.s0) * (s / of.s0));
  const double flow = of.c / (of.q * std::pow(s, -of.k) + 1) /
                      (1 + of.b * t / (1 - nu) * std::pow(s, of.n)) * std::max(0., 1 - of.j * t);
  const double saturation = of.g1 * std::exp(-of.g2 * t) * s / (s + of.g3);
  return std::exp(-inward * std::erf(kUnitSlope * mu / of.c2) -
                  flow * std::erf(kUnitSlope * mu / saturation));
}

}  // namespace

RubbedRatios rubbed_ratios(double poisson_ratio, double size_over_thickness,
                           double friction_coefficient) noexcept {
  if (!(size_over_thickness > 0) || !(friction_coefficient > 0)) return {};
  const auto of = [&](const RatioConstants& constants) {
    return ratio(constants, poisson_ratio, size_over_thickness, friction_coefficient);
  };
  return {of(kOfSize), of(kOfIndentation), of(kOfArm)};
}

Prediction rubbed(const Prediction& frictionless, const ContactProblem& problem,
                  double friction_coefficient) noexcept {
  const double s =
      std::sqrt(frictionless.a_m) * std::sqrt(frictionless.b_m) / problem.layer.thickness_m;
  const RubbedRatios ratios = rubbed_ratios(problem.layer.poisson_ratio, s, friction_coefficient);
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
  return card.layer_constants == LayerConstants::all && !card.finite_strain && !card.is_empirical;
}

}  // namespace softfinger
