// The table of errors, and what is made of it: answers for contacts in it and beside it.

#include "comparisons/judgement/atlas/error_atlas.h"

#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

bool read(std::string_view bytes) {
  try {
    const judgement::ErrorAtlas atlas(judgement::parse_atlas(std::string(bytes), "fuzzed.csv"));
    for (const double poisson_ratio : {0., 0.3, 0.5})
      for (const double load_N : {0.1, 5.}) {
        const ContactProblem problem = {
            {0.02, 0.02, 0}, {0.002, 3e5, poisson_ratio}, {load_N, 0.5}, {}, {}};
        for (const char* model : {"hertz", "bonded_layer", "fem"})
          for (const judgement::AtlasKind kind :
               {judgement::AtlasKind::flat, judgement::AtlasKind::curved,
                judgement::AtlasKind::finite_sphere})
            atlas.estimate(model, problem, kind, 0.1);
      }
    atlas.cost_ns("fem");
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// The first lines of each atlas, with one model's columns.
std::vector<std::string> seeds() {
  std::vector<std::string> texts;
  for (const std::string& text : texts_of(SOFTFINGER_ATLASES, ".csv")) {
    std::string seed;
    int lines = 0;
    for (std::size_t begin = 0; begin < text.size() && lines < 14; ++lines) {
      const std::size_t end = text.find('\n', begin);
      std::size_t cut = begin;
      for (int columns = 39; columns > 0 && cut < end; --columns)
        cut = std::min(text.find(',', cut + 1), end);
      seed += text.substr(begin, cut - begin) + "\n";
      begin = end + 1;
    }
    texts.push_back(seed);
  }
  return texts;
}

}  // namespace

const Target error_atlas = {"error_atlas", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
