#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/mesh_points_text.h"
#include "comparisons/input/case.h"
#include "comparisons/input/measured_silicones.h"
#include "comparisons/input/mesh_unit.h"
#include "comparisons/judgement/pads.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/mesh_points.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"
#include "meshes/io/read_surface.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

namespace fs = std::filesystem;

struct InitOptions {
  std::string file = "my_finger.toml", mesh, along = "-y", near, unit, part, material;
  bool along_given = false, unit_given = false, force = false, json = false, pad = false;
};

constexpr const char* kPlane =
    "object = { radii_mm = [inf, inf] }       # a plane; or { sphere_radius_mm = 10 }, { mesh = "
    "\"object.stl\", along = \"+z\" }\n";

/// The best pad's line, and the next best as comments; empty where no place is usable.
std::string pads_text(const meshes::SurfaceFile& file, const input::NamedMesh& named) {
  std::vector<judgement::PadPlace> places;
  for (const std::string axis : {"-y", "+y", "-x", "+x", "-z", "+z"}) {
    const Eigen::Vector3d direction = *input::axis_direction(axis);
    places.push_back({axis, prediction::extreme_point_m(file.surface, direction), direction});
  }
  const judgement::Pressing pressing;
  const judgement::Pads pads =
      judgement::find_pads(file.surface, input::MeshRole::finger, pressing, places, true);
  if (pads.usable == 0) return "";
  constexpr std::size_t kMostListed = 4;
  std::string lines =
      "# The best of the places that softfinger mesh FILE lists; its --page shows the finger, "
      "where "
      "a\n# click gives such a line. Or along = \"-y\": the point that lies farthest there.\n";
  std::size_t listed = 0;
  for (const judgement::Pad& pad : pads.best_first) {
    if (!pad.is_usable() || listed == kMostListed) continue;
    const report::MeshPoint point = point_of(pad, named, input::MeshRole::finger);
    lines += fmt::format("{}{}   # {}: ± {} at {:g} N\n", listed++ == 0 ? "" : "# ", point.toml,
                         point.name, text::percent(pad.worst), pressing.load_N);
  }
  return lines;
}

std::string geometry_text(const InitOptions& options) {
  if (options.mesh.empty())
    return "# Exactly one of three forms. Radii in mm: inf is flat, negative hollow.\n"
           "finger = { radii_mm = [9.0, 7.0] }\n"
           "object = { radii_mm = [inf, 15.0] }      # or { sphere_radius_mm = 10 }\n"
           "angle_deg = 90                           # the object's x axis against the finger's\n"
           "# relative_radii_mm = [20.0, 5.0]        # of the gap, in place of the two bodies\n"
           "# finger = { mesh = \"tip.stl\", unit = \"mm\", along = \"-y\" }   # softfinger mesh "
           "tip.stl\n";
  const std::string path =
      system::find_mesh_file(options.mesh, fs::path(options.file).parent_path()).string();
  const meshes::SurfaceFile file =
      read_typed_skin({path, options.unit, options.part}, "--near", options.near);
  const input::NamedMesh named = input::named_mesh(options.mesh, options.part, file);
  // A typed unit is in the case, whose reader doubts it.
  if (const std::string doubt = finger_unit_remark(file); file.is_unit_guessed && !doubt.empty())
    remark(path + ": " + doubt);
  if (options.near.empty() && !options.along_given) {
    const std::string pads = pads_text(file, named);
    if (!pads.empty()) return pads + kPlane;
  }
  if (!options.near.empty())
    return geometry_line(named,
                         point_near(file.surface, options.near, named.metres_per_unit, path)) +
           "\n" + kPlane;
  return fmt::format(
      "# along: the point that lies farthest there. Any other: near_mm = [x, y, z], the nearest "
      "one;\n"
      "# softfinger mesh FILE --page page.html shows the finger, where a click gives these lines.\n"
      "finger = {{ {}, along = \"{}\" }}\n{}",
      named.entries(), options.along, kPlane);
}

/// The line of the modulus: of a measured silicone, or `otherwise`.
std::string modulus_line(const InitOptions& options, const char* otherwise) {
  if (options.material.empty()) return otherwise;
  const input::MeasuredSilicone& silicone = input::find_measured_silicone(options.material);
  // The scatter as a factor to either side, which predict carries through to its answers.
  const double factor =
      std::max(silicone.high_kPa() / silicone.to_30_kPa, silicone.to_30_kPa / silicone.low_kPa());
  return fmt::format(
      "# {}: {:g} kPa in tension to 30 % of strain, {:g} to {:g} kPa from 10 to 100 %. Crosshead\n"
      "# strain: lower bounds. Batches differ: softfinger calibrate.\n"
      "youngs_modulus_kPa = {{ value = {:.1f}, factor = {:.3g} }}\n",
      silicone.name, silicone.to_30_kPa, silicone.low_kPa(), silicone.high_kPa(),
      silicone.to_30_kPa, factor);
}

std::string pad_case_text(const InitOptions& options) {
  return fmt::format(
      "# A flat pad for softfinger. What a key means and may be: softfinger predict --help\n"
      "id = \"{}\"\n"
      "question = \"Which torque does my gripper's pad hold?\"   # optional\n"
      "\n[geometry]                               # the contact is where pad and face overlap\n"
      "finger = {{ pad_mm = [22, 37.5], corner_radius_mm = 1, edge_radius_mm = 0.5 }}\n"
      "# finger = {{ pad_diameter_mm = 20 }}     # or pad_outline_mm = [[0, 0], [20, 0], [10, "
      "15]], "
      "convex\n"
      "object = {{ flat = true }}                 # a plane larger than the pad\n"
      "# object = {{ face_mm = [10, 50], offset_mm = [2, 0], angle_deg = 20 }}   # or "
      "face_diameter_mm, face_outline_mm\n"
      "\n[layer]                                  # the rubber on its rigid backing\n"
      "thickness_mm = 3.0\n"
      "{}"
      "poisson_ratio = 0.49                     # 0 to 0.5; rubber and silicone 0.48 to 0.5, foam "
      "0 to 0.3\n"
      "\n[contact]\n"
      "load_N = [20.0, 60.0]                    # one or several\n"
      "friction_coefficient = 0.9\n"
      "# pressing = \"stuck\"                     # default; or \"frictionless\", of a lubricated "
      "face\n"
      "# load_at_mm = [1.0, 0.0]                # where the load acts; default: faces stay "
      "parallel\n",
      options.file == "-" ? "my_pad" : input::id_of(options.file),
      modulus_line(options,
                   "youngs_modulus_kPa = 800.0               # moves indentation and stiffness, "
                   "not the torque\n"));
}

std::string case_text(const InitOptions& options) {
  if (options.pad) return pad_case_text(options);
  return fmt::format(
      "# A case for softfinger. What a key means and may be: softfinger predict --help, "
      "docs/files.md\n"
      "id = \"{}\"\n"
      "question = \"Which model holds for my finger?\"   # optional\n"
      "\n[geometry]\n{}"
      "\n[layer]                                  # the rubber; [[layer]] several times: from the "
      "surface inwards\n"
      "thickness_mm = 2.0\n"
      "{}"
      "poisson_ratio = 0.49                     # 0 to 0.5; rubber and silicone 0.48 to 0.5, foam "
      "0 to 0.3\n"
      "# relaxation = [{{ share = 0.12, time_s = 0.5 }}]   # part of the modulus that is lost with "
      "time\n"
      "\n[contact]\n"
      "load_N = [1.0, 2.0, 5.0]                 # one or several\n"
      "# history = [{{ time_s = 0, load_N = 0 }}, {{ time_s = 1, load_N = 5 }}]   # in its place\n"
      "friction_coefficient = 0.8\n"
      "# shear_law = \"coulomb\"                  # or \"shear_strength\", \"limited\", "
      "\"adhesive_shear\"\n"
      "# shear_strength_kPa = 40                # for these three\n"
      "\n# [fem]                                  # to ask compare and fem for less; default: the "
      "finger itself\n"
      "# geometry = \"flat\"                      # a flat layer under the relative radii; or "
      "\"curved\"\n"
      "# kinematics = \"linear\"                  # small strain; or \"finite\"\n"
      "# level = 2                              # 1 coarse to 3 fine\n",
      options.file == "-" ? "my_finger" : input::id_of(options.file), geometry_text(options),
      modulus_line(options,
                   "youngs_modulus_kPa = 300.0               # silicone: 50 to 3000; "
                   "softfinger init --material\n"));
}

int run_init(const InitOptions& options) {
  if (options.file.empty())
    throw InputError("command line", "FILE", "\"\"", "the name of a file, or \"-\"");
  if (options.mesh.empty() &&
      (options.along_given || options.unit_given || !options.near.empty() || !options.part.empty()))
    throw InputError("command line", "--along, --near, --unit, --part", "", "with --mesh");
  if (!input::axis_direction(options.along))
    throw InputError("command line", "--along", "\"" + options.along + "\"",
                     "+x, -x, +y, -y, +z or -z");
  if (options.pad && !options.mesh.empty())
    throw InputError("command line", "--pad, --mesh", "", "one of them");
  const bool to_stdout = options.file == "-";
  const std::string text = case_text(options);
  const fs::path file = options.file;
  // The new case must read back, and its mesh must exist and have a surface to press on.
  const input::Case written = input::parse_case(text, file, {}, input::FlatPads::taken);
  if (!options.pad) {
    const prediction::GeometryResolver resolver(written);
    for (const std::string& line : resolver.remarks()) remark(line);
  }
  std::error_code error;
  if (!to_stdout && !options.force && fs::exists(file, error))
    throw InputError(file.string(), "is there already", "", "a new file, or --force");
  if (!to_stdout) system::write_file_atomically(file, text);
  const std::string next = fmt::format("softfinger predict {}", file.string());
  if (options.json)
    system::write_to_stdout(text::printed(
        nlohmann::json({{"file", to_stdout ? nlohmann::json() : nlohmann::json(file.string())},
                        {"text", text},
                        {"next", to_stdout ? "softfinger predict -" : next}})));
  else if (to_stdout)
    system::write_to_stdout(text);
  else
    system::write_text_to_stdout(file.string() + ": written; next: " + next + "\n");
  return 0;
}

}  // namespace

void add_init(CLI::App& app, Action& action) {
  auto options = std::make_shared<InitOptions>();
  CLI::App* command =
      app.add_subcommand("init", "Writes a commented case file to start from, for your own finger");
  command->add_option("FILE", options->file,
                      "the file to write, \"-\" for standard output; default: my_finger.toml");
  command->add_option("--mesh", options->mesh,
                      std::string("the finger as a file in ") + meshes::kMeshFormats +
                          ", named as seen from FILE's folder, or a built-in mesh; default: a "
                          "finger by its radii");
  CLI::Option* along = command->add_option(
      "--along", options->along,
      "direction in which the finger is touched: +x, -x, +y, -y, +z or -z; default: at the best "
      "pad that softfinger mesh finds, or -y where none is usable");
  command
      ->add_option(
          "--near", options->near,
          "X,Y,Z: instead touched at the surface's point nearest to this one, in the mesh's "
          "unit")
      ->excludes(along);
  add_mesh_options(*command, options->unit, options->part, "");
  command->add_option("--material", options->material,
                      "a silicone whose modulus was measured, as \"Dragon Skin 10\", with its "
                      "scatter; default: 300 kPa, of a pad 800 kPa");
  command->add_flag("--pad", options->pad, "a flat pad instead of a curved finger");
  command->add_flag("--force", options->force, "replace a file that is there");
  command->add_flag("--json", options->json, "one JSON object on standard output: file and text");
  command->footer(
      "Samples:\n"
      "  softfinger init -\n"
      "  softfinger init my_pad.toml --pad --force\n"
      "  softfinger init - --material RTV615\n"
      "  softfinger init pad.toml --mesh shadow_like_pad.stl --along +z --force");
  command->callback([options, along, &action] {
    options->along_given = along->count() > 0;
    options->unit_given = !options->unit.empty();
    action = [options] { return run_init(*options); };
  });
}

}  // namespace softfinger::commands
