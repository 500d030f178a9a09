#pragma once

#include <optional>

#include "comparisons/input/scene.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/pressure/pressure_model.h"

/// Which pressure model a contact of a scene gets.
namespace softfinger::simulation {

/// A contact with an ellipse at the scene's nominal load, its layer taken for flat. Nothing for a
/// rigid point contact and where the scene gives e_n.
std::optional<ContactProblem> soft_contact(const input::Scene& scene, int a, int b,
                                           const RelativeRadii& radii);

/// The model that the scene names for these bodies, else the recommended one.
/// @param problem  with the curvature of the finger
const PressureModel& model_of_contact(const input::Scene& scene, int a, int b,
                                      const ContactProblem& problem);

/// Area of the contact at the scene's nominal load by its model; 0 where it has none. From it
/// follows over which region a quadric is fitted to a mesh.
double predicted_area_m2(const input::Scene& scene, int a, int b, const RelativeRadii& radii);

}  // namespace softfinger::simulation
