#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/demand_input.h"
#include "comparisons/commands/mesh_points_text.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/input/case.h"
#include "comparisons/input/mesh_unit.h"
#include "comparisons/judgement/pads.h"
#include "comparisons/prediction/answer_json.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/mesh_points.h"
#include "comparisons/report/mesh_picture.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

using Eigen::Vector3d;

using input::MeshRole;
using judgement::Pad;

struct MeshOptions {
  std::string file, along, near, unit, part, page, picture, command_line;
  std::string layer, load, friction;
  DemandInput demand;
  bool write_page = false, write_picture = false, json = false;
};

struct ReadMesh {
  meshes::SurfaceFile file;
  MeshRole role = MeshRole::finger;
  input::NamedMesh named;
  std::string unit, doubt;  ///< about the unit, or how it was guessed
};

ReadMesh read_mesh(const std::string& path, const MeshOptions& options) {
  ReadMesh read;
  read.file = read_typed_skin({path, options.unit, options.part}, "--near", options.near);
  read.named = input::named_mesh(options.file, options.part, read.file);
  read.role = input::likely_role(read.file);
  read.unit = input::unit_name(read.file.metres_per_unit);
  read.doubt = input::unit_remark(read.file, read.role, input::UnitIsTold::on_the_command_line);
  return read;
}

judgement::Pressing pressing_of(const MeshOptions& options) {
  judgement::Pressing pressing;
  pressing.demand = options.demand.demand();
  if (!options.layer.empty()) {
    const std::string allowed =
        "THICKNESS_mm,E_kPa,NU: two numbers > 0 and one from 0 to 0.5, as in 2,300,0.49";
    const std::vector<double> typed = numbers_of("--layer", options.layer, allowed, 3);
    if (!(typed[0] > 0 && typed[1] > 0 && typed[2] >= 0 && typed[2] <= 0.5))
      throw InputError("command line", "--layer", options.layer, allowed);
    pressing.layer = {1e-3 * typed[0], 1e3 * typed[1], typed[2]};
  }
  const auto number = [](const std::string& flag, const std::string& text, bool or_zero,
                         const std::string& allowed, double& value) {
    if (text.empty()) return;
    value = number_of(flag, text, allowed);
    if (!(value > 0 || (or_zero && value == 0)))
      throw InputError("command line", flag, text, allowed);
  };
  number("--load", options.load, false, "a number > 0, in N", pressing.load_N);
  number("--friction", options.friction, true, "a number >= 0", pressing.friction_coefficient);
  return pressing;
}

struct Answer {
  std::vector<report::MeshPoint> points;  ///< asked for, or the six extremes
  judgement::Pads pads;
  std::string sentence;
};

/// The points that were asked for, or the six that lie farthest.
std::vector<report::MeshPoint> points_of(const MeshOptions& options, const ReadMesh& read,
                                         const std::string& path) {
  const TriangleSurface& surface = read.file.surface;
  std::vector<report::MeshPoint> points;
  if (!options.near.empty())
    points.push_back(point_near(surface, options.near, read.file.metres_per_unit, path));
  for (const std::string axis : {"-y", "+y", "-x", "+x", "-z", "+z"}) {
    const Vector3d direction = *input::axis_direction(axis);
    if (options.along.empty() ? !options.near.empty()
                              : *input::axis_direction(options.along) != direction)
      continue;
    // Better places are found anyway where all of the surface is looked at.
    points.push_back(describe_point(surface, axis, prediction::extreme_point_m(surface, direction),
                                    &direction,
                                    options.along.empty() ? Advice::none : Advice::nearest_point));
  }
  for (report::MeshPoint& point : points) point.toml = geometry_line(read.named, point, read.role);
  return points;
}

/// "[0, -7, 0] mm, facing 0, -1, 0"
std::string place_in_words(const Vector3d& point_m, const Vector3d& normal) {
  const auto rounded = [](double x) { return std::round(100 * x) / 100 + 0.0; };
  return fmt::format("{} mm, facing {:g}, {:g}, {:g}", prediction::in_millimetres(point_m),
                     rounded(normal.x()), rounded(normal.y()), rounded(normal.z()));
}

std::string millimetres_or_flat(double radius_m) {
  return std::isfinite(radius_m) ? fmt::format("{:.4g}", 1e3 * radius_m) : "flat";
}

/// The best place of each kind, of an object.
std::string object_in_words(const ReadMesh& read, const judgement::Pads& pads) {
  std::string text = fmt::format("an object, {:.3g} mm wide", 1e3 * read.file.width_m);
  std::string separator = ": ";
  for (const char* kind : {"wall", "dome", "rim", "base", "flat", "hollow", "saddle"}) {
    const Pad* found = nullptr;
    const auto area_m2 = [](const Pad& pad) { return pad.face ? pad.face->area_m2 : 0; };
    // The largest of several faces: a body can stand on many of its sides.
    for (const Pad& pad : pads.best_first)
      if (pad.kind == kind && (!found || area_m2(pad) > area_m2(*found))) found = &pad;
    if (!found) continue;
    text += separator + kind + " " + prediction::in_millimetres(found->point_m);
    separator = "; ";
    if (found->face)
      text += fmt::format(", {}{:.3g} x {:.3g} mm", found->kind == "flat" ? "" : "flat, ",
                          1e3 * found->face->width_m, 1e3 * found->face->length_m);
    else if (found->fit)
      text +=
          fmt::format(", radii {} and {} mm", millimetres_or_flat(found->fit->principal.radii_m[0]),
                      millimetres_or_flat(found->fit->principal.radii_m[1]));
    text += found->is_usable() ? ", usable ± " + text::percent(found->worst) : ", not usable";
  }
  return text;
}

std::string sentence_of(const MeshOptions& options, const ReadMesh& read,
                        const judgement::Pads& pads) {
  if (pads.best_first.empty()) return "no place of it was tried";
  const Pad& best = pads.best_first.front();
  if (!options.along.empty() || !options.near.empty())
    return best.name + ": " + (best.is_usable() || best.face ? "" : "not usable, ") +
           verdict_of(best);
  if (read.role == MeshRole::object) return object_in_words(read, pads);
  if (const prediction::FlatFace* face = pads.pad_face())
    return prediction::in_words(*face) + ", at " + place_in_words(face->middle_m, face->normal);
  if (best.is_usable())
    return fmt::format("best pad: {} at {}; radii {} and {} mm; {}", best.name,
                       place_in_words(best.point_m, best.normal),
                       millimetres_or_flat(best.fit->principal.radii_m[0]),
                       millimetres_or_flat(best.fit->principal.radii_m[1]), verdict_of(best));
  const auto curved = std::find_if(pads.best_first.begin(), pads.best_first.end(),
                                   [](const Pad& pad) { return !pad.face; });
  const Pad& nearest = curved == pads.best_first.end() ? best : *curved;
  return fmt::format("no usable pad: of {} places none is known {}; {} at {}: {}",
                     pads.best_first.size(), prediction::in_words(options.demand.demand()),
                     nearest.name, place_in_words(nearest.point_m, nearest.normal),
                     verdict_of(nearest));
}

Answer answer_of(const MeshOptions& options, const ReadMesh& read, const std::string& path,
                 const judgement::Pressing& pressing) {
  Answer answer;
  answer.points = points_of(options, read, path);
  std::vector<judgement::PadPlace> places;
  for (const report::MeshPoint& point : answer.points)
    if (!point.normal.isZero(0)) places.push_back({point.name, point.point_m, point.normal});
  answer.pads = judgement::find_pads(read.file.surface, read.role, pressing, places,
                                     options.along.empty() && options.near.empty());
  answer.sentence = sentence_of(options, read, answer.pads);
  return answer;
}

nlohmann::json vector_json(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json face_json(const prediction::FlatFace& face) {
  return {{"point_m", vector_json(face.middle_m)},   {"normal", vector_json(face.normal)},
          {"size_m", {face.length_m, face.width_m}}, {"area_m2", face.area_m2},
          {"outermost", face.is_outermost},          {"ring", face.is_ring()}};
}

nlohmann::json pad_json(const ReadMesh& read, const Pad& pad) {
  const bool has_answer = pad.answer && pad.answer->prediction.has_answer;
  nlohmann::json entry = {
      {"name", pad.name},
      {"kind", pad.kind},
      {"point_m", vector_json(pad.point_m)},
      {"normal", vector_json(pad.normal)},
      {"usable", pad.is_usable()},
      {"error_bound", text::finite_or_null(pad.worst)},
      {"reason", pad.reason.empty() ? nlohmann::json() : nlohmann::json(pad.reason)},
      {"radii_m", nlohmann::json()},
      {"flat", pad.face ? face_json(*pad.face) : nlohmann::json()},
      {"model", has_answer ? nlohmann::json(pad.answer->model->card().name) : nlohmann::json()}};
  if (pad.fit)
    entry["radii_m"] = {text::finite_or_null(pad.fit->principal.radii_m[0]),
                        text::finite_or_null(pad.fit->principal.radii_m[1])};
  const auto number = [&](const char* key, double value) {
    entry[key] = has_answer ? text::finite_or_null(value) : nlohmann::json();
  };
  const Prediction none;
  const Prediction& p = has_answer ? pad.answer->prediction : none;
  number("a_m", p.a_m);
  number("b_m", p.b_m);
  number("eccentricity_m", p.torque_arm_exact_m);
  number("max_torque_Nm",
         has_answer ? pad.answer->friction_ellipsoid(prediction::TorqueRule::exact).max_torque_Nm()
                    : 0);
  const std::string line = point_of(pad, read.named, read.role).toml;
  entry["toml"] = line.empty() ? nlohmann::json() : nlohmann::json(line);
  return entry;
}

nlohmann::json to_json(const MeshOptions& options, const ReadMesh& read, const Answer& answer,
                       const judgement::Pressing& pressing) {
  const TriangleSurface& surface = read.file.surface;
  const prediction::SurfaceFacts facts = prediction::facts_of(surface);
  const std::size_t open_edges = read.file.open_edges.value_or(facts.open_edges);
  nlohmann::json list = nlohmann::json::array(), pads = list, faces = list;
  for (const report::MeshPoint& point : answer.points) {
    nlohmann::json entry = point.fit ? prediction::to_json(*point.fit) : nlohmann::json::object();
    if (!point.fit) entry["radii_m"] = nlohmann::json();
    entry["name"] = point.name;
    entry["point_m"] = vector_json(point.point_m);
    entry["normal"] = vector_json(point.normal);
    entry["doubt"] = point.doubt.empty() ? nlohmann::json() : nlohmann::json(point.doubt);
    entry["toml"] = point.toml.empty() ? nlohmann::json() : nlohmann::json(point.toml);
    list.push_back(entry);
  }
  for (const Pad& pad : answer.pads.best_first) pads.push_back(pad_json(read, pad));
  for (const prediction::FlatFace& face : answer.pads.faces) faces.push_back(face_json(face));
  return {{"mesh", options.file},
          {"answer", answer.sentence},
          {"role", read.role == MeshRole::finger ? "finger" : "object"},
          {"unit", read.unit},
          {"metres_per_unit", read.file.metres_per_unit},
          {"part", options.part.empty() ? nlohmann::json() : nlohmann::json(options.part)},
          {"unit_guessed", read.file.is_unit_guessed},
          {"unit_doubt", input::is_width_doubtful(read.file, read.role) ? nlohmann::json(read.doubt)
                                                                        : nlohmann::json()},
          {"triangles", surface.triangles.size()},
          {"vertices", surface.vertices_m.size()},
          {"closed", open_edges == 0},
          {"open_edges", open_edges},
          {"bounds_m", {vector_json(facts.least_m), vector_json(facts.largest_m)}},
          {"area_m2", facts.area_m2},
          {"degenerate_triangles", read.file.degenerate_triangles},
          {"duplicate_triangles", read.file.duplicate_triangles},
          {"turned_triangles", read.file.turned_triangles},
          {"hidden_triangles", read.file.hidden_triangles},
          {"points", list},
          {"pads", pads},
          {"usable_pads", answer.pads.usable},
          {"flat_faces", faces},
          {"pressed", judgement::in_words(pressing, read.role)},
          {"page", options.write_page ? nlohmann::json(options.page) : nlohmann::json()},
          {"picture", options.write_picture ? nlohmann::json(options.picture) : nlohmann::json()}};
}

/// The best places first, then those points that were asked for and are not among them.
std::vector<report::MeshPoint> shown_points(const ReadMesh& read, const Answer& answer,
                                            std::size_t most) {
  std::vector<report::MeshPoint> shown;
  const auto add = [&](const Pad& pad) {
    report::MeshPoint point = point_of(pad, read.named, read.role);
    // A point that was asked for is shown as it was described: with the fit that `fit` makes.
    for (const report::MeshPoint& asked : answer.points)
      if (asked.name == pad.name && asked.fit) {
        const std::string verdict = point.verdict;
        point = asked;
        point.verdict = verdict;
      }
    shown.push_back(point);
  };
  for (const Pad& pad : answer.pads.best_first)
    if (shown.size() < most) add(pad);
  for (const report::MeshPoint& point : answer.points)
    if (std::none_of(shown.begin(), shown.end(),
                     [&](const report::MeshPoint& one) { return one.name == point.name; })) {
      shown.push_back(point);
      for (const Pad& pad : answer.pads.best_first)
        if (pad.name == point.name) shown.back().verdict = verdict_of(pad);
    }
  return shown;
}

constexpr std::size_t kMostListed = 8;

std::string to_text(const MeshOptions& options, const ReadMesh& read, const Answer& answer,
                    const judgement::Pressing& pressing) {
  const prediction::SurfaceFacts facts = prediction::facts_of(read.file.surface);
  const Vector3d least = 1e3 * facts.least_m, largest = 1e3 * facts.largest_m;
  const judgement::Pads& pads = answer.pads;
  std::string text = answer.sentence + "\n";
  text += fmt::format("{} of {} places usable, each pressed with {}{}\n", pads.usable,
                      pads.best_first.size(), judgement::in_words(pressing, read.role),
                      pads.is_complete ? "" : "; the search ended after 3 s");
  text += fmt::format(
      "{}: {}\n  x {:.4g} to {:.4g}, y {:.4g} to {:.4g}, z {:.4g} to {:.4g} mm, read in {}{}\n\n",
      options.file, facts_in_words(read.file), least.x(), largest.x(), least.y(), largest.y(),
      least.z(), largest.z(), read.unit,
      read.file.is_unit_guessed ? " (guessed; --unit says it)"
      : read.named.is_own_unit  ? ", as the file says"
                                : "");
  text += fmt::format("{:<22} {:>28} {:>26} {:>19} {:>9}\n", "point", "x, y, z mm", "normal",
                      "radii mm", "region mm");
  const auto shown = shown_points(read, answer, kMostListed);
  for (const report::MeshPoint& point : shown) {
    const auto list = [](const Vector3d& v, int digits) {
      const double step = std::pow(10, -digits);
      // A value that rounds to zero is printed without a sign.
      const auto unsigned_zero = [&](double x) { return std::abs(x) < 0.5 * step ? 0 : x; };
      return fmt::format("{:.{}f}, {:.{}f}, {:.{}f}", unsigned_zero(v.x()), digits,
                         unsigned_zero(v.y()), digits, unsigned_zero(v.z()), digits);
    };
    text += fmt::format("  {:<20} {:>28} {:>26} {:>19} {:>9}\n", point.name,
                        list(1e3 * point.point_m, 3), list(point.normal, 4),
                        point.fit ? millimetres_or_flat(point.fit->principal.radii_m[0]) + ", " +
                                        millimetres_or_flat(point.fit->principal.radii_m[1])
                                  : "?",
                        point.fit ? fmt::format("{:.3g}", 1e3 * point.fit->region_radius_m) : "?");
    if (!point.verdict.empty()) text += "    " + point.verdict + "\n";
    if (!point.doubt.empty()) text += "    " + point.doubt + "\n";
  }
  text += "\nFor [geometry] of a case:\n";
  for (const report::MeshPoint& point : shown)
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
  const judgement::Pressing pressing = pressing_of(options);
  const auto path = system::find_mesh_file(options.file, "");
  const ReadMesh read = read_mesh(path.string(), options);
  const Answer answer = answer_of(options, read, path.string(), pressing);
  const std::string repairs = meshes::repairs(read.file);
  if (options.write_page) {
    report::MeshPage page;
    name_mesh(page, read.named);
    page.facts = answer.sentence + ". " + facts_in_words(read.file) + ".";
    for (const std::string& doubt : {read.doubt, repairs})
      if (!doubt.empty()) page.doubts.push_back(doubt);
    constexpr std::size_t kMostOnPage = 20;
    page.points = shown_points(read, answer, kMostOnPage);
    page.version = "softfinger " + system::program_version();
    page.command = options.command_line;
    system::write_file_atomically(options.page, report::mesh_page(read.file.surface, page));
  }
  if (options.write_picture)
    system::write_file_atomically(options.picture,
                                  report::mesh_picture(read.file.surface, answer.points));
  // Last, so that a refusal stays a single line.
  for (const std::string& doubt : {read.doubt, repairs})
    if (!doubt.empty()) remark(path.string() + ": " + doubt);
  if (options.write_page) remark("the page is " + options.page);
  if (options.write_picture) remark("the picture is " + options.picture);
  if (options.json)
    system::write_to_stdout(text::printed(to_json(options, read, answer, pressing)));
  else
    system::write_text_to_stdout(to_text(options, read, answer, pressing));
  return 0;
}

}  // namespace

void add_mesh(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<MeshOptions>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand(
      "mesh",
      "A surface at a glance: the best pad, places to press on with what each gives, "
      "size, unit, closed or not, lines for a case");
  command
      ->add_option("MESH", options->file,
                   std::string("file in ") + meshes::kMeshFormats +
                       ", the name of a built-in mesh, or \"-\" for standard input (STL or OBJ)")
      ->required();
  CLI::Option* along = command->add_option(
      "--along", options->along,
      "only the point that lies farthest in this direction: +x, -x, +y, -y, +z or -z; default: in "
      "all six");
  command->add_option(
      "--layer", options->layer,
      "THICKNESS_mm,E_kPa,NU: the soft layer that places are pressed with; default: "
      "2,300,0.49");
  command->add_option("--load", options->load,
                      "N, > 0: the load that places are pressed with; default: 1");
  command->add_option("--friction", options->friction, "friction coefficient, >= 0; default: 0.8");
  add_demand(*command, options->demand);
  command
      ->add_option("--near", options->near,
                   "X,Y,Z: only the surface's point nearest to this one, in the mesh's unit")
      ->excludes(along);
  add_mesh_options(*command, options->unit, options->part, "");
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
      "Some fifty places all over the surface are pressed by the default model; of a finger, on a\n"
      "plane. Wider than 50 mm it is an object, and pressed by a ball of 8 mm with the layer on "
      "it.\n"
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
