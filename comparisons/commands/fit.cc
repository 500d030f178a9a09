#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/mesh_points_text.h"
#include "comparisons/input/mesh_unit.h"
#include "comparisons/prediction/answer_json.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/flat_faces.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/mesh_points.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct FitOptions {
  std::string mesh, point, normal, unit, part, page, command_line;
  double radius_mm = 0;
  bool radius_given = false, write_page = false, json = false;
};

std::string plus_minus(double std_m) {
  return std::isfinite(std_m) ? fmt::format("± {:.2g} mm", 1e3 * std_m) : "uncertainty unknown";
}

std::string region_dependence(const QuadricFit& fit, const std::array<double, 2>& change_m) {
  for (const std::size_t i : {0, 1})
    if (std::isfinite(fit.principal.radii_m[i]) && std::isinf(change_m[i]))
      return "how much they depend on the region is not known: neither 0.8 nor 1.25 times this "
             "radius gives another region that can be fitted";
  return fmt::format(
      "with regions of 0.8 and 1.25 times this radius they change by up to {:.2g} and {:.2g} mm",
      1e3 * change_m[0], 1e3 * change_m[1]);
}

int run_fit(const FitOptions& options) {
  if (options.write_page && options.page.empty())
    throw InputError("command line", "--page", "\"\"", "the name of an HTML file");
  const Eigen::Vector3d typed_point =
      parse_vector("--point", options.point, "X,Y,Z: three finite numbers in the mesh's unit");
  std::optional<Eigen::Vector3d> normal;
  if (!options.normal.empty()) {
    const std::string allowed = "X,Y,Z: three finite numbers, not all 0";
    normal = parse_vector("--normal", options.normal, allowed);
    if (!(normal->norm() > 0))
      throw InputError("command line", "--normal", "\"" + options.normal + "\"", allowed);
    normal->normalize();
  }
  if (options.radius_given && !(options.radius_mm > 0 && std::isfinite(options.radius_mm)))
    throw InputError("command line", "--radius-mm", options.radius_mm,
                     "a finite number > 0, in mm");

  const auto path = system::find_mesh_file(options.mesh, "");
  const auto file =
      read_typed_skin({path.string(), options.unit, options.part}, "--point", options.point);
  const Eigen::Vector3d point_m = file.metres_per_unit * typed_point;
  std::vector<std::string> remarks;  // the answer comes first
  for (const std::string& note :
       {meshes::repairs(file),
        input::unit_remark(file, input::likely_role(file), input::UnitIsTold::on_the_command_line)})
    if (!note.empty()) remarks.push_back(path.string() + ": " + note);
  prediction::require_point_on_surface(file.surface, point_m, path.string(), "--point");
  const Eigen::Vector3d* normal_pointer = normal ? &*normal : nullptr;
  const auto advised = [&](const std::string& allowed) {
    const std::string advice = smooth_point_advice(file.surface, point_m, normal_pointer);
    return allowed + (allowed.empty() || advice.empty() ? "" : "; ") + advice;
  };
  const auto faces = prediction::flat_faces(file.surface);
  const prediction::FlatFace* face = prediction::face_at(file.surface, faces, point_m);
  const QuadricFit fit = [&] {
    try {
      return options.radius_given
                 ? fit_quadric(file.surface, point_m, normal_pointer, options.radius_mm * 1e-3)
                 : prediction::fit_around(file.surface, point_m, normal_pointer);
    } catch (const InputError& error) {
      if (face) throw InputError(path.string(), prediction::in_words(*face), "", advised(""));
      // The fit does not know the file's name: it is added here.
      throw InputError(path.string(), error.field(), error.value(), advised(error.allowed()));
    } catch (const ConvergenceError& error) {
      throw InputError(
          path.string(), "surface near the point", "",
          advised(std::string("one that a quadric can follow (") + error.what() + ")"));
    }
  }();
  if (!options.radius_given)
    remarks.push_back(fmt::format("no --radius-mm: {:.4g} mm taken, which holds {} points",
                                  fit.region_radius_m * 1e3, fit.points));
  if (fit.surface_kind == SurfaceKind::sharp_edge)
    remarks.push_back(advised(fmt::format(
        "a sharp edge of {:.3g}° lies in the region, where radii of curvature mean little",
        fit.sharpest_kink_rad * 180 / kPi)));
  if (fit.outliers > 0)
    remarks.push_back(fmt::format("{} outlying vertices were left out", fit.outliers));
  const bool is_whole =
      is_whole_surface(file.surface, point_m, normal_pointer, fit.region_radius_m);
  if (is_whole)
    remarks.push_back(
        fmt::format("a region of {:.4g} mm takes in the whole surface that faces this way: a "
                    "larger one shows nothing of how much the radii depend on it",
                    fit.region_radius_m * 1e3));
  const auto region_change_m = radii_region_change_m(file.surface, point_m, normal_pointer, fit);
  if (options.write_page) {
    report::MeshPoint point;
    point.name = "fitted at " + options.point;
    point.point_m = point_m;
    point.normal = fit.normal;
    point.fit = fit;
    report::MeshPage page;
    page.points = {point};
    write_fits_page(options.page, input::named_mesh(options.mesh, options.part, file), file.surface,
                    std::move(page), options.command_line);
  }
  const auto say_remarks = [&remarks] {
    for (const std::string& said : remarks) remark(said);
  };
  if (options.json) {
    nlohmann::json object = prediction::to_json(fit);
    object["mesh"] = options.mesh;
    object["radii_region_change_m"] = {text::finite_or_null(region_change_m[0]),
                                       text::finite_or_null(region_change_m[1])};
    object["region_is_whole_surface"] = is_whole;
    object["surface_kind"] = fit.surface_kind == SurfaceKind::sharp_edge ? "sharp_edge" : "smooth";
    object["sharpest_kink_rad"] = fit.sharpest_kink_rad;
    object["outliers"] = fit.outliers;
    object["degenerate_triangles"] = file.degenerate_triangles;
    object["duplicate_triangles"] = file.duplicate_triangles;
    object["turned_triangles"] = file.turned_triangles;
    object["flat_size_m"] = face ? nlohmann::json{face->length_m, face->width_m} : nlohmann::json();
    object["hidden_triangles"] = file.hidden_triangles;
    system::write_to_stdout(text::printed(object));
    say_remarks();
    return 0;
  }
  const auto& principal = fit.principal;
  system::write_text_to_stdout(fmt::format(
      "{}radii: {} ({}) along {:.4g}° from x, {} ({}) across; negative = concave\n"
      "{}\n"
      "depth = A x² + B y² + C x y: A {:.5g}, B {:.5g}, C {:.5g} per m\n"
      "normal: {:.5f}, {:.5f}, {:.5f}\n"
      "x axis: {:.5f}, {:.5f}, {:.5f}\n"
      "residual: {:.3g} mm rms over {} points, {:.4g} mm², region radius {:.4g} mm\n",
      face ? prediction::in_words(*face) + "\n" : "", prediction::millimetres(principal.radii_m[0]),
      plus_minus(fit.radii_std_m[0]), principal.axis_rad * 180 / kPi,
      prediction::millimetres(principal.radii_m[1]), plus_minus(fit.radii_std_m[1]),
      region_dependence(fit, region_change_m), fit.quadric.A_per_m, fit.quadric.B_per_m,
      fit.quadric.C_per_m, fit.normal.x(), fit.normal.y(), fit.normal.z(), fit.x_axis.x(),
      fit.x_axis.y(), fit.x_axis.z(), fit.residual_rms_m * 1e3, fit.points, fit.area_m2 * 1e6,
      fit.region_radius_m * 1e3));
  say_remarks();
  return 0;
}

}  // namespace

void add_fit(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<FitOptions>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand(
      "fit", "Local quadric of a surface: A, B, C, principal radii, directions, residual");
  command
      ->add_option("MESH", options->mesh,
                   std::string("file in ") + meshes::kMeshFormats +
                       ", the name of a built-in mesh, or \"-\" for standard input (STL or OBJ)")
      ->required();
  command
      ->add_option("--point", options->point,
                   "X,Y,Z: where the body is touched, near the surface, in the mesh's unit")
      ->required();
  command->add_option(
      "--normal", options->normal,
      "X,Y,Z: outward direction, any length > 0, need only be roughly right (default: the "
      "region's own)");
  auto* radius =
      command->add_option("--radius-mm", options->radius_mm,
                          "radius of the fitted region in mm, > 0 (default: about 40 vertices)");
  add_mesh_options(*command, options->unit, options->part, " and of --point");
  const CLI::Option* page = command->add_option(
      "--page", options->page,
      "HTML file to write: the surface in 3-D with the region and the quadric, as softfinger mesh");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "Samples:\n"
      "  softfinger fit sphere.stl --point 0,0,20 --radius-mm 3\n"
      "  softfinger fit sphere.stl --point 0,0,20 --normal 0,0,1 --unit mm --json");
  command->callback([options, radius, page, &action] {
    options->write_page = page->count() > 0;
    options->radius_given = radius->count() > 0;
    action = [options] { return run_fit(*options); };
  });
}

}  // namespace softfinger::commands
