#pragma once

#include "comparisons/report/mesh_page.h"
#include "tests/meshes/triangulated_ellipsoid.h"

namespace softfinger::tests {

/// An ellipsoid with semi-axes of 12, 7 and 14 mm.
inline TriangleSurface sample_surface() {
  return meshes::triangulated_ellipsoid({12e-3, 7e-3, 14e-3}, Eigen::Vector3d::Zero(), 32);
}

/// Two points, one with a fit, and a name that a page must not take for markup.
inline report::MeshPage sample_mesh_page() {
  report::MeshPage page;
  page.mesh = "tip <1>.stl";
  page.mesh_entries = "mesh = \"tip <1>.stl\", unit = \"mm\"";
  page.mesh_options = "--unit mm";
  page.facts = "Closed.";
  page.doubts = {"24 mm wide, read in mm?"};
  page.points.resize(2);
  report::MeshPoint& first = page.points[0];
  first.name = "-y";
  first.point_m = {0, -7e-3, 0};
  first.normal = {0, -1, 0};
  first.fit = fit_quadric(sample_surface(), first.point_m, &first.normal, 4e-3);
  first.toml = "finger = { mesh = \"tip <1>.stl\", point_mm = [0, -7, 0], normal = [0, -1, 0] }";
  report::MeshPoint& second = page.points[1];
  second.name = "+x";
  second.point_m = {12e-3, 0, 0};
  second.normal = {1, 0, 0};
  second.doubt = "no quadric: too few vertices";
  second.toml = "finger = { mesh = \"tip <1>.stl\", point_mm = [12, 0, 0], normal = [1, 0, 0] }";
  page.version = "softfinger 0.0.0";
  page.command = "softfinger mesh tip.stl --page tip.html";
  return page;
}

}  // namespace softfinger::tests
