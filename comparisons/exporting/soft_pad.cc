#include "comparisons/exporting/soft_pad.h"

#include <algorithm>

namespace softfinger::exporting {
namespace {

double uniform_eccentricity_m(const ConvexOutline& outline) {
  return outline.radius_integral_m3(outline.centroid_m()) / outline.area_m2();
}

}  // namespace

SoftContact soft_pad(const PadModel& model, const PadProblem& problem,
                     const PadPrediction& prediction) {
  const ConvexOutline& outline = problem.shape->outline();
  SoftContact contact;
  contact.friction_coefficient = problem.load.friction_coefficient;
  contact.load_N = problem.load.normal_force_N;
  contact.eccentricity_m = prediction.eccentricity_m;
  contact.indentation_m = prediction.indentation_m;
  contact.normal_stiffness_N_per_m = prediction.normal_stiffness_N_per_m;
  contact.torsional_stiffness_Nm_per_rad = prediction.torsional_stiffness_Nm_per_rad;
  double corner_m = 0;
  for (const Eigen::Vector2d& vertex : outline.vertices_m())
    corner_m = std::max(corner_m, (vertex - outline.centroid_m()).norm());
  PadProblem centred = problem;
  centred.load_at_m.reset();
  const Eigen::Vector2d extent_m = outline.extent_m();
  contact.face =
      PadFace{extent_m.x(),
              extent_m.y(),
              outline.area_m2(),
              problem.layer.thickness_m,
              model.predict(centred).eccentricity_m,
              corner_m,
              uniform_eccentricity_m(outline),
              uniform_eccentricity_m(ConvexOutline::rounded_rectangle(extent_m.x(), extent_m.y()))};
  return contact;
}

}  // namespace softfinger::exporting
