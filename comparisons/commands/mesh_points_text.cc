#include "comparisons/commands/mesh_points_text.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <utility>

#include "comparisons/commands/commands.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/mesh_points.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "softfinger/geometry/surface_region.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {

Eigen::Vector3d parse_vector(const std::string& flag, const std::string& text,
                             const std::string& allowed) {
  Eigen::Vector3d vector;
  const char* next = text.c_str();
  for (int i = 0; i < 3; ++i) {
    char* end = nullptr;
    vector[i] = std::strtod(next, &end);
    const char expected = i < 2 ? ',' : '\0';
    if (end == next || *end != expected || !std::isfinite(vector[i]))
      throw InputError("command line", flag, "\"" + text + "\"", allowed);
    next = end + 1;
  }
  return vector;
}

meshes::SurfaceFile read_typed_surface(const std::string& path, double metres_per_unit) {
  if (path != "-") return meshes::read_surface(path, metres_per_unit);
  return meshes::parse_surface(system::read_standard_input(meshes::kLargestSurface_bytes),
                               "standard input", metres_per_unit);
}

std::string toml_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7f) {
      quoted += fmt::format("\\u{:04x}", code);
      continue;
    }
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

report::MeshPoint describe_point(const TriangleSurface& surface, const std::string& name,
                                 const Eigen::Vector3d& point_m, const Eigen::Vector3d* normal) {
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
    if (fit.surface_kind == SurfaceKind::sharp_edge)
      point.doubt = fmt::format("a sharp edge of {:.3g}° lies in the region",
                                fit.sharpest_kink_rad * 180 / kPi);
    // Of the two radii the smaller one is what a fit knows best.
    const double sharper_m = std::abs(fit.principal.radii_m[1]);
    constexpr double kKnown = 0.5;
    if (const double part = fit.radii_std_m[1] / sharper_m; part > kKnown && std::isfinite(part))
      point.doubt += fmt::format("{}the fit knows the smaller radius to ± {:.0f} % only",
                                 point.doubt.empty() ? "" : "; ", 100 * part);
  } catch (const InputError& error) {
    point.doubt = point.normal.isZero(0)
                      ? "the surface ends here: none of its facets faces this way"
                      : std::string("no quadric: ") + error.what();
  } catch (const ConvergenceError& error) {
    point.doubt = std::string("no quadric: ") + error.what();
  }
  return point;
}

report::MeshPoint point_near(const TriangleSurface& surface, const std::string& near,
                             const std::string& unit, const std::string& path) {
  const Eigen::Vector3d point_m =
      (unit == "m" ? 1 : 1e-3) *
      parse_vector("--near", near, "X,Y,Z: three finite numbers in the mesh's unit");
  prediction::require_point_on_surface(surface, point_m, path, "--near");
  const internal::SurfaceNeighbourhood neighbourhood(surface, point_m, nullptr);
  return describe_point(surface, "nearest to " + near, neighbourhood.centre_m(), nullptr);
}

std::string geometry_line(const std::string& mesh, const std::string& unit,
                          const report::MeshPoint& point) {
  if (point.normal.isZero(0)) return "";
  // 0.1 µm and 1e-5 rad; a zero without a minus sign.
  const auto rounded = [](double value, double step) {
    return std::round(value / step) * step + 0.0;
  };
  const auto list = [&](const Eigen::Vector3d& v, double step) {
    return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", rounded(v.x(), step), rounded(v.y(), step),
                       rounded(v.z(), step));
  };
  return fmt::format("finger = {{ mesh = {}, unit = \"{}\", point_mm = {}, normal = {} }}",
                     toml_text(mesh == "-" ? "FILE.stl" : mesh), unit,
                     list(1e3 * point.point_m, 1e-4), list(point.normal, 1e-5));
}

void write_fits_page(const std::string& file, const std::string& mesh, const std::string& unit,
                     const TriangleSurface& surface, std::vector<report::MeshPoint> points,
                     const std::string& command_line) {
  report::MeshPage page;
  page.mesh = mesh;
  page.mesh_toml = toml_text(mesh);
  page.unit = unit;
  page.facts = facts_in_words(surface) + ".";
  for (report::MeshPoint& point : points) point.toml = geometry_line(mesh, unit, point);
  page.points = std::move(points);
  page.version = "softfinger " + system::program_version();
  page.command = command_line;
  system::write_file_atomically(file, report::mesh_page(surface, page));
  remark("the page is " + file);
}

std::string facts_in_words(const TriangleSurface& surface) {
  const prediction::SurfaceFacts facts = prediction::facts_of(surface);
  const Eigen::Vector3d size_mm = 1e3 * (facts.largest_m - facts.least_m);
  return fmt::format(
      "{} triangles, {} vertices, {}; {:.4g} x {:.4g} x {:.4g} mm, {:.4g} mm² of surface",
      surface.triangles.size(), surface.vertices_m.size(),
      facts.open_edges == 0 ? "closed" : fmt::format("open at {} edges", facts.open_edges),
      size_mm.x(), size_mm.y(), size_mm.z(), 1e6 * facts.area_m2);
}

}  // namespace softfinger::commands
