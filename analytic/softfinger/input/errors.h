#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

namespace softfinger {

namespace internal {

/// A number in a message.
inline std::string number_text(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace internal

/// A value from outside that cannot be used. `what()` is the one line that the user reads:
/// "<where>: <field> = <value>: allowed: <allowed>".
class InputError : public std::runtime_error {
 public:
  /// @param where    file, with line where known ("tip.toml:12"), or the flag's name
  /// @param field    the name that the user typed, unit suffix included
  /// @param value    the offending value as text; may be empty
  /// @param allowed  what would have been accepted, as text; may be empty
  InputError(const std::string& where, const std::string& field, const std::string& value,
             const std::string& allowed)
      : std::runtime_error(where + ": " + field + (value.empty() ? "" : " = " + value) +
                           (allowed.empty() ? "" : ": allowed: " + allowed)),
        where_(where),
        field_(field),
        value_(value),
        allowed_(allowed) {}

  /// Takes the offending value as a number, which is shown with six digits.
  InputError(const std::string& where, const std::string& field, double value,
             const std::string& allowed)
      : InputError(where, field, internal::number_text(value, 6), allowed) {}

  const std::string& where() const { return where_; }
  const std::string& field() const { return field_; }
  const std::string& value() const { return value_; }
  const std::string& allowed() const { return allowed_; }

 private:
  std::string where_, field_, value_, allowed_;
};

/// An iteration that did not reach its tolerance. The hint names the usual cause.
class ConvergenceError : public std::runtime_error {
 public:
  ConvergenceError(const std::string& stage, int iteration, double residual,
                   const std::string& hint)
      : std::runtime_error(stage + " did not converge: iteration " + std::to_string(iteration) +
                           ", residual " + internal::number_text(residual, 3) + "; hint: " + hint),
        iteration_(iteration),
        residual_(residual) {}

  int iteration() const { return iteration_; }
  double residual() const { return residual_; }

 private:
  int iteration_;
  double residual_;
};

}  // namespace softfinger
