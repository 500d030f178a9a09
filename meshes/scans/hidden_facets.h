#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "softfinger/input/triangle_surface.h"

namespace softfinger::meshes {

/// Which facets lie inside of a body: walls of a shell, a core under the skin, parts of what it was
/// assembled from. Nothing that comes from outside touches them.
///
/// A facet is hidden where none of its points that are tried is seen from outside: in each of seven
/// directions, along the normal and at 50 degrees to it, another facet is in the way.
/// @param facets   indices of those that count: as what is looked at and as what is in the way
/// @param normals  of all triangles, unit
/// @returns for each of `facets`. None of them where all would be: then the surface is inside out.
///          Of surfaces that take too long, slivers that cross by the thousand, only some
std::vector<bool> hidden_facets(const TriangleSurface& surface,
                                const std::vector<std::size_t>& facets,
                                const std::vector<Eigen::Vector3d>& normals);

/// The surface without its hidden facets, those without an area and those farther than `within`
/// from the origin. Vertices keep their numbers.
TriangleSurface seen_surface(const TriangleSurface& surface, double within);

/// The surface without the parts of it that lie inside, and without the vertices that only these
/// have. A face is what kinks of at most 35 degrees do not end. It is left out as a whole where 90
/// % of it is hidden, as the inside of a hollow tip; the rest of a cup's inside stays, though one
/// sees little of it. Of other faces hidden facets are left out that lie in the solid of another
/// part, as where parts of an assembly overlap. Normals of facets without an area do not matter:
/// those stay.
///
/// Cost: sorting the edges; for surfaces of several faces a tree of boxes and a few thousand rays,
/// and of several parts three rays per facet.
TriangleSurface outer_skin(const TriangleSurface& surface);

}  // namespace softfinger::meshes
