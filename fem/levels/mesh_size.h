#pragma once

#include <string>

#include "fem/levels/contact_physics.h"

/// The size of the meshes that a contact is solved on.
namespace softfinger::fem {

/// The next mesh grows by this factor where a contact reaches the rim of the patch: there its
/// moments are only a lower bound of its size.
constexpr double growth_at_rim = 1.3;

/// Rounds to one part in a thousand, so that contacts of one size ask for the very same mesh. That
/// is far below a cell, which is what the edge has to meet.
double rounded(double semi_axis);

/// Makes the mesh for a contact of these semi-axes, rounded.
void fit_to(double a, double b, LayerDiscretisation& mesh);

/// The difference in size of a contact and the mesh it is on: the larger |ln| of both ratios.
double misfit(const LayerDiscretisation& mesh, double a, double b);

/// @throws InputError where the finger's surface ends within the patch
void check_reach(const LayerDiscretisation& mesh, const Problem& problem);

/// Tells how many unknowns a mesh from outside makes. Its cells are halved until they are small
/// enough, which may make far more of them than anybody expects.
/// @param name  of the mesh, for the line of progress
void tell_unknowns(const std::string& name, const LayerDiscretisation& mesh,
                   const ContactPhysics& physics, const ContactTask& task);

}  // namespace softfinger::fem
