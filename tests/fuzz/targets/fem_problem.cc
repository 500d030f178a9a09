// Problem files of the finite-element program.

#include "comparisons/reference/fem_problem.h"

#include <memory>
#include <variant>

#include "comparisons/input/case.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/reference/pad_elements.h"
#include "fem/program/read_pad.h"
#include "fem/program/read_problem.h"
#include "meshes/generation/layer_mesh.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

/// Whatever a problem calls a mesh is a tetrahedron; a layer's mesh is none at all.
const fem::MeshReaders& mesh_readers() {
  static const fem::MeshReaders readers = {
      [](const std::string&, double metres_per_unit) {
        TriangleSurface surface;
        surface.vertices_m = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}};
        for (auto& vertex : surface.vertices_m) vertex *= metres_per_unit;
        surface.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
        return surface;
      },
      [](const std::string&, double, const auto&) {
        return std::make_shared<const meshes::LayerMesh>();
      }};
  return readers;
}

void read_one(const nlohmann::json& problem) {
  if (fem::is_pad(problem))
    fem::read_pad(problem);
  else
    fem::read_problem(problem, mesh_readers());
}

bool read(std::string_view bytes) {
  try {
    const nlohmann::json problems = fem::parse_problems(std::string(bytes), "fuzzed.json");
    if (problems.is_array())
      for (const nlohmann::json& problem : problems) read_one(problem);
    else
      read_one(problems);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// The problems of the built-in cases that need no mesh, and one with everything.
std::vector<std::string> seeds() {
  std::vector<std::string> texts;
  for (const std::string& text : texts_of(SOFTFINGER_CASES, ".toml")) {
    const input::Case contact_case =
        input::parse_case(text, "seed.toml", {}, input::FlatPads::taken);
    if (text.find("mesh") != std::string::npos || contact_case.object_layer.thickness_m > 0)
      continue;
    const double load_N = contact_case.loads_N.front();
    if (std::holds_alternative<input::PadPair>(contact_case.geometry)) {
      texts.push_back(reference::pad_problem(contact_case, load_N, 1, 0).dump(1));
      continue;
    }
    const prediction::LocalGeometry geometry =
        prediction::GeometryResolver(contact_case).resolve(load_N);
    texts.push_back(to_json(reference::fem_problem(contact_case, geometry, load_N, 2)).dump(1));
  }
  const std::string mesh =
      "{\"shape\": \"mesh\", \"mesh\": \"tip.stl\", \"metres_per_unit\": 0.001,\n\"point_m\": [0, "
      "0, 0.009], \"outward_normal\": [0, 0, 1], \"x_axis\": [1, 0, 0],\n\"radii_m\": [0.02, "
      "null], \"turn_rad\": 0.1}";
  texts.push_back(
      "[{\"name\": \"all\",\n\"radii_m\": [0.02, 0.01],\n\"layer\": {\"thickness_m\": "
      "0.002,\n\"youngs_modulus_Pa\": 3e5,\n\"poisson_ratio\": 0.4,\n\"material\": \"yeoh\","
      "\n\"yeoh_ratios\": [0.1, 0.01],\n\"volumetric\": \"logarithmic\"},\n\"kinematics\": "
      "\"finite\",\n\"approach_m\": 1e-3,\n\"friction_coefficient\": 0.5,\n\"friction\": "
      "{\"torsion\": true,\n\"increments\": 9,\n\"limit_surface\": 7,\n\"increments_to_slip\": 3,"
      "\n\"twist_axis_m\": [0, 1e-3]},\n\"fingertip\": {\"pad\": " +
      mesh + ",\n\"object\": " + mesh +
      "},\n\"layer_mesh\": {\"mesh\": \"layer.msh\", \"metres_per_unit\": 1}}]");
  return texts;
}

}  // namespace

const Target fem_problem = {"fem_problem", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
