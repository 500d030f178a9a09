#include "comparisons/simulation/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "softfinger/input/constants.h"

namespace softfinger::simulation {
namespace {

constexpr int kSegments = 36;

struct ProfilePoint {
  double radius_m, z_m;
};

/// Turns a profile about the z axis. It goes upwards and begins and ends on the axis.
TriangleSurface revolved(const std::vector<ProfilePoint>& profile) {
  TriangleSurface surface;
  std::vector<int> first_vertex;
  for (const ProfilePoint& point : profile) {
    first_vertex.push_back(static_cast<int>(surface.vertices_m.size()));
    const bool on_axis = first_vertex.size() == 1 || first_vertex.size() == profile.size();
    for (int j = 0; j < (on_axis ? 1 : kSegments); ++j) {
      const double angle = 2 * kPi * j / kSegments;
      const double radius_m = on_axis ? 0 : point.radius_m;
      surface.vertices_m.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle),
                                      point.z_m);
    }
  }
  const int last = static_cast<int>(profile.size()) - 1;
  for (int ring = 0; ring < last; ++ring)
    for (int j = 0; j < kSegments; ++j) {
      const int k = (j + 1) % kSegments;
      const int low = first_vertex[ring], high = first_vertex[ring + 1];
      if (ring > 0)
        surface.triangles.push_back({low + j, low + k, ring + 1 < last ? high + k : high});
      if (ring + 1 < last)
        surface.triangles.push_back({ring > 0 ? low + j : low, high + k, high + j});
    }
  return surface;
}

/// Half a meridian, from the equator to the pole or back.
void append_quarter(std::vector<ProfilePoint>& profile, double radius_m, double centre_z_m,
                    double from_rad, double to_rad) {
  constexpr int kBands = kSegments / 4;
  for (int i = 0; i <= kBands; ++i) {
    const double latitude = from_rad + (to_rad - from_rad) * i / kBands;
    profile.push_back({radius_m * std::cos(latitude), centre_z_m + radius_m * std::sin(latitude)});
  }
}

TriangleSurface surface_of(const input::Capsule& capsule, double) {
  std::vector<ProfilePoint> profile;
  append_quarter(profile, capsule.radius_m, -capsule.length_m / 2, -kPi / 2, 0);
  // A capsule without a shaft is a sphere: one equator, not two.
  if (capsule.length_m == 0) profile.pop_back();
  append_quarter(profile, capsule.radius_m, capsule.length_m / 2, 0, kPi / 2);
  return revolved(profile);
}

TriangleSurface surface_of(const input::Sphere& sphere, double) {
  return surface_of(input::Capsule{sphere.radius_m, 0}, 0);
}

TriangleSurface surface_of(const input::Ellipsoid& ellipsoid, double) {
  TriangleSurface surface = surface_of(input::Sphere{1}, 0);
  for (Eigen::Vector3d& vertex : surface.vertices_m)
    vertex = vertex.cwiseProduct(ellipsoid.semi_axes_m);
  return surface;
}

TriangleSurface surface_of(const input::Cylinder& cylinder, double) {
  const double half = cylinder.length_m / 2;
  return revolved({{0, -half}, {cylinder.radius_m, -half}, {cylinder.radius_m, half}, {0, half}});
}

TriangleSurface surface_of(const input::Box& box, double) {
  TriangleSurface surface;
  for (int corner = 0; corner < 8; ++corner)
    surface.vertices_m.push_back(
        box.size_m.cwiseProduct(Eigen::Vector3d(corner & 1, corner >> 1 & 1, corner >> 2 & 1) -
                                Eigen::Vector3d::Constant(0.5)));
  surface.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return surface;
}

TriangleSurface surface_of(const input::HalfSpace&, double width_m) {
  const double half = width_m / 2;
  return {{{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}},
          {{0, 1, 2}, {0, 2, 3}}};
}

TriangleSurface surface_of(const input::Mesh& mesh, double) {
  return mesh.surface ? *mesh.surface : TriangleSurface{};
}

}  // namespace

TriangleSurface triangulate(const input::Shape& shape, double half_space_width_m) {
  TriangleSurface surface = std::visit(
      [&](const auto& kind) { return surface_of(kind, half_space_width_m); }, shape.kind);
  for (Eigen::Vector3d& vertex : surface.vertices_m) vertex = shape.pose * vertex;
  return surface;
}

Eigen::AlignedBox3d extent_of(const Recording& recording) {
  Eigen::AlignedBox3d extent;
  for (std::size_t body = 0; body < recording.bodies.size(); ++body) {
    Eigen::AlignedBox3d own;
    for (const input::Shape& shape : recording.bodies[body].shapes)
      if (!std::holds_alternative<input::HalfSpace>(shape.kind))
        for (const Eigen::Vector3d& vertex : triangulate(shape, 0).vertices_m) own.extend(vertex);
    if (own.isEmpty()) continue;
    for (const Frame& frame : recording.frames)
      for (int corner = 0; corner < 8; ++corner)
        extent.extend(frame.poses.at(body) *
                      own.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  for (const Frame& frame : recording.frames)
    for (const RecordedContact& contact : frame.contacts) extent.extend(contact.point_m);
  return extent;
}

double half_space_width_m(const Recording& recording) {
  const Eigen::AlignedBox3d extent = extent_of(recording);
  if (extent.isEmpty()) return 1;
  double reach_m = 0;
  for (std::size_t body = 0; body < recording.bodies.size(); ++body)
    for (const input::Shape& shape : recording.bodies[body].shapes)
      if (std::holds_alternative<input::HalfSpace>(shape.kind))
        for (const Frame& frame : recording.frames)
          reach_m = std::max(
              reach_m, (frame.poses.at(body) * shape.pose.translation() - extent.center()).norm());
  const double width_m = 2 * (reach_m + extent.diagonal().norm());
  return width_m > 0 ? width_m : 1;
}

}  // namespace softfinger::simulation
