// Entry points of libFuzzer, for the target SOFTFINGER_FUZZ_TARGET.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "tests/fuzz/target.h"

namespace fuzz = softfinger::fuzz;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t largest);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::SOFTFINGER_FUZZ_TARGET.read({reinterpret_cast<const char*>(data), size});
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t largest, unsigned seed) {
  const fuzz::Target& target = fuzz::SOFTFINGER_FUZZ_TARGET;
  std::mt19937 generator(seed);
  const unsigned choice = generator() % 16;
  // Bytes are changed as well: only they find what no line or number shows.
  if (!target.is_text || choice < 8) return LLVMFuzzerMutate(data, size, largest);
  std::string text(reinterpret_cast<const char*>(data), size);
  if (target.random && choice < 10) text = target.random(generator);
  for (unsigned changes = 1 + generator() % 3; changes > 0; --changes)
    text = fuzz::change_text(text, generator);
  size = std::min(text.size(), largest);
  std::memcpy(data, text.data(), size);
  return size;
}
