#include "comparisons/exporting/shape_pad.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "comparisons/prediction/flat_faces.h"

namespace softfinger::exporting {
namespace {

using Eigen::Vector3d;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

ShapePad pad_of_ball(double radius_m, const Vector3d& normal) {
  ShapePad pad;
  pad.normal = normal;
  pad.point_m = radius_m * normal;
  pad.major_radius_m = pad.minor_radius_m = radius_m;
  pad.part = "the sphere";
  return pad;
}

/// Gauss' map of an ellipsoid: the curvatures at the point with a normal n are those of the shape
/// operator A^-1 / |A^-1 x| in the tangent plane, with x = A n / sqrt(n A n) and A = diag(a^2).
ShapePad pad_of_ellipsoid(const Vector3d& semi_axes_m, const Vector3d& normal) {
  const Vector3d squares = semi_axes_m.cwiseAbs2();
  ShapePad pad;
  pad.normal = normal;
  pad.point_m = squares.cwiseProduct(normal) / std::sqrt(normal.dot(squares.cwiseProduct(normal)));
  const Vector3d gradient = pad.point_m.cwiseQuotient(squares);
  // Two directions across the normal.
  int least = 0;
  normal.cwiseAbs().minCoeff(&least);
  const Vector3d one = normal.cross(Vector3d(Vector3d::Unit(least))).normalized();
  const Vector3d other = normal.cross(one);
  const auto form = [&](const Vector3d& u, const Vector3d& v) {
    return u.cwiseQuotient(squares).dot(v) / gradient.norm();
  };
  const double xx = form(one, one), yy = form(other, other), xy = form(one, other);
  const double middle = (xx + yy) / 2, half = std::hypot((xx - yy) / 2, xy);
  pad.minor_radius_m = 1 / (middle + half);
  // The product of the curvatures is exact where their difference cancels.
  pad.major_radius_m = (middle + half) / (xx * yy - xy * xy);
  pad.part = "the ellipsoid";
  return pad;
}

Vector3d unit_or(const Vector3d& vector, const Vector3d& otherwise) {
  const double length = vector.norm();
  return length > 1e-12 ? Vector3d(vector / length) : otherwise;
}

/// The normal at the ellipsoid's point nearest to a point: x_i = a_i^2 p_i/(a_i^2 + t), by
/// bisection of t.
Vector3d normal_near(const Vector3d& semi_axes_m, const Vector3d& point_m) {
  const Vector3d squares = semi_axes_m.cwiseAbs2();
  const auto at = [&](double t) {
    return Vector3d(squares.cwiseProduct(point_m).cwiseQuotient((squares.array() + t).matrix()));
  };
  const auto is_outside = [&](double t) { return at(t).cwiseQuotient(semi_axes_m).norm() > 1; };
  double low = -squares.minCoeff() * (1 - 1e-12);
  double high = semi_axes_m.maxCoeff() * point_m.norm() + squares.maxCoeff();
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    (is_outside(middle) ? low : high) = middle;
  }
  int shortest = 0;
  semi_axes_m.minCoeff(&shortest);
  return unit_or(at(high).cwiseQuotient(squares), Vector3d::Unit(shortest));
}

ShapePad pad_of_cap(double radius_m, double half_length_m, const Vector3d& normal, double end) {
  ShapePad pad = pad_of_ball(radius_m, normal);
  pad.point_m.z() += end * half_length_m;
  pad.part = "an end of the capsule";
  pad.to_seam_m = radius_m * std::asin(std::min(1., std::abs(normal.z())));
  return pad;
}

/// @param height_m  along the axis, from the middle
ShapePad pad_of_side(double radius_m, double half_length_m, const Vector3d& across, double height_m,
                     const char* part) {
  ShapePad pad = pad_of_ball(radius_m, across);
  pad.major_radius_m = kInfinite;
  pad.point_m.z() = height_m;
  pad.to_seam_m = half_length_m - std::abs(height_m);
  pad.part = part;
  return pad;
}

ShapePad pad_of_face(const Vector3d& normal, const Vector3d& point_m, double to_edge_m,
                     const char* part) {
  ShapePad pad;
  pad.normal = normal;
  pad.point_m = point_m;
  pad.major_radius_m = pad.minor_radius_m = kInfinite;
  pad.to_seam_m = to_edge_m;
  pad.part = part;
  return pad;
}

Vector3d across_axis(const Vector3d& vector) {
  return unit_or({vector.x(), vector.y(), 0}, Vector3d::UnitX());
}

ShapePad pad_of_box(const input::Box& box, const Vector3d& near_m, int axis, double side) {
  const Vector3d half = box.size_m / 2;
  Vector3d point = near_m.cwiseMin(half).cwiseMax(-half);
  point[axis] = side * half[axis];
  double to_edge_m = kInfinite;
  for (int i = 0; i < 3; ++i)
    if (i != axis) to_edge_m = std::min(to_edge_m, half[i] - std::abs(point[i]));
  return pad_of_face(side * Vector3d(Vector3d::Unit(axis)), point, to_edge_m, "a face of the box");
}

struct Towards {
  const Vector3d& direction;

  ShapePad operator()(const std::monostate&) const { return {}; }
  ShapePad operator()(const NamedMesh&) const { return {}; }
  ShapePad operator()(const input::Sphere& sphere) const {
    return pad_of_ball(sphere.radius_m, direction);
  }
  ShapePad operator()(const input::Ellipsoid& ellipsoid) const {
    return pad_of_ellipsoid(ellipsoid.semi_axes_m, direction);
  }
  ShapePad operator()(const input::Capsule& capsule) const {
    // Within a degree the plane touches the side.
    constexpr double kAcross = 0.0175;
    const double half_m = capsule.length_m / 2;
    if (std::abs(direction.z()) < kAcross)
      return pad_of_side(capsule.radius_m, half_m, across_axis(direction), 0,
                         "the side of the capsule");
    return pad_of_cap(capsule.radius_m, half_m, direction, direction.z() > 0 ? 1 : -1);
  }
  ShapePad operator()(const input::Cylinder& cylinder) const {
    const double half_m = cylinder.length_m / 2, side = direction.z() > 0 ? 1 : -1;
    if (direction.z() * direction.z() > 0.5)
      return pad_of_face(side * Vector3d::UnitZ(), side * half_m * Vector3d::UnitZ(),
                         cylinder.radius_m, "an end of the cylinder");
    return pad_of_side(cylinder.radius_m, half_m, across_axis(direction), 0,
                       "the side of the cylinder");
  }
  ShapePad operator()(const input::Box& box) const {
    int axis = 0;
    direction.cwiseAbs().maxCoeff(&axis);
    return pad_of_box(box, Vector3d::Zero(), axis, direction[axis] > 0 ? 1 : -1);
  }
};

struct Near {
  const Vector3d& point_m;

  ShapePad operator()(const std::monostate&) const { return {}; }
  ShapePad operator()(const NamedMesh&) const { return {}; }
  ShapePad operator()(const input::Sphere& sphere) const {
    return pad_of_ball(sphere.radius_m, unit_or(point_m, Vector3d::UnitZ()));
  }
  ShapePad operator()(const input::Ellipsoid& ellipsoid) const {
    return pad_of_ellipsoid(ellipsoid.semi_axes_m, normal_near(ellipsoid.semi_axes_m, point_m));
  }
  ShapePad operator()(const input::Capsule& capsule) const {
    const double half_m = capsule.length_m / 2;
    if (std::abs(point_m.z()) <= half_m)
      return pad_of_side(capsule.radius_m, half_m, across_axis(point_m), point_m.z(),
                         "the side of the capsule");
    const double end = point_m.z() > 0 ? 1 : -1;
    const Vector3d from_end = point_m - end * half_m * Vector3d::UnitZ();
    return pad_of_cap(capsule.radius_m, half_m, unit_or(from_end, end * Vector3d::UnitZ()), end);
  }
  ShapePad operator()(const input::Cylinder& cylinder) const {
    const double half_m = cylinder.length_m / 2, across_m = std::hypot(point_m.x(), point_m.y());
    const double end = point_m.z() > 0 ? 1 : -1;
    const bool is_end = std::abs(point_m.z()) - half_m > across_m - cylinder.radius_m;
    if (is_end) {
      const double inside_m = std::min(across_m, cylinder.radius_m);
      return pad_of_face(end * Vector3d::UnitZ(),
                         inside_m * (across_m > 0 ? across_axis(point_m) : Vector3d::Zero()) +
                             end * half_m * Vector3d::UnitZ(),
                         cylinder.radius_m - inside_m, "an end of the cylinder");
    }
    return pad_of_side(cylinder.radius_m, half_m, across_axis(point_m),
                       std::clamp(point_m.z(), -half_m, half_m), "the side of the cylinder");
  }
  ShapePad operator()(const input::Box& box) const {
    const Vector3d depth = point_m.cwiseAbs() - box.size_m / 2;
    int axis = 0;
    depth.maxCoeff(&axis);
    return pad_of_box(box, point_m, axis, point_m[axis] > 0 ? 1 : -1);
  }
};

}  // namespace

ShapePad pad_towards(const RobotShapeKind& kind, const Vector3d& direction) {
  return std::visit(Towards{direction}, kind);
}

ShapePad pad_near(const RobotShapeKind& kind, const Vector3d& point_m) {
  return std::visit(Near{point_m}, kind);
}

FlatEnd flat_end(const RobotShapeKind& kind, const ShapePad& pad) {
  int axis = 0;
  pad.normal.cwiseAbs().maxCoeff(&axis);
  const int x_axis = (axis + 1) % 3;
  FlatEnd end;
  const Vector3d x = Vector3d::Unit(x_axis);
  end.in_shape.linear() << x, pad.normal.cross(x), pad.normal;
  end.in_shape.translation() = pad.normal.dot(pad.point_m) * pad.normal;
  if (const auto* box = std::get_if<input::Box>(&kind))
    end.figure = input::RectangleFigure{box->size_m[x_axis], box->size_m[(axis + 2) % 3], 0};
  else
    end.figure = input::DiscFigure{2 * std::get<input::Cylinder>(kind).radius_m};
  return end;
}

namespace {

std::optional<FlatEnd> flat_end(const prediction::FaceOutline& outline) {
  constexpr double kFilled = 0.9;
  if (outline.filled < kFilled) return std::nullopt;
  FlatEnd end{input::OutlineFigure{outline.hull_m}, outline.in_surface};
  if (outline.is_rectangle())
    end.figure = input::RectangleFigure{outline.length_m, outline.width_m, 0};
  return end;
}

/// Whether a face is a facet of something round: the one beside it is turned little and is not
/// narrow, as a chamfer or a strip of a fillet is.
bool is_facet(const TriangleSurface& surface, const prediction::FlatFace& face) {
  constexpr double kTurned = 0.6;  // the cosine of 53 degrees
  constexpr double kNarrow = 0.2;
  std::set<std::pair<int, int>> edges;
  for (const int own : face.triangles) {
    const auto& corners = surface.triangles[std::size_t(own)];
    for (std::size_t c = 0; c < 3; ++c) edges.emplace(corners[c], corners[(c + 1) % 3]);
  }
  for (const auto& corners : surface.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::pair<int, int> there(corners[(c + 1) % 3], corners[c]);
      // The facets of the face itself have both directions.
      if (edges.count(there) == 0 || edges.count({there.second, there.first}) > 0) continue;
      const Vector3d& from = surface.vertices_m[std::size_t(there.first)];
      const Vector3d edge = surface.vertices_m[std::size_t(there.second)] - from;
      const Vector3d across =
          (surface.vertices_m[std::size_t(corners[(c + 2) % 3])] - from).cross(edge);
      const double twice_area_m2 = across.norm();
      if (across.dot(face.normal) > kTurned * twice_area_m2 &&
          twice_area_m2 > kNarrow * face.width_m * edge.norm())
        return true;
    }
  return false;
}

}  // namespace

std::optional<FlatEnd> flat_end_of_mesh(const TriangleSurface& surface, const Vector3d& point_m,
                                        const std::optional<Vector3d>& facing) {
  constexpr double kFacing = 0.7;
  auto faces = prediction::flat_faces(surface);
  if (facing)
    faces.erase(std::remove_if(faces.begin(), faces.end(),
                               [&](const prediction::FlatFace& face) {
                                 return face.normal.dot(*facing) < kFacing;
                               }),
                faces.end());
  const prediction::FlatFace* face = prediction::face_at(surface, faces, point_m);
  if (!face || is_facet(surface, *face)) return std::nullopt;
  return flat_end(outline_of(surface, *face));
}

std::optional<FlatEnd> joined(const std::vector<FlatEnd>& ends) {
  std::vector<Vector3d> corners_m;
  double area_m2 = 0;
  for (const FlatEnd& end : ends) {
    const auto* rectangle = std::get_if<input::RectangleFigure>(&end.figure);
    if (!rectangle) return std::nullopt;
    area_m2 += rectangle->length_m * rectangle->width_m;
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5})
        corners_m.push_back(end.in_shape *
                            Vector3d(x * rectangle->length_m, y * rectangle->width_m, 0));
  }
  auto end =
      flat_end(prediction::outline_of(corners_m, ends.front().in_shape.linear().col(2), area_m2));
  if (end) end->is_joined = true;
  return end;
}

}  // namespace softfinger::exporting
