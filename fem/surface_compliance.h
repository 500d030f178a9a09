#pragma once

#include <Eigen/Core>
#include <vector>

#include "fem/layer_model.h"

namespace softfinger::fem {

/// What a state of contact, friction included, is invariant under. Fewer points stand for the rest.
enum class Invariance {
  none,      ///< all of the contact is solved for: any tangential force and torque
  half_turn  ///< rotation by pi about the normal: load and twist; half of the contact
};

/// The surface's compliance among the points of a whole contact, composed of quarter problems.
///
/// Where a rotation maps a point to itself (the centre), `force` below is its force divided by the
/// number of such rotations: that keeps the compliance symmetric and every sum simple.
struct SurfaceCompliance {
  Eigen::Matrix2Xd position;   ///< of each point, in h
  Eigen::VectorXd area;        ///< each point's share of the surface, in h²; scaled like `force`
  Eigen::MatrixXd tangential;  ///< 2n x 2n, blocks in the order x, y
  Eigen::MatrixXd normal;      ///< n x n, into the layer
  Eigen::MatrixXd normal_tangential;  ///< n x 2n: displacement into the layer by tangential force
  std::vector<int> quarter_node;      ///< of the model, for each point
  /// Of the quarter problem odd in x and in y, which holds a twist of the stuck contact: 3 x 3
  /// blocks for the nodes that were given.
  Eigen::MatrixXd odd;
  std::vector<int> odd_node;
  int copies = 1;  ///< sums over the points times this are sums over the contact

  Eigen::Index size() const { return position.cols(); }
};

/// @param nodes  of the quarter model: those that may come into contact
/// Factorises two quarter problems for a half turn, four for no invariance.
SurfaceCompliance surface_compliance(const LayerModel& model, const std::vector<int>& nodes,
                                     Invariance invariance);

}  // namespace softfinger::fem
