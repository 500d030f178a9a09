#pragma once

#include "softfinger/pressure/gradient.h"
#include "softfinger/pressure/pressure_model.h"

/// The effect of friction that acts while a layer is pressed.
namespace softfinger {

/// Numbers of a contact that is pressed with friction from the first touch, over those of the
/// contact that is pressed without, at equal load.
struct RubbedRatios {
  double size = 1;         ///< of a and b
  double indentation = 1;  ///< of d
  double torque_arm = 1;   ///< of int p r dA / P
};

/// A layer that sticks is stiffer. Two mechanisms, each of which saturates with mu: inward slip of
/// compressible layers, which a half-space has too, and the flow that is squeezed out of thin,
/// nearly incompressible ones. With t = 1 - 2 nu, s = sqrt(ab)/h of the frictionless contact,
///   ln ratio = -A erf(0.886 mu/(c2 t^n2)) - B erf(0.886 mu/m),
///   A = c0 t^n1/(1 + (s/(s0 t^n3))^p),
///   B = c s^k/(q + s^k)/(1 + b t/(1 - nu) s^n) max(0, 1 - j t),  m = g1 exp(-g2 t) s/(s + g3),
/// constants fitted to linear elasticity: incremental solutions of round contacts (nu 0.3 to 0.499,
/// s 0.3 to 5) within 0.4 % for nu up to 0.49 and 0.9 % above, this project's finite elements (nu 0
/// to 0.4, s 0.04 to 2) within 0.2 (d), 0.4 (a) and 0.6 % (arm). Pressed far, a layer flows as a
/// thinner one does: in B and m, s grows by the share `per_strain` d/h, which leaves 1 % in d and a
/// of spheres that stick at finite strain (nu 0.49, R = 5 h, d/h to 0.4). The arm changes more
/// where friction on a steep object bears a part of the load, which is left out.
/// @param poisson_ratio         0 to 1/2
/// @param size_over_thickness   s >= 0
/// @param friction_coefficient  mu >= 0; infinite: all sticks
/// @param strain                d/h >= 0 of the frictionless contact; 0: linear elasticity
RubbedRatios rubbed_ratios(double poisson_ratio, double size_over_thickness,
                           double friction_coefficient, double strain = 0) noexcept;

/// A prediction of frictionless pressing as it is with friction. The pressure keeps the form
/// (1 - r²)^n, with the exponent of its new arm, which gives the peak: within 4 % of linear
/// elasticity. `torque_arm_exact_m` becomes int p r dA / P as pressed. It is not the arm of the
/// largest torque, which is that of frictionless pressing: at full slip the direction of friction
/// has turned into that of the slip.
/// @param model         that gave it: one at finite strain has the ratios of its strain
/// @param frictionless  an answer
/// About half a microsecond. Never throws, never allocates.
Prediction rubbed(const PressureModel& model, const Prediction& frictionless,
                  const ContactProblem& problem, double friction_coefficient) noexcept;

inline ContactNumbers contact_numbers(const Prediction& of) noexcept {
  return {of.a_m,
          of.b_m,
          of.indentation_m,
          of.peak_pressure_Pa,
          of.torque_arm_exact_m,
          of.torque_arm_paper_m};
}

/// A contact's numbers likewise: of a model of finite strain, or of linear elasticity.
ContactNumbers rubbed_numbers(const ContactNumbers& frictionless, double poisson_ratio,
                              double thickness_m, double friction_coefficient,
                              bool has_finite_strain) noexcept;

/// A prediction with its derivatives, exact to round-off, those by `friction_coefficient` included.
/// The stiffnesses are those of the ellipse as pressed; the largest torque stays that of
/// frictionless pressing.
/// @param frictionless  an answer whose gradient is known, else nothing is changed
PredictionWithGradient rubbed(const PressureModel& model,
                              const PredictionWithGradient& frictionless,
                              const ContactProblem& problem, double friction_coefficient) noexcept;

/// Pressure in Pa at (x, y) of a contact that is pressed with friction, zero outside. A model that
/// solves its pressure knows that of frictionless pressing; (1 - r²)^n then stands for it.
/// @param pressed  what `rubbed` returned for this problem
double rubbed_pressure_Pa(const PressureModel& model, const ContactProblem& problem,
                          const Prediction& pressed, double x_m, double y_m) noexcept;

/// Whether a model's answers are those of an elastic layer, which the ratios are for.
bool knows_pressing_friction(const PressureModel& model) noexcept;

/// A model's prediction with the friction that acts while pressing, where the model knows it and
/// has an answer; else what is given.
Prediction as_pressed(const PressureModel& model, const Prediction& frictionless,
                      const ContactProblem& problem, double friction_coefficient) noexcept;

/// For a model that does not know it: the share by which friction makes the indentation smaller, in
/// linear elasticity, which holds below half of the default tolerance.
/// @param frictionless  an answer of the model
ValidityCheck check_frictionless_pressing(const PressureModel& model,
                                          const Prediction& frictionless,
                                          const ContactProblem& problem,
                                          double friction_coefficient) noexcept;

}  // namespace softfinger
