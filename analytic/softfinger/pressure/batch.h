#pragma once

#include <cstddef>

#include "softfinger/input/contact_problem.h"

namespace softfinger {

/// Many contacts of one layer with rigid objects, as arrays of `count` numbers each, in the ranges
/// of contact_problem.h. SI.
struct ContactBatch {
  std::size_t count = 0;
  const double* normal_force_N = nullptr;
  const double* youngs_modulus_Pa = nullptr;
  const double* poisson_ratio = nullptr;
  const double* thickness_m = nullptr;
  const double* radius_major_m = nullptr;
  const double* radius_minor_m = nullptr;
  /// The finger's own curvature along the contact's axes (ContactProblem::finger_curvature); null:
  /// zero, a flat layer.
  const double* finger_xx_per_m = nullptr;
  const double* finger_yy_per_m = nullptr;
  const double* finger_xy_per_m = nullptr;
  /// The coefficient of friction that acts while the contact is pressed (rubbed_prediction.h),
  /// infinite where all sticks; null: pressed without. Models that do not know it leave it out.
  const double* pressing_friction_coefficient = nullptr;
  bool are_objects_spherical = false;
  ModelOptions options{};

  ContactProblem problem(std::size_t index) const {
    ContactProblem result;
    result.radii = {radius_major_m[index], radius_minor_m[index], 0};
    result.layer = {thickness_m[index], youngs_modulus_Pa[index], poisson_ratio[index]};
    result.load.normal_force_N = normal_force_N[index];
    const auto or_zero = [index](const double* array) { return array ? array[index] : 0; };
    result.finger_curvature = {or_zero(finger_xx_per_m), or_zero(finger_yy_per_m),
                               or_zero(finger_xy_per_m)};
    result.is_object_spherical = are_objects_spherical;
    result.options = options;
    return result;
  }
};

/// Destination of the answers: arrays with one number for each contact, null for a quantity that is
/// not wanted. All zero where the model has no answer; `predict` says why.
struct PredictionBatch {
  double* a_m = nullptr;
  double* b_m = nullptr;
  double* indentation_m = nullptr;
  double* peak_pressure_Pa = nullptr;
  /// Arms of the largest torque, which friction while pressing leaves as they are.
  double* torque_arm_exact_m = nullptr;
  double* torque_arm_paper_m = nullptr;
  double* pressure_arm_m = nullptr;    ///< (int p r dA)/P as pressed
  double* frictionless_a_m = nullptr;  ///< of the contact that is pressed without friction
  double* frictionless_b_m = nullptr;
};

class PressureModel;

/// The answers of `PressureModel::predict`, and of `rubbed` where friction acts while pressing, bit
/// for bit. bonded_layer and fingertip_layer compute four contacts at a time, with what vector
/// instructions the processor has: with AVX2 0.12 and 0.15 microseconds each, and 0.2 more with
/// friction. Never throws, never allocates; parts of a batch may run on several
/// threads.
void predict_batch(const PressureModel& model, const ContactBatch& contacts,
                   const PredictionBatch& predictions) noexcept;

/// `PressureModel::predict_batch` of `bonded_layer` and `fingertip_layer`.
void predict_bonded_layer_batch(const PressureModel& model, const ContactBatch& contacts,
                                const PredictionBatch& predictions) noexcept;
void predict_fingertip_layer_batch(const PressureModel& model, const ContactBatch& contacts,
                                   const PredictionBatch& predictions) noexcept;

}  // namespace softfinger
