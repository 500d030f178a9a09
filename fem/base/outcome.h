#pragma once

#include <utility>
#include <variant>

namespace softfinger::fem {

/// A value, or the reason why there is none. The caller decides what the reason means: another
/// mesh, other coordinates, or an error.
template <class Value, class Reason>
class Outcome {
 public:
  Outcome(Value value) : either_(std::in_place_index<0>, std::move(value)) {}
  Outcome(Reason reason) : either_(std::in_place_index<1>, std::move(reason)) {}

  explicit operator bool() const { return either_.index() == 0; }

  /// @pre there is a value
  Value& operator*() & { return std::get<0>(either_); }
  const Value& operator*() const& { return std::get<0>(either_); }
  Value operator*() && { return std::get<0>(std::move(either_)); }
  Value* operator->() { return &std::get<0>(either_); }
  const Value* operator->() const { return &std::get<0>(either_); }

  /// @pre there is no value
  const Reason& reason() const { return std::get<1>(either_); }

 private:
  std::variant<Value, Reason> either_;
};

}  // namespace softfinger::fem
