#include "comparisons/reference/fem_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "comparisons/input/layer_json.h"
#include "comparisons/input/mesh_file.h"
#include "comparisons/text/json_text.h"
#include "meshes/io/input_files.h"
#include "softfinger/input/errors.h"

namespace softfinger::reference {
namespace {

using nlohmann::json;

json list(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

json or_null(const std::optional<double>& value) { return value ? json(*value) : json(); }

/// A hash of a mesh's bytes, as a process reads them.
std::string content_of(const std::filesystem::path& path, const std::string& part) {
  return meshes::content_hash(input::plain_mesh_file(path, part).string());
}

/// A core has the finger's unit, unless its own file says another and nobody told one.
double core_metres_per_unit(const PlacedMesh& mesh) {
  const std::filesystem::path& core = mesh.mesh.core;
  if (mesh.mesh.metres_per_unit || !meshes::is_converted_mesh(core.string()))
    return mesh.metres_per_unit;
  return input::converted_mesh(core, mesh.mesh.core_part)
      .metres_per_unit.value_or(mesh.metres_per_unit);
}

json body_json(const PlacedBody& placed) {
  if (const auto* quadric = std::get_if<input::QuadricBody>(&placed.body)) {
    const char* shape[] = {"paraboloid", "ellipsoid", "tapered"};
    return {
        {"shape", shape[static_cast<int>(quadric->shape)]},
        {"radii_m",
         {text::finite_or_null(quadric->radius_x_m), text::finite_or_null(quadric->radius_y_m)}},
        {"taper_per_m", quadric->taper_per_m},
        {"turn_rad", placed.turn_rad}};
  }
  if (const auto* sphere = std::get_if<input::SphereBody>(&placed.body))
    return {{"shape", "sphere"}, {"radii_m", {sphere->radius_m, sphere->radius_m}}};
  const auto& mesh = std::get<PlacedMesh>(placed.body);
  json object = {{"shape", "mesh"},
                 {"mesh", std::filesystem::absolute(mesh.mesh.path).string()},
                 {"content", content_of(mesh.mesh.path, mesh.mesh.part)},
                 {"metres_per_unit", mesh.metres_per_unit},
                 {"point_m", list(mesh.mesh.point_m)},
                 {"outward_normal", list(mesh.outward_normal)},
                 {"x_axis", list(mesh.x_axis)},
                 {"radii_m", {or_null(mesh.radius_x_m), or_null(mesh.radius_y_m)}},
                 {"turn_rad", placed.turn_rad}};
  if (mesh.region_excess > 0) object["region_excess"] = mesh.region_excess;
  if (!mesh.mesh.part.empty()) object["part"] = mesh.mesh.part;
  if (!mesh.mesh.core.empty()) {
    object["core"] = {{"mesh", std::filesystem::absolute(mesh.mesh.core).string()},
                      {"content", content_of(mesh.mesh.core, mesh.mesh.core_part)},
                      {"metres_per_unit", core_metres_per_unit(mesh)}};
    if (!mesh.mesh.core_part.empty()) object["core"]["part"] = mesh.mesh.core_part;
  }
  return object;
}

/// Names the files that a process reads in place of those that only this one understands.
void add_read_from(const PlacedBody& placed, json& object) {
  const auto* mesh = std::get_if<PlacedMesh>(&placed.body);
  if (!mesh) return;
  const auto add = [](const std::filesystem::path& path, const std::string& part, json& entry) {
    if (meshes::is_converted_mesh(path.string()))
      entry["read_from"] = input::plain_mesh_file(path, part).string();
  };
  add(mesh->mesh.path, mesh->mesh.part, object);
  if (!mesh->mesh.core.empty()) add(mesh->mesh.core, mesh->mesh.core_part, object["core"]);
}

void add_material(const input::FiniteStrain& material, json& layer) {
  layer["material"] = material.material;
  layer["volumetric"] = material.volumetric;
  layer["mooney_rivlin_share"] = material.mooney_rivlin_share;
  if (!material.yeoh_ratios.empty()) layer["yeoh_ratios"] = material.yeoh_ratios;
}

json friction_json(const FrictionRequest& request) {
  json object = {{"torsion", request.torsion},
                 {"increments", request.increments},
                 {"limit_surface", request.limit_surface},
                 {"increments_to_slip", request.increments_to_slip}};
  if (request.twist_axis_m)
    object["twist_axis_m"] = {request.twist_axis_m->x(), request.twist_axis_m->y()};
  return object;
}

json times_json(const FemProblem::InTime& in_time) {
  json object = {{"relaxation", json::array()},
                 {"history", json::array()},
                 {"time_s", text::finite_or_null(in_time.time_s)}};
  for (const RelaxationTerm& term : in_time.relaxation.terms())
    object["relaxation"].push_back({{"share", term.share}, {"time_s", term.time_s}});
  for (const HistoryPoint& point : in_time.points)
    object["history"].push_back({{"time_s", point.time_s}, {"value", point.value}});
  return object;
}

/// @param fit       of a mesh
/// @param point_m   where a mesh is touched
/// @param metres_per_unit  of a mesh's file
/// @param turn_rad  from the x of the relative radii's frame to the body's own
PlacedBody placed_body(const input::CaseBody& body, const std::optional<QuadricFit>& fit,
                       const Eigen::Vector3d& point_m, double metres_per_unit, double turn_rad) {
  if (const auto* quadric = std::get_if<input::QuadricBody>(&body)) {
    input::QuadricBody turned = *quadric;
    // Quarter turns without rounding: they keep the symmetry that saves three quarters of the work.
    const double quarters = turn_rad / (M_PI / 2);
    if (quadric->shape != input::FingerShape::tapered &&
        std::abs(quarters - std::round(quarters)) < 1e-9) {
      if (std::lround(quarters) % 2 != 0) std::swap(turned.radius_x_m, turned.radius_y_m);
      turn_rad = 0;
    }
    return {turned, turn_rad};
  }
  if (const auto* sphere = std::get_if<input::SphereBody>(&body)) return {*sphere, 0};
  // Radii of the surface's sections along the frame's axes: the layer's map starts from a torus.
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  const auto section = [&](double x, double y) -> std::optional<double> {
    const double curvature = 2 * (fit->quadric.A_per_m * x * x + fit->quadric.B_per_m * y * y +
                                  fit->quadric.C_per_m * x * y);
    if (!(curvature > 0)) return std::nullopt;
    return 1 / curvature;
  };
  input::MeshBody mesh = std::get<input::MeshBody>(body);
  mesh.point_m = point_m;
  return {PlacedMesh{std::move(mesh), metres_per_unit, fit->normal, fit->x_axis, section(c, -s),
                     section(s, c)},
          turn_rad};
}

/// The region that a contact asks for is twice as large as the contact.
double region_excess(const ContactPatch& patch) {
  if (patch.agrees || !(patch.region_area_m2 > 0)) return 0;
  return std::max(0., 1 - 2 * patch.predicted_area_m2 / patch.region_area_m2);
}

FemProblem::Bodies placed_bodies(const input::BodyPair& pair,
                                 const prediction::LocalGeometry& geometry, double axis_rad) {
  const std::optional<QuadricFit> none;
  const std::optional<ContactPatch>& patch = geometry.patch;
  FemProblem::Bodies bodies = {
      placed_body(pair.finger, patch ? patch->finger_fit : none, geometry.finger_point_m,
                  geometry.finger_metres_per_unit, -axis_rad),
      placed_body(pair.object, patch ? patch->object_fit : none, geometry.object_point_m,
                  geometry.object_metres_per_unit, pair.angle_rad - axis_rad)};
  if (auto* finger = std::get_if<PlacedMesh>(&bodies.pad.body))
    finger->region_excess = region_excess(*patch);
  return bodies;
}

}  // namespace

json to_json(const FemProblem& problem) {
  json object = {{"name", problem.name},
                 {"radii_m", {problem.radii.major_m, problem.radii.minor_m}},
                 {"axis_rad", problem.radii.axis_rad},
                 {"sphere_radius_m", text::finite_or_null(problem.sphere_radius_m)},
                 {"layer", input::layer_json(problem.layer)},
                 {"load_N", problem.load_N},
                 {"level", problem.level}};
  if (problem.shear_law.has_friction_coefficient())
    object["friction_coefficient"] = problem.shear_law.friction_coefficient;
  if (problem.shear_law.has_shear_strength()) {
    object["shear_law"] = problem.shear_law.name();
    object["shear_strength_Pa"] = problem.shear_law.shear_strength_Pa;
  }
  if (problem.pressing != PressingFriction::none) object["pressing"] = name_of(problem.pressing);
  if (problem.approach_m) object["approach_m"] = *problem.approach_m;
  if (problem.in_time) object["in_time"] = times_json(*problem.in_time);
  if (problem.finite_strain) {
    object["kinematics"] = "finite";
    add_material(*problem.finite_strain, object["layer"]);
  }
  for (const input::Sublayer& sublayer : problem.sublayers) {
    json entry = input::layer_json(sublayer.layer);
    entry["name"] = sublayer.name;
    if (problem.finite_strain) add_material(sublayer.material, entry);
    object["layer"]["sublayers"].push_back(entry);
  }
  if (problem.object_layer.thickness_m > 0)
    object["object_layer"] = input::layer_json(problem.object_layer);
  if (problem.layer_mesh)
    object["layer_mesh"] = {{"mesh", problem.layer_mesh->file.string()},
                            {"metres_per_unit", problem.layer_mesh->metres_per_unit},
                            {"content", problem.layer_mesh->content}};
  if (problem.bodies)
    object["fingertip"] = {{"pad", body_json(problem.bodies->pad)},
                           {"object", body_json(problem.bodies->object)}};
  if (problem.friction) object["friction"] = friction_json(*problem.friction);
  if (problem.lists_forces) object["lists_forces"] = true;
  if (!problem.compliance_file.empty())
    object["compliance_file"] = problem.compliance_file.string();
  if (!problem.output_directory.empty())
    object["output_directory"] = problem.output_directory.string();
  return object;
}

json process_input(const FemProblem& problem) {
  json object = to_json(problem);
  if (!problem.bodies) return object;
  add_read_from(problem.bodies->pad, object["fingertip"]["pad"]);
  add_read_from(problem.bodies->object, object["fingertip"]["object"]);
  return object;
}

namespace {

/// @throws InputError where finite elements cannot solve a case with layers on both bodies
void check_two_layers(const input::Case& contact_case) {
  const auto refuse = [&](const char* field, const char* value, const char* allowed) {
    throw InputError(contact_case.file.string(), field, value, allowed);
  };
  if (contact_case.fem_curved)
    refuse("[fem] geometry", "\"curved\"",
           "\"flat\" with [layer] and [object_layer]: finite elements of two layers are flat");
  if (contact_case.fem_finite)
    refuse(
        "[fem] kinematics", "\"finite\"",
        "\"linear\" with [layer] and [object_layer]: two layers are solved in linear elasticity");
  if (!contact_case.fem_mesh.empty())
    refuse("[fem] mesh", "given", "none with [layer] and [object_layer]");
}

}  // namespace

FemProblem fem_problem(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                       double load_N, int level) {
  const bool has_object_layer = contact_case.object_layer.thickness_m > 0;
  if (has_object_layer) check_two_layers(contact_case);
  FemProblem problem;
  problem.name = contact_case.id;
  problem.radii = geometry.radii;
  // A layer on the sphere, too, is taken for flat: the gap is then that of the paraboloid.
  if (!has_object_layer) problem.sphere_radius_m = geometry.sphere_radius_m;
  problem.layer = contact_case.layer;
  problem.object_layer = contact_case.object_layer;
  problem.sublayers = contact_case.sublayers;
  problem.finite_strain = contact_case.fem_finite;
  problem.load_N = load_N;
  problem.shear_law = contact_case.shear_law;
  problem.pressing = contact_case.pressing;
  problem.level = level;
  if (!contact_case.fem_mesh.empty())
    problem.layer_mesh = {std::filesystem::absolute(contact_case.fem_mesh),
                          contact_case.fem_mesh_metres_per_unit,
                          meshes::content_hash(contact_case.fem_mesh.string())};
  if (contact_case.fem_curved) {
    const auto& pair = std::get<input::BodyPair>(contact_case.geometry);
    // A tapered finger tapers along its own x, wherever the contact's long axis lies.
    const auto* finger = std::get_if<input::QuadricBody>(&pair.finger);
    if (finger && finger->shape == input::FingerShape::tapered) problem.radii.axis_rad = 0;
    problem.bodies = placed_bodies(pair, geometry, problem.radii.axis_rad);
  }
  return problem;
}

}  // namespace softfinger::reference
