#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "softfinger/dynamics/bodies/multibody.h"
#include "softfinger/dynamics/step/eccentricity_law.h"
#include "softfinger/friction/friction_shape.h"

namespace softfinger {

/// A point at which two bodies touch, or are about to.
struct Contact {
  int a = -1, b = -1;                                 ///< bodies
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< halfway between the surfaces
  /// Friction acts here, if it acts elsewhere than the normal force. Points that hold one face
  /// share the pressure's centre: limits of the same shape about the same point add up to one limit
  /// of the face's whole normal force, however that is distributed over the points.
  std::optional<Eigen::Vector3d> centre_of_pressure_m;
  const Eigen::Vector3d& friction_point_m() const {
    return centre_of_pressure_m ? *centre_of_pressure_m : point_m;
  }
  /// Columns: along the contact ellipse's long axis, its short axis, the normal from `a` to `b`.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  double gap_m = 0;                                   ///< negative: the bodies overlap
  double friction_coefficient = 0;                    ///< mu, unless the law has it
  double restitution = 0;                             ///< 0 to 1, see TimeStepper
  double eccentricity_m = 0;                          ///< e_n, unless there is a law
  const EccentricityLaw* eccentricity_law = nullptr;  ///< e_n(P), eq. 6; outlives the step
  const FrictionShape* shape = nullptr;  ///< of FrictionRule::limit_surface; outlives the step
  /// Points of the same number hold one flat face, and follow each other in the list: see
  /// TimeStepper for how they share its force.
  static constexpr long kNoFace = -1;
  long face = kNoFace;
  static constexpr long kNoId = -1;
  long id = kNoId;  ///< the same from step to step for as long as the contact lasts
  /// Elastic compliance of the contact before it slides, along the axes and about the normal (m/N,
  /// m/N, rad/(N m)). The friction wrench on body `b` at the end of the step is `elastic_wrench`,
  /// its value at the start, minus the step's elastic displacement over the compliance. Zero: the
  /// contact is rigid until it slides. See presliding.h.
  Eigen::Vector3d compliance = Eigen::Vector3d::Zero();
  Eigen::Vector3d elastic_wrench = Eigen::Vector3d::Zero();
};

/// Collision detection and contact geometry.
class ContactFinder {
 public:
  virtual ~ContactFinder() = default;
  /// Appends the contacts of the current poses. `time_step_s`: how far ahead they may be needed.
  virtual void find(const Multibody& bodies, double time_step_s,
                    std::vector<Contact>& contacts) = 0;
};

}  // namespace softfinger
