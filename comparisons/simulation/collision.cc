#include "comparisons/simulation/collision.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "comparisons/simulation/contact_model.h"
#include "comparisons/simulation/elliptic_contact.h"
#include "comparisons/simulation/flat_contact.h"
#include "comparisons/simulation/shape_distances.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Data of a pair of shapes that are kept between steps.
struct PairMemory {
  Vector3d normal_in_a = Vector3d::Zero();  ///< zero: not yet known
  Fits fits;
  std::vector<Fits> earlier_fits;  ///< at other places, the last one first
  int triangle = -1;               ///< of a mesh, the last nearest one
  bool was_outside = false;        ///< the last time, the other shape lay outside the mesh
  std::optional<Vector3d> lowest;  ///< of a mesh over a half-space, the last lowest vertex
  std::array<Bearing, 2> bearing;  ///< of a and b, where they last touched at flat sides
  /// The last time that the shapes were looked at, their gap was at least this, and b lay so in a.
  double gap_m = 0;
  Isometry3d b_in_a = Isometry3d::Identity();
  bool known() const { return normal_in_a.squaredNorm() > 0; }
};

/// All parts of the scene's bodies, half-spaces among them.
std::vector<Part> parts_of(const input::Scene& scene) {
  std::vector<Part> parts;
  for (int b = 0; b < int(scene.bodies.size()); ++b)
    for (const input::Shape& shape : scene.bodies[std::size_t(b)].shapes)
      parts.push_back({b, &shape, bounding_radius_m(shape.kind), nullptr, Isometry3d::Identity()});
  return parts;
}

std::vector<const input::ShapeKind*> kinds_of(const std::vector<Part>& parts) {
  std::vector<const input::ShapeKind*> kinds;
  for (const Part& part : parts) kinds.push_back(&part.kind());
  return kinds;
}

/// A bound on how far a point of `b` has moved in the other shape's frame.
double farthest_moved_m(const Isometry3d& from, const Isometry3d& to, const Part& b) {
  if (b.is_half_space()) return kInfinity;
  // The chord of a turn is |R' - R| in Frobenius' norm over the root of 2.
  return (to.translation() - from.translation()).norm() +
         b.radius_m * (to.linear() - from.linear()).norm() / std::sqrt(2.0);
}

/// A half-space's nearest point lies below the other shape's lowest one. Of a mesh that stands on a
/// flat side many vertices are lowest but for round-off: the last one is kept among these.
Nearest nearest_to_half_space(const Part& part, const Part& half_space, PairMemory& memory) {
  constexpr double kSameHeight = 1e-7;  // of the size: a few roundings of the files' seven digits
  Nearest result;
  const Vector3d up = half_space.pose.linear().col(2);
  result.normal = -up;
  const Vector3d down = part.local_direction(-up);
  Vector3d lowest = support_point(part, down);
  if (memory.lowest && down.dot(lowest - *memory.lowest) < kSameHeight * part.radius_m)
    lowest = *memory.lowest;
  if (part.is_mesh()) memory.lowest = lowest;
  result.on_a = part.pose * lowest;
  result.gap_m = up.dot(result.on_a - half_space.pose.translation());
  result.on_b = result.on_a - result.gap_m * up;
  return result;
}

/// A shape as a point, a segment or a block with a layer of constant thickness around it.
struct RoundedCore {
  TriangleTree::Core core;
  double radius_m = 0;
  bool is_exact = true;  ///< else the shape lies within it
};

std::optional<RoundedCore> core_of(const Part& part) {
  using Segment = TriangleTree::Segment;
  const auto along = [&](const Vector3d& half) {
    return Segment{part.pose * Vector3d(-half), part.pose * half};
  };
  if (const auto* sphere = std::get_if<input::Sphere>(&part.kind()))
    return RoundedCore{along(Vector3d::Zero()), sphere->radius_m};
  if (const auto* capsule = std::get_if<input::Capsule>(&part.kind()))
    return RoundedCore{along(capsule->length_m / 2 * Vector3d::UnitZ()), capsule->radius_m};
  if (const auto* cylinder = std::get_if<input::Cylinder>(&part.kind()))
    return RoundedCore{along(cylinder->length_m / 2 * Vector3d::UnitZ()), cylinder->radius_m,
                       false};
  if (const auto* ellipsoid = std::get_if<input::Ellipsoid>(&part.kind())) {
    int longest = 0;
    Vector3d axes = ellipsoid->semi_axes_m;
    const double length_m = axes.maxCoeff(&longest);
    axes[longest] = 0;
    return RoundedCore{along(length_m * Vector3d::Unit(longest)), axes.maxCoeff(), false};
  }
  if (const auto* box = std::get_if<input::Box>(&part.kind()))
    return RoundedCore{TriangleTree::Block{part.pose, box->size_m / 2}};
  return std::nullopt;
}

/// A core of the world in a mesh's frame.
TriangleTree::Core in_frame(const Part& mesh, TriangleTree::Core core) {
  const Isometry3d into = mesh.pose.inverse();
  if (auto* segment = std::get_if<TriangleTree::Segment>(&core))
    return TriangleTree::Segment{into * segment->from, into * segment->to};
  auto& block = std::get<TriangleTree::Block>(core);
  block.pose = into * block.pose;
  return block;
}

/// Nearest points of a mesh (a) and a ball or a capsule (b). They follow from the point of b's core
/// (centre or axis) that is nearest to the mesh, also where the two overlap. Beyond twice the reach
/// the gap is only a bound. Where the core lies within the mesh, the shortest way out counts.
Nearest nearest_to_round(const Part& mesh, const RoundedCore& round, double reach_m,
                         PairMemory& memory) {
  Nearest result;
  // The first time, the whole mesh is searched: the core can lie deep within.
  const double limit_m =
      memory.known() || memory.was_outside ? 2 * (round.radius_m + reach_m) : kInfinity;
  const TriangleTree::Nearest at =
      mesh.tree->nearest(in_frame(mesh, round.core), limit_m, memory.triangle);
  memory.triangle = at.triangle;
  if (at.triangle < 0) {
    memory.normal_in_a.setZero();
    result.gap_m = limit_m - round.radius_m;
    return result;
  }
  Vector3d outward = at.distance_m > 0 ? Vector3d((at.on_core - at.on_surface) / at.distance_m)
                                       : mesh.tree->normal(at.triangle);
  const bool inside = memory.known() ? outward.dot(memory.normal_in_a) < 0
                                     : !memory.was_outside && mesh.tree->contains(at.on_core);
  memory.was_outside = !inside;
  if (inside) outward *= -1;
  memory.normal_in_a = outward;
  result.normal = mesh.pose.linear() * outward;
  result.on_a = mesh.pose * at.on_surface;
  result.on_b = mesh.pose * at.on_core - round.radius_m * result.normal;
  result.gap_m = (inside ? -at.distance_m : at.distance_m) - round.radius_m;
  return result;
}

/// A direction, or the normal of a flat face that it differs from by no more than the error of
/// nearest points: there the face's normal is the exact one.
Vector3d or_face_normal(const Vector3d& direction, const Part& part) {
  // Nearest points are known to a part 1e-10 of the shift, directions across edges to its root.
  constexpr double kSame = 1e-4;
  const bool is_box = std::holds_alternative<input::Box>(part.kind());
  if (!is_box && !std::holds_alternative<input::Cylinder>(part.kind())) return direction;
  for (int axis = is_box ? 0 : 2; axis < 3; ++axis) {
    const Vector3d face = part.pose.linear().col(axis);
    const double side = face.dot(direction) < 0 ? -1 : 1;
    if ((side * face - direction).norm() < kSame) return side * face;
  }
  return direction;
}

/// The contact as seen from the other body.
void turn_round(TouchingPoint& point) {
  std::swap(point.a, point.b);
  if (point.elliptic) {
    SurfaceCurvature& curvature = point.curvature_of_a;
    curvature.xx_per_m = 1 / point.radii.major_m - curvature.xx_per_m;
    curvature.yy_per_m = 1 / point.radii.minor_m - curvature.yy_per_m;
    // That of the other one is -xy, and the second axis turns round.
  }
  point.axes.col(2) *= -1;
  point.axes.col(1) *= -1;
}

}  // namespace

/// Pairs of parts that may touch before any has moved far.
struct NearPairs {
  std::vector<std::pair<int, int>> pairs;
  double distance_m = -1;         ///< others were farther apart than this
  std::vector<Isometry3d> poses;  ///< of the parts then
};

struct CollisionDetector::Implementation {
  explicit Implementation(const input::Scene& of_scene);

  void update(const Multibody& bodies);
  void update_near_pairs();
  void find(const Multibody& bodies, double time_step_s, std::vector<TouchingPoint>& points);
  void find_between(int first, int second, std::vector<TouchingPoint>& points);
  bool may_touch(int part, int other) const;
  double reach_m(const Part& a, const Part& b) const;
  Nearest nearest(int a, int b, double reach_m, PairMemory& memory) const;
  ShapeDistances::Nearest distance(int a, int b, const Isometry3d& pose_of_b, double tolerance_m,
                                   PairMemory& memory) const;
  void fit_meshes(const Part& a, const Part& b, const Nearest& nearest, PairMemory& memory);

  const input::Scene& scene;
  std::map<const TriangleSurface*, TriangleTree> trees;  ///< bodies may share a mesh
  std::vector<Part> parts;
  ShapeDistances distances;
  NearPairs nearby;
  std::map<std::pair<int, int>, PairMemory> memories;
  std::vector<char> may_collide;      ///< bodies x bodies; empty before the first update
  std::vector<double> speed_m_per_s;  ///< a bound, per body
  double time_step_s = 0;
  int fit_count = 0;
};

CollisionDetector::Implementation::Implementation(const input::Scene& of_scene)
    : scene(of_scene), parts(parts_of(of_scene)), distances(kinds_of(parts)) {
  speed_m_per_s.assign(scene.bodies.size(), 0);
  for (Part& part : parts)
    if (const auto* mesh = std::get_if<input::Mesh>(&part.kind()))
      part.tree = &trees.try_emplace(mesh->surface.get(), *mesh->surface).first->second;
}

void CollisionDetector::Implementation::update(const Multibody& bodies) {
  const int count = int(scene.bodies.size());
  if (may_collide.empty()) {
    may_collide.assign(std::size_t(count * count), char(false));
    for (int a = 0; a < count; ++a)
      for (int b = 0; b < count; ++b)
        may_collide[std::size_t(a * count + b)] =
            char(a != b && scene.rule(a, b).collide && (bodies.moves(a) || bodies.moves(b)) &&
                 !bodies.are_joined(a, b));
  }
  std::fill(speed_m_per_s.begin(), speed_m_per_s.end(), 0.);
  for (Part& part : parts) {
    part.pose = bodies.pose(part.body) * part.shape->pose;
    if (!bodies.moves(part.body)) continue;
    double& speed = speed_m_per_s[std::size_t(part.body)];
    speed = std::max(speed, bodies.velocity_at(part.body, part.pose.translation()).norm() +
                                bodies.angular_velocity(part.body).norm() * part.radius_m);
  }
}

/// The list of the last time holds as long as no two parts can have come near that are not in it.
void CollisionDetector::Implementation::update_near_pairs() {
  double reach = 0, moved_m = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Part& part = parts[p];
    if (part.is_half_space()) continue;
    reach = std::max(reach, reach_m(part, part));
    if (nearby.distance_m >= 0)
      moved_m = std::max(moved_m, farthest_moved_m(nearby.poses[p], part.pose, part));
  }
  // A farther list has more pairs and holds for longer: for several steps at today's velocities.
  // That of a fast motion is too long afterwards.
  constexpr double kTimesReach = 5, kTooFar = 25;
  if (reach + 2 * moved_m <= nearby.distance_m && nearby.distance_m <= kTooFar * reach) return;
  nearby.distance_m = kTimesReach * reach;
  nearby.poses.clear();
  for (const Part& part : parts) nearby.poses.push_back(part.pose);
  nearby.pairs = distances.near_pairs(nearby.poses, nearby.distance_m);
  for (int plane = 0; plane < int(parts.size()); ++plane)
    if (parts[std::size_t(plane)].is_half_space())
      for (int p = 0; p < int(parts.size()); ++p) nearby.pairs.push_back(std::minmax(p, plane));
  const auto never_touch = [&](const std::pair<int, int>& pair) {
    return !may_touch(pair.first, pair.second);
  };
  nearby.pairs.erase(std::remove_if(nearby.pairs.begin(), nearby.pairs.end(), never_touch),
                     nearby.pairs.end());
  std::sort(nearby.pairs.begin(), nearby.pairs.end());
}

bool CollisionDetector::Implementation::may_touch(int part, int other) const {
  const int count = int(scene.bodies.size());
  return may_collide[std::size_t(parts[std::size_t(part)].body * count +
                                 parts[std::size_t(other)].body)];
}

double CollisionDetector::Implementation::reach_m(const Part& a, const Part& b) const {
  const double closing = speed_m_per_s[std::size_t(a.body)] + speed_m_per_s[std::size_t(b.body)];
  return 0.01 * std::min(a.radius_m, b.radius_m) + 2 * time_step_s * closing;
}

void CollisionDetector::Implementation::find(const Multibody& bodies, double step_s,
                                             std::vector<TouchingPoint>& points) {
  time_step_s = step_s;
  update(bodies);
  update_near_pairs();
  for (const auto& [first, second] : nearby.pairs) find_between(first, second, points);
}

ShapeDistances::Nearest CollisionDetector::Implementation::distance(int first, int second,
                                                                    const Isometry3d& pose_of_b,
                                                                    double tolerance_m,
                                                                    PairMemory& memory) const {
  const Part& a = parts[std::size_t(first)];
  Part b = parts[std::size_t(second)];
  if (!a.is_mesh() || !std::holds_alternative<input::Box>(b.kind())) {
    const ShapeDistances::Nearest at =
        distances.nearest(first, a.pose, second, pose_of_b, tolerance_m);
    if (!at.has_points)
      throw CollisionError(fmt::format(
          "the library FCL finds no nearest points of \"{}\" and \"{}\", {:.4g} mm apart",
          scene.descriptions[std::size_t(a.body)].name,
          scene.descriptions[std::size_t(b.body)].name, at.distance_m * 1e3));
    return at;
  }
  b.pose = pose_of_b;
  const TriangleTree::Nearest at =
      a.tree->nearest(in_frame(a, core_of(b)->core), kInfinity, memory.triangle);
  memory.triangle = at.triangle;
  return {at.distance_m, a.pose * at.on_surface, a.pose * at.on_core};
}

/// Bodies that touch have a distance of zero, and no direction between them is known then. So `b`
/// is moved away along the last normal by a little before the distance is asked for; the common
/// normal stays the same by that. The normal that is found replaces the last one until both agree.
Nearest CollisionDetector::Implementation::nearest(int first, int second, double reach_m,
                                                   PairMemory& memory) const {
  const Part &a = parts[std::size_t(first)], &b = parts[std::size_t(second)];
  if (b.is_half_space()) return nearest_to_half_space(a, b, memory);
  if (a.is_mesh() && !b.is_mesh()) {
    const RoundedCore round = *core_of(b);
    const bool is_block = std::holds_alternative<TriangleTree::Block>(round.core);
    if (round.is_exact && !is_block) return nearest_to_round(a, round, reach_m, memory);
    // While they touch, that is seen below.
    if (!memory.known() || memory.gap_m > reach_m) {
      // The search goes beyond the reach, by a quarter of the smaller radius: a pair that is
      // farther apart need not be searched again until its motion can have used up the difference.
      const double limit_m = round.radius_m + reach_m + std::min(a.radius_m, b.radius_m) / 4;
      const TriangleTree::Nearest at =
          a.tree->nearest(in_frame(a, round.core), limit_m, memory.triangle);
      Nearest apart;
      apart.gap_m = at.distance_m - round.radius_m;
      const bool near = apart.gap_m <= reach_m;
      if (!near && !memory.known() && !memory.was_outside)
        memory.was_outside = !a.tree->contains(a.local_point(b.pose.translation()));
      if (!near && (memory.known() || memory.was_outside)) return apart;
    }
  }
  Vector3d normal = a.pose.linear() * memory.normal_in_a;
  const bool known = memory.known();
  if (!known) {
    normal = b.pose.translation() - a.pose.translation();
    normal = normal.norm() > 0 ? Vector3d(normal.normalized()) : Vector3d(Vector3d::UnitZ());
  }
  double shift_m = 0.02 * std::min(a.radius_m, b.radius_m);
  // At edges, normals are only as good as the root of the distance's tolerance.
  const double tolerance_m = 1e-10 * shift_m;
  Nearest result;
  const int most_rounds = known ? 3 : 30;
  constexpr int kMostDoublings = 30;
  int doublings = 0;
  for (int round = 0; round < most_rounds; ++round) {
    Isometry3d moved = b.pose;
    moved.translation() += shift_m * normal;
    const ShapeDistances::Nearest apart = distance(first, second, moved, tolerance_m, memory);
    if (!(apart.distance_m > 1e-3 * shift_m)) {  // the bodies overlap by more than the shift
      if (++doublings > kMostDoublings) break;
      shift_m *= 2;
      --round;
      continue;
    }
    const Vector3d across = apart.on_b - apart.on_a;
    const Vector3d direction = or_face_normal(or_face_normal(across.normalized(), b), a);
    result.on_a = apart.on_a;
    result.on_b = apart.on_b - shift_m * normal;
    result.gap_m = across.dot(direction) - shift_m * normal.dot(direction);
    const double turned = (direction - normal).norm();
    normal = direction;
    if (turned < 1e-7) break;
  }
  result.normal = normal;
  memory.normal_in_a = a.local_direction(normal);
  return result;
}

/// Fits quadrics to the meshes of a pair, unless those of the last step, or earlier ones, are near:
/// a body that rocks on its rim comes back to the same places again and again. How large a region
/// is fitted depends on the contact, and the contact on the fit: they are repeated until the region
/// has twice the area of the contact that is predicted for the scene's nominal load. A mesh too
/// coarse for that is fitted over as little as it allows.
void CollisionDetector::Implementation::fit_meshes(const Part& a, const Part& b,
                                                   const Nearest& nearest, PairMemory& memory) {
  const std::array<const Part*, 2> both = {&a, &b};
  const std::array<Vector3d, 2> points = {a.local_point(nearest.on_a), b.local_point(nearest.on_b)};
  const auto are_near = [&](const Fits& fits) {
    for (std::size_t side = 0; side < 2; ++side) {
      if (!both[side]->is_mesh()) continue;
      const auto& fit = fits[side];
      // The region is 1.4 times as large as the contact, which so stays within it.
      if (!fit || !((fit->origin_m - points[side]).norm() < 0.25 * fit->region_radius_m))
        return false;
    }
    return true;
  };
  Fits& fits = memory.fits;
  if (are_near(fits)) return;
  std::vector<Fits>& earlier = memory.earlier_fits;
  const auto known = std::find_if(earlier.begin(), earlier.end(), are_near);
  if (known != earlier.end()) {
    std::swap(*known, fits);
    return;
  }
  constexpr std::size_t kMostEarlier = 4;
  earlier.insert(earlier.begin(), fits);
  if (earlier.size() > kMostEarlier) earlier.pop_back();
  double radius_m = 0.2 * std::min(a.radius_m, b.radius_m);
  // The contact is most often as large as it was.
  for (const auto& fit : fits)
    if (fit) radius_m = fit->region_radius_m;
  constexpr int kMostRounds = 8;
  constexpr double kMargin = 1.01;  // the fit sees all triangles that reach into its region
  for (int round = 0; round < kMostRounds; ++round) {
    try {
      for (std::size_t side = 0; side < 2; ++side) {
        fits[side].reset();
        if (!both[side]->is_mesh()) continue;
        fits[side] = fit_quadric(both[side]->tree->within(points[side], kMargin * radius_m),
                                 points[side], nullptr, radius_m);
        // Normal and curvature are the quadric's, but the surface goes through its nearest point.
        QuadricFit& fit = *fits[side];
        const double aside = fit.normal.dot(points[side] - surface_near(fit, points[side]).point_m);
        fit.origin_m += aside * fit.normal;
        ++fit_count;
      }
    } catch (const std::exception&) {  // too few vertices, or too strongly curved
      radius_m *= round < kMostRounds / 2 ? 1.5 : 0.6;
      continue;
    }
    const SurfacePoint on_a = surface(a, fits[0], nearest.on_a);
    const SurfacePoint on_b = surface(b, fits[1], nearest.on_b);
    // Ascending. Along the normal there is no curvature: of two positive ones, the zero is below.
    const Vector3d curvatures = Eigen::SelfAdjointEigenSolver<Matrix3d>()
                                    .computeDirect(on_a.curvature_per_m + on_b.curvature_per_m)
                                    .eigenvalues();
    if (!(curvatures[1] > 0)) break;
    const double area_m2 =
        predicted_area_m2(scene, a.body, b.body, {1 / curvatures[1], 1 / curvatures[2], 0});
    const double wanted_m = std::sqrt(2 * area_m2 / kPi);
    if (!(wanted_m > 0) || std::abs(wanted_m - radius_m) < 0.05 * radius_m) break;
    radius_m = std::min(wanted_m, 0.5 * std::min(a.radius_m, b.radius_m));
  }
}

void CollisionDetector::Implementation::find_between(int first, int second,
                                                     std::vector<TouchingPoint>& points) {
  // A half-space comes second, and a mesh before what is none; that the contact itself has a < b is
  // seen to at the end.
  int one = first, other = second;
  if (parts[std::size_t(one)].is_half_space() ||
      (parts[std::size_t(other)].is_mesh() && !parts[std::size_t(one)].is_mesh()))
    std::swap(one, other);
  const Part &a = parts[std::size_t(one)], &b = parts[std::size_t(other)];
  const ShapePair pair{a, b, reach_m(a, b), (long(first) * long(parts.size()) + second) * kSlots};
  // The balls around both exclude most pairs.
  if (!b.is_half_space() &&
      (a.pose.translation() - b.pose.translation()).norm() > a.radius_m + b.radius_m + pair.reach_m)
    return;
  PairMemory& memory = memories[{one, other}];
  const Isometry3d b_in_a = a.pose.inverse(Eigen::Isometry) * b.pose;
  if (memory.gap_m - farthest_moved_m(memory.b_in_a, b_in_a, b) > pair.reach_m) {
    // On which side they will meet, nothing tells any more.
    memory.normal_in_a.setZero();
    memory.was_outside = true;
    return;
  }
  const Nearest at = nearest(one, other, pair.reach_m, memory);
  memory.gap_m = at.gap_m;
  memory.b_in_a = b_in_a;
  if (at.gap_m > pair.reach_m) return;
  if (a.is_mesh() || b.is_mesh()) fit_meshes(a, b, at, memory);
  const std::size_t before = points.size();
  if (const auto point = find_elliptic_contact(pair, memory.fits, at)) {
    memory.normal_in_a = a.local_direction(point->axes.col(2));
    if (point->gap_m <= pair.reach_m) points.push_back(*point);
  } else {
    find_flat_contact(pair, at, memory.bearing, points);
  }
  for (std::size_t p = before; p < points.size(); ++p)
    if (points[p].a > points[p].b) turn_round(points[p]);
}

CollisionDetector::CollisionDetector(const input::Scene& scene)
    : implementation_(std::make_unique<Implementation>(scene)) {}
CollisionDetector::~CollisionDetector() = default;

void CollisionDetector::find(const Multibody& bodies, double time_step_s,
                             std::vector<TouchingPoint>& points) {
  implementation_->find(bodies, time_step_s, points);
}

std::vector<CollisionDetector::Overlap> CollisionDetector::overlaps(const Multibody& bodies) {
  std::vector<TouchingPoint> points;
  try {
    implementation_->find(bodies, 0, points);
  } catch (const CollisionError&) {
    // Bodies without nearest points do not overlap, and the first step says so.
  }
  std::vector<Overlap> result;
  for (const TouchingPoint& point : points) {
    double smaller_m = std::numeric_limits<double>::infinity();
    for (const Part& part : implementation_->parts)
      if (part.body == point.a || part.body == point.b)
        smaller_m = std::min(smaller_m, part.radius_m);
    if (point.gap_m >= -1e-4 * smaller_m) continue;
    const auto same = std::find_if(result.begin(), result.end(), [&](const Overlap& known) {
      return std::minmax(known.a, known.b) == std::minmax(point.a, point.b);
    });
    if (same == result.end())
      result.push_back({point.a, point.b, -point.gap_m});
    else
      same->depth_m = std::max(same->depth_m, -point.gap_m);
  }
  return result;
}

void CollisionDetector::require_no_overlap(const Multibody& bodies) {
  const std::vector<Overlap> found = overlaps(bodies);
  if (found.empty()) return;
  const Overlap& first = found.front();
  throw InputError(implementation_->scene.file.string(),
                   fmt::format("overlap of \"{}\" and \"{}\" at the start, in mm",
                               bodies.body(first.a).name, bodies.body(first.b).name),
                   fmt::format("{:.4g}", first.depth_m * 1e3),
                   "bodies that do not interpenetrate, or collide = false in their [[contact]]");
}

int CollisionDetector::fits() const { return implementation_->fit_count; }

}  // namespace softfinger::simulation
