#include "comparisons/robots/sdf_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sdf/sdf.hh>
#include <set>

#include "meshes/io/mesh_formats.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d vector(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }

Isometry3d pose(const ignition::math::Pose3d& at) {
  Isometry3d result = Isometry3d::Identity();
  result.translation() = vector(at.Pos());
  result.linear() = Eigen::Quaterniond(at.Rot().W(), at.Rot().X(), at.Rot().Y(), at.Rot().Z())
                        .normalized()
                        .toRotationMatrix();
  return result;
}

class Importer {
 public:
  Importer(const std::filesystem::path& file, std::string id,
           const std::vector<FingerLayer>& layers)
      : file_(file), id_(std::move(id)), layers_(layers) {}

  ImportedScene run() {
    sdf::Console::Instance()->SetQuiet(true);
    sdf::Root root;
    require(root.Load(file_.string()));
    double time_step_s = 1e-3;
    Vector3d gravity(0, 0, -9.81);
    std::vector<const sdf::Model*> models;
    if (root.WorldCount() > 0) {
      const sdf::World& world = *root.WorldByIndex(0);
      if (root.WorldCount() > 1) note("worlds but the first are left out");
      gravity = vector(world.Gravity());
      if (world.PhysicsCount() > 0) time_step_s = world.PhysicsByIndex(0)->MaxStepSize();
      for (std::uint64_t i = 0; i < world.ModelCount(); ++i)
        models.push_back(world.ModelByIndex(i));
    }
    if (root.Model()) models.push_back(root.Model());
    if (models.empty()) refuse("models", "at least one");
    is_single_ = models.size() == 1;
    for (const sdf::Model* model : models) add_links(*model);
    if (bodies_.size() > kMostBodies) refuse("links", fmt::format("at most {}", kMostBodies));
    group_.resize(bodies_.size() + 1);  // the last one: what does not move
    std::iota(group_.begin(), group_.end(), 0);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (bodies_[b].is_fixed) group_[b] = bodies_.size();
    for (const sdf::Model* model : models) add_joints(*model);

    std::vector<std::string> names;
    for (const Body& body : bodies_) names.push_back(body.name);
    names_.insert(names.begin(), names.end());
    result_.text = fmt::format(
        "# From {} by softfinger simulate.\n"
        "id = {}\n\n[simulation]\ntime_step_ms = {}\nduration_s = 1\ngravity_m_per_s2 = {}\n\n",
        file_.filename().string(), in_quotes(id_), 1e3 * time_step_s, list(gravity));
    result_.text += layer_tables(layers_, names);
    gravity_m_per_s2_ = gravity;
    for (std::size_t b = 0; b < bodies_.size(); ++b) add_body(b);
    result_.text += joints_ + loops_ + motors_ + forces_;
    add_contacts();
    note("plugins, sensors and visuals are left out");
    note("contacts are rigid points with Coulomb's friction, or soft where --finger-layer says so");
    return std::move(result_);
  }

 private:
  struct Body {
    std::string name;
    const sdf::Model* model = nullptr;
    const sdf::Link* link = nullptr;
    Isometry3d pose = Isometry3d::Identity();
    bool is_fixed = false;
  };

  template <class... Arguments>
  void note(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    result_.notes.push_back(fmt::format(text, std::forward<Arguments>(arguments)...));
  }
  [[noreturn]] void refuse(const std::string& what, const std::string& allowed) const {
    throw InputError(file_.string(), what, "", allowed);
  }
  void require(const sdf::Errors& errors) const {
    if (errors.empty()) return;
    std::string reason = errors.front().Message();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    throw InputError(file_.string(), "libsdformat cannot read it: " + reason, "", "");
  }
  std::string full_name(const sdf::Model& model, const std::string& own) const {
    const std::string name = is_single_ ? own : model.Name() + "_" + own;
    if (!is_name(name))
      refuse("the name " + name.substr(0, kLongestName),
             fmt::format("1 to {} bytes without control characters", kLongestName));
    return name == "world" || name == "*" ? name + "_" : name;
  }
  /// A name that no body has.
  std::string new_name(std::string name) {
    while (!names_.insert(name).second) name += "_";
    return name;
  }
  Isometry3d resolved(const sdf::SemanticPose& semantic, const std::string& frame) const {
    ignition::math::Pose3d result;
    require(semantic.Resolve(result, frame));
    return pose(result);
  }

  /// The frame of a model that its pose places.
  Isometry3d placement(const sdf::Model& model, const std::string& frame) const {
    if (const sdf::Link* link = model.LinkByName(frame))
      return resolved(link->SemanticPose(), "__model__");
    if (const sdf::Joint* joint = model.JointByName(frame))
      return resolved(joint->SemanticPose(), "__model__");
    if (const sdf::Frame* own = model.FrameByName(frame))
      return resolved(own->SemanticPose(), "__model__");
    refuse("placement_frame " + in_quotes(frame), "a link, joint or frame of the model");
  }

  void add_links(const sdf::Model& model) {
    if (model.ModelCount() > 0)
      refuse("model " + in_quotes(model.Name()),
             "links and joints: models in models are not known");
    Isometry3d at = pose(model.RawPose());
    if (!model.PoseRelativeTo().empty())
      refuse("model " + in_quotes(model.Name()), "a pose in the world, without relative_to");
    if (const std::string& frame = model.PlacementFrameName(); !frame.empty())
      at = at * placement(model, frame).inverse();
    for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
      Body body;
      body.model = &model;
      body.link = model.LinkByIndex(i);
      body.name = full_name(model, body.link->Name());
      body.pose = at * resolved(body.link->SemanticPose(), "__model__");
      body.is_fixed = model.Static();
      place_of_link_[{&model, body.link->Name()}] = bodies_.size();
      bodies_.push_back(body);
    }
  }

  /// The index of a link; that behind the last for the world.
  std::size_t link_named(const sdf::Model& model, const std::string& name) const {
    if (name == "world") return bodies_.size();
    const auto found = place_of_link_.find({&model, name});
    if (found == place_of_link_.end()) refuse("link " + in_quotes(name), "a link of the model");
    return found->second;
  }
  std::string name_of(std::size_t body) const {
    return body == bodies_.size() ? "world" : bodies_[body].name;
  }
  std::size_t group(std::size_t body) const {
    while (group_[body] != body) body = group_[body];
    return body;
  }

  void add_joints(const sdf::Model& model) {
    for (std::uint64_t i = 0; i < model.JointCount(); ++i) {
      const sdf::Joint& joint = *model.JointByIndex(i);
      const std::string name = full_name(model, joint.Name());
      std::string parent_name, child_name;
      require(joint.ResolveParentLink(parent_name));
      require(joint.ResolveChildLink(child_name));
      const std::size_t parent = link_named(model, parent_name),
                        child = link_named(model, child_name);
      const bool is_hinge =
          joint.Type() == sdf::JointType::REVOLUTE || joint.Type() == sdf::JointType::CONTINUOUS;
      const bool is_slide = joint.Type() == sdf::JointType::PRISMATIC;
      const char* kind = is_hinge                                ? "revolute"
                         : is_slide                              ? "prismatic"
                         : joint.Type() == sdf::JointType::BALL  ? "ball"
                         : joint.Type() == sdf::JointType::FIXED ? "fixed"
                                                                 : nullptr;
      if (!kind)
        refuse("joint " + in_quotes(name), "fixed, revolute, continuous, prismatic or ball");
      if (child == bodies_.size() || bodies_[child].is_fixed)
        refuse("joint " + in_quotes(name), "a child that can move");
      const Isometry3d frame = bodies_[child].pose * resolved(joint.SemanticPose(), child_name);
      Vector3d axis = Vector3d::UnitZ();
      if (is_hinge || is_slide) {
        ignition::math::Vector3d in_child;
        require(joint.Axis(0)->ResolveXyz(in_child, child_name));
        axis = bodies_[child].pose.linear() * vector(in_child);
      }
      const std::string anchor =
          fmt::format("anchor_mm = {}\n", list(frame.translation() / kMillimetre));
      const std::string along = is_hinge || is_slide ? fmt::format("axis = {}\n", list(axis)) : "";
      const bool closes_a_ring = group(parent) == group(child) || has_parent_.count(child) > 0;
      if (group(parent) != group(child)) group_[group(child)] = group(parent);
      if (closes_a_ring) {
        loops_ += fmt::format("[[loop]]\nname = {}\nkind = \"{}\"\nbodies = [{}, {}]\n{}{}\n",
                              in_quotes(name), kind, in_quotes(name_of(parent)),
                              in_quotes(name_of(child)), anchor, along);
        note("the joint {} closes a ring: its limits, damping and spring are left out",
             in_quotes(name));
        continue;
      }
      has_parent_.insert(child);
      joints_ +=
          fmt::format("[[joint]]\nname = {}\nkind = \"{}\"\nparent = {}\nchild = {}\n{}{}",
                      in_quotes(name), kind, in_quotes(name_of(parent)), in_quotes(name_of(child)),
                      is_hinge || joint.Type() == sdf::JointType::BALL ? anchor : "", along);
      if (is_hinge || is_slide) add_axis(name, *joint.Axis(0), is_hinge);
      joints_ += "\n";
    }
  }

  /// libsdformat 12 does not know the element.
  void note_mimic(const std::string& name, const sdf::JointAxis& axis) {
    const sdf::ElementPtr element = axis.Element();
    if (!element) return;
    for (sdf::ElementPtr child = element->GetFirstElement(); child; child = child->GetNextElement())
      if (child->GetName() == "mimic")
        note(
            "joint {} moves by itself, not as joint {}: <mimic> is left out, a [[motor]] of its "
            "own can move it",
            in_quotes(name), in_quotes(child->Get<std::string>("joint", "").first));
  }

  void add_axis(const std::string& name, const sdf::JointAxis& axis, bool turns) {
    const double unit = turns ? kDegree : kMillimetre;
    // Without limits SDF has 1e16.
    constexpr double kNone = 1e15;
    const auto limit = [&](double value) {
      return std::abs(value) >= kNone
                 ? std::copysign(std::numeric_limits<double>::infinity(), value)
                 : value / unit;
    };
    if (!(axis.Lower() <= axis.Upper()))
      throw InputError(file_.string(), "the limits of joint " + in_quotes(name),
                       fmt::format("{} to {}", axis.Lower(), axis.Upper()), "lower <= upper");
    for (const double value : {axis.Damping(), axis.Friction(), axis.SpringStiffness(),
                               axis.SpringReference(), axis.Effort(), axis.MaxVelocity()})
      if (std::isnan(value))
        throw InputError(file_.string(), "the axis of joint " + in_quotes(name), "nan", "numbers");
    note_mimic(name, axis);
    if (std::isfinite(axis.MaxVelocity()) && axis.MaxVelocity() > 0 && axis.MaxVelocity() < kNone)
      note("the velocity limit of joint {} is left out", in_quotes(name));
    if (axis.Lower() > 0 || axis.Upper() < 0)
      note("the limits of joint {} are widened to the 0 at which it starts", in_quotes(name));
    const double lower = std::min(0., limit(axis.Lower())),
                 upper = std::max(0., limit(axis.Upper()));
    if (std::isfinite(lower) || std::isfinite(upper))
      joints_ += fmt::format("limits{} = [{}, {}]\n", turns ? "_deg" : "_mm", lower, upper);
    if (axis.Friction() > 0)
      joints_ += fmt::format("dry_friction_{} = {}\n", turns ? "Nm" : "N", axis.Friction());
    const bool is_limited = std::isfinite(axis.Effort()) && axis.Effort() > 0;
    if (!(axis.Damping() > 0) && !(axis.SpringStiffness() > 0) && !is_limited) return;
    motors_ += fmt::format("[[motor]]\njoint = {}\n", in_quotes(name));
    if (axis.SpringStiffness() > 0)
      motors_ += fmt::format("stiffness_{} = {}\ntime_s = [0]\nposition_{} = [{}]\n",
                             turns ? "Nm_per_rad" : "N_per_m", axis.SpringStiffness(),
                             turns ? "deg" : "mm", axis.SpringReference() / unit);
    if (axis.Damping() > 0)
      motors_ +=
          fmt::format("damping_{} = {}\n", turns ? "Nms_per_rad" : "Ns_per_m", axis.Damping());
    if (is_limited) {
      motors_ += fmt::format("max_effort_{} = {}\n", turns ? "Nm" : "N", axis.Effort());
      if (axis.Damping() > 0 || axis.SpringStiffness() > 0)
        note("damping and spring of joint {} share its effort limit", in_quotes(name));
    }
    motors_ += "\n";
  }

  /// Properties from a collision's <surface> that decide how it touches others.
  struct Surface {
    double friction_coefficient = 1;
    unsigned collide = 0xffff, category = 0xffff;

    bool operator==(const Surface& other) const {
      return friction_coefficient == other.friction_coefficient && collide == other.collide &&
             category == other.category;
    }
    bool meets(const Surface& other) const {
      return ((category & other.collide) | (other.category & collide)) != 0;
    }
  };

  /// An element in others, or null.
  static sdf::ElementPtr inner(sdf::ElementPtr element, std::initializer_list<const char*> path) {
    for (const char* part : path)
      element = element && element->HasElement(part) ? element->GetElement(part) : nullptr;
    return element;
  }

  Surface surface(const sdf::Collision& collision) {
    Surface result;
    if (const sdf::ElementPtr ode = inner(collision.Element(), {"surface", "friction", "ode"})) {
      const double along = ode->Get<double>("mu", 1.).first;
      const double across = ode->Get<double>("mu2", 1.).first;
      result.friction_coefficient = std::min(along, across);
      if (along != across)
        note("collision {} has the smaller of its two friction coefficients both ways",
             in_quotes(collision.Name()));
    }
    if (const sdf::ElementPtr contact = inner(collision.Element(), {"surface", "contact"})) {
      result.collide = contact->Get<unsigned>("collide_bitmask", 0xffffU).first;
      result.category = contact->HasElement("category_bitmask")
                            ? contact->Get<unsigned>("category_bitmask")
                            : result.collide;
    }
    return result;
  }

  /// A scene has one friction for two bodies: collisions whose surfaces differ are bodies of their
  /// own, fixed to the first.
  void add_body(std::size_t b) {
    const Body& body = bodies_[b];
    std::vector<Part> parts;
    std::vector<std::string> shapes;
    for (std::uint64_t i = 0; i < body.link->CollisionCount(); ++i) {
      const sdf::Collision& collision = *body.link->CollisionByIndex(i);
      const Surface own = surface(collision);
      std::size_t p = 0;
      while (p < parts.size() && !(parts[p].surface == own)) ++p;
      if (p == parts.size()) {
        parts.push_back(
            {p == 0 ? body.name : new_name(fmt::format("{}_collisions_{}", body.name, p + 1)), b,
             own});
        shapes.emplace_back();
      }
      shapes[p] += shape(collision, resolved(collision.SemanticPose(), body.link->Name()));
    }
    const std::size_t count = std::max<std::size_t>(1, parts.size());
    for (std::size_t p = 0; p < count; ++p) {
      const std::string name = parts.empty() ? body.name : parts[p].name;
      result_.text +=
          fmt::format("[[body]]\nname = {}\n{}", in_quotes(name), placed_lines(body.pose));
      if (body.is_fixed)
        result_.text += "fixed = true\n";
      else
        add_mass(body, 1. / double(count));
      if (p > 0 && !body.is_fixed)
        joints_ +=
            fmt::format("[[joint]]\nname = {}\nkind = \"fixed\"\nparent = {}\nchild = {}\n\n",
                        in_quotes("fixed_" + name), in_quotes(body.name), in_quotes(name));
      result_.text += layer_line(layers_, body.name);
      const bool has_shapes = !shapes.empty() && !shapes[p].empty();
      result_.text += has_shapes ? "shapes = [\n" + shapes[p] + "]\n\n" : "\n";
      if (has_shapes) parts_.push_back(parts[p]);
    }
    if (count > 1)
      note("the collisions of link {} have {} surfaces: it is {} bodies, fixed to each other",
           in_quotes(body.name), count, count);
    if (!body.is_fixed && !body.link->Element()->Get<bool>("gravity", true).first) add_lift(body);
  }

  /// @param share  of the link's mass: parts with one centre of mass add up to the link
  void add_mass(const Body& body, double share) {
    const auto& inertial = body.link->Inertial();
    const double mass_kg = inertial.MassMatrix().Mass();
    if (!(mass_kg > 0))
      throw InputError(file_.string(), "the mass of link " + in_quotes(body.name),
                       fmt::format("{}", mass_kg), "a number > 0, in kg");
    const ignition::math::Matrix3d moi = inertial.MassMatrix().Moi();
    Matrix3d inertia;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) inertia(i, j) = moi(std::size_t(i), std::size_t(j));
    result_.text += mass_lines(share * mass_kg, pose(inertial.Pose()), share * inertia);
  }

  /// A scene has gravity for all bodies: one without it is held by its weight at its centre of
  /// mass.
  void add_lift(const Body& body) {
    const Vector3d force = -body.link->Inertial().MassMatrix().Mass() * gravity_m_per_s2_;
    forces_ += fmt::format("[[force]]\nbody = {}\ntime_s = [0]\nforce_N = [{}]\n\n",
                           in_quotes(body.name), list(force));
    note("link {} has no gravity: a [[force]] holds its weight in the file's gravity",
         in_quotes(body.name));
  }

  std::string shape(const sdf::Collision& collision, Isometry3d at) const {
    const sdf::Geometry& geometry = *collision.Geom();
    std::string text;
    switch (geometry.Type()) {
      case sdf::GeometryType::EMPTY:
        return "";
      case sdf::GeometryType::PLANE:
        at.linear() *= Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(),
                                                          vector(geometry.PlaneShape()->Normal()))
                           .toRotationMatrix();
        text = "half_space = true";
        break;
      case sdf::GeometryType::BOX:
        text = "box_size_mm = " + list(vector(geometry.BoxShape()->Size()) / kMillimetre);
        break;
      case sdf::GeometryType::SPHERE:
        text = fmt::format("sphere_radius_mm = {}", geometry.SphereShape()->Radius() / kMillimetre);
        break;
      case sdf::GeometryType::ELLIPSOID:
        text = "ellipsoid_semi_axes_mm = " +
               list(vector(geometry.EllipsoidShape()->Radii()) / kMillimetre);
        break;
      case sdf::GeometryType::CYLINDER:
        text = fmt::format("cylinder_radius_length_mm = [{}, {}]",
                           geometry.CylinderShape()->Radius() / kMillimetre,
                           geometry.CylinderShape()->Length() / kMillimetre);
        break;
      case sdf::GeometryType::CAPSULE:
        text = fmt::format("capsule_radius_length_mm = [{}, {}]",
                           geometry.CapsuleShape()->Radius() / kMillimetre,
                           geometry.CapsuleShape()->Length() / kMillimetre);
        break;
      case sdf::GeometryType::MESH:
        text = mesh(collision.Name(), *geometry.MeshShape());
        break;
      default:
        refuse("collision " + in_quotes(collision.Name()),
               "a plane, box, sphere, ellipsoid, cylinder, capsule or mesh");
    }
    const std::string placing = placed(at);
    return fmt::format("  {{ {}{}{} }},\n", text, placing.empty() ? "" : ", ", placing);
  }

  std::string mesh(const std::string& collision, const sdf::Mesh& mesh) const {
    const std::filesystem::path path = file_.parent_path() / mesh.Uri();
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
      refuse("collision " + in_quotes(collision),
             "a mesh file beside the SDF file, not " + mesh.Uri().substr(0, kLongestName));
    if (mesh.Scale() != ignition::math::Vector3d::One)
      refuse("collision " + in_quotes(collision), "a mesh without scale");
    // A file that says its unit is in that one.
    const meshes::MeshFormat* format = meshes::mesh_format(path.string());
    return fmt::format("mesh = {}{}", in_quotes(std::filesystem::absolute(path).string()),
                       format && format->has_unit ? "" : ", unit = \"m\"");
  }

  /// Adds the contact rules; the smaller friction of two surfaces counts.
  void add_contacts() {
    std::size_t rules = 0;
    for (auto a = parts_.begin(); a != parts_.end(); ++a)
      for (auto b = a + 1; b != parts_.end(); ++b) {
        const Body &first = bodies_[a->body], &second = bodies_[b->body];
        if (first.is_fixed && second.is_fixed) continue;
        if (++rules > kMostRules)
          refuse("pairs of links with collisions", fmt::format("at most {}", kMostRules));
        const bool collide = a->surface.meets(b->surface) && a->body != b->body &&
                             (first.model != second.model || first.model->SelfCollide());
        result_.text += fmt::format("[[contact]]\nbodies = [{}, {}]\n{}\n\n", in_quotes(a->name),
                                    in_quotes(b->name),
                                    collide ? fmt::format("friction_coefficient = {}",
                                                          std::min(a->surface.friction_coefficient,
                                                                   b->surface.friction_coefficient))
                                            : "collide = false");
      }
  }

  const std::filesystem::path& file_;
  std::string id_;
  const std::vector<FingerLayer>& layers_;
  ImportedScene result_;
  bool is_single_ = true;
  std::vector<Body> bodies_;
  std::vector<std::size_t> group_;  ///< of links that hang together
  std::map<std::pair<const sdf::Model*, std::string>, std::size_t> place_of_link_;
  std::set<std::size_t> has_parent_;
  /// A body of the scene with shapes.
  struct Part {
    std::string name;
    std::size_t body = 0;
    Surface surface;
  };
  std::vector<Part> parts_;
  std::set<std::string> names_;  ///< of bodies
  Vector3d gravity_m_per_s2_ = Vector3d::Zero();
  std::string joints_, loops_, motors_, forces_;
};

}  // namespace

ImportedScene import_sdf(const std::filesystem::path& file, const std::string& id,
                         const std::vector<FingerLayer>& layers) {
  return Importer(file, id, layers).run();
}

}  // namespace softfinger::robots
