#pragma once

/// Attribute of functions that with_best_instructions (wide.h) has to compile for wide
/// instructions. GCC inlines all that such a function calls by `flatten`; clang does so for the
/// first level alone. GCC 12 is not told twice: with both attributes it passed a null reference to
/// a part that it had split off (-O3, batch.cc).
#if defined(__clang__)
#define SOFTFINGER_ALWAYS_INLINE [[gnu::always_inline]]
#else
#define SOFTFINGER_ALWAYS_INLINE
#endif
