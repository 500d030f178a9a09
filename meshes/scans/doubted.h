#pragma once

#include "softfinger/input/triangle_surface.h"

namespace softfinger::meshes {

/// The surface with its vertices moved along their normals by what its facets leave open, or part
/// of it: by as much as a facet's middle lies under the surface, e² kappa / 8 of an edge e across
/// curvature kappa. Programs that thin meshes leave vertices under or over the surface by that
/// order. Signs are random, the same for the same pattern.
/// @param crease_rad  facets that meet more sharply make an edge, across which there is no
/// curvature
TriangleSurface doubted(const TriangleSurface& surface, double crease_rad, double part,
                        unsigned int pattern);

}  // namespace softfinger::meshes
