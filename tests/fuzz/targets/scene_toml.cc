// Scene files.

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

std::vector<std::string> seeds() { return texts_of(SOFTFINGER_SCENES, ".toml"); }

}  // namespace

const Target scene_toml = {"scene_toml", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
