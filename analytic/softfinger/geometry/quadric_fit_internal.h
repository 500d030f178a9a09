#pragma once

#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/geometry/surface_region.h"

namespace softfinger::internal {

/// `fit_quadric` for a neighbourhood that is kept over several radii.
QuadricFit fit_quadric(const SurfaceNeighbourhood& neighbourhood, double region_radius_m);

/// Standard deviations of the principal curvatures (ascending) of a quadric whose coefficients have
/// the given covariance: first order, dk = 2 dA vx² + 2 dB vy² + 2 dC vx vy along each principal
/// direction v. Infinite where the covariance is.
std::array<double, 2> principal_curvature_std_per_m(double axis_rad,
                                                    const Eigen::Matrix3d& covariance_per_m2);

/// Principal curvatures, ascending, in 1/m; the smaller one without cancellation.
std::array<double, 2> principal_curvatures_per_m(const Quadric& quadric);

}  // namespace softfinger::internal
