// Sweep files: a case, and values for its numbers.

#include <algorithm>

#include "comparisons/sweep/sweep_file.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

bool read(std::string_view bytes) {
  try {
    const sweep::Sweep sweep(std::string(bytes), "fuzzed.toml");
    sweep::Sweep::Cases cases(sweep);
    for (std::size_t point = 0; point < std::min<std::size_t>(sweep.points(), 3); ++point) try {
        cases.at(point);
      } catch (const InputError&) {  // values that do not go together
      }
    return true;
  } catch (const InputError&) {
    return false;
  }
}

std::vector<std::string> seeds() {
  std::vector<std::string> texts = texts_of(SOFTFINGER_SWEEPS, ".toml");
  texts.push_back(
      "id = \"all\"\n[geometry]\nrelative_radii_mm = [20.0, 10.0]\n[layer]\nthickness_mm = "
      "2.0\nyoungs_modulus_kPa = 300.0\npoisson_ratio = 0.45\n[contact]\nload_N = [1, "
      "2]\nfriction_coefficient = 0.8\n[sweep]\n\"layer.thickness_mm\" = [1, 2]\n"
      "\"layer.poisson_ratio\" = { from = 0.1, to = 0.4, steps = 2 }\n"
      "\"geometry.relative_radii_mm[0]\" = { from = 20, to = 50, random = 3, seed = 7 }\n"
      "\"layer.youngs_modulus_kPa\" = { from = 10, to = 1e3, steps = 3, spacing = \"log\" }\n"
      "zip = [[\"layer.thickness_mm\", \"layer.poisson_ratio\"]]\nmodels = [\"hertz\"]\nfem = "
      "false\n");
  return texts;
}

}  // namespace

const Target sweep_toml = {"sweep_toml", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
