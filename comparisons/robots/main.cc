// softfinger-robot FILE MESHES ID [--package-path DIR]...
//                  [BODY THICKNESS_MM YOUNGS_MODULUS_kPa POISSON_RATIO]...
// Writes a robot's file as a scene to standard output, and what is not as in the file to standard
// error, a line each. `softfinger simulate` runs it: a program of its own, so that `softfinger`
// does not load MuJoCo, and so that a file at which MuJoCo gives up ends nothing else.
//
// softfinger-robot --mesh FILE [PART]
// Writes a mesh in another format than STL and OBJ to standard output: the line "metres_per_unit
// 0.001", or without a number where the file does not say its unit; then a binary STL in that unit.
// Every command of `softfinger` that reads a mesh runs it.
#include <fmt/format.h>

#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "comparisons/robots/foreign_mesh.h"
#include "comparisons/robots/imported_scene.h"
#include "meshes/io/output_file.h"
#include "softfinger/input/errors.h"
#ifdef SOFTFINGER_HAS_MUJOCO
#include <mujoco/mujoco.h>

#include "comparisons/robots/mujoco_scene.h"
#endif
#ifdef SOFTFINGER_HAS_SDFORMAT
#include "comparisons/robots/sdf_scene.h"
#endif
#ifdef SOFTFINGER_HAS_URDFDOM
#include "comparisons/robots/urdf_scene.h"
#endif

namespace {

constexpr int kBadInput = 2;

void say(std::string line) {
  for (char& letter : line)
    if (static_cast<unsigned char>(letter) < 0x20) letter = ' ';
  std::fprintf(stderr, "%s\n", line.c_str());
}

#ifdef SOFTFINGER_HAS_MUJOCO
/// MuJoCo's own way out would leave a file of its own in the working directory.
void give_up(const char* message) {
  say(std::string("MuJoCo cannot go on: ") + message);
  std::_Exit(kBadInput);
}

/// MuJoCo only warns of numbers that are none, once for each, and reads on.
bool has_nan = false;

void note(const char* message) {
  if (std::string_view(message).find("'NaN'") != std::string_view::npos)
    has_nan = true;
  else
    say(std::string("MuJoCo: ") + message);
}
#endif

using softfinger::InputError;
using softfinger::robots::FingerLayer;
using softfinger::robots::ImportedScene;

/// Whether an XML file is URDF: its root element begins so, behind comments and declarations.
bool is_urdf(const std::filesystem::path& file, const std::string& suffix) {
  if (suffix == ".urdf" || suffix == ".xacro") return true;
  std::ifstream stream(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(stream)), {});
  std::size_t at = 0;
  while ((at = text.find('<', at)) != std::string::npos) {
    const char* const end = text.compare(at, 4, "<!--") == 0 ? "-->"
                            : text.compare(at, 2, "<?") == 0 ? "?>"
                            : text.compare(at, 2, "<!") == 0 ? ">"
                                                             : nullptr;
    if (!end) return text.compare(at, 6, "<robot") == 0;
    at = text.find(end, at);
  }
  return false;
}

struct Words {
  std::string file, meshes, id;
  std::vector<std::string> package_paths;
  std::vector<FingerLayer> layers;
};

ImportedScene import(const Words& words) {
  const std::filesystem::path file = words.file;
  std::string suffix = file.extension().string();
  for (char& letter : suffix) letter = char(std::tolower(static_cast<unsigned char>(letter)));
  if (suffix == ".sdf") {
#ifdef SOFTFINGER_HAS_SDFORMAT
    return softfinger::robots::import_sdf(file, words.id, words.layers);
#else
    throw InputError(words.file, "suffix", ".sdf",
                     "MJCF or URDF: this program was built without libsdformat-dev");
#endif
  }
  if (is_urdf(file, suffix)) {
#ifdef SOFTFINGER_HAS_URDFDOM
    return softfinger::robots::import_urdf(file, words.meshes, words.id, words.layers,
                                           words.package_paths);
#else
    throw InputError(words.file, "format", "URDF",
                     "MJCF or SDF: this program was built without liburdfdom-dev");
#endif
  }
#ifdef SOFTFINGER_HAS_MUJOCO
  mju_user_error = give_up;
  mju_user_warning = note;
  const InputError no_number(words.file, "number", "NaN", "finite numbers");
  try {
    ImportedScene scene =
        softfinger::robots::import_robot(file, words.meshes, words.id, words.layers);
    if (has_nan) throw no_number;
    return scene;
  } catch (const std::exception&) {
    // Whatever else is wrong with such a file follows from that.
    if (has_nan) throw no_number;
    throw;
  }
#else
  throw InputError(words.file, "suffix", suffix,
                   ".sdf or .urdf: this program was built without libmujoco-dev");
#endif
}

int write_out(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  return std::fflush(stdout) == 0 ? 0 : kBadInput;
}

int write_mesh(const std::string& file, const std::string& part) {
  try {
    const softfinger::meshes::ConvertedMesh mesh = softfinger::robots::convert_mesh(file, part);
    if (!mesh.note.empty()) say(mesh.note);
    const std::string unit = mesh.metres_per_unit ? fmt::format(" {}", *mesh.metres_per_unit) : "";
    return write_out("metres_per_unit" + unit + "\n" + mesh.stl);
  } catch (const std::bad_alloc&) {
    say(file + ": it needs more memory than there is");
  } catch (const std::exception& error) {
    say(error.what());
  }
  return kBadInput;
}

}  // namespace

int main(int argc, char** argv) {
  softfinger::meshes::open_standard_descriptors();
  const std::vector<std::string> typed(argv + 1, argv + argc);
  if ((typed.size() == 2 || typed.size() == 3) && typed[0] == "--mesh")
    return write_mesh(typed[1], typed.size() == 3 ? typed[2] : "");
  std::size_t next = 3;
  Words words;
  for (; next + 1 < typed.size() && typed[next] == "--package-path"; next += 2)
    words.package_paths.push_back(typed[next + 1]);
  if (typed.size() < 3 || (typed.size() - next) % 4 != 0) {
    say("softfinger-robot FILE MESHES ID [--package-path DIR]... "
        "[BODY THICKNESS_MM YOUNGS_MODULUS_kPa POISSON_RATIO]...; or softfinger-robot --mesh FILE "
        "[PART]");
    return kBadInput;
  }
  words.file = typed[0];
  words.meshes = typed[1];
  words.id = typed[2];
  try {
    for (std::size_t i = next; i < typed.size(); i += 4)
      words.layers.push_back(
          {typed[i], std::stod(typed[i + 1]), std::stod(typed[i + 2]), std::stod(typed[i + 3])});
    const ImportedScene scene = import(words);
    for (const std::string& line : scene.notes) say(line);
    return write_out(scene.text);
  } catch (const std::exception& error) {
    say(error.what());
    return kBadInput;
  }
}
