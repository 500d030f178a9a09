#include <cmath>

#include "softfinger/friction/max_torque.h"
#include "softfinger/input/constants.h"
#include "softfinger/math/hertz_ellipse.h"
#include "softfinger/pressure/elliptic_pressure.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/validity.h"

namespace softfinger::models {
namespace {

class Hertz final : public PressureModel {
 public:
  const ModelCard& card() const noexcept override {
    static const ModelCard card{
        "hertz",
        "Elliptic Hertz contact on a half-space",
        "Linear elasticity; the layer, and the object's where it has one, is so thick that its "
        "rigid base is not felt; the gap is a quadric and shallow inside the contact; no friction "
        "in the normal problem.",
        "p = p0 sqrt(1 - x²/a² - y²/b²), p0 = 3P/(2 pi a b); "
        "R'/R'' = ((a/b)² E(m) - K(m)) / (K(m) - E(m)), m = 1 - b²/a²; "
        "a³ = 3 P R' (K - E)/(pi E* m), d = 3 P K/(2 pi a E*), E* = E/(1 - nu²), with a compliant "
        "object 1/E* = (1 - nu1²)/E1 + (1 - nu2²)/E2; "
        "arm of the torque: (3/8) a E(m) (exact), (3 pi/16) sqrt(ab) (paper)",
        "K. L. Johnson, Contact Mechanics (1985), section 4.2; torque: Ciocarlie, Lackner, Allen "
        "(2007), eq. 10",
        "contact small against the layer: sqrt(ab)/h below 0.88 (nu = 0) to 0.65 (nu = 1/2); "
        "a/R', b/R'' and d/h below 0.3",
        "about 400 ns",
        /*hot_path=*/true,
        /*finite_strain=*/false,
        NumericalAccuracy{},
        LayerConstants::plane_strain_modulus,
        /*is_empirical=*/false,
        /*is_calibrated=*/true};
    return card;
  }

  Prediction predict(const ContactProblem& problem) const noexcept override {
    const ValidityCheck violation = first_range_violation(problem);
    if (*violation.check) return no_answer(violation);

    const double R1 = problem.radii.major_m, R2 = problem.radii.minor_m;
    const double P = problem.load.normal_force_N;
    // 3 P / E* of either body; in a half-space the two displacements add.
    const double finger_m2 = 3 * (P / problem.layer.plane_strain_modulus_Pa());
    const double object_m2 =
        problem.has_object_layer() ? 3 * (P / problem.object_layer.plane_strain_modulus_Pa()) : 0;
    const double compliance_m2 = finger_m2 + object_m2;
    const EllipticIntegrals integrals = hertz_ellipse(R1 / R2);
    if (!(integrals.q > 1e-290)) return no_answer(not_representable());

    Prediction prediction;
    prediction.has_answer = true;
    prediction.a_m = std::cbrt(compliance_m2 * R1 * integrals.D / kPi);
    prediction.b_m = prediction.a_m * std::sqrt(integrals.q);
    prediction.indentation_m = compliance_m2 * integrals.K() / (2 * kPi * prediction.a_m);
    prediction.peak_pressure_Pa = 1.5 * P / (kPi * prediction.a_m * prediction.b_m);
    // torque_arm_exact_m(a, b, 1/2) with the E(m) that is at hand.
    prediction.torque_arm_exact_m = 0.375 * prediction.a_m * integrals.E();
    prediction.torque_arm_paper_m = torque_arm_paper_m(prediction.a_m, prediction.b_m, 0.5);
    prediction.validity.add(thick_layer_check(prediction, problem.layer));
    if (problem.has_object_layer())
      prediction.validity.add(
          thick_layer_check(prediction, problem.object_layer, "thick_object_layer"));
    prediction.validity.add(small_slope_check(prediction, problem.radii));
    prediction.validity.add(small_strain_check(prediction, problem, finger_m2, object_m2));
    return finite_or_no_answer(prediction, problem);
  }

  std::optional<DifferentiatedContact> differentiated(
      const ContactProblem& problem) const noexcept override {
    const DifferentiatedInput input = differentiated_input(problem);
    const auto at = layer_arguments(input);
    const auto shapes = tabulated_limit_shapes(at.log_radii_ratio);
    return DifferentiatedContact{contact_of_logarithms<DifferentiatedNumber>(
        {shapes.log_hertz_size_at_unit_load + at.log_load * (1. / 3), shapes.log_hertz_aspect,
         shapes.log_hertz_depth, kLogHertzArm, kLogHertzPeak},
        at.mean_radius_m, input)};
  }

  double pressure_Pa(const ContactProblem&, const Prediction& prediction, double x_m,
                     double y_m) const noexcept override {
    return prediction.peak_pressure_Pa * std::sqrt(ellipse_depth(prediction, x_m, y_m));
  }
};

}  // namespace

const PressureModel& hertz_model() {
  static const Hertz model;
  return model;
}

}  // namespace softfinger::models
