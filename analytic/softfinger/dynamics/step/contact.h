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
  /// Columns: along the contact ellipse's long axis, its short axis, the normal from `a` to `b`.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  double gap_m = 0;                                   ///< negative: the bodies overlap
  double friction_coefficient = 0;                    ///< mu, unless the law has it
  double restitution = 0;                             ///< 0 to 1, see TimeStepper
  double eccentricity_m = 0;                          ///< e_n, unless there is a law
  const EccentricityLaw* eccentricity_law = nullptr;  ///< e_n(P), eq. 6; outlives the step
  const FrictionShape* shape = nullptr;  ///< of FrictionRule::limit_surface; outlives the step
  /// Contacts of the same number hold one flat face. Its points follow each other in the list.
  static constexpr long kNoFace = -1;
  long face = kNoFace;
  enum class FaceRole {
    rigid_point,  ///< one of a rigid face, with friction of its own
    soft_point,   ///< one without friction, of a face that has a contact for it
    friction  ///< the friction of a whole face, at the pressure's centre: under the normal forces
              ///< of the face's points, and without one of its own
  };
  FaceRole role = FaceRole::rigid_point;
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
