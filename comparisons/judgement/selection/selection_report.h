#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "comparisons/judgement/selection/model_choice.h"
#include "comparisons/prediction/local_geometry.h"

namespace softfinger::judgement {

/// A choice and the contact it is for.
struct LoadChoice {
  prediction::LocalGeometry geometry;
  ContactProblem problem;
  Choice choice;
};

/// Data of select.html (report/README.md): the choices, stated errors over the load, causes of the
/// torque's error in the nearest run of the atlas, the atlas itself. Takes about a second.
nlohmann::json selection_report(const input::Case& contact_case,
                                const prediction::GeometryResolver& resolver,
                                const SelectionOptions& options,
                                const std::vector<LoadChoice>& choices, const std::string& command);

/// The options' demands beside the tolerance, in words for the page; may be empty.
std::string limits_in_words(const SelectionOptions& options);

/// A choice for a scene or a pad, with what its page says of the models and of its origin.
nlohmann::json with_provenance(const nlohmann::json& choice, const std::string& command);

}  // namespace softfinger::judgement
