#pragma once

#include <optional>

#include "comparisons/input/case.h"
#include "comparisons/prediction/local_geometry.h"

namespace softfinger::reference {

/// Effects that the reference is asked to leave out, although the case leaves them open.
struct Idealisations {
  bool linear = false;  ///< linear elasticity
  bool flat = false;    ///< a flat layer under the quadric gap
};

/// The case with the reference that it deserves, where its [fem] chooses none: two bodies as they
/// are, the layer curved over the finger's own core; finite strain as soon as it changes a number
/// by more than the finite elements' stated error. A user's own mesh of the layer stays what it is,
/// and layers on both bodies are flat and linear.
/// @param geometry    of the case
/// @param approach_m  by which it is pressed in place of its loads
input::Case with_full_reference(input::Case contact_case,
                                const prediction::GeometryResolver& geometry,
                                const Idealisations& idealisations,
                                std::optional<double> approach_m = std::nullopt);

/// Whether a case as it is solved leaves out nothing that its full reference has, whatever its
/// [fem] or the command line asked for.
bool is_full_reference(const input::Case& solved, const prediction::GeometryResolver& geometry,
                       std::optional<double> approach_m = std::nullopt);

}  // namespace softfinger::reference
