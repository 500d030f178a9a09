#include "comparisons/text/percent.h"

#include <fmt/format.h>

namespace softfinger::text {

std::string percent(double ratio) {
  return ratio < 0.0995 ? fmt::format("{:.2g} %", 100 * ratio)
                        : fmt::format("{:.0f} %", 100 * ratio);
}

}  // namespace softfinger::text
