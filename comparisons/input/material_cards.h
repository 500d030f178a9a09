#pragma once

#include <string_view>
#include <vector>

namespace softfinger::input {

/// A hyperelastic material of the finite elements, as `softfinger explain` shows it. The equations
/// are those of fem/problem/material_choice.h: this program does not load the finite elements.
struct MaterialCard {
  std::string_view name;  ///< as in the case file
  std::string_view title, energy, parameters, source, validity;
};

const std::vector<MaterialCard>& material_cards();

}  // namespace softfinger::input
