#include <cmath>
#include <limits>

#include "softfinger/input/constants.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/validity.h"

namespace softfinger::models {
namespace {

/// The first reason why the law cannot be used, a check with an empty name when there is none.
ValidityCheck law_violation(const PowerLaw& law) noexcept {
  constexpr double kLargest = std::numeric_limits<double>::max();
  if (law.radius_coefficient == 0)
    return {"power_law_known", 0, 1, false,
            "no answer: no power law is known for this finger; state its coefficient and exponent, "
            "or fit them to measured loads and radii"};
  if (!(law.radius_coefficient > 0 && law.radius_coefficient <= kLargest))
    return {"radius_coefficient_in_range", 0, 1, false,
            "no answer: the coefficient c of a = c P^gamma must be positive and finite"};
  if (!(law.radius_exponent > 0 && law.radius_exponent < 1))
    return {"radius_exponent_in_range", 0, 1, false,
            "no answer: the exponent gamma of a = c P^gamma must lie between 0 and 1"};
  if (!(law.pressure_exponent >= 1 && law.pressure_exponent <= kLargest))
    return {"pressure_exponent_in_range", 0, 1, false,
            "no answer: the exponent k of the pressure must be finite and at least 1"};
  return {};
}

/// A fit may scatter about gamma = 1/3, but not by more than this.
ValidityCheck elastic_exponent_check(const PowerLaw& law) noexcept {
  return {"elastic_exponent", law.radius_exponent, 0.4, true,
          "the contact grows faster with the load than any elastic one (gamma = 1/3 for a thick "
          "linear layer, less for a thin or stiffening one): check the data"};
}

/// Round contacts only. At this limit the ellipse on a half-space has a/b of about (R'/R'')^(2/3) =
/// 1.84, and a circle of the same area has 7 % less torque.
ValidityCheck round_contact_check(const RelativeRadii& radii) noexcept {
  return {"round_contact", radii.major_m / radii.minor_m, 2.5, true,
          "the law is for round contacts: for these radii of curvature the contact is an ellipse; "
          "the answer is a circle, meant to have its area, and the torque is underestimated"};
}

class PowerLawContact final : public PressureModel {
 public:
  const ModelCard& card() const noexcept override {
    static const ModelCard card{
        "power_law",
        "Measured growth of a round contact",
        "Empirical: the radius of a round contact follows a power of the load, with coefficient "
        "and exponents of this very finger (given or fitted); layer and moduli are not used. The "
        "indentation is no part of the law: a²/sqrt(R'R''), as on a half-space, stands in. For R' "
        "> R'' the answer is a circle. A compliant object is refused: its law is another one.",
        "a = c P^gamma; p = C_k P/(pi a²) (1 - (r/a)^k)^(1/k), "
        "C_k = Gamma(1 + 3/k)/(Gamma(1 + 2/k) Gamma(1 + 1/k)); arm of the torque: "
        "(2/3) a Gamma(1 + 3/k)²/(Gamma(1 + 2/k) Gamma(1 + 4/k))",
        "Xydias, Kao, Modeling of contact mechanics and friction limit surfaces for soft fingers "
        "in robotics, with experimental results, Int. J. Robotics Research 18 (1999)",
        "round contacts (R'/R'' below 2.5) within the range of measured loads; gamma up to 1/3; "
        "a/R', b/R'' below 0.3",
        "about 300 ns",
        /*hot_path=*/true,
        /*finite_strain=*/false,
        NumericalAccuracy{},
        LayerConstants::none,
        /*is_empirical=*/true,
        /*is_calibrated=*/true};
    return card;
  }

  Prediction predict(const ContactProblem& problem) const noexcept override {
    ValidityCheck violation = first_range_violation(problem);
    const PowerLaw& law = problem.options.power_law;
    if (!*violation.check) violation = law_violation(law);
    if (!*violation.check) violation = one_layer_only(problem);
    if (*violation.check) return no_answer(violation);

    const double P = problem.load.normal_force_N, k = law.pressure_exponent;
    const double gamma_2 = std::tgamma(1 + 2 / k), gamma_3 = std::tgamma(1 + 3 / k);
    const double a = law.radius_coefficient * std::pow(P, law.radius_exponent);

    Prediction prediction;
    prediction.has_answer = true;
    prediction.a_m = prediction.b_m = a;
    prediction.indentation_m =
        a / std::sqrt(problem.radii.major_m) * (a / std::sqrt(problem.radii.minor_m));
    prediction.peak_pressure_Pa =
        gamma_3 / (gamma_2 * std::tgamma(1 + 1 / k)) * (P / (kPi * a * a));
    prediction.torque_arm_exact_m = prediction.torque_arm_paper_m =
        2.0 / 3 * a * (gamma_3 / gamma_2) * (gamma_3 / std::tgamma(1 + 4 / k));
    prediction.validity.add(round_contact_check(problem.radii));
    prediction.validity.add(elastic_exponent_check(law));
    prediction.validity.add(small_slope_check(prediction, problem.radii));
    return finite_or_no_answer(prediction, problem);
  }

  std::optional<DifferentiatedContact> differentiated(
      const ContactProblem& problem) const noexcept override {
    const Prediction prediction = predict(problem);
    const DifferentiatedInput input = differentiated_input(problem);
    const DifferentiatedNumber& P = input.normal_force_N;
    const double exponent = problem.options.power_law.radius_exponent;
    const auto a =
        DifferentiatedNumber::chain(P, prediction.a_m, exponent * prediction.a_m / P.value);
    using plain::sqrt;
    const DifferentiatedNumber arm = a * (prediction.torque_arm_exact_m / prediction.a_m);
    return DifferentiatedContact{
        {a, a, a / sqrt(input.radius_major_m) * (a / sqrt(input.radius_minor_m)),
         P / (a * a) * (prediction.peak_pressure_Pa / P.value * prediction.a_m * prediction.a_m),
         arm, arm},
        false};
  }

  double pressure_Pa(const ContactProblem& problem, const Prediction& prediction, double x_m,
                     double y_m) const noexcept override {
    if (!prediction.has_answer) return 0;
    const double k = problem.options.power_law.pressure_exponent;
    const double r = std::hypot(x_m, y_m) / prediction.a_m;
    // log1p and expm1 keep the small difference next to the edge.
    const double depth = r < 1 ? -std::expm1(k * std::log(r)) : 0;
    return depth > 0 ? prediction.peak_pressure_Pa * std::pow(depth, 1 / k) : 0;
  }
};

}  // namespace

const PressureModel& power_law_model() {
  static const PowerLawContact model;
  return model;
}

}  // namespace softfinger::models
