#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "fem/contact/pressure_fit.h"
#include "fem/contact/rigid_object.h"
#include "fem/contact/touching_outline.h"

namespace softfinger::fem {

/// The contact's shape as measured on one mesh, in units of h and E.
struct ContactShape {
  double a = 0, b = 0;              ///< of the best ellipse, seen along the load
  double block_a = 0, block_b = 0;  ///< along the surface's x and y, for the next mesh
  double turn_rad = 0;              ///< of the long axis from x; 0 with both mirror planes
  double projected_area = 0;        ///< seen along the load
  double departure = 0;             ///< largest distance of the outline from the ellipse, over b
  std::vector<Eigen::Matrix2Xd> outlines;  ///< seen along the load, the largest first
  double peak = 0;                         ///< largest pressure
  double centre_pressure = 0;              ///< at the contact's middle
  double cell = 0;  ///< side of the surface's cells; 0 on a mesh from outside, whose cells differ
  /// The pressure's fit, which gives all of the above; none: outlines and pressure are those of the
  /// nodes. In layered materials the pressures always are.
  std::optional<PressureFit> fit;
};

/// Why a contact's shape cannot be measured on its mesh.
struct Unmeasured {
  bool outgrew_patch = false;  ///< a larger patch may do; else the cells are too large
  ConvergenceError error;      ///< for a caller that has no other mesh
};

/// A contact on one mesh.
struct NodalContact {
  explicit NodalContact(const NodalPressure& nodal) : pressure(nodal) {}

  NodalPressure pressure;
  MirrorPlanes planes;              ///< the nodes are those of one image
  double rough_a = 0, rough_b = 0;  ///< semi-axes along the surface
  Eigen::VectorXd nodal_pressure;   ///< force over the node's area
  /// Takes a point of the surface to the place where it is seen along the load.
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> place;
  Eigen::Matrix2Xd position;                   ///< of each node, seen along the load
  std::function<Eigen::VectorXd()> clearance;  ///< of each node from the object
  double modulus = 1;                          ///< E / (1 - nu²) of the surface's material
  bool regular = true;                         ///< faces are a grid of rectangles
  /// The outline of the nodes lies outside the edge by this many cells.
  double outline_outside = 0;
};

/// Semi-axes along x and y of a pressure (1 - r²)^n, in the block, from its second moments; its
/// exponent n, 1/2 of a half-space to 2 of a thin incompressible layer, from its fourth ones. Rough
/// but robust.
Eigen::Vector2d axes_of_moments(const std::vector<SurfaceNode>& nodes,
                                const Eigen::VectorXd& force);

/// Semi-axes of the ellipse along x and y about the block's origin that holds all nodes that touch,
/// as long as the ellipse of their second moments.
Eigen::Vector2d holding_axes(const std::vector<SurfaceNode>& nodes, const Eigen::VectorXd& force,
                             MirrorPlanes planes);

/// Area of an object's surface within outlines seen along the load, over their own area: what
/// touches has the object's slope.
double mean_secant(const std::vector<Eigen::Matrix2Xd>& outlines, const RigidObject& object);

/// With both mirror planes the shape is that of a fitted pressure, if there is one. Otherwise it is
/// the outline that the nodes and their images tell, as a smooth curve where one follows it.
Outcome<ContactShape, Unmeasured> measure_shape(const NodalContact& contact);

}  // namespace softfinger::fem
