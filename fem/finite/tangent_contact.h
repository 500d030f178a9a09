#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

namespace softfinger::fem::finite {

/// The surface's response to displacements w of its nodes into the layer, about a deformed state:
/// contact forces f = stiffness w - force. Symmetric. Under pressure it is positive definite only
/// on nodes that are free: pressed nodes would be unstable if they were released under constant
/// forces.
struct SurfaceResponse {
  Eigen::MatrixXd stiffness;
  Eigen::VectorXd force;
};

/// A contact about such a state.
struct TangentContact {
  Eigen::VectorXd force, displacement;
  double approach = 0;
  int active = 0;
};

/// Problems with one stiffness share this factor while the same nodes are free.
struct ReleasedFactor {
  std::vector<Eigen::Index> touching, free;
  Eigen::MatrixXd of_touching, free_by_touching;
  Eigen::PartialPivLU<Eigen::MatrixXd> factor;
};

/// Solves w >= cosine (approach - gap), f >= 0, f (w - cosine (approach - gap)) = 0 by a
/// primal-dual active set, with the approach given, or eliminated by sum(cosine f) = load. Only the
/// free nodes' block of the stiffness is factorised. Any consistent units.
///
/// @param cosine  n, > 0, of the angle between a node's displacement and the approach
/// @param gap     n, along the approach, any origin
/// @param load    <= 0: the approach is given
/// @param start   n forces, > 0 on the nodes that likely touch; all zero where unknown
/// @param kept    of an earlier problem with the same stiffness; replaced; may be null
/// @throws ConvergenceError when the set still changes after 200 steps
TangentContact solve_tangent_contact(const SurfaceResponse& response, const Eigen::VectorXd& cosine,
                                     const Eigen::VectorXd& gap, double load, double approach,
                                     const Eigen::VectorXd& start, ReleasedFactor* kept = nullptr);

}  // namespace softfinger::fem::finite
