#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "comparisons/local_geometry.h"
#include "comparisons/selection/model_choice.h"

namespace softfinger {

/// A choice and the contact it is for.
struct LoadChoice {
  LocalGeometry geometry;
  ContactProblem problem;
  Choice choice;
};

/// What select.html is made of (report/README.md): the choices, stated errors over the load, causes
/// of the torque's error in the nearest run of the atlas, the atlas itself. About a second.
nlohmann::json selection_report(const Case& contact_case, const GeometryResolver& resolver,
                                const SelectionOptions& options,
                                const std::vector<LoadChoice>& choices, const std::string& command);

}  // namespace softfinger
