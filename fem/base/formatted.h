#pragma once

#include <string>

namespace softfinger::fem {

/// A text by the format of std::printf, as long as it needs to be.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

}  // namespace softfinger::fem
