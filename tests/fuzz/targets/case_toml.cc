// Case files.

#include "comparisons/input/case.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

bool read(std::string_view bytes) {
  try {
    input::parse_case(std::string(bytes), "fuzzed.toml", {}, input::FlatPads::taken);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

std::vector<std::string> seeds() {
  std::vector<std::string> texts = texts_of(SOFTFINGER_CASES, ".toml");
  texts.push_back(
      "id = \"measured\"\n[geometry]\nfinger = { radii_mm = [9.0, 7.0], shape = \"tapered\", "
      "taper_per_mm = 0.02 }\nobject = { radii_mm = [inf, -30.0] }\nangle_deg = 20\n[[layer]]\n"
      "name = \"skin\"\nthickness_mm = 1\nyoungs_modulus_kPa = 300\npoisson_ratio = 0.45\n"
      "[[layer]]\nthickness_mm = 2\nyoungs_modulus_kPa = 100\npoisson_ratio = 0.4\n"
      "[object_layer]\nthickness_mm = 3\nyoungs_modulus_kPa = 900\npoisson_ratio = 0.3\n"
      "[power_law]\npressure_exponent = 2.5\ndata = [[1, 2.0], [2, 2.4], [4, 2.9]]\n[contact]\n"
      "load_N = [1, 2.5, 1e1]\nfriction_coefficient = 0.8\n");
  texts.push_back(
      "id = \"scan\"\n[geometry]\nfinger = { mesh = \"tip.stl\", unit = \"m\", along = \"-y\" }\n"
      "object = { sphere_radius_mm = 10 }\n[layer]\nthickness_mm = 1\nyoungs_modulus_kPa = 300\n"
      "poisson_ratio = 0.45\n[contact]\nload_N = 1\nfriction_coefficient = 0.8\n");
  return texts;
}

}  // namespace

const Target case_toml = {"case_toml", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
