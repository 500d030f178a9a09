#include "comparisons/commands/finger_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <unordered_map>

#include "comparisons/commands/case_input.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/exporting/pad_contact.h"
#include "comparisons/input/mesh_file.h"
#include "comparisons/prediction/flat_faces.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/mesh_points.h"
#include "comparisons/robots/mesh_file.h"
#include "comparisons/robots/package_paths.h"
#include "comparisons/text/nearest_name.h"
#include "comparisons/text/number.h"
#include "meshes/io/mesh_formats.h"
#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using exporting::NamedMesh;
using exporting::RobotBody;
using exporting::RobotJoint;
using exporting::RobotShape;
using exporting::RobotShapes;
using exporting::ShapePad;

constexpr const char* kPadAllowed =
    "[FINGER:]+x, -x, +y, -y, +z or -z, or [FINGER:]X,Y,Z in mm, in the axes of the finger's body "
    "or link";

std::string in_quotes(const std::string& name) { return "\"" + text::shortened(name) + "\""; }

/// "+z", or "[0.2, 0, 0.98]"
std::string direction_words(const Vector3d& direction) {
  constexpr double kAligned = 1 - 1e-9;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(direction[axis]) > kAligned)
      return std::string(direction[axis] > 0 ? "+" : "-") + "xyz"[axis];
  const Vector3d positive = direction.array() + 0.;
  return fmt::format("[{:.2f}, {:.2f}, {:.2f}]", positive.x(), positive.y(), positive.z());
}

Eigen::AlignedBox3d box_of(const TriangleSurface& surface) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : surface.vertices_m) box.extend(vertex);
  return box;
}

/// The place of a pad, typed or guessed, in the axes of the body.
struct PadPlace {
  std::optional<Vector3d> direction, point_m;  ///< one of them
  std::string words;
  bool is_guessed = false;
};

std::optional<PadPlace> read_place(const std::string& typed) {
  PadPlace place;
  if (const auto direction = input::axis_direction(typed)) {
    place.direction = *direction;
    place.words = "towards " + direction_words(*direction);
    return place;
  }
  const auto numbers = text::read_numbers(typed);
  if (!numbers || numbers->size() != 3) return std::nullopt;
  place.point_m = 1e-3 * Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  place.words =
      fmt::format("nearest to [{:g}, {:g}, {:g}] mm", (*numbers)[0], (*numbers)[1], (*numbers)[2]);
  return place;
}

/// The pads as typed, by finger; those without a finger's name are under "".
std::map<std::string, PadPlace> read_pads(const std::vector<std::string>& pads,
                                          const std::vector<exporting::FingerParts>& fingers) {
  std::vector<std::string> names;
  for (const auto& finger : fingers) names.push_back(finger.name);
  std::map<std::string, PadPlace> places;
  for (const std::string& typed : pads) {
    const std::size_t colon = typed.rfind(':');
    const std::string name = colon == std::string::npos ? "" : typed.substr(0, colon);
    const auto place = read_place(colon == std::string::npos ? typed : typed.substr(colon + 1));
    if (!place) throw InputError("command line", "--pad", in_quotes(typed), kPadAllowed);
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
      throw InputError("command line", "--pad of no --finger" + text::did_you_mean(name, names),
                       in_quotes(name), text::shortened(text::joined(names), 200));
    if (!places.emplace(name, *place).second)
      throw InputError("command line", "--pad", in_quotes(typed), "one pad for each finger");
  }
  return places;
}

/// The three numbers of --layer take the place of three options.
CaseInput numbers_of_case(const ShapeChoice& typed, const ContactChoice& choice) {
  CaseInput numbers = choice.typed_case;
  numbers.load_N = choice.load;
  numbers.radii_mm = "1";  // stands in: the radii are the shapes'
  if (typed.layer.empty()) return numbers;
  constexpr const char* kAllowed =
      "THICKNESS_mm,YOUNGS_MODULUS_kPa,POISSON_RATIO, such as 2,300,0.49";
  std::vector<std::string> parts = {""};
  for (const char letter : typed.layer)
    if (letter == ',')
      parts.emplace_back();
    else
      parts.back() += letter;
  if (parts.size() != 3 ||
      std::any_of(parts.begin(), parts.end(), [](const std::string& part) { return part.empty(); }))
    throw InputError("command line", "--layer", in_quotes(typed.layer), kAllowed);
  const std::array<std::string*, 3> places = {&numbers.thickness_mm, &numbers.youngs_modulus_kPa,
                                              &numbers.poisson_ratio};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!places[i]->empty())
      throw InputError("command line", "--layer", in_quotes(typed.layer),
                       "the layer once: either --layer or --thickness-mm, --youngs-modulus-kPa "
                       "and --poisson-ratio");
    *places[i] = parts[i];
    const auto number = text::read_number(parts[i]);
    if (!number || !(i == 2 ? *number >= 0 && *number <= 0.5 : *number > 0))
      throw InputError("command line", "--layer", in_quotes(typed.layer), kAllowed);
  }
  return numbers;
}

class Fingers {
 public:
  Fingers(const RobotShapes& shapes, const std::vector<exporting::FingerParts>& fingers,
          RobotMeshes& meshes)
      : shapes_(shapes), fingers_(fingers), meshes_(meshes) {
    for (const RobotShape& shape : shapes.shapes) by_element_[shape.element] = &shape;
  }

  /// The shapes of a finger that can touch.
  /// @throws InputError where there is none
  std::vector<const RobotShape*> usable(const exporting::FingerParts& finger) const {
    std::vector<const RobotShape*> found;
    const RobotShape* last = nullptr;
    for (const exporting::XmlElement* element : finger.elements) {
      const auto known = by_element_.find(element);
      if (known == by_element_.end()) continue;
      last = known->second;
      if (!std::holds_alternative<std::monostate>(last->kind)) found.push_back(last);
    }
    if (found.empty())
      throw InputError(finger.elements.front()->where(), "--finger " + text::shortened(finger.name),
                       last ? last->unknown : "no shape",
                       "a sphere, capsule, cylinder, ellipsoid or mesh, or a CASE with the radii");
    return found;
  }

  /// The middle of a finger in the axes of its body.
  Vector3d middle_m(const std::vector<const RobotShape*>& shapes) {
    Vector3d sum = Vector3d::Zero();
    for (const RobotShape* shape : shapes) sum += shape->in_body * middle_m(shape->kind);
    return sum / double(shapes.size());
  }

  PadPlace guessed(const exporting::FingerParts& finger,
                   const std::vector<const RobotShape*>& shapes) {
    const std::size_t body = shapes.front()->body;
    const Vector3d middle = middle_m(shapes);
    PadPlace place;
    place.is_guessed = true;
    std::string reason;
    Vector3d direction = closing(body, middle, reason);
    if (direction.isZero(0)) direction = towards_others(body, middle, reason);
    if (direction.isZero(0) && shapes.size() == 1 &&
        std::holds_alternative<input::Sphere>(shapes.front()->kind)) {
      direction = Vector3d::UnitZ();
      reason = "as all its sides are alike";
    }
    if (direction.isZero(0)) {
      std::string end;
      if (const auto farthest = away_from_joints(body, middle))
        end = fmt::format("--pad {}:{}, its far end, or another ", finger.name,
                          direction_words(*farthest));
      throw InputError(finger.elements.front()->where(),
                       "the pad of " + in_quotes(finger.name) +
                           ": no joint and no other finger says on which side it lies",
                       "", end + "--pad " + kPadAllowed);
    }
    // A pad lies mostly along an axis of its link.
    constexpr double kNearAxis = 0.9;  // 26 degrees
    int axis = 0;
    if (direction.cwiseAbs().maxCoeff(&axis) > kNearAxis)
      direction = Vector3d((direction[axis] > 0 ? 1. : -1.) * Vector3d(Vector3d::Unit(axis)));
    place.direction = direction;
    place.words = "towards " + direction_words(direction) + ", " + reason;
    return place;
  }

  /// The shape of a finger on which the pad lies, and the pad; a mesh has only its point.
  struct Found {
    const RobotShape* shape = nullptr;
    std::optional<ShapePad> pad;
    Vector3d point_in_body_m = Vector3d::Zero();
    std::vector<Found> flush;  ///< on other shapes that end in the same plane across a direction
  };
  Found find(const exporting::FingerParts& finger, const std::vector<const RobotShape*>& shapes,
             const PadPlace& place) {
    Found best;
    double best_value = 0;
    for (const RobotShape* shape : shapes) {
      const Found found = on_shape(shape, place);
      // The farthest along the direction, or the nearest to the point.
      const double value = place.direction ? -place.direction->dot(found.point_in_body_m)
                                           : (found.point_in_body_m - *place.point_m).norm();
      constexpr double kSamePlane_m = 1e-5;
      const bool is_flush =
          best.shape && place.direction && std::abs(value - best_value) < kSamePlane_m;
      if (is_flush) best.flush.push_back(found);
      if (best.shape && (is_flush || value >= best_value)) continue;
      best = found;
      best_value = value;
    }
    if (place.point_m) require_near(finger, best, *place.point_m, best_value);
    return best;
  }

  /// The flat face on which the pad lies, if it does.
  std::optional<exporting::FlatEnd> flat_end(const Found& found, const PadPlace& place) {
    if (found.pad) {
      if (!found.pad->is_flat()) return std::nullopt;
      exporting::FlatEnd own = exporting::flat_end(found.shape->kind, *found.pad);
      std::vector<exporting::FlatEnd> all = {own};
      for (const Found& other : found.flush) {
        if (!other.pad || !other.pad->is_flat()) return own;
        all.push_back(exporting::flat_end(other.shape->kind, *other.pad));
        all.back().in_shape =
            found.shape->in_body.inverse() * other.shape->in_body * all.back().in_shape;
      }
      if (all.size() > 1)
        if (const auto together = exporting::joined(all)) return together;
      return own;
    }
    const Isometry3d to_shape = found.shape->in_body.inverse();
    std::optional<Vector3d> facing;
    if (place.direction) facing = to_shape.linear() * *place.direction;
    return exporting::flat_end_of_mesh(meshes_.read(std::get<NamedMesh>(found.shape->kind)).surface,
                                       to_shape * place.point_m.value_or(found.point_in_body_m),
                                       facing);
  }

 private:
  /// @throws InputError where a typed point lies farther from the surface than 5 % of its size
  void require_near(const exporting::FingerParts& finger, const Found& found,
                    const Vector3d& point_m, double distance_m) {
    constexpr double kFarthest = 0.05;
    if (const auto* named = std::get_if<NamedMesh>(&found.shape->kind)) {
      try {
        prediction::require_point_on_surface(meshes_.read(*named).surface,
                                             found.shape->in_body.inverse() * point_m, "", "");
        return;
      } catch (const InputError&) {
      }
    } else if (distance_m <= kFarthest * found.pad->point_m.norm()) {
      return;
    }
    throw InputError(
        "command line", "--pad of " + in_quotes(finger.name),
        prediction::in_millimetres(point_m) + " mm",
        fmt::format("a point on {}; the nearest is {} mm, {:.3g} mm away", in_words(*found.shape),
                    prediction::in_millimetres(found.point_in_body_m),
                    1e3 * (found.point_in_body_m - point_m).norm()));
  }

  Vector3d middle_m(const exporting::RobotShapeKind& kind) {
    const auto* named = std::get_if<NamedMesh>(&kind);
    if (!named) return Vector3d::Zero();
    return box_of(meshes_.read(*named).surface).center();
  }

  /// A joint that bends one way further than the other closes that way.
  Vector3d closing(std::size_t body, const Vector3d& middle, std::string& reason) const {
    const RobotBody& own = shapes_.bodies[body];
    if (!own.is_placed) return Vector3d::Zero();
    const Vector3d at = own.in_world * middle;
    for (int carrier = int(body); carrier >= 0;
         carrier = shapes_.bodies[std::size_t(carrier)].parent) {
      const RobotBody& moved = shapes_.bodies[std::size_t(carrier)];
      for (auto joint = moved.joints.rbegin(); joint != moved.joints.rend(); ++joint) {
        if (!joint->is_hinge) return Vector3d::Zero();
        constexpr double kOneSided = 0.2;
        const double range = joint->upper - joint->lower;
        if (!std::isfinite(range) || !(std::abs(joint->lower + joint->upper) > kOneSided * range))
          continue;
        const Vector3d arm = at - moved.in_world * joint->anchor_m;
        const Vector3d motion = (moved.in_world.linear() * joint->axis).cross(arm);
        if (!(motion.norm() > 1e-3 * arm.norm()) || !(motion.norm() > 0)) continue;
        const double side = joint->lower + joint->upper > 0 ? 1 : -1;
        reason = "where joint " + in_quotes(joint->name) + " closes";
        return own.in_world.linear().transpose() * (side * motion.normalized());
      }
    }
    return Vector3d::Zero();
  }

  /// The axis of the body along which its middle lies farthest from the joint on which it hangs, or
  /// from the next one up the chain where it lies on that joint, or from its origin without a
  /// joint; null where it lies on them all.
  std::optional<Vector3d> away_from_joints(std::size_t body, const Vector3d& middle) const {
    constexpr double kOnJoint_m = 1e-3;
    const RobotBody& own = shapes_.bodies[body];
    Vector3d arm = Vector3d::Zero();
    for (int carrier = int(body); carrier >= 0 && arm.norm() < kOnJoint_m;
         carrier = shapes_.bodies[std::size_t(carrier)].parent) {
      const RobotBody& moved = shapes_.bodies[std::size_t(carrier)];
      if (!own.is_placed && &own != &moved) break;
      if (moved.joints.empty()) continue;
      arm = own.in_world.linear().transpose() *
            (own.in_world * middle - moved.in_world * moved.joints.back().anchor_m);
    }
    if (arm.norm() < kOnJoint_m) arm = middle;
    if (arm.norm() < kOnJoint_m) return std::nullopt;
    int axis = 0;
    arm.cwiseAbs().maxCoeff(&axis);
    return Vector3d((arm[axis] > 0 ? 1. : -1.) * Vector3d(Vector3d::Unit(axis)));
  }

  /// The direction to the other fingers, or to the other jaw of a gripper.
  Vector3d towards_others(std::size_t body, const Vector3d& middle, std::string& reason) {
    const RobotBody& own = shapes_.bodies[body];
    if (!own.is_placed) return Vector3d::Zero();
    Vector3d sum = Vector3d::Zero();
    std::size_t count = 0;
    std::string names;
    for (const auto& [other, middles] : middles_by_body()) {
      if (other == body) continue;
      names += (names.empty() ? "" : ", ") + text::shortened(middles.name);
      if (names.size() > 60) break;
    }
    sum = all_middles_.sum_m;
    count = all_middles_.count;
    if (const auto own_middles = middles_.find(body); own_middles != middles_.end()) {
      sum -= own_middles->second.sum_m;
      count -= own_middles->second.count;
    }
    if (count == 0) add_jaws(body, sum, count, names);
    if (count == 0) return Vector3d::Zero();
    const Vector3d away = sum / double(count) - own.in_world * middle;
    if (!(away.norm() > 1e-6)) return Vector3d::Zero();
    reason = "which faces " + names;
    return own.in_world.linear().transpose() * away.normalized();
  }

  /// The middles of the fingers on each body that has a place, in the world.
  struct Middles {
    Vector3d sum_m = Vector3d::Zero();
    std::size_t count = 0;
    std::string name;
  };
  const std::map<std::size_t, Middles>& middles_by_body() {
    if (!middles_.empty()) return middles_;
    for (const exporting::FingerParts& finger : fingers_) {
      const std::vector<const RobotShape*> shapes = usable(finger);
      const std::size_t body = shapes.front()->body;
      if (!shapes_.bodies[body].is_placed) continue;
      Middles& middles = middles_[body];
      const Vector3d at = shapes_.bodies[body].in_world * middle_m(shapes);
      middles.sum_m += at;
      all_middles_.sum_m += at;
      ++middles.count;
      ++all_middles_.count;
      middles.name = finger.name;
    }
    return middles_;
  }

  /// Bodies that slide on the same parent as the finger's.
  void add_jaws(std::size_t body, Vector3d& sum, std::size_t& count, std::string& names) {
    int jaw = int(body);
    while (jaw >= 0 && shapes_.bodies[std::size_t(jaw)].joints.empty())
      jaw = shapes_.bodies[std::size_t(jaw)].parent;
    if (jaw < 0) return;
    const int parent = shapes_.bodies[std::size_t(jaw)].parent;
    for (const RobotShape& shape : shapes_.shapes) {
      const RobotBody& other = shapes_.bodies[shape.body];
      const bool is_jaw = int(shape.body) != jaw && shape.body != body && other.parent == parent &&
                          !other.joints.empty() && !other.joints.front().is_hinge;
      if (!is_jaw || !other.is_placed || std::holds_alternative<std::monostate>(shape.kind))
        continue;
      sum += other.in_world * shape.in_body * middle_m(shape.kind);
      if (++count <= 3 && names.find(other.name) == std::string::npos)
        names += (names.empty() ? "" : ", ") + text::shortened(other.name);
    }
  }

  Found on_shape(const RobotShape* shape, const PadPlace& place) {
    Found found;
    found.shape = shape;
    const Isometry3d to_shape = shape->in_body.inverse();
    if (const auto* named = std::get_if<NamedMesh>(&shape->kind)) {
      const TriangleSurface& surface = meshes_.read(*named).surface;
      Vector3d point_m;
      if (place.direction) {
        point_m = prediction::extreme_point_m(surface, to_shape.linear() * *place.direction);
      } else {
        const Vector3d near = to_shape * *place.point_m;
        point_m =
            *std::min_element(surface.vertices_m.begin(), surface.vertices_m.end(),
                              [&](const Vector3d& one, const Vector3d& other) {
                                return (one - near).squaredNorm() < (other - near).squaredNorm();
                              });
      }
      found.point_in_body_m = shape->in_body * point_m;
      return found;
    }
    found.pad = place.direction ? pad_towards(shape->kind, to_shape.linear() * *place.direction)
                                : pad_near(shape->kind, to_shape * *place.point_m);
    found.point_in_body_m = shape->in_body * found.pad->point_m;
    return found;
  }

  const RobotShapes& shapes_;
  const std::vector<exporting::FingerParts>& fingers_;
  RobotMeshes& meshes_;
  std::map<std::size_t, Middles> middles_;
  Middles all_middles_;
  std::unordered_map<const exporting::XmlElement*, const RobotShape*> by_element_;
};

/// "--pad tip:0.0000,0.0000,18.0000"
std::string typed_pad(const std::string& finger, const Vector3d& point_in_body_m) {
  const Vector3d point_mm = 1e3 * point_in_body_m;
  return fmt::format("--pad {}:{:.4f},{:.4f},{:.4f}", finger, point_mm.x(), point_mm.y(),
                     point_mm.z());
}

/// "such as its end, --pad tip:0.0000,0.0000,18.0000", the end of a capsule or cylinder that lies
/// farther from its body's origin; empty for other shapes.
std::string end_in_words(const std::string& finger, const RobotShape& shape) {
  const auto* capsule = std::get_if<input::Capsule>(&shape.kind);
  const auto* cylinder = std::get_if<input::Cylinder>(&shape.kind);
  if (!capsule && !cylinder) return "";
  const double half_m =
      capsule ? capsule->length_m / 2 + capsule->radius_m : cylinder->length_m / 2;
  const Vector3d one = shape.in_body * Vector3d(0, 0, half_m),
                 other = shape.in_body * Vector3d(0, 0, -half_m);
  return ", such as its end, " + typed_pad(finger, one.norm() < other.norm() ? other : one);
}

/// @throws InputError for a flat pad on a round object, and for a line on a plane
void require_known(const exporting::FingerParts& finger, const RobotShape& shape,
                   const ShapePad& pad, const PadPlace& place, bool on_plane) {
  if (!(pad.is_flat() && !on_plane) && !(pad.is_line() && on_plane)) return;
  const std::string subject = "the pad of " + in_quotes(finger.name) + ", " + pad.part + " (" +
                              in_words(shape) + ") " + place.words;
  if (pad.is_flat())
    throw InputError(shape.element->where(), subject + ", is flat", "",
                     "no --object-radius-mm: a flat pad is known on a plane; or a curved part, by "
                     "--pad");
  throw InputError(shape.element->where(),
                   subject + ", touches a plane along a line, not in an ellipse", "",
                   "another part by --pad" + end_in_words(finger.name, shape) +
                       "; a round object by --object-radius-mm, or a CASE with the pad's radii");
}

/// `{ pad_mm = [22, 37.5] }`
std::string pad_toml(const input::FlatFigure& figure) {
  if (const auto* rectangle = std::get_if<input::RectangleFigure>(&figure))
    return fmt::format("{{ pad_mm = [{}, {}] }}", 1e3 * rectangle->length_m,
                       1e3 * rectangle->width_m);
  if (const auto* disc = std::get_if<input::DiscFigure>(&figure))
    return fmt::format("{{ pad_diameter_mm = {} }}", 1e3 * disc->diameter_m);
  std::string points;
  for (const Eigen::Vector2d& point : std::get<input::OutlineFigure>(figure).points_m)
    points +=
        fmt::format("{}[{}, {}]", points.empty() ? "" : ", ", 1e3 * point.x(), 1e3 * point.y());
  return "{ pad_outline_mm = [" + points + "] }";
}

std::string toml_number(double value) {
  return std::isinf(value) ? "inf" : fmt::format("{}", value);
}

constexpr const char* kMeshName = "NAME.stl";

/// A mesh that is touched where the body says: a direction is that of its farthest vertex.
std::string mesh_bodies(const TriangleSurface& surface, const input::MeshBody& body,
                        const std::string& object) {
  Vector3d point_m = body.near_m.value_or(Vector3d::Zero());
  std::string normal;
  if (body.along) {
    point_m = *std::max_element(surface.vertices_m.begin(), surface.vertices_m.end(),
                                [&](const Vector3d& one, const Vector3d& other) {
                                  return body.along->dot(one) < body.along->dot(other);
                                });
    normal =
        fmt::format(", normal = [{}, {}, {}]", body.along->x(), body.along->y(), body.along->z());
  }
  return fmt::format(
      "finger = {{ mesh = \"{}\", unit = \"m\", near_mm = [{}, {}, {}]{} }}\nobject = {{ {} }}\n",
      kMeshName, 1e3 * point_m.x(), 1e3 * point_m.y(), 1e3 * point_m.z(), normal, object);
}

}  // namespace

void add_shape_choice(CLI::App& command, ShapeChoice& choice) {
  const char* const group = "The finger's geometry from MODEL, in place of a case";
  command
      .add_option(
          "--layer", choice.layer,
          "THICKNESS_mm,E_kPa,NU of the soft layer: the radii are those of the finger's own "
          "shape in MODEL")
      ->group(group);
  command
      .add_option(
          "--pad", choice.pads,
          "[FINGER:]+z, -x, .. or [FINGER:]X,Y,Z in mm, in the axes of the finger's body or "
          "link: where it touches; default: guessed, the side to which its joint closes or "
          "that faces the other fingers; may be repeated")
      ->allow_extra_args(false)
      ->group(group);
  command
      .add_option("--object-radius-mm", choice.object_radius_mm,
                  "radius of a round object in mm, > 0; default: a plane")
      ->group(group);
  command
      .add_option(
          "--write-cases", choice.cases,
          "folder, made when missing: a case file of each finger's own shape, a mesh beside "
          "it, for predict, fem, compare, explore and the other commands")
      ->group(group);
  command
      .add_option("--package-path", choice.package_paths,
                  "folder with the packages of MODEL's meshes, repeatable: package://NAME/.. is "
                  "looked for there, then above the file")
      ->allow_extra_args(false)
      ->group(group);
}

RobotMeshes::RobotMeshes(fs::path model, exporting::RobotFormat format, const RobotShapes& shapes,
                         std::vector<std::string> package_paths)
    : model_(std::move(model)),
      format_(format),
      mesh_folder_(shapes.mesh_folder),
      strips_paths_(shapes.strips_paths),
      package_paths_(std::move(package_paths)) {
  for (const std::string& folder : package_paths_) {
    std::error_code error;
    if (!fs::is_directory(folder, error))
      throw InputError("command line", "--package-path", "\"" + folder + "\"", "a folder");
  }
}

fs::path RobotMeshes::find(const NamedMesh& named) const {
  const std::string where = named.named_by->where();
  if (format_ != exporting::RobotFormat::mjcf)
    return robots::PackagePaths(model_.empty() ? fs::path("model") : model_, package_paths_)
        .find(named.file, where);
  const fs::path file = strips_paths_ ? fs::path(named.file).filename() : fs::path(named.file);
  const fs::path path = (model_.parent_path() / mesh_folder_ / file).lexically_normal();
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    throw InputError(where, "file", in_quotes(named.file),
                     "a mesh that is there: " + text::shortened(path.string(), 200) + " is not");
  return path;
}

const RobotMeshes::Mesh& RobotMeshes::read(const NamedMesh& named) {
  const fs::path path = find(named);
  const bool is_converted = meshes::is_converted_mesh(path.string());
  if (is_converted && format_ == exporting::RobotFormat::mjcf)
    throw InputError(named.named_by->where(), "file", in_quotes(named.file),
                     "STL or OBJ: MuJoCo reads no other meshes");
  const Vector3d& scale = named.scale;
  const std::string key =
      fmt::format("{} {} {} {}", path.string(), scale.x(), scale.y(), scale.z());
  std::unique_ptr<Mesh>& mesh = meshes_[key];
  if (mesh) return *mesh;
  auto made = std::make_unique<Mesh>();
  made->surface = robots::read_mesh(
      path, scale, [](const std::string& file) { return input::converted_mesh(file, ""); });
  const bool is_uniform = scale.x() > 0 && scale.x() == scale.y() && scale.y() == scale.z();
  made->path = path;
  made->metres_per_unit = scale.x();
  if (!is_uniform || is_converted) {
    if (!copies_) copies_ = std::make_unique<TemporaryFolder>();
    made->path = copies_->path() / fmt::format("scaled_{}.stl", meshes_.size());
    made->metres_per_unit = 1;
    const std::string stl = robots::robot_stl(made->surface);
    meshes::write_whole_file(made->path.string(), [&](std::ostream& out) { out << stl; });
  }
  mesh = std::move(made);
  return *mesh;
}

Vector3d RobotMeshes::size_m(const NamedMesh& named) { return box_of(read(named).surface).sizes(); }

std::vector<std::unique_ptr<ShapedFinger>> shaped_fingers(
    const RobotShapes& shapes, const std::vector<exporting::FingerParts>& fingers,
    const ShapeChoice& typed, const ContactChoice& choice, RobotMeshes& meshes) {
  const CaseInput numbers = numbers_of_case(typed, choice);
  input::Settings settings = settings_of(numbers);
  settings.erase(std::remove_if(settings.begin(), settings.end(),
                                [](const input::Setting& setting) {
                                  return setting.key == "geometry.relative_radii_mm";
                                }),
                 settings.end());
  std::string object = "radii_mm = [inf, inf]";
  const bool on_plane = typed.object_radius_mm.empty();
  if (!on_plane) {
    const double radius_mm =
        number_of("--object-radius-mm", typed.object_radius_mm, "a number > 0, in mm");
    if (!(radius_mm > 0))
      throw InputError("command line", "--object-radius-mm", typed.object_radius_mm,
                       "a number > 0, in mm");
    object = "sphere_radius_mm = " + fmt::format("{}", radius_mm);
  }
  const auto pads = read_pads(typed.pads, fingers);
  Fingers geometry(shapes, fingers, meshes);
  std::map<std::string, input::Case> cases;  // of fingers that are alike
  std::vector<std::unique_ptr<ShapedFinger>> result;
  for (const exporting::FingerParts& finger : fingers) {
    const auto usable = geometry.usable(finger);
    auto place = pads.find(finger.name);
    if (place == pads.end()) place = pads.find("");
    const PadPlace chosen = place == pads.end() ? geometry.guessed(finger, usable) : place->second;
    const auto found = geometry.find(finger, usable, chosen);
    const RobotShape& shape = *found.shape;
    if (found.pad) require_known(finger, shape, *found.pad, chosen, on_plane);
    auto shaped = std::make_unique<ShapedFinger>();
    shaped->name = finger.name;
    shaped->shape = shape;
    shaped->shape_words = in_words(shape);
    shaped->pad_words = chosen.words;
    shaped->is_guessed = chosen.is_guessed;
    shaped->point_in_body_m = found.point_in_body_m;
    shaped->pad = found.pad;
    const bool has_friction = !numbers.friction.empty();
    const auto read_case = [&](const std::string& bodies) {
      const std::string text = "id = \"finger\"\n[geometry]\n" + bodies +
                               (has_friction ? "" : "[contact]\nfriction_coefficient = 1\n");
      auto known = cases.find(text);
      if (known == cases.end())
        known = cases
                    .emplace(text, input::parse_case(text, "command line", settings,
                                                     input::FlatPads::taken))
                    .first;
      input::Case made = known->second;
      made.id = input::id_of(finger.name);
      if (made.id.empty()) made.id = "finger";
      made.geometry_where = shape.element->where() + ": " + finger.name;
      return made;
    };
    if (on_plane) shaped->flat = geometry.flat_end(found, chosen);
    const bool is_joined = shaped->flat && shaped->flat->is_joined;
    shaped->flush = is_joined ? 0 : found.flush.size();
    if (is_joined) {
      shaped->shape_words += fmt::format(" and {} beside it", found.flush.size());
      shaped->point_in_body_m = shape.in_body * shaped->flat->in_shape.translation();
    }
    if (shaped->flat) {
      shaped->pad_bodies =
          "finger = " + pad_toml(shaped->flat->figure) + "\nobject = { flat = true }\n";
      shaped->pad_case = read_case(shaped->pad_bodies);
    }
    if (shaped->is_surely_flat()) {
      result.push_back(std::move(shaped));
      continue;
    }
    const ShapePad pad = found.pad.value_or(ShapePad());
    const double long_mm = found.pad ? 1e3 * pad.major_radius_m : 10,
                 short_mm = found.pad ? 1e3 * pad.minor_radius_m : 10;
    shaped->bodies = fmt::format("finger = {{ radii_mm = [{}, {}] }}\nobject = {{ {} }}\n",
                                 toml_number(long_mm), toml_number(short_mm), object);
    input::Case made = read_case(shaped->bodies);
    if (const auto* named = std::get_if<NamedMesh>(&shape.kind)) {
      const RobotMeshes::Mesh& mesh = meshes.read(*named);
      const Isometry3d to_shape = shape.in_body.inverse();
      input::MeshBody body;
      body.path = mesh.path;
      body.typed = named->file;
      body.where = named->named_by->where();
      body.metres_per_unit = mesh.metres_per_unit;
      if (chosen.direction)
        body.along = Vector3d((to_shape.linear() * *chosen.direction).normalized());
      else
        body.near_m = to_shape * *chosen.point_m;
      shaped->bodies = mesh_bodies(mesh.surface, body, object);
      if (!typed.cases.empty()) shaped->stl = robots::robot_stl(mesh.surface);
      std::get<input::BodyPair>(made.geometry).finger = body;
    }
    shaped->contact_case = std::move(made);
    result.push_back(std::move(shaped));
  }
  return result;
}

std::string case_text(const ShapedFinger& finger, bool is_flat, const std::string& name) {
  const input::Case& made = is_flat ? finger.pad_case : finger.contact_case;
  std::string bodies = is_flat ? finger.pad_bodies : finger.bodies;
  if (const std::size_t at = bodies.find(kMeshName); at != std::string::npos)
    bodies.replace(at, std::string(kMeshName).size(), name + ".stl");
  std::string loads;
  for (const double load_N : made.loads_N)
    loads += fmt::format("{}{}", loads.empty() ? "" : ", ", load_N);
  std::string text = fmt::format(
      "# {}, pad {}: made by softfinger apply\n"
      "id = \"{}\"\n[geometry]\n{}[layer]\nthickness_mm = {}\nyoungs_modulus_kPa = {}\n"
      "poisson_ratio = {}\n[contact]\nload_N = [{}]\n",
      finger.shape_words, finger.pad_words, made.id, bodies, 1e3 * made.layer.thickness_m,
      1e-3 * made.layer.youngs_modulus_Pa, made.layer.poisson_ratio, loads);
  if (made.shear_law.has_friction_coefficient())
    text += fmt::format("friction_coefficient = {}\n", made.shear_law.friction_coefficient);
  if (made.shear_law.has_shear_strength())
    text += fmt::format("shear_law = \"{}\"\nshear_strength_kPa = {}\n", made.shear_law.name(),
                        1e-3 * made.shear_law.shear_strength_Pa);
  return text;
}

std::string as_pad(const ShapedFinger& finger, std::string advice) {
  const std::string radii = "finger = { radii_mm = [9, 7] }";
  if (const std::size_t at = advice.find(radii); at != std::string::npos)
    advice.replace(at, radii.size(), "--radii-mm 9,7");
  const std::string start = "finger = {", place = "near_mm = [";
  const std::size_t begin = advice.find(start);
  if (begin == std::string::npos) return advice;
  const std::size_t numbers = advice.find(place, begin), end = advice.find('}', begin);
  if (numbers == std::string::npos || end == std::string::npos || numbers > end) return advice;
  const std::size_t first = numbers + place.size(), close = advice.find(']', first);
  if (close == std::string::npos || close > end) return advice;
  const auto point_mm = text::read_numbers(advice.substr(first, close - first));
  if (!point_mm || point_mm->size() != 3) return advice;
  const Vector3d point_m = 1e-3 * Vector3d((*point_mm)[0], (*point_mm)[1], (*point_mm)[2]);
  return advice.substr(0, begin) + typed_pad(finger.name, finger.shape.in_body * point_m) +
         advice.substr(end + 1);
}

exporting::ContactCurve ask_contact_curve(const ShapedFinger& finger, const ContactChoice& choice) {
  try {
    exporting::ContactCurve curve = ask_contact_curve(finger.contact_case, choice);
    curve.advice = as_pad(finger, curve.advice);
    return curve;
  } catch (const InputError& error) {
    throw InputError(error.where(), error.field(), error.value(), as_pad(finger, error.allowed()));
  }
}

std::string flat_pad_in_words(const RobotShapes& shapes, const exporting::FingerParts& parts,
                              const ShapedFinger& finger, const ShapeChoice& typed,
                              const ContactChoice& choice, RobotMeshes& meshes) {
  const auto* named = std::get_if<NamedMesh>(&finger.shape.kind);
  if (!named || !typed.object_radius_mm.empty()) return "";
  constexpr std::size_t kMostFaces = 6;
  std::size_t count = 0;
  for (const prediction::FlatFace& face : prediction::flat_faces(meshes.read(*named).surface)) {
    if (!face.is_outermost) continue;  // a plane does not reach it
    if (++count > kMostFaces) break;
    const std::string pad = typed_pad(finger.name, finger.shape.in_body * face.middle_m);
    ShapeChoice tried = typed;
    tried.pads = {pad.substr(pad.find(' ') + 1)};
    try {
      const auto found = shaped_fingers(shapes, {parts}, tried, choice, meshes);
      const std::optional<exporting::FlatEnd>& flat = found.front()->flat;
      if (!flat) continue;
      const input::Case& pad_case = found.front()->pad_case;
      const double load_N = loads_of(pad_case, choice).nominal_N;
      if (exporting::ask_pad_contact(pad_case, load_N, choice.demand.demand()).answer.usable)
        return fmt::format("or a flat side, {:.3g} x {:.3g} mm: {}", 1e3 * face.width_m,
                           1e3 * face.length_m, pad);
    } catch (const InputError&) {
    }
  }
  return "";
}

void require_on_one_part(const ShapedFinger& finger, const exporting::ContactCurve& curve) {
  if (!finger.pad) return;
  const double half_m = std::max(curve.nominal.a_m, curve.nominal.b_m);
  if (!(half_m > finger.pad->to_seam_m)) return;
  throw InputError(
      finger.shape.element->where(),
      fmt::format("the contact of \"{}\", {:.3g} mm long, reaches beyond {} ({}), {:.3g} mm from "
                  "its middle",
                  text::shortened(finger.name), 2e3 * half_m, finger.pad->part, finger.shape_words,
                  1e3 * finger.pad->to_seam_m),
      "",
      "a pad farther from there" + end_in_words(finger.name, finger.shape) +
          "; a smaller load, or a CASE with the pad's radii");
}

}  // namespace softfinger::commands
