#include <algorithm>
#include <cmath>

#include "softfinger/friction/max_torque.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/elliptic_pressure.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/validity.h"

namespace softfinger::models {
namespace {

/// Whether the layer is thin enough for the parabolic flow profile across it, within 10 % in area
/// and torque at nu = 1/2 (the layer's exact solution; convergence is slow, like h/a).
ValidityCheck thin_for_flow_check(const Prediction& prediction, double thickness_m) noexcept {
  return {"thin_for_flow", std::sqrt(prediction.a_m) * std::sqrt(prediction.b_m) / thickness_m, 30,
          false,
          "the layer is not thin enough: near the contact's edge it bulges over a width of about "
          "its thickness, so that area and torque are overestimated by more than 10 %"};
}

/// Whether the layer flows sideways instead of being compressed. With compressibility the theory's
/// equation is u = (h/M) p - (h³/3G) laplacian p, and the two terms compare like the value here,
/// ab (h/M) / (h³/3G). For a circle the equation is solved by Bessel functions: without its first
/// term the area is 10 % too small at the value 6, the torque 6 %.
ValidityCheck incompressible_check(const Prediction& prediction, double column_compliance,
                                   double flow_compliance) noexcept {
  return {
      "incompressible", prediction.a_m * (column_compliance / flow_compliance) * prediction.b_m, 6,
      true,
      "the layer is compressible: it is squeezed rather than flowing sideways, so that area and "
      "torque are underestimated; the wider the contact, the closer nu must be to 1/2"};
}

class ThinIncompressible final : public PressureModel {
 public:
  const ModelCard& card() const noexcept override {
    static const ModelCard card{
        "thin_incompressible",
        "Thin incompressible layer that flows sideways",
        "Linear elasticity; the layer is bonded, incompressible and thin against the contact, so "
        "that its material is pressed sideways with a parabolic profile, like a lubricant; "
        "pressure and its slope vanish at the edge. A layer on the object adds its compliance.",
        "(h³/3G) laplacian p = -(d - x²/(2R') - y²/(2R'')), G = E/(2(1 + nu)); "
        "p = p0 (1 - x²/a² - y²/b²)², t = a²/b² = [(rho - 1) + sqrt((rho - 1)² + 36 rho)]/6, "
        "rho = R'/R''; a^6 = 8 h³ R' (3 + t) sqrt(t) P/(pi G), d = a² (1 + t)/(2 R' (3 + t)), "
        "p0 = 3P/(pi a b); two layers: h³/G = h1³/G1 + h2³/G2; "
        "arm of the torque: (32/(35 pi)) a E(m), m = 1 - b²/a² (exact), (16/35) sqrt(ab) (paper)",
        "leading order of the bonded layer for nu = 1/2 and k h -> 0 (K. L. Johnson, Contact "
        "Mechanics (1985), section 5.8, for the circle); elliptic solution derived here",
        "nu -> 1/2 and sqrt(ab)/h above 30: 3 (sqrt(ab)/h)² G/M below 6; a/R', b/R'' and d/h below "
        "0.3",
        "about 100 ns"};
    return card;
  }

  Prediction predict(const ContactProblem& problem) const noexcept override {
    const ValidityCheck violation = first_range_violation(problem);
    if (*violation.check) return no_answer(violation);

    const ElasticLayer& layer = problem.layer;
    const ElasticLayer& object = problem.object_layer;
    const bool two_layers = problem.has_object_layer();
    const double P = problem.load.normal_force_N;
    const double R1 = problem.radii.major_m, rho = R1 / problem.radii.minor_m;
    // (a/b)²; hypot, because the square of an extreme ratio overflows.
    const double t = ((rho - 1) + std::hypot(rho - 1, 6 * std::sqrt(rho))) / 6;

    // h³/G of both layers, written as h³ of the finger's layer times 1/G: h³ alone would underflow.
    const double h = layer.thickness_m;
    const double finger_per_Pa = 1 / layer.shear_modulus_Pa();
    double object_per_Pa = 0;
    if (two_layers) {
      const double thickness_ratio = object.thickness_m / h;
      object_per_Pa =
          thickness_ratio * thickness_ratio * thickness_ratio / object.shear_modulus_Pa();
    }
    const double compliance_per_Pa = finger_per_Pa + object_per_Pa;

    Prediction prediction;
    prediction.has_answer = true;
    prediction.a_m =
        std::sqrt(h) *
        std::cbrt(std::sqrt(8 / kPi * (3 + t) * std::sqrt(t) * R1 * (P * compliance_per_Pa)));
    prediction.b_m = prediction.a_m / std::sqrt(t);
    prediction.indentation_m = prediction.a_m * (prediction.a_m / R1) * ((1 + t) / (2 * (3 + t)));
    prediction.peak_pressure_Pa = 3 * P / (kPi * prediction.a_m * prediction.b_m);
    prediction.torque_arm_exact_m = torque_arm_exact_m(prediction.a_m, prediction.b_m, 2);
    prediction.torque_arm_paper_m = torque_arm_paper_m(prediction.a_m, prediction.b_m, 2);
    prediction.validity.add(thin_for_flow_check(prediction, std::max(h, object.thickness_m)));
    // Compliances over h: of columns 1/M, of flow (h²/3)/G.
    double columns_per_Pa = 1 / layer.oedometric_modulus_Pa();
    if (two_layers) columns_per_Pa += object.thickness_m / h / object.oedometric_modulus_Pa();
    prediction.validity.add(
        incompressible_check(prediction, columns_per_Pa, h * (compliance_per_Pa / 3) * h));
    prediction.validity.add(small_slope_check(prediction, problem.radii));
    prediction.validity.add(small_strain_check(prediction, problem, finger_per_Pa, object_per_Pa));
    return finite_or_no_answer(prediction, problem);
  }

  std::optional<DifferentiatedContact> differentiated(
      const ContactProblem& problem) const noexcept override {
    const DifferentiatedInput input = differentiated_input(problem);
    auto at = layer_arguments(input);
    // The layer's G enters, not its E*: P/(E* h³) with E* = 4 G.
    at.log_load = at.log_load - log(2. * (1. - input.poisson_ratio));
    const auto shapes = tabulated_limit_shapes(at.log_radii_ratio);
    return DifferentiatedContact{contact_of_logarithms<DifferentiatedNumber>(
        {shapes.log_incompressible_size_at_unit_load + at.log_load * (1. / 6),
         shapes.log_incompressible_aspect, shapes.log_incompressible_depth, kLogIncompressibleArm,
         kLogIncompressiblePeak},
        at.mean_radius_m, input)};
  }

  double pressure_Pa(const ContactProblem&, const Prediction& prediction, double x_m,
                     double y_m) const noexcept override {
    const double depth = ellipse_depth(prediction, x_m, y_m);
    return prediction.peak_pressure_Pa * depth * depth;
  }
};

}  // namespace

const PressureModel& thin_incompressible_model() {
  static const ThinIncompressible model;
  return model;
}

}  // namespace softfinger::models
