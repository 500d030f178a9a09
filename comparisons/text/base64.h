#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Arrays as text without loss, for VTU files and for pages.
namespace softfinger::text {

/// RFC 4648 with padding.
std::string base64(std::string_view bytes);

/// The array's bytes in memory order.
template <typename Number>
std::string_view bytes_of(const std::vector<Number>& numbers) {
  static_assert(std::is_arithmetic_v<Number>);
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

}  // namespace softfinger::text
