#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <optional>

#include "analytic/python/bindings/contacts.h"
#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/pressure/gradient.h"

namespace softfinger::python {
namespace {

TriangleSurface surface_of(const Numbers& vertices_m,
                           const py::array_t<int, py::array::c_style>& triangles) {
  TriangleSurface surface;
  const double* vertex = rows(vertices_m, 3);
  for (py::ssize_t i = 0; i < vertices_m.shape(0); ++i)
    surface.vertices_m.emplace_back(vertex[3 * i], vertex[3 * i + 1], vertex[3 * i + 2]);
  const int* corner = triangles.data();
  for (py::ssize_t i = 0; i < triangles.shape(0); ++i)
    surface.triangles.push_back({corner[3 * i], corner[3 * i + 1], corner[3 * i + 2]});
  return surface;
}

py::dict fit(const Numbers& vertices_m, const py::array_t<int, py::array::c_style>& triangles,
             const Eigen::Vector3d& point_m, const std::optional<Eigen::Vector3d>& outward_normal,
             double region_radius_m) {
  const TriangleSurface surface = surface_of(vertices_m, triangles);
  const Eigen::Vector3d* normal = outward_normal ? &*outward_normal : nullptr;
  QuadricFit found;
  std::array<double, 2> change_m{};
  {
    const py::gil_scoped_release others_may_run;
    found = fit_quadric(surface, point_m, normal, region_radius_m);
    change_m = radii_region_change_m(surface, point_m, normal, found);
  }
  const auto pair = [](const std::array<double, 2>& values) {
    return Eigen::Vector2d(values[0], values[1]);
  };
  py::dict result;
  result["A_per_m"] = found.quadric.A_per_m;
  result["B_per_m"] = found.quadric.B_per_m;
  result["C_per_m"] = found.quadric.C_per_m;
  result["covariance_per_m2"] = found.covariance_per_m2;
  result["radii_m"] = pair(found.principal.radii_m);
  result["axis_rad"] = found.principal.axis_rad;
  result["radii_std_m"] = pair(found.radii_std_m);
  result["radii_region_change_m"] = pair(change_m);
  result["origin_m"] = found.origin_m;
  result["normal"] = found.normal;
  result["x_axis"] = found.x_axis;
  result["residual_rms_m"] = found.residual_rms_m;
  result["region_radius_m"] = found.region_radius_m;
  result["area_m2"] = found.area_m2;
  result["points"] = found.points;
  result["outliers"] = found.outliers;
  result["has_sharp_edge"] = found.surface_kind == SurfaceKind::sharp_edge;
  result["sharpest_kink_rad"] = found.sharpest_kink_rad;
  return result;
}

/// Radii and angle (n, 5) of pairs of bodies to R', R'', axis and the finger's curvatures (n, 6);
/// all zero where the bodies touch in no ellipse.
Numbers gaps(const Numbers& bodies) {
  const double* body = rows(bodies, 5);
  const py::ssize_t count = bodies.shape(0);
  Numbers result({count, py::ssize_t(6)});
  double* out = result.mutable_data();
  const py::gil_scoped_release others_may_run;
  for (py::ssize_t i = 0; i < count; ++i, body += 5, out += 6) {
    ContactProblem problem;
    set_bodies({body[0], body[1], body[2], body[3], body[4]}, problem);
    const SurfaceCurvature& finger = problem.finger_curvature;
    out[0] = problem.radii.major_m;
    out[1] = problem.radii.minor_m;
    out[2] = problem.radii.axis_rad;
    out[3] = finger.xx_per_m;
    out[4] = finger.yy_per_m;
    out[5] = finger.xy_per_m;
  }
  return result;
}

}  // namespace

void bind_geometry(py::module_& module) {
  module.def("fit", &fit);
  module.def("gaps", &gaps);
}

}  // namespace softfinger::python
