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

/// Compliances of the quarter problems among some nodes, by parity. They serve every invariance.
struct QuarterCompliances {
  const LayerModel& model;
  std::vector<int> nodes;  ///< of the quarter model
  /// Even, odd in x and y; then, unless only a half turn is needed, odd in x, odd in y.
  std::vector<Eigen::MatrixXd> by_parity;
};

/// @param nodes  those that may come into contact
/// Factorises two problems if only a half turn's are needed, else four.
QuarterCompliances quarter_compliances(const LayerModel& model, std::vector<int> nodes,
                                       Invariance fewest);

/// Which of the blocks to compose: the tangential one is the largest.
enum class Blocks { all, without_tangential };

/// The surface's compliance among the points of a whole contact, composed of quarter problems.
///
/// Where a rotation maps a point to itself (the centre), `force` below is its force divided by the
/// number of such rotations: that keeps the compliance symmetric and every sum simple.
struct SurfaceCompliance {
  Eigen::Matrix2Xd position;          ///< of each point, in h
  Eigen::VectorXd area;               ///< its share of the surface, in h²; scaled like `force`
  Eigen::MatrixXd normal;             ///< n x n, into the layer
  Eigen::MatrixXd tangential;         ///< 2n x 2n, blocks in the order x, y; empty if left out
  Eigen::MatrixXd normal_tangential;  ///< n x 2n: displacement into the layer by tangential force
  std::vector<int> quarter_node;      ///< of the model, for each point
  int copies = 1;                     ///< sums over points times this are sums over the contact

  Eigen::Index size() const { return position.cols(); }
};

SurfaceCompliance surface_compliance(const QuarterCompliances& quarters, Invariance invariance,
                                     Blocks blocks = Blocks::all);

}  // namespace softfinger::fem
