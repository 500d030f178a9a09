#include "comparisons/simulation/contact_model.h"

#include <variant>

#include "softfinger/accuracy/default_model.h"

namespace softfinger::simulation {

std::optional<ContactProblem> soft_contact(const input::Scene& scene, int a, int b,
                                           const RelativeRadii& radii) {
  const input::ContactRule& rule = scene.rule(a, b);
  const auto& layer_a = scene.bodies[std::size_t(a)].layer;
  const auto& layer_b = scene.bodies[std::size_t(b)].layer;
  if (std::holds_alternative<input::RigidPoint>(rule.model) ||
      std::holds_alternative<input::GivenEccentricity>(rule.model) || (!layer_a && !layer_b))
    return std::nullopt;
  ContactProblem problem;
  problem.radii = radii;
  problem.layer = layer_a ? *layer_a : *layer_b;
  if (layer_a && layer_b) problem.object_layer = *layer_b;
  problem.load = {scene.nominal_load_N, rule.shear_law.friction_coefficient};
  return problem;
}

const PressureModel& model_of_contact(const input::Scene& scene, int a, int b,
                                      const ContactProblem& problem) {
  const auto* named = std::get_if<const PressureModel*>(&scene.rule(a, b).model);
  return named ? **named : default_model(problem);
}

double predicted_area_m2(const input::Scene& scene, int a, int b, const RelativeRadii& radii) {
  const auto problem = soft_contact(scene, a, b, radii);
  if (!problem) return 0;
  const Prediction prediction = model_of_contact(scene, a, b, *problem).predict(*problem);
  return prediction.has_answer ? prediction.area_m2() : 0;
}

}  // namespace softfinger::simulation
