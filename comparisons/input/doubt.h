#pragma once

#include <string>
#include <vector>

namespace softfinger::input {

/// A number of a case that its user is not sure of: `{ value = 300, factor = 2 }`, which lies
/// between 150 and 600, or `{ value = 0.8, std = 0.1 }`, which lies between 0.6 and 1.
struct Doubt {
  std::string key;              ///< "layer.youngs_modulus_kPa", "contact.load_N[0]"
  double value = 0;             ///< in the file's unit, as the two bounds are
  double lower = 0, upper = 0;  ///< the interval that holds 95 %
};
using Doubts = std::vector<Doubt>;

}  // namespace softfinger::input
