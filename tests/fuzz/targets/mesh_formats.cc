// Meshes in other formats than STL and OBJ, as softfinger-robot converts them.

#include "tests/meshes/mesh_formats.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <optional>

#include "comparisons/robots/foreign_mesh.h"
#include "meshes/io/read_surface.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

/// Reads what the reader has made, which has to be a mesh or to be refused as one.
bool is_surface(const meshes::ConvertedMesh& mesh) {
  if (mesh.stl.size() < 84 + 50 || (mesh.stl.size() - 84) % 50 != 0) std::terminate();
  try {
    return !meshes::parse_converted_surface(mesh, "fuzzed", std::nullopt).surface.triangles.empty();
  } catch (const InputError&) {
    return false;
  }
}

tests::FilePart part(const char* name) {
  tests::FilePart made;
  made.name = name;
  made.surface = {{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}},
                  {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  return made;
}

std::vector<tests::FilePart> parts() {
  tests::FilePart moved = part("b");
  moved.place.translate(Eigen::Vector3d(20, 0, 1));
  return {part("a"), moved};
}

/// Bytes that are no archive are the model of one, which is where the words are.
bool read_3mf(std::string_view bytes) {
  std::string file(bytes);
  if (bytes.substr(0, 2) != "PK") file = tests::zip_of({{"3D/3dmodel.model", file}});
  try {
    return is_surface(robots::convert_mesh_bytes(std::move(file), "fuzzed.3mf", ""));
  } catch (const InputError&) {
    return false;
  }
}

std::vector<std::string> seeds_of_3mf() {
  const std::string model = tests::model_of(parts(), "");
  std::string composed = tests::model_of({part("a")}, "inch");
  composed.replace(
      composed.find("</resources>"), 12,
      "<object id=\"7\"><components><component objectid=\"1\" transform=\"1 0 0 0 1 0 0 "
      "0 1 5 5 5\"/>\n<component objectid=\"1\"/></components></object>\n</resources>");
  composed.replace(composed.find("item objectid=\"1\""), 17, "item objectid=\"7\"");
  return {model, composed, tests::threemf_of(parts(), "millimeter"),
          tests::threemf_of(parts(), "centimeter", true)};
}

#ifdef SOFTFINGER_HAS_ASSIMP
/// The first letters show the format, as far as the seeds are kept.
std::string name_of(std::string_view bytes) {
  if (bytes.substr(0, 3) == "ply") return "fuzzed.ply";
  if (bytes.substr(0, 4) == "glTF") return "fuzzed.glb";
  return bytes.substr(0, 1) == "{" ? "fuzzed.gltf" : "fuzzed.dae";
}

/// Converts in a process of its own, as everywhere: a fault of Assimp ends only that.
bool read_by_assimp(std::string_view bytes) {
  constexpr int kLongest_ms = 20000;
  int ends[2];
  if (pipe(ends) != 0) std::terminate();
  const pid_t child = fork();
  if (child < 0) std::terminate();
  if (child == 0) {
    alarm(kLongest_ms / 1000);
    // A fault shall not write down where it was.
    close(STDERR_FILENO);
    try {
      const meshes::ConvertedMesh mesh =
          robots::convert_mesh_bytes(std::string(bytes), name_of(bytes), "");
      std::size_t at = 0;
      while (at < mesh.stl.size()) {
        const ssize_t written = write(ends[1], mesh.stl.data() + at, mesh.stl.size() - at);
        if (written <= 0) _exit(3);
        at += std::size_t(written);
      }
      _exit(0);
    } catch (const InputError&) {
      _exit(2);
    }
  }
  close(ends[1]);
  meshes::ConvertedMesh mesh;
  char buffer[4096];
  for (;;) {
    const ssize_t count = read(ends[0], buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;  // libFuzzer's clock
    if (count <= 0) break;
    mesh.stl.append(buffer, std::size_t(count));
  }
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 && is_surface(mesh);
}

std::vector<std::string> seeds_of_assimp() {
  const TriangleSurface surface = part("a").surface;
  return {tests::dae_of(parts(), "0.001", "Z_UP"), tests::dae_of({part("a")}, "", ""),
          tests::glb_of(parts()), tests::ply_of(surface, false), tests::ply_of(surface, true)};
}
#else
bool read_by_assimp(std::string_view) { return false; }
std::vector<std::string> seeds_of_assimp() { return {}; }
#endif

}  // namespace

const Target mesh_3mf = {"mesh_3mf", read_3mf, seeds_of_3mf, nullptr, true};
const Target mesh_assimp = {"mesh_assimp", read_by_assimp, seeds_of_assimp, nullptr, true};

}  // namespace softfinger::fuzz
