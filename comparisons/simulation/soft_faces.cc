#include "comparisons/simulation/soft_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <variant>

#include "comparisons/simulation/shape_pair.h"
#include "softfinger/input/errors.h"
#include "softfinger/pads/pad_model.h"

namespace softfinger::simulation {

/// An outline by the area and moments that decide e_n, and its pressure for a load in the middle.
struct SoftFaces::Face::Outline {
  double area_m2;
  Eigen::Vector2d centroid_m;
  Eigen::Matrix2d second_moments_m4;
  EccentricLoad load;

  /// Whether another outline has the same pressure to a hundredth.
  bool is_near(const ConvexOutline& other) const {
    constexpr double kNear = 0.01;
    return std::abs(other.area_m2() - area_m2) <= kNear * area_m2 &&
           (other.centroid_m() - centroid_m).squaredNorm() <= kNear * kNear * area_m2 &&
           (other.second_moments_m4() - second_moments_m4).norm() <=
               kNear * second_moments_m4.norm();
  }
};

namespace {

/// The corners of the convex hull, counter-clockwise (Andrew 1979).
std::vector<Eigen::Vector2d> hull_corners(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const auto& one, const auto& other) {
    return one.x() != other.x() ? one.x() < other.x() : one.y() < other.y();
  });
  std::vector<Eigen::Vector2d> corners;
  const auto add_chain = [&corners](auto first, auto last) {
    const std::size_t start = corners.size();
    for (auto point = first; point != last; ++point) {
      while (corners.size() >= start + 2) {
        const Eigen::Vector2d along = corners.back() - corners[corners.size() - 2];
        const Eigen::Vector2d next = *point - corners.back();
        if (along.x() * next.y() - along.y() * next.x() > 0) break;
        corners.pop_back();
      }
      corners.push_back(*point);
    }
    corners.pop_back();
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return corners;
}

bool has_cylinder(const input::SceneBody& body) {
  return std::any_of(body.shapes.begin(), body.shapes.end(), [](const input::Shape& shape) {
    return std::holds_alternative<input::Cylinder>(shape.kind);
  });
}

/// The face that touches at these points; none where they lie on a line.
/// @param may_be_rim  corners at the same distance from the middle are those of a cylinder's end,
///                    which has six
std::optional<ConvexOutline> outline_of(const std::vector<Eigen::Vector2d>& points,
                                        bool may_be_rim) {
  constexpr double kNarrowest = 0.02;
  constexpr std::size_t kRim = 6;
  const std::vector<Eigen::Vector2d> corners = hull_corners(points);
  if (corners.size() < 3) return std::nullopt;
  try {
    ConvexOutline polygon = ConvexOutline::polygon(corners);
    if (polygon.least_width_m() < kNarrowest * polygon.largest_width_m()) return std::nullopt;
    const auto& kept = polygon.vertices_m();
    double least = 1e300, largest = 0;
    for (const Eigen::Vector2d& corner : kept) {
      const double radius_m = (corner - polygon.centroid_m()).norm();
      least = std::min(least, radius_m);
      largest = std::max(largest, radius_m);
    }
    constexpr double kRound = 1e-6;
    if (may_be_rim && kept.size() >= kRim && largest - least <= kRound * largest)
      return ConvexOutline::disc(2 * largest).moved(0, polygon.centroid_m());
    return polygon;
  } catch (const InputError&) {
    return std::nullopt;  // rounding has left no polygon of them
  }
}

/// Tangents that turn with a body, so that coordinates in the plane last from step to step.
/// @param across  the body's axis that the first tangent follows, kept while it lies in the plane
Eigen::Matrix3d axes_on(const Eigen::Matrix3d& body, const Eigen::Vector3d& normal, int& across) {
  constexpr double kUpright = 0.8;
  const Eigen::Vector3d along_normal = (body.transpose() * normal).cwiseAbs();
  if (across < 0 || along_normal[across] > kUpright) along_normal.minCoeff(&across);
  Eigen::Matrix3d axes;
  axes.col(2) = normal;
  axes.col(0) = (body.col(across) - normal * normal.dot(body.col(across))).normalized();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

}  // namespace

bool SoftFaces::describe(const std::vector<std::size_t>& group,
                         const std::vector<TouchingPoint>& points, const Multibody& bodies,
                         Face& face) const {
  const TouchingPoint& first = points[group.front()];
  const auto& layer_a = scene_.bodies[std::size_t(first.a)].layer;
  const auto& layer_b = scene_.bodies[std::size_t(first.b)].layer;
  const Eigen::Isometry3d& finger = bodies.pose(layer_a ? first.a : first.b);
  const int across_before = face.across;
  face.axes = axes_on(finger.linear(), first.axes.col(2), face.across);
  if (face.across != across_before) face.last_centre_m.reset();
  face.origin_m = finger.translation();
  face.height_m = 0;
  std::vector<Eigen::Vector2d> places;
  for (const std::size_t p : group) {
    const Eigen::Vector3d local = face.axes.transpose() * (points[p].point_m - face.origin_m);
    places.emplace_back(local.head<2>());
    face.height_m += local.z() / double(group.size());
  }
  const bool may_be_rim = has_cylinder(scene_.bodies[std::size_t(first.a)]) ||
                          has_cylinder(scene_.bodies[std::size_t(first.b)]);
  const std::optional<ConvexOutline> outline = outline_of(places, may_be_rim);
  if (!outline) return false;
  if (!face.outline || !face.outline->is_near(*outline)) {
    const PadShape shape(*outline);
    PadProblem problem;
    problem.shape = &shape;
    problem.layer = layer_a ? *layer_a : *layer_b;
    problem.load = {scene_.nominal_load_N, 1};
    const PadModel& model = *find_pad_model("pad_layer");
    const PadPrediction prediction = model.predict(problem);
    face.stuck = {prediction.torsional_stiffness_Nm_per_rad,
                  prediction.tangential_stiffness_N_per_m[0],
                  prediction.tangential_stiffness_N_per_m[1]};
    const Eigen::Vector2d extent_m = outline->extent_m();
    face.aspect = extent_m.minCoeff() / extent_m.maxCoeff();
    face.size = extent_m.maxCoeff() / 2 / problem.layer.thickness_m;
    face.answered_at_m.reset();
    face.outline = std::make_shared<const Face::Outline>(
        Face::Outline{outline->area_m2(), outline->centroid_m(), outline->second_moments_m4(),
                      EccentricLoad(model.slipping_pressure(problem))});
  }
  const EccentricLoad& load = face.outline->load;
  const Eigen::Vector2d centre_m = face.last_centre_m.value_or(load.middle_m());
  // e_n changes with the square of the centre's place, over the face's size.
  constexpr double kSame = 1e-3;
  if (!face.answered_at_m ||
      (centre_m - *face.answered_at_m).squaredNorm() > kSame * kSame * outline->area_m2()) {
    face.answered_at_m = centre_m;
    face.eccentricity_m = load.at(centre_m).eccentricity_m;
  }
  face.area_m2 = outline->area_m2();
  face.centre_m =
      face.origin_m + face.axes * Eigen::Vector3d(centre_m.x(), centre_m.y(), face.height_m);
  return face.eccentricity_m > 0;
}

void SoftFaces::describe(const std::vector<TouchingPoint>& points, const Multibody& bodies,
                         std::vector<Contact>& contacts) {
  std::map<long, std::vector<std::size_t>> groups;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const TouchingPoint& point = points[p];
    const bool is_soft =
        scene_.bodies[std::size_t(point.a)].layer || scene_.bodies[std::size_t(point.b)].layer;
    if (!point.elliptic && is_soft &&
        std::holds_alternative<input::AutomaticModel>(scene_.rule(point.a, point.b).model))
      groups[pair_of(point.id)].push_back(p);
  }
  for (auto& [pair, face] : faces_) face.is_here = false;
  for (const auto& [pair, group] : groups) {
    if (group.size() < 3) continue;
    Face& face = faces_[pair];
    face.is_here = describe(group, points, bodies, face);
    if (!face.is_here) continue;
    Contact friction = contacts[group.front()];
    friction.role = Contact::FaceRole::friction;
    friction.id = pair * kSlots + slot::kFriction;
    friction.axes = face.axes;
    friction.point_m = face.centre_m;
    friction.gap_m = 0;
    friction.eccentricity_m = face.eccentricity_m;
    for (const std::size_t p : group) {
      contacts[p].role = Contact::FaceRole::soft_point;
      contacts[p].axes = face.axes;
      contacts[p].friction_coefficient = 0;
    }
    contacts.push_back(friction);
  }
  for (auto entry = faces_.begin(); entry != faces_.end();)
    entry = entry->second.is_here ? std::next(entry) : faces_.erase(entry);
}

void SoftFaces::settle(const TimeStepper& stepper) {
  std::unordered_map<long, Eigen::Vector3d> sums;  // force, and force times place
  for (int i = 0; i < int(stepper.contacts().size()); ++i) {
    const Contact& contact = stepper.contacts()[std::size_t(i)];
    const Face* const face = this->face(contact);
    if (!face || contact.role == Contact::FaceRole::friction) continue;
    const double force_N = stepper.wrench(i).normal_force_N;
    const Eigen::Vector3d place = face->axes.transpose() * (contact.point_m - face->origin_m);
    auto& sum = sums.try_emplace(contact.face, Eigen::Vector3d::Zero()).first->second;
    sum += force_N * Eigen::Vector3d(1, place.x(), place.y());
  }
  for (const auto& [pair, sum] : sums)
    if (sum[0] > 0) faces_.at(pair).move_centre(sum.tail<2>() / sum[0]);
}

/// Friction at the centre of an earlier pressure moves the centre of the next one, by mu times the
/// bodies' size over e_n, and may drive it to and fro. So the centre follows by part of the way,
/// by how it answered to the last part (Aitken; Küttler, Wall, Comput. Mech. 43 (2008), eq. 44).
void SoftFaces::Face::move_centre(const Eigen::Vector2d& pressed_m) {
  constexpr double kLeast = 0.02;
  if (!last_centre_m) {
    last_centre_m = pressed_m;
    return;
  }
  const Eigen::Vector2d left_m = pressed_m - *last_centre_m, change_m = left_m - last_way_m;
  if (last_way_m.squaredNorm() > 0 && change_m.squaredNorm() > 0)
    part_of_way =
        std::clamp(-part_of_way * last_way_m.dot(change_m) / change_m.squaredNorm(), kLeast, 1.);
  last_way_m = left_m;
  *last_centre_m += part_of_way * left_m;
}

const SoftFaces::Face* SoftFaces::face(const Contact& contact) const {
  if (contact.role == Contact::FaceRole::rigid_point) return nullptr;
  const auto found = faces_.find(contact.face);
  return found == faces_.end() ? nullptr : &found->second;
}

}  // namespace softfinger::simulation
