#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/mesh_points_text.h"
#include "comparisons/input/case.h"
#include "comparisons/input/mesh_unit.h"
#include "comparisons/prediction/answer_json.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/mesh_points.h"
#include "comparisons/report/mesh_picture.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/toml_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

using Eigen::Vector3d;

struct MeshOptions {
  std::string file, along, near, unit, page, picture, command_line;
  bool write_page = false, write_picture = false, json = false;
};

struct ReadMesh {
  meshes::SurfaceFile file;
  std::string unit, doubt;  ///< about the unit, or how it was guessed
};

ReadMesh read_mesh(const std::string& path, const std::string& typed_unit,
                   const std::string& near) {
  ReadMesh read;
  read.file = read_typed_skin(path, typed_unit, "--near", near);
  read.unit = input::unit_name(read.file.metres_per_unit);
  read.doubt = finger_unit_remark(read.file);
  return read;
}

std::vector<report::MeshPoint> points_of(const MeshOptions& options, const ReadMesh& read,
                                         const std::string& path) {
  const TriangleSurface& surface = read.file.surface;
  std::vector<report::MeshPoint> points;
  if (!options.near.empty()) points.push_back(point_near(surface, options.near, read.unit, path));
  for (const std::string axis : {"-y", "+y", "-x", "+x", "-z", "+z"}) {
    const Vector3d direction = *input::axis_direction(axis);
    if (options.along.empty() ? !options.near.empty()
                              : *input::axis_direction(options.along) != direction)
      continue;
    points.push_back(
        describe_point(surface, axis, prediction::extreme_point_m(surface, direction), &direction));
  }
  for (report::MeshPoint& point : points)
    point.toml = geometry_line(options.file, read.unit, point);
  return points;
}

nlohmann::json to_json(const MeshOptions& options, const ReadMesh& read,
                       const std::vector<report::MeshPoint>& points) {
  const auto vector = [](const Vector3d& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  const TriangleSurface& surface = read.file.surface;
  const prediction::SurfaceFacts facts = prediction::facts_of(surface);
  nlohmann::json list = nlohmann::json::array();
  for (const report::MeshPoint& point : points) {
    nlohmann::json entry = point.fit ? prediction::to_json(*point.fit) : nlohmann::json::object();
    if (!point.fit) entry["radii_m"] = nlohmann::json();
    entry["name"] = point.name;
    entry["point_m"] = vector(point.point_m);
    entry["normal"] = vector(point.normal);
    entry["doubt"] = point.doubt.empty() ? nlohmann::json() : nlohmann::json(point.doubt);
    entry["toml"] = point.toml.empty() ? nlohmann::json() : nlohmann::json(point.toml);
    list.push_back(entry);
  }
  return {{"mesh", options.file},
          {"unit", read.unit},
          {"unit_guessed", read.file.is_unit_guessed},
          {"unit_doubt", input::is_width_doubtful(read.file, input::MeshRole::finger)
                             ? nlohmann::json(read.doubt)
                             : nlohmann::json()},
          {"triangles", surface.triangles.size()},
          {"vertices", surface.vertices_m.size()},
          {"closed", facts.open_edges == 0},
          {"open_edges", facts.open_edges},
          {"bounds_m", {vector(facts.least_m), vector(facts.largest_m)}},
          {"area_m2", facts.area_m2},
          {"degenerate_triangles", read.file.degenerate_triangles},
          {"duplicate_triangles", read.file.duplicate_triangles},
          {"turned_triangles", read.file.turned_triangles},
          {"hidden_triangles", read.file.hidden_triangles},
          {"points", list},
          {"page", options.write_page ? nlohmann::json(options.page) : nlohmann::json()},
          {"picture", options.write_picture ? nlohmann::json(options.picture) : nlohmann::json()}};
}

std::string to_text(const MeshOptions& options, const ReadMesh& read,
                    const std::vector<report::MeshPoint>& points) {
  const prediction::SurfaceFacts facts = prediction::facts_of(read.file.surface);
  const Vector3d least = 1e3 * facts.least_m, largest = 1e3 * facts.largest_m;
  std::string text = fmt::format(
      "{}: {}\n  x {:.4g} to {:.4g}, y {:.4g} to {:.4g}, z {:.4g} to {:.4g} mm, read in {}{}\n\n",
      options.file, facts_in_words(read.file.surface), least.x(), largest.x(), least.y(),
      largest.y(), least.z(), largest.z(), read.unit,
      read.file.is_unit_guessed ? " (guessed; --unit says it)" : "");
  text += fmt::format("{:<22} {:>28} {:>26} {:>19} {:>9}\n", "point", "x, y, z mm", "normal",
                      "radii mm", "region mm");
  for (const report::MeshPoint& point : points) {
    const auto radius = [](double radius_m) {
      return std::isfinite(radius_m) ? fmt::format("{:.4g}", 1e3 * radius_m) : "flat";
    };
    const auto list = [](const Vector3d& v, int digits) {
      const double step = std::pow(10, -digits);
      // A value that rounds to zero is printed without a sign.
      const auto shown = [&](double x) { return std::abs(x) < 0.5 * step ? 0 : x; };
      return fmt::format("{:.{}f}, {:.{}f}, {:.{}f}", shown(v.x()), digits, shown(v.y()), digits,
                         shown(v.z()), digits);
    };
    text += fmt::format("  {:<20} {:>28} {:>26} {:>19} {:>9}\n", point.name,
                        list(1e3 * point.point_m, 3), list(point.normal, 4),
                        point.fit ? radius(point.fit->principal.radii_m[0]) + ", " +
                                        radius(point.fit->principal.radii_m[1])
                                  : "?",
                        point.fit ? fmt::format("{:.3g}", 1e3 * point.fit->region_radius_m) : "?");
    if (!point.doubt.empty()) text += "    " + point.doubt + "\n";
  }
  text += "\nFor [geometry] of a case:\n";
  for (const report::MeshPoint& point : points)
    if (!point.toml.empty()) text += point.toml + "\n";
  return text;
}

int run_mesh(const MeshOptions& options) {
  if (!options.along.empty() && !input::axis_direction(options.along))
    throw InputError("command line", "--along", "\"" + options.along + "\"",
                     "+x, -x, +y, -y, +z or -z");
  if (options.write_page && options.page.empty())
    throw InputError("command line", "--page", "\"\"", "the name of an HTML file");
  if (options.write_picture && options.picture.empty())
    throw InputError("command line", "--picture", "\"\"", "the name of a PNG file");
  const auto path = system::find_mesh_file(options.file, "");
  const ReadMesh read = read_mesh(path.string(), options.unit, options.near);
  const std::vector<report::MeshPoint> points = points_of(options, read, path.string());
  const std::string repairs = meshes::repairs(read.file);
  if (options.write_page) {
    report::MeshPage page;
    page.mesh = options.file;
    page.mesh_toml = text::toml_text(options.file);
    page.unit = read.unit;
    page.facts = facts_in_words(read.file.surface) + ".";
    for (const std::string& doubt : {read.doubt, repairs})
      if (!doubt.empty()) page.doubts.push_back(doubt);
    page.points = points;
    page.version = "softfinger " + system::program_version();
    page.command = options.command_line;
    system::write_file_atomically(options.page, report::mesh_page(read.file.surface, page));
  }
  if (options.write_picture)
    system::write_file_atomically(options.picture, report::mesh_picture(read.file.surface, points));
  // Last, so that a refusal stays a single line.
  for (const std::string& doubt : {read.doubt, repairs})
    if (!doubt.empty()) remark(path.string() + ": " + doubt);
  if (options.write_page) remark("the page is " + options.page);
  if (options.write_picture) remark("the picture is " + options.picture);
  if (options.json)
    system::write_to_stdout(text::printed(to_json(options, read, points)));
  else
    system::write_text_to_stdout(to_text(options, read, points));
  return 0;
}

}  // namespace

void add_mesh(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<MeshOptions>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand(
      "mesh",
      "An STL or OBJ surface at a glance: size, unit, closed or not, points to press on, lines for "
      "a case");
  command
      ->add_option("MESH", options->file,
                   "STL or OBJ file, the name of a built-in mesh, or \"-\" for standard input")
      ->required();
  CLI::Option* along = command->add_option(
      "--along", options->along,
      "only the point that lies farthest in this direction: +x, -x, +y, -y, +z or -z; default: in "
      "all six");
  command
      ->add_option("--near", options->near,
                   "X,Y,Z: only the surface's point nearest to this one, in the mesh's unit")
      ->excludes(along);
  command
      ->add_option(
          "--unit", options->unit,
          "of the mesh: \"mm\" or \"m\"; default: the one in which its width, the middle one of "
          "its three sizes, is nearer to a finger's 15 mm")
      ->check(CLI::IsMember({"mm", "m"}));
  const CLI::Option* page = command->add_option(
      "--page", options->page,
      "HTML file to write: the surface in 3-D with the points, the fitted regions and quadrics; a "
      "click on it gives the line of a case, a button a picture (PNG)");
  const CLI::Option* picture = command->add_option(
      "--picture", options->picture,
      "PNG file to write: the surface seen along the six axes, with the points and a bar of "
      "millimetres");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "Radii are those of a quadric fitted to about forty vertices around the point; predict fits\n"
      "the region of each load. In a case, along = \"-y\" stands for point_mm and normal.\n"
      "Samples:\n"
      "  softfinger mesh shadow_like_pad.stl\n"
      "  softfinger mesh shadow_like_pad.stl --along +z --page pad.html\n"
      "  softfinger mesh shadow_like_pad.stl --picture pad.png\n"
      "  softfinger mesh sphere.stl --near 0,-20,1 --json");
  command->callback([options, page, picture, &action] {
    options->write_page = page->count() > 0;
    options->write_picture = picture->count() > 0;
    action = [options] { return run_mesh(*options); };
  });
}

}  // namespace softfinger::commands
