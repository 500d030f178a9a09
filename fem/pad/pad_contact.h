#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

#include "fem/pad/face_response.h"
#include "fem/pad/pad_problem.h"

/// A pad's face under load on one mesh: plain numbers and dense algebra, lengths in h, stresses in
/// E, places from the centroid of the touched face.
namespace softfinger::fem {

/// The load on the face and the line along which it acts.
struct FaceLoad {
  double force = 0;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
};

/// A pressed face.
struct PressedFace {
  Eigen::Vector3d motion =
      Eigen::Vector3d::Zero();  ///< approach at the origin, tilts along x and y (`FaceMotion`)
  Eigen::VectorXd force;        ///< per node, into the pad
  double lifted_area = 0;       ///< has come off the object
  int iterations = 0;           ///< of the active set; 0: all of the face touches
};

/// The point at which a load does not tilt the face.
Eigen::Vector2d stiffness_centre(const FaceResponse& face, PadPressing pressing);

/// Solves for the face's motion under a load. A frictionless face lifts off where the pad would
/// have to be pulled: a primal-dual active set on the nodal forces.
/// @throws ConvergenceError for the active set
PressedFace press_face(const FaceResponse& face, PadPressing pressing, const FaceLoad& load);

/// Whether a pressed face has to be pulled somewhere, by more than round-off.
bool has_tension(const PressedFace& pressed);

/// The largest distances, along x and y, of a load from the centre of stiffness without tension
/// anywhere: the smaller one of both senses. 0 where there is tension without any tilt.
/// @param free  whether the stuck face may move sideways
Eigen::Vector2d tilt_limit(const FaceResponse& face, PadPressing pressing, bool free);

/// Moment per angle of a face that is free to approach: of turns that make it deeper along x, and
/// along y.
/// @param free  whether the stuck face may move sideways
Eigen::Vector2d tilt_stiffness(const FaceResponse& face, PadPressing pressing, bool free);

/// Moment per angle about the normal of the stuck face, free to move sideways.
double torsional_stiffness(const FaceResponse& face);

/// The resultant of a pressure.
struct PressureArm {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double arm = 0;  ///< int p r dA / int p dA about the centre
};
PressureArm arm_of(const FaceResponse& face, const Eigen::VectorXd& force);

/// The peak of the pressure where the outline, shrunk towards its centroid, still encloses it.
double peak_within(const FaceResponse& face, const ConvexOutline& outline,
                   const Eigen::VectorXd& force, double share);

}  // namespace softfinger::fem
