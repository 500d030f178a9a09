// Pictures of contacts.

#include <cmath>
#include <exception>

#include "comparisons/input/mask.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

bool read(std::string_view bytes) {
  bool is_read = false;
  for (const bool is_dark : {false, true}) try {
      const input::MaskedContact contact =
          input::parse_mask(std::string(bytes), 1e-4, is_dark, "fuzzed.png");
      if (!(contact.area_m2 > 0 && contact.b_m > 0 && contact.b_m <= contact.a_m &&
            contact.area_std_m2 > 0 && std::isfinite(contact.a_m)))
        std::terminate();
      is_read = true;
    } catch (const InputError&) {
    }
  return is_read;
}

std::vector<std::string> seeds() { return texts_of(SOFTFINGER_MEASUREMENTS, ".png"); }

}  // namespace

const Target mask_png = {"mask_png", read, seeds, nullptr, false};

}  // namespace softfinger::fuzz
