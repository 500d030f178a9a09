#include "comparisons/simulation/contact_model.h"

#include <variant>

namespace softfinger::simulation {

const PressureModel* model_of_contact(const input::Scene& scene, int a, int b,
                                      const RelativeRadii& radii, ContactProblem& problem) {
  const input::ContactRule& rule = scene.rule(a, b);
  const auto& layer_a = scene.bodies[std::size_t(a)].layer;
  const auto& layer_b = scene.bodies[std::size_t(b)].layer;
  if (std::holds_alternative<input::RigidPoint>(rule.model) ||
      std::holds_alternative<input::GivenEccentricity>(rule.model) || (!layer_a && !layer_b))
    return nullptr;
  problem = {};
  problem.radii = radii;
  problem.layer = layer_a ? *layer_a : *layer_b;
  if (layer_a && layer_b) problem.object_layer = *layer_b;
  problem.load = {scene.nominal_load_N, rule.shear_law.friction_coefficient};
  if (const auto* named = std::get_if<const PressureModel*>(&rule.model)) return *named;
  // The bonded layer holds for every load and thickness and takes a microsecond. Closed forms are
  // cheaper, but hold in part of that range only: they serve where the bonded layer has no answer.
  const PressureModel* best = find_pressure_model("bonded_layer");
  if (best->predict(problem).has_answer) return best;
  for (const PressureModel* model : all_pressure_models())
    if (model->card().hot_path && model->predict(problem).valid()) return model;
  return find_pressure_model("hertz");
}

double predicted_area_m2(const input::Scene& scene, int a, int b, const RelativeRadii& radii) {
  ContactProblem problem;
  if (const PressureModel* model = model_of_contact(scene, a, b, radii, problem)) {
    const Prediction prediction = model->predict(problem);
    if (prediction.has_answer) return prediction.area_m2();
  }
  return 0;
}

}  // namespace softfinger::simulation
