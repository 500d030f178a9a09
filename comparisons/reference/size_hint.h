#pragma once

#include <array>
#include <optional>

#include "comparisons/reference/fem_problem.h"

namespace softfinger::reference {

/// Semi-axes of the contact to expect along x and y of the problem's frame (m), from a closed form:
/// bonded_layer, at finite strain finite_strain_layer. The finite elements begin their trial meshes
/// with them. They decide nothing else, so that they are no part of a problem (`to_json`): a result
/// stays valid when a model changes.
/// None where no model tells: sublayers, a given approach, a tapered finger (whose frame is not
/// that of the relative radii).
std::optional<std::array<double, 2>> size_hint_m(const FemProblem& problem);

}  // namespace softfinger::reference
