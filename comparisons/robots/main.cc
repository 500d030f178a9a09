// softfinger-robot FILE MESHES ID [BODY THICKNESS_MM YOUNGS_MODULUS_kPa POISSON_RATIO]...
// Writes a robot's file as a scene to standard output, and what is not as in the file to standard
// error, a line each. `softfinger simulate` runs it: a program of its own, so that `softfinger`
// does not load MuJoCo, and so that a file at which MuJoCo gives up ends nothing else.
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

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

/// @param words  file, folder for meshes, id
ImportedScene import(const std::vector<std::string>& words,
                     const std::vector<FingerLayer>& layers) {
  const std::filesystem::path file = words[0];
  std::string suffix = file.extension().string();
  for (char& letter : suffix) letter = char(std::tolower(static_cast<unsigned char>(letter)));
  if (suffix == ".sdf") {
#ifdef SOFTFINGER_HAS_SDFORMAT
    return softfinger::robots::import_sdf(file, words[2], layers);
#else
    throw InputError(words[0], "suffix", ".sdf",
                     "MJCF or URDF: this program was built without libsdformat-dev");
#endif
  }
#ifdef SOFTFINGER_HAS_MUJOCO
  mju_user_error = give_up;
  mju_user_warning = note;
  const InputError no_number(words[0], "number", "NaN", "finite numbers");
  try {
    ImportedScene scene = softfinger::robots::import_robot(file, words[1], words[2], layers);
    if (has_nan) throw no_number;
    return scene;
  } catch (const std::exception&) {
    // Whatever else is wrong with such a file follows from that.
    if (has_nan) throw no_number;
    throw;
  }
#else
  throw InputError(words[0], "suffix", suffix,
                   ".sdf: this program was built without libmujoco-dev");
#endif
}

}  // namespace

int main(int argc, char** argv) {
  softfinger::meshes::open_standard_descriptors();
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 3 || (words.size() - 3) % 4 != 0) {
    say("softfinger-robot FILE MESHES ID [BODY THICKNESS_MM YOUNGS_MODULUS_kPa POISSON_RATIO]...");
    return kBadInput;
  }
  try {
    std::vector<FingerLayer> layers;
    for (std::size_t i = 3; i < words.size(); i += 4)
      layers.push_back(
          {words[i], std::stod(words[i + 1]), std::stod(words[i + 2]), std::stod(words[i + 3])});
    const ImportedScene scene = import(words, layers);
    for (const std::string& line : scene.notes) say(line);
    std::fwrite(scene.text.data(), 1, scene.text.size(), stdout);
    return std::fflush(stdout) == 0 ? 0 : kBadInput;
  } catch (const std::exception& error) {
    say(error.what());
    return kBadInput;
  }
}
