#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "comparisons/input/scene.h"
#include "softfinger/dynamics/multibody.h"
#include "softfinger/geometry/relative_curvature.h"

namespace softfinger::simulation {

/// Where two bodies touch or nearly do, and how their surfaces are curved there.
struct TouchingPoint {
  int a = -1, b = -1;                                 ///< bodies, a < b
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< halfway between the surfaces
  /// Columns: long axis, short axis, normal from `a` to `b`. Any tangents unless `elliptic`.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  double gap_m = 0;       ///< along the normal; negative: overlap
  bool elliptic = false;  ///< both relative curvatures positive and known
  RelativeRadii radii;    ///< if so
  long id = -1;           ///< the same for as long as the contact lasts
};

/// Finds the touching points of all bodies of a scene. FCL finds the pairs and their nearest
/// points; the local second-order geometry (exact for primitives, quadrics fitted to meshes:
/// Ciocarlie et al. 2007, eq. 7, 8) then finds the common normal to round-off and the relative
/// curvature.
///
/// Bodies are moved apart by a little along the last normal before they are given to FCL, which
/// knows no direction between bodies that touch; a common normal does not change by that.
///
/// Two round surfaces touch in one point. Flat and line contacts get the points that bear them:
/// corners, points of a rim, ends of a line.
class CollisionDetector {
 public:
  explicit CollisionDetector(const input::Scene& scene);
  ~CollisionDetector();

  /// Appends all points whose gap may close within `time_step_s` at twice the current velocities,
  /// or is below a hundredth of the smaller body.
  void find(const Multibody& bodies, double time_step_s, std::vector<TouchingPoint>& points);

  /// @throws InputError(file) when bodies overlap by more than 1e-4 of the smaller one.
  void require_no_overlap(const Multibody& bodies);

  /// How often quadrics were fitted to meshes so far.
  int fits() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger::simulation
