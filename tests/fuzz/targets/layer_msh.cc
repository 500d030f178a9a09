// Users' meshes of the layer, gmsh's MSH format.

#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"
#if __has_include("meshes/io/read_msh.h")
#include "meshes/io/read_msh.h"
#endif

namespace softfinger::fuzz {
namespace {

#if __has_include("meshes/io/read_msh.h")

bool read(std::string_view bytes) {
  try {
    meshes::parse_msh(bytes, "fuzzed.msh");
    return true;
  } catch (const InputError&) {
    return false;
  }
}

constexpr const char* kNames =
    "$PhysicalNames\n3\n2 1 \"contact\"\n2 2 \"core\"\n3 3 \"layer\"\n$EndPhysicalNames\n";

/// One cube in each version, ASCII and binary.
std::vector<std::string> seeds() {
  constexpr double corners[8][3] = {{0, 0, -1}, {1, 0, -1}, {1, 1, -1}, {0, 1, -1},
                                    {0, 0, 0},  {1, 0, 0},  {1, 1, 0},  {0, 1, 0}};
  const auto header = [](const char* version, bool binary) {
    std::string text = std::string("$MeshFormat\n") + version + (binary ? " 1 8\n" : " 0 8\n");
    const int one = 1;
    if (binary) text.append(reinterpret_cast<const char*>(&one), sizeof one) += '\n';
    return text + "$EndMeshFormat\n";
  };
  const auto append = [](std::string& text, const auto&... values) {
    (text.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  };
  std::string old_ascii = header("2.2", false) + kNames + "$Nodes\n8\n",
              old_binary = header("2.2", true) + kNames + "$Nodes\n8\n",
              entities =
                  "$Entities\n0 0 2 1\n1 0 0 0 1 1 0 1 1 0\n2 0 0 -1 1 1 -1 1 2 0\n"
                  "1 0 0 -1 1 1 0 1 3 0\n$EndEntities\n",
              new_ascii = header("4.1", false) + kNames + entities + "$Nodes\n1 8 1 8\n3 1 0 8\n";
  std::string coordinates;
  for (int node = 0; node < 8; ++node) {
    const auto& x = corners[node];
    std::string line;
    for (const double value : x) line += " " + std::to_string(value);
    old_ascii += std::to_string(node + 1) + line + "\n";
    append(old_binary, node + 1, x[0], x[1], x[2]);
    new_ascii += std::to_string(node + 1) + "\n";
    coordinates += line + "\n";
  }
  old_ascii +=
      "$EndNodes\n$Elements\n3\n1 3 2 1 1 5 6 7 8\n2 3 2 2 2 1 2 3 4\n3 5 2 3 1 1 2 3 4 5 6 7 8\n"
      "$EndElements\n";
  old_binary += "\n$EndNodes\n$Elements\n3\n";
  append(old_binary, 3, 2, 2, 1, 1, 1, 5, 6, 7, 8, 2, 2, 2, 1, 2, 3, 4);
  append(old_binary, 5, 1, 2, 3, 3, 1, 1, 2, 3, 4, 5, 6, 7, 8);
  old_binary += "\n$EndElements\n";
  new_ascii += coordinates +
               "$EndNodes\n$Elements\n3 3 1 3\n2 1 3 1\n1 5 6 7 8\n2 2 3 1\n2 1 2 3 4\n3 1 5 1\n"
               "3 1 2 3 4 5 6 7 8\n$EndElements\n";
  return {old_ascii, old_binary, new_ascii};
}

#else

// The reader is not there yet.
bool read(std::string_view) { return false; }
std::vector<std::string> seeds() { return {}; }

#endif

}  // namespace

const Target layer_msh = {"layer_msh", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
