#pragma once

#include <Eigen/Core>
#include <memory>

namespace softfinger {

enum class LcpStatus {
  solved,             ///< the residual is within the tolerance
  infeasible_or_ray,  ///< every path ended in a ray; see LcpResult::proof
  iteration_limit     ///< neither: the best point found is returned, with its residual
};

/// The statement that a ray proves. Each ray that a path has found is checked as a vector,
/// independently of the path.
enum class RayProof {
  none,  ///< there was no ray, or its conditions are not met to round-off
  /// y >= 0, M^T y <= 0, q^T y < 0 (Farkas): no z >= 0 has M z + q >= 0, for any M.
  infeasible,
  /// y >= 0, M y >= 0, y^T M y = 0, q^T y < 0: proves that there is no solution only where M is
  /// copositive-plus (Cottle, Pang, Stone 1992, theorem 4.4.13). For other M it says that the
  /// method has no answer, not that there is none.
  ray_only
};

struct LcpResult {
  LcpStatus status = LcpStatus::iteration_limit;
  /// max_i |min(z_i, w_i)|, which measures violations of z >= 0, w >= 0 and w^T z = 0 in one
  /// number. Without unit: rows and columns are scaled so that the largest entry of each is 1 in M,
  /// and the result is divided by the largest scaled q or z.
  double residual = 0;
  int pivots = 0;    ///< of all attempts
  int attempts = 0;  ///< covering vectors tried; 0: solved without a path
  RayProof proof = RayProof::none;
  // Of contact problems:
  int newton_iterations = 0;  ///< of exact friction
  bool warm = false;          ///< found from the previous basis
};

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
