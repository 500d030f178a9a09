#pragma once

#include <deal.II/grid/tria.h>

#include "fem/layer/dimension.h"
#include "fem/layer/layer_discretisation.h"
#include "fem/problem/mirror_planes.h"
#include "meshes/generation/layer_block.h"

/// Our own mesh of a layer: a flat block of hexahedra, which is mapped onto the finger later.
/// Internal to this room.
namespace softfinger::fem {

/// The coarse lattice that, halved `refinements` times, gives cells of the size the contact asks
/// for.
struct Lattice {
  meshes::LayerBlock block;
  int refinements = 0;
};

/// @param coarsest  longest cells, in thicknesses
Lattice plan_lattice(const LayerDiscretisation& discretisation, double coarsest);

/// The mesh from its quarter x, y >= 0, on one side of mirror planes.
meshes::HexahedralMesh with_images(const meshes::HexahedralMesh& quarter, MirrorPlanes planes);

/// Drops cells that are not connected by vertices with those at the origin.
void keep_cells_around_contact(meshes::HexahedralMesh& mesh);

void make_triangulation(const meshes::HexahedralMesh& mesh,
                        dealii::Triangulation<dim>& triangulation);

/// Halves the cells near the patch, level by level, so that cell size grows with the distance.
void refine_towards_patch(const LayerDiscretisation& discretisation, int refinements,
                          dealii::Triangulation<dim>& triangulation);

}  // namespace softfinger::fem
