#pragma once

#include <stdexcept>
#include <string>

namespace softfinger {

/// A value from outside that cannot be used. `what()` is the one line that the user reads:
/// "<where>: <field> = <value> <unit>: allowed: <allowed>".
class InputError : public std::runtime_error {
 public:
  /// @param where    file, with line where known ("tip.toml:12"), or the flag's name
  /// @param field    the name that the user typed, unit suffix included
  /// @param value    the offending value as text
  /// @param allowed  what would have been accepted, as text
  InputError(std::string where, std::string field, std::string value, std::string allowed)
      : std::runtime_error(where + ": " + field + (value.empty() ? "" : " = " + value) +
                           (allowed.empty() ? "" : ": allowed: " + allowed)),
        where(std::move(where)),
        field(std::move(field)),
        value(std::move(value)),
        allowed(std::move(allowed)) {}

  const std::string where, field, value, allowed;
};

/// An iteration that did not reach its tolerance. The hint names the usual cause.
class ConvergenceError : public std::runtime_error {
 public:
  ConvergenceError(const std::string& stage, int iteration, double residual, const std::string& hint)
      : std::runtime_error(stage + " did not converge: iteration " + std::to_string(iteration) +
                           ", residual " + std::to_string(residual) + "; " + hint),
        iteration(iteration),
        residual(residual) {}

  const int iteration;
  const double residual;
};

}  // namespace softfinger
