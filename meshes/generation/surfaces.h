#pragma once

#include "softfinger/input/triangle_surface.h"

/// Object and fingertip surfaces, triangulated by gmsh: what the built-in mesh cases touch. They are written
/// as STL and go through the same path as a user's own files.
namespace softfinger::meshes {

/// Shadow-like distal pad: a convex pad with a larger radius along the finger than across it,
/// the cross-section tapering towards the tip. Pad faces -y, tip at +z, as on the hand's own link.
struct FingertipPad {
  double across_radius_m = 7e-3;   ///< of the cross-section at the pad's middle
  double along_radius_m = 25e-3;   ///< of the pad's profile along the finger, at its middle
  double length_m = 26e-3;
  double tip_to_base_width = 0.75; ///< ratio of the widths: the taper
  double edge_length_m = 0.6e-3;
};
TriangleSurface fingertip_pad(const FingertipPad& shape);

/// A drinking glass as a surface of revolution about z: conical wall, rounded foot.
TriangleSurface glass(double foot_radius_m, double rim_radius_m, double height_m, double edge_length_m);
TriangleSurface rounded_box(double side_m, double edge_radius_m, double edge_length_m);
TriangleSurface cylinder(double radius_m, double length_m, double edge_length_m);
TriangleSurface sphere(double radius_m, double edge_length_m);

}  // namespace softfinger::meshes
