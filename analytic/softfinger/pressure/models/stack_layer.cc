#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/layer/stack_contact.h"
#include "softfinger/layer/stack_kernel.h"
#include "softfinger/pressure/answer.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/validity.h"

namespace softfinger::models {

const PressureModel& bonded_layer_model();

namespace {

/// The first sublayer out of the ranges of contact_problem.h, as a check that fails.
ValidityCheck sublayer_violation(const LayerStack& stack) noexcept {
  if (stack.count > LayerStack::kMost)
    return {"sublayers_in_range", double(stack.count), double(LayerStack::kMost), true,
            "no answer: at most eight sublayers"};
  const auto positive_and_finite = [](double value) {
    return value > 0 && value <= std::numeric_limits<double>::max();
  };
  double least_Pa = std::numeric_limits<double>::max(), most_Pa = 0;
  for (std::size_t i = 0; i < stack.count; ++i) {
    const ElasticLayer& layer = stack.sublayers[i];
    if (!positive_and_finite(layer.thickness_m) || !positive_and_finite(layer.youngs_modulus_Pa) ||
        !(layer.poisson_ratio >= 0 && layer.poisson_ratio <= 0.5))
      return {"sublayers_in_range", 0, 1, false,
              "no answer: each sublayer's thickness and Young's modulus must be positive and "
              "finite, its Poisson's ratio between 0 and 1/2"};
    least_Pa = std::min(least_Pa, layer.youngs_modulus_Pa);
    most_Pa = std::max(most_Pa, layer.youngs_modulus_Pa);
  }
  constexpr double kLargestContrast = 1e6;
  if (const double contrast = most_Pa / least_Pa; !(contrast <= kLargestContrast))
    return {"sublayers_comparable", std::min(contrast, std::numeric_limits<double>::max()),
            kLargestContrast, true,
            "no answer: the sublayers' moduli differ by more than a factor of a million, which "
            "leaves too few digits of their compliance"};
  return {};
}

/// A ratio of the bodies' numbers beyond which their contact is not trusted, as a check that fails:
/// there it has been seen to grow as a layer becomes thinner.
ValidityCheck unlike_bodies(const ContactProblem& problem) noexcept {
  constexpr double kLargestRadiiRatio = 20, kLargestModuliRatio = 1e3, kLargestThicknessRatio = 1e4;
  const auto ratio = [](double one, double other) {
    return std::min(std::max(one / other, other / one), std::numeric_limits<double>::max());
  };
  const double radii = ratio(problem.radii.major_m, problem.radii.minor_m);
  if (!(radii <= kLargestRadiiRatio))
    return {"two_bodies_radii", radii, kLargestRadiiRatio, true,
            "no answer: with layers on both bodies R'/R'' at most 20"};
  double moduli = 1;
  const LayerStack finger = problem.finger_layers();
  for (std::size_t i = 0; i < std::min(finger.count, LayerStack::kMost); ++i)
    moduli = std::max(moduli, ratio(finger.sublayers[i].youngs_modulus_Pa,
                                    problem.object_layer.youngs_modulus_Pa));
  if (!(moduli <= kLargestModuliRatio))
    return {
        "two_bodies_moduli", moduli, kLargestModuliRatio, true,
        "no answer: the moduli of the two bodies differ by more than a factor of 1000: leave out "
        "the hard one's layer"};
  const double thickness = ratio(finger.thickness_m(), problem.object_layer.thickness_m);
  if (!(thickness <= kLargestThicknessRatio))
    return {"two_bodies_thickness", thickness, kLargestThicknessRatio, true,
            "no answer: the layers' thicknesses differ by more than a factor of 10,000"};
  return {};
}

class StackLayer final : public PressureModel {
 public:
  const ModelCard& card() const noexcept override {
    static const ModelCard card{
        "stack_layer",
        "Layer of bonded sublayers on a rigid core",
        "Linear elasticity; one to eight sublayers, bonded to each other and to the base, wide "
        "against the contact; the gap is a quadric and shallow inside the contact; no friction in "
        "the normal problem. One sublayer, and equal ones, have the answer of bonded_layer. A "
        "layer "
        "on the object is taken too: the kernels of both add.",
        "p = sum of c_n (1 - r²)^(n - 1/2), n = 1 to 5, in the stack's surface kernel 2 w(k)/(E* "
        "k) "
        "(2 x 2 compliance of each interface from the base upwards), against the same of a "
        "homogeneous layer with the stack's int dz/M, int dz/G and int z² dz/G, whose contact "
        "bonded_layer knows; a/b by the exponent d ln P/d ln a",
        "this project (softfinger/layer/stack_contact.h): Galerkin's method for the equation of N. "
        "N. Lebedev, Ya. S. Ufliand, Appl. Math. Mech. 22 (1958)",
        "moduli to a ratio of 100, nu 0.3 to 0.499, shares of the thickness 5 to 90 %, sqrt(ab) "
        "0.1 "
        "to 5 thicknesses: of 500 unseen stacks 95 % within 0.3 % in a, 0.05 % in d, 0.1 % in the "
        "torque of linear elasticity under R' = R'', of 500 under R'/R'' to 5 within 0.7 %, 0.8 %, "
        "1 %; a/R', b/R'' and the strain below 0.3",
        "8 to 16 times bonded_layer for two to eight sublayers, 2 to 7 microseconds, with AVX2; "
        "three "
        "times that without",
        true,
        false,
        {1e-12, 1e-12, 1e-2,
         "one layer has the pressure of bonded_layer, and so have several: given the load, the "
         "torque arm and the peak in closed form"}};
    return card;
  }

  bool knows_stacks() const noexcept override { return true; }

  Prediction predict(const ContactProblem& problem) const noexcept override {
    if (is_one_layer(problem)) return bonded_layer_model().predict(problem);
    if (const ValidityCheck reason = why_unanswered(problem); *reason.check)
      return no_answer(reason);
    const LayerStack object(problem.object_layer);
    const StackContact contact =
        stack_contact(problem.radii, problem.finger_layers(), problem.load.normal_force_N, object);
    Prediction prediction = answer_of(contact.numbers);
    if (!std::isfinite(prediction.a_m)) return no_answer(not_representable());
    if (!contact.is_solved)
      return no_answer({"solved", 0, 1, false,
                        "no answer: the load does not grow steadily with the contact's size, as "
                        "of sublayers that differ by far more than a factor of 100"});
    prediction.validity.add(small_slope_check(prediction, problem.radii));
    prediction.validity.add(
        object.count == 0
            ? small_strain_check(prediction, contact.equivalent)
            : small_strain_check(prediction, problem,
                                 compliance_per_Pa(problem.finger_layers(), prediction.a_m),
                                 compliance_per_Pa(object, prediction.a_m)));
    return finite_or_no_answer(prediction, problem);
  }

  Prediction predict_differentiated(
      const ContactProblem& problem,
      std::optional<DifferentiatedContact>* contact) const noexcept override {
    return is_one_layer(problem) ? bonded_layer_model().predict_differentiated(problem, contact)
                                 : predict(problem);
  }

  double pressure_Pa(const ContactProblem& problem, const Prediction& prediction, double x_m,
                     double y_m) const noexcept override {
    return bonded_layer_model().pressure_Pa(problem, prediction, x_m, y_m);
  }

 private:
  static bool is_one_layer(const ContactProblem& problem) noexcept {
    return problem.stack.count == 0 && !problem.has_object_layer();
  }

  /// Displacement by a pressure of wave number 1/a, in units of a. Layers on both bodies share the
  /// indentation as these.
  static double compliance_per_Pa(const LayerStack& stack, double a_m) noexcept {
    return StackKernel(stack).compliance(stack.surface().thickness_m / a_m) /
           stack.surface().plane_strain_modulus_Pa();
  }

  static ValidityCheck why_unanswered(const ContactProblem& problem) noexcept {
    const ValidityCheck violation = first_range_violation(problem);
    if (*violation.check) return violation;
    if (problem.has_object_layer())
      if (const ValidityCheck unlike = unlike_bodies(problem); *unlike.check) return unlike;
    return sublayer_violation(problem.finger_layers());
  }
};

}  // namespace

const PressureModel& stack_layer_model() {
  static const StackLayer model;
  return model;
}

}  // namespace softfinger::models
