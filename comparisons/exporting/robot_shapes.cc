#include "comparisons/exporting/robot_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <unordered_map>

#include "comparisons/text/nearest_name.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::exporting {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The finite numbers of a text.
/// @throws InputError for other words
std::vector<double> numbers_in(const XmlElement& element, const char* name,
                               const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.c_str();
  for (char* end = nullptr;; at = end) {
    const double value = std::strtod(at, &end);
    if (end == at) break;
    if (!std::isfinite(value)) break;
    numbers.push_back(value);
  }
  while (std::isspace(static_cast<unsigned char>(*at))) ++at;
  if (*at != '\0')
    throw InputError(element.where(), name, "\"" + text::shortened(text) + "\"", "finite numbers");
  return numbers;
}

std::optional<Vector3d> three(const std::vector<double>& numbers, std::size_t first = 0) {
  if (numbers.size() < first + 3) return std::nullopt;
  return Vector3d(numbers[first], numbers[first + 1], numbers[first + 2]);
}

Matrix3d from_roll_pitch_yaw(const Vector3d& angles_rad) {
  return (AngleAxisd(angles_rad.z(), Vector3d::UnitZ()) *
          AngleAxisd(angles_rad.y(), Vector3d::UnitY()) *
          AngleAxisd(angles_rad.x(), Vector3d::UnitX()))
      .toRotationMatrix();
}

const XmlElement* child_of(const XmlElement& element, const char* name) {
  for (const XmlElement* child : element.children)
    if (child->name == name) return child;
  return nullptr;
}

template <class Kind>
void set_kind(RobotShape& shape, const Kind& kind, bool is_positive) {
  if (is_positive)
    shape.kind = kind;
  else
    shape.unknown = "a shape of which a size is missing or not > 0";
}

class MjcfShapes {
 public:
  MjcfShapes(const XmlFile& file, const Mjcf& mjcf) : file_(file), mjcf_(mjcf) {}

  RobotShapes read() {
    for (const XmlElement* element : file_.elements()) {
      if (element->name == "compiler") read_compiler(*element);
      if (element->name == "mesh" && element->parent && element->parent->name == "asset")
        meshes_.emplace(name_of_mesh(*element), element);
    }
    for (const XmlElement* element : file_.elements()) {
      if (!element->parent || !is_in_world(*element)) continue;
      const std::string& kind = element->name;
      if (kind == "worldbody" || kind == "body")
        add_body(*element);
      else if (kind == "frame" || kind == "replicate")
        places_[element] = {pose(*element), body_around(*element)};
      else if (kind == "joint" || kind == "freejoint")
        add_joint(*element);
      else if (kind == "geom")
        add_geom(*element);
    }
    return std::move(result_);
  }

 private:
  /// A body or a frame: its pose in the body, and the body's index.
  struct Place {
    Isometry3d in_body = Isometry3d::Identity();
    std::size_t body = 0;
  };

  void read_compiler(const XmlElement& compiler) {
    const auto read = [&](const char* name, std::string& value) {
      if (compiler.attribute(name)) value = compiler.value(name);
    };
    std::string angle, coordinate, strips;
    read("angle", angle);
    read("coordinate", coordinate);
    read("strippath", strips);
    read("eulerseq", euler_sequence_);
    if (!angle.empty()) in_degrees_ = angle != "radian";
    if (!coordinate.empty()) is_global_ = coordinate == "global";
    if (!strips.empty()) result_.strips_paths = strips == "true";
    read("assetdir", result_.mesh_folder);
    read("meshdir", result_.mesh_folder);
  }

  static std::string name_of_mesh(const XmlElement& mesh) {
    const std::string name = mesh.value("name");
    return name.empty() ? std::filesystem::path(mesh.value("file")).stem().string() : name;
  }

  std::vector<double> numbers(const XmlElement& element, const char* name) const {
    const XmlElement* const source = mjcf_.source(element, name);
    if (!source) return {};
    return numbers_in(*source, name, source->value(name));
  }

  double radians(double angle) const { return in_degrees_ ? angle * kPi / 180 : angle; }

  Matrix3d orientation(const XmlElement& element) const {
    if (const auto q = numbers(element, "quat"); q.size() >= 4) {
      const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
      if (turn.norm() > 1e-12) return turn.normalized().toRotationMatrix();
    }
    if (const auto turn = numbers(element, "axisangle"); turn.size() >= 4)
      if (const Vector3d axis = *three(turn); axis.norm() > 1e-12)
        return AngleAxisd(radians(turn[3]), axis.normalized()).toRotationMatrix();
    if (const auto axes = numbers(element, "xyaxes"); axes.size() >= 6) {
      const Vector3d x = *three(axes), y = *three(axes, 3), z = x.cross(y);
      if (z.norm() > 1e-12) {
        Matrix3d turn;
        turn.col(0) = x.normalized();
        turn.col(2) = z.normalized();
        turn.col(1) = turn.col(2).cross(turn.col(0));
        return turn;
      }
    }
    if (const auto z = three(numbers(element, "zaxis")); z && z->norm() > 1e-12)
      return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), *z).toRotationMatrix();
    if (const auto angles = numbers(element, "euler"); angles.size() >= 3) {
      Matrix3d turn = Matrix3d::Identity();
      for (std::size_t i = 0; i < 3 && i < euler_sequence_.size(); ++i) {
        const char letter = euler_sequence_[i];
        const int axis = std::tolower(static_cast<unsigned char>(letter)) - 'x';
        if (axis < 0 || axis > 2) continue;
        const Matrix3d one =
            AngleAxisd(radians(angles[i]), Vector3d(Vector3d::Unit(axis))).toRotationMatrix();
        turn = letter >= 'a' ? Matrix3d(turn * one) : Matrix3d(one * turn);
      }
      return turn;
    }
    return Matrix3d::Identity();
  }

  Isometry3d pose(const XmlElement& element) const {
    Isometry3d at = Isometry3d::Identity();
    at.translation() = three(numbers(element, "pos")).value_or(Vector3d::Zero());
    at.linear() = orientation(element);
    const auto around = places_.find(element.parent);
    const bool is_in_frame =
        around != places_.end() && element.parent->name != "body" && element.name != "body";
    return is_in_frame ? around->second.in_body * at : at;
  }

  std::size_t body_around(const XmlElement& element) {
    const auto found = places_.find(element.parent);
    if (found != places_.end()) return found->second.body;
    // A file to be included may have bodies under its root: the world is then not in it.
    if (!has_world_) {
      has_world_ = true;
      world_ = result_.bodies.size();
      result_.bodies.push_back({&file_.root(), "", -1, Isometry3d::Identity(), true, {}});
    }
    return world_;
  }

  void add_body(const XmlElement& element) {
    if (element.name == "worldbody") {
      const std::size_t world = body_around(element);
      places_[&element] = {Isometry3d::Identity(), world};
      return;
    }
    const std::size_t parent = body_around(element);
    const auto around = places_.find(element.parent);
    const Isometry3d frame =
        around == places_.end() ? Isometry3d::Identity() : around->second.in_body;
    RobotBody body;
    body.element = &element;
    body.name = element.value("name");
    body.parent = int(parent);
    body.in_world = result_.bodies[parent].in_world * frame * pose(element);
    body.is_placed = !is_global_ && result_.bodies[parent].is_placed;
    places_[&element] = {Isometry3d::Identity(), result_.bodies.size()};
    result_.bodies.push_back(body);
  }

  void add_joint(const XmlElement& element) {
    const std::string type = mjcf_.value(element, "type");
    const bool is_hinge = type.empty() || type == "hinge";
    if (element.name == "freejoint" || (!is_hinge && type != "slide")) return;
    RobotJoint joint;
    joint.name = element.value("name");
    joint.is_hinge = is_hinge;
    if (const auto axis = three(numbers(element, "axis")); axis && axis->norm() > 1e-12)
      joint.axis = axis->normalized();
    joint.anchor_m = three(numbers(element, "pos")).value_or(Vector3d::Zero());
    if (const auto range = numbers(element, "range");
        range.size() >= 2 && mjcf_.value(element, "limited") != "false" && range[0] < range[1]) {
      joint.lower = is_hinge ? radians(range[0]) : range[0];
      joint.upper = is_hinge ? radians(range[1]) : range[1];
    }
    result_.bodies[body_around(element)].joints.push_back(joint);
  }

  void add_geom(const XmlElement& element) {
    RobotShape shape;
    shape.element = &element;
    shape.body = body_around(element);
    shape.in_body = pose(element);
    std::vector<double> size = numbers(element, "size");
    std::string type = mjcf_.value(element, "type");
    const std::string mesh = mjcf_.value(element, "mesh");
    if (type.empty()) type = mesh.empty() ? "sphere" : "mesh";
    if (const auto ends = numbers(element, "fromto"); ends.size() >= 6 && !size.empty()) {
      const Vector3d from = *three(ends), to = *three(ends, 3), along = from - to;
      Isometry3d at = Isometry3d::Identity();
      at.translation() = (from + to) / 2;
      if (along.norm() > 1e-12)
        at.linear() =
            Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), along).toRotationMatrix();
      const auto around = places_.find(element.parent);
      shape.in_body =
          (around == places_.end() ? Isometry3d::Identity() : around->second.in_body) * at;
      const double half = along.norm() / 2;
      size = type == "box" || type == "ellipsoid" ? std::vector<double>{size[0], size[0], half}
                                                  : std::vector<double>{size[0], half};
    }
    set_shape(shape, type, mesh, size);
    result_.shapes.push_back(std::move(shape));
  }

  void set_shape(RobotShape& shape, const std::string& type, const std::string& mesh,
                 const std::vector<double>& size) {
    const auto has = [&](std::size_t count) {
      return size.size() >= count && std::all_of(size.begin(), size.begin() + long(count),
                                                 [](double value) { return value > 0; });
    };
    const auto at = [&](std::size_t i) { return i < size.size() ? size[i] : 0.; };
    const Vector3d all(at(0), at(1), at(2));
    if (type == "mesh") {
      const auto found = meshes_.find(mesh);
      if (found == meshes_.end() || mjcf_.value(*found->second, "file").empty()) {
        shape.unknown = found == meshes_.end() ? "a mesh that the file does not have"
                                               : "a mesh whose vertices are in the file itself";
        return;
      }
      NamedMesh named;
      named.named_by = found->second;
      named.file = mjcf_.value(*found->second, "file");
      named.scale = three(numbers(*found->second, "scale")).value_or(Vector3d::Ones());
      // The vertices are relative to this pose.
      Isometry3d reference = Isometry3d::Identity();
      reference.translation() = three(numbers(*found->second, "refpos")).value_or(Vector3d::Zero());
      if (const auto q = numbers(*found->second, "refquat"); q.size() >= 4)
        if (const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]); turn.norm() > 1e-12)
          reference.linear() = turn.normalized().toRotationMatrix();
      shape.in_body = shape.in_body * reference.inverse();
      shape.kind = named;
    } else if (!mesh.empty()) {
      shape.unknown = "a " + text::shortened(type) + " that MuJoCo fits to a mesh";
    } else if (type == "sphere") {
      set_kind(shape, input::Sphere{at(0)}, has(1));
    } else if (type == "capsule") {
      set_kind(shape, input::Capsule{at(0), 2 * at(1)}, has(2));
    } else if (type == "cylinder") {
      set_kind(shape, input::Cylinder{at(0), 2 * at(1)}, has(2));
    } else if (type == "ellipsoid") {
      set_kind(shape, input::Ellipsoid{all}, has(3));
    } else if (type == "box") {
      set_kind(shape, input::Box{2 * all}, has(3));
    } else {
      shape.unknown = type == "plane"    ? "a plane"
                      : type == "hfield" ? "a height field"
                                         : "a shape of the type " + text::shortened(type);
    }
  }

  const XmlFile& file_;
  const Mjcf& mjcf_;
  RobotShapes result_;
  std::map<std::string, const XmlElement*> meshes_;
  std::unordered_map<const XmlElement*, Place> places_;
  std::string euler_sequence_ = "xyz";
  bool in_degrees_ = true, is_global_ = false, has_world_ = false;
  std::size_t world_ = 0;
};

/// The links and joints of URDF and SDF.
class LinkShapes {
 public:
  LinkShapes(const XmlFile& file, RobotFormat format)
      : file_(file), is_urdf_(format == RobotFormat::urdf) {}

  RobotShapes read() {
    for (const XmlElement* element : file_.elements()) {
      if (!element->parent) continue;
      if (element->name == "link" && is_scope(*element->parent)) add_link(*element);
      if (element->name == "joint" && is_scope(*element->parent)) joints_.push_back(element);
    }
    for (const XmlElement* joint : joints_) add_joint(*joint);
    place();
    for (const XmlElement* link : links_)
      for (const XmlElement* collision : link->children)
        if (collision->name == "collision") add_collision(*collision, new_index_[index_.at(link)]);
    return std::move(result_);
  }

 private:
  bool is_scope(const XmlElement& element) const {
    return element.name == (is_urdf_ ? "robot" : "model");
  }

  /// @param is_known  set to false where the pose is relative to something else
  Isometry3d pose(const XmlElement& element, bool* is_known = nullptr) const {
    Isometry3d at = Isometry3d::Identity();
    const XmlElement* const child = child_of(element, is_urdf_ ? "origin" : "pose");
    if (!child) return at;
    if (is_urdf_) {
      at.translation() =
          three(numbers_in(*child, "xyz", child->value("xyz"))).value_or(Vector3d::Zero());
      at.linear() = from_roll_pitch_yaw(
          three(numbers_in(*child, "rpy", child->value("rpy"))).value_or(Vector3d::Zero()));
      return at;
    }
    const std::vector<double> six = numbers_in(*child, "pose", child->text);
    const bool is_simple = child->value("relative_to").empty() && six.size() == 6 &&
                           child->value("rotation_format") != "quat_xyzw";
    if (!is_simple) {
      if (is_known && !six.empty()) *is_known = false;
      return at;
    }
    at.translation() = *three(six);
    at.linear() =
        from_roll_pitch_yaw(*three(six, 3) * (child->value("degrees") == "true" ? kPi / 180 : 1));
    return at;
  }

  void add_link(const XmlElement& element) {
    RobotBody body;
    body.element = &element;
    body.name = element.value("name");
    if (!is_urdf_) {
      body.in_world = pose(element, &body.is_placed);
      for (const XmlElement* model = element.parent; model && model->name == "model";
           model = model->parent)
        body.in_world = pose(*model, &body.is_placed) * body.in_world;
    }
    index_[&element] = links_.size();
    by_name_[{element.parent, body.name}] = links_.size();
    links_.push_back(&element);
    bodies_.push_back(body);
  }

  std::optional<std::size_t> link_of(const XmlElement& joint, const char* end) const {
    const XmlElement* const child = child_of(joint, end);
    if (!child) return std::nullopt;
    const auto found = by_name_.find({joint.parent, is_urdf_ ? child->value("link") : child->text});
    if (found == by_name_.end()) return std::nullopt;
    return found->second;
  }

  void add_joint(const XmlElement& element) {
    const auto parent = link_of(element, "parent"), child = link_of(element, "child");
    if (!child || !parent || bodies_[*child].parent >= 0) return;
    bodies_[*child].parent = int(*parent);
    if (is_urdf_) bodies_[*child].in_world = pose(element);  // in the parent, until placed
    const std::string type = element.value("type");
    const bool is_hinge = type == "revolute" || type == "continuous";
    if (!is_hinge && type != "prismatic") return;
    RobotJoint joint;
    joint.name = element.value("name");
    joint.is_hinge = is_hinge;
    const XmlElement* const axis = child_of(element, "axis");
    const XmlElement* limit = child_of(element, "limit");
    joint.axis = is_urdf_ ? Vector3d::UnitX() : Vector3d::UnitZ();
    if (is_urdf_) {
      if (axis)
        if (const auto typed = three(numbers_in(*axis, "xyz", axis->value("xyz")));
            typed && typed->norm() > 1e-12)
          joint.axis = typed->normalized();
    } else {
      const XmlElement* const xyz = axis ? child_of(*axis, "xyz") : nullptr;
      bool is_known = true;
      const Isometry3d at = pose(element, &is_known);
      if (!is_known || (xyz && !xyz->value("expressed_in").empty())) return;
      if (xyz)
        if (const auto typed = three(numbers_in(*xyz, "xyz", xyz->text));
            typed && typed->norm() > 1e-12)
          joint.axis = typed->normalized();
      joint.axis = at.linear() * joint.axis;
      joint.anchor_m = at.translation();
      limit = axis ? child_of(*axis, "limit") : nullptr;
    }
    const auto end = [&](const char* name, double& value) {
      if (!limit) return;
      const XmlElement* const leaf = child_of(*limit, name);
      const std::string text = is_urdf_ ? limit->value(name) : leaf ? leaf->text : "";
      // "inf" and the like mean no limit.
      char* rest = nullptr;
      const double typed = std::strtod(text.c_str(), &rest);
      if (rest != text.c_str() && std::isfinite(typed)) value = typed;
    };
    if (type != "continuous") {
      end("lower", joint.lower);
      end("upper", joint.upper);
    }
    bodies_[*child].joints.push_back(joint);
  }

  /// Parents before children, without recursion. Links that hang on each other in a ring have no
  /// place.
  void place() {
    std::vector<std::vector<std::size_t>> children(bodies_.size());
    std::vector<std::size_t> open;
    for (std::size_t i = bodies_.size(); i-- > 0;)
      if (bodies_[i].parent < 0) open.push_back(i);
    for (std::size_t i = bodies_.size(); i-- > 0;)
      if (bodies_[i].parent >= 0) children[std::size_t(bodies_[i].parent)].push_back(i);
    new_index_.assign(bodies_.size(), bodies_.size());
    const auto take = [&](std::size_t old) {
      new_index_[old] = result_.bodies.size();
      result_.bodies.push_back(bodies_[old]);
    };
    while (!open.empty()) {
      const std::size_t old = open.back();
      open.pop_back();
      take(old);
      RobotBody& body = result_.bodies.back();
      if (body.parent >= 0) {
        body.parent = int(new_index_[std::size_t(body.parent)]);
        const RobotBody& parent = result_.bodies[std::size_t(body.parent)];
        if (is_urdf_) body.in_world = parent.in_world * body.in_world;
        body.is_placed &= parent.is_placed;
      }
      open.insert(open.end(), children[old].begin(), children[old].end());
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (new_index_[i] < bodies_.size()) continue;
      take(i);
      result_.bodies.back().parent = -1;
      result_.bodies.back().is_placed = false;
    }
  }

  void add_collision(const XmlElement& element, std::size_t body) {
    RobotShape shape;
    shape.element = &element;
    shape.body = body;
    bool is_known = true;
    shape.in_body = pose(element, &is_known);
    const XmlElement* const geometry = child_of(element, "geometry");
    const XmlElement* const kind =
        geometry && !geometry->children.empty() ? geometry->children.front() : nullptr;
    if (!kind)
      shape.unknown = "a collision without a geometry";
    else if (!is_known)
      shape.unknown = "a shape that is placed relative to another frame";
    else
      set_shape(shape, *kind);
    result_.shapes.push_back(std::move(shape));
  }

  void set_shape(RobotShape& shape, const XmlElement& kind) const {
    const auto numbers = [&](const char* name) {
      const XmlElement* const leaf = child_of(kind, name);
      return numbers_in(kind, name, is_urdf_ || !leaf ? kind.value(name) : leaf->text);
    };
    const auto number = [&](const char* name) {
      const auto all = numbers(name);
      return all.empty() ? 0. : all[0];
    };
    const auto vector = [&](const char* name) {
      return three(numbers(name)).value_or(Vector3d::Zero());
    };
    std::string type = kind.name;
    if (type.rfind("drake:", 0) == 0) type = type.substr(6);
    if (type == "sphere") {
      set_kind(shape, input::Sphere{number("radius")}, number("radius") > 0);
    } else if (type == "box") {
      set_kind(shape, input::Box{vector("size")}, vector("size").minCoeff() > 0);
    } else if (type == "ellipsoid") {
      set_kind(shape, input::Ellipsoid{vector("radii")}, vector("radii").minCoeff() > 0);
    } else if (type == "cylinder" || type == "capsule") {
      const double radius_m = number("radius"), length_m = number("length");
      const bool is_positive = radius_m > 0 && length_m > 0;
      if (type == "capsule")
        set_kind(shape, input::Capsule{radius_m, length_m}, is_positive);
      else
        set_kind(shape, input::Cylinder{radius_m, length_m}, is_positive);
    } else if (type == "mesh") {
      NamedMesh mesh;
      mesh.named_by = &kind;
      const XmlElement* const uri = child_of(kind, "uri");
      mesh.file = is_urdf_ ? kind.value("filename") : uri ? uri->text : "";
      if (const auto scale = numbers("scale"); !scale.empty())
        mesh.scale = three(scale).value_or(Vector3d::Constant(scale[0]));
      if (mesh.file.empty())
        shape.unknown = "a mesh without a file";
      else
        shape.kind = mesh;
    } else {
      shape.unknown = "a shape of the kind " + text::shortened(type);
    }
  }

  const XmlFile& file_;
  bool is_urdf_;
  RobotShapes result_;
  std::vector<const XmlElement*> links_, joints_;
  std::vector<RobotBody> bodies_;
  std::vector<std::size_t> new_index_;
  std::unordered_map<const XmlElement*, std::size_t> index_;
  std::map<std::pair<const XmlElement*, std::string>, std::size_t> by_name_;
};

struct ShapeWords {
  const RobotShape& shape;

  static std::string sizes(const Vector3d& size_m) {
    return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", 1e3 * size_m.x(), 1e3 * size_m.y(),
                       1e3 * size_m.z());
  }
  static std::string rod(const char* kind, double radius_m, double length_m) {
    return fmt::format("a {} of radius {:.4g} mm and length {:.4g} mm", kind, 1e3 * radius_m,
                       1e3 * length_m);
  }
  std::string operator()(const std::monostate&) const { return shape.unknown; }
  std::string operator()(const input::Sphere& sphere) const {
    return fmt::format("a sphere of radius {:.4g} mm", 1e3 * sphere.radius_m);
  }
  std::string operator()(const input::Ellipsoid& ellipsoid) const {
    return "an ellipsoid of semi-axes " + sizes(ellipsoid.semi_axes_m);
  }
  std::string operator()(const input::Cylinder& cylinder) const {
    return rod("cylinder", cylinder.radius_m, cylinder.length_m);
  }
  std::string operator()(const input::Capsule& capsule) const {
    return rod("capsule", capsule.radius_m, capsule.length_m);
  }
  std::string operator()(const input::Box& box) const { return "a box of " + sizes(box.size_m); }
  std::string operator()(const NamedMesh& mesh) const {
    return "the mesh " + text::shortened(mesh.file);
  }
};

}  // namespace

RobotShapes read_shapes(const XmlFile& file, RobotFormat format, const Mjcf& mjcf) {
  return format == RobotFormat::mjcf ? MjcfShapes(file, mjcf).read()
                                     : LinkShapes(file, format).read();
}

std::string in_words(const RobotShape& shape) { return std::visit(ShapeWords{shape}, shape.kind); }

}  // namespace softfinger::exporting
