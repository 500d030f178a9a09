#include "softfinger/layer/fingertip_layer.h"

#include "softfinger/layer/fingertip_layer_core.h"
#include "softfinger/math/wide.h"

namespace softfinger {

ContactNumbers fingertip_layer_contact(const ContactProblem& problem) noexcept {
  return with_best_instructions([&] {
    return fingertip_layer_numbers(
        contact_input(problem.radii, problem.layer, problem.load.normal_force_N,
                      problem.finger_curvature),
        problem.is_object_spherical ? 1. : 0.);
  });
}

}  // namespace softfinger
