#pragma once

#include <cstddef>

#include "comparisons/report/html.h"
#include "softfinger/input/triangle_surface.h"

/// Surfaces as the scripts with three.js read them.
namespace softfinger::report {

/// Joins the vertices within each cell of a grid, the coarsest that is needed.
TriangleSurface coarsened(const TriangleSurface& surface, std::size_t most_triangles);

/// Vertices of their own for the two sides of a sharp edge, so that shading with vertex normals
/// leaves edges of boxes sharp and fingertips smooth.
TriangleSurface split_at_edges(const TriangleSurface& surface);

/// "positions" and "triangles16" or "triangles32" in base64: x, y, z of the vertices in m as
/// 32-bit floats, and three indices per triangle.
Json surface_json(const TriangleSurface& surface);

}  // namespace softfinger::report
