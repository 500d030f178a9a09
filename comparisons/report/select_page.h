#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger::report {

/// The page of a selection: which model is enough for a case, load by load, before the error atlas.
/// Built from the object described in README.md of this folder; values may be null or missing.
/// @throws std::invalid_argument when `selection` has no array `choices`
std::string render_selection(const nlohmann::json& selection);

/// Page for a scene: what each pair of bodies that touch needs, and what that does to the motion.
/// @throws std::invalid_argument as above
std::string render_scene_selection(const nlohmann::json& selection);

}  // namespace softfinger::report
