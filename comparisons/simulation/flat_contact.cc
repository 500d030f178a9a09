#include "comparisons/simulation/flat_contact.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace softfinger::simulation {
namespace {

using Eigen::Vector3d;

/// A point that overlaps is as far from the surface as it is deep.
constexpr double kBeyondReach = 2;

/// The points of one pair, each place once.
class Places {
 public:
  Places(const ShapePair& pair, std::vector<TouchingPoint>& points)
      : pair_(pair), points_(points), first_(points.size()) {}

  /// Nearer than this two points are one.
  double same_m() const { return 1e-6 * pair_.smaller_m(); }

  void add(const Vector3d& on_a, const Vector3d& on_b, const Vector3d& normal, double gap_m,
           long slot) {
    TouchingPoint point;
    point.a = pair_.a.body;
    point.b = pair_.b.body;
    point.point_m = (on_a + on_b) / 2;
    for (std::size_t other = first_; other < points_.size(); ++other)
      if ((points_[other].point_m - point.point_m).norm() < same_m()) return;
    point.axes = any_axes(normal);
    point.gap_m = gap_m;
    point.id = pair_.first_id + slot;
    points_.push_back(point);
  }

  double least_gap_m() const {
    double least_m = std::numeric_limits<double>::infinity();
    for (std::size_t p = first_; p < points_.size(); ++p)
      least_m = std::min(least_m, points_[p].gap_m);
    return least_m;
  }

 private:
  const ShapePair& pair_;
  std::vector<TouchingPoint>& points_;
  std::size_t first_;
};

bool is_round_all_over(const Part& part) {
  return std::holds_alternative<input::Sphere>(part.kind()) ||
         std::holds_alternative<input::Ellipsoid>(part.kind());
}

/// A point of a surface, in the world.
struct Below {
  Vector3d point_m, normal;
};

/// The surface nearest to a point; of a mesh none where that is out of reach.
std::optional<Below> surface_below(const Part& part, const Vector3d& point, double reach_m) {
  const Vector3d local = part.local_point(point);
  if (!part.tree) {
    const SurfacePoint at = surface_near(part.kind(), local);
    return Below{part.pose * at.point_m, part.pose.linear() * at.normal};
  }
  const TriangleTree::Nearest at =
      part.tree->nearest(TriangleTree::Segment{local, local}, kBeyondReach * reach_m);
  if (at.triangle < 0) return std::nullopt;
  return Below{part.pose * at.on_surface, part.pose.linear() * part.tree->normal(at.triangle)};
}

/// Side of one of the two shapes that faces the other one.
struct Facing {
  Facing(const Part& of_part, const Vector3d& direction, Bearing& memory)
      : part(of_part),
        outward(direction),
        local(part.local_direction(direction)),
        bearing(memory.points) {
    // Vertices that bear within a hundredth of a radian do so after a turn by a ten-millionth of
    // that.
    constexpr double kSame = 1e-9;
    if (part.is_mesh() && (memory.direction - local).norm() < kSame) return;
    memory.points = bearing_points(part, local);
    memory.direction = local;
  }

  const Part& part;
  Vector3d outward, local;  ///< the direction towards the other shape, in the world and the shape
  const std::vector<Vector3d>& bearing;  ///< in the shape
};

/// Adds the bearing points of one of the two shapes that lie over the other one's face.
void add_bearing_points(const ShapePair& pair, bool from_a, const Facing& facing, Places& places) {
  const Part& from = facing.part;
  const Part& to = from_a ? pair.b : pair.a;
  const Vector3d& outward = facing.outward;
  // The cosine of the largest angle between two normals of one contact: 2.6 degrees.
  constexpr double kFacing = 1 - 1e-3;
  long slot = slot::kBearing + (from_a ? 0 : slot::kMostBearing);
  for (const Vector3d& local : facing.bearing) {
    const long own_slot = slot++;
    const Vector3d bearing = from.pose * local;
    const std::optional<Below> below = surface_below(to, bearing, pair.reach_m);
    if (!below) continue;
    const Below& under = *below;
    Vector3d normal = outward;
    double gap_m = 0;
    if (-outward.dot(under.normal) > kFacing) {
      normal = -under.normal;
      gap_m = under.normal.dot(bearing - under.point_m);
    } else {
      // The nearest point lies on another face or edge: the bearing point is beside the face. On
      // the edge itself round-off decides which face that is, and the pair's normal holds.
      gap_m = outward.dot(under.point_m - bearing);
      const Vector3d aside = under.point_m - bearing - gap_m * outward;
      if (aside.norm() > places.same_m()) continue;
    }
    if (gap_m > pair.reach_m) continue;
    if (from_a)
      places.add(bearing, under.point_m, normal, gap_m, own_slot);
    else
      places.add(under.point_m, bearing, -normal, gap_m, own_slot);
  }
}

/// A straight line along which a shape may touch.
struct Edge {
  Vector3d start, along;  ///< world
  int number = 0;         ///< within the shape, below slot::kMostEdges
};

/// The edge of a cylinder's flat end.
struct Rim {
  Vector3d centre, axis;  ///< world
  double radius_m = 0;
};

/// Outline of the side of a shape that faces a direction, or the line that faces it.
struct Outline {
  std::vector<Edge> edges;
  std::optional<Rim> rim;
  bool is_empty() const { return edges.empty() && !rim; }
};

/// All shapes without a flat side or a straight line.
template <class Round>
Outline outline_of(const Round&, const Facing&, double) {
  return {};
}

/// Edges of a box of which both ends lie within reach of its farthest point.
Outline outline_of(const input::Box& box, const Facing& facing, double reach_m) {
  const Part& part = facing.part;
  const Vector3d &local = facing.local, half = box.size_m / 2;
  // The depth is limited, so that of a thin plate only the side facing the other body counts.
  const double depth_m = std::min(reach_m, box.size_m.minCoeff() / 4);
  const double farthest = half.dot(local.cwiseAbs());
  Outline outline;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 4; ++side) {
      Vector3d start = -half, along = Vector3d::Zero();
      if (side & 1) start[(axis + 1) % 3] *= -1;
      if (side & 2) start[(axis + 2) % 3] *= -1;
      along[axis] = box.size_m[axis];
      if (std::min(start.dot(local), (start + along).dot(local)) < farthest - depth_m) continue;
      outline.edges.push_back({part.pose * start, part.pose.linear() * along, 4 * axis + side});
    }
  return outline;
}

Edge edge_between(const Part& part, const Vector3d& from, const Vector3d& to, int number) {
  return {part.pose * from, part.pose.linear() * (to - from), number};
}

/// Whether the direction is nearer to the sides of a shape around its z axis than to its ends.
bool faces_side(const Vector3d& local) { return local.head<2>().norm() > std::abs(local.z()); }

Outline outline_of(const input::Cylinder& cylinder, const Facing& facing, double) {
  const Part& part = facing.part;
  const Vector3d& local = facing.local;
  const Vector3d end(0, 0, std::copysign(cylinder.length_m / 2, local.z()));
  if (!faces_side(local))
    return {{}, Rim{part.pose * end, part.pose.linear().col(2), cylinder.radius_m}};
  const Vector3d side =
      cylinder.radius_m * Vector3d(local.x(), local.y(), 0) / local.head<2>().norm();
  return {{edge_between(part, side - end, side + end, 0)}, std::nullopt};
}

Outline outline_of(const input::Capsule&, const Facing& facing, double) {
  if (!faces_side(facing.local)) return {};
  return {{edge_between(facing.part, facing.bearing[0], facing.bearing[1], 0)}, std::nullopt};
}

/// Polygon of a mesh's bearing points, which are in order around the direction.
Outline outline_of(const input::Mesh&, const Facing& facing, double reach_m) {
  const Vector3d& local = facing.local;
  const double least = support_point(facing.part, local).dot(local) - reach_m;
  const std::vector<Vector3d>& corners = facing.bearing;
  Outline outline;
  const int count = int(corners.size());
  for (int i = 0; i < (count > 2 ? count : count - 1); ++i) {
    const Vector3d &from = corners[std::size_t(i)], &to = corners[std::size_t((i + 1) % count)];
    if (std::min(from.dot(local), to.dot(local)) < least) continue;
    outline.edges.push_back(edge_between(facing.part, from, to, i));
  }
  return outline;
}

Outline outline_of(const Facing& facing, double reach_m) {
  return std::visit([&](const auto& kind) { return outline_of(kind, facing, reach_m); },
                    facing.part.kind());
}

/// A place of a rim, seen along the normal from a point.
Vector3d on_plane_of(const Rim& rim, const Vector3d& point, const Vector3d& normal) {
  return point - normal * (rim.axis.dot(point - rim.centre) / rim.axis.dot(normal));
}

/// Two shapes whose outlines cross, seen along the normal.
class Crossings {
 public:
  Crossings(const ShapePair& pair, const Vector3d& normal, Places& places)
      : pair_(pair), normal_(normal), places_(places) {}

  void add(const Outline& a, const Outline& b) {
    for (const Edge& on_a : a.edges)
      for (const Edge& on_b : b.edges) add(on_a, on_b);
    if (a.rim)
      for (const Edge& on_b : b.edges) add(*a.rim, on_b, true);
    if (b.rim)
      for (const Edge& on_a : a.edges) add(*b.rim, on_a, false);
    if (a.rim && b.rim) add(*a.rim, *b.rim);
  }

 private:
  void add(const Edge& on_a, const Edge& on_b) {
    const double turn = normal_.dot(on_a.along.cross(on_b.along));
    constexpr double kParallel = 1e-9;
    if (!(std::abs(turn) > kParallel * on_a.along.norm() * on_b.along.norm())) return;
    const Vector3d apart = on_b.start - on_a.start;
    const double part_a = normal_.dot(apart.cross(on_b.along)) / turn;
    const double part_b = normal_.dot(apart.cross(on_a.along)) / turn;
    if (!(part_a > 0 && part_a < 1 && part_b > 0 && part_b < 1)) return;
    add(on_a.start + part_a * on_a.along, on_b.start + part_b * on_b.along, on_a.number,
        on_b.number);
  }

  /// Solves |c + t along - centre| = radius for t, in the rim's plane.
  void add(const Rim& rim, const Edge& edge, bool rim_is_of_a) {
    const Vector3d start = on_plane_of(rim, edge.start, normal_) - rim.centre;
    const Vector3d along = on_plane_of(rim, edge.start + edge.along, normal_) - rim.centre - start;
    const double square = along.squaredNorm(), half = start.dot(along);
    const double root = half * half - square * (start.squaredNorm() - std::pow(rim.radius_m, 2));
    if (!(square > 0 && root > 0)) return;
    for (const int which : {0, 1}) {
      const double part = (-half + (which ? 1 : -1) * std::sqrt(root)) / square;
      if (!(part > 0 && part < 1)) continue;
      const Vector3d on_rim = rim.centre + start + part * along;
      const Vector3d on_edge = edge.start + part * edge.along;
      if (rim_is_of_a)
        add(on_rim, on_edge, which, edge.number);
      else
        add(on_edge, on_rim, edge.number, which);
    }
  }

  /// Two circles in planes across the normal.
  void add(const Rim& a, const Rim& b) {
    const Vector3d apart = on_plane_of(a, b.centre, normal_) - a.centre;
    const double distance_m = apart.norm();
    if (!(distance_m > std::abs(a.radius_m - b.radius_m) && distance_m < a.radius_m + b.radius_m))
      return;
    const Vector3d towards = apart / distance_m, aside = a.axis.cross(towards);
    const double along_m =
        (distance_m * distance_m + std::pow(a.radius_m, 2) - std::pow(b.radius_m, 2)) /
        (2 * distance_m);
    const double aside_m = std::sqrt(std::pow(a.radius_m, 2) - along_m * along_m);
    for (const int which : {0, 1}) {
      const Vector3d on_a = a.centre + along_m * towards + (which ? 1 : -1) * aside_m * aside;
      add(on_a, on_plane_of(b, on_a, normal_), which, which);
    }
  }

  void add(const Vector3d& on_a, const Vector3d& on_b, int number_of_a, int number_of_b) {
    const double gap_m = normal_.dot(on_b - on_a);
    if (gap_m > pair_.reach_m || !is_material(pair_.a, on_a) || !is_material(pair_.b, on_b)) return;
    places_.add(on_a, on_b, normal_, gap_m,
                slot::kCrossing + slot::kMostEdges * number_of_a + number_of_b);
  }

  /// The polygon of a mesh may span a gap between its feet.
  static bool is_material(const Part& part, const Vector3d& point) {
    constexpr double kNear = 1e-3;  // of the size: how far a side that counts as flat is from flat
    if (!part.tree) return true;
    const Vector3d local = part.local_point(point);
    return part.tree->nearest(TriangleTree::Segment{local, local}, kNear * part.radius_m)
               .triangle >= 0;
  }

  const ShapePair& pair_;
  const Vector3d& normal_;
  Places& places_;
};

}  // namespace

void find_flat_contact(const ShapePair& pair, const Nearest& nearest,
                       std::array<Bearing, 2>& bearing, std::vector<TouchingPoint>& points) {
  Places places(pair, points);
  const auto add_nearest = [&] {
    places.add(nearest.on_a, nearest.on_b, nearest.normal, nearest.gap_m, slot::kNearest);
  };
  if (is_round_all_over(pair.a) || is_round_all_over(pair.b)) {
    add_nearest();
    return;
  }
  const Facing a(pair.a, nearest.normal, bearing[0]), b(pair.b, -nearest.normal, bearing[1]);
  add_bearing_points(pair, true, a, places);
  add_bearing_points(pair, false, b, places);
  if (const Outline of_b = outline_of(b, pair.reach_m); !of_b.is_empty())
    Crossings(pair, nearest.normal, places).add(outline_of(a, pair.reach_m), of_b);
  // If none of these is as near as the nearest point, two edges or rims cross there.
  if (places.least_gap_m() > nearest.gap_m + places.same_m() / 10) add_nearest();
}

}  // namespace softfinger::simulation
