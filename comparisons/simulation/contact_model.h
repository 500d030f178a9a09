#pragma once

#include <string_view>

#include "comparisons/input/scene.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/pressure/pressure_model.h"

/// Which pressure model a contact of a scene gets.
namespace softfinger::simulation {

/// The model of a contact with an ellipse.
/// @param problem  receives the contact at the scene's nominal load
/// @returns null for a rigid point contact and where the scene gives e_n
const PressureModel* model_of_contact(const input::Scene& scene, int a, int b,
                                      const RelativeRadii& radii, ContactProblem& problem);

/// Area of the contact at the scene's nominal load by its model; 0 where it has none. From it
/// follows over which region a quadric is fitted to a mesh.
double predicted_area_m2(const input::Scene& scene, int a, int b, const RelativeRadii& radii);

}  // namespace softfinger::simulation
