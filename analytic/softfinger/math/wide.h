#pragma once

namespace softfinger {

/// Whether the processor has instructions for four doubles at once (AVX2). Tests set it to false,
/// to reach what other processors do.
#if defined(__x86_64__)
inline bool has_wide_instructions = __builtin_cpu_supports("avx2");
#else
inline bool has_wide_instructions = false;
#endif

#if defined(__x86_64__)
template <class Function>
[[gnu::target("avx2"), gnu::flatten]] auto with_wide_instructions(const Function& function) {
  return function();
}
#endif

/// `function()`, compiled twice from the same source: for the instructions that every processor has
/// and, inlined into one function, for wider ones, of which the processor's are taken. Neither
/// fuses multiplications with additions, so that the bits agree.
template <class Function>
auto with_best_instructions(const Function& function) {
#if defined(__x86_64__)
  if (has_wide_instructions) return with_wide_instructions(function);
#endif
  return function();
}

}  // namespace softfinger
