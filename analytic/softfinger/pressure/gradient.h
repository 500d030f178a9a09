#pragma once

#include <array>

#include "softfinger/layer/stuck_stiffness.h"
#include "softfinger/pressure/differentiated.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// Derivatives of one number of a prediction.
struct Derivatives {
  std::array<double, kContactVariables> by{};  ///< by ContactVariable; SI
  double by_friction_coefficient = 0;
};

/// Derivatives of a prediction. `known` is false where the model has no answer, two layers, or no
/// derivatives (those that solve the contact numerically).
struct PredictionGradient {
  bool known = false;
  Derivatives a_m, b_m, indentation_m, area_m2, peak_pressure_Pa, torque_arm_exact_m,
      torque_arm_paper_m;
  Derivatives max_torque_Nm;  ///< mu P times the exact arm
  /// Stiffness of the contact before it slips: `stuck_stiffness` on this model's ellipse.
  StuckStiffness stuck;
  Derivatives torsional_stiffness_Nm_per_rad, tangential_stiffness_x_N_per_m,
      tangential_stiffness_y_N_per_m;

  /// dP/dd at the load: what the contact's spring is against a further approach.
  double normal_stiffness_N_per_m() const { return known ? 1 / indentation_m.by[kNormalForce] : 0; }
};

struct PredictionWithGradient {
  Prediction prediction;
  PredictionGradient gradient;
};

/// A prediction and its derivatives, by forward differentiation: exact to round-off. Of
/// `bonded_layer` and `fingertip_layer` it takes two to three times a prediction's time. Never
/// throws, never allocates.
PredictionWithGradient predict_with_gradient(const PressureModel& model,
                                             const ContactProblem& problem) noexcept;

/// Derivatives with respect to the principal radii of both bodies and the angle between them.
struct BodyDerivatives {
  double finger_radius_x_m = 0, finger_radius_y_m = 0;  ///< by them, in 1/m
  double object_radius_x_m = 0, object_radius_y_m = 0;
  double angle_rad = 0;
};

/// Two quadrics as in a case file: principal radii along their own axes (infinite: flat, negative:
/// hollow), the object's x axis turned from the finger's by `angle_rad`.
struct BodyRadii {
  double finger_x_m = 0, finger_y_m = 0, object_x_m = 0, object_y_m = 0, angle_rad = 0;
};

/// Carries derivatives on to the bodies, by the chain rule through R', R'' and the finger's
/// curvature along the contact's axes. With equal relative radii the axes have no direction, and
/// the derivatives are those along the finger's own.
/// @param of  a number whose derivatives at the contact of these bodies are known
BodyDerivatives by_body_radii(const Derivatives& of, const BodyRadii& bodies) noexcept;

/// The gap's radii and the finger's curvature along its axes.
/// @return false where the bodies touch in no ellipse
bool set_bodies(const BodyRadii& bodies, ContactProblem& problem) noexcept;

}  // namespace softfinger
