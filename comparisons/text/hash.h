#pragma once

#include <cstdint>
#include <string_view>

namespace softfinger::text {

/// FNV-1a (Fowler, Noll, Vo), 64 bits: tells texts apart that nobody forged, the same on every
/// machine.
constexpr std::uint64_t hash_of(std::string_view bytes) noexcept {
  std::uint64_t hash = 14695981039346656037u;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  return hash;
}

}  // namespace softfinger::text
