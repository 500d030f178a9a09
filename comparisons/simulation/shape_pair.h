#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>

#include "comparisons/simulation/surface_point.h"
#include "comparisons/simulation/touching_point.h"

/// Internal to the collision detection: two shapes that may touch.
namespace softfinger::simulation {

/// The nearest points of two shapes, in the world.
struct Nearest {
  Eigen::Vector3d on_a = Eigen::Vector3d::Zero(), on_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< from a to b
  double gap_m = std::numeric_limits<double>::infinity();
};

struct ShapePair {
  const Part &a, &b;
  double reach_m = 0;  ///< points with a larger gap are of no interest
  long first_id = 0;   ///< the pair has kSlots contact ids from here on

  double smaller_m() const { return std::min(a.radius_m, b.radius_m); }
};

/// A contact keeps its id for as long as it lasts: its pair of shapes, and what makes the contact
/// within the pair.
namespace slot {
constexpr long kElliptic = 0;      ///< the one point of two round surfaces
constexpr long kNearest = 1;       ///< the nearest point
constexpr long kBearing = 2;       ///< + number of the bearing point of shape a, then of shape b
constexpr long kMostBearing = 16;  ///< of one shape: more than `bearing_points` gives
constexpr long kMostEdges = 12;    ///< of one shape: a box has as many
constexpr long kCrossing = kBearing + 2 * kMostBearing;          ///< + 12 edge of a + edge of b
constexpr long kFriction = kCrossing + kMostEdges * kMostEdges;  ///< that of two flat faces
}  // namespace slot
constexpr long kSlots = slot::kFriction + 1;
/// The number of the pair of shapes that a contact belongs to.
constexpr long pair_of(long contact_id) { return contact_id / kSlots; }

}  // namespace softfinger::simulation
