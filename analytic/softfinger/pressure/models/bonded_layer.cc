#include "softfinger/layer/bonded_layer.h"

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/math/wide.h"
#include "softfinger/pressure/answer.h"
#include "softfinger/pressure/elliptic_pressure.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/validity.h"

namespace softfinger::models {
namespace {

/// Weights of three pressures (1 - r²)^n of equal load that together have the given torque arm and
/// peak, over the load's mean pressure; the shape below is normalised by its peak.
struct PressureShape {
  double second, third;  ///< share of the peak; the first has the rest

  /// `exponents` n, `arms` (n+1) B(3/2, n+1); `arm` and `peak` as in LayerQuantity.
  PressureShape(const double (&exponents)[3], const double (&arms)[3], double arm,
                double peak) noexcept {
    const double arm1 = arms[1] - arms[0], arm2 = arms[2] - arms[0];
    const double peak1 = exponents[1] - exponents[0], peak2 = exponents[2] - exponents[0];
    const double d_arm = arm - arms[0], d_peak = peak - exponents[0] - 1;
    const double determinant = arm1 * peak2 - arm2 * peak1;
    second = (d_arm * peak2 - arm2 * d_peak) / determinant * (exponents[1] + 1) / peak;
    third = (arm1 * d_peak - d_arm * peak1) / determinant * (exponents[2] + 1) / peak;
  }
  double first() const noexcept { return 1 - second - third; }
};

/// Pressure over its peak for `depth` = 1 - x²/a² - y²/b² > 0, with the load, the torque arm and
/// the peak of the prediction.
///
/// sqrt(depth) (c0 + c1 depth + c2 depth²), which has the true edge, follows the exact pressure
/// within 1 % of the peak. Towards the thin incompressible layer, whose edge is flat, c0 vanishes
/// and could become negative: there the powers 1/2, 1 and 2 take over, which are exact in that
/// limit.
double relative_pressure(double arm, double peak, double depth) noexcept {
  constexpr double kRootExponents[3] = {0.5, 1.5, 2.5};
  constexpr double kRootArms[3] = {3 * kPi / 16, 5 * kPi / 32, 35 * kPi / 256};
  constexpr double kLimitExponents[3] = {0.5, 1, 2};
  constexpr double kLimitArms[3] = {3 * kPi / 16, 8.0 / 15, 16.0 / 35};
  constexpr double kTakeOver = 0.1;
  const PressureShape root(kRootExponents, kRootArms, arm, peak);
  const PressureShape limit(kLimitExponents, kLimitArms, arm, peak);
  const double share = std::clamp((kTakeOver - root.first()) / kTakeOver, 0.0, 1.0);
  const double edge = std::sqrt(depth);
  const double of_root = 1 + root.second * (depth - 1) + root.third * (depth * depth - 1);
  const double of_limit = 1 + limit.second * (edge - 1) + limit.third * (edge * depth - 1);
  return std::max(0.0, edge * (of_root + share * (of_limit - of_root)));
}

class BondedLayer final : public PressureModel {
 public:
  const ModelCard& card() const noexcept override {
    static const ModelCard card{
        "bonded_layer",
        "Elastic layer of any thickness on a rigid core",
        "Linear elasticity; the layer is bonded to its base and wide against the contact; the gap "
        "is a quadric and shallow inside the contact; no friction in the normal problem. Any "
        "thickness, Poisson's ratio and R'/R''. A layer on the object must be like the finger's.",
        "contact of a quadric on a layer of compliance 2 w(kh)/(E* k), w(x) = (2 kappa sinh 2x - "
        "4x)/(2 kappa cosh 2x + 4x² + 1 + kappa²), kappa = 3 - 4 nu: a smooth blend of the limits "
        "(hertz; winkler with K = M; thin_incompressible) times a tabulated correction",
        "this project: spectral solution tabulated over s = sqrt(ab)/h, nu and R'/R'' "
        "(softfinger/layer, tools/make_bonded_layer_table.cc); kernel: K. L. Johnson, Contact "
        "Mechanics (1985), section 5.8",
        "sqrt(ab)/h <= 100 (no lower limit), R'/R'' <= 100: a, b and torque within 0.5 %, d within "
        "1 % of linear elasticity; a/R', b/R'' and d/h below 0.3",
        "below 1 microsecond",
        true,
        false,
        {1e-12, 1e-12, 1e-4,
         "the pressure is given the load, the torque arm and the peak in closed form; where the "
         "thickness no longer matters, the table's interpolation error is left, which is not "
         "monotone"},
        LayerConstants::all,
        /*is_empirical=*/false,
        /*is_calibrated=*/true};
    return card;
  }

  Prediction predict(const ContactProblem& problem) const noexcept override {
    if (const ValidityCheck reason = why_unanswered(problem); *reason.check)
      return no_answer(reason);
    // Two like layers meet in a plane of symmetry: each is pressed against half of the gap.
    const double halves = problem.has_object_layer() ? 2 : 1;
    RelativeRadii radii = problem.radii;
    radii.major_m *= halves;
    radii.minor_m *= halves;
    Prediction prediction =
        answer_of(bonded_layer_contact(radii, problem.layer, problem.load.normal_force_N));
    prediction.indentation_m *= halves;
    add_checks(problem, prediction);
    return finite_or_no_answer(prediction, problem);
  }

  Prediction predict_differentiated(
      const ContactProblem& problem,
      std::optional<DifferentiatedContact>* contact) const noexcept override {
    if (problem.has_object_layer()) return predict(problem);
    if (const ValidityCheck reason = why_unanswered(problem); *reason.check)
      return no_answer(reason);
    with_best_instructions([&] {
      contact->emplace(DifferentiatedContact{bonded_layer_numbers(differentiated_input(problem))});
    });
    Prediction prediction = answer_of(**contact);
    add_checks(problem, prediction);
    return finite_or_no_answer(prediction, problem);
  }

  void predict_batch(const ContactBatch& contacts,
                     const PredictionBatch& predictions) const noexcept override {
    predict_bonded_layer_batch(*this, contacts, predictions);
  }

  double pressure_Pa(const ContactProblem& problem, const Prediction& prediction, double x_m,
                     double y_m) const noexcept override {
    const double depth = ellipse_depth(prediction, x_m, y_m);
    if (!(depth > 0)) return 0;
    const double arm =
        prediction.torque_arm_paper_m / std::sqrt(prediction.a_m) / std::sqrt(prediction.b_m);
    const double peak = prediction.peak_pressure_Pa / problem.load.normal_force_N * kPi *
                        prediction.a_m * prediction.b_m;
    return prediction.peak_pressure_Pa * relative_pressure(arm, peak, depth);
  }

 private:
  static ValidityCheck why_unanswered(const ContactProblem& problem) noexcept {
    const ValidityCheck violation = first_range_violation(problem);
    if (*violation.check) return violation;
    if (problem.has_object_layer() && !same(problem.layer, problem.object_layer))
      return {"single_layer", 0, 1, false,
              "no answer: a layer on the object must have the finger's thickness and "
              "material (then each takes half of the gap); stack_layer takes "
              "two different ones"};
    return {};
  }

  static void add_checks(const ContactProblem& problem, Prediction& prediction) noexcept {
    const double halves = problem.has_object_layer() ? 2 : 1;
    prediction.validity.add(
        {"table_size", contact_to_thickness(prediction, problem.layer), 100, true,
         "the contact is larger than the tabulated ones (sqrt(ab)/h): the answer is on its way to "
         "the limit of thin layers, without a stated error"});
    prediction.validity.add(
        {"table_radii_ratio", std::min(problem.radii.major_m / problem.radii.minor_m, 1e300),
         100.001, true,
         "R'/R'' is beyond the tabulated ones: the corrections for R'/R'' = 100 "
         "are used, without a stated error"});
    prediction.validity.add(small_slope_check(prediction, problem.radii));
    prediction.validity.add(
        small_strain_check(prediction.indentation_m / halves / problem.layer.thickness_m));
  }

  static bool same(const ElasticLayer& one, const ElasticLayer& other) noexcept {
    return one.thickness_m == other.thickness_m &&
           one.youngs_modulus_Pa == other.youngs_modulus_Pa &&
           one.poisson_ratio == other.poisson_ratio;
  }
};

}  // namespace

const PressureModel& bonded_layer_model() {
  static const BondedLayer model;
  return model;
}

}  // namespace softfinger::models
