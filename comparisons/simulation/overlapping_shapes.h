#pragma once

#include <string>
#include <vector>

#include "comparisons/input/scene.h"

namespace softfinger::simulation {

/// A sentence for each body whose mass or inertia follows from its shapes and of which a part lies
/// in more than one of them, or twice in one mesh (a shell within another): there it weighs twice.
/// Parts below 0.1 % of the body are taken for rounding. The volumes are those over a grid of 48 x
/// 48 columns, of shapes as 36-sided polyhedra: to a few percent. Time is linear in the triangles.
std::vector<std::string> overlap_remarks(const input::Scene& scene);

}  // namespace softfinger::simulation
