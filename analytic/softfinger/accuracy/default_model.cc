#include "softfinger/accuracy/default_model.h"

#include <cmath>

#include "softfinger/layer/fingertip_layer_core.h"

namespace softfinger {
namespace {

/// Whether layer and bodies have the shapes that `fingertip_layer` was fitted to. The load does not
/// enter. Written so that what is no number does not have them.
bool has_fitted_shape(const ContactProblem& problem) {
  if (problem.has_object_layer()) return false;
  const RelativeRadii& radii = problem.radii;
  const SurfaceCurvature& finger = problem.finger_curvature;
  const double h = problem.layer.thickness_m;
  const double mean_per_m = 0.5 * (finger.xx_per_m + finger.yy_per_m);
  const double spread_per_m =
      std::hypot(0.5 * (finger.xx_per_m - finger.yy_per_m), finger.xy_per_m);
  constexpr double kRoundOff = 1e-9;
  const bool is_convex =
      mean_per_m - spread_per_m >= -kRoundOff * std::abs(mean_per_m + spread_per_m);
  return is_convex && h * (mean_per_m + spread_per_m) <= kFingertipRange.largest_bend &&
         h <= kFingertipRange.largest_flat_thickness * std::sqrt(radii.major_m) *
                  std::sqrt(radii.minor_m) &&
         radii.major_m <= kFingertipRange.largest_radii_ratio * (1 + kRoundOff) * radii.minor_m;
}

}  // namespace

const PressureModel& default_model(const ContactProblem& problem) noexcept {
  static const PressureModel &fingertip = *find_pressure_model("fingertip_layer"),
                             &layer = *find_pressure_model("bonded_layer"),
                             &half_space = *find_pressure_model("hertz"),
                             &stack = *find_pressure_model("stack_layer");
  if (problem.stack.count > 1) return stack;
  if (has_fitted_shape(problem)) return fingertip;
  if (layer.predict(problem).has_answer) return layer;
  return problem.has_object_layer() && stack.predict(problem).has_answer ? stack : half_space;
}

}  // namespace softfinger
