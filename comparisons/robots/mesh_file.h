#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>

#include "softfinger/input/triangle_surface.h"

namespace softfinger::robots {

/// The surface of a mesh file, in metres.
/// @param scale  from the file's unit to metres, along each axis; a negative one mirrors
/// @throws InputError
TriangleSurface read_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale);

/// Whether `read_mesh` knows the format, by the file's suffix.
bool is_known_mesh(const std::string& name);

/// Writes a robot's meshes beside its scene: each once, as binary STL in metres.
class MeshFolder {
 public:
  /// @param id  the beginning of the files' names
  MeshFolder(std::filesystem::path folder, std::string id)
      : folder_(std::move(folder)), id_(std::move(id)) {}

  struct Written {
    std::string name;  ///< of the file in the folder
    TriangleSurface surface;
  };
  const Written& add(const std::filesystem::path& file, const Eigen::Vector3d& scale);

 private:
  std::filesystem::path folder_;
  std::string id_;
  std::map<std::string, Written> written_;  ///< by file and scale
};

/// A binary STL file's bytes, in metres, with the title by which `simulate` knows its own.
std::string robot_stl(const TriangleSurface& surface);

}  // namespace softfinger::robots
