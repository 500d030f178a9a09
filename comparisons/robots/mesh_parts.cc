#include "comparisons/robots/mesh_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "comparisons/robots/imported_scene.h"
#include "meshes/io/read_surface.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

/// Nodes that carry triangles, themselves or by what hangs on them.
std::vector<bool> carriers(const MeshParts& parts) {
  std::vector<bool> carries(parts.nodes.size(), false);
  for (std::size_t n = parts.nodes.size(); n-- > 0;) {
    const PartNode& node = parts.nodes[n];
    for (const std::size_t mesh : node.meshes)
      if (!parts.meshes[mesh].triangles.empty()) carries[n] = true;
    if (carries[n] && node.parent >= 0) carries[std::size_t(node.parent)] = true;
  }
  return carries;
}

/// The names by which parts can be chosen, each once.
std::vector<std::string> names_of(const MeshParts& parts) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  };
  const std::vector<bool> carries = carriers(parts);
  for (std::size_t n = 0; n < parts.nodes.size(); ++n)
    // A root that only holds the others is all of the file.
    if (carries[n] && (parts.nodes[n].parent >= 0 || !parts.nodes[n].meshes.empty()))
      add(parts.nodes[n].name);
  for (const PartMesh& mesh : parts.meshes)
    if (!mesh.triangles.empty()) add(mesh.name);
  return names;
}

[[noreturn]] void refuse_part(const MeshParts& parts, const std::string& path,
                              const std::string& part) {
  constexpr std::size_t kMostListed = 12;
  const std::vector<std::string> names = names_of(parts);
  std::string listed;
  for (std::size_t i = 0; i < std::min(names.size(), kMostListed); ++i)
    listed += (i > 0 ? ", " : "") + in_quotes(names[i].substr(0, kLongestName));
  if (names.size() > kMostListed) listed += fmt::format(" and {} more", names.size() - kMostListed);
  throw InputError(path, "part", in_quotes(part.substr(0, kLongestName)),
                   names.empty() ? "none: the file's parts have no names" : listed);
}

/// Adds triangles to an STL file's bytes.
class StlText {
 public:
  explicit StlText(const std::string& path) : path_(path), bytes_(84, ' ') {}

  void add(const PartMesh& mesh, const Affine3d& place) {
    // The count below stays within 32 bits, and the file within what the reader takes.
    if (mesh.triangles.size() > meshes::kMostTriangles - count_)
      throw InputError(path_, "triangles", fmt::format("more than {}", meshes::kMostTriangles),
                       fmt::format("at most {}", meshes::kMostTriangles));
    for (const auto& corners : mesh.triangles) {
      float triangle[12] = {0, 0, 0};  // the normal first, which readers compute anew
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const int index = corners[corner];
        if (index < 0 || std::size_t(index) >= mesh.vertices.size())
          throw InputError(path_, in_mesh(mesh) + "vertex index", std::to_string(index),
                           fmt::format("0 to {}", std::int64_t(mesh.vertices.size()) - 1));
        const Vector3d vertex = place * mesh.vertices[std::size_t(index)];
        for (int axis = 0; axis < 3; ++axis) {
          triangle[3 + 3 * corner + std::size_t(axis)] = float(vertex[axis]);
          if (!std::isfinite(float(vertex[axis])))
            throw InputError(path_, in_mesh(mesh) + "vertex " + std::to_string(index),
                             fmt::format("{}", vertex[axis]), "finite numbers");
        }
      }
      bytes_.append(reinterpret_cast<const char*>(triangle), sizeof triangle);
      bytes_.append(2, '\0');
    }
    count_ += mesh.triangles.size();
  }

  std::string finish() {
    if (count_ == 0) throw InputError(path_, "triangles", "0", "at least one");
    const auto count = std::uint32_t(count_);
    std::copy_n(reinterpret_cast<const char*>(&count), sizeof count, bytes_.begin() + 80);
    return std::move(bytes_);
  }

 private:
  static std::string in_mesh(const PartMesh& mesh) {
    return mesh.name.empty() ? "" : "mesh " + in_quotes(mesh.name.substr(0, kLongestName)) + ": ";
  }

  const std::string& path_;
  std::string bytes_;
  std::size_t count_ = 0;
};

}  // namespace

meshes::ConvertedMesh merged(const MeshParts& parts, const std::string& path,
                             const std::string& part) {
  if (parts.metres_per_unit &&
      !(*parts.metres_per_unit > 0 && std::isfinite(*parts.metres_per_unit)))
    throw InputError(path, "unit", *parts.metres_per_unit, "a finite number > 0, in metres");
  const bool is_node = std::any_of(parts.nodes.begin(), parts.nodes.end(),
                                   [&](const PartNode& node) { return node.name == part; });
  bool is_found = part.empty();
  std::vector<Affine3d> places;
  std::vector<bool> chosen;
  StlText stl(path);
  for (const PartNode& node : parts.nodes) {
    const auto parent = std::size_t(std::max(node.parent, 0));
    places.push_back(node.parent < 0 ? node.in_parent : places[parent] * node.in_parent);
    chosen.push_back(part.empty() || (is_node && node.name == part) ||
                     (node.parent >= 0 && chosen[parent]));
    for (const std::size_t index : node.meshes) {
      const PartMesh& mesh = parts.meshes[index];
      if (!chosen.back() && (is_node || mesh.name != part)) continue;
      is_found = true;
      stl.add(mesh, places.back());
    }
  }
  if (!is_found) refuse_part(parts, path, part);
  meshes::ConvertedMesh result;
  result.metres_per_unit = parts.metres_per_unit;
  if (parts.left_out > 0)
    result.note = fmt::format("{} points and lines were left out", parts.left_out);
  result.stl = stl.finish();
  return result;
}

}  // namespace softfinger::robots
