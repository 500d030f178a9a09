#include "comparisons/simulation/collision.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "comparisons/simulation/contact_model.h"
#include "comparisons/simulation/surface_point.h"
#include "softfinger/input/errors.h"
#include "softfinger/math/pi.h"

namespace softfinger::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

std::shared_ptr<fcl::CollisionGeometryd> fcl_geometry(const input::ShapeKind& kind) {
  if (const auto* sphere = std::get_if<input::Sphere>(&kind))
    return std::make_shared<fcl::Sphered>(sphere->radius_m);
  if (const auto* ellipsoid = std::get_if<input::Ellipsoid>(&kind))
    return std::make_shared<fcl::Ellipsoidd>(ellipsoid->semi_axes_m);
  if (const auto* cylinder = std::get_if<input::Cylinder>(&kind))
    return std::make_shared<fcl::Cylinderd>(cylinder->radius_m, cylinder->length_m);
  if (const auto* capsule = std::get_if<input::Capsule>(&kind))
    return std::make_shared<fcl::Capsuled>(capsule->radius_m, capsule->length_m);
  if (const auto* box = std::get_if<input::Box>(&kind))
    return std::make_shared<fcl::Boxd>(box->size_m);
  if (const auto* mesh = std::get_if<input::Mesh>(&kind)) {
    auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    std::vector<fcl::Triangle> triangles;
    for (const auto& t : mesh->surface->triangles)
      triangles.emplace_back(std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2]));
    model->beginModel(int(triangles.size()), int(mesh->surface->vertices_m.size()));
    model->addSubModel(mesh->surface->vertices_m, triangles);
    model->endModel();
    return model;
  }
  return nullptr;  // a half-space is compared with support points
}

/// More than a pair of shapes has points.
constexpr long kIds = 256;

/// A shape of a body, in the scene's list.
struct Part {
  int body = -1;
  const input::Shape* shape = nullptr;
  double radius_m = 0;
  Isometry3d pose = Isometry3d::Identity();  ///< in the world, now
  std::unique_ptr<fcl::CollisionObjectd> object;

  bool is_mesh() const { return std::holds_alternative<input::Mesh>(shape->kind); }
  bool is_half_space() const { return std::holds_alternative<input::HalfSpace>(shape->kind); }
};

struct Nearest {
  Vector3d on_a = Vector3d::Zero(), on_b = Vector3d::Zero();
  Vector3d normal = Vector3d::UnitZ();  ///< world; from a to b
  double gap_m = std::numeric_limits<double>::infinity();
};

/// What is remembered of a pair of shapes between steps.
struct PairMemory {
  Vector3d normal_in_a = Vector3d::Zero();        ///< zero: not yet known
  std::array<std::optional<QuadricFit>, 2> fits;  ///< of meshes, in the shape's frame
};

/// Distance and nearest points of two shapes that do not overlap. FCL 0.7 names the mesh's point
/// first, whatever the order of the call, and for some pairs gives the points in the shapes' own
/// frames.
double fcl_distance(const Part& a, const Isometry3d& pose_a, const Part& b,
                    const Isometry3d& pose_b, const fcl::DistanceRequestd& request, Vector3d& on_a,
                    Vector3d& on_b) {
  if (b.is_mesh() && !a.is_mesh()) return fcl_distance(b, pose_b, a, pose_a, request, on_b, on_a);
  fcl::DistanceResultd found;
  const double distance =
      fcl::distance(a.object->collisionGeometry().get(), pose_a,
                    b.object->collisionGeometry().get(), pose_b, request, found);
  on_a = found.nearest_points[0];
  on_b = found.nearest_points[1];
  const double rounding = 1e-6 * std::min(a.radius_m, b.radius_m);
  if (distance > 0 && std::abs((on_b - on_a).norm() - distance) > rounding) {
    on_a = pose_a * on_a;
    on_b = pose_b * on_b;
  }
  return distance;
}

SurfacePoint in_world(const SurfacePoint& local, const Isometry3d& pose) {
  const Matrix3d turn = pose.linear();
  return {pose * local.point_m, turn * local.normal,
          turn * local.curvature_per_m * turn.transpose(), local.smooth};
}

struct Edge {
  Vector3d start, along;  ///< world
  int number = 0;         ///< of the box's twelve
};

/// The edges of a box that lie within reach of its farthest point in a direction, both ends of
/// them.
std::vector<Edge> bearing_edges(const input::Box& box, const Isometry3d& pose,
                                const Vector3d& direction, double reach_m) {
  const Vector3d local = pose.linear().transpose() * direction, half = box.size_m / 2;
  // Of a thin plate only one side faces the other body.
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
      edges.push_back({pose * start, pose.linear() * along, 4 * axis + side});
    }
  return edges;
}

/// Whether a capsule that touches with one cap lies along the other surface: its other end is
/// within reach too, by the tilt and the other's curvature.
bool lies(const Part& part, const Vector3d& on_part, const SurfacePoint& other, double reach_m) {
  const auto* capsule = std::get_if<input::Capsule>(&part.shape->kind);
  if (!capsule) return false;
  const double past_m = std::abs((part.pose.inverse() * on_part).z()) - capsule->length_m / 2;
  const Vector3d axis = part.pose.linear().col(2);
  const double rise_m = capsule->length_m * past_m / capsule->radius_m +
                        std::pow(capsule->length_m, 2) / 2 * axis.dot(other.curvature_per_m * axis);
  return rise_m < reach_m && past_m > -1e-9 * capsule->length_m;
}

/// Two tangents that depend on the normal alone.
Matrix3d any_axes(const Vector3d& normal) {
  int least = 0;
  normal.cwiseAbs().minCoeff(&least);
  Matrix3d axes;
  axes.col(2) = normal;
  axes.col(0) = Vector3d::Unit(least).cross(normal).normalized();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

}  // namespace

struct CollisionDetector::Implementation {
  explicit Implementation(const input::Scene& of_scene);

  void update(const Multibody& bodies);
  void find(const Multibody& bodies, double time_step_s, std::vector<TouchingPoint>& points);
  void find_between(int first, int second, std::vector<TouchingPoint>& points);
  double reach_m(const Part& a, const Part& b) const;
  Nearest nearest_to_half_space(const Part& a, const Part& plane) const;
  Nearest nearest(const Part& a, const Part& b, PairMemory& memory) const;
  SurfacePoint surface(const Part& part, const std::optional<QuadricFit>& fit,
                       const Vector3d& point_m) const;
  bool find_round(const Part& a, const Part& b, PairMemory& memory, Nearest& nearest,
                  double reach_m, TouchingPoint& point);
  void fit_meshes(const Part& a, const Part& b, const Nearest& nearest, PairMemory& memory);
  void find_bearing(const Part& a, const Part& b, const Nearest& nearest, double reach_m,
                    long first_id, std::vector<TouchingPoint>& points) const;

  const input::Scene& scene;
  std::vector<Part> parts;
  std::vector<int> half_spaces;
  fcl::DynamicAABBTreeCollisionManagerd manager;
  std::map<std::pair<int, int>, PairMemory> memories;
  std::vector<char> may_touch;        ///< bodies x bodies; empty before the first update
  std::vector<double> speed_m_per_s;  ///< a bound, per body
  double time_step_s = 0;
  int fits = 0;
};

CollisionDetector::Implementation::Implementation(const input::Scene& of_scene) : scene(of_scene) {
  for (int b = 0; b < int(scene.bodies.size()); ++b)
    for (const input::Shape& shape : scene.bodies[std::size_t(b)].shapes) {
      Part part;
      part.body = b;
      part.shape = &shape;
      part.radius_m = bounding_radius_m(shape.kind);
      parts.push_back(std::move(part));
    }
  for (int p = 0; p < int(parts.size()); ++p) {
    Part& part = parts[std::size_t(p)];
    if (part.is_half_space()) {
      half_spaces.push_back(p);
      continue;
    }
    part.object = std::make_unique<fcl::CollisionObjectd>(fcl_geometry(part.shape->kind));
    part.object->setUserData(&part);
    manager.registerObject(part.object.get());
  }
  manager.setup();
  speed_m_per_s.assign(scene.bodies.size(), 0);
}

void CollisionDetector::Implementation::update(const Multibody& bodies) {
  const int count = int(scene.bodies.size());
  if (may_touch.empty()) {
    may_touch.assign(std::size_t(count * count), char(false));
    for (int a = 0; a < count; ++a)
      for (int b = 0; b < count; ++b)
        may_touch[std::size_t(a * count + b)] =
            char(a != b && scene.rule(a, b).collide && (bodies.moves(a) || bodies.moves(b)) &&
                 !bodies.are_joined(a, b));
  }
  std::fill(speed_m_per_s.begin(), speed_m_per_s.end(), 0.);
  for (Part& part : parts) {
    part.pose = bodies.pose(part.body) * part.shape->pose;
    if (bodies.moves(part.body)) {
      double& speed = speed_m_per_s[std::size_t(part.body)];
      speed = std::max(speed, bodies.velocity_at(part.body, part.pose.translation()).norm() +
                                  bodies.angular_velocity(part.body).norm() * part.radius_m);
    }
    if (!part.object) continue;
    part.object->setTransform(part.pose);
    part.object->computeAABB();
  }
  manager.update();
}

double CollisionDetector::Implementation::reach_m(const Part& a, const Part& b) const {
  const double closing = speed_m_per_s[std::size_t(a.body)] + speed_m_per_s[std::size_t(b.body)];
  return 0.01 * std::min(a.radius_m, b.radius_m) + 2 * time_step_s * closing;
}

void CollisionDetector::Implementation::find(const Multibody& bodies, double step_s,
                                             std::vector<TouchingPoint>& points) {
  time_step_s = step_s;
  update(bodies);
  std::vector<std::pair<int, int>> pairs;
  struct Search {
    const Implementation* detector;
    std::vector<std::pair<int, int>>* pairs;
    double farthest_m;
  } search{this, &pairs, 0};
  for (const Part& part : parts)
    if (part.object) search.farthest_m = std::max(search.farthest_m, reach_m(part, part));
  // FCL skips pairs whose boxes are farther apart than `distance`.
  manager.distance(&search, [](fcl::CollisionObjectd* one, fcl::CollisionObjectd* other, void* data,
                               double& distance) {
    auto& found = *static_cast<Search*>(data);
    distance = found.farthest_m;
    const Part* first = static_cast<const Part*>(one->getUserData());
    const Part* second = static_cast<const Part*>(other->getUserData());
    const int count = int(found.detector->scene.bodies.size());
    if (!found.detector->may_touch[std::size_t(first->body * count + second->body)]) return false;
    const Part* start = found.detector->parts.data();
    found.pairs->push_back(std::minmax(int(first - start), int(second - start)));
    return false;
  });
  const int count = int(scene.bodies.size());
  for (const int plane : half_spaces)
    for (int p = 0; p < int(parts.size()); ++p)
      if (may_touch[std::size_t(parts[std::size_t(plane)].body * count +
                                parts[std::size_t(p)].body)])
        pairs.push_back(std::minmax(p, plane));
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [first, second] : pairs) find_between(first, second, points);
}

Nearest CollisionDetector::Implementation::nearest_to_half_space(const Part& a,
                                                                 const Part& plane) const {
  Nearest result;
  const Vector3d up = plane.pose.linear().col(2);
  result.normal = -up;
  result.on_a = a.pose * support_point(a.shape->kind, a.pose.linear().transpose() * -up);
  result.gap_m = up.dot(result.on_a - plane.pose.translation());
  result.on_b = result.on_a - result.gap_m * up;
  return result;
}

Nearest CollisionDetector::Implementation::nearest(const Part& a, const Part& b,
                                                   PairMemory& memory) const {
  if (b.is_half_space()) return nearest_to_half_space(a, b);
  Vector3d normal = a.pose.linear() * memory.normal_in_a;
  const bool known = memory.normal_in_a.squaredNorm() > 0;
  if (!known) {
    normal = b.pose.translation() - a.pose.translation();
    normal = normal.norm() > 0 ? Vector3d(normal.normalized()) : Vector3d(Vector3d::UnitZ());
  }
  double shift_m = 0.02 * std::min(a.radius_m, b.radius_m);
  fcl::DistanceRequestd request(true);
  // Normals at edges are only as good as the root of that.
  request.distance_tolerance = 1e-10 * shift_m;
  Nearest result;
  const int most = known ? 3 : 30;
  constexpr int kMostDoublings = 30;
  int doublings = 0;
  for (int round = 0; round < most; ++round) {
    Isometry3d moved = b.pose;
    moved.translation() += shift_m * normal;
    Vector3d on_a, on_b;
    const double distance = fcl_distance(a, a.pose, b, moved, request, on_a, on_b);
    if (!(distance > 1e-3 * shift_m)) {  // deeper than expected
      if (++doublings > kMostDoublings) break;
      shift_m *= 2;
      --round;
      continue;
    }
    const Vector3d across = on_b - on_a;
    const Vector3d direction = across.normalized();
    result.on_a = on_a;
    result.on_b = on_b - shift_m * normal;
    result.gap_m = across.norm() - shift_m * normal.dot(direction);
    const double turned = (direction - normal).norm();
    normal = direction;
    if (turned < 1e-7) break;
  }
  result.normal = normal;
  memory.normal_in_a = a.pose.linear().transpose() * normal;
  return result;
}

SurfacePoint CollisionDetector::Implementation::surface(const Part& part,
                                                        const std::optional<QuadricFit>& fit,
                                                        const Vector3d& point_m) const {
  const Vector3d local = part.pose.inverse() * point_m;
  return in_world(fit ? surface_near(*fit, local) : surface_near(part.shape->kind, local),
                  part.pose);
}

/// Region and contact agree when the region is twice the contact predicted for the scene's nominal
/// load. A mesh too coarse for that is fitted over as little as it allows.
void CollisionDetector::Implementation::fit_meshes(const Part& a, const Part& b,
                                                   const Nearest& nearest, PairMemory& memory) {
  const std::array<const Part*, 2> both = {&a, &b};
  const std::array<Vector3d, 2> points = {a.pose.inverse() * nearest.on_a,
                                          b.pose.inverse() * nearest.on_b};
  bool fresh = true;
  for (std::size_t side = 0; side < 2; ++side)
    if (both[side]->is_mesh()) {
      const auto& fit = memory.fits[side];
      fresh = fresh && fit && (fit->origin_m - points[side]).norm() < 0.1 * fit->region_radius_m;
    }
  if (fresh) return;
  double radius_m = 0.2 * std::min(a.radius_m, b.radius_m);
  constexpr int kMostRounds = 8;
  for (int round = 0; round < kMostRounds; ++round) {
    try {
      for (std::size_t side = 0; side < 2; ++side) {
        memory.fits[side].reset();
        const auto* mesh = std::get_if<input::Mesh>(&both[side]->shape->kind);
        if (!mesh) continue;
        memory.fits[side] = fit_quadric(*mesh->surface, points[side], nullptr, radius_m);
        // The quadric tells normal and curvature; where the surface lies, its nearest point does.
        QuadricFit& fit = *memory.fits[side];
        const double aside = fit.normal.dot(points[side] - surface_near(fit, points[side]).point_m);
        fit.origin_m += aside * fit.normal;
        ++fits;
      }
    } catch (const std::exception&) {  // too few vertices, or too strongly curved
      radius_m *= round < kMostRounds / 2 ? 1.5 : 0.6;
      continue;
    }
    const SurfacePoint on_a = surface(a, memory.fits[0], nearest.on_a);
    const SurfacePoint on_b = surface(b, memory.fits[1], nearest.on_b);
    const Vector3d moments =
        Eigen::SelfAdjointEigenSolver<Matrix3d>(on_a.curvature_per_m + on_b.curvature_per_m)
            .eigenvalues();
    if (!(moments[1] > 0)) break;  // the normal's own is the zero below or among them
    const double area_m2 =
        predicted_area_m2(scene, a.body, b.body, {1 / moments[1], 1 / moments[2], 0});
    const double wanted_m = std::sqrt(2 * area_m2 / kPi);
    if (!(wanted_m > 0) || std::abs(wanted_m - radius_m) < 0.05 * radius_m) break;
    radius_m = std::min(wanted_m, 0.5 * std::min(a.radius_m, b.radius_m));
  }
}

/// The point with a common normal of two curved surfaces: minimises their distance along the
/// normal, whose Hessian is the relative curvature, then turns the normal to theirs. False where
/// there is none, or not a single one.
bool CollisionDetector::Implementation::find_round(const Part& a, const Part& b, PairMemory& memory,
                                                   Nearest& nearest, double reach_m,
                                                   TouchingPoint& point) {
  if (a.is_mesh() || b.is_mesh()) fit_meshes(a, b, nearest, memory);
  if ((a.is_mesh() && !memory.fits[0]) || (b.is_mesh() && !memory.fits[1])) return false;
  for (const auto& fit : memory.fits)
    if (fit && fit->surface_kind != SurfaceKind::smooth) return false;
  Vector3d on_a = nearest.on_a, on_b = nearest.on_b, normal = nearest.normal;
  const double far = 0.5 * std::min(a.radius_m, b.radius_m);
  Matrix3d axes;
  Eigen::Matrix2d curvature;
  for (int round = 0; round < 12; ++round) {
    const SurfacePoint at_a = surface(a, memory.fits[0], on_a);
    const SurfacePoint at_b = surface(b, memory.fits[1], on_b);
    if (!at_a.smooth || !at_b.smooth) return false;
    const Vector3d turned = (at_a.normal - at_b.normal).normalized();
    if (!(turned.dot(nearest.normal) > 0.5)) return false;
    normal = round == 0 ? normal : turned;
    axes = any_axes(normal);
    const Eigen::Matrix<double, 3, 2> plane = axes.leftCols<2>();
    const Eigen::Matrix2d curved_a = plane.transpose() * at_a.curvature_per_m * plane;
    const Eigen::Matrix2d curved_b = plane.transpose() * at_b.curvature_per_m * plane;
    curvature = curved_a + curved_b;
    const Eigen::Vector2d bends =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(curvature).eigenvalues();
    const double largest = std::max(at_a.curvature_per_m.norm(), at_b.curvature_per_m.norm());
    if (!(bends[0] > 1e-6 * largest)) return false;
    // Slopes of both surfaces over the plane across the normal.
    const Eigen::Vector2d slope_a = -plane.transpose() * at_a.normal / at_a.normal.dot(normal);
    const Eigen::Vector2d slope_b = -plane.transpose() * at_b.normal / at_b.normal.dot(normal);
    const Eigen::Vector2d place_a = plane.transpose() * (at_a.point_m - nearest.on_a);
    const Eigen::Vector2d place_b = plane.transpose() * (at_b.point_m - nearest.on_a);
    const Eigen::Vector2d place =
        curvature.ldlt().solve(curved_b * place_b + curved_a * place_a - slope_b + slope_a);
    const auto next = [&](const SurfacePoint& at, const Eigen::Vector2d& from,
                          const Eigen::Vector2d& slope) -> Vector3d {
      const Eigen::Vector2d step = place - from;
      return at.point_m + plane * step + slope.dot(step) * normal;
    };
    const Vector3d next_a = next(at_a, place_a, slope_a), next_b = next(at_b, place_b, slope_b);
    const double moved = (next_a - on_a).norm() + (next_b - on_b).norm();
    on_a = next_a;
    on_b = next_b;
    if ((on_a - nearest.on_a).norm() > far) return false;
    if (round > 0 && moved < 1e-13 * far) break;
  }
  const SurfacePoint at_a = surface(a, memory.fits[0], on_a);
  const SurfacePoint at_b = surface(b, memory.fits[1], on_b);
  if (!at_a.smooth || !at_b.smooth) return false;
  if (lies(a, at_a.point_m, at_b, reach_m) || lies(b, at_b.point_m, at_a, reach_m)) return false;
  nearest = {at_a.point_m, at_b.point_m, normal, normal.dot(at_b.point_m - at_a.point_m)};
  memory.normal_in_a = a.pose.linear().transpose() * normal;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal(curvature);
  point.point_m = (at_a.point_m + at_b.point_m) / 2;
  point.gap_m = nearest.gap_m;
  point.elliptic = true;
  point.radii = {1 / principal.eigenvalues()[0], 1 / principal.eigenvalues()[1], 0};
  point.axes.col(2) = normal;
  point.axes.col(0) = (axes.leftCols<2>() * principal.eigenvectors().col(0)).normalized();
  point.axes.col(1) = normal.cross(point.axes.col(0));
  return true;
}

void CollisionDetector::Implementation::find_bearing(const Part& a, const Part& b,
                                                     const Nearest& nearest, double reach_m,
                                                     long first_id,
                                                     std::vector<TouchingPoint>& points) const {
  const std::size_t first = points.size();
  TouchingPoint point;
  point.a = a.body;
  point.b = b.body;
  const double same_m = 1e-6 * std::min(a.radius_m, b.radius_m);
  const auto add = [&](const Vector3d& on_a, const Vector3d& on_b, const Vector3d& normal,
                       double gap_m, long id) {
    point.point_m = (on_a + on_b) / 2;
    for (std::size_t other = first; other < points.size(); ++other)
      if ((points[other].point_m - point.point_m).norm() < same_m) return;
    point.axes = any_axes(normal);
    point.gap_m = gap_m;
    point.id = first_id + id;
    points.push_back(point);
  };
  // A body that is round all over is held in one point, and its nearest point is not the one below.
  const auto round_all_over = [](const Part& part) {
    return std::holds_alternative<input::Sphere>(part.shape->kind) ||
           std::holds_alternative<input::Ellipsoid>(part.shape->kind);
  };
  if (round_all_over(a) || round_all_over(b)) {
    add(nearest.on_a, nearest.on_b, nearest.normal, nearest.gap_m, 0);
    return;
  }
  long id = 0;
  for (const bool from_a : {true, false}) {
    const Part& from = from_a ? a : b;
    const Part& to = from_a ? b : a;
    const double sign = from_a ? 1 : -1;
    if (to.is_mesh()) {
      id += 16;
      continue;
    }
    const long start = id;
    for (const Vector3d& local : bearing_points(
             from.shape->kind, from.pose.linear().transpose() * (sign * nearest.normal), reach_m)) {
      const Vector3d bearing = from.pose * local;
      ++id;
      // Beyond the other's edge, or through one of its other faces, is not under this contact.
      const SurfacePoint under = surface(to, std::nullopt, bearing);
      const double facing = -sign * nearest.normal.dot(under.normal);
      Vector3d normal = nearest.normal, on_other = under.point_m;
      double gap_m = 0;
      if (facing > 1 - 1e-3) {
        normal = -sign * under.normal;
        gap_m = under.normal.dot(bearing - under.point_m);
      } else {
        // On the edge itself to round-off: the pair's normal decides.
        gap_m = sign * nearest.normal.dot(under.point_m - bearing);
        const Vector3d aside = under.point_m - bearing - sign * gap_m * nearest.normal;
        if (aside.norm() > same_m) continue;
      }
      if (gap_m > reach_m) continue;
      if (from_a)
        add(bearing, on_other, normal, gap_m, id);
      else
        add(on_other, bearing, normal, gap_m, id);
    }
    id = start + 16;
  }
  // Flat on flat: the corners of the common polygon that are corners of neither.
  const auto* box_a = std::get_if<input::Box>(&a.shape->kind);
  const auto* box_b = std::get_if<input::Box>(&b.shape->kind);
  if (box_a && box_b) {
    const std::vector<Edge> edges_a = bearing_edges(*box_a, a.pose, nearest.normal, reach_m);
    const std::vector<Edge> edges_b = bearing_edges(*box_b, b.pose, -nearest.normal, reach_m);
    for (const Edge& on_a : edges_a)
      for (const Edge& on_b : edges_b) {
        const Vector3d across = on_a.along.cross(on_b.along);
        const double turn = nearest.normal.dot(across);
        if (!(std::abs(turn) > 1e-9 * on_a.along.norm() * on_b.along.norm())) continue;
        const Vector3d apart = on_b.start - on_a.start;
        const double part_a = nearest.normal.dot(apart.cross(on_b.along)) / turn;
        const double part_b = nearest.normal.dot(apart.cross(on_a.along)) / turn;
        if (!(part_a > 0 && part_a < 1 && part_b > 0 && part_b < 1)) continue;
        const Vector3d point_a = on_a.start + part_a * on_a.along;
        const Vector3d point_b = on_b.start + part_b * on_b.along;
        const double gap_m = nearest.normal.dot(point_b - point_a);
        if (gap_m > reach_m) continue;
        add(point_a, point_b, nearest.normal, gap_m, 40 + 12 * on_a.number + on_b.number);
      }
  }
  // Where none of these is as near as the nearest point, edges or rims cross there.
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t p = first; p < points.size(); ++p) least_m = std::min(least_m, points[p].gap_m);
  if (least_m > nearest.gap_m + same_m / 10)
    add(nearest.on_a, nearest.on_b, nearest.normal, nearest.gap_m, id);
}

void CollisionDetector::Implementation::find_between(int first, int second,
                                                     std::vector<TouchingPoint>& points) {
  // Half-spaces and bodies of higher index come second; the contact itself has a < b.
  int one = first, other = second;
  if (parts[std::size_t(one)].is_half_space()) std::swap(one, other);
  const Part& a = parts[std::size_t(one)];
  const Part& b = parts[std::size_t(other)];
  const double reach = reach_m(a, b);
  // Spheres about both exclude most.
  if (!b.is_half_space() &&
      (a.pose.translation() - b.pose.translation()).norm() > a.radius_m + b.radius_m + reach)
    return;
  PairMemory& memory = memories[{one, other}];
  Nearest at = nearest(a, b, memory);
  if (at.gap_m > reach) return;
  const std::size_t before = points.size();
  const long first_id = (long(first) * long(parts.size()) + second) * kIds;
  TouchingPoint point;
  point.a = a.body;
  point.b = b.body;
  point.id = first_id;
  if (find_round(a, b, memory, at, reach, point)) {
    if (point.gap_m <= reach) points.push_back(point);
  } else {
    find_bearing(a, b, at, reach, first_id + 1, points);
  }
  for (std::size_t p = before; p < points.size(); ++p) {
    TouchingPoint& found = points[p];
    if (found.a < found.b) continue;
    std::swap(found.a, found.b);
    found.axes.col(2) *= -1;
    found.axes.col(1) *= -1;
  }
}

CollisionDetector::CollisionDetector(const input::Scene& scene)
    : implementation_(std::make_unique<Implementation>(scene)) {}
CollisionDetector::~CollisionDetector() = default;

void CollisionDetector::find(const Multibody& bodies, double time_step_s,
                             std::vector<TouchingPoint>& points) {
  implementation_->find(bodies, time_step_s, points);
}

void CollisionDetector::require_no_overlap(const Multibody& bodies) {
  std::vector<TouchingPoint> points;
  implementation_->find(bodies, 0, points);
  for (const TouchingPoint& point : points) {
    double smaller_m = std::numeric_limits<double>::infinity();
    for (const Part& part : implementation_->parts)
      if (part.body == point.a || part.body == point.b) {
        smaller_m = std::min(smaller_m, part.radius_m);
      }
    if (point.gap_m >= -1e-4 * smaller_m) continue;
    throw InputError(implementation_->scene.file.string(),
                     fmt::format("overlap of \"{}\" and \"{}\" at the start, in mm",
                                 bodies.body(point.a).name, bodies.body(point.b).name),
                     fmt::format("{:.4g}", -point.gap_m * 1e3),
                     "bodies that do not interpenetrate");
  }
}

int CollisionDetector::fits() const { return implementation_->fits; }

}  // namespace softfinger::simulation
