#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>

#include "softfinger/input/shear_law.h"

namespace softfinger::fem {

/// The largest force of friction on each point of a contact, in the units of the model: the shear
/// law's stress times the point's area.
///
/// What adhesion holds does not open: under a strength that acts without pressure, the points that
/// touch after the pressing without friction keep it, and others never get it. Otherwise a point
/// at the edge, lifted by its own shear, would lose it and touch again, without end.
struct FrictionBound {
  /// Coulomb's law, which needs no areas.
  FrictionBound(double friction_coefficient)  // NOLINT: a coefficient is a bound
      : law(ShearLaw::coulomb(friction_coefficient)) {}
  /// @param strength_area  per point: where the law's strength acts; see `strength_share`
  FrictionBound(const ShearLaw& of, Eigen::VectorXd strength_area)
      : law(of), area(std::move(strength_area)) {}

  ShearLaw law;          ///< its strength in units of E
  Eigen::VectorXd area;  ///< empty for Coulomb's law

  double at(Eigen::Index point, double normal_force) const {
    return law.largest_force_N(std::max(normal_force, 0.0), area.size() > 0 ? area[point] : 0);
  }
  Eigen::VectorXd of(const Eigen::VectorXd& normal_force) const;
};

/// Nodes of a contact that was pressed without friction, or of a quarter of it.
struct TouchedNodes {
  const Eigen::VectorXd& force;   ///< > 0 where a node touches
  const Eigen::VectorXd& area;    ///< of each node, seen along the load
  const Eigen::VectorXd& radius;  ///< relative to the contact's ellipse
  double cell = 0;                ///< side of the cells, in the same way
  double contact_area = 0;        ///< as measured, seen along the load
};

/// Share of each node's area on which a strength acts that needs no pressure: 0 beside the contact,
/// 1 in it. The nodes that touch have not quite the contact's area together; those at its edge, of
/// the outermost cell, take the difference. All 1 where the strength only limits mu p, which
/// vanishes at the edge.
Eigen::VectorXd strength_share(const ShearLaw& law, const TouchedNodes& nodes);

}  // namespace softfinger::fem
