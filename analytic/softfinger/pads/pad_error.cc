#include "softfinger/pads/pad_error.h"

#include <cmath>

#include "softfinger/pads/pad_law.h"

namespace softfinger {
namespace {

/// Bounds of pad_layer, larger towards thick pads and towards nu = 1/2.
PadErrors layer_pad_bound(double, double) noexcept {
  return {0.08, 0.1, 0.03, 0.03, 0.1, 0.1, 0.1};
}

}  // namespace

std::optional<PadErrors> pad_error_bound(const PadModel& model,
                                         const PadProblem& problem) noexcept {
  const PadModel& layer = *find_pad_model("pad_layer");
  const PadPrediction reference = layer.predict(problem);
  const double width = problem.shape->size_m() / problem.layer.thickness_m;
  const double nu = problem.layer.poisson_ratio;
  if (!reference.valid() || width > pads::kLargestWidth) return std::nullopt;
  PadErrors bound = layer_pad_bound(width, nu);
  if (&model == &layer) return bound;
  const PadPrediction other = model.predict(problem);
  if (!other.has_answer) return std::nullopt;
  const auto add = [](double& error, double number, double known) {
    error += std::abs(number / known - 1);
  };
  add(bound.indentation, other.indentation_m, reference.indentation_m);
  add(bound.peak_pressure, other.peak_pressure_Pa, reference.peak_pressure_Pa);
  add(bound.pressure_arm, other.pressure_arm_m, reference.pressure_arm_m);
  add(bound.max_torque, other.eccentricity_m, reference.eccentricity_m);
  add(bound.tilt_stiffness, other.tilt_stiffness_Nm_per_rad[0],
      reference.tilt_stiffness_Nm_per_rad[0]);
  return bound;
}

}  // namespace softfinger
