#pragma once

#include <cstdint>

namespace softfinger::internal {

/// Random numbers of [0, 1) that depend on nothing but their two indices (SplitMix64), so that a
/// problem is solved the same way in every run and in every thread.
inline double hash_to_unit(std::uint64_t first, std::uint64_t second) {
  std::uint64_t x =
      first * 0x9e3779b97f4a7c15u + second * 0xd1b54a32d192ed03u + 0x8cb92ba72f3d8dd7u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return double((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

}  // namespace softfinger::internal
