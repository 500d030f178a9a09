#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>

#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/input/contact_problem.h"

namespace softfinger {

/// Kind of contact that two quadrics make near their common point.
enum class ContactKind {
  elliptic,    ///< one ellipse: both relative curvatures positive
  line,        ///< one relative curvature vanishes: a cylinder along a plane; no ellipse
  conforming,  ///< both vanish: flat on flat; no ellipse
  saddle       ///< a relative curvature is negative: the bodies interpenetrate beside the point
};

struct RelativeCurvature {
  ContactKind kind = ContactKind::elliptic;
  RelativeRadii radii;                  ///< meaningful for `elliptic` only
  std::array<double, 2> radii_std_m{};  ///< of R', R'', as in QuadricFit; 0 for exact quadrics
  /// Covariance of (ln R', ln R''), first order; 0 for exact quadrics, for `elliptic` only.
  Eigen::Matrix2d log_radii_covariance = Eigen::Matrix2d::Zero();
  std::array<double, 2> curvatures_per_m{};  ///< 1/R', 1/R'' (ascending), for any kind
};

/// Relative curvature of two bodies in contact (Ciocarlie et al. 2007, eq. 8).
///
/// Both quadrics are depths below the common tangent plane, each into its own body, seen in the
/// finger's contact frame (z along the finger's outward normal); the gap is their sum. `angle_rad`
/// turns the object counter-clockwise about z: its x axis lies at that angle from the finger's.
/// Covariances (of A, B, C; zero for exact quadrics) are propagated to first order.
///
/// A relative curvature counts as zero below 1e-9 of the bodies' largest one, or, between fits,
/// below three of its standard deviations and 1e-3 of the largest one. Two that are both within two
/// standard deviations of zero are `conforming`; a negative one within two of zero, or a positive
/// one within half of one, is a `line`. (A longer ellipse is still an ellipse, whose length is
/// known badly, and its `radii_std_m` says so.) Where the covariance is infinite, the values
/// decide.
RelativeCurvature relative_curvature(const Quadric& finger,
                                     const Eigen::Matrix3d& finger_covariance_per_m2,
                                     const Quadric& object,
                                     const Eigen::Matrix3d& object_covariance_per_m2,
                                     double angle_rad);

/// Standard deviations, first order, of quantities of the relative radii (an ellipse's semi-axes, a
/// torque), each in its own unit: sqrt(g^T S g) with its derivatives g with respect to (ln R',
/// ln R''), by differences outwards from R' >= R'', five calls, and S = `log_radii_covariance`.
/// 0 for exact quadrics, infinite where the covariance is, NaN unless `elliptic` or where the
/// quantity is NaN. What it throws is passed on.
/// @param quantities  the same number of them at every call
Eigen::VectorXd propagated_std(
    const RelativeCurvature& relative,
    const std::function<Eigen::VectorXd(const RelativeRadii&)>& quantities);

}  // namespace softfinger
