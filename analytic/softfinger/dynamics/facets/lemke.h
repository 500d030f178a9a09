#pragma once

#include <Eigen/Core>
#include <memory>

#include "softfinger/dynamics/contacts/lcp_result.h"

namespace softfinger {

/// Linear complementarity problem w = M z + q, w, z >= 0, w^T z = 0 by Lemke's algorithm (Cottle,
/// Pang, Stone, The Linear Complementarity Problem, 1992, algorithm 4.4.1).
///
/// The textbook's method has a covering vector of ones and exact ties. On problems with redundant
/// contacts it cycles or takes tiny pivots. Here:
/// - The covering vector is random, the same in every run.
/// - Ties are resolved by Harris' ratio test: it takes the row with the largest pivot among those
///   that block within a tolerance.
/// - When a path fails, another covering vector is tried.
/// - Rows and columns are equilibrated first, so that units and other scalings do not matter.
/// - The last basis is solved once more, with iterative refinement.
///
/// Lemke's method reaches a solution when M is a P-matrix, strictly copositive, or copositive-plus
/// with a feasible problem. For other M every path may end in a ray although a solution exists.
///
/// Sized once: `solve` then allocates nothing. Cost: O(n k) per pivot, k the number of basic z;
/// usually n to 2n pivots.
class LemkeSolver {
 public:
  /// @param largest_size  n of the problems to be solved; three n x n matrices are held
  explicit LemkeSolver(int largest_size);
  ~LemkeSolver();
  LemkeSolver(LemkeSolver&&) noexcept;
  LemkeSolver& operator=(LemkeSolver&&) noexcept;

  /// @param matrix    M, n x n, n <= largest_size, finite
  /// @param constant  q, n, finite
  /// @param z         n; the solution, or the best point found, or unchanged after a ray
  /// @throws InputError for sizes that do not fit and values that are not finite
  LcpResult solve(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                  const Eigen::Ref<const Eigen::VectorXd>& constant, Eigen::Ref<Eigen::VectorXd> z);

  /// The vector y of LcpResult::proof, n long, of any length; meaningless without a proof.
  Eigen::Ref<const Eigen::VectorXd> ray() const;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace softfinger
