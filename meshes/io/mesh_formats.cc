#include "meshes/io/mesh_formats.h"

#include <cctype>
#include <filesystem>

namespace softfinger::meshes {

const MeshFormat* mesh_format(const std::string& path) {
  static constexpr MeshFormat kFormats[] = {
      {".stl", "STL", false, false, false}, {".obj", "OBJ", false, false, false},
      {".dae", "DAE", true, true, true},    {".glb", "GLB", true, true, true},
      {".gltf", "glTF", true, true, true},  {".ply", "PLY", true, false, false},
      {".3mf", "3MF", true, true, true}};
  std::string suffix = std::filesystem::path(path).extension().string();
  for (char& letter : suffix) letter = char(std::tolower(static_cast<unsigned char>(letter)));
  for (const MeshFormat& format : kFormats)
    if (suffix == format.suffix) return &format;
  return nullptr;
}

bool is_converted_mesh(const std::string& path) {
  const MeshFormat* format = mesh_format(path);
  return format && format->is_converted;
}

}  // namespace softfinger::meshes
