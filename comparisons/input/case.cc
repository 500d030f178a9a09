#include "comparisons/input/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "comparisons/input/case_table.h"
#include "comparisons/input/doubted_numbers.h"
#include "comparisons/input/pad_reader.h"
#include "comparisons/input/time_reader.h"
#include "comparisons/input/toml_reader.h"
#include "comparisons/input/unusual_values.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/nearest_name.h"
#include "meshes/io/mesh_formats.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostLoads = 1000, kMostSublayers = 100, kMostMeasuredRadii = 1000;

double checked_radius(const TomlReader& reader, const toml::node& node, const std::string& field,
                      double radius_mm) {
  const double radius_m = radius_mm * kMillimetre;
  if (radius_m == 0)
    reader.refuse(node, field, "radii other than 0 (inf = flat, negative = concave)");
  return radius_m;
}

void read_finger_shape(const TomlReader& reader, const toml::table& table, QuadricBody& quadric) {
  if (const toml::node* shape = table.get("shape")) {
    quadric.shape_typed = true;
    const std::string chosen =
        reader.choice(*shape, "finger.shape", {"paraboloid", "ellipsoid", "tapered"});
    if (chosen == "ellipsoid") quadric.shape = FingerShape::ellipsoid;
    if (chosen == "tapered") quadric.shape = FingerShape::tapered;
  }
  if (const toml::node* taper = table.get("taper_per_mm")) {
    if (quadric.shape != FingerShape::tapered)
      reader.say(*taper, "taper_per_mm belongs to shape = \"tapered\"");
    quadric.taper_per_m =
        reader.number(*taper, "taper_per_mm", "a finite number per mm") / kMillimetre;
  }
}

CaseBody read_body(const TomlReader& reader, const toml::node& node, const std::string& name,
                   const fs::path& folder) {
  if (!node.is_table())
    reader.refuse(node, name,
                  "{ radii_mm = [..] }, { mesh = \"..\", .. } or { sphere_radius_mm = .. }");
  const toml::table& table = *node.as_table();
  reader.check_keys(table, name,
                    {"radii_mm", "sphere_radius_mm", "mesh", "part", "unit", "point_mm", "near_mm",
                     "normal", "along", "core", "shape", "taper_per_mm"});
  const int forms = static_cast<int>(table.contains("radii_mm")) +
                    static_cast<int>(table.contains("sphere_radius_mm")) +
                    static_cast<int>(table.contains("mesh"));
  if (forms != 1) reader.say(node, name + " needs exactly one of radii_mm, sphere_radius_mm, mesh");
  if (!table.contains("mesh"))
    for (const char* key : {"part", "unit", "point_mm", "near_mm", "normal", "along", "core"})
      if (const toml::node* entry = table.get(key))
        reader.say(*entry,
                   fmt::format("{}.{} belongs to a mesh, and {} has none", name, key, name));

  for (const char* key : {"shape", "taper_per_mm"})
    if (const toml::node* entry = table.get(key))
      if (name != "finger" || !table.contains("radii_mm"))
        reader.say(*entry, fmt::format("{} is for a finger with radii_mm", key));

  if (const toml::node* entry = table.get("radii_mm")) {
    const std::string field = name + ".radii_mm";
    const auto radii = reader.numbers(
        *entry, field, 2, "two radii in mm, along x and y (inf = flat, negative = concave)", true);
    QuadricBody quadric{checked_radius(reader, *entry, field, radii[0]),
                        checked_radius(reader, *entry, field, radii[1])};
    read_finger_shape(reader, table, quadric);
    return quadric;
  }
  if (const toml::node* entry = table.get("sphere_radius_mm")) {
    if (name == "finger")
      reader.say(*entry, "sphere_radius_mm is for the object; a finger has radii_mm");
    return SphereBody{reader.positive(*entry, name + ".sphere_radius_mm", kMillimetre)};
  }
  MeshBody mesh;
  const toml::node& file = *table.get("mesh");
  const std::string typed = reader.text(file, name + ".mesh");
  const std::string a_path = std::string("the path of a file in ") + meshes::kMeshFormats;
  if (typed.empty()) reader.refuse(file, name + ".mesh", a_path);
  mesh.path = system::find_mesh_file(typed, folder);
  mesh.typed = typed;
  mesh.where = reader.where(file);
  const auto part_of = [&](const toml::table& entries, const std::string& field) -> std::string {
    const toml::node* part = entries.get("part");
    if (!part) return "";
    const std::string typed_part = reader.text(*part, field);
    if (typed_part.empty()) reader.refuse(*part, field, "the name of a part of the mesh's file");
    return typed_part;
  };
  mesh.part = part_of(table, name + ".part");
  if (const toml::node* unit = table.get("unit"))
    mesh.metres_per_unit = reader.choice(*unit, name + ".unit", {"mm", "m"}) == "mm" ? 1e-3 : 1;
  const auto point = [&](const toml::node& entry, const std::string& key) -> Eigen::Vector3d {
    const auto xyz = reader.numbers(entry, name + "." + key, 3, "three finite numbers in mm");
    return kMillimetre * Eigen::Vector3d(xyz[0], xyz[1], xyz[2]);
  };
  const auto refuse_beside = [&](const char* chosen, std::initializer_list<const char*> others) {
    for (const char* key : others)
      if (const toml::node* entry = table.get(key))
        reader.say(*entry,
                   fmt::format("{0}.{1} and {0}.{2} say the same: one of them", name, key, chosen));
  };
  if (const toml::node* along = table.get("along")) {
    refuse_beside("along", {"point_mm", "near_mm", "normal"});
    mesh.along = axis_direction(reader.choice(*along, name + ".along",
                                              {"+x", "-x", "+y", "-y", "+z", "-z", "x", "y", "z"}));
  } else if (const toml::node* near = table.get("near_mm")) {
    refuse_beside("near_mm", {"point_mm"});
    mesh.near_m = point(*near, "near_mm");
  } else if (const toml::node* exact = table.get("point_mm")) {
    mesh.point_m = point(*exact, "point_mm");
  } else {
    reader.say(node, fmt::format("{} has no near_mm = [x, y, z], and no along = \"-y\" or "
                                 "point_mm in its place; see: softfinger mesh",
                                 name));
  }
  if (const toml::node* entry = table.get("normal")) {
    const std::string allowed = "three finite numbers, not all 0: the direction out of the body";
    const auto normal = reader.numbers(*entry, name + ".normal", 3, allowed);
    mesh.normal = Eigen::Vector3d(normal[0], normal[1], normal[2]);
    if (!(mesh.normal->norm() > 0)) reader.refuse(*entry, name + ".normal", allowed);
    mesh.normal->normalize();
  }
  if (const toml::node* entry = table.get("core")) {
    if (name != "finger") reader.say(*entry, "an object has no core: it is rigid");
    if (!entry->is_table()) reader.refuse(*entry, name + ".core", "{ mesh = \"..\" }");
    reader.check_keys(*entry->as_table(), name + ".core", {"mesh", "part"});
    const toml::node& core = reader.required(*entry->as_table(), name + ".core", "mesh");
    const std::string typed_core = reader.text(core, name + ".core.mesh");
    if (typed_core.empty()) reader.refuse(core, name + ".core.mesh", a_path);
    mesh.core = system::find_mesh_file(typed_core, folder);
    mesh.core_part = part_of(*entry->as_table(), name + ".core.part");
  }
  return mesh;
}

decltype(Case::geometry) read_geometry(const TomlReader& reader, const toml::table& table,
                                       const fs::path& folder) {
  reader.check_keys(table, "[geometry]", {"relative_radii_mm", "finger", "object", "angle_deg"});
  const bool relative = table.contains("relative_radii_mm");
  const bool bodies = table.contains("finger") || table.contains("object");
  if (relative == bodies)
    reader.say(table, "[geometry] needs exactly one form: relative_radii_mm, or finger and object");
  if (relative) {
    const toml::node& node = *table.get("relative_radii_mm");
    if (const toml::node* angle = table.get("angle_deg"))
      reader.say(*angle, "angle_deg turns an object against a finger; relative_radii_mm has none");
    const std::string field = "relative_radii_mm";
    const auto radii = reader.numbers(node, field, 2, "two radii in mm, R' and R''", true);
    for (double radius_mm : radii) {
      if (std::isinf(radius_mm))
        reader.say(
            node, "relative_radii_mm = " + as_typed(node) +
                      ": no contact ellipse: a flat direction makes a line or plane contact. "
                      "A line needs its length: finger = { roller_radius_mm = 14, length_mm = 28 } "
                      "on object = { flat = true }");
      if (radius_mm < 0)
        reader.say(node, "relative_radii_mm = " + as_typed(node) +
                             (radii[0] < 0 && radii[1] < 0
                                  ? ": no contact ellipse: two negative relative radii make a gap "
                                    "that opens nowhere, the bodies would interpenetrate all round"
                                  : ": no contact ellipse: a negative relative radius makes a "
                                    "saddle gap"));
      if (!(radius_mm * kMillimetre > 0)) reader.refuse(node, field, "finite numbers > 0");
    }
    RelativeRadii result;
    result.major_m = kMillimetre * std::max(radii[0], radii[1]);
    result.minor_m = kMillimetre * std::min(radii[0], radii[1]);
    // The first radius is the one along x: if it is the smaller one, the long axis lies along y.
    result.axis_rad = radii[0] < radii[1] ? 90 * kDegree : 0;
    return result;
  }
  BodyPair pair;
  pair.finger = read_body(reader, reader.required(table, "[geometry]", "finger"), "finger", folder);
  if (!table.contains("object"))
    reader.say(table,
               "[geometry] has no object: a plane is object = { radii_mm = [inf, inf] }, a "
               "ball object = { sphere_radius_mm = 20 }");
  pair.object = read_body(reader, *table.get("object"), "object", folder);
  if (const toml::node* angle = table.get("angle_deg"))
    pair.angle_rad = kDegree * reader.number(*angle, "angle_deg", "a finite number of degrees");
  return pair;
}

void read_winkler_modulus(const TomlReader& reader, const toml::table& table, Case& result) {
  if (const toml::node* node = table.get("winkler_modulus"))
    result.options.winkler_modulus =
        reader.choice(*node, "winkler_modulus", {"oedometric", "youngs"}) == "youngs"
            ? WinklerModulus::youngs
            : WinklerModulus::oedometric;
}

std::vector<std::string> with_material_keys(std::vector<std::string> keys) {
  keys.insert(keys.end(), {"material", "volumetric", "mooney_rivlin_share", "yeoh_ratios"});
  return keys;
}

/// The tables of [[layer]], or none where there is only one layer.
std::vector<const toml::table*> sublayer_tables(const TomlReader& reader, const toml::table& root) {
  std::vector<const toml::table*> tables;
  const toml::array* list = root["layer"].as_array();
  if (!list || !list->is_array_of_tables()) return {};
  reader.list(*list, "[[layer]]", kMostSublayers, "tables");
  for (const toml::node& entry : *list) tables.push_back(entry.as_table());
  return tables;
}

/// [[layer]], from the surface inwards.
void read_sublayers(const TomlReader& reader, const std::vector<const toml::table*>& tables,
                    Case& result) {
  double compliance = 0, poisson = 0;
  for (const toml::table* table : tables) {
    if (const toml::node* relaxation = table->get("relaxation"))
      reader.say(*relaxation,
                 "relaxation is for one [layer]: sublayers that relax differently have no common "
                 "modulus");
    reader.check_keys(
        *table, "[[layer]]",
        with_material_keys({"name", "thickness_mm", "youngs_modulus_kPa", "poisson_ratio"}));
    Sublayer sublayer;
    if (const toml::node* name = table->get("name")) {
      sublayer.name = reader.name(*name, "name");
      for (const Sublayer& other : result.sublayers)
        if (other.name == sublayer.name) reader.refuse(*name, "name", "each name once");
    }
    sublayer.layer = reader.elastic_layer(*table, "[[layer]]");
    result.layer.thickness_m += sublayer.layer.thickness_m;
    compliance += sublayer.layer.thickness_m / sublayer.layer.youngs_modulus_Pa;
    poisson += sublayer.layer.thickness_m * sublayer.layer.poisson_ratio;
    result.sublayers.push_back(sublayer);
  }
  result.layer.youngs_modulus_Pa = result.layer.thickness_m / compliance;
  result.layer.poisson_ratio = poisson / result.layer.thickness_m;
}

/// [layer] on the finger, [object_layer] on the object; at least one of them.
void read_layers(const TomlReader& reader, const toml::table& root, Case& result) {
  const toml::node* on_object = root.get("object_layer");
  result.layer_on_object = on_object && !root.contains("layer");
  if (const auto tables = sublayer_tables(reader, root); !tables.empty()) {
    read_sublayers(reader, tables, result);
  } else if (!result.layer_on_object) {
    const toml::table& table = reader.required_table(root, "layer");
    reader.check_keys(table, "[layer]",
                      with_material_keys({"thickness_mm", "youngs_modulus_kPa", "poisson_ratio",
                                          "winkler_modulus", "relaxation"}));
    result.layer = reader.elastic_layer(table, "[layer]");
    result.times.relaxation = read_relaxation(reader, table);
    if (const toml::node* relaxation = table.get("relaxation"))
      result.times.where = reader.where(*relaxation);
    read_winkler_modulus(reader, table, result);
  }
  if (!on_object) return;
  const toml::table& table = reader.required_table(root, "object_layer");
  std::vector<std::string> keys = {"thickness_mm", "youngs_modulus_kPa", "poisson_ratio"};
  // One choice for both layers; if there is a [layer], it has to be written there.
  if (result.layer_on_object) keys.push_back("winkler_modulus");
  reader.check_keys(table, "[object_layer]", keys);
  (result.layer_on_object ? result.layer : result.object_layer) =
      reader.elastic_layer(table, "[object_layer]");
  if (result.layer_on_object) read_winkler_modulus(reader, table, result);
}

void read_power_law(const TomlReader& reader, const toml::node& node, Case& result) {
  if (!node.is_table()) reader.refuse(node, "power_law", "a table");
  const toml::table& table = *node.as_table();
  reader.check_keys(table, "[power_law]",
                    {"radius_coefficient_mm", "radius_exponent", "pressure_exponent", "data"});
  PowerLaw& law = result.options.power_law;
  if (const toml::node* exponent = table.get("pressure_exponent")) {
    const std::string allowed = "a finite number >= 1 (2: as Hertz, larger: flatter)";
    law.pressure_exponent = reader.number(*exponent, "pressure_exponent", allowed);
    if (law.pressure_exponent < 1) reader.refuse(*exponent, "pressure_exponent", allowed);
  }
  if (const toml::node* data = table.get("data")) {
    for (const char* key : {"radius_coefficient_mm", "radius_exponent"})
      if (const toml::node* entry = table.get(key))
        reader.say(*entry, std::string(key) +
                               " is fitted when [power_law] has data: give one of "
                               "the two");
    const std::string allowed = "a list of measured [load_N, radius_mm], all > 0";
    std::vector<LoadAndRadius> points;
    for (const toml::node& row : reader.list(*data, "data", kMostMeasuredRadii, allowed)) {
      const auto pair = reader.numbers(row, "data", 2, allowed);
      points.push_back({pair[0], pair[1] * kMillimetre});
      if (!(points.back().load_N > 0 && points.back().radius_m > 0))
        reader.refuse(row, "data", allowed);
    }
    try {
      result.power_law_fit = fit_power_law(points, law.pressure_exponent);
    } catch (const InputError& error) {
      throw InputError(reader.where(*data), "data: " + error.field(), error.value(),
                       error.allowed());
    }
    law = result.power_law_fit->law;
    return;
  }
  law.radius_coefficient =
      reader.positive(reader.required(table, "[power_law]", "radius_coefficient_mm"),
                      "radius_coefficient_mm", kMillimetre);
  const toml::node& exponent = reader.required(table, "[power_law]", "radius_exponent");
  const std::string allowed = "a number between 0 and 1 (linear elastic: 1/3 and less)";
  law.radius_exponent = reader.number(exponent, "radius_exponent", allowed);
  if (!(law.radius_exponent > 0 && law.radius_exponent < 1))
    reader.refuse(exponent, "radius_exponent", allowed);
}

void read_contact(const TomlReader& reader, const toml::table& table, Case& result) {
  reader.check_keys(table, "[contact]",
                    {"load_N", "history", "friction_coefficient", "shear_law", "shear_strength_kPa",
                     "pressing", "load_at_mm"});
  if (const toml::node* history = table.get("history")) {
    if (const toml::node* load = table.get("load_N"))
      reader.say(*load, "[contact] load_N and history say the same: one of them");
    read_history(reader, *history, result);
    result.shear_law = reader.shear_law(table, "[contact]");
    return;
  }
  const toml::node& load = reader.required(table, "[contact]", "load_N");
  if (load.is_array()) {
    const std::string allowed = "a number > 0 or a list of them";
    const toml::array& list = reader.list(load, "load_N", kMostLoads, allowed);
    if (list.empty()) reader.refuse(load, "load_N", allowed);
    std::set<double> known;
    for (const toml::node& entry : list) {
      const double load_N = reader.positive(entry, "load_N", 1);
      if (!known.insert(load_N).second) reader.refuse(entry, "load_N", "each load once");
      result.loads_N.push_back(load_N);
    }
  } else {
    result.loads_N.push_back(reader.positive(load, "load_N", 1));
  }
  result.shear_law = reader.shear_law(table, "[contact]");
}

/// Rubber sticks while it is pressed: the default wherever friction is a coefficient. How a contact
/// that creeps is rubbed is not known. Of two soft bodies that are alike nothing rubs.
/// @pre the layers are read
void read_pressing(const TomlReader& reader, const toml::table& table, Case& result) {
  const bool is_coulomb = result.shear_law.kind == ShearLaw::Kind::coulomb;
  const toml::node* pressing = table.get("pressing");
  if (!pressing) {
    if (is_coulomb && !result.times.are_given() && !(result.object_layer.thickness_m > 0))
      result.pressing = PressingFriction::coulomb;
    return;
  }
  const std::string typed = reader.choice(
      *pressing, "pressing", {kPressingFrictionNames.begin(), kPressingFrictionNames.end()});
  result.pressing = PressingFriction(
      std::find(kPressingFrictionNames.begin(), kPressingFrictionNames.end(), typed) -
      kPressingFrictionNames.begin());
  if (result.pressing != PressingFriction::none && !is_coulomb)
    reader.refuse(*pressing, "pressing", "\"frictionless\" with another shear law than Coulomb's");
  if (result.pressing != PressingFriction::none && result.times.are_given())
    reader.refuse(*pressing, "pressing", "\"frictionless\" with relaxation or history");
}

void read_fem(const TomlReader& reader, const toml::node& node, Case& result) {
  if (!node.is_table()) reader.refuse(node, "fem", "a table");
  const toml::table& table = *node.as_table();
  reader.check_keys(table, "[fem]", {"level", "geometry", "kinematics", "mesh", "mesh_unit"});
  if (const toml::node* level = table.get("level"))
    result.fem_level = reader.integer(*level, "level", 1, 3, "1, 2 or 3");
  result.fem_geometry_typed = table.contains("geometry");
  result.fem_kinematics_typed = table.contains("kinematics");
  if (const toml::node* geometry = table.get("geometry"))
    if (reader.choice(*geometry, "geometry", {"flat", "curved"}) == "curved") {
      if (!std::holds_alternative<BodyPair>(result.geometry))
        reader.refuse(*geometry, "geometry",
                      "\"flat\" with relative_radii_mm; a curved layer needs finger and object");
      if (result.layer_on_object)
        reader.refuse(*geometry, "geometry",
                      "\"flat\" with [object_layer]: the curved layer is the finger's");
      result.fem_curved = true;
    }
  if (const toml::node* mesh = table.get("mesh")) {
    const std::string typed = reader.text(*mesh, "mesh");
    if (typed.empty()) reader.refuse(*mesh, "mesh", "the name of a gmsh file (.msh) of the layer");
    if (result.fem_curved)
      reader.refuse(*mesh, "mesh", "geometry = \"flat\": the mesh is the layer, curved or not");
    result.fem_mesh = system::find_mesh_file(typed, result.file.parent_path());
  }
  if (const toml::node* unit = table.get("mesh_unit"))
    result.fem_mesh_metres_per_unit =
        reader.choice(*unit, "mesh_unit", {"mm", "m"}) == "mm" ? 1e-3 : 1;
  if (const toml::node* kinematics = table.get("kinematics"))
    if (reader.choice(*kinematics, "kinematics", {"linear", "finite"}) == "finite")
      result.fem_finite = FiniteStrain();
}

/// Reads the keys of a layer's table that belong to finite strain.
/// @param name  of the table, as typed
FiniteStrain read_material(const TomlReader& reader, const toml::table& table, const char* name,
                           bool finite) {
  FiniteStrain material;
  if (!finite) {
    for (const char* key : {"material", "volumetric", "mooney_rivlin_share", "yeoh_ratios"})
      if (const toml::node* node = table.get(key))
        reader.refuse(*node, key, "nothing here: it needs [fem] kinematics = \"finite\"");
    return material;
  }
  if (const toml::node* node = table.get("material"))
    material.material = reader.choice(*node, "material", {"neo_hookean", "mooney_rivlin", "yeoh"});
  if (const toml::node* node = table.get("volumetric"))
    material.volumetric = reader.choice(*node, "volumetric", {"quadratic", "logarithmic"});
  const auto require = [&](const char* key, const char* of) {
    const toml::node* node = table.get(key);
    if (node && material.material != of)
      reader.refuse(*node, key, std::string("nothing here: it needs material = \"") + of + "\"");
    return material.material == of ? &reader.required(table, name, key) : nullptr;
  };
  if (const toml::node* node = require("mooney_rivlin_share", "mooney_rivlin"))
    material.mooney_rivlin_share =
        reader.number(*node, "mooney_rivlin_share", "c01/(c10 + c01), 0 to 1");
  if (const toml::node* node = require("yeoh_ratios", "yeoh"))
    material.yeoh_ratios =
        reader.numbers(*node, "yeoh_ratios", 2, "two numbers, c20/c10 and c30/c10");
  return material;
}

void read_materials(const TomlReader& reader, const toml::table& root, Case& result) {
  const auto tables = sublayer_tables(reader, root);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    result.sublayers[i].material =
        read_material(reader, *tables[i], "[[layer]]", result.fem_finite.has_value());
    if (!result.fem_mesh.empty() && result.sublayers[i].name.empty())
      reader.say(*tables[i], "[[layer]] needs a name: that of its volume in the mesh of the layer");
  }
  if (result.sublayers.size() == 1 && result.fem_mesh.empty()) {
    if (result.fem_finite) result.fem_finite = result.sublayers[0].material;
    result.sublayers.clear();  // a homogeneous layer after all
  }
  if (!tables.empty() || !root.contains("layer")) return;
  const FiniteStrain material =
      read_material(reader, *root["layer"].as_table(), "[layer]", result.fem_finite.has_value());
  if (result.fem_finite) result.fem_finite = material;
}

/// Refuses what flat pads do not have yet.
void require_plain_pad(const TomlReader& reader, const toml::table& root) {
  const auto refuse = [&](const toml::node& node, const char* what) {
    reader.say(node,
               fmt::format("a flat pad takes no {} yet: one [layer] under a rigid face", what));
  };
  for (const auto& [table, key] : {std::pair("layer", "relaxation"), {"contact", "history"}})
    if (const toml::node* node = root[table][key].node()) refuse(*node, key);
  for (const char* key : {"object_layer", "power_law"})
    if (const toml::node* node = root.get(key))
      refuse(*node, (std::string("[") + key + "]").c_str());
  if (const toml::node* layer = root.get("layer")) {
    if (layer->is_array()) refuse(*layer, "[[layer]]");
    for (const char* key :
         {"winkler_modulus", "material", "volumetric", "mooney_rivlin_share", "yeoh_ratios"})
      if (const toml::node* node = layer->as_table()->get(key)) refuse(*node, key);
  }
  if (const toml::node* fem = root.get("fem"); fem && fem->is_table())
    for (const char* key : {"geometry", "kinematics", "mesh", "mesh_unit"})
      if (const toml::node* node = fem->as_table()->get(key))
        refuse(*node, (std::string("[fem] ") + key).c_str());
  if (const toml::node* law = root["contact"]["shear_law"].node())
    if (reader.text(*law, "shear_law") != "coulomb")
      reader.refuse(*law, "shear_law", "\"coulomb\" for a flat pad");
}

}  // namespace

void refuse_pad(const Case& contact_case, const std::string& command) {
  if (!std::holds_alternative<PadPair>(contact_case.geometry)) return;
  throw InputError(contact_case.geometry_where,
                   command +
                       " does not take flat pads yet: softfinger predict, fem, compare, select, "
                       "sweep, explore and export do",
                   "", "");
}

void refuse_curved_pad(const Case& contact_case, const std::string& command) {
  const auto* pair = std::get_if<PadPair>(&contact_case.geometry);
  if (!pair || !pair->curved) return;
  throw InputError(contact_case.geometry_where,
                   command + " does not take " +
                       (pair->is_roller ? "a roller" : "a curved object on a flat pad") +
                       " yet: softfinger predict and fem do, and compare for a line",
                   "", "");
}

void settle_finger_shape(Case& contact_case) {
  if (!contact_case.fem_finite || !contact_case.fem_curved) return;
  auto* finger = std::get_if<QuadricBody>(&std::get<BodyPair>(contact_case.geometry).finger);
  if (!finger || finger->shape_typed) return;
  // No ellipsoid is flat or hollow.
  const auto bulges = [](double radius_m) { return radius_m > 0 && std::isfinite(radius_m); };
  if (bulges(finger->radius_x_m) && bulges(finger->radius_y_m))
    finger->shape = FingerShape::ellipsoid;
}

Case case_of(const toml::table& typed, const std::string& text, const fs::path& file) {
  const TomlReader reader(file.string());
  if (has_doubts(typed)) {
    toml::table root = typed;
    Doubts doubts = settle_doubts(reader, root);
    Case result = case_of(root, text, file);
    result.doubts = std::move(doubts);
    for (const Doubt& doubt : result.doubts)
      if (result.times.are_given() && (doubt.key.rfind("contact.load_N", 0) == 0 ||
                                       doubt.key.rfind("contact.history", 0) == 0 ||
                                       doubt.key.rfind("layer.relaxation", 0) == 0))
        throw InputError(result.times.where, doubt.key, "a number with its doubt",
                         "a plain number beside relaxation or history");
    return result;
  }
  const toml::table& root = typed;
  reader.check_keys(
      root, "",
      {"id", "question", "geometry", "layer", "object_layer", "power_law", "contact", "fem"});

  Case result;
  result.file = file;
  result.text = text;
  result.id = reader.id(root);
  if (const toml::node* question = root.get("question"))
    result.question = reader.text(*question, "question");

  const toml::table& geometry = reader.required_table(root, "geometry");
  result.geometry_where = reader.where(geometry);
  read_layers(reader, root, result);
  if (const toml::node* law = root.get("power_law")) read_power_law(reader, *law, result);
  const toml::table& contact = reader.required_table(root, "contact");
  read_contact(reader, contact, result);
  check_times(reader, root, result);
  if (is_flat_geometry(geometry)) {
    result.geometry = read_pad_pair(reader, geometry, contact);
    require_plain_pad(reader, root);
    if (const toml::node* fem = root.get("fem")) read_fem(reader, *fem, result);
    result.remarks = unusual_values(result);
    return result;
  }
  read_pressing(reader, contact, result);
  if (const toml::node* node = contact.get("load_at_mm"))
    reader.say(*node, "load_at_mm is for flat pads: finger = { pad_mm = [l, w] }");
  result.geometry = read_geometry(reader, geometry, file.parent_path());
  if (const toml::node* fem = root.get("fem")) read_fem(reader, *fem, result);
  if (const auto core = geometry.at_path("finger.core");
      core && result.fem_geometry_typed && !result.fem_curved)
    reader.say(*core.node(),
               "finger.core needs [fem] geometry = \"curved\": a flat layer has none");
  read_materials(reader, root, result);
  settle_finger_shape(result);
  result.remarks = unusual_values(result);
  return result;
}

Case parse_case(const std::string& text, const fs::path& file, const Settings& settings,
                FlatPads pads, Times times) {
  const toml::table root = parse_toml(text, file.string(), settings);
  Case read = case_of(root, text_of(root, text, settings), file);
  if (pads == FlatPads::refused) refuse_pad(read, "this command");
  if (times == Times::refused) refuse_times(read, "this command");
  read.settings = settings;
  return read;
}

Case with_value(const Case& contact_case, const Doubt& doubt, double value) {
  const Settings setting = {{doubt.key, fmt::format("{}", value), doubt.key}};
  return parse_case(contact_case.text, contact_case.file, setting, FlatPads::taken, Times::taken);
}

std::optional<Eigen::Vector3d> axis_direction(const std::string& typed) {
  const bool is_signed = typed.size() == 2 && (typed[0] == '+' || typed[0] == '-');
  if (!is_signed && typed.size() != 1) return std::nullopt;
  const int axis = typed.back() - 'x';
  if (axis < 0 || axis > 2) return std::nullopt;
  return (typed[0] == '-' ? -1. : 1.) * Eigen::Vector3d::Unit(axis);
}

void require_coulomb(const Case& contact_case, const std::string& command) {
  if (contact_case.shear_law.kind != ShearLaw::Kind::coulomb)
    throw InputError(
        contact_case.file.string(), "shear_law",
        "\"" + std::string(contact_case.shear_law.name()) + "\"",
        "\"coulomb\" for " + command + "; predict, fem, export and simulate take the other laws");
}

Case read_case(const fs::path& file, const Settings& settings, FlatPads pads, Times times) {
  return parse_case(read_typed_text(file), name_of_typed(file), settings, pads, times);
}

}  // namespace softfinger::input
