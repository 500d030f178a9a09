#pragma once

#include <string>
#include <vector>

#include "comparisons/report/mesh_page.h"
#include "softfinger/input/triangle_surface.h"

namespace softfinger::report {

/// A picture of the surface as the bytes of a PNG file, 960 x 640: seen from -y, -x, -z above and
/// +y, +x, +z below, all to one scale, with a bar of whole millimetres. Discs mark the points, in
/// the views that they face.
/// @param surface  with at least one triangle, m
std::string mesh_picture(const TriangleSurface& surface, const std::vector<MeshPoint>& points);

}  // namespace softfinger::report
