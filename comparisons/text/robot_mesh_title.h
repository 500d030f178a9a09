#pragma once

#include <string_view>

namespace softfinger::text {

/// Beginning of the STL files that are made of a robot's meshes. `simulate --write-scene` replaces
/// no other file that has such a file's name.
constexpr std::string_view kRobotMeshTitle = "softfinger: mesh of a robot, metres";

}  // namespace softfinger::text
