#pragma once

#include <Eigen/Core>
#include <vector>

#include "fem/pad/pad_model.h"

namespace softfinger::fem {

/// A curved object on a pad's face without friction, on one mesh: plain numbers, lengths in h,
/// stresses in E. Nodes are those that can be touched, of one side of each mirror plane.
struct CurvedContact {
  double approach = 0;
  Eigen::VectorXd force;  ///< per node, >= 0, of what is meshed: all images of it bear the load
  std::vector<Eigen::Index> touching;
  int iterations = 0;  ///< of the active set
};

/// Displacements of the face's nodes into the pad per normal force on one of them, without
/// friction, for fields of a parity.
class FaceCompliance {
 public:
  /// @throws ConvergenceError, NotEnoughMemory
  FaceCompliance(PadModel& model, Parity parity);

  /// Touching nodes are pressed to `approach` - `gap`, none pulls, and none lies beyond the object:
  /// a primal-dual active set. All forces add up to `load`.
  /// @throws ConvergenceError for the active set
  CurvedContact press(const Eigen::VectorXd& gap, double load) const;

  /// Forces by displacements of the touching nodes, all others being free: shapes by shapes, while
  /// the contact stays what it is.
  /// @param shapes  displacements of all nodes, by columns; those that the parity excludes are zero
  Eigen::MatrixXd resultants(const std::vector<Eigen::Index>& touching,
                             const Eigen::MatrixXd& shapes) const;

 private:
  std::vector<Eigen::Index> node_;  ///< of each row
  Eigen::MatrixXd compliance_;
};

}  // namespace softfinger::fem
