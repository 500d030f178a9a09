#pragma once

#include <Eigen/Core>

#include "softfinger/input/contact_problem.h"

namespace softfinger::simulation {

/// Place where two bodies touch or nearly do, and the curvatures of their surfaces there.
struct TouchingPoint {
  int a = -1, b = -1;                                 ///< bodies, a < b
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< halfway between the surfaces
  /// Columns: long axis, short axis, normal from `a` to `b`. Any tangents unless `elliptic`.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  double gap_m = 0;                 ///< along the normal; negative: overlap
  bool elliptic = false;            ///< both relative curvatures are positive and known
  RelativeRadii radii;              ///< of an elliptic point
  SurfaceCurvature curvature_of_a;  ///< along its axes; `b` has the rest
  bool a_is_sphere = false, b_is_sphere = false;  ///< of an elliptic point: exact spheres
  long id = -1;                                   ///< the same for as long as the contact lasts
};

}  // namespace softfinger::simulation
