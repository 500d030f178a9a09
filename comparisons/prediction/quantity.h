#pragma once

#include <array>
#include <string>

#include "softfinger/accuracy/error_bound.h"

namespace softfinger::prediction {

/// The numbers of a contact that models are compared in, in the order of tables.
enum class Quantity { a, b, indentation, area, peak_pressure, max_torque };
constexpr int kQuantities = 6;
/// The names that JSON and command lines use.
constexpr std::array<const char*, kQuantities> kQuantityNames = {
    "a", "b", "indentation", "area", "peak_pressure", "max_torque"};
using QuantityErrors = std::array<double, kQuantities>;  ///< relative

/// Demand of a user on an answer: these quantities within the tolerance.
struct Demand {
  double tolerance = 0.1;  ///< relative
  QuantityChoice quantities = kUsualQuantities;

  bool is_met_by(const QuantityErrors& errors) const {
    return worst_of(errors, quantities) <= tolerance;
  }
};

/// "within 10 %", or "within 5 % in a, area" of other than the usual quantities.
std::string in_words(const Demand& demand);

}  // namespace softfinger::prediction
