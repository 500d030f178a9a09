#pragma once

#include <Eigen/Core>
#include <functional>

#include "meshes/generation/layer_mesh.h"

namespace softfinger::meshes {

/// Divides the cells of a mesh along its sheets. A sheet is what cells make that follow each other
/// through opposite faces: parallel edges of a cell belong to one sheet, and all of a sheet's edges
/// are divided into the same number of equal parts. So the faces of the cells still fit together,
/// and a cell that is too long in one direction becomes no smaller in the others. What is divided
/// goes on to the mesh's ends.
/// @param parts  wanted of an edge, by its two vertices, >= 1: a sheet has the most of its edges'
LayerMesh divide_sheets(const LayerMesh& mesh, const std::function<int(int, int)>& parts);

}  // namespace softfinger::meshes
