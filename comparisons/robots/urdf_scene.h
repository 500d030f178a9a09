#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "comparisons/robots/imported_scene.h"

namespace softfinger::robots {

/// Reads a URDF file by urdfdom and describes it as a scene.
///
/// The root link stands in the world. Links on fixed joints are parts of the body that carries
/// them, but for those with a layer; links without mass are frames. Joints start at 0, or at the
/// limit next to it. A planar joint is two slides and a hinge; a link on a floating joint is free.
/// A link without `<inertial>` weighs what its shapes weigh at 1000 kg/m3. Visual shapes are those
/// of a link that has no collisions. Bodies that a joint connects do not collide.
/// @param meshes  the folder for its meshes, which are written as STL files in metres
/// @param id  of the scene, and the beginning of the files' names
/// @param package_paths  where packages lie, see PackagePaths
/// @throws InputError for a file that urdfdom refuses, files that are not there, numbers that no
/// body can have, and a layer of an unknown link
ImportedScene import_urdf(const std::filesystem::path& file, const std::filesystem::path& meshes,
                          const std::string& id, const std::vector<FingerLayer>& layers,
                          const std::vector<std::string>& package_paths = {});

}  // namespace softfinger::robots
