#pragma once

#include <utility>

namespace softfinger {

/// body(0), body(1), ..., without a loop: the compiler would not always take it apart, and vectors
/// of an array would then go through memory.
template <class Body, int... numbers>
inline void repeat(const Body& body, std::integer_sequence<int, numbers...>) {
  (body(numbers), ...);
}
template <int count, class Body>
inline void repeat(const Body& body) {
  repeat(body, std::make_integer_sequence<int, count>());
}

}  // namespace softfinger
