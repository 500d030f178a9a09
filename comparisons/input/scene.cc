#include "comparisons/input/scene.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "comparisons/input/mesh_file.h"
#include "comparisons/input/mesh_unit.h"
#include "comparisons/input/time_reader.h"
#include "comparisons/input/toml_reader.h"
#include "comparisons/input/unusual_values.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/nearest_name.h"
#include "meshes/io/read_surface.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::input {
namespace fs = std::filesystem;
namespace {

/// Limits of one scene, copies counted. All poses are recorded: five million of them take about
/// a gigabyte.
constexpr std::size_t kMostBodies = 1000, kMostShapes = 100, kMostLayers = 100, kMostJoints = 1000,
                      kMostLoops = 100, kMostMotors = 1000, kMostForces = 1000,
                      kMostContactRules = 20000, kMostTimes = 10000, kMostEccentricities = 1000;
/// The place among a scene's rules of that for bodies which a joint connects.
constexpr int kJoinedRule = 1;
constexpr double kMostSteps = 1e6, kMostRecordedPoses = 5e6;
/// Beyond these a step only rounds: larger loads than any machine's, half a turn per step.
constexpr double kMostLoad = 1e12, kMostTurnPerStep = kPi;
constexpr double kMostGravity = 1e9;  // m/s2, each component
constexpr int kMostCopies = 100, kFewestVertices = 6, kMostVertices = 1024;

constexpr double kGram = 1e-3, kKilogramSquareMillimetre = 1e-6;

const std::vector<std::string> kJointKinds = {"fixed", "revolute", "prismatic", "ball"};

/// @param name  one of kJointKinds
JointKind joint_kind(const std::string& name) {
  return name == "revolute"    ? JointKind::revolute
         : name == "prismatic" ? JointKind::prismatic
         : name == "ball"      ? JointKind::ball
                               : JointKind::fixed;
}

/// Reads a scene file, table by table.
/// "; did you mean "floor"?", or all names there are.
std::string meant(const std::string& typed, const std::vector<std::string>& known) {
  constexpr std::size_t kListedNames = 200;  // bytes
  const std::string nearest = text::did_you_mean(typed, known, "; ");
  return nearest.empty() ? ": " + text::shortened(text::joined(known), kListedNames) : nearest;
}

class SceneReader {
 public:
  SceneReader(const toml::table& root, const fs::path& file, Scene& scene)
      : reader_(file.string()), root_(root), folder_(file.parent_path()), scene_(scene) {}

  void read();

 private:
  std::vector<const toml::table*> tables(const char* key, std::size_t most,
                                         bool required = false) const;
  Eigen::Vector3d vector(const toml::node& node, const std::string& field, double si) const;
  Eigen::Vector3d gravity_of(const toml::node& node) const;
  Eigen::Vector3d vector_or_zero(const toml::table& table, const std::string& key, double si) const;
  Eigen::Isometry3d pose(const toml::table& table) const;
  int body_named(const toml::node& node, const std::string& field, bool world_allowed) const;
  std::vector<double> times(const toml::table& table, const std::string& name) const;

  void read_simulation();
  const FrictionLaw& read_law(const toml::node& node) const;
  void read_layers();
  void read_bodies();
  Shape read_shape(const toml::node& node, MeshRole role) const;
  void remark_once(const std::string& line) const;
  void read_mass(const toml::table& table, const std::string& where,
                 const std::vector<Shape>& shapes, BodyDescription& body) const;
  void read_joints();
  void read_leaders();
  void read_loops();
  void read_motors();
  void read_forces();
  void separate_joined_bodies();
  void read_rules();
  ContactRule read_rule(const toml::table& table) const;
  void start_joints(Multibody bodies);
  ContactModel read_model(const toml::table& table) const;
  const FrictionLaw* read_own_law(const toml::table& table) const;
  EccentricityOverLoad eccentricity_table(const toml::node& node) const;

  TomlReader reader_;
  const toml::table& root_;
  fs::path folder_;
  Scene& scene_;
  struct Layer {
    ElasticLayer elastic;
    Relaxation relaxation;
  };
  std::map<std::string, Layer> layers_;
  std::vector<const toml::table*> body_tables_, joint_tables_, loop_tables_;
};

std::vector<const toml::table*> SceneReader::tables(const char* key, std::size_t most,
                                                    bool required) const {
  std::vector<const toml::table*> result;
  const toml::node* node = root_.get(key);
  const std::string name = fmt::format("[[{}]]", key);
  if (!node) {
    if (required) throw InputError(scene_.file.string(), "there is no " + name, "", "");
    return result;
  }
  for (const toml::node& entry : reader_.list(*node, name, most, "tables " + name)) {
    if (!entry.is_table()) reader_.refuse(entry, key, "tables " + name);
    result.push_back(entry.as_table());
  }
  return result;
}

Eigen::Vector3d SceneReader::vector(const toml::node& node, const std::string& field,
                                    double si) const {
  const auto values = reader_.numbers(node, field, 3, "three finite numbers");
  return si * Eigen::Vector3d(values[0], values[1], values[2]);
}

Eigen::Vector3d SceneReader::vector_or_zero(const toml::table& table, const std::string& key,
                                            double si) const {
  const toml::node* node = table.get(key);
  return node ? vector(*node, key, si) : Eigen::Vector3d::Zero();
}

/// position_mm, then rotation_deg about the fixed x, y and z axes, in this order.
Eigen::Isometry3d SceneReader::pose(const toml::table& table) const {
  const Eigen::Vector3d angles = vector_or_zero(table, "rotation_deg", kDegree);
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = (Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
  result.translation() = vector_or_zero(table, "position_mm", kMillimetre);
  return result;
}

int SceneReader::body_named(const toml::node& node, const std::string& field,
                            bool world_allowed) const {
  const std::string typed = reader_.name(node, field);
  if (world_allowed && typed == "world") return -1;
  std::vector<std::string> known;
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    if (scene_.bodies[b].name == typed) return int(b);
    known.push_back(scene_.bodies[b].name);
  }
  reader_.refuse(node, field, "the name of a body" + meant(typed, known));
}

std::vector<double> SceneReader::times(const toml::table& table, const std::string& name) const {
  const toml::node& node = reader_.required(table, name, "time_s");
  const std::string allowed = "a list of times in s, each later than the one before";
  const toml::array& list = reader_.list(node, "time_s", kMostTimes, allowed);
  if (list.empty()) reader_.refuse(node, "time_s", allowed);
  std::vector<double> result;
  for (const toml::node& entry : list) {
    result.push_back(reader_.number(entry, "time_s", allowed));
    if (result.size() > 1 && !(result.back() > result[result.size() - 2]))
      reader_.refuse(node, "time_s", allowed);
  }
  return result;
}

const FrictionLaw& SceneReader::read_law(const toml::node& node) const {
  std::vector<std::string> names;
  for (const FrictionLaw* law : all_friction_laws()) names.emplace_back(law->name);
  const std::string typed = reader_.choice(node, "friction", names);
  return **std::find_if(all_friction_laws().begin(), all_friction_laws().end(),
                        [&](const FrictionLaw* law) { return law->name == typed; });
}

Eigen::Vector3d SceneReader::gravity_of(const toml::node& node) const {
  const Eigen::Vector3d typed = vector(node, "gravity_m_per_s2", 1);
  if (!(typed.lpNorm<Eigen::Infinity>() <= kMostGravity))
    reader_.refuse(node, "gravity_m_per_s2",
                   fmt::format("[x, y, z], each at most {:g}", kMostGravity));
  return typed;
}

void SceneReader::read_simulation() {
  const toml::table& table = reader_.required_table(root_, "simulation");
  reader_.check_keys(table, "[simulation]",
                     {"time_step_ms", "duration_s", "gravity_m_per_s2", "gravity_time_s",
                      "friction", "vertices", "nominal_load_N"});
  scene_.time_step_s = reader_.positive(reader_.required(table, "[simulation]", "time_step_ms"),
                                        "time_step_ms", 1e-3);
  scene_.duration_s =
      reader_.positive(reader_.required(table, "[simulation]", "duration_s"), "duration_s", 1);
  if (scene_.time_step_s > scene_.duration_s)
    reader_.refuse(*table.get("time_step_ms"), "time_step_ms",
                   fmt::format("at most the duration, {:g}", 1e3 * scene_.duration_s));
  if (scene_.duration_s / scene_.time_step_s > kMostSteps)
    reader_.refuse(*table.get("duration_s"), "duration_s",
                   fmt::format("at most {:.0f} steps of time_step_ms", kMostSteps));
  if (const toml::node* load = table.get("nominal_load_N"))
    scene_.nominal_load_N = reader_.positive(*load, "nominal_load_N", 1);
  scene_.gravity.time_s = {0};
  scene_.gravity.values = Eigen::RowVector3d(0, 0, -9.81);
  if (const toml::node* gravity = table.get("gravity_m_per_s2")) {
    const toml::array* list = gravity->as_array();
    if (list && !list->empty() && (*list)[0].is_array()) {
      reader_.list(*gravity, "gravity_m_per_s2", kMostTimes, "directions");
      scene_.gravity.time_s.clear();
      const toml::node& typed_times = reader_.required(table, "[simulation]", "gravity_time_s");
      const toml::array* times = typed_times.as_array();
      const std::string allowed = "as many increasing times as there are directions";
      if (!times || times->size() != list->size())
        reader_.refuse(typed_times, "gravity_time_s", allowed);
      scene_.gravity.values.resize(Eigen::Index(list->size()), 3);
      for (std::size_t n = 0; n < list->size(); ++n) {
        scene_.gravity.time_s.push_back(reader_.number((*times)[n], "gravity_time_s", allowed));
        if (n > 0 && !(scene_.gravity.time_s[n] > scene_.gravity.time_s[n - 1]))
          reader_.refuse(typed_times, "gravity_time_s", allowed);
        scene_.gravity.values.row(Eigen::Index(n)) = gravity_of((*list)[n]).transpose();
      }
    } else {
      scene_.gravity.values = gravity_of(*gravity).transpose();
    }
  }
  if (const toml::node* friction = table.get("friction"))
    scene_.friction.law = &read_law(*friction);
  if (const toml::node* vertices = table.get("vertices")) {
    if (scene_.friction.law != &kFacetsLaw)
      reader_.say(*vertices, "vertices belongs to friction = \"facets\"");
    scene_.friction.vertices =
        reader_.integer(*vertices, "vertices", kFewestVertices, kMostVertices,
                        fmt::format("{} to {}", kFewestVertices, kMostVertices));
  }
}

void SceneReader::read_layers() {
  for (const toml::table* table : tables("layer", kMostLayers)) {
    reader_.check_keys(
        *table, "[[layer]]",
        {"name", "thickness_mm", "youngs_modulus_kPa", "poisson_ratio", "relaxation"});
    const toml::node& name = reader_.required(*table, "[[layer]]", "name");
    const Layer layer{reader_.elastic_layer(*table, "[[layer]]"), read_relaxation(reader_, *table)};
    if (!layers_.emplace(reader_.name(name, "name"), layer).second)
      reader_.refuse(name, "name", "each layer once");
  }
}

void SceneReader::remark_once(const std::string& line) const {
  auto& remarks = scene_.remarks;
  if (std::find(remarks.begin(), remarks.end(), line) == remarks.end()) remarks.push_back(line);
}

Shape SceneReader::read_shape(const toml::node& node, MeshRole role) const {
  if (!node.is_table()) reader_.refuse(node, "shape", "a table such as { sphere_radius_mm = 10 }");
  const toml::table& table = *node.as_table();
  const std::vector<std::string> kinds = {"sphere_radius_mm",
                                          "ellipsoid_semi_axes_mm",
                                          "cylinder_radius_length_mm",
                                          "capsule_radius_length_mm",
                                          "box_size_mm",
                                          "half_space",
                                          "mesh"};
  std::vector<std::string> known = kinds;
  known.insert(known.end(), {"position_mm", "rotation_deg", "unit", "part"});
  reader_.check_keys(table, "shape", known);
  std::vector<std::string> found;
  for (const std::string& kind : kinds)
    if (table.contains(kind)) found.push_back(kind);
  if (found.size() != 1) reader_.say(table, "a shape needs exactly one of " + text::joined(kinds));
  const std::string& kind = found[0];
  const toml::node& value = *table.get(kind);
  Shape shape;
  shape.pose = pose(table);
  for (const char* key : {"unit", "part"})
    if (table.contains(key) && kind != "mesh")
      reader_.say(table, std::string(key) + " belongs to a mesh");
  const auto positive_numbers = [&](std::size_t count) {
    const std::string allowed = fmt::format("{} numbers > 0, in mm", count);
    auto numbers = reader_.numbers(value, kind, count, allowed);
    for (double& number : numbers) {
      if (!(number > 0)) reader_.refuse(value, kind, allowed);
      number *= kMillimetre;
    }
    return numbers;
  };
  if (kind == "sphere_radius_mm") {
    shape.kind = Sphere{reader_.positive(value, kind, kMillimetre)};
  } else if (kind == "ellipsoid_semi_axes_mm") {
    const auto axes = positive_numbers(3);
    shape.kind = Ellipsoid{{axes[0], axes[1], axes[2]}};
  } else if (kind == "cylinder_radius_length_mm") {
    const auto size = positive_numbers(2);
    shape.kind = Cylinder{size[0], size[1]};
  } else if (kind == "capsule_radius_length_mm") {
    const auto size = positive_numbers(2);
    shape.kind = Capsule{size[0], size[1]};
  } else if (kind == "box_size_mm") {
    const auto size = positive_numbers(3);
    shape.kind = Box{{size[0], size[1], size[2]}};
  } else if (kind == "half_space") {
    const std::string allowed = "true: all below the shape's plane z = 0";
    if (!reader_.boolean(value, kind, allowed)) reader_.refuse(value, kind, allowed);
    shape.kind = HalfSpace{};
  } else {
    const std::string typed = reader_.text(value, "mesh");
    const toml::node *unit = table.get("unit"), *part = table.get("part");
    std::optional<double> metres_per_unit;
    if (unit) metres_per_unit = reader_.choice(*unit, "unit", {"mm", "m"}) == "m" ? 1 : 1e-3;
    try {
      const std::string path = system::find_mesh_file(typed, folder_).string();
      const std::string typed_part = part ? reader_.text(*part, "part") : "";
      if (part && typed_part.empty())
        reader_.refuse(*part, "part", "the name of a part of the mesh's file");
      const meshes::SurfaceFile file = read_mesh_file(path, typed_part, metres_per_unit);
      if (role == MeshRole::finger) require_finger_size(file, path, UnitIsTold::in_a_file);
      shape.kind = Mesh{std::make_shared<TriangleSurface>(file.surface)};
      for (const std::string& text :
           {meshes::repairs(file), unit_remark(file, role, UnitIsTold::in_a_file)})
        if (!text.empty()) remark_once(path + ": " + text);
    } catch (const InputError& error) {
      throw InputError(reader_.where(value), "mesh " + error.where() + ": " + error.field(),
                       error.value(), error.allowed());
    }
  }
  return shape;
}

struct Solid {
  MassProperties unit_mass;
  double volume_m3 = 0;
};

/// Volume, and mass properties for the mass 1, of a shape in its body's frame.
Solid solid(const Shape& shape, const std::string& where) {
  Solid result;
  if (const auto* sphere = std::get_if<Sphere>(&shape.kind)) {
    result.unit_mass = unit_mass_of_ellipsoid(Eigen::Vector3d::Constant(sphere->radius_m));
    result.volume_m3 = 4 * kPi / 3 * std::pow(sphere->radius_m, 3);
  } else if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape.kind)) {
    result.unit_mass = unit_mass_of_ellipsoid(ellipsoid->semi_axes_m);
    result.volume_m3 = 4 * kPi / 3 * ellipsoid->semi_axes_m.prod();
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.kind)) {
    result.unit_mass = unit_mass_of_cylinder(cylinder->radius_m, cylinder->length_m);
    result.volume_m3 = kPi * cylinder->radius_m * cylinder->radius_m * cylinder->length_m;
  } else if (const auto* capsule = std::get_if<Capsule>(&shape.kind)) {
    const double r = capsule->radius_m;
    result.unit_mass = unit_mass_of_capsule(r, capsule->length_m);
    result.volume_m3 = kPi * r * r * (capsule->length_m + 4 * r / 3);
  } else if (const auto* box = std::get_if<Box>(&shape.kind)) {
    result.unit_mass = unit_mass_of_box(box->size_m);
    result.volume_m3 = box->size_m.prod();
  } else if (const auto* mesh = std::get_if<Mesh>(&shape.kind)) {
    result.unit_mass = unit_mass_of_closed_surface(*mesh->surface, where, &result.volume_m3);
  }
  const Eigen::Matrix3d turn = shape.pose.linear();
  result.unit_mass.inertia_kg_m2 = turn * result.unit_mass.inertia_kg_m2 * turn.transpose();
  result.unit_mass.center_m = shape.pose * result.unit_mass.center_m;
  return result;
}

/// Solid made of all shapes of a body; where they overlap, their volume counts twice.
Solid united(const std::vector<Shape>& shapes, const std::string& where) {
  Solid sum;
  std::vector<Solid> parts;
  for (const Shape& shape : shapes) {
    parts.push_back(solid(shape, where));
    sum.volume_m3 += parts.back().volume_m3;
  }
  for (const Solid& part : parts)
    sum.unit_mass.center_m += part.volume_m3 / sum.volume_m3 * part.unit_mass.center_m;
  for (const Solid& part : parts) {
    const Eigen::Vector3d arm = part.unit_mass.center_m - sum.unit_mass.center_m;
    sum.unit_mass.inertia_kg_m2 +=
        part.volume_m3 / sum.volume_m3 *
        (part.unit_mass.inertia_kg_m2 + arm.squaredNorm() * Eigen::Matrix3d::Identity() -
         arm * arm.transpose());
  }
  sum.unit_mass.mass_kg = 1;
  return sum;
}

void SceneReader::read_mass(const toml::table& table, const std::string& where,
                            const std::vector<Shape>& shapes, BodyDescription& body) const {
  const toml::node* mass = table.get("mass_g");
  const toml::node* density = table.get("density_kg_per_m3");
  const toml::node* inertia = table.get("inertia_kg_mm2");
  const toml::node* center = table.get("center_of_mass_mm");
  if (body.fixed || body.massless) {
    for (const toml::node* node : {mass, density, inertia, center})
      if (node) reader_.say(*node, "a fixed or massless body needs no mass");
    return;
  }
  if ((mass != nullptr) == (density != nullptr))
    reader_.say(table, where + " needs exactly one of mass_g, density_kg_per_m3");
  for (const Shape& shape : shapes)
    if (std::holds_alternative<HalfSpace>(shape.kind))
      reader_.say(table, where + " has a half_space: that is for fixed bodies");
  if (density && inertia) reader_.say(*inertia, "inertia_kg_mm2 goes with mass_g");
  const bool derived = !inertia;
  if (derived && shapes.empty())
    reader_.say(table, where + " has no shape to derive its inertia from: give inertia_kg_mm2");
  double volume_m3 = 0;
  if (derived) {
    try {
      const Solid whole = united(shapes, where);
      body.mass = whole.unit_mass;
      volume_m3 = whole.volume_m3;
    } catch (const InputError& error) {
      throw InputError(reader_.where(table.contains("shapes") ? *table.get("shapes") : table),
                       where + ": " + error.field(), error.value(), error.allowed());
    }
  }
  const double mass_kg = mass ? reader_.number(*mass, "mass_g", "a finite number > 0") * kGram
                              : reader_.positive(*density, "density_kg_per_m3", 1) * volume_m3;
  if (mass && !(mass_kg > 0)) reader_.refuse(*mass, "mass_g", "a finite number > 0");
  if (derived) {
    body.mass = with_mass(body.mass, mass_kg);
  } else {
    body.mass.mass_kg = mass_kg;
    const toml::array* list = inertia->as_array();
    const std::string allowed = "[xx, yy, zz] or [xx, yy, zz, xy, xz, yz] about the centre of mass";
    const std::size_t count = list && list->size() == 6 ? 6 : 3;
    const auto values = reader_.numbers(*inertia, "inertia_kg_mm2", count, allowed);
    Eigen::Matrix3d& matrix = body.mass.inertia_kg_m2;
    matrix = Eigen::Vector3d(values[0], values[1], values[2]).asDiagonal();
    if (count == 6) {
      matrix(0, 1) = matrix(1, 0) = values[3];
      matrix(0, 2) = matrix(2, 0) = values[4];
      matrix(1, 2) = matrix(2, 1) = values[5];
    }
    matrix *= kKilogramSquareMillimetre;
  }
  if (center) body.mass.center_m = vector(*center, "center_of_mass_mm", kMillimetre);
  try {
    require_physical(body.mass, where);
  } catch (const InputError& error) {
    throw InputError(reader_.where(inertia ? *inertia : *(mass ? mass : density)),
                     where + ": " + error.field(), error.value(), error.allowed());
  }
}

void SceneReader::read_bodies() {
  std::set<std::string> body_names;
  for (const toml::table* table : tables("body", kMostBodies, true)) {
    reader_.check_keys(
        *table, "[[body]]",
        {"name", "fixed", "massless", "position_mm", "rotation_deg", "mass_g", "density_kg_per_m3",
         "center_of_mass_mm", "inertia_kg_mm2", "velocity_mm_per_s", "angular_velocity_deg_per_s",
         "layer", "shapes", "copies"});
    SceneBody body;
    BodyDescription description;
    const toml::node& name = reader_.required(*table, "[[body]]", "name");
    body.name = reader_.name(name, "name");
    const std::string where = "body \"" + body.name + "\"";
    if (body.name == "world" || body.name == "*")
      reader_.refuse(name, "name", "a name; \"world\" and \"*\" are taken");
    if (const toml::node* fixed = table->get("fixed"))
      description.fixed = reader_.boolean(*fixed, "fixed");
    description.pose = pose(*table);
    for (const char* key : {"velocity_mm_per_s", "angular_velocity_deg_per_s"})
      if (description.fixed && table->contains(key))
        reader_.say(*table->get(key), where + " is fixed: it has no " + std::string(key));
    description.velocity_m_per_s = vector_or_zero(*table, "velocity_mm_per_s", kMillimetre);
    description.angular_velocity_rad_per_s =
        vector_or_zero(*table, "angular_velocity_deg_per_s", kDegree);
    if (!(description.angular_velocity_rad_per_s.norm() * scene_.time_step_s <= kMostTurnPerStep))
      reader_.refuse(*table->get("angular_velocity_deg_per_s"), "angular_velocity_deg_per_s",
                     fmt::format("at most half a turn per time step, {:g} together",
                                 kMostTurnPerStep / kDegree / scene_.time_step_s));
    const bool is_finger = table->contains("layer");
    if (const toml::node* shapes = table->get("shapes"))
      for (const toml::node& shape :
           reader_.list(*shapes, "shapes", kMostShapes, "a list of shapes"))
        body.shapes.push_back(read_shape(shape, is_finger ? MeshRole::finger : MeshRole::object));
    if (const toml::node* layer = table->get("layer")) {
      const std::string typed = reader_.name(*layer, "layer");
      const auto found = layers_.find(typed);
      if (found == layers_.end()) reader_.refuse(*layer, "layer", "the name of a [[layer]]");
      body.layer = found->second.elastic;
      body.relaxation = found->second.relaxation;
    }
    if (const toml::node* massless = table->get("massless"))
      description.massless = reader_.boolean(*massless, "massless");
    if (description.massless && (description.fixed || !body.shapes.empty()))
      reader_.say(*table, where + " is massless: it has no shapes and is not fixed");
    read_mass(*table, where, body.shapes, description);
    body.is_mass_derived =
        !description.fixed && !description.massless && !table->contains("inertia_kg_mm2");
    std::array<std::int64_t, 3> count = {1, 1, 1};
    Eigen::Vector3d spacing_m = Eigen::Vector3d::Zero();
    if (const toml::node* copies = table->get("copies")) {
      if (!copies->is_table())
        reader_.refuse(*copies, "copies", "{ count = [2, 2, 1], spacing_mm = [10, 10, 0] }");
      reader_.check_keys(*copies->as_table(), "copies", {"count", "spacing_mm"});
      const toml::node& counts = reader_.required(*copies->as_table(), "copies", "count");
      const std::string allowed = fmt::format("three whole numbers from 1 to {}", kMostCopies);
      const auto typed = reader_.numbers(counts, "count", 3, allowed);
      for (std::size_t i = 0; i < 3; ++i) {
        if (!(typed[i] >= 1 && typed[i] <= kMostCopies) || typed[i] != std::floor(typed[i]))
          reader_.refuse(counts, "count", allowed);
        count[i] = std::int64_t(typed[i]);
      }
      spacing_m = vector(reader_.required(*copies->as_table(), "copies", "spacing_mm"),
                         "spacing_mm", kMillimetre);
    }
    const Eigen::Vector3d corner = description.pose.translation();
    const std::size_t copies = std::size_t(count[0] * count[1] * count[2]);
    if (scene_.bodies.size() + copies > kMostBodies)
      reader_.refuse(name, "name",
                     fmt::format("at most {} bodies in a scene, copies counted", kMostBodies));
    const bool several = copies > 1;
    int number = 0;
    for (std::int64_t z = 0; z < count[2]; ++z)
      for (std::int64_t y = 0; y < count[1]; ++y)
        for (std::int64_t x = 0; x < count[0]; ++x) {
          SceneBody copy = body;
          if (several) copy.name = fmt::format("{}_{}", body.name, ++number);
          description.name = copy.name;
          description.pose.translation() =
              corner + spacing_m.cwiseProduct(Eigen::Vector3d(double(x), double(y), double(z)));
          if (!body_names.insert(copy.name).second) reader_.refuse(name, "name", "each body once");
          scene_.bodies.push_back(copy);
          scene_.descriptions.push_back(description);
          body_tables_.push_back(table);
        }
  }
}

void SceneReader::read_joints() {
  for (const toml::table* table : tables("joint", kMostJoints)) {
    reader_.check_keys(*table, "[[joint]]",
                       {"name", "kind", "parent", "child", "anchor_mm", "axis", "start_deg",
                        "start_mm", "limits_deg", "limits_mm", "rotor_inertia_kg_mm2",
                        "rotor_mass_g", "dry_friction_Nm", "dry_friction_N", "follows", "ratio"});
    JointDescription joint;
    const toml::node& name = reader_.required(*table, "[[joint]]", "name");
    joint.name = reader_.name(name, "name");
    for (const JointDescription& other : scene_.joints)
      if (other.name == joint.name) reader_.refuse(name, "name", "each joint once");
    const std::string kind =
        reader_.choice(reader_.required(*table, "[[joint]]", "kind"), "kind", kJointKinds);
    joint.kind = joint_kind(kind);
    joint.parent = body_named(reader_.required(*table, "[[joint]]", "parent"), "parent", true);
    joint.child = body_named(reader_.required(*table, "[[joint]]", "child"), "child", false);
    const bool turns = joint.kind == JointKind::revolute, is_ball = joint.kind == JointKind::ball;
    for (const char* key : {"start_deg", "limits_deg", "rotor_inertia_kg_mm2", "dry_friction_Nm"})
      if (!turns && table->contains(key))
        reader_.say(*table->get(key), std::string(key) + " belongs to a revolute joint");
    if (!turns && !is_ball && table->contains("anchor_mm"))
      reader_.say(*table->get("anchor_mm"), "anchor_mm belongs to a revolute or ball joint");
    if (is_ball && table->contains("axis"))
      reader_.say(*table->get("axis"), "a ball joint turns about every axis");
    for (const char* key : {"start_mm", "limits_mm", "rotor_mass_g", "dry_friction_N"})
      if (kind != "prismatic" && table->contains(key))
        reader_.say(*table->get(key), std::string(key) + " belongs to a prismatic joint");
    if (turns || joint.kind == JointKind::prismatic)
      joint.axis = vector(reader_.required(*table, "[[joint]]", "axis"), "axis", 1);
    if (turns || is_ball)
      joint.anchor_m =
          vector(reader_.required(*table, "[[joint]]", "anchor_mm"), "anchor_mm", kMillimetre);
    const double unit = turns ? kDegree : kMillimetre;
    const std::string suffix = turns ? "_deg" : "_mm";
    if (const toml::node* start = table->get("start" + suffix))
      joint.start = unit * reader_.number(*start, "start" + suffix, "a finite number");
    if (const toml::node* limits = table->get("limits" + suffix)) {
      const std::string allowed = "[lower, upper] with lower <= start <= upper";
      const auto pair = reader_.numbers(*limits, "limits" + suffix, 2, allowed, true);
      joint.lower = unit * pair[0];
      joint.upper = unit * pair[1];
      if (!(joint.lower <= joint.start && joint.start <= joint.upper))
        reader_.refuse(*limits, "limits" + suffix, allowed);
    }
    const char* rotor_key = turns ? "rotor_inertia_kg_mm2" : "rotor_mass_g";
    if (const toml::node* rotor = table->get(rotor_key)) {
      const double typed = reader_.number(*rotor, rotor_key, "a number >= 0");
      if (!(typed >= 0)) reader_.refuse(*rotor, rotor_key, "a number >= 0");
      joint.rotor_inertia = typed * (turns ? kKilogramSquareMillimetre : kGram);
    }
    const char* friction_key = turns ? "dry_friction_Nm" : "dry_friction_N";
    if (const toml::node* friction = table->get(friction_key)) {
      joint.dry_friction = reader_.number(*friction, friction_key, "a number >= 0");
      if (!(joint.dry_friction >= 0 && joint.dry_friction <= kMostLoad))
        reader_.refuse(*friction, friction_key, fmt::format("0 to {:g}", kMostLoad));
    }
    if (const toml::node* ratio = table->get("ratio")) {
      if (!table->contains("follows")) reader_.say(*ratio, "ratio goes with follows");
      joint.ratio = reader_.number(*ratio, "ratio", "a finite number");
    }
    scene_.joints.push_back(joint);
    joint_tables_.push_back(table);
  }
}

/// A joint may follow one that comes later in the file.
void SceneReader::read_leaders() {
  std::vector<std::string> names;
  for (const JointDescription& joint : scene_.joints) names.push_back(joint.name);
  for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
    const toml::node* follows = joint_tables_[j]->get("follows");
    if (!follows) continue;
    const std::string typed = reader_.name(*follows, "follows");
    const auto found = std::find(names.begin(), names.end(), typed);
    if (found == names.end())
      reader_.refuse(*follows, "follows", "the name of a joint" + meant(typed, names));
    scene_.joints[j].leader = int(found - names.begin());
  }
}

void SceneReader::read_loops() {
  std::set<std::string> names;
  for (const toml::table* table : tables("loop", kMostLoops)) {
    reader_.check_keys(*table, "[[loop]]", {"name", "kind", "bodies", "anchor_mm", "axis"});
    LoopDescription loop;
    const toml::node& name = reader_.required(*table, "[[loop]]", "name");
    loop.name = reader_.name(name, "name");
    if (!names.insert(loop.name).second) reader_.refuse(name, "name", "each loop once");
    loop.kind = joint_kind(
        reader_.choice(reader_.required(*table, "[[loop]]", "kind"), "kind", kJointKinds));
    const toml::node& pair = reader_.required(*table, "[[loop]]", "bodies");
    const toml::array* two = pair.as_array();
    if (!two || two->size() != 2)
      reader_.refuse(pair, "bodies", "two names, one of which may be \"world\"");
    loop.a = body_named((*two)[0], "bodies", true);
    loop.b = body_named((*two)[1], "bodies", true);
    loop.anchor_m =
        vector(reader_.required(*table, "[[loop]]", "anchor_mm"), "anchor_mm", kMillimetre);
    if (loop.kind == JointKind::revolute || loop.kind == JointKind::prismatic)
      loop.axis = vector(reader_.required(*table, "[[loop]]", "axis"), "axis", 1);
    else if (const toml::node* axis = table->get("axis"))
      reader_.say(*axis, "axis belongs to a revolute or prismatic loop");
    scene_.loops.push_back(loop);
    loop_tables_.push_back(table);
  }
}

void SceneReader::read_motors() {
  for (const toml::table* table : tables("motor", kMostMotors)) {
    const toml::node& name = reader_.required(*table, "[[motor]]", "joint");
    const std::string typed = reader_.name(name, "joint");
    Motor motor;
    std::vector<std::string> known;
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      if (scene_.joints[j].name == typed) motor.joint = int(j);
      known.push_back(scene_.joints[j].name);
    }
    if (motor.joint < 0)
      reader_.refuse(name, "joint",
                     known.empty() ? "the name of a [[joint]], of which there are none"
                                   : "the name of a joint" + meant(typed, known));
    const JointDescription& joint = scene_.joints[std::size_t(motor.joint)];
    if (joint.kind == JointKind::fixed || joint.kind == JointKind::ball)
      reader_.refuse(name, "joint", "a revolute or prismatic joint");
    for (const Motor& other : scene_.motors)
      if (other.joint == motor.joint) reader_.refuse(name, "joint", "one motor per joint");
    const bool turns = joint.kind == JointKind::revolute;
    const std::string stiffness = turns ? "stiffness_Nm_per_rad" : "stiffness_N_per_m";
    const std::string damping = turns ? "damping_Nms_per_rad" : "damping_Ns_per_m";
    const std::string most = turns ? "max_effort_Nm" : "max_effort_N";
    const std::string position = turns ? "position_deg" : "position_mm";
    const std::string effort = turns ? "effort_Nm" : "effort_N";
    reader_.check_keys(*table, "[[motor]]",
                       {"joint", stiffness, damping, most, position, effort, "time_s"});
    const auto not_negative = [&](const std::string& key, double& value) {
      const toml::node* node = table->get(key);
      if (!node) return;
      value = reader_.number(*node, key, "a number >= 0", true);
      if (!(value >= 0)) reader_.refuse(*node, key, "a number >= 0");
    };
    not_negative(stiffness, motor.stiffness);
    not_negative(damping, motor.damping);
    not_negative(most, motor.max_effort);
    if (std::isinf(motor.stiffness) || std::isinf(motor.damping))
      reader_.say(*table, "a motor's stiffness and damping are finite");
    motor.target = joint.start;
    const int index = int(scene_.motors.size());
    scene_.motors.push_back(motor);
    bool used_times = false;
    for (const std::string& key : {position, effort}) {
      const toml::node* node = table->get(key);
      if (!node) continue;
      used_times = true;
      if (key == position && motor.stiffness == 0)
        reader_.say(*node, key + " needs a " + stiffness + " > 0");
      Motion motion;
      motion.motor = index;
      motion.is_effort = key == effort;
      motion.table.smooth = !motion.is_effort;
      motion.table.time_s = times(*table, "[[motor]]");
      const auto values = reader_.numbers(*node, key, motion.table.time_s.size(),
                                          "finite numbers, as many as time_s has");
      motion.table.values.resize(Eigen::Index(values.size()), 1);
      const double unit = motion.is_effort ? 1 : turns ? kDegree : kMillimetre;
      for (std::size_t i = 0; i < values.size(); ++i)
        motion.table.values(Eigen::Index(i), 0) = unit * values[i];
      scene_.motions.push_back(motion);
    }
    if (!used_times && table->contains("time_s"))
      reader_.say(*table->get("time_s"), "time_s goes with " + position + " or " + effort);
  }
}

void SceneReader::read_forces() {
  for (const toml::table* table : tables("force", kMostForces)) {
    reader_.check_keys(*table, "[[force]]", {"body", "point_mm", "time_s", "force_N", "torque_Nm"});
    ForceOverTime force;
    const toml::node& name = reader_.required(*table, "[[force]]", "body");
    force.body = body_named(name, "body", false);
    const BodyDescription& body = scene_.descriptions[std::size_t(force.body)];
    if (body.fixed) reader_.refuse(name, "body", "a body that is not fixed");
    force.point_in_body_m = table->contains("point_mm")
                                ? vector(*table->get("point_mm"), "point_mm", kMillimetre)
                                : body.mass.center_m;
    force.table.time_s = times(*table, "[[force]]");
    const std::size_t count = force.table.time_s.size();
    force.table.values.setZero(Eigen::Index(count), 6);
    if (!table->contains("force_N") && !table->contains("torque_Nm"))
      reader_.say(*table, "[[force]] needs force_N or torque_Nm");
    for (const auto& [key, column] : {std::pair("force_N", 0), std::pair("torque_Nm", 3)}) {
      const toml::node* node = table->get(key);
      if (!node) continue;
      const toml::array* rows = node->as_array();
      if (!rows || rows->size() != count)
        reader_.refuse(*node, key, "a list of as many [x, y, z] as time_s has");
      for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Vector3d load = vector((*rows)[i], key, 1);
        if (!(load.lpNorm<Eigen::Infinity>() <= kMostLoad))
          reader_.refuse((*rows)[i], key, fmt::format("[x, y, z], each at most {:g}", kMostLoad));
        force.table.values.block<1, 3>(Eigen::Index(i), column) = load.transpose();
      }
    }
    scene_.forces.push_back(force);
  }
}

EccentricityOverLoad SceneReader::eccentricity_table(const toml::node& node) const {
  const toml::table* samples = node.as_table();
  const char* form =
      "{ loads_N = [least, largest], eccentricity_mm = [at least two, evenly spaced in ln P] }";
  if (!samples) reader_.refuse(node, "eccentricity_table", form);
  reader_.check_keys(*samples, "eccentricity_table", {"loads_N", "eccentricity_mm"});
  const toml::node& loads = reader_.required(*samples, "eccentricity_table", "loads_N");
  const std::vector<double> range =
      reader_.numbers(loads, "loads_N", 2, "two numbers, 0 < least < largest");
  if (!(range[0] > 0 && range[0] < range[1]))
    reader_.refuse(loads, "loads_N", "two numbers, 0 < least < largest");
  const toml::node& values = reader_.required(*samples, "eccentricity_table", "eccentricity_mm");
  const toml::array& array = reader_.list(values, "eccentricity_mm", kMostEccentricities, form);
  if (array.size() < 2) reader_.refuse(values, "eccentricity_mm", form);
  EccentricityOverLoad table{range[0], range[1], {}};
  for (const toml::node& value : array)
    table.eccentricity_m.push_back(reader_.positive(value, "eccentricity_mm", kMillimetre));
  return table;
}

ContactModel SceneReader::read_model(const toml::table& table) const {
  std::vector<std::string> names = {"auto", "rigid", "given", "table"};
  for (const PressureModel* model : all_pressure_models())
    if (model->card().hot_path) names.emplace_back(model->card().name);
  const toml::node* typed = table.get("model");
  const std::string name = typed ? reader_.choice(*typed, "model", names) : "auto";
  const toml::node* arm = table.get("eccentricity_mm");
  const toml::node* samples = table.get("eccentricity_table");
  if (arm && name != "given") reader_.say(*arm, "eccentricity_mm belongs to model = \"given\"");
  if (samples && name != "table")
    reader_.say(*samples, "eccentricity_table belongs to model = \"table\"");
  if (name == "auto") return AutomaticModel{};
  if (name == "rigid") return RigidPoint{};
  if (name == "given") {
    if (!arm) reader_.say(table, "model = \"given\" needs eccentricity_mm");
    return GivenEccentricity{reader_.positive(*arm, "eccentricity_mm", kMillimetre)};
  }
  if (name == "table") {
    if (!samples) reader_.say(table, "model = \"table\" needs eccentricity_table");
    return eccentricity_table(*samples);
  }
  return find_pressure_model(name);
}

/// The law of a [[contact]]; null: the scene's. The solver has one rule for all contacts of a step,
/// so that facets do not go together with another law.
const FrictionLaw* SceneReader::read_own_law(const toml::table& table) const {
  const bool facets = scene_.friction.law == &kFacetsLaw;
  const toml::node* typed = table.get("friction");
  const toml::node* exact = table.get("limit_surface");
  if (typed && exact) reader_.say(*exact, "limit_surface and friction both name the law: give one");
  if (typed) {
    const FrictionLaw& law = read_law(*typed);
    if (facets != (&law == &kFacetsLaw))
      reader_.say(*typed, "friction = \"facets\" holds for all contacts of a scene or for none");
    return &law;
  }
  if (!exact) return nullptr;
  if (reader_.boolean(*exact, "limit_surface")) {
    if (facets) reader_.say(*exact, "limit_surface = true needs a friction other than \"facets\"");
    return &kLimitSurfaceLaw;
  }
  return facets ? nullptr : &kEllipsoidLaw;
}

ContactRule SceneReader::read_rule(const toml::table& table) const {
  ContactRule rule;
  rule.shear_law = reader_.shear_law(table, "[[contact]]", rule.shear_law.friction_coefficient);
  rule.model = read_model(table);
  const bool knows_area = std::holds_alternative<AutomaticModel>(rule.model) ||
                          std::holds_alternative<const PressureModel*>(rule.model);
  if (rule.shear_law.has_shear_strength() && !knows_area)
    reader_.refuse(*table.get("shear_law"), "shear_law",
                   "\"coulomb\" with this model: the other laws need the contact's area, from "
                   "model = \"auto\" or a pressure model");
  rule.friction = read_own_law(table);
  if (const toml::node* restitution = table.get("restitution")) {
    const std::string allowed = "0, no rebound, to 1, at the speed of the impact";
    rule.restitution = reader_.number(*restitution, "restitution", allowed);
    if (!(rule.restitution >= 0 && rule.restitution <= 1))
      reader_.refuse(*restitution, "restitution", allowed);
  }
  if (const toml::node* collide = table.get("collide"))
    rule.collide = reader_.boolean(*collide, "collide");
  if (const toml::node* presliding = table.get("presliding")) {
    rule.presliding = reader_.boolean(*presliding, "presliding");
    if (rule.presliding && (std::holds_alternative<RigidPoint>(rule.model) ||
                            std::holds_alternative<GivenEccentricity>(rule.model)))
      reader_.refuse(*presliding, "presliding",
                     "false with this model: the stiffness needs the contact's ellipse, from "
                     "model = \"auto\", \"table\" or a pressure model");
  }
  return rule;
}

/// Bodies that a joint connects never collide. Those that hang on each other by way of bodies
/// without shapes, as on the axes of one joint, overlap as often: they do not collide unless a
/// [[contact]] names both.
void SceneReader::separate_joined_bodies() {
  const std::size_t count = scene_.bodies.size();
  scene_.rules.push_back({});
  scene_.rules.back().collide = false;
  std::vector<int> carrier(count, -1);
  for (const JointDescription& joint : scene_.joints)
    carrier[std::size_t(joint.child)] = joint.parent;
  for (std::size_t b = 0; b < count; ++b) {
    int other = carrier[b];
    for (std::size_t steps = 0; other >= 0 && steps < count; ++steps) {
      if (!scene_.bodies[std::size_t(other)].shapes.empty()) break;
      other = carrier[std::size_t(other)];
    }
    if (other < 0 || std::size_t(other) == b) continue;
    scene_.rule_of_pair[b * count + std::size_t(other)] =
        scene_.rule_of_pair[std::size_t(other) * count + b] = kJoinedRule;
  }
}

void SceneReader::read_rules() {
  const std::size_t count = scene_.bodies.size();
  scene_.rules.assign(1, {});
  scene_.rule_of_pair.assign(count * count, 0);
  separate_joined_bodies();
  for (const toml::table* table : tables("contact", kMostContactRules)) {
    reader_.check_keys(*table, "[[contact]]",
                       {"bodies", "friction_coefficient", "shear_law", "shear_strength_kPa",
                        "model", "eccentricity_mm", "eccentricity_table", "friction",
                        "limit_surface", "restitution", "collide", "presliding"});
    const toml::node& pair = reader_.required(*table, "[[contact]]", "bodies");
    const toml::array* names = pair.as_array();
    if (!names || names->size() != 2)
      reader_.refuse(pair, "bodies", "two names; \"*\" is any body, \"tip*\" any that begins so");
    std::array<std::vector<std::size_t>, 2> chosen;
    for (std::size_t side = 0; side < 2; ++side) {
      const std::string typed = reader_.text((*names)[side], "bodies");
      const bool prefix = !typed.empty() && typed.back() == '*';
      const std::string start = prefix ? typed.substr(0, typed.size() - 1) : typed;
      for (std::size_t b = 0; b < count; ++b) {
        const std::string& name = scene_.bodies[b].name;
        if (prefix ? name.compare(0, start.size(), start) == 0 : name == typed)
          chosen[side].push_back(b);
      }
      if (chosen[side].empty()) body_named((*names)[side], "bodies", false);  // refuses
    }
    if (chosen[0].size() == 1 && chosen[0] == chosen[1])
      reader_.refuse(pair, "bodies", "two bodies: one does not touch itself");
    const int index = int(scene_.rules.size());
    scene_.rules.push_back(read_rule(*table));
    // Names that stand for several bodies do not mean those that a joint connects.
    const bool is_single = chosen[0].size() == 1 && chosen[1].size() == 1;
    for (const std::size_t a : chosen[0])
      for (const std::size_t b : chosen[1])
        if (is_single || scene_.rule_of_pair[a * count + b] != kJoinedRule)
          scene_.rule_of_pair[a * count + b] = scene_.rule_of_pair[b * count + a] = index;
  }
}

/// The equations G v = 0 that loops impose on all velocities.
Eigen::MatrixXd loop_equations(const Multibody& bodies) {
  Eigen::MatrixXd all(0, bodies.velocities());
  for (const Multibody::Tree& tree : bodies.trees()) {
    if (tree.loop_rows == 0) continue;
    Eigen::MatrixXd jacobian;
    Eigen::VectorXd opening;
    bodies.loops(tree, jacobian, opening);
    const Eigen::Index before = all.rows();
    all.conservativeResize(before + jacobian.rows(), Eigen::NoChange);
    all.bottomRows(jacobian.rows()).setZero();
    all.block(before, tree.first, jacobian.rows(), tree.count) = jacobian;
  }
  return all;
}

/// Gives the joints the velocities that are typed for the bodies on them. A missing key leaves that
/// velocity to the other bodies; joints without any typed velocity are at rest. Loops stay closed:
/// they pass motion on, and a velocity that they do not allow is refused.
void SceneReader::start_joints(Multibody bodies) {
  struct Typed {
    int body;
    bool is_angular;
    const toml::node* node;
    const char* key;
    Eigen::Vector3d velocity;
  };
  std::vector<Typed> typed;
  std::vector<int> joint_of(scene_.bodies.size(), -1);
  for (std::size_t j = 0; j < scene_.joints.size(); ++j)
    joint_of[std::size_t(scene_.joints[j].child)] = int(j);
  // A loop may hold any body, by way of others.
  std::vector<bool> is_held(scene_.bodies.size());
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b)
    is_held[b] = joint_of[b] >= 0 || !scene_.loops.empty();
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    if (!is_held[b]) continue;
    const BodyDescription& body = scene_.descriptions[b];
    if (const toml::node* node = body_tables_[b]->get("velocity_mm_per_s"))
      typed.push_back({int(b), false, node, "velocity_mm_per_s", body.velocity_m_per_s});
    if (const toml::node* node = body_tables_[b]->get("angular_velocity_deg_per_s"))
      typed.push_back(
          {int(b), true, node, "angular_velocity_deg_per_s", body.angular_velocity_rad_per_s});
  }
  if (typed.empty()) return;
  const auto velocity_of = [&](const Typed& of) -> Eigen::Vector3d {
    if (!bodies.moves(of.body)) return Eigen::Vector3d::Zero();
    return of.is_angular ? bodies.angular_velocity(of.body)
                         : bodies.velocity_at(of.body, bodies.center_of_mass_m(of.body));
  };
  // The bodies' velocities are linear in those of the joints. Degrees of freedom that move a free
  // body are left out of the fit, so that free bodies keep the velocities they were given.
  const auto moves_free_body = [&] {
    for (std::size_t b = 0; b < joint_of.size(); ++b)
      if (!is_held[b] && bodies.moves(int(b)) &&
          (!bodies.angular_velocity(int(b)).isZero(0) ||
           !bodies.velocity_at(int(b), bodies.center_of_mass_m(int(b))).isZero(0)))
        return true;
    return false;
  };
  const Eigen::VectorXd of_free = bodies.velocity();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3 * Eigen::Index(typed.size()), bodies.velocities());
  Eigen::VectorXd wanted(rows.rows());
  for (std::size_t t = 0; t < typed.size(); ++t)
    wanted.segment<3>(3 * Eigen::Index(t)) = typed[t].velocity - velocity_of(typed[t]);
  for (int dof = 0; dof < bodies.velocities(); ++dof) {
    bodies.set_velocity(Eigen::VectorXd::Unit(bodies.velocities(), dof));
    if (moves_free_body()) continue;
    for (std::size_t t = 0; t < typed.size(); ++t)
      rows.block<3, 1>(3 * Eigen::Index(t), dof) = velocity_of(typed[t]);
  }
  using Solver = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;
  const Eigen::MatrixXd loops = loop_equations(bodies);
  Eigen::MatrixXd allowed = Eigen::MatrixXd::Identity(bodies.velocities(), bodies.velocities());
  if (loops.rows() > 0) allowed -= Solver(loops).pseudoInverse() * loops;
  const Eigen::VectorXd start = allowed * of_free;
  wanted += rows * (of_free - start);
  scene_.start_velocity = start + allowed * Solver(rows * allowed).solve(wanted);
  bodies.set_velocity(scene_.start_velocity);
  for (const Typed& of : typed) {
    // Typed velocities are rounded and need not match exactly.
    constexpr double kRounding = 1e-3, kLeast = 1e-9;
    const double unit = of.is_angular ? kDegree : kMillimetre;
    const Eigen::Vector3d nearest = velocity_of(of);
    if ((nearest - of.velocity).norm() <= kRounding * of.velocity.norm() + kLeast) continue;
    const int joint = joint_of[std::size_t(of.body)];
    std::string held = joint < 0 ? "" : "joint \"" + scene_.joints[std::size_t(joint)].name + "\"";
    if (loops.rows() > 0) held += held.empty() ? "its loops" : " and the loops";
    reader_.refuse(
        *of.node, of.key,
        fmt::format("what {} let{} body \"{}\" do; nearest to what is typed "
                    "comes [{:.4g}, {:.4g}, {:.4g}]",
                    held, loops.rows() > 0 ? "" : "s", scene_.bodies[std::size_t(of.body)].name,
                    nearest.x() / unit, nearest.y() / unit, nearest.z() / unit));
  }
}

void SceneReader::read() {
  reader_.check_keys(root_, "",
                     {"id", "question", "simulation", "layer", "body", "joint", "loop", "motor",
                      "force", "contact"});
  scene_.id = reader_.id(root_);
  if (const toml::node* question = root_.get("question"))
    scene_.question = reader_.text(*question, "question");
  read_simulation();
  read_layers();
  read_bodies();
  if (scene_.duration_s / scene_.time_step_s * double(scene_.bodies.size()) > kMostRecordedPoses)
    reader_.refuse(*root_["simulation"].as_table()->get("duration_s"), "duration_s",
                   fmt::format("steps times bodies of at most {:.0f}", kMostRecordedPoses));
  read_joints();
  read_leaders();
  read_loops();
  read_motors();
  read_forces();
  read_rules();
  // Joints in a ring, second parents and loops that hold nothing are found when the bodies are
  // built.
  try {
    Multibody(scene_.descriptions, scene_.joints, scene_.loops);
  } catch (const InputError& error) {
    std::string where = scene_.file.string();
    for (std::size_t j = 0; j < scene_.joints.size(); ++j)
      if (error.where() == "joint \"" + scene_.joints[j].name + "\"")
        where = reader_.where(*joint_tables_[j]);
    for (std::size_t l = 0; l < scene_.loops.size(); ++l)
      if (error.where() == "loop \"" + scene_.loops[l].name + "\"")
        where = reader_.where(*loop_tables_[l]);
    throw InputError(where, error.where() + ": " + error.field(), error.value(), error.allowed());
  }
  start_joints(Multibody(scene_.descriptions, scene_.joints, scene_.loops));
}

}  // namespace

namespace {

/// The interval between two of the times that holds `time_s`, and how far into it, 0 to 1.
std::pair<Eigen::Index, double> find_interval(const std::vector<double>& times, double time_s) {
  const auto next = std::upper_bound(times.begin(), times.end(), time_s);
  const Eigen::Index i = next - times.begin();
  if (i == 0) return {0, 0};
  if (next == times.end()) return {Eigen::Index(times.size()) - 1, 0};
  const double before = times[std::size_t(i) - 1];
  return {i - 1, (time_s - before) / (*next - before)};
}

}  // namespace

Eigen::VectorXd TimeTable::value(double time) const {
  const auto [i, part] = find_interval(time_s, time);
  if (part == 0) return values.row(i).transpose();
  // Eased by 10 x³ - 15 x⁴ + 6 x⁵: velocity and acceleration vanish at both ends.
  const double x = smooth ? part * part * part * (10 + part * (6 * part - 15)) : part;
  return ((1 - x) * values.row(i) + x * values.row(i + 1)).transpose();
}

Eigen::VectorXd TimeTable::rate(double time) const {
  const auto [i, part] = find_interval(time_s, time);
  if (part == 0) return Eigen::VectorXd::Zero(values.cols());
  const double span = time_s[std::size_t(i) + 1] - time_s[std::size_t(i)];
  const double slope = smooth ? 30 * part * part * (1 - part) * (1 - part) : 1;
  return (slope / span * (values.row(i + 1) - values.row(i))).transpose();
}

int Scene::steps() const { return int(std::lround(std::max(1., duration_s / time_step_s))); }

Scene parse_scene(const std::string& text, const fs::path& file, const Settings& settings) {
  Scene scene;
  scene.file = file;
  const toml::table root = parse_toml(text, file.string(), settings);
  scene.text = text_of(root, text, settings);
  SceneReader(root, file, scene).read();
  for (const std::string& line : unusual_values(scene)) scene.remarks.push_back(line);
  return scene;
}

bool is_scene(const fs::path& file) {
  return parse_toml(read_typed_text(file), name_of_typed(file).string()).contains("simulation");
}

Scene read_scene(const fs::path& file, const Settings& settings) {
  return parse_scene(read_typed_text(file), name_of_typed(file), settings);
}

}  // namespace softfinger::input
