// softfinger-robot FILE MESHES ID [BODY THICKNESS_MM YOUNGS_MODULUS_kPa POISSON_RATIO]...
// Writes a robot's file as a scene to standard output, and what is not as in the file to standard
// error, a line each. `softfinger simulate` runs it: a program of its own, so that `softfinger`
// does not load MuJoCo, and so that a file at which MuJoCo gives up ends nothing else.
#include <mujoco/mujoco.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "comparisons/robots/mujoco_scene.h"
#include "softfinger/input/errors.h"

namespace {

constexpr int kBadInput = 2;

void say(std::string line) {
  for (char& letter : line)
    if (static_cast<unsigned char>(letter) < 0x20) letter = ' ';
  std::fprintf(stderr, "%s\n", line.c_str());
}

/// MuJoCo's own way out would leave a file of its own in the working directory.
void give_up(const char* message) {
  say(std::string("MuJoCo cannot go on: ") + message);
  std::_Exit(kBadInput);
}

void note(const char* message) { say(std::string("MuJoCo: ") + message); }

}  // namespace

int main(int argc, char** argv) {
  using namespace softfinger;
  mju_user_error = give_up;
  mju_user_warning = note;
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 3 || (words.size() - 3) % 4 != 0) {
    say("softfinger-robot FILE MESHES ID [BODY THICKNESS_MM YOUNGS_MODULUS_kPa POISSON_RATIO]...");
    return kBadInput;
  }
  try {
    std::vector<robots::FingerLayer> layers;
    for (std::size_t i = 3; i < words.size(); i += 4)
      layers.push_back(
          {words[i], std::stod(words[i + 1]), std::stod(words[i + 2]), std::stod(words[i + 3])});
    const robots::ImportedScene scene = robots::import_robot(words[0], words[1], words[2], layers);
    for (const std::string& line : scene.notes) say(line);
    std::fwrite(scene.text.data(), 1, scene.text.size(), stdout);
    return std::fflush(stdout) == 0 ? 0 : kBadInput;
  } catch (const std::exception& error) {
    say(error.what());
    return kBadInput;
  }
}
