#pragma once

#include <string>

#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/geometry/surface_region.h"

namespace softfinger::internal {

/// `fit_quadric` for a neighbourhood that is kept over several radii.
QuadricFit fit_quadric(const SurfaceNeighbourhood& neighbourhood, double region_radius_m);

/// Takes the facets as the surface itself. For a region with too few vertices, as in a tessellation
/// that is straight in one direction.
QuadricFit fit_quadric_to_facets(const SurfaceNeighbourhood& neighbourhood, double region_radius_m);

/// Covariance of the principal curvatures (ascending) of a quadric whose coefficients have the
/// given covariance. First order: dk = 2 dA vx² + 2 dB vy² + 2 dC vx vy along each principal
/// direction v. Added to it is the square of the amount by which noise pushes two eigenvalues
/// apart, which is second order, about s²/|d| for a difference 2 |d| of the curvatures, but all
/// there is at an umbilic point. Infinite diagonal where the covariance is.
Eigen::Matrix2d principal_curvature_covariance_per_m2(const Quadric& quadric,
                                                      const Eigen::Matrix3d& covariance_per_m2);

/// Standard deviation of a radius of curvature such that two of them reach the far end of the two
/// standard deviations of its curvature: 1/(k - 2 s) - 1/k = 2 (s/k²)/(1 - 2 s/k).
double radius_std_m(double curvature_per_m, double std_per_m);

/// Sets the principal radii, their axis and standard deviations, from quadric and covariance.
void set_principal_radii(QuadricFit& fit, double region_radius_m);

/// Principal curvatures, ascending, in 1/m; the smaller one without cancellation.
std::array<double, 2> principal_curvatures_per_m(const Quadric& quadric);

/// "2.35 mm", for messages.
std::string millimetres(double length_m);

}  // namespace softfinger::internal
