#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "softfinger/input/contact_problem.h"

namespace softfinger {

/// Quantity measured on a contact.
enum class MeasuredQuantity { a, b, area, indentation, max_torque, tangential_force };
constexpr std::size_t kMeasuredQuantities = 6;
constexpr std::array<std::string_view, kMeasuredQuantities> kMeasuredQuantityNames{
    "a", "b", "area", "indentation", "max_torque", "tangential_force"};

/// Whether the quantity depends on friction.
constexpr bool is_frictional(MeasuredQuantity quantity) {
  return quantity == MeasuredQuantity::max_torque || quantity == MeasuredQuantity::tangential_force;
}

/// One measured number.
struct Measurement {
  MeasuredQuantity quantity;
  std::size_t contact = 0;  ///< which of Measurements::contacts
  double value = 0;         ///< > 0, SI
  double std = 0;           ///< its standard deviation, SI; 0: not known
};

/// Contacts of one finger, and what was measured on them. The contacts differ in load, and where
/// the geometry was fitted to a region of a mesh in their radii.
struct Measurements {
  std::vector<ContactProblem> contacts;
  std::vector<Measurement> values;
};

}  // namespace softfinger
