#pragma once

#include <deal.II/grid/tria.h>

#include "fem/layer/dimension.h"
#include "fem/layer/layer_discretisation.h"

namespace softfinger::meshes {
struct LayerMesh;
}

/// A layer's mesh that the user supplies ("from outside"). Internal to this room.
namespace softfinger::fem {

/// Divides the mesh along sheets and halves its cells until those of the patch are small enough,
/// with as few cells as these two operations allow.
void triangulate(const meshes::LayerMesh& mesh, double thickness,
                 const LayerDiscretisation& discretisation,
                 dealii::Triangulation<dim>& triangulation);

/// The number of cells along b, by the largest of them in the patch; 0 where there are none.
int cells_along_b(const LayerDiscretisation& discretisation,
                  const dealii::Triangulation<dim>& triangulation);

}  // namespace softfinger::fem
