// Surfaces: STL, binary and ASCII, and OBJ.

#include <cstdint>
#include <cstring>
#include <exception>
#include <optional>

#include "meshes/io/read_surface.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

bool read_as(std::string_view bytes, const char* name) {
  try {
    const meshes::SurfaceFile file = meshes::parse_surface(std::string(bytes), name, std::nullopt);
    for (const auto& triangle : file.surface.triangles)
      for (const int vertex : triangle)
        if (vertex < 0 || std::size_t(vertex) >= file.surface.vertices_m.size()) std::terminate();
    return true;
  } catch (const InputError&) {
    return false;
  }
}

bool read_stl(std::string_view bytes) { return read_as(bytes, "fuzzed.stl"); }
bool read_obj(std::string_view bytes) { return read_as(bytes, "fuzzed.obj"); }

/// A tetrahedron's faces, in mm.
constexpr float kFaces[4][3][3] = {{{0, 0, 0}, {0, 9, 0}, {9, 0, 0}},
                                   {{0, 0, 0}, {9, 0, 0}, {0, 0, 9}},
                                   {{0, 0, 0}, {0, 0, 9}, {0, 9, 0}},
                                   {{9, 0, 0}, {0, 9, 0}, {0, 0, 9}}};

std::vector<std::string> stl_seeds() {
  std::string ascii = "solid tip\n", binary(80, ' ');
  const std::uint32_t count = 4;
  const auto append = [&binary](const auto& value) {
    binary.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(count);
  const float normal[3] = {0, 0, 1};
  for (const auto& face : kFaces) {
    ascii += "facet normal 0 0 1\nouter loop\n";
    append(normal);
    for (const auto& vertex : face) {
      ascii += "vertex";
      for (const float x : vertex) ascii += " " + std::to_string(x);
      ascii += "\n";
      append(vertex);
    }
    ascii += "endloop\nendfacet\n";
    append(std::uint16_t{0});
  }
  ascii += "endsolid tip\n";
  return {ascii, binary, "\xEF\xBB\xBF" + ascii, binary + "a note"};
}

std::vector<std::string> obj_seeds() {
  const std::string vertices = "# tip\nv 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\n";
  return {vertices + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
          "mtllib tip.mtl\no tip\n" + vertices +
              "vt 0 0\nvn 0 0 1\ng all\nusemtl skin\ns off\nf 1/1/1 3/1/1 2/1/1\nf -4//1 -3//1 "
              "-1//1\nf 1/1 \\\n 4/1 3/1\n",
          vertices + "v 9 9 0 1.0\nf 1 2 5 3\nl 1 2\np 1\n"};
}

}  // namespace

const Target surface_stl = {"surface_stl", read_stl, stl_seeds, nullptr, true};
const Target surface_obj = {"surface_obj", read_obj, obj_seeds, nullptr, true};

}  // namespace softfinger::fuzz
