#pragma once

#include <Eigen/Core>
#include <string>

#include "softfinger/input/triangle_surface.h"

namespace softfinger {

/// Mass, centre and inertia of a rigid body, in the body's frame.
struct MassProperties {
  double mass_kg = 0;                                       ///< > 0
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();       ///< of mass
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about the centre of mass
};

/// Mass 1 kg; scale mass and inertia together. Along their z axis, centred at the origin.
MassProperties unit_mass_of_ellipsoid(const Eigen::Vector3d& semi_axes_m);
MassProperties unit_mass_of_box(const Eigen::Vector3d& size_m);
MassProperties unit_mass_of_cylinder(double radius_m, double length_m);
/// `length_m` without the half-spheres.
MassProperties unit_mass_of_capsule(double radius_m, double length_m);

/// Mass properties of the solid inside a closed surface, with a mass of 1 kg. By the divergence
/// theorem, exact for facets.
/// `volume_m3`, if given, receives the volume.
/// @throws InputError(where) unless every edge joins two triangles that agree about outside, and
/// for a volume that is not positive.
MassProperties unit_mass_of_closed_surface(const TriangleSurface& surface, const std::string& where,
                                           double* volume_m3 = nullptr);

/// Scales a body of unit mass to another mass.
MassProperties with_mass(MassProperties unit_mass, double mass_kg);

/// @throws InputError(where) unless the mass is positive, the inertia symmetric, positive definite
/// and such that no principal moment exceeds the sum of the other two: no mass distribution has
/// that.
void require_physical(const MassProperties& mass, const std::string& where);

}  // namespace softfinger
