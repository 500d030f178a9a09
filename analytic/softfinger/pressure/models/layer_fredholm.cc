#include <cmath>
#include <exception>
#include <vector>

#include "softfinger/layer/circular_contact.h"
#include "softfinger/pressure/last_solution.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/validity.h"

namespace softfinger::models {
namespace {

/// R'/R'' up to which a contact counts as round: what it neglects is then below the other errors.
constexpr double kRound = 1 + 1e-9;

double combined_modulus_Pa(const ContactProblem& problem) noexcept {
  const double finger_Pa = problem.finger_layers().surface().plane_strain_modulus_Pa();
  if (!problem.has_object_layer()) return finger_Pa;
  return 1 / (1 / finger_Pa + 1 / problem.object_layer.plane_strain_modulus_Pa());
}

double mean_radius_m(const ContactProblem& problem) noexcept {
  return std::sqrt(problem.radii.major_m) * std::sqrt(problem.radii.minor_m);
}

std::vector<CompliantLayer> compliant_layers(const ContactProblem& problem) {
  const double modulus_Pa = combined_modulus_Pa(problem);
  std::vector<CompliantLayer> layers;
  const auto add = [&](const LayerStack& stack) {
    layers.push_back({StackKernel(stack), modulus_Pa / stack.surface().plane_strain_modulus_Pa()});
  };
  add(problem.finger_layers());
  if (problem.has_object_layer()) add(problem.object_layer);
  return layers;
}

const CircularLayerContact& solution_of(const ContactProblem& problem) {
  return last_solution<CircularLayerContact>(problem, [&] {
    return circular_layer_contact_at_load(
        problem.load.normal_force_N / combined_modulus_Pa(problem), mean_radius_m(problem),
        compliant_layers(problem));
  });
}

/// The strain of each layer. They share the indentation as their compliances at the wave number
/// 1/a, about which the pressure's spectrum lies.
ValidityCheck strain_check(const Prediction& prediction, const ContactProblem& problem) noexcept {
  const auto compliance_per_Pa = [&](const LayerStack& stack) {
    return StackKernel(stack).compliance(stack.surface().thickness_m / prediction.a_m) /
           stack.surface().plane_strain_modulus_Pa();
  };
  return small_strain_check(
      prediction, problem, compliance_per_Pa(problem.finger_layers()),
      problem.has_object_layer() ? compliance_per_Pa(problem.object_layer) : 0);
}

class LayerFredholm final : public PressureModel {
 public:
  const ModelCard& card() const noexcept override {
    static const ModelCard card{
        "layer_fredholm",
        "Round contact on a layer, solved live",
        "Linear elasticity; the layer, homogeneous or of sublayers that are bonded to each other, "
        "is bonded to its rigid base and wide against the contact; "
        "the gap is r²/(2R) (R' = R''), shallow inside the contact; no friction in the normal "
        "problem. "
        "A layer on the object adds its own compliance.",
        "phi(t) - (2/pi) int_0^a phi(s) int_0^inf (1 - w(kh)) cos kt cos ks dk ds = (E*/pi)(d - "
        "t²/R), phi(a) = 0; P = 2 pi int phi dt, torque = mu pi² int t phi dt, p(r) = -int_r^a "
        "phi'(t)/sqrt(t² - r²) dt; two layers: w = sum of (E*/E*_i) w_i(k h_i)",
        "N. N. Lebedev, Ya. S. Ufliand, Appl. Math. Mech. 22 (1958); kernel: K. L. Johnson, "
        "Contact Mechanics (1985), section 5.8",
        "R' = R'', a/h <= 120: relative error below 1e-8 of linear elasticity to a/h = 20, 1e-4 at "
        "120; a/R and d/h below 0.3",
        "about 5 ms at a/h = 1, seconds at 100",
        false,
        false,
        {1e-12, 1e-12, 1e-4,
         "load, torque and pressure are integrals of one expansion, exact for it; the expansion "
         "itself is within 1e-4 at a/h = 120"}};
    return card;
  }

  bool knows_stacks() const noexcept override { return true; }

  Prediction predict(const ContactProblem& problem) const noexcept override {
    const ValidityCheck violation = first_range_violation(problem);
    if (*violation.check) return no_answer(violation);
    const double ratio = problem.radii.major_m / problem.radii.minor_m;
    if (!(ratio <= kRound))
      return no_answer({"round", std::min(ratio, 1e300), kRound, true,
                        "no answer: this model solves round contacts (R' = R''); layer_fft takes "
                        "elliptic ones"});
    const double modulus_Pa = combined_modulus_Pa(problem);
    const double radius_m = mean_radius_m(problem);
    const double scaled_load_m2 = problem.load.normal_force_N / modulus_Pa;
    // The cube of Hertz's radius, 3 P R/(4 E*), must be a number with all its digits.
    if (!(scaled_load_m2 * radius_m > 1e-290 && scaled_load_m2 * radius_m < 1e290))
      return no_answer(not_representable());
    try {
      const CircularLayerContact& contact = solution_of(problem);
      if (!(contact.a_m > 0))
        return no_answer({"solvable", 0, 1, false,
                          "no answer: the contact is larger than 120 times the layer's thickness, "
                          "which takes too many unknowns; the thin-layer models hold there"});
      Prediction prediction;
      prediction.has_answer = true;
      prediction.a_m = prediction.b_m = contact.a_m;
      prediction.indentation_m = contact.indentation_m;
      prediction.peak_pressure_Pa = modulus_Pa * contact.pressure_over_modulus(0);
      prediction.torque_arm_exact_m = prediction.torque_arm_paper_m = contact.torque_arm_m;
      prediction.validity.add(small_slope_check(prediction, problem.radii));
      const ValidityCheck strain = strain_check(prediction, problem);
      prediction.validity.add(strain);
      if (problem.has_object_layer() && strain.value >= 1)
        return no_answer(
            {"not_pressed_through", strain.value, 1, true,
             "no answer: one of the two layers is pressed by more than its thickness"});
      return finite_or_no_answer(prediction, problem);
    } catch (const std::exception&) {  // memory only: predict() must not throw
      return no_answer(not_representable());
    }
  }

  double pressure_Pa(const ContactProblem& problem, const Prediction& prediction, double x_m,
                     double y_m) const noexcept override {
    if (!prediction.has_answer) return 0;
    try {
      return combined_modulus_Pa(problem) *
             solution_of(problem).pressure_over_modulus(std::hypot(x_m, y_m));
    } catch (const std::exception&) {
      return 0;
    }
  }
};

}  // namespace

const PressureModel& layer_fredholm_model() {
  static const LayerFredholm model;
  return model;
}

}  // namespace softfinger::models
