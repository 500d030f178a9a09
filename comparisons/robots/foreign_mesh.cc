#include "comparisons/robots/foreign_mesh.h"

#include <string_view>
#include <utility>

#include "comparisons/robots/imported_scene.h"
#include "comparisons/robots/mesh_parts.h"
#include "comparisons/robots/threemf_mesh.h"
#include "meshes/io/read_surface.h"
#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"
#ifdef SOFTFINGER_HAS_ASSIMP
#include "comparisons/robots/assimp_mesh.h"
#endif

namespace softfinger::robots {

meshes::ConvertedMesh convert_mesh_bytes(std::string bytes, const std::string& path,
                                         const std::string& part) {
  const meshes::MeshFormat* format = meshes::mesh_format(path);
  if (!format || !format->is_converted)
    throw InputError(path, "format", format ? format->name : "unknown",
                     "DAE, GLB, glTF, PLY or 3MF, by the suffix of its name");
  if (!part.empty() && !format->has_parts)
    throw InputError(path, "part", in_quotes(part.substr(0, kLongestName)),
                     std::string("none: a ") + format->name + " file has no parts with names");
  if (format->suffix == std::string_view(".3mf"))
    return merged(read_3mf(std::move(bytes), path), path, part);
#ifdef SOFTFINGER_HAS_ASSIMP
  return merged(read_by_assimp(std::move(bytes), path), path, part);
#else
  throw InputError(path, "format", format->name,
                   "STL, OBJ or 3MF: softfinger-robot was built without Assimp (Debian: "
                   "libassimp-dev); install that and build again, or convert the file to STL");
#endif
}

meshes::ConvertedMesh convert_mesh(const std::string& path, const std::string& part) {
  return convert_mesh_bytes(
      meshes::read_whole_file(path, "file", "a readable mesh", meshes::kLargestSurface_bytes), path,
      part);
}

}  // namespace softfinger::robots
