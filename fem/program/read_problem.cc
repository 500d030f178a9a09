#include "fem/program/read_problem.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include "fem/program/json_entry.h"
#include "meshes/generation/layer_mesh.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "meshes/io/input_files.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/nesting.h"

namespace softfinger::fem {
namespace {

using nlohmann::json;

/// The solver refuses sublayers thinner than 2 % of all of them.
constexpr std::size_t kMostSublayers = 50;

/// The file to read a mesh from: an STL of it, where it is in a format that is not read here.
std::string file_of(const Entry& body) {
  const auto stl = body.find("read_from");
  return (stl ? *stl : body.at("mesh")).text();
}

/// Refuses a mesh that has changed since the problem was made: results are kept by the content that
/// the problem names.
void check_content(const Entry& body) {
  const auto content = body.find("content");
  if (!content) return;
  const std::string read = meshes::content_hash(file_of(body));
  if (!read.empty() && content->text() != read)
    throw InputError(body.at("mesh").text(), "was changed while the command ran", "",
                     "run the command again");
}

TriangleSurface read_mesh(const Entry& body, const MeshReaders& readers) {
  TriangleSurface surface = readers.surface(file_of(body), body.at("metres_per_unit").positive());
  check_content(body);
  return surface;
}

double turn_of(const Entry& body) {
  const auto turn_rad = body.find("turn_rad");
  return turn_rad ? turn_rad->finite() : 0;
}

meshes::SurfacePlacement placement(const Entry& body) {
  return {body.at("point_m").vector(), body.at("outward_normal").direction(),
          body.at("x_axis").direction(), turn_of(body)};
}

/// Bodies in the contact's frame; a body is turned by `turn_rad` about z from its own.
Fingertip read_fingertip(const Entry& input, const MeshReaders& readers) {
  Fingertip fingertip;
  {
    const Entry pad = input.at("pad");
    const std::string shape =
        pad.at("shape").choice({"paraboloid", "ellipsoid", "sphere", "tapered", "mesh"});
    // An entry that describes only the frame's error makes no other pad.
    fingertip.pad_name = pad.dump_without("region_excess");
    const std::vector<Entry> radii = pad.at("radii_m").list(2, 2);
    const double x = radii[0].radius(), y = radii[1].radius(), turn_rad = turn_of(pad);
    if (shape == "paraboloid") {
      fingertip.pad = meshes::paraboloid_pad(x, y, turn_rad);
    } else if (shape == "ellipsoid") {
      fingertip.pad = meshes::ellipsoid_pad(x, y, std::nullopt, turn_rad);
    } else if (shape == "sphere") {
      fingertip.pad = meshes::sphere_pad(x);
    } else if (shape == "mesh") {
      const meshes::PlacedSurface placed(read_mesh(pad, readers), placement(pad),
                                         meshes::PlacedSurface::Body::below);
      fingertip.scan = std::make_shared<const TriangleSurface>(placed.in_contact_frame());
      if (const auto excess = pad.find("region_excess"))
        fingertip.region_excess = excess->number(0, 1, "a number from 0 to 1");
      if (const auto core = pad.find("core"))
        fingertip.core = std::make_shared<const TriangleSurface>(
            placed.in_contact_frame(read_mesh(*core, readers)));
    } else {
      if (!(std::abs(turn_rad) < 1e-9))
        pad.at("turn_rad").refuse("0: a finger tapers along the contact's long axis");
      const auto taper_per_m = pad.find("taper_per_m");
      fingertip.pad = meshes::tapered_pad(x, y, taper_per_m ? taper_per_m->finite() : 0);
    }
  }
  const Entry object = input.at("object");
  const std::string shape = object.at("shape").choice({"paraboloid", "sphere", "cylinder", "mesh"});
  const std::vector<Entry> radii = object.at("radii_m").list(2, 2);
  const double x = radii[0].radius(), y = radii[1].radius(), turn_rad = turn_of(object);
  const bool is_round = shape == "sphere" || (shape == "paraboloid" && x == y);
  fingertip.symmetric_object = shape != "mesh" && (turn_rad == 0 || is_round);
  if (shape == "paraboloid")
    fingertip.object = meshes::quadric_object(x, y, turn_rad);
  else if (shape == "sphere")
    fingertip.object = meshes::sphere_object(x);
  else if (shape == "cylinder")
    fingertip.object = meshes::cylinder_object(x, turn_rad);
  else
    fingertip.object = meshes::triangulated_object(read_mesh(object, readers), placement(object));
  return fingertip;
}

ElasticLayer read_layer(const Entry& layer) {
  return {layer.at("thickness_m").positive(), layer.at("youngs_modulus_Pa").positive(),
          layer.at("poisson_ratio").number(0, 0.5, "a number from 0 to 0.5")};
}

MaterialChoice read_material(const Entry& layer) {
  MaterialChoice choice;
  if (const auto material = layer.find("material")) {
    const std::string name =
        material->choice({name_of(MaterialName::neo_hookean), name_of(MaterialName::mooney_rivlin),
                          name_of(MaterialName::yeoh)});
    for (const MaterialName known : {MaterialName::mooney_rivlin, MaterialName::yeoh})
      if (name == name_of(known)) choice.name = known;
  }
  if (const auto volumetric = layer.find("volumetric"))
    if (volumetric->choice(
            {name_of(VolumetricLaw::quadratic), name_of(VolumetricLaw::logarithmic)}) ==
        name_of(VolumetricLaw::logarithmic))
      choice.volumetric = VolumetricLaw::logarithmic;
  if (const auto share = layer.find("mooney_rivlin_share"))
    choice.mooney_rivlin_share = share->number(0, 1, "a number from 0 to 1");
  if (const auto ratios = layer.find("yeoh_ratios")) {
    const std::vector<Entry> both = ratios->list(2, 2);
    choice.yeoh_second = both[0].finite();
    choice.yeoh_third = both[1].finite();
  }
  return choice;
}

FrictionRequest read_friction(const Entry& input) {
  FrictionRequest request;
  if (const auto torsion = input.find("torsion")) request.torsion = torsion->flag();
  if (const auto increments = input.find("increments"))
    request.increments = increments->whole(1, 1000);
  if (const auto points = input.find("limit_surface"))
    request.limit_surface = points->whole(0, 10000);
  if (const auto states = input.find("increments_to_slip"))
    request.increments_to_slip = states->whole(0, 1000);
  if (const auto axis = input.find("twist_axis_m")) {
    const std::vector<Entry> both = axis->list(2, 2);
    request.twist_axis_x_m = both[0].finite();
    request.twist_axis_y_m = both[1].finite();
  }
  return request;
}

/// The models get the thickness that is typed, the finite elements the mesh's: both have to be of
/// one layer. Where the mesh has no core under the contact nothing can be said.
void require_thickness(const std::string& path, const meshes::LayerMesh& mesh, double typed_m) {
  constexpr double a_few_percent = 0.03;
  if (!mesh.thickness_m || std::abs(*mesh.thickness_m / typed_m - 1) <= a_few_percent) return;
  const auto in_mm = [](double length_m) {
    std::ostringstream text;
    text << std::setprecision(4) << 1e3 * length_m << " mm";
    return text.str();
  };
  throw InputError(path, "thickness under the contact", in_mm(*mesh.thickness_m),
                   "thickness_mm of the case, " + in_mm(typed_m) +
                       ", within 3 %: another mesh, another thickness, or another mesh_unit");
}

/// "line 3, column 14" of a byte, counted from 1 as the parser does.
std::string place_of(const std::string& text, std::size_t byte) {
  const std::string before = text.substr(0, byte > 0 ? byte - 1 : 0);
  const std::size_t line = before.rfind('\n');
  const auto lines = std::count(before.begin(), before.end(), '\n');
  return "line " + std::to_string(lines + 1) + ", column " +
         std::to_string(before.size() - (line == std::string::npos ? 0 : line + 1) + 1);
}

}  // namespace

json parse_problems(const std::string& text, const std::string& where) {
  check_nesting(text, where);
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    throw InputError(where, "not JSON at " + place_of(text, error.byte), "", "");
  } catch (const json::out_of_range&) {
    throw InputError(where, "number", "", "less than 1.8e308");
  }
}

PressedInTime read_times(const Entry& input) {
  constexpr std::size_t most_terms = 50, most_points = 1000;
  PressedInTime pressed;
  for (const Entry& term : input.at("relaxation").list(0, most_terms))
    pressed.terms.push_back({term.at("share").positive(), term.at("time_s").positive()});
  for (const Entry& point : input.at("history").list(1, most_points))
    pressed.points.push_back(
        {point.at("time_s").finite(),
         point.at("value").number(0, std::numeric_limits<double>::max(), "a finite number >= 0")});
  const auto time_s = input.find("time_s");
  pressed.time_s = time_s ? time_s->finite() : std::numeric_limits<double>::infinity();
  return pressed;
}

Problem read_problem(const json& input, const MeshReaders& readers) {
  Problem problem;
  if (const auto name = Entry(input, "", "problem").find("name")) problem.name = name->text();
  const Entry root(input, "", problem.name);
  const std::vector<Entry> radii = root.at("radii_m").list(2, 2);
  const auto axis_rad = root.find("axis_rad");
  problem.contact.radii = {radii[0].positive(), radii[1].positive(),
                           axis_rad ? axis_rad->finite() : 0};
  if (const auto radius_m = root.find("sphere_radius_m"))
    problem.sphere_radius_m = radius_m->positive();
  const Entry layer = root.at("layer");
  problem.contact.layer = read_layer(layer);
  if (const auto object_layer = root.find("object_layer"))
    problem.contact.object_layer = read_layer(*object_layer);
  if (const auto kinematics = root.find("kinematics"))
    if (kinematics->choice({"linear", "finite"}) == "finite")
      problem.finite_strain = read_material(layer);
  std::vector<std::string> regions;
  if (const auto sublayers = layer.find("sublayers"))
    for (const Entry& sublayer : sublayers->list(0, kMostSublayers)) {
      problem.sublayers.push_back({read_layer(sublayer), read_material(sublayer)});
      const auto name = sublayer.find("name");
      regions.push_back(name ? name->text() : "");
    }
  if (regions.empty()) regions = {"layer"};
  if (const auto approach_m = root.find("approach_m"))
    problem.approach_m = approach_m->number(0, std::numeric_limits<double>::max(),
                                            "a finite number > 0, or 0 to press by load_N");
  if (const auto times = root.find("in_time")) problem.in_time = read_times(*times);
  if (const auto name = root.find("shear_law")) {
    const std::string typed = name->choice({kShearLawNames.begin(), kShearLawNames.end()});
    problem.shear_law = ShearLaw::Kind(
        std::find(kShearLawNames.begin(), kShearLawNames.end(), typed) - kShearLawNames.begin());
  }
  const ShearLaw law = problem.friction_law();
  if (law.has_shear_strength()) problem.shear_strength_Pa = root.at("shear_strength_Pa").positive();
  if (const auto pressing = root.find("pressing")) {
    const std::string typed =
        pressing->choice({kPressingFrictionNames.begin(), kPressingFrictionNames.end()});
    problem.pressing = PressingFriction(
        std::find(kPressingFrictionNames.begin(), kPressingFrictionNames.end(), typed) -
        kPressingFrictionNames.begin());
  }
  problem.contact.load = {
      problem.approach_m != 0 ? 0.0 : root.at("load_N").positive(),
      law.has_friction_coefficient() ? root.at("friction_coefficient").positive() : 0.0};
  if (const auto hint = root.find("size_hint_m")) {
    const std::vector<Entry> both = hint->list(2, 2);
    problem.size_hint_m = {both[0].positive(), both[1].positive()};
  }
  if (const auto level = root.find("level")) problem.level = level->whole(1, 4);
  if (const auto fingertip = root.find("fingertip"))
    problem.fingertip = read_fingertip(*fingertip, readers);
  if (const auto mesh = root.find("layer_mesh")) {
    problem.mesh_name = mesh->dump();
    const std::string path = mesh->at("mesh").text();
    problem.mesh = readers.layer(path, mesh->at("metres_per_unit").positive(), regions);
    check_content(*mesh);
    require_thickness(path, *problem.mesh, problem.contact.layer.thickness_m);
  }
  if (const auto friction = root.find("friction")) problem.friction = read_friction(*friction);
  if (const auto forces = root.find("lists_forces")) problem.lists_forces = forces->flag();
  if (const auto file = root.find("compliance_file")) problem.compliance_file = file->text();
  if (const auto folder = root.find("output_directory")) problem.output_directory = folder->text();
  return problem;
}

}  // namespace softfinger::fem
