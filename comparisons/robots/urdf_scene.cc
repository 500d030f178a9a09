#include "comparisons/robots/urdf_scene.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "comparisons/robots/foreign_mesh.h"
#include "comparisons/robots/mesh_file.h"
#include "comparisons/robots/package_paths.h"
#include "comparisons/robots/urdf_file.h"
#include "softfinger/dynamics/bodies/mass_properties.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The density of links of which the file does not say what they weigh: that of water, as MuJoCo
/// has it.
constexpr double kDensity_kg_per_m3 = 1000;

Vector3d vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Isometry3d pose(const urdf::Pose& at) {
  Isometry3d result = Isometry3d::Identity();
  result.translation() = vector(at.position);
  const urdf::Rotation& turn = at.rotation;
  result.linear() =
      Eigen::Quaterniond(turn.w, turn.x, turn.y, turn.z).normalized().toRotationMatrix();
  return result;
}

/// Keeps what urdfdom says of the file's first fault.
class FirstFault : public console_bridge::OutputHandler {
 public:
  FirstFault() { console_bridge::useOutputHandler(this); }
  ~FirstFault() override { console_bridge::restorePreviousOutputHandler(); }
  FirstFault(const FirstFault&) = delete;
  FirstFault& operator=(const FirstFault&) = delete;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR || !text_.empty()) return;
    text_ = text;
    std::replace(text_.begin(), text_.end(), '\n', ' ');
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Mass, first moment and inertia about a body's origin: those of parts add up.
struct MassSum {
  double mass_kg = 0;
  Vector3d moment_kg_m = Vector3d::Zero();
  Matrix3d about_origin_kg_m2 = Matrix3d::Zero();

  void add(const MassProperties& part, const Isometry3d& at) {
    const Vector3d arm = at * part.center_m;
    mass_kg += part.mass_kg;
    moment_kg_m += part.mass_kg * arm;
    about_origin_kg_m2 +=
        at.linear() * part.inertia_kg_m2 * at.linear().transpose() + part.mass_kg * spread(arm);
  }
  MassProperties properties() const {
    const Vector3d center = moment_kg_m / mass_kg;
    return {mass_kg, center, about_origin_kg_m2 - mass_kg * spread(center)};
  }
  static Matrix3d spread(const Vector3d& arm) {
    return arm.squaredNorm() * Matrix3d::Identity() - arm * arm.transpose();
  }
};

class UrdfImporter {
 public:
  UrdfImporter(const std::filesystem::path& file, const std::filesystem::path& meshes,
               std::string id, const std::vector<FingerLayer>& layers,
               const std::vector<std::string>& package_paths)
      : file_(file),
        id_(std::move(id)),
        layers_(layers),
        paths_(file, package_paths),
        meshes_(meshes, id_, [](const std::string& mesh) { return convert_mesh(mesh, ""); }) {}

  ImportedScene run() {
    urdf_ = read_urdf(file_);
    result_.notes = urdf_.notes;
    FirstFault fault;
    model_ = urdf::parseURDF(urdf_.text);
    if (!model_ || !model_->getRoot())
      throw InputError(file_.string(), "urdfdom cannot read it: " + fault.text(), "", "");
    order_links();
    for (const urdf::Link* link : order_) describe_link(*link);
    // The loop goes from the tips inwards, because a link carries the mass of those that hang on
    // it.
    for (auto link = order_.rbegin(); link != order_.rend(); ++link) {
      LinkParts& own = links_[*link];
      const bool is_moved =
          (*link)->parent_joint && (*link)->parent_joint->type != urdf::Joint::FIXED;
      // A frame that a joint moves, with nothing on it but its shapes, weighs what they do.
      if (is_moved && !own.carries_mass && !own.shapes.empty()) own.is_frame = false;
      own.carries_mass |= own.weighs();
      if (const auto parent = (*link)->getParent())
        links_[parent.get()].carries_mass |= own.carries_mass;
    }
    result_.text = fmt::format(
        "# From {} by softfinger simulate.\n"
        "id = {}\n\n[simulation]\ntime_step_ms = 1\nduration_s = 1\n\n",
        file_.filename().string(), in_quotes(id_));
    std::vector<std::string> names;
    for (const urdf::Link* link : order_) names.push_back(body_name(link->name));
    result_.text += layer_tables(layers_, names);
    for (const urdf::Link* link : order_) place_link(*link);
    if (bodies_.size() > kMostBodies)
      throw InputError(file_.string(), "bodies", std::to_string(bodies_.size()),
                       fmt::format("at most {}", kMostBodies));
    for (std::size_t b = 0; b < bodies_.size(); ++b) write_body(b);
    result_.text += massless_ + joints_ + motors_;
    add_contacts();
    note_the_rest();
    return std::move(result_);
  }

 private:
  template <class... Arguments>
  void note(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    result_.notes.push_back(fmt::format(text, std::forward<Arguments>(arguments)...));
  }

  struct PlacedShape {
    std::string text;  ///< of the scene, without its place
    Isometry3d at = Isometry3d::Identity();
    MassProperties unit_mass;
    double volume_m3 = 0;
  };
  struct LinkParts {
    std::vector<PlacedShape> shapes;
    std::optional<MassProperties> mass;  ///< in the link's frame
    bool is_frame = false;               ///< the file says that it weighs nothing
    bool carries_mass = false;           ///< it or a link that hangs on it
    std::size_t body = 0;
    Isometry3d in_body = Isometry3d::Identity(), in_world = Isometry3d::Identity();

    bool weighs() const { return mass || (!is_frame && !shapes.empty()); }
  };
  struct Body {
    std::string name;
    bool is_fixed = false;
    int carrier = -1;  ///< the body that carries it, by a joint; -1: none
    Isometry3d in_world = Isometry3d::Identity();
    std::vector<const urdf::Link*> links;
  };

  std::string at_link(const std::string& name) const {
    const auto line = urdf_.line_of_link.find(name);
    return fmt::format("{}:{}: link {}", file_.string(),
                       line == urdf_.line_of_link.end() ? 1 : line->second, in_quotes(name));
  }
  std::string at_joint(const std::string& name) const {
    const auto line = urdf_.line_of_joint.find(name);
    return fmt::format("{}:{}: joint {}", file_.string(),
                       line == urdf_.line_of_joint.end() ? 1 : line->second, in_quotes(name));
  }
  std::string body_name(std::string name) const {
    if (!is_name(name))
      throw InputError(at_link(name.substr(0, kLongestName)), "name", "",
                       fmt::format("1 to {} bytes without control characters", kLongestName));
    // A scene means any name that begins so.
    if (name.back() == '*') name.back() = '_';
    return name == "world" ? name + "_" : name;
  }
  std::string joint_name(const std::string& name) const {
    if (!is_name(name))
      throw InputError(at_joint(name.substr(0, kLongestName)), "name", "",
                       fmt::format("1 to {} bytes without control characters", kLongestName));
    return name;
  }

  /// Parents before children, without recursion: a chain may be long.
  void order_links() {
    std::vector<const urdf::Link*> open = {model_->getRoot().get()};
    while (!open.empty()) {
      order_.push_back(open.back());
      open.pop_back();
      const auto& own = order_.back()->child_links;
      for (auto child = own.rbegin(); child != own.rend(); ++child) open.push_back(child->get());
    }
    if (order_.size() < model_->links_.size())
      for (const auto& [name, link] : model_->links_)
        if (std::find(order_.begin(), order_.end(), link.get()) == order_.end())
          throw InputError(at_link(name), "place", "",
                           "a link that hangs on the root link " +
                               in_quotes(model_->getRoot()->name) + " by joints");
  }

  void describe_link(const urdf::Link& link) {
    LinkParts& parts = links_[&link];
    for (std::size_t i = 0; i < link.collision_array.size(); ++i)
      if (const auto& collision = link.collision_array[i]; collision && collision->geometry)
        add_shape(link, *collision->geometry, pose(collision->origin),
                  urdf_.capsules.count({link.name, int(i)}) > 0, parts);
    if (link.collision_array.empty() && !link.visual_array.empty()) take_visuals(link, parts);
    describe_mass(link, parts);
  }

  void take_visuals(const urdf::Link& link, LinkParts& parts) {
    for (std::size_t i = 0; i < link.visual_array.size(); ++i) {
      const auto& visual = link.visual_array[i];
      if (!visual || !visual->geometry) continue;
      const auto* mesh = dynamic_cast<const urdf::Mesh*>(visual->geometry.get());
      const auto note_unread = [&, link_name = link.name](const std::string& why) {
        note("link {} has no collision, and its visual mesh {} is not read{}: it touches nothing",
             in_quotes(link_name), in_quotes(mesh->filename), why);
      };
      if (mesh && !is_known_mesh(mesh->filename)) {
        note_unread("");
        continue;
      }
      try {
        add_shape(link, *visual->geometry, pose(visual->origin),
                  urdf_.capsules.count({link.name, UrdfFile::kVisual + int(i)}) > 0, parts);
      } catch (const InputError& error) {
        // A picture need not be a surface: a robot is worth simulating without it.
        if (!mesh || !meshes::is_converted_mesh(mesh->filename)) throw;
        note_unread(fmt::format(" ({})", error.what()));
      }
    }
    if (!parts.shapes.empty())
      note("link {} has no collision: its visual shapes stand in", in_quotes(link.name));
  }

  void add_shape(const urdf::Link& link, const urdf::Geometry& geometry, const Isometry3d& at,
                 bool is_capsule, LinkParts& parts) {
    PlacedShape shape;
    shape.at = at;
    bool is_empty = false;
    if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) {
      is_empty = !(sphere->radius > 0);
      shape.text = fmt::format("sphere_radius_mm = {}", sphere->radius / kMillimetre);
      shape.unit_mass = unit_mass_of_ellipsoid(Vector3d::Constant(sphere->radius));
      shape.volume_m3 = 4 * kPi / 3 * std::pow(sphere->radius, 3);
    } else if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) {
      const Vector3d size = vector(box->dim);
      is_empty = !(size.minCoeff() > 0);
      shape.text = "box_size_mm = " + list(size / kMillimetre);
      shape.unit_mass = unit_mass_of_box(size);
      shape.volume_m3 = size.prod();
    } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
      is_empty = !(cylinder->radius > 0) || !(cylinder->length > 0);
      const double r = cylinder->radius, length = cylinder->length;
      shape.text =
          fmt::format("{}_radius_length_mm = [{}, {}]", is_capsule ? "capsule" : "cylinder",
                      r / kMillimetre, length / kMillimetre);
      shape.unit_mass =
          is_capsule ? unit_mass_of_capsule(r, length) : unit_mass_of_cylinder(r, length);
      shape.volume_m3 = kPi * r * r * (length + (is_capsule ? 4 * r / 3 : 0));
    } else if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(&geometry)) {
      add_mesh(link, *mesh, shape);
    }
    if (is_empty)
      note("a shape of link {} has no size: it is left out", in_quotes(link.name));
    else
      parts.shapes.push_back(std::move(shape));
  }

  void add_mesh(const urdf::Link& link, const urdf::Mesh& mesh, PlacedShape& shape) {
    const auto line = urdf_.line_of_mesh.find(mesh.filename);
    const std::string where = line == urdf_.line_of_mesh.end()
                                  ? at_link(link.name)
                                  : fmt::format("{}:{}", file_.string(), line->second);
    const MeshFolder::Written& written =
        meshes_.add(paths_.find(mesh.filename, where), vector(mesh.scale));
    shape.text = fmt::format("mesh = {}, unit = \"m\"", in_quotes(written.name));
    try {
      shape.unit_mass = unit_mass_of_closed_surface(written.surface, where, &shape.volume_m3);
    } catch (const InputError&) {  // open; only of use where the file does not say what it weighs
      Eigen::AlignedBox3d box;
      for (const Vector3d& vertex : written.surface.vertices_m) box.extend(vertex);
      const Vector3d size = box.sizes().cwiseMax(1e-3 * box.sizes().maxCoeff());
      shape.unit_mass = unit_mass_of_box(size);
      shape.unit_mass.center_m = box.center();
      shape.volume_m3 = size.prod();
    }
  }

  /// The mass of the shapes together; where they overlap, it counts twice.
  static MassProperties mass_of(const std::vector<PlacedShape>& shapes) {
    MassSum sum;
    for (const PlacedShape& shape : shapes)
      sum.add(with_mass(shape.unit_mass, kDensity_kg_per_m3 * shape.volume_m3), shape.at);
    return sum.properties();
  }

  void describe_mass(const urdf::Link& link, LinkParts& parts) {
    if (!link.inertial) {
      // A frame may have a shape to be seen.
      parts.is_frame = link.collision_array.empty();
      return;
    }
    const urdf::Inertial& given = *link.inertial;
    if (!(given.mass >= 0))
      throw InputError(at_link(link.name), "mass", given.mass, "a number >= 0, in kg");
    if (given.mass == 0) {
      parts.is_frame = true;
      return;
    }
    Matrix3d inertia;
    inertia << given.ixx, given.ixy, given.ixz, given.ixy, given.iyy, given.iyz, given.ixz,
        given.iyz, given.izz;
    MassProperties mass;
    mass.mass_kg = given.mass;
    const Isometry3d at = pose(given.origin);
    mass.center_m = at.translation();
    mass.inertia_kg_m2 = at.linear() * possible(link, inertia, parts) * at.linear().transpose();
    parts.mass = mass;
  }

  /// The nearest inertia that a body can have: files have zeros, and moments of which one exceeds
  /// the sum of the others.
  Matrix3d possible(const urdf::Link& link, const Matrix3d& inertia, const LinkParts& parts) {
    const double mass_kg = link.inertial->mass;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(inertia);
    Vector3d moments = principal.eigenvalues();
    // Below that it is rounding of the largest.
    constexpr double kRounding = 1e-6;
    // A body of a micrometre is none: such moments are the rounding of zeros.
    constexpr double kLeast_m2 = 1e-12;
    if (!(moments[2] > kLeast_m2 * mass_kg) || moments[0] < -kRounding * moments[2]) {
      if (!parts.shapes.empty()) {
        note("the inertia of link {} is impossible: it has that of its shapes",
             in_quotes(link.name));
        const MassProperties of_shapes = mass_of(parts.shapes);
        return mass_kg / of_shapes.mass_kg * of_shapes.inertia_kg_m2;
      }
      note("the inertia of link {} is impossible: it has that of a ball of its mass at {} kg/m3",
           in_quotes(link.name), kDensity_kg_per_m3);
      const double radius_m = std::cbrt(mass_kg / kDensity_kg_per_m3 * 3 / (4 * kPi));
      return 0.4 * mass_kg * radius_m * radius_m * Matrix3d::Identity();
    }
    const double missing = moments[2] - moments[0] - moments[1];
    // Digits of a file.
    constexpr double kDigits = 1e-9;
    if (moments[0] > kDigits * moments[2] && missing <= kDigits * moments[2]) return inertia;
    const double least = 1e-3 * moments[2];
    moments[0] = std::max(moments[0], least);
    const double still = std::max(0., moments[2] - moments[0] - moments[1]);
    moments[0] += still / 2 * (1 + kDigits);
    moments[1] += still / 2 * (1 + kDigits);
    note(
        "the inertia of link {} is impossible, its largest moment exceeds the sum of the others: "
        "these are raised",
        in_quotes(link.name));
    return principal.eigenvectors() * moments.asDiagonal() * principal.eigenvectors().transpose();
  }

  bool has_layer(const urdf::Link& link) const {
    return std::any_of(layers_.begin(), layers_.end(), [&](const FingerLayer& layer) {
      return layer.body == body_name(link.name);
    });
  }

  /// Joint and place of a link; its parent has been placed.
  void place_link(const urdf::Link& link) {
    LinkParts& own = links_[&link];
    const auto parent_link = link.getParent();
    if (!parent_link) {
      own.body = add_body(link, -1);
      bodies_.back().is_fixed = true;
      return;
    }
    const urdf::Joint& joint = *link.parent_joint;
    const LinkParts& parent = links_[parent_link.get()];
    const Isometry3d origin = pose(joint.parent_to_joint_origin_transform);
    const bool is_loose = joint.type != urdf::Joint::FIXED && own.carries_mass;
    if (joint.type != urdf::Joint::FIXED && !own.carries_mass)
      note("joint {} moves nothing that weighs: it is fixed", in_quotes(joint.name));
    if (!is_loose && !has_layer(link)) {
      own.body = parent.body;
      own.in_body = parent.in_body * origin;
      own.in_world = parent.in_world * origin;
      bodies_[own.body].links.push_back(&link);
      return;
    }
    own.in_world = parent.in_world * origin;
    const std::size_t carrier = parent.body;
    if (!is_loose) {
      own.body = add_body(link, int(carrier));
      if (bodies_[carrier].is_fixed)
        bodies_[own.body].is_fixed = true;
      else
        fix(own.body, carrier);
      return;
    }
    add_joint(link, joint, carrier);
  }

  std::size_t add_body(const urdf::Link& link, int carrier) {
    Body body;
    body.name = body_name(link.name);
    body.carrier = carrier;
    body.in_world = links_[&link].in_world;
    body.links.push_back(&link);
    bodies_.push_back(body);
    return bodies_.size() - 1;
  }

  void fix(std::size_t child, std::size_t carrier) {
    joints_ += fmt::format("[[joint]]\nname = {}\nkind = \"fixed\"\nparent = {}\nchild = {}\n\n",
                           in_quotes("fixed_" + bodies_[child].name),
                           in_quotes(bodies_[carrier].name), in_quotes(bodies_[child].name));
  }

  /// Name of a joint's parent: fixed bodies are parts of the world.
  std::string parent_name(std::size_t carrier) const {
    return bodies_[carrier].is_fixed ? "world" : bodies_[carrier].name;
  }

  void add_joint(const urdf::Link& link, const urdf::Joint& joint, std::size_t carrier) {
    LinkParts& own = links_[&link];
    const std::string name = joint_name(joint.name);
    if (urdf_.ball_joints.count(joint.name) > 0) {
      own.body = add_body(link, int(carrier));
      joints_ += fmt::format(
          "[[joint]]\nname = {}\nkind = \"ball\"\nparent = {}\nchild = {}\nanchor_mm = {}\n\n",
          in_quotes(name), in_quotes(parent_name(carrier)), in_quotes(bodies_[own.body].name),
          list(own.in_world.translation() / kMillimetre));
      return;
    }
    if (joint.type == urdf::Joint::FLOATING) {
      own.body = add_body(link, -1);
      return;
    }
    const Vector3d in_joint = vector(joint.axis);
    if (!(in_joint.norm() > 0))
      throw InputError(at_joint(joint.name), "axis", list(in_joint), "a direction");
    const Vector3d axis = own.in_world.linear() * in_joint.normalized();
    if (joint.type == urdf::Joint::PLANAR) {
      own.body = add_planar(link, name, axis, carrier);
      return;
    }
    const bool turns = joint.type != urdf::Joint::PRISMATIC;
    const std::string leader = leader_of(joint);
    const double unit = turns ? kDegree : kMillimetre;
    const char* suffix = turns ? "deg" : "mm";
    double start = 0;
    std::string limits;
    if (joint.type != urdf::Joint::CONTINUOUS && joint.limits &&
        joint.limits->lower < joint.limits->upper) {
      const double wanted = leader.empty() ? 0 : start_of_follower(joint);
      start = std::clamp(wanted, joint.limits->lower, joint.limits->upper);
      if (start != wanted)
        note("joint {} starts at its limit, {:.6g}, not at {:.6g} beyond it", in_quotes(name),
             start, wanted);
      limits = fmt::format("limits_{} = [{}, {}]\n", suffix, joint.limits->lower / unit,
                           joint.limits->upper / unit);
    } else if (!leader.empty()) {
      start = start_of_follower(joint);
    }
    const Vector3d anchor = own.in_world.translation();
    if (turns)
      own.in_world.linear() = Eigen::AngleAxisd(start, axis) * own.in_world.linear();
    else
      own.in_world.translation() += start * axis;
    own.body = add_body(link, int(carrier));
    joints_ += fmt::format("[[joint]]\nname = {}\nkind = \"{}\"\nparent = {}\nchild = {}\n",
                           in_quotes(name), turns ? "revolute" : "prismatic",
                           in_quotes(parent_name(carrier)), in_quotes(bodies_[own.body].name));
    if (turns) joints_ += fmt::format("anchor_mm = {}\n", list(anchor / kMillimetre));
    joints_ +=
        fmt::format("axis = {}\nstart_{} = {}\n{}", list(axis), suffix, start / unit, limits);
    if (joint.dynamics && joint.dynamics->friction > 0)
      joints_ +=
          fmt::format("dry_friction_{} = {}\n", turns ? "Nm" : "N", joint.dynamics->friction);
    if (!leader.empty())
      joints_ +=
          fmt::format("follows = {}\nratio = {}\n", in_quotes(leader), joint.mimic->multiplier);
    joints_ += "\n";
    add_motor(joint, name, turns);
  }

  /// The joint that another one mimics, if that is one that moves by itself along an axis.
  std::string leader_of(const urdf::Joint& joint) {
    if (!joint.mimic) return "";
    const auto leader = model_->joints_.find(joint.mimic->joint_name);
    const auto is_simple = [&](const urdf::Joint& one) {
      return one.type == urdf::Joint::REVOLUTE || one.type == urdf::Joint::CONTINUOUS ||
             one.type == urdf::Joint::PRISMATIC;
    };
    if (leader == model_->joints_.end() || leader->second.get() == &joint)
      throw InputError(at_joint(joint.name), "mimic", in_quotes(joint.mimic->joint_name),
                       "another joint of the file");
    const auto child = model_->links_.find(leader->second->child_link_name);
    if (is_simple(*leader->second) && child != model_->links_.end() &&
        links_[child->second.get()].carries_mass)
      return leader->first;
    note("joint {} moves by itself: joint {}, which it mimics, does not turn or slide",
         in_quotes(joint.name), in_quotes(joint.mimic->joint_name));
    return "";
  }

  /// The start of a joint that mimics one which starts at 0, or at the limit next to it.
  double start_of_follower(const urdf::Joint& joint) const {
    const urdf::Joint& leader = *model_->joints_.at(joint.mimic->joint_name);
    double start = 0;
    if (leader.type != urdf::Joint::CONTINUOUS && leader.limits &&
        leader.limits->lower < leader.limits->upper)
      start = std::clamp(0., leader.limits->lower, leader.limits->upper);
    return joint.mimic->multiplier * start + joint.mimic->offset;
  }

  /// Two slides and a hinge, the first two on bodies without mass.
  std::size_t add_planar(const urdf::Link& link, const std::string& name, const Vector3d& normal,
                         std::size_t carrier) {
    const Vector3d along = normal.unitOrthogonal(), across = normal.cross(along);
    std::string parent = parent_name(carrier);
    for (const auto& [suffix, axis] : {std::pair("_x", along), std::pair("_y", across)}) {
      const std::string child = body_name(new_name(link.name + suffix));
      massless_ += fmt::format("[[body]]\nname = {}\nmassless = true\n{}\n", in_quotes(child),
                               placed_lines(links_[&link].in_world));
      joints_ += fmt::format(
          "[[joint]]\nname = {}\nkind = \"prismatic\"\nparent = {}\nchild = {}\naxis = {}\n\n",
          in_quotes(joint_name(name + suffix)), in_quotes(parent), in_quotes(child), list(axis));
      parent = child;
    }
    joints_ += fmt::format(
        "[[joint]]\nname = {}\nkind = \"revolute\"\nparent = {}\nchild = {}\nanchor_mm = {}\n"
        "axis = {}\n\n",
        in_quotes(name), in_quotes(parent), in_quotes(body_name(link.name)),
        list(links_[&link].in_world.translation() / kMillimetre), list(normal));
    return add_body(link, int(carrier));
  }

  /// A name that no link has.
  std::string new_name(std::string name) {
    while (urdf_.line_of_link.count(name) > 0 || !new_names_.insert(name).second) name += "_";
    return name;
  }

  void add_motor(const urdf::Joint& joint, const std::string& name, bool turns) {
    const double damping = joint.dynamics ? std::max(0., joint.dynamics->damping) : 0;
    const double effort = joint.limits ? joint.limits->effort : 0;
    if (joint.limits && joint.limits->velocity > 0) ++velocity_limits_;
    if (damping == 0 && !(effort > 0)) return;
    motors_ += fmt::format("[[motor]]\njoint = {}\n", in_quotes(name));
    if (damping > 0)
      motors_ += fmt::format("damping_{} = {}\n", turns ? "Nms_per_rad" : "Ns_per_m", damping);
    if (effort > 0) motors_ += fmt::format("max_effort_{} = {}\n", turns ? "Nm" : "N", effort);
    if (effort > 0 && damping > 0)
      note("the damping of joint {} shares its effort limit", in_quotes(name));
    motors_ += "\n";
  }

  void write_body(std::size_t b) {
    const Body& body = bodies_[b];
    std::string shapes;
    MassSum sum;
    std::vector<PlacedShape> all;
    for (const urdf::Link* link : body.links) {
      const LinkParts& parts = links_[link];
      for (const PlacedShape& shape : parts.shapes) {
        const Isometry3d at = parts.in_body * shape.at;
        const std::string place = placed(at);
        shapes += fmt::format("  {{ {}{}{} }},\n", shape.text, place.empty() ? "" : ", ", place);
        all.push_back(shape);
        all.back().at = at;
      }
      if (parts.mass) {
        sum.add(*parts.mass, parts.in_body);
      } else if (parts.weighs()) {
        sum.add(mass_of(parts.shapes), parts.in_body);
        if (!body.is_fixed) note_derived_mass(*link, mass_of(parts.shapes).mass_kg);
      }
    }
    // The frame of a body that moves, with shapes that the file says weigh nothing.
    if (sum.mass_kg == 0 && !all.empty() && !body.is_fixed) {
      sum.add(mass_of(all), Isometry3d::Identity());
      note_derived_mass(*body.links.front(), sum.mass_kg);
    }
    const std::string layer = layer_line(layers_, body.name);
    if (body.is_fixed && shapes.empty() && layer.empty()) return;
    result_.text +=
        fmt::format("[[body]]\nname = {}\n{}", in_quotes(body.name), placed_lines(body.in_world));
    if (body.is_fixed) {
      result_.text += "fixed = true\n";
    } else if (sum.mass_kg > 0) {
      const MassProperties mass = sum.properties();
      require_physical(mass, at_link(body.links.front()->name));
      Isometry3d center = Isometry3d::Identity();
      center.translation() = mass.center_m;
      result_.text += mass_lines(mass.mass_kg, center, mass.inertia_kg_m2);
    } else {
      result_.text += "massless = true\n";
    }
    result_.text += layer;
    result_.text += shapes.empty() ? "\n" : "shapes = [\n" + shapes + "]\n\n";
    if (!shapes.empty()) with_shapes_.push_back(b);
  }

  void note_derived_mass(const urdf::Link& link, double mass_kg) {
    note("link {} has no mass in the file: its shapes weigh {:.3g} kg at {} kg/m3",
         in_quotes(link.name), mass_kg, kDensity_kg_per_m3);
  }

  /// Writes the rules of contact. The smaller friction of two links counts: in a scene the later
  /// rule does.
  void add_contacts() {
    if (with_shapes_.size() < 2 && urdf_.friction_of_link.empty()) return;
    std::vector<std::pair<double, std::string>> frictions;
    for (const std::size_t b : with_shapes_) {
      double friction = 1;
      for (const urdf::Link* link : bodies_[b].links) {
        const auto found = urdf_.friction_of_link.find(link->name);
        if (found != urdf_.friction_of_link.end()) friction = std::min(friction, found->second);
      }
      if (friction != 1) frictions.emplace_back(friction, bodies_[b].name);
    }
    std::sort(frictions.rbegin(), frictions.rend());
    result_.text += "[[contact]]\nbodies = [\"*\", \"*\"]\nfriction_coefficient = 1\n\n";
    for (const auto& [friction, name] : frictions)
      result_.text +=
          fmt::format("[[contact]]\nbodies = [{}, \"*\"]\nfriction_coefficient = {}\n\n",
                      in_quotes(name), friction);
    for (const std::size_t b : with_shapes_) {
      // The next body inwards that has shapes: those between are the axes of one joint.
      int carrier = bodies_[b].carrier;
      while (carrier >= 0 &&
             !std::binary_search(with_shapes_.begin(), with_shapes_.end(), std::size_t(carrier)))
        carrier = bodies_[std::size_t(carrier)].carrier;
      if (carrier < 0) continue;
      result_.text +=
          fmt::format("[[contact]]\nbodies = [{}, {}]\ncollide = false\n\n",
                      in_quotes(bodies_[std::size_t(carrier)].name), in_quotes(bodies_[b].name));
    }
  }

  void note_the_rest() {
    if (velocity_limits_ > 0) note("{} velocity limits are left out", velocity_limits_);
    note("the root link {} stands in the world", in_quotes(model_->getRoot()->name));
    if (!motors_.empty())
      note("motors are without effort until --control or an effort in the scene moves them");
    if (with_shapes_.size() > 1)
      note(
          "contacts are rigid points with Coulomb's friction, 1 where the file says nothing, or "
          "soft where --finger-layer says so; bodies that a joint connects do not collide");
  }

  const std::filesystem::path& file_;
  std::string id_;
  const std::vector<FingerLayer>& layers_;
  PackagePaths paths_;
  MeshFolder meshes_;
  UrdfFile urdf_;
  urdf::ModelInterfaceSharedPtr model_;
  ImportedScene result_;
  std::vector<const urdf::Link*> order_;
  std::map<const urdf::Link*, LinkParts> links_;
  std::vector<Body> bodies_;
  std::string massless_, joints_, motors_;
  std::set<std::string> new_names_;
  std::vector<std::size_t> with_shapes_;  ///< bodies, in rising order
  int velocity_limits_ = 0;
};

}  // namespace

ImportedScene import_urdf(const std::filesystem::path& file, const std::filesystem::path& meshes,
                          const std::string& id, const std::vector<FingerLayer>& layers,
                          const std::vector<std::string>& package_paths) {
  return UrdfImporter(file, meshes, id, layers, package_paths).run();
}

}  // namespace softfinger::robots
