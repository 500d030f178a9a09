#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "meshes/io/mesh_formats.h"
#include "softfinger/input/triangle_surface.h"

namespace softfinger::robots {

/// Makes an STL of a file in another format than STL and OBJ. Inside softfinger-robot that is done
/// at once, elsewhere by running it.
using MeshConverter = std::function<meshes::ConvertedMesh(const std::string& path)>;

/// The surface of a mesh file, in metres.
/// @param scale  along each axis, of the coordinates in metres. They are in metres as far as the
///               file says its unit; a file that does not is taken to be in metres, so that the
///               scale is its unit. A negative one mirrors.
/// @throws InputError
TriangleSurface read_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                          const MeshConverter& convert);

/// Whether `read_mesh` knows the format, by the file's suffix.
bool is_known_mesh(const std::string& name);

/// Writes a robot's meshes beside its scene: each once, as binary STL in metres.
class MeshFolder {
 public:
  /// @param id  the beginning of the files' names
  MeshFolder(std::filesystem::path folder, std::string id, MeshConverter convert)
      : folder_(std::move(folder)), id_(std::move(id)), convert_(std::move(convert)) {}

  struct Written {
    std::string name;  ///< of the file in the folder
    TriangleSurface surface;
  };
  const Written& add(const std::filesystem::path& file, const Eigen::Vector3d& scale);

 private:
  std::filesystem::path folder_;
  std::string id_;
  MeshConverter convert_;
  std::map<std::string, Written> written_;  ///< by file and scale
};

/// A binary STL file's bytes, in metres, with the title by which `simulate` knows its own.
std::string robot_stl(const TriangleSurface& surface);

}  // namespace softfinger::robots
