#pragma once

#include <string>

#include "comparisons/robots/mesh_parts.h"

namespace softfinger::robots {

/// Reads a DAE, GLB, glTF or PLY file by Assimp: its triangles and their places alone. Animations,
/// skins, materials and textures are not read. Files that it names (the buffers of glTF) are opened
/// in its own folder and below, nowhere else, and nothing is fetched.
///
/// Coordinates stay in the file's own axes: `up_axis` of a DAE file turns nothing. That is what
/// those do who load robots' meshes: RViz and MoveIt clear the rotation that Assimp makes of it
/// (rviz issue 1045, geometric_shapes pull request 52), Gazebo does not look at it (gazebo-classic
/// issue 1305), and public robots' DAE files lie as their STL files do whichever axis they say.
/// glTF has y upwards by definition; there, too, nobody turns a robot's meshes. The unit of a DAE
/// file, on the other hand, is applied by all of them.
/// @param bytes  of the file
/// @param path   for messages, and for the folder of what it names
/// @throws InputError
MeshParts read_by_assimp(std::string bytes, const std::string& path);

}  // namespace softfinger::robots
