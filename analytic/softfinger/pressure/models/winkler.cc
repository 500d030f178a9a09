#include <cmath>

#include "softfinger/friction/max_torque.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/elliptic_pressure.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/validity.h"

namespace softfinger::models {
namespace {

double modulus_Pa(const ElasticLayer& layer, WinklerModulus choice) {
  return choice == WinklerModulus::youngs ? layer.youngs_modulus_Pa : layer.oedometric_modulus_Pa();
}

/// E/M of the layers' columns, load for load: what the free column's modulus makes of a bonded one.
ValidityCheck youngs_modulus_check(double free_compliance, double confined_compliance) noexcept {
  // Area ~ K^(-1/2): a modulus of 1/1.1² is an area of +10 %.
  return {"confined_modulus", confined_compliance / free_compliance, 1 / 1.21, false,
          "Young's modulus is right only for nu = 0 in a bonded layer, whose columns cannot widen: "
          "contact area and torque are overestimated; the oedometric modulus belongs here"};
}

class Winkler final : public PressureModel {
 public:
  const ModelCard& card() const noexcept override {
    static const ModelCard card{
        "winkler",
        "Elastic foundation of independent columns",
        "Linear elasticity; the layer is thin against the contact and compressible, so that each "
        "column is compressed on its own, without moving sideways (modulus K = M, confined; K = E, "
        "the option winkler_modulus = \"youngs\", is wrong for a bonded layer unless nu = 0). A "
        "layer on the object is a second column in series.",
        "p = (K d/h) (1 - x²/a² - y²/b²), d = sqrt(P h/(K pi sqrt(R' R''))), a = sqrt(2 d R'), "
        "b = sqrt(2 d R''), K = M = E (1 - nu)/((1 + nu)(1 - 2 nu)); two layers: h/K = h1/K1 + "
        "h2/K2; "
        "arm of the torque: (16/(15 pi)) a E(m), m = 1 - b²/a² (exact), (8/15) sqrt(ab) (paper)",
        "Ciocarlie, Lackner, Allen (2007), eq. 9, 11-13",
        "contact large against the layer: sqrt(ab)/h above 2.7 (nu = 0.3), 10 (0.45), 52 (0.49), "
        "never at nu = 1/2; a/R', b/R'' and d/h below 0.3",
        "about 100 ns",
        /*hot_path=*/true,
        /*finite_strain=*/false,
        NumericalAccuracy{},
        LayerConstants::foundation_modulus,
        /*is_empirical=*/false,
        /*is_calibrated=*/true};
    return card;
  }

  Prediction predict(const ContactProblem& problem) const noexcept override {
    const ValidityCheck violation = first_range_violation(problem);
    if (*violation.check) return no_answer(violation);

    const WinklerModulus choice = problem.options.winkler_modulus;
    const ElasticLayer& object = problem.object_layer;
    const bool two_layers = problem.has_object_layer();
    // h/K in m/Pa; in series they add.
    const double finger_compliance = problem.layer.thickness_m / modulus_Pa(problem.layer, choice);
    const double object_compliance =
        two_layers ? object.thickness_m / modulus_Pa(object, choice) : 0;
    const double compliance = finger_compliance + object_compliance;
    if (compliance == 0 && problem.layer.poisson_ratio == 0.5)
      return no_answer({"compressible", 0, 1e-16, false,
                        "no answer: at nu = 1/2 (value: 1 - 2 nu) a confined column cannot be "
                        "compressed, so that independent columns carry any load without contact"});

    const double R1 = problem.radii.major_m, R2 = problem.radii.minor_m;
    const double mean_radius_m = std::sqrt(R1) * std::sqrt(R2);
    Prediction prediction;
    prediction.has_answer = true;
    const double d = std::sqrt(problem.load.normal_force_N * compliance / kPi / mean_radius_m);
    prediction.indentation_m = d;
    prediction.a_m = std::sqrt(2 * d * R1);
    prediction.b_m = std::sqrt(2 * d * R2);
    prediction.peak_pressure_Pa = d / compliance;
    prediction.torque_arm_exact_m = torque_arm_exact_m(prediction.a_m, prediction.b_m, 1);
    prediction.torque_arm_paper_m = torque_arm_paper_m(prediction.a_m, prediction.b_m, 1);
    prediction.validity.add(thin_layer_check(prediction, problem.layer));
    if (two_layers)
      prediction.validity.add(thin_layer_check(prediction, object, "thin_object_layer"));
    prediction.validity.add(small_slope_check(prediction, problem.radii));
    prediction.validity.add(
        small_strain_check(prediction, problem, finger_compliance, object_compliance));
    if (choice == WinklerModulus::youngs) {
      double confined = problem.layer.thickness_m / problem.layer.oedometric_modulus_Pa();
      if (two_layers) confined += object.thickness_m / object.oedometric_modulus_Pa();
      prediction.validity.add(youngs_modulus_check(compliance, confined));
    }
    return finite_or_no_answer(prediction, problem);
  }

  std::optional<DifferentiatedContact> differentiated(
      const ContactProblem& problem) const noexcept override {
    using plain::log;
    const DifferentiatedInput input = differentiated_input(problem);
    const auto at = layer_arguments(input);
    const DifferentiatedNumber& nu = input.poisson_ratio;
    // s⁴ = 4 P R/(pi K h³), with E*/K
    const DifferentiatedNumber softness = problem.options.winkler_modulus == WinklerModulus::youngs
                                              ? 1. / (1. - nu * nu)
                                              : (1. - 2. * nu) / ((1. - nu) * (1. - nu));
    return DifferentiatedContact{contact_of_logarithms<DifferentiatedNumber>(
        {0.25 * (at.log_load + log(softness * (4 / kPi))), 0.5 * at.log_radii_ratio,
         kLogWinklerDepth, kLogWinklerArm, kLogWinklerPeak},
        at.mean_radius_m, input)};
  }

  double pressure_Pa(const ContactProblem&, const Prediction& prediction, double x_m,
                     double y_m) const noexcept override {
    return prediction.peak_pressure_Pa * ellipse_depth(prediction, x_m, y_m);
  }
};

}  // namespace

const PressureModel& winkler_model() {
  static const Winkler model;
  return model;
}

}  // namespace softfinger::models
