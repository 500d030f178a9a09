#include "comparisons/commands/mesh_points_text.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/input/mesh_unit.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/mesh_points.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/percent.h"
#include "softfinger/geometry/surface_region.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {

Eigen::Vector3d parse_vector(const std::string& flag, const std::string& text,
                             const std::string& allowed) {
  const std::vector<double> numbers = numbers_of(flag, text, allowed, 3);
  return {numbers[0], numbers[1], numbers[2]};
}

void add_mesh_options(CLI::App& command, std::string& unit, std::string& part,
                      const std::string& also) {
  command
      .add_option("--unit", unit,
                  "of the mesh" + also +
                      ": \"mm\" or \"m\"; default: the one that the file says (DAE, GLB, glTF, "
                      "3MF), else the one in which its width, the middle one of its three sizes, "
                      "is nearer to a finger's 15 mm")
      ->check(CLI::IsMember({"mm", "m"}));
  command.add_option("--part", part,
                     "NAME of one part of a DAE, GLB, glTF or 3MF file, with all that hangs on it; "
                     "default: all parts");
}

meshes::SurfaceFile read_typed_surface(const TypedMesh& typed) {
  std::optional<double> metres_per_unit;
  if (!typed.unit.empty()) metres_per_unit = typed.unit == "m" ? 1 : 1e-3;
  const bool is_input = typed.path == "-";
  const std::string name = is_input ? "standard input" : typed.path;
  if (is_input && !typed.part.empty())
    throw InputError("command line", "--part", "\"" + typed.part + "\"",
                     "with a file: standard input is read as STL or OBJ, which have no parts");
  meshes::SurfaceFile file =
      is_input ? meshes::parse_surface(system::read_standard_input(meshes::kLargestSurface_bytes),
                                       name, metres_per_unit)
               : input::read_mesh_file(typed.path, typed.part, metres_per_unit);
  input::require_finger_size(file, name, input::UnitIsTold::on_the_command_line);
  return file;
}

meshes::SurfaceFile read_typed_skin(const TypedMesh& typed, const std::string& flag,
                                    const std::string& point) {
  meshes::SurfaceFile file = read_typed_surface(typed);
  std::vector<Eigen::Vector3d> touched_m;
  if (!point.empty())
    touched_m.push_back(
        file.metres_per_unit *
        parse_vector(flag, point, "X,Y,Z: three finite numbers in the mesh's unit"));
  prediction::keep_outer_skin(file, touched_m);
  return file;
}

std::string finger_unit_remark(const meshes::SurfaceFile& file) {
  return input::unit_remark(file, input::MeshRole::finger, input::UnitIsTold::on_the_command_line);
}

std::string smooth_point_advice(const TriangleSurface& surface, const Eigen::Vector3d& point_m,
                                const Eigen::Vector3d* normal) {
  const auto smooth = prediction::nearest_smooth_point(surface, point_m, normal);
  if (!smooth) return "";
  return fmt::format("the nearest point that is round and smooth is {:.2g} mm away: near_mm = {}",
                     1e3 * (*smooth - point_m).norm(), prediction::in_millimetres(*smooth));
}

report::MeshPoint describe_point(const TriangleSurface& surface, const std::string& name,
                                 const Eigen::Vector3d& point_m, const Eigen::Vector3d* normal,
                                 Advice advice) {
  report::MeshPoint point;
  point.name = name;
  point.point_m = point_m;
  point.normal.setZero();
  try {
    const internal::SurfaceNeighbourhood there(surface, point_m, normal);
    point.normal = normal ? *normal : there.region(there.radius_with_facets(1)).mean_normal;
    const QuadricFit fit = prediction::fit_around(surface, point_m, normal);
    point.fit = fit;
    point.normal = fit.normal;
    point.doubt = prediction::doubt_of(fit);
  } catch (const InputError& error) {
    point.doubt = point.normal.isZero(0)
                      ? "the surface ends here: none of its facets faces this way"
                      : std::string("no quadric: ") + error.what();
  } catch (const ConvergenceError& error) {
    point.doubt = std::string("no quadric: ") + error.what();
  }
  if (!point.doubt.empty() && advice == Advice::nearest_point)
    if (const std::string words = smooth_point_advice(surface, point_m, normal); !words.empty())
      point.doubt += "; " + words;
  return point;
}

report::MeshPoint point_near(const TriangleSurface& surface, const std::string& near,
                             double metres_per_unit, const std::string& path) {
  const Eigen::Vector3d point_m =
      metres_per_unit *
      parse_vector("--near", near, "X,Y,Z: three finite numbers in the mesh's unit");
  prediction::require_point_on_surface(surface, point_m, path, "--near");
  const internal::SurfaceNeighbourhood neighbourhood(surface, point_m, nullptr);
  return describe_point(surface, "nearest to " + near, neighbourhood.centre_m(), nullptr);
}

std::string geometry_line(const input::NamedMesh& mesh, const report::MeshPoint& point,
                          input::MeshRole role) {
  if (point.normal.isZero(0)) return "";
  // 0.1 µm and 1e-5 rad; a zero without a minus sign.
  const auto rounded = [](double value, double step) {
    return std::round(value / step) * step + 0.0;
  };
  const auto list = [&](const Eigen::Vector3d& v, double step) {
    return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", rounded(v.x(), step), rounded(v.y(), step),
                       rounded(v.z(), step));
  };
  input::NamedMesh named = mesh;
  if (named.file == "-") named.file = "FILE.stl";
  return fmt::format("{} = {{ {}, point_mm = {}, normal = {} }}",
                     role == input::MeshRole::finger ? "finger" : "object", named.entries(),
                     list(1e3 * point.point_m, 1e-4), list(point.normal, 1e-5));
}

std::string verdict_of(const judgement::Pad& pad) {
  const auto flat = pad.face ? prediction::in_words(*pad.face) : "";
  if (!pad.is_usable()) return pad.reason.empty() ? flat : pad.reason;
  const Prediction& p = pad.answer->prediction;
  return fmt::format(
      "usable, torque {:.3g} mN·m, contact {:.3g} x {:.3g} mm, ± {}{}",
      1e3 * pad.answer->friction_ellipsoid(prediction::TorqueRule::exact).max_torque_Nm(),
      2e3 * p.a_m, 2e3 * p.b_m, text::percent(pad.worst),
      pad.face ? fmt::format("; flat, {:.3g} x {:.3g} mm", 1e3 * pad.face->width_m,
                             1e3 * pad.face->length_m)
               : "");
}

void name_mesh(report::MeshPage& page, const input::NamedMesh& mesh) {
  page.mesh = mesh.file;
  page.mesh_entries = mesh.entries();
  page.mesh_options = mesh.options();
  page.metres_per_unit = mesh.metres_per_unit;
}

report::MeshPoint point_of(const judgement::Pad& pad, const input::NamedMesh& mesh,
                           input::MeshRole role) {
  report::MeshPoint point;
  point.name = pad.name;
  point.point_m = pad.point_m;
  point.normal = pad.normal;
  point.fit = pad.fit;
  point.verdict = verdict_of(pad);
  point.toml = geometry_line(mesh, point, role);
  return point;
}

void write_fits_page(const std::string& file, const input::NamedMesh& mesh,
                     const TriangleSurface& surface, report::MeshPage page,
                     const std::string& command_line) {
  name_mesh(page, mesh);
  page.facts = facts_in_words(surface) + ".";
  for (report::MeshPoint& point : page.points) point.toml = geometry_line(mesh, point);
  page.version = "softfinger " + system::program_version();
  page.command = command_line;
  system::write_file_atomically(file, report::mesh_page(surface, page));
  remark("the page is " + file);
}

namespace {

std::string facts_in_words(const TriangleSurface& surface,
                           const std::optional<std::size_t>& open_edges) {
  const prediction::SurfaceFacts facts = prediction::facts_of(surface);
  const std::size_t open = open_edges.value_or(facts.open_edges);
  const Eigen::Vector3d size_mm = 1e3 * (facts.largest_m - facts.least_m);
  return fmt::format(
      "{} triangles, {} vertices, {}; {:.4g} x {:.4g} x {:.4g} mm, {:.4g} mm² of surface",
      surface.triangles.size(), surface.vertices_m.size(),
      open == 0 ? "closed" : fmt::format("open at {} edges", open), size_mm.x(), size_mm.y(),
      size_mm.z(), 1e6 * facts.area_m2);
}

}  // namespace

std::string facts_in_words(const TriangleSurface& surface) {
  return facts_in_words(surface, std::nullopt);
}

std::string facts_in_words(const meshes::SurfaceFile& file) {
  return facts_in_words(file.surface, file.open_edges);
}

}  // namespace softfinger::commands
