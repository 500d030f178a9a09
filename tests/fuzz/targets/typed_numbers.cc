// Values typed as options: numbers, lists of them, KEY=VALUE.

#include <cmath>
#include <exception>

#include "comparisons/input/setting.h"
#include "comparisons/text/number.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

bool read(std::string_view bytes) {
  const auto numbers = text::read_numbers(bytes);
  if (numbers) {
    for (const double number : *numbers)
      if (!std::isfinite(number)) std::terminate();
    // Nothing but digits, signs, points, exponents, commas and blanks can be numbers.
    if (bytes.find_first_not_of("0123456789+-.eE, \t") != std::string_view::npos) std::terminate();
  }
  try {
    const std::string typed(bytes);
    input::require_each_key_once(
        {input::parse_setting(typed), input::parse_setting("layer.thickness_mm=2")});
    return true;
  } catch (const InputError&) {
    return numbers.has_value();
  }
}

std::vector<std::string> seeds() {
  return {
      "1,5", "0.5", "-1e-3, +.5", "20,10", "contact.load_N=3", "geometry.relative_radii_mm[0]=1"};
}

}  // namespace

const Target typed_numbers = {"typed_numbers", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
