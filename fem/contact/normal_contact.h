#pragma once

#include <Eigen/Core>
#include <vector>

namespace softfinger::fem {

/// Nodal forces under a rigid indenter pressed on a compliant surface with a given load.
struct NormalContact {
  Eigen::VectorXd force;  ///< per candidate node, >= 0
  double approach = 0;
  int active = 0;
  int iterations = 0;
  double load_residual = 0;             ///< |sum force - load| / load
  double complementarity_residual = 0;  ///< worst penetration relative to the approach
};

/// The factor of one contact's touching nodes. Kept between solves with one compliance: a set of
/// nodes that differs from these by few, as it mostly does from one state of friction to the next,
/// needs no factor of its own.
struct TouchingFactor {
  std::vector<Eigen::Index> nodes;
  Eigen::MatrixXd factor;            ///< lower triangle
  Eigen::VectorXd per_displacement;  ///< forces on the nodes when all are displaced by 1
};

/// Solves w = C f, w >= approach - gap, f >= 0, f (w - approach + gap) = 0, sum f = load, by a
/// primal-dual active set with the approach eliminated by the load: exact complementarity, no
/// penalty. Any consistent units.
///
/// @param compliance  symmetric positive definite, n x n: displacement into the surface per unit
/// force
/// @param gap         n initial gaps, any origin
/// @param start       a contact that is likely to touch nearly the same nodes; may be null
/// @param kept        of an earlier solve with the same compliance, replaced; may be null
/// @throws ConvergenceError when the set still changes after 200 steps.
NormalContact solve_normal_contact(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                                   double load, const NormalContact* start = nullptr,
                                   TouchingFactor* kept = nullptr);

/// Solves the same with the approach given in place of the load. It is larger than the smallest
/// gap.
NormalContact solve_normal_contact_at(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                                      double approach);

}  // namespace softfinger::fem
