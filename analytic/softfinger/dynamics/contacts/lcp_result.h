#pragma once

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

/// The rung of the solver's ladder that found the solution of a contact problem. Each rung is tried
/// only after those above it have failed, so that a fault in one of them shows as a solution from a
/// lower rung before it shows as a failure.
enum class SolvedBy {
  none,         ///< no rung: there is no solution, or none was found
  separating,   ///< all contacts open without impulses
  still,        ///< the last impulses, as they were or corrected by the last decomposition
  warm,         ///< Newton's method or proximal points from the last impulses
  first_start,  ///< proximal points from no impulses
  drawn_start,  ///< proximal points from given or drawn impulses
  facets        ///< Lemke's path: the method of the facets, and the last start of exact friction
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
  // Only contact problems have these:
  int newton_iterations = 0;  ///< of exact friction
  SolvedBy solved_by = SolvedBy::none;

  /// Whether the last problem's impulses led to the solution.
  bool is_warm() const { return solved_by == SolvedBy::still || solved_by == SolvedBy::warm; }
};

}  // namespace softfinger
