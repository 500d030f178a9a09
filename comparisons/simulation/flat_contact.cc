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

/// The surface nearest to a point; of a mesh none where that is out of reach.
std::optional<SurfacePoint> surface_below(const Part& part, const Vector3d& point, double reach_m) {
  if (!part.tree) return surface(part, std::nullopt, point);
  const Vector3d local = part.local_point(point);
  const TriangleTree::Nearest at =
      part.tree->nearest(TriangleTree::Segment{local, local}, kBeyondReach * reach_m);
  if (at.triangle < 0) return std::nullopt;
  SurfacePoint result;
  result.point_m = part.pose * at.on_surface;
  result.normal = part.pose.linear() * part.tree->normal(at.triangle);
  return result;
}

/// Adds the bearing points of one of the two shapes that lie over the other one's face.
void add_bearing_points(const ShapePair& pair, bool from_a, const Vector3d& pair_normal,
                        Places& places) {
  const Part& from = from_a ? pair.a : pair.b;
  const Part& to = from_a ? pair.b : pair.a;
  const Vector3d outward = from_a ? pair_normal : Vector3d(-pair_normal);
  // The cosine of the largest angle between two normals of one contact: 2.6 degrees.
  constexpr double kFacing = 1 - 1e-3;
  long slot = slot::kBearing + (from_a ? 0 : slot::kMostBearing);
  for (const Vector3d& local : bearing_points(from, from.local_direction(outward))) {
    const long own_slot = slot++;
    const Vector3d bearing = from.pose * local;
    const std::optional<SurfacePoint> below = surface_below(to, bearing, pair.reach_m);
    if (!below) continue;
    const SurfacePoint& under = *below;
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

struct Edge {
  Vector3d start, along;  ///< world
  int number = 0;         ///< of the box's twelve
};

/// The edges of a box that face a direction: both ends lie within reach of its farthest point.
std::vector<Edge> edges_facing(const Vector3d& direction, const input::Box& box, const Part& part,
                               double reach_m) {
  const Vector3d local = part.local_direction(direction), half = box.size_m / 2;
  // The depth is limited, so that of a thin plate only the side facing the other body counts.
  const double depth_m = std::min(reach_m, box.size_m.minCoeff() / 4);
  const double farthest = half.dot(local.cwiseAbs());
  std::vector<Edge> edges;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 4; ++side) {
      Vector3d start = -half, along = Vector3d::Zero();
      if (side & 1) start[(axis + 1) % 3] *= -1;
      if (side & 2) start[(axis + 2) % 3] *= -1;
      along[axis] = box.size_m[axis];
      if (std::min(start.dot(local), (start + along).dot(local)) < farthest - depth_m) continue;
      edges.push_back({part.pose * start, part.pose.linear() * along, 4 * axis + side});
    }
  return edges;
}

/// Adds the point where two edges cross, seen along the normal; none where they do not.
void add_crossing(const ShapePair& pair, const Edge& on_a, const Edge& on_b, const Vector3d& normal,
                  Places& places) {
  const double turn = normal.dot(on_a.along.cross(on_b.along));
  constexpr double kParallel = 1e-9;
  if (!(std::abs(turn) > kParallel * on_a.along.norm() * on_b.along.norm())) return;
  const Vector3d apart = on_b.start - on_a.start;
  const double part_a = normal.dot(apart.cross(on_b.along)) / turn;
  const double part_b = normal.dot(apart.cross(on_a.along)) / turn;
  if (!(part_a > 0 && part_a < 1 && part_b > 0 && part_b < 1)) return;
  const Vector3d point_a = on_a.start + part_a * on_a.along;
  const Vector3d point_b = on_b.start + part_b * on_b.along;
  const double gap_m = normal.dot(point_b - point_a);
  if (gap_m > pair.reach_m) return;
  places.add(point_a, point_b, normal, gap_m,
             slot::kCrossing + slot::kBoxEdges * on_a.number + on_b.number);
}

/// Flat on flat: adds the corners of the polygon that both faces share that are corners of neither.
void add_crossing_edges(const ShapePair& pair, const Vector3d& normal, Places& places) {
  const auto* box_a = std::get_if<input::Box>(&pair.a.kind());
  const auto* box_b = std::get_if<input::Box>(&pair.b.kind());
  if (!box_a || !box_b) return;
  const std::vector<Edge> edges_a = edges_facing(normal, *box_a, pair.a, pair.reach_m);
  const std::vector<Edge> edges_b = edges_facing(-normal, *box_b, pair.b, pair.reach_m);
  for (const Edge& on_a : edges_a)
    for (const Edge& on_b : edges_b) add_crossing(pair, on_a, on_b, normal, places);
}

}  // namespace

void find_flat_contact(const ShapePair& pair, const Nearest& nearest,
                       std::vector<TouchingPoint>& points) {
  Places places(pair, points);
  const auto add_nearest = [&] {
    places.add(nearest.on_a, nearest.on_b, nearest.normal, nearest.gap_m, slot::kNearest);
  };
  if (is_round_all_over(pair.a) || is_round_all_over(pair.b)) {
    add_nearest();
    return;
  }
  for (const bool from_a : {true, false}) add_bearing_points(pair, from_a, nearest.normal, places);
  add_crossing_edges(pair, nearest.normal, places);
  // Where none of these is as near as the nearest point, two edges or rims cross there.
  if (places.least_gap_m() > nearest.gap_m + places.same_m() / 10) add_nearest();
}

}  // namespace softfinger::simulation
