#include "comparisons/robots/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <ostream>

#include "comparisons/robots/imported_scene.h"
#include "comparisons/text/robot_mesh_title.h"
#include "meshes/io/read_surface.h"
#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {

using Eigen::Vector3d;

bool is_known_mesh(const std::string& name) { return meshes::mesh_format(name) != nullptr; }

TriangleSurface read_mesh(const std::filesystem::path& file, const Vector3d& scale,
                          const MeshConverter& convert) {
  const double largest = scale.cwiseAbs().maxCoeff();
  if (!(scale.cwiseAbs().minCoeff() > 0) || !scale.allFinite())
    throw InputError(file.string(), "scale", list(scale), "three numbers that are not 0");
  if (!is_known_mesh(file.filename().string()))
    throw InputError(file.string(), "format", in_quotes(file.extension().string()),
                     std::string(meshes::kMeshFormats) + ": convert the file, and name that one");
  TriangleSurface surface;
  if (meshes::is_converted_mesh(file.string())) {
    const meshes::ConvertedMesh mesh = convert(file.string());
    surface = meshes::parse_converted_surface(mesh, file.string(),
                                              largest * mesh.metres_per_unit.value_or(1))
                  .surface;
  } else {
    surface = meshes::read_surface(file.string(), largest).surface;
  }
  const Vector3d rest = scale / largest;
  for (Vector3d& vertex : surface.vertices_m) vertex = vertex.cwiseProduct(rest).eval();
  // A mirror turns the triangles round.
  if (rest.prod() < 0)
    for (auto& corners : surface.triangles) std::swap(corners[1], corners[2]);
  return surface;
}

std::string robot_stl(const TriangleSurface& surface) {
  const auto count = std::uint32_t(surface.triangles.size());
  std::string stl(text::kRobotMeshTitle);
  stl.resize(80, ' ');
  stl.append(reinterpret_cast<const char*>(&count), 4);
  for (const auto& corners : surface.triangles) {
    float triangle[12] = {0, 0, 0};  // the normal first, which readers compute anew
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (int axis = 0; axis < 3; ++axis)
        triangle[3 + 3 * corner + std::size_t(axis)] =
            float(surface.vertices_m[std::size_t(corners[corner])][axis]);
    stl.append(reinterpret_cast<const char*>(triangle), sizeof triangle);
    stl.append(2, '\0');
  }
  return stl;
}

const MeshFolder::Written& MeshFolder::add(const std::filesystem::path& file,
                                           const Vector3d& scale) {
  const std::string key = file.string() + list(scale);
  const auto found = written_.find(key);
  if (found != written_.end()) return found->second;
  Written written{fmt::format("{}_mesh_{}.stl", id_, written_.size()),
                  read_mesh(file, scale, convert_)};
  const std::string stl = robot_stl(written.surface);
  meshes::write_whole_file((folder_ / written.name).string(),
                           [&](std::ostream& out) { out << stl; });
  return written_.emplace(key, std::move(written)).first->second;
}

}  // namespace softfinger::robots
