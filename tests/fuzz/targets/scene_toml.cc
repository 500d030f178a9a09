// Scene files.

#include <algorithm>

#include "comparisons/input/scene.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

bool read(std::string_view bytes) {
  try {
    input::parse_scene(std::string(bytes), "fuzzed.toml");
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// Scenes without meshes, which a build without gmsh lacks.
std::vector<std::string> seeds() {
  std::vector<std::string> texts = texts_of(SOFTFINGER_SCENES, ".toml");
  texts.erase(std::remove_if(texts.begin(), texts.end(),
                             [](const std::string& text) {
                               return text.find("mesh = ") != std::string::npos;
                             }),
              texts.end());
  return texts;
}

}  // namespace

const Target scene_toml = {"scene_toml", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
