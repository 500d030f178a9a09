#include "comparisons/prediction/local_geometry.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "comparisons/input/mesh_file.h"
#include "comparisons/input/mesh_unit.h"
#include "comparisons/prediction/mesh_points.h"
#include "meshes/io/read_surface.h"
#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/geometry/surface_region.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::prediction {
namespace {

std::string surface_key(const input::MeshBody& mesh) {
  return fmt::format("{} {} {}", mesh.path.string(), mesh.metres_per_unit.value_or(0), mesh.part);
}

/// The model that predicts how large a contact is: one and the same as far as it has answers, so
/// that the region grows with the load. Asked many times per load, therefore a closed form.
const PressureModel& patch_model(const ContactProblem& problem) {
  static const PressureModel &layer = *find_pressure_model("bonded_layer"),
                             &half_space = *find_pressure_model("hertz");
  return layer.predict(problem).has_answer ? layer : half_space;
}

bool is_flat(const input::CaseBody& body) {
  const auto* quadric = std::get_if<input::QuadricBody>(&body);
  return quadric && std::isinf(quadric->radius_x_m) && std::isinf(quadric->radius_y_m);
}

/// @param fitted_m  radius of the region in which the curvatures were fitted; 0: they are exact
void require_ellipse(const RelativeCurvature& relative, const std::string& where, double fitted_m) {
  // Over a flat region of a file the coordinates' single precision leaves less.
  constexpr double kFlatSlope = 1e-4;
  const auto& curvature = relative.curvatures_per_m;
  const std::string numbers =
      fmt::format(" (relative curvatures {:.4g} and {:.4g} per metre)", curvature[0], curvature[1]);
  const bool curved =
      std::max(std::abs(curvature[0]), std::abs(curvature[1])) * fitted_m > kFlatSlope;
  if (relative.kind == ContactKind::conforming && curved)
    throw InputError(where,
                     "no contact ellipse: both relative curvatures lie within the fit's error of "
                     "zero, the gap may be a saddle" +
                         numbers,
                     "", "");
  switch (relative.kind) {
    case ContactKind::elliptic:
      return;
    case ContactKind::line:
      throw InputError(where,
                       "no contact ellipse: the bodies touch along a line, one relative curvature "
                       "vanishes; a line needs its length: finger = { roller_radius_mm = 14, "
                       "length_mm = 28 }, or object = { cylinder_radius_mm = 7 } on a flat pad" +
                           numbers,
                       "", "");
    case ContactKind::conforming:
      throw InputError(where,
                       "no contact ellipse: the bodies conform, flat on flat, both relative "
                       "curvatures vanish" +
                           numbers,
                       "", "");
    case ContactKind::saddle:
      throw InputError(
          where,
          std::string("no contact ellipse: ") +
              (curvature[1] < 0 ? "the gap closes in every direction" : "the gap is a saddle") +
              ", the bodies would interpenetrate beside the point" + numbers,
          "", "");
  }
}

}  // namespace

void require_point_on_surface(const TriangleSurface& surface, const Eigen::Vector3d& point_m,
                              const std::string& where, const std::string& field) {
  constexpr double kFarthest = 0.05;
  const internal::SurfaceNeighbourhood neighbourhood(surface, point_m, nullptr);
  if (neighbourhood.distance_m() > kFarthest * neighbourhood.extent_m())
    throw InputError(where, field,
                     fmt::format("{:.4g}, {:.4g}, {:.4g} mm", 1e3 * point_m.x(), 1e3 * point_m.y(),
                                 1e3 * point_m.z()),
                     fmt::format("a point on the surface; the nearest triangle is {:.4g} mm away",
                                 1e3 * neighbourhood.distance_m()));
}

GeometryResolver::GeometryResolver(const input::Case& contact_case, const GeometryResolver* known)
    : case_(contact_case) {
  const auto* pair = std::get_if<input::BodyPair>(&case_.geometry);
  if (!pair) return;
  const auto keep = [&](input::MeshBody mesh, const Surface& surface) {
    surfaces_.emplace(surface_key(mesh), surface);
    // A body that was placed has the unit that was guessed for it.
    mesh.metres_per_unit = surface.metres_per_unit;
    surfaces_.emplace(surface_key(mesh), surface);
  };
  for (const input::CaseBody* body : {&pair->finger, &pair->object}) {
    const auto* mesh = std::get_if<input::MeshBody>(body);
    if (!mesh || surfaces_.count(surface_key(*mesh))) continue;
    if (known) {
      if (const auto found = known->surfaces_.find(surface_key(*mesh));
          found != known->surfaces_.end()) {
        keep(*mesh, found->second);
        continue;
      }
    }
    std::error_code ignored;
    if (!std::filesystem::exists(mesh->path, ignored))
      throw InputError(mesh->where, "mesh", mesh->path.string(),
                       std::string("a file in the case file's folder, in ") + meshes::kMeshFormats +
                           ", or a built-in mesh; this one does not exist");
    auto file = input::read_mesh_file(mesh->path, mesh->part, mesh->metres_per_unit);
    const bool is_finger = body == &pair->finger;
    std::vector<Eigen::Vector3d> touched_m;
    for (const input::CaseBody* other : {&pair->finger, &pair->object})
      if (const auto* also = std::get_if<input::MeshBody>(other);
          also && also->path == mesh->path && also->part == mesh->part && !also->along)
        touched_m.push_back(also->near_m ? *also->near_m : also->point_m);
    keep_outer_skin(file, touched_m);
    if (is_finger) input::require_finger_size(file, mesh->where, input::UnitIsTold::in_a_file);
    for (const std::string& text :
         {meshes::repairs(file),
          input::unit_remark(file, is_finger ? input::MeshRole::finger : input::MeshRole::object,
                             input::UnitIsTold::in_a_file)})
      if (!text.empty()) remarks_.push_back(mesh->path.string() + ": " + text);
    keep(*mesh, {std::make_shared<const TriangleSurface>(std::move(file.surface)),
                 file.metres_per_unit, file.own_metres_per_unit == file.metres_per_unit});
  }
}

GeometryResolver::GeometryResolver(const input::Case& contact_case,
                                   const std::shared_ptr<const TriangleSurface>& mesh)
    : case_(contact_case) {
  const auto* pair = std::get_if<input::BodyPair>(&case_.geometry);
  if (!pair) return;
  for (const input::CaseBody* body : {&pair->finger, &pair->object})
    if (const auto* known = std::get_if<input::MeshBody>(body))
      surfaces_.emplace(surface_key(*known),
                        Surface{mesh, known->metres_per_unit.value_or(1e-3), false});
}

const TriangleSurface& GeometryResolver::surface(const input::MeshBody& mesh) const {
  return *surfaces_.at(surface_key(mesh)).surface;
}

input::MeshBody GeometryResolver::placed(const input::MeshBody& mesh) const {
  input::MeshBody body = mesh;
  const Surface& surface_there = surfaces_.at(surface_key(mesh));
  body.metres_per_unit = surface_there.metres_per_unit;
  body.is_own_unit = surface_there.is_own_unit;
  if (mesh.along) {
    body.point_m = extreme_point_m(surface(mesh), *mesh.along);
    body.normal = *mesh.along;
  } else if (mesh.near_m) {
    const Eigen::Vector3d* normal = mesh.normal ? &*mesh.normal : nullptr;
    require_point_on_surface(surface(mesh), *mesh.near_m, mesh.where, "near_mm");
    body.point_m = internal::SurfaceNeighbourhood(surface(mesh), *mesh.near_m, normal).centre_m();
  }
  return body;
}

void GeometryResolver::add_points(LocalGeometry& geometry) const {
  const auto& pair = std::get<input::BodyPair>(case_.geometry);
  const auto add = [&](const input::CaseBody& body, Eigen::Vector3d& point_m,
                       double& metres_per_unit) {
    const auto* mesh = std::get_if<input::MeshBody>(&body);
    if (!mesh) return;
    const input::MeshBody there = placed(*mesh);
    point_m = there.point_m;
    metres_per_unit = *there.metres_per_unit;
  };
  add(pair.finger, geometry.finger_point_m, geometry.finger_metres_per_unit);
  add(pair.object, geometry.object_point_m, geometry.object_metres_per_unit);
}

ContactBody GeometryResolver::contact_body(const input::CaseBody& body) const {
  if (const auto* quadric = std::get_if<input::QuadricBody>(&body))
    return quadric_from_radii(quadric->radius_x_m, quadric->radius_y_m);
  if (const auto* sphere = std::get_if<input::SphereBody>(&body))
    return quadric_from_radii(sphere->radius_m, sphere->radius_m);
  const input::MeshBody mesh = placed(std::get<input::MeshBody>(body));
  require_point_on_surface(surface(mesh), mesh.point_m, mesh.where, "point_mm");
  return MeshContactPoint{&surface(mesh), mesh.point_m, mesh.normal};
}

namespace {

/// Curvature of a body along the contact's axes.
/// @param turn_rad  from the body's x axis to the contact's
SurfaceCurvature curvature_of(const input::CaseBody& body, const std::optional<QuadricFit>& fit,
                              double turn_rad) {
  if (const auto* sphere = std::get_if<input::SphereBody>(&body))
    return curvature_along(sphere->radius_m, sphere->radius_m, 0);
  if (const auto* quadric = std::get_if<input::QuadricBody>(&body))
    return curvature_along(quadric->radius_x_m, quadric->radius_y_m, turn_rad);
  if (!fit) return {};
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  const Quadric& q = fit->quadric;
  return {2 * (q.A_per_m * c * c + q.B_per_m * s * s + q.C_per_m * c * s),
          2 * (q.A_per_m * s * s + q.B_per_m * c * c - q.C_per_m * c * s),
          2 * (q.B_per_m - q.A_per_m) * c * s + q.C_per_m * (c * c - s * s)};
}

/// Round-off and the fit leave 1 + 1e-4 of the gap's curvature on a plane, and 1e-4 on a flat pad.
double settled(double curvature_per_m, double gap_per_m) {
  constexpr double kSlack = 1e-3;
  const double share = curvature_per_m / gap_per_m;
  if (std::abs(share) < kSlack) return 0;
  return std::abs(share - 1) < kSlack ? gap_per_m : curvature_per_m;
}

}  // namespace

ContactProblem contact_problem(const input::Case& contact_case, const LocalGeometry& geometry,
                               double load_N) {
  ContactProblem problem = contact_case.problem(geometry.radii, load_N);
  problem.finger_curvature = geometry.finger_curvature;
  problem.is_object_spherical = geometry.is_object_spherical;
  return problem;
}

namespace {

/// "the finger's given normal lies 47° off the surface's, which is taken", or empty.
std::string normal_doubt(const char* name, const input::MeshBody& mesh,
                         const std::optional<QuadricFit>& fit) {
  constexpr double kDoubtful_rad = 30 * kPi / 180;
  if (!mesh.normal || !fit) return "";
  const double angle_rad =
      std::atan2(mesh.normal->cross(fit->normal).norm(), mesh.normal->dot(fit->normal));
  if (angle_rad < kDoubtful_rad) return "";
  return fmt::format("the {}'s given normal lies {:.0f}° off the surface's, which is taken", name,
                     angle_rad * 180 / kPi);
}

}  // namespace

void GeometryResolver::add_finger(LocalGeometry& geometry) const {
  const auto& pair = std::get<input::BodyPair>(case_.geometry);
  const std::optional<QuadricFit> none;
  const auto& patch = geometry.patch;
  const RelativeRadii& radii = geometry.radii;
  const SurfaceCurvature finger =
      case_.layer_on_object
          ? curvature_of(pair.object, patch ? patch->object_fit : none,
                         radii.axis_rad - pair.angle_rad)
          : curvature_of(pair.finger, patch ? patch->finger_fit : none, radii.axis_rad);
  const double mean_m = std::sqrt(radii.major_m) * std::sqrt(radii.minor_m);
  geometry.finger_curvature = {settled(finger.xx_per_m, 1 / radii.major_m),
                               settled(finger.yy_per_m, 1 / radii.minor_m),
                               settled(finger.xy_per_m, 1 / mean_m)};
  geometry.is_object_spherical =
      std::holds_alternative<input::SphereBody>(case_.layer_on_object ? pair.finger : pair.object);
}

LocalGeometry GeometryResolver::resolve(double load_N) const {
  LocalGeometry result;
  if (const auto* radii = std::get_if<RelativeRadii>(&case_.geometry)) {
    result.radii = *radii;
    return result;
  }
  const auto& pair = std::get<input::BodyPair>(case_.geometry);
  const bool meshes = std::holds_alternative<input::MeshBody>(pair.finger) ||
                      std::holds_alternative<input::MeshBody>(pair.object);
  if (!meshes) {
    const Eigen::Matrix3d exact = Eigen::Matrix3d::Zero();
    const auto relative =
        relative_curvature(std::get<Quadric>(contact_body(pair.finger)), exact,
                           std::get<Quadric>(contact_body(pair.object)), exact, pair.angle_rad);
    require_ellipse(relative, case_.geometry_where, 0);
    result.radii = relative.radii;
    if (const auto* sphere = std::get_if<input::SphereBody>(&pair.object))
      if (is_flat(pair.finger) && !case_.layer_on_object) result.sphere_radius_m = sphere->radius_m;
    add_finger(result);
    return result;
  }
  try {
    if (!contact_surface_)
      contact_surface_.emplace(contact_body(pair.finger), contact_body(pair.object),
                               pair.angle_rad);
    result.patch = contact_surface_->patch([&](const RelativeRadii& radii) {
      const ContactProblem problem = case_.problem(radii, load_N);
      return patch_model(problem).predict(problem).area_m2();
    });
    result.patch_model =
        patch_model(case_.problem(result.patch->relative.radii, load_N)).card().name;
  } catch (const InputError& error) {
    // The fit does not know the file: the line of the case is added here.
    if (error.field() == "point_mm" || error.field() == "near_mm") throw;
    throw InputError(case_.geometry_where, error.field(), error.value(), error.allowed());
  } catch (const ConvergenceError& error) {
    throw InputError(case_.geometry_where, "surface near the contact point", "",
                     std::string("one that a quadric can follow (") + error.what() + ")");
  }
  require_ellipse(result.patch->relative, case_.geometry_where,
                  std::sqrt(result.patch->region_area_m2 / kPi));
  result.radii = result.patch->relative.radii;
  const auto add_doubt = [&](const char* name, const input::CaseBody& body,
                             const std::optional<QuadricFit>& fit) {
    const auto* mesh = std::get_if<input::MeshBody>(&body);
    const std::string doubt = mesh ? normal_doubt(name, *mesh, fit) : "";
    std::string& remark = result.patch->remark;
    if (!doubt.empty()) remark += (remark.empty() ? "" : "; ") + doubt;
  };
  add_doubt("finger", pair.finger, result.patch->finger_fit);
  add_doubt("object", pair.object, result.patch->object_fit);
  add_finger(result);
  add_points(result);
  return result;
}

/// Position and orientation of the surface: by a quadric, or a plane where none can be fitted.
QuadricFit GeometryResolver::lie_of(const input::MeshBody& body) const {
  const input::MeshBody mesh = placed(body);
  require_point_on_surface(surface(mesh), mesh.point_m, mesh.where, "point_mm");
  const Eigen::Vector3d* given = mesh.normal ? &*mesh.normal : nullptr;
  try {
    constexpr double region_per_thickness = 1.5;
    return fit_quadric(surface(mesh), mesh.point_m, given,
                       region_per_thickness * case_.layer.thickness_m);
  } catch (const InputError&) {
  } catch (const ConvergenceError&) {
  }
  try {
    const internal::SurfaceNeighbourhood neighbourhood(surface(mesh), mesh.point_m, given);
    QuadricFit plane;
    plane.origin_m = neighbourhood.centre_m();
    // At an edge the given normal says how the body is held.
    plane.normal =
        given ? given->normalized() : neighbourhood.region(case_.layer.thickness_m).mean_normal;
    plane.x_axis = surface_axes(plane.normal).col(0);
    return plane;
  } catch (const InputError& error) {
    throw InputError(mesh.where, error.field(), error.value(), error.allowed());
  }
}

LocalGeometry GeometryResolver::place(double load_N) const {
  const auto* pair = std::get_if<input::BodyPair>(&case_.geometry);
  const auto is_mesh = [](const input::CaseBody& body) {
    return std::holds_alternative<input::MeshBody>(body);
  };
  // Radii say all there is about a line or a saddle: what is refused for models is refused here.
  if (!case_.fem_curved || !pair || !(is_mesh(pair->finger) || is_mesh(pair->object)))
    return resolve(load_N);
  LocalGeometry result;
  try {
    return resolve(load_N);
  } catch (const InputError& error) {
    if (error.field() == "point_mm" || error.field() == "near_mm") throw;
    result.no_ellipse =
        error.value().empty() ? error.field() : error.field() + " = " + error.value();
  }
  constexpr double radius_per_thickness = 10;
  result.radii = {radius_per_thickness * case_.layer.thickness_m,
                  radius_per_thickness * case_.layer.thickness_m, 0};
  result.patch.emplace();
  if (const auto* mesh = std::get_if<input::MeshBody>(&pair->finger))
    result.patch->finger_fit = lie_of(*mesh);
  if (const auto* mesh = std::get_if<input::MeshBody>(&pair->object))
    result.patch->object_fit = lie_of(*mesh);
  add_points(result);
  return result;
}

}  // namespace softfinger::prediction
