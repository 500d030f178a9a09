#pragma once

#include <string_view>

#include "comparisons/input/scene.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/pressure/pressure_model.h"

/// Which pressure model a contact of a scene gets: model only what the scene requires.
namespace softfinger::simulation {

/// The model of a contact with an ellipse; null: a rigid point contact, or an eccentricity that is
/// given. `problem` receives the contact for the scene's nominal load.
const PressureModel* model_of_contact(const input::Scene& scene, int a, int b,
                                      const RelativeRadii& radii, ContactProblem& problem);

/// Area of the contact at the scene's nominal load, by its model, 0 where there is none: the
/// size of the region that stands for a mesh.
double predicted_area_m2(const input::Scene& scene, int a, int b, const RelativeRadii& radii);

}  // namespace softfinger::simulation
