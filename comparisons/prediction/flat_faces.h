#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/input/triangle_surface.h"

/// Flat faces of a triangulated surface: pads and places to stand on.
namespace softfinger::prediction {

/// Facets that hang together over edges and lie in one plane, within 1e-5 of the surface's size (a
/// file's rounding).
struct FlatFace {
  Eigen::Vector3d middle_m;          ///< on the face, far from its edges
  Eigen::Vector3d normal;            ///< outward, of length 1
  double length_m = 0, width_m = 0;  ///< sides of the smallest rectangle around it, length >= width
  double area_m2 = 0;
  double room_m = 0;          ///< from `middle_m` to the nearest edge
  bool is_outermost = false;  ///< all of the surface lies behind it: the body can stand on it
  std::vector<int> triangles;

  /// Whether the face goes all the way round something, as the rim of a cup does.
  bool is_ring() const { return area_m2 < 0.4 * length_m * width_m; }
};

/// The flat faces that are wide enough to be a pad, with room for a circle of a twentieth of the
/// surface's width, the largest first. Cost: linear in the number of triangles, but for their sort.
std::vector<FlatFace> flat_faces(const TriangleSurface& surface);

/// The one of `faces` on which the surface's point nearest to this one lies; null for none.
const FlatFace* face_at(const TriangleSurface& surface, const std::vector<FlatFace>& faces,
                        const Eigen::Vector3d& point_m);

/// A face as the outline of a pad.
struct FaceOutline {
  /// The origin lies in the middle of the smallest rectangle around the face, z points outward and
  /// x along the rectangle's longer side.
  Eigen::Isometry3d in_surface = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector2d> hull_m;  ///< convex, counter-clockwise
  double length_m = 0, width_m = 0;     ///< of that rectangle
  double filled = 0;                    ///< the face's area over its hull's

  bool is_rectangle() const;
};
FaceOutline outline_of(const TriangleSurface& surface, const FlatFace& face);
/// @param points_m  corners of faces in one plane
/// @param area_m2   of these faces together
FaceOutline outline_of(const std::vector<Eigen::Vector3d>& points_m, const Eigen::Vector3d& normal,
                       double area_m2);

/// "flat, 22 x 37 mm: a pad", the shorter side first.
std::string in_words(const FlatFace& face);

}  // namespace softfinger::prediction
