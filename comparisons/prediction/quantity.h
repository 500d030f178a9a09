#pragma once

#include <array>

namespace softfinger::prediction {

/// The numbers of a contact that models are compared in, in the order of tables.
enum class Quantity { a, b, indentation, area, peak_pressure, max_torque };
constexpr int kQuantities = 6;
/// As JSON and command lines call them.
constexpr std::array<const char*, kQuantities> kQuantityNames = {
    "a", "b", "indentation", "area", "peak_pressure", "max_torque"};
using QuantityErrors = std::array<double, kQuantities>;  ///< relative

}  // namespace softfinger::prediction
