#pragma once

namespace softfinger {

/// Four doubles whose arithmetic is that of each: one instruction where the processor has it.
/// Short loops the compiler takes apart before it sees what they are.
constexpr int kFour = 4;
using Four [[gnu::vector_size(kFour * sizeof(double))]] = double;
/// Result of four comparisons: all bits of an element are set, or none.
using FourConditions = decltype(Four{} > Four{});

/// Four doubles in memory of any alignment. A copy of bytes would go through the stack by halves.
using FourInMemory
    [[gnu::vector_size(kFour * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] =
        double;

/// By reference, because what would return them depends on the instructions.
inline void load(const double* from, Four& to) {
  to = *reinterpret_cast<const FourInMemory*>(from);
}
inline void store(const Four& from, double* to) { *reinterpret_cast<FourInMemory*>(to) = from; }

/// The rows of a matrix become its columns.
inline void transpose(Four& a, Four& b, Four& c, Four& d) {
  const Four ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Four ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Four cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

/// Whether the processor has instructions for four doubles at once (AVX2, FMA). Tests set it to
/// false, to reach what other processors do.
#if defined(__x86_64__)
inline bool has_wide_instructions = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
inline bool has_wide_instructions = false;
#endif

#if defined(__x86_64__)
template <class Function>
[[gnu::target("avx2,fma"), gnu::flatten]] auto with_wide_instructions(const Function& function) {
  return function();
}
#endif

/// `function()`, compiled twice from the same source: for the instructions that every processor has
/// and, inlined into one function, for wider ones, of which the processor's are taken. Neither
/// fuses multiplications with additions that the source does not, so that the bits agree.
template <class Function>
auto with_best_instructions(const Function& function) {
#if defined(__x86_64__)
  if (has_wide_instructions) return with_wide_instructions(function);
#endif
  return function();
}

}  // namespace softfinger
