#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace softfinger {

/// FNV-1a (Fowler, Noll, Vo), 64 bits: distinguishes texts that nobody forged, the same on every
/// machine. No library that is linked anyway has a hash; this one finds each changed byte, because
/// every step is one to one, and misses one of 2^64 other changes.
/// @param begun  the hash of the bytes before these, to hash a text in pieces
constexpr std::uint64_t hash_of(std::string_view bytes,
                                std::uint64_t begun = 14695981039346656037u) noexcept {
  std::uint64_t hash = begun;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  return hash;
}

/// A hash as it is kept in files: 16 hexadecimal digits.
inline std::string hash_text(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace softfinger
