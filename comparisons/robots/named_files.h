#pragma once

#include <filesystem>

namespace softfinger::robots {

/// Looks at the files that a robot's file names (meshes, textures, included files and what those
/// name) before MuJoCo opens them: it would wait for whoever writes to a pipe.
/// @throws InputError for one that is a pipe, a socket or a device, with the line that names it
void refuse_named_pipes(const std::filesystem::path& file);

}  // namespace softfinger::robots
