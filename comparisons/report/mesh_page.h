#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/input/triangle_surface.h"

namespace softfinger::report {

/// A point at which the surface may be touched.
struct MeshPoint {
  std::string name;  ///< "-y", "nearest to 0, -7, 0"
  Eigen::Vector3d point_m, normal;
  std::optional<QuadricFit> fit;  ///< none where no quadric follows the surface
  std::string doubt;              ///< why there is none, or what is doubtful about it; else empty
  std::string toml;               ///< line of [geometry] in a case
  std::string verdict = {};       ///< what pressing it gives; empty where it was not pressed
};

/// The answer of `predict`, where the page is of a case: its lines as they are printed.
struct PrintedPrediction {
  std::string case_id;
  std::string answers;  ///< a line for each load, with remarks below that begin with a space
  std::string numbers;  ///< tables of the models
};

struct MeshPage {
  std::string mesh;          ///< as typed
  std::string mesh_entries;  ///< of a case's body: mesh = "tip.stl", unit = "mm"
  std::string mesh_options;  ///< of a command: --unit mm
  double metres_per_unit = 1e-3;
  std::string facts;  ///< size, triangles, closed or not: a sentence or two
  std::vector<std::string> doubts;
  std::vector<MeshPoint> points;
  std::optional<PrintedPrediction> prediction = {};
  std::string version, command;
};

/// One HTML file with the surface in 3-D, the points, and at each the region of the fit and the
/// quadric that was fitted to it. A click on the surface gives the line of a case for that point.
/// Needs no network; without JavaScript the points and their lines are there as a table. Surfaces
/// of more than 60,000 triangles are drawn coarser.
std::string mesh_page(const TriangleSurface& surface, const MeshPage& content);

}  // namespace softfinger::report
