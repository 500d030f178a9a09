#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace softfinger::fem {

/// The places where a contact touched on a coarse mesh, in all of its states: a finer mesh's nodes
/// that may touch lie near. For a contact that is no ellipse these are far fewer than those of the
/// ellipse around it.
struct TouchedRegion {
  std::vector<Eigen::Vector2d> places;  ///< of nodes, in the block, over the semi-axes
  double a = 0, b = 0;                  ///< semi-axes
  double spacing = 0;                   ///< of the coarse nodes, in the same way

  /// The distance of a place of the block from what touched. The edge is known to the coarse nodes'
  /// distance.
  double distance(double x, double y) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& place : places)
      nearest = std::min(nearest, (Eigen::Vector2d(x / a, y / b) - place).squaredNorm());
    return std::sqrt(nearest);
  }
};

}  // namespace softfinger::fem
