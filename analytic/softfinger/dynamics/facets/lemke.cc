#include "softfinger/dynamics/facets/lemke.h"

#include <cmath>
#include <string>
#include <vector>

#include "softfinger/dynamics/contacts/repeatable_random.h"
#include "softfinger/dynamics/facets/lemke_path.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using internal::Blocking;
using internal::PathEnd;

constexpr int kMostAttempts = 12;
constexpr double kTolerance = 1e-10;

RayProof stronger(RayProof a, RayProof b) {
  if (a == RayProof::infeasible || b == RayProof::infeasible) return RayProof::infeasible;
  return a == RayProof::none ? b : a;
}

/// The System of LemkePath with M, q and the covering vector as arrays, all scaled.
class DenseSystem {
 public:
  explicit DenseSystem(int capacity)
      : matrix(capacity, capacity),
        constant(capacity),
        covering(capacity),
        w_(capacity),
        dw_(capacity) {}

  Eigen::MatrixXd matrix;
  Eigen::VectorXd constant, covering;
  int size = 0;

  int pairs() const { return size; }
  void column(int j, const int* rows, int k, double* out) const {
    for (int p = 0; p < k; ++p) out[p] = matrix(rows[p], j);
  }
  void row(int i, const int* columns, int k, double* out) const {
    for (int p = 0; p < k; ++p) out[p] = columns[p] == size ? covering[i] : matrix(i, columns[p]);
  }
  double cover(int i) const { return covering[i]; }
  double natural_size(int) const { return 1; }
  void cover_all_but(const int*, int) {}
  template <class IsActive>
  int first_row(const IsActive& is_active) const {
    int best = -1;
    double least = 0;
    for (int i = 0; i < size; ++i)
      if (!is_active(i) && w_[i] < least * covering[i]) {
        least = w_[i] / covering[i];
        best = i;
      }
    return best;
  }
  void set_state(const int* columns, const double* z, int k) {
    w_.head(size) = constant.head(size);
    add(columns, z, k, w_);
  }
  void set_direction(const int* columns, const double* dz, int k, int entering) {
    if (entering >= 0)
      dw_.head(size) = matrix.col(entering).head(size);
    else
      dw_.head(size).setZero();
    add(columns, dz, k, dw_);
  }
  void advance(double theta) { w_.head(size) += theta * dw_.head(size); }
  double state(int i) const { return w_[i]; }
  double direction(int i) const { return dw_[i]; }

  template <class IsActive>
  void bound(const IsActive& is_active, double least, double tolerance, Blocking& blocking) const {
    for (int i = 0; i < size; ++i)
      if (!is_active(i)) blocking.bound(w_[i], dw_[i], least, tolerance);
  }
  template <class IsActive>
  void choose(const IsActive& is_active, double least, Blocking& blocking) const {
    for (int i = 0; i < size; ++i)
      if (!is_active(i) && blocking.prefers(w_[i], dw_[i], least)) {
        blocking.pivot = -dw_[i];
        blocking.row = i;
      }
  }

 private:
  void add(const int* columns, const double* z, int k, Eigen::VectorXd& w) const {
    for (int p = 0; p < k; ++p) {
      if (z[p] == 0) continue;
      if (columns[p] == size)
        w.head(size).noalias() += z[p] * covering.head(size);
      else
        w.head(size).noalias() += z[p] * matrix.col(columns[p]).head(size);
    }
  }

  Eigen::VectorXd w_, dw_;
};

}  // namespace

struct LemkeSolver::Workspace {
  explicit Workspace(int capacity)
      : system(capacity),
        path(capacity, capacity + 1),
        row_scale(capacity),
        column_scale(capacity),
        z(capacity),
        best(capacity),
        w(capacity),
        ray(capacity) {}

  void equilibrate(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                   const Eigen::Ref<const Eigen::VectorXd>& constant);
  double residual(const Eigen::VectorXd& point);
  RayProof check_ray();
  LcpResult follow_paths(Eigen::Ref<Eigen::VectorXd> solution);

  DenseSystem system;
  internal::LemkePath<DenseSystem> path;
  Eigen::VectorXd row_scale, column_scale, z, best, w, ray;
  double constant_scale = 1;
};

/// Ruiz' iteration (Rutherford Appleton Laboratory report RAL-TR-2001-034): the largest entries of
/// all rows and columns of R M C become 1. Scaling by positive numbers changes neither the
/// solutions nor which matrices Lemke's method can process: it is the same method with another
/// covering vector.
void LemkeSolver::Workspace::equilibrate(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                                         const Eigen::Ref<const Eigen::VectorXd>& constant) {
  const int n = int(constant.size());
  constexpr int kSweeps = 8;
  system.size = n;
  auto scaled = system.matrix.topLeftCorner(n, n);
  scaled = matrix;
  row_scale.head(n).setOnes();
  column_scale.head(n).setOnes();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    // By rows, then by columns. The first sweep takes rows as they are, without the root, so that a
    // number by which the whole matrix is multiplied is gone after it.
    for (int i = 0; i < n; ++i) {
      const double largest = scaled.row(i).lpNorm<Eigen::Infinity>();
      if (!(largest > 0)) continue;
      const double factor = sweep == 0 ? 1 / largest : 1 / std::sqrt(largest);
      scaled.row(i) *= factor;
      row_scale[i] *= factor;
    }
    for (int j = 0; j < n; ++j) {
      const double largest = scaled.col(j).lpNorm<Eigen::Infinity>();
      if (!(largest > 0)) continue;
      const double factor = 1 / std::sqrt(largest);
      scaled.col(j) *= factor;
      column_scale[j] *= factor;
    }
  }
  system.constant.head(n) = row_scale.head(n).cwiseProduct(constant);
  constant_scale = system.constant.head(n).lpNorm<Eigen::Infinity>();
  if (constant_scale > 0) system.constant.head(n) /= constant_scale;
}

double LemkeSolver::Workspace::residual(const Eigen::VectorXd& point) {
  const int n = system.size;
  w.head(n) = system.constant.head(n);
  for (int j = 0; j < n; ++j)
    if (point[j] != 0) w.head(n).noalias() += point[j] * system.matrix.col(j).head(n);
  return point.head(n).cwiseMin(w.head(n)).lpNorm<Eigen::Infinity>() /
         std::max(1., point.head(n).lpNorm<Eigen::Infinity>());
}

RayProof LemkeSolver::Workspace::check_ray() {
  const int n = system.size;
  ray.head(n).setZero();
  double z0 = 0;
  for (int p = 0; p < path.basis_size(); ++p)
    (path.basis_column(p) == n ? z0 : ray[path.basis_column(p)]) = path.ray_value(p);
  if (path.ray_entering() >= 0) ray[path.ray_entering()] = 1;
  const double size = ray.head(n).lpNorm<Eigen::Infinity>();
  if (!(size > 0)) return RayProof::none;
  ray.head(n) /= size;
  constexpr double kRoundOff = 1e-9;
  if (ray.head(n).minCoeff() < -kRoundOff) return RayProof::none;
  ray.head(n) = ray.head(n).cwiseMax(0.);

  // Farkas' y multiplies rows, scaled by R; the ray is made of columns, scaled by C. The same
  // vector in both: C ray_scaled = R y_scaled.
  Eigen::VectorXd& y = z;
  y.head(n) = ray.head(n).cwiseProduct(column_scale.head(n)).cwiseQuotient(row_scale.head(n));
  y.head(n) /= y.head(n).lpNorm<Eigen::Infinity>();
  w.head(n).noalias() = system.matrix.topLeftCorner(n, n).transpose() * y.head(n);
  const bool farkas =
      w.head(n).maxCoeff() <= kRoundOff && y.head(n).dot(system.constant.head(n)) < -kRoundOff;

  w.head(n).noalias() = system.matrix.topLeftCorner(n, n) * ray.head(n);
  const bool holds = std::abs(z0) <= kRoundOff * size && w.head(n).minCoeff() >= -kRoundOff &&
                     w.head(n).dot(ray.head(n)) <= kRoundOff &&
                     y.head(n).dot(system.constant.head(n)) < -kRoundOff;
  ray.head(n) = ray.head(n).cwiseProduct(column_scale.head(n));
  return farkas ? RayProof::infeasible : holds ? RayProof::ray_only : RayProof::none;
}

LcpResult LemkeSolver::Workspace::follow_paths(Eigen::Ref<Eigen::VectorXd> solution) {
  const int n = system.size;
  LcpResult result;
  result.residual = std::numeric_limits<double>::infinity();
  RayProof proof = RayProof::none;
  internal::PathOptions options;
  options.most_pivots = 50 * n + 100;
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    result.attempts = attempt + 1;
    for (int i = 0; i < n; ++i)
      system.covering[i] = 1 + internal::hash_to_unit(std::uint64_t(attempt), std::uint64_t(i));
    options.tolerance = attempt % 2 == 0 ? 1e-11 : 1e-13;
    const PathEnd end = path.follow(system, options);
    result.pivots += path.pivots();
    if (end == PathEnd::ray) {
      proof = stronger(proof, check_ray());
      if (proof == RayProof::infeasible) break;
      continue;
    }
    if (end == PathEnd::solved) path.refine();
    z.head(n).setZero();
    for (int p = 0; p < path.basis_size(); ++p)
      if (path.basis_column(p) != n) z[path.basis_column(p)] = std::max(0., path.basis_value(p));
    const double reached = residual(z);
    if (!(reached < result.residual)) continue;
    result.residual = reached;
    best.head(n) = z.head(n);
    if (reached <= kTolerance) break;
  }
  if (result.residual <= kTolerance)
    result.status = LcpStatus::solved;
  else if (proof != RayProof::none)
    result.status = LcpStatus::infeasible_or_ray;
  result.proof = result.status == LcpStatus::infeasible_or_ray ? proof : RayProof::none;
  if (result.status != LcpStatus::infeasible_or_ray && std::isfinite(result.residual))
    solution = constant_scale * column_scale.head(n).cwiseProduct(best.head(n));
  return result;
}

LemkeSolver::LemkeSolver(int largest_size)
    : workspace_(std::make_unique<Workspace>(std::max(largest_size, 0))) {}
LemkeSolver::~LemkeSolver() = default;
LemkeSolver::LemkeSolver(LemkeSolver&&) noexcept = default;
LemkeSolver& LemkeSolver::operator=(LemkeSolver&&) noexcept = default;

Eigen::Ref<const Eigen::VectorXd> LemkeSolver::ray() const {
  return workspace_->ray.head(workspace_->system.size);
}

LcpResult LemkeSolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                             const Eigen::Ref<const Eigen::VectorXd>& constant,
                             Eigen::Ref<Eigen::VectorXd> z) {
  const auto n = constant.size();
  if (matrix.rows() != n || matrix.cols() != n || z.size() != n ||
      n > workspace_->system.constant.size())
    throw InputError("LemkeSolver", "size",
                     std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) +
                         " with q of " + std::to_string(n),
                     "M of n x n, q and z of n, n at most " +
                         std::to_string(workspace_->system.constant.size()));
  if (!matrix.allFinite()) throw InputError("LemkeSolver", "M", "", "finite numbers");
  if (!constant.allFinite()) throw InputError("LemkeSolver", "q", "", "finite numbers");
  workspace_->equilibrate(matrix, constant);
  if (n == 0 || constant.minCoeff() >= 0) {
    z.setZero();
    LcpResult result;
    result.status = LcpStatus::solved;
    return result;
  }
  return workspace_->follow_paths(z);
}

}  // namespace softfinger
