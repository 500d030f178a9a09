#include "meshes/generation/surfaces.h"

#include <gmsh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "meshes/generation/gmsh_session.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

// The modelling kernel's tolerance is absolute, 1e-7: in millimetres that is a tenth of a
// nanometre.
constexpr double kUnitsPerMetre = 1e3;

void require_length(const char* shape, const char* field, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw InputError(shape, field, value, "positive and finite");
}

/// Meshes the boundary of the model's only volume, outward normals, and collects its triangles.
TriangleSurface mesh_boundary(double edge_length_m) {
  gmsh::model::occ::synchronize();
  const double size = edge_length_m * kUnitsPerMetre;
  gmsh::option::setNumber("Mesh.MeshSizeMin", size);
  gmsh::option::setNumber("Mesh.MeshSizeMax", size);
  gmsh::option::setNumber("Mesh.Algorithm", 6);  // frontal Delaunay: the most even triangles
  gmsh::vectorpair volumes;
  gmsh::model::getEntities(volumes, 3);
  gmsh::model::mesh::setOutwardOrientation(volumes.at(0).second);
  gmsh::model::mesh::generate(2);

  std::vector<std::size_t> tags, corners;
  std::vector<double> coordinates, parameters;
  gmsh::model::mesh::getNodes(tags, coordinates, parameters);
  std::unordered_map<std::size_t, std::size_t> position;
  for (std::size_t i = 0; i < tags.size(); ++i) position[tags[i]] = i;
  const int linear_triangle = 2;
  tags.clear();  // gmsh would take the size of a non-empty vector as a request
  gmsh::model::mesh::getElementsByType(linear_triangle, tags, corners);

  TriangleSurface surface;
  std::unordered_map<std::size_t, int>
      index;  // leaves out nodes without a triangle (centres of arcs)
  for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
    std::array<int, 3> triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [entry, added] =
          index.emplace(corners[t + i], static_cast<int>(surface.vertices_m.size()));
      if (added) {
        const double* x = &coordinates[3 * position.at(corners[t + i])];
        surface.vertices_m.push_back(Vector3d(x[0], x[1], x[2]) / kUnitsPerMetre);
      }
      triangle[i] = entry->second;
    }
    surface.triangles.push_back(triangle);
  }
  return surface;
}

/// Meshes the boundary of what `build` models, in a session of its own.
TriangleSurface mesh_model(const char* name, double edge_length_m,
                           const std::function<void()>& build) {
  const GmshSession session(name);
  try {
    build();
    return mesh_boundary(edge_length_m);
  } catch (const std::string& message) {  // what this version of gmsh throws
    throw std::runtime_error(std::string("gmsh, ") + name + ": " + message);
  }
}

double pad_alpha(const FingertipPad& shape) {
  return shape.length_m * shape.length_m / 4 / (shape.across_radius_m * shape.along_radius_m);
}

}  // namespace

TriangleSurface fingertip_pad(const FingertipPad& shape) {
  require_length("fingertip pad", "across_radius_m", shape.across_radius_m);
  require_length("fingertip pad", "along_radius_m", shape.along_radius_m);
  require_length("fingertip pad", "length_m", shape.length_m);
  require_length("fingertip pad", "edge_length_m", shape.edge_length_m);
  const double alpha = pad_alpha(shape), taper = shape.tip_to_base_width;
  if (!(alpha >= 0.3 && alpha <= 1.3)) {
    throw InputError("fingertip pad", "length_m", shape.length_m,
                     "length² / (4 across_radius along_radius) between 0.3 and 1.3");
  }
  if (!(taper >= 0.5 && taper <= 1))
    throw InputError("fingertip pad", "tip_to_base_width", taper, "0.5 to 1");

  const double half_length = shape.length_m / 2, r = shape.across_radius_m;
  TriangleSurface surface = mesh_model("fingertip pad", shape.edge_length_m, [&] {
    const int ball = gmsh::model::occ::addSphere(0, 0, 0, 1);
    gmsh::model::occ::dilate({{3, ball}}, 0, 0, 0, r * kUnitsPerMetre, r * kUnitsPerMetre,
                             half_length * kUnitsPerMetre);
  });
  // The ellipsoid differs little from the pad, so that its even triangles stay even on the pad.
  const double slope = (1 - taper) / (1 + taper) * 4 / shape.length_m;
  for (Vector3d& p : surface.vertices_m) {
    const Vector3d unit = Vector3d(p.x() / r, p.y() / r, p.z() / half_length).normalized();
    const double s = r * std::sqrt(1 + (1 - alpha) * unit.z() * unit.z());
    const double z = half_length * unit.z();
    p = {s * (1 - slope * z) * unit.x(), s * unit.y(), z};
  }
  return surface;
}

SurfacePoint fingertip_pad_middle(const FingertipPad& shape) {
  const bool along_is_major = shape.along_radius_m >= shape.across_radius_m;
  return {{0, -shape.across_radius_m, 0},
          {0, -1, 0},
          std::max(shape.along_radius_m, shape.across_radius_m),
          std::min(shape.along_radius_m, shape.across_radius_m),
          along_is_major ? Vector3d::UnitZ() : Vector3d::UnitX()};
}

TriangleSurface glass(double foot_radius_m, double rim_radius_m, double height_m,
                      double edge_length_m) {
  require_length("glass", "foot_radius_m", foot_radius_m);
  require_length("glass", "rim_radius_m", rim_radius_m);
  require_length("glass", "height_m", height_m);
  require_length("glass", "edge_length_m", edge_length_m);
  const double thickness = 0.06 * rim_radius_m, foot_rounding = 2 * thickness;
  if (!(foot_radius_m > 4 * thickness && height_m > 8 * thickness)) {
    throw InputError("glass", "foot_radius_m, height_m",
                     std::to_string(foot_radius_m) + ", " + std::to_string(height_m),
                     "more than 0.24 and 0.48 rim radii: the wall is 0.06 rim radii thick");
  }
  return mesh_model("glass", edge_length_m, [&] {
    namespace occ = gmsh::model::occ;
    using Eigen::Vector2d;  // (radius, height)
    const auto point = [](const Vector2d& p) {
      return occ::addPoint(p[0] * kUnitsPerMetre, 0, p[1] * kUnitsPerMetre);
    };
    const Vector2d foot(foot_radius_m, 0), rim(rim_radius_m, height_m);
    const Vector2d up = (rim - foot).normalized(), inward(-up[1], up[0]);
    // Foot: an arc that touches the bottom and the wall.
    const double half_angle = std::acos(-up[0]) / 2;  // between bottom (inward) and wall
    const double reach = foot_rounding / std::tan(half_angle);
    const Vector2d arc_start = foot - Vector2d(reach, 0), arc_end = foot + reach * up;
    const Vector2d arc_centre = arc_start + Vector2d(0, foot_rounding);
    // Rim: half a circle. Two arcs, because an arc of the modelling kernel must be shorter than
    // that.
    const Vector2d rim_inside = rim + thickness * inward, rim_centre = (rim + rim_inside) / 2;
    const Vector2d rim_top = rim_centre + thickness / 2 * up;
    const Vector2d bottom_inside(0, 2 * thickness);
    const Vector2d corner = rim_inside + (bottom_inside[1] - rim_inside[1]) / up[1] *
                                             up;  // inner wall meets the bottom

    const int p0 = point({0, 0}), p1 = point(arc_start), p2 = point(arc_end), p3 = point(rim),
              p4 = point(rim_top), p5 = point(rim_inside), p6 = point(corner),
              p7 = point(bottom_inside), c1 = point(arc_centre), c2 = point(rim_centre);
    const int loop = occ::addCurveLoop({occ::addLine(p0, p1), occ::addCircleArc(p1, c1, p2),
                                        occ::addLine(p2, p3), occ::addCircleArc(p3, c2, p4),
                                        occ::addCircleArc(p4, c2, p5), occ::addLine(p5, p6),
                                        occ::addLine(p6, p7), occ::addLine(p7, p0)});
    const int profile = occ::addPlaneSurface({loop});
    gmsh::vectorpair revolved;
    occ::revolve({{2, profile}}, 0, 0, 0, 0, 0, 1, 2 * kPi, revolved);
    occ::remove({{2, profile}});  // else it would be meshed too, as a wall across the glass
  });
}

SurfacePoint glass_wall_middle(double foot_radius_m, double rim_radius_m, double height_m) {
  const Vector3d up = Vector3d(rim_radius_m - foot_radius_m, 0, height_m).normalized();
  const double radius = (foot_radius_m + rim_radius_m) / 2;
  // A cone is straight along its wall; across it, the distance to the axis along the normal
  // (Meusnier).
  return {{radius, 0, height_m / 2}, {up.z(), 0, -up.x()}, kInfinity, radius / up.z(), up};
}

TriangleSurface rounded_box(double side_m, double edge_radius_m, double edge_length_m) {
  require_length("rounded box", "side_m", side_m);
  require_length("rounded box", "edge_radius_m", edge_radius_m);
  require_length("rounded box", "edge_length_m", edge_length_m);
  if (!(edge_radius_m < 0.5 * side_m)) {
    throw InputError("rounded box", "edge_radius_m", edge_radius_m, "less than half the side");
  }
  return mesh_model("rounded box", edge_length_m, [&] {
    namespace occ = gmsh::model::occ;
    const double s = side_m * kUnitsPerMetre;
    const int box = occ::addBox(-s / 2, -s / 2, -s / 2, s, s, s);
    occ::synchronize();
    gmsh::vectorpair curves, rounded;
    gmsh::model::getEntities(curves, 1);
    std::vector<int> edges;
    for (const auto& curve : curves) edges.push_back(curve.second);
    occ::fillet({box}, edges, {edge_radius_m * kUnitsPerMetre}, rounded);
  });
}

SurfacePoint rounded_box_edge_middle(double side_m, double edge_radius_m) {
  const Vector3d normal = Vector3d(1, 1, 0).normalized();
  const double centre = side_m / 2 - edge_radius_m;
  return {Vector3d(centre, centre, 0) + edge_radius_m * normal, normal, kInfinity, edge_radius_m,
          Vector3d::UnitZ()};
}

TriangleSurface cylinder(double radius_m, double length_m, double edge_length_m) {
  require_length("cylinder", "radius_m", radius_m);
  require_length("cylinder", "length_m", length_m);
  require_length("cylinder", "edge_length_m", edge_length_m);
  return mesh_model("cylinder", edge_length_m, [&] {
    gmsh::model::occ::addCylinder(0, 0, -length_m / 2 * kUnitsPerMetre, 0, 0,
                                  length_m * kUnitsPerMetre, radius_m * kUnitsPerMetre);
  });
}

TriangleSurface sphere(double radius_m, double edge_length_m) {
  require_length("sphere", "radius_m", radius_m);
  require_length("sphere", "edge_length_m", edge_length_m);
  return mesh_model("sphere", edge_length_m,
                    [&] { gmsh::model::occ::addSphere(0, 0, 0, radius_m * kUnitsPerMetre); });
}

}  // namespace softfinger::meshes
