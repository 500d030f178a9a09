#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "comparisons/robots/imported_scene.h"

namespace softfinger::robots {

/// Reads a robot's file in MJCF by MuJoCo and describes it as a scene.
///
/// Bodies start where the first keyframe puts them, else at the reference positions, with joints
/// moved into their limits, and with the keyframe's velocities. Bodies with several joints become
/// chains of massless ones, those whose geoms touch others differently several fixed to each other.
/// Triangle meshes are written as STL files in metres.
/// @param meshes  the folder for them
/// @param id  of the scene, and the beginning of the files' names
/// @throws InputError for a file that MuJoCo refuses, a shape or body that a scene cannot hold, and
/// a layer of an unknown body
ImportedScene import_robot(const std::filesystem::path& file, const std::filesystem::path& meshes,
                           const std::string& id, const std::vector<FingerLayer>& layers);

}  // namespace softfinger::robots
