#pragma once

#include <string>

namespace softfinger::text {

/// A ratio in per cent: two digits, or as many as stand before the point. "0.41 %", "124 %"
std::string percent(double ratio);

}  // namespace softfinger::text
