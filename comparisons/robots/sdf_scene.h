#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "comparisons/robots/imported_scene.h"

namespace softfinger::robots {

/// Reads the models of an SDF file by libsdformat and describes them as a scene.
///
/// Bodies are links; one of a file with several models is called model_link. Joints start at 0,
/// where the file places the links. A joint that closes a ring becomes a loop. A link whose
/// collisions have different surfaces becomes several bodies fixed to each other; one without
/// gravity gets a force of its weight.
/// @param id  of the scene
/// @throws InputError for a file that libsdformat refuses, a joint or shape that a scene cannot
/// hold, and a layer of an unknown body
ImportedScene import_sdf(const std::filesystem::path& file, const std::string& id,
                         const std::vector<FingerLayer>& layers);

}  // namespace softfinger::robots
