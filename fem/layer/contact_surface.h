#pragma once

#include <deal.II/base/point.h>

#include <vector>

#include "fem/layer/layer_space.h"

/// The surface where contact is possible: its nodes, with their share of it, and its faces.
/// Internal to this room.
namespace softfinger::fem {

/// Collects the surface of our own block: only the finest faces, which form a regular grid of
/// rectangles.
/// @param support  place of each dof in the block
/// @param at_end   per dof: where the surface ends
/// @param on_edge  per dof: where the finger does, at a sharp edge
void collect_finest_faces(const std::vector<dealii::Point<dim>>& support,
                          const std::vector<char>& at_end, const std::vector<char>& on_edge,
                          LayerSpace& space);

/// Collects the surface of a mesh from outside. Its faces are any quadrilaterals, so that their
/// areas and normals are integrated.
/// @param support  place of each dof on the mesh
/// @param at_end   per dof: on a face beside the contact surface
void collect_contact_faces(const std::vector<dealii::Point<dim>>& support,
                           const std::vector<char>& at_end, LayerSpace& space);

}  // namespace softfinger::fem
