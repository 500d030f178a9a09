#include "comparisons/simulation/shape_distances.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>

#include "comparisons/simulation/surface_point.h"

namespace softfinger::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

Geometry geometry(const input::Sphere& sphere) {
  return std::make_shared<fcl::Sphered>(sphere.radius_m);
}
Geometry geometry(const input::Ellipsoid& ellipsoid) {
  return std::make_shared<fcl::Ellipsoidd>(ellipsoid.semi_axes_m);
}
Geometry geometry(const input::Cylinder& cylinder) {
  return std::make_shared<fcl::Cylinderd>(cylinder.radius_m, cylinder.length_m);
}
Geometry geometry(const input::Capsule& capsule) {
  return std::make_shared<fcl::Capsuled>(capsule.radius_m, capsule.length_m);
}
Geometry geometry(const input::Box& box) { return std::make_shared<fcl::Boxd>(box.size_m); }
Geometry geometry(const input::HalfSpace&) { return nullptr; }
Eigen::AlignedBox3d box_of(const input::Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : mesh.surface->vertices_m) box.extend(vertex);
  return box;
}

Geometry triangles_of(const input::Mesh& mesh) {
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : mesh.surface->triangles)
    triangles.emplace_back(std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2]));
  model->beginModel(int(triangles.size()), int(mesh.surface->vertices_m.size()));
  model->addSubModel(mesh.surface->vertices_m, triangles);
  model->endModel();
  return model;
}

/// A mesh is looked for by its box.
Geometry geometry(const input::Mesh& mesh) {
  const Eigen::AlignedBox3d box = box_of(mesh);
  return std::make_shared<fcl::Boxd>(box.sizes());
}

struct Item {
  int index = -1;
  double radius_m = 0;
  const input::Mesh* mesh = nullptr;              ///< null: the shape is none
  Vector3d centre_m = Vector3d::Zero();           ///< of `object` in the shape's frame
  std::unique_ptr<fcl::CollisionObjectd> object;  ///< null: a half-space
  Geometry triangles;                             ///< of a mesh, once its distance is asked for

  const fcl::CollisionGeometryd* exact() {
    if (!mesh) return object->collisionGeometry().get();
    // Many meshes only ever meet shapes that need no such tree.
    if (!triangles) triangles = triangles_of(*mesh);
    return triangles.get();
  }
};

/// Difference between the distance of the nearest points and the stated distance (m). FCL finds
/// both from the same corners. A direction between the points that is wrong by an angle changes how
/// far apart they are by half its square.
double mismatch_m(const ShapeDistances::Nearest& nearest) {
  return std::abs((nearest.on_b - nearest.on_a).norm() - nearest.distance_m);
}

/// Whether only rounding makes the mismatch: 2e-15 of the coordinates at most, of all pairs of
/// shapes but a mesh and a sphere, for which FCL 0.7 is not asked.
bool belong_together(const ShapeDistances::Nearest& nearest) {
  constexpr double kRounding = 1e-14;
  const double size_m = nearest.on_a.norm() + nearest.on_b.norm() + nearest.distance_m;
  return mismatch_m(nearest) <= kRounding * size_m;
}

int index_of(const fcl::CollisionObjectd* object) {
  return static_cast<const Item*>(object->getUserData())->index;
}

}  // namespace

struct ShapeDistances::Implementation {
  std::vector<Item> items;  ///< FCL points into it
  fcl::DynamicAABBTreeCollisionManagerd manager;
};

ShapeDistances::ShapeDistances(const std::vector<const input::ShapeKind*>& shapes)
    : implementation_(std::make_unique<Implementation>()) {
  std::vector<Item>& items = implementation_->items;
  items.resize(shapes.size());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    Item& item = items[i];
    item.index = int(i);
    item.radius_m = bounding_radius_m(*shapes[i]);
    item.mesh = std::get_if<input::Mesh>(shapes[i]);
    if (item.mesh) item.centre_m = box_of(*item.mesh).center();
    const Geometry own = std::visit([](const auto& kind) { return geometry(kind); }, *shapes[i]);
    if (!own) continue;
    item.object = std::make_unique<fcl::CollisionObjectd>(own);
    item.object->setUserData(&item);
    implementation_->manager.registerObject(item.object.get());
  }
  implementation_->manager.setup();
}

ShapeDistances::~ShapeDistances() = default;

std::vector<std::pair<int, int>> ShapeDistances::near_pairs(const std::vector<Isometry3d>& poses,
                                                            double distance_m) {
  for (Item& item : implementation_->items) {
    if (!item.object) continue;
    item.object->setTransform(poses[std::size_t(item.index)] * Eigen::Translation3d(item.centre_m));
    item.object->computeAABB();
  }
  implementation_->manager.update();
  struct Search {
    double distance_m;
    std::vector<std::pair<int, int>> pairs;
  } search{distance_m, {}};
  // FCL asks about pairs whose boxes are nearer than `distance`, which the answer may change.
  implementation_->manager.distance(
      &search,
      [](fcl::CollisionObjectd* one, fcl::CollisionObjectd* other, void* data, double& distance) {
        auto& found = *static_cast<Search*>(data);
        distance = found.distance_m;
        found.pairs.push_back(std::minmax(index_of(one), index_of(other)));
        return false;
      });
  return std::move(search.pairs);
}

ShapeDistances::Nearest ShapeDistances::nearest(int a, const Isometry3d& pose_a, int b,
                                                const Isometry3d& pose_b,
                                                double tolerance_m) const {
  Item& one = implementation_->items[std::size_t(a)];
  Item& other = implementation_->items[std::size_t(b)];
  // FCL 0.7 names the mesh's point first, whatever the order of the call.
  if (other.mesh && !one.mesh) {
    Nearest turned = nearest(b, pose_b, a, pose_a, tolerance_m);
    std::swap(turned.on_a, turned.on_b);
    return turned;
  }
  const auto ask = [&](const Isometry3d& pose_of_b) {
    fcl::DistanceRequestd request(true);
    request.distance_tolerance = tolerance_m;
    fcl::DistanceResultd found;
    Nearest asked;
    asked.distance_m = fcl::distance(one.exact(), pose_a, other.exact(), pose_of_b, request, found);
    asked.on_a = found.nearest_points[0];
    asked.on_b = found.nearest_points[1];
    if (!(asked.distance_m > 0) || belong_together(asked)) return asked;
    // For some pairs FCL 0.7 gives the points in the shapes' own frames.
    Nearest local = asked;
    local.on_a = pose_a * found.nearest_points[0];
    local.on_b = pose_of_b * found.nearest_points[1];
    return mismatch_m(local) < mismatch_m(asked) ? local : asked;
  };
  const Nearest first = ask(pose_b);
  if (!(first.distance_m > 0) || belong_together(first)) return first;
  // FCL may give two points that do not belong together if faces are parallel to rounding. Those of
  // a shape that is turned by a little do, and the distance is known.
  const Vector3d axis = Vector3d(1, 2, 3).normalized();
  Nearest best = first;
  for (const double little_rad : {1e-10, 1e-9, 1e-8, 1e-7, 1e-6}) {
    const Nearest turned = ask(pose_b * Eigen::AngleAxisd(little_rad, axis));
    if (turned.distance_m > 0 && mismatch_m(turned) < mismatch_m(best)) best = turned;
    if (belong_together(best)) break;
  }
  constexpr double kMostAngle = 0.01;  // of the direction
  best.has_points = mismatch_m(best) <= kMostAngle * kMostAngle / 2 * best.distance_m;
  best.on_b = best.on_a + first.distance_m * (best.on_b - best.on_a).normalized();
  best.distance_m = first.distance_m;
  return best;
}

}  // namespace softfinger::simulation
