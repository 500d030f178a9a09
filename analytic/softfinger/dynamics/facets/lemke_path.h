#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "softfinger/dynamics/contacts/repeatable_random.h"
#include "softfinger/dynamics/facets/basis_inverse.h"

/// Internal: the path that Lemke's algorithm follows, for any matrix that can answer a few
/// questions.
namespace softfinger::internal {

enum class PathEnd { solved, ray, limit, numerical };

struct PathOptions {
  /// Tolerance of Harris' ratio test: how far below zero w and z may go, over their natural size.
  /// Several rows may block the path within the tolerance. The one with the largest pivot is taken.
  double tolerance = 1e-11;
  /// A row blocks only if it falls faster than this part of the largest change: slower ones are
  /// mostly round-off and would make bad pivots. Nearly redundant contacts have true pivots that
  /// small, so that no single value serves all problems.
  double smallest_pivot = 1e-9;
  int most_pivots = 1000;
  /// Number of pivots after which the values are computed again from the basis, and corrected. At
  /// the pivots between, they are only advanced along the direction.
  int refresh_after = 1;
};

/// The result of the ratio test: how far the path goes, and which row or column blocks it.
struct Blocking {
  double theta = std::numeric_limits<double>::infinity();
  double pivot = 0;
  int row = -1;     ///< the row whose w becomes zero, or
  int column = -1;  ///< the position in the basis of the z that does

  static bool blocks(double slope, double least) { return slope < -least; }

  /// First pass: how far the path can go until some value is a tolerance below zero.
  void bound(double value, double slope, double least, double tolerance) {
    if (blocks(slope, least)) theta = std::min(theta, (std::max(value, 0.) + tolerance) / -slope);
  }
  /// Second pass: of all that block before `theta`, the largest pivot.
  bool prefers(double value, double slope, double least) const {
    return blocks(slope, least) && -slope > pivot && value <= -slope * theta;
  }
};

/// Lemke's path for w = M z + q + d z0, w, z, z0 >= 0, w^T z = 0, from z0 large to z0 = 0 (Cottle,
/// Pang, Stone, The Linear Complementarity Problem, 1992, algorithm 4.4.1), with Harris' two-pass
/// ratio test instead of exact ties.
///
/// Only the active part of the basis is held: the inverse of the k columns of basic z (z0 is one of
/// them) in the k rows where w = 0. M is asked for single rows and columns. A pivot costs O(k²) and
/// what `System` takes to follow w along a direction. No allocation after construction.
///
/// `System` has
/// - int pairs(): n
/// - void column(int j, const int* rows, int k, double* out): M(rows, j)
/// - void row(int i, const int* columns, int k, double* out): M(i, columns), where index n is d
/// - double cover(int i): d_i
/// - void cover_all_but(const int* rows, int k): from now on d = 0 in these rows
/// - double natural_size(int i): of z_i and w_i; i = n: of z0
/// - void set_state(const int* columns, const double* z, int k): w(z)
/// - void set_direction(const int* columns, const double* dz, int k, int entering or -1): dw
/// - void advance(double theta): w += theta dw
/// - double state(int i), direction(int i): w_i, dw_i
/// - int first_row(is_active): argmin w_i/d_i over rows not active, -1 if all w >= 0
/// - void bound(is_active, double least, double tolerance, Blocking&)
/// - void choose(is_active, double least, Blocking&): the two passes over rows not active
template <class System>
class LemkePath {
 public:
  LemkePath(int most_pairs, int largest_basis)
      : basis_(largest_basis),
        columns_(std::size_t(largest_basis)),
        rows_(std::size_t(largest_basis)),
        column_position_(std::size_t(most_pairs) + 1, -1),
        row_position_(std::size_t(most_pairs), -1),
        z_(largest_basis),
        dz_(largest_basis),
        first_(largest_basis),
        second_(largest_basis),
        matrix_(largest_basis, largest_basis) {}

  /// Follows the path from z = 0. With `resume`, follows it from the basis in which the last path
  /// was solved, after the problem has got more rows. z0 then covers only the new rows that are
  /// violated, so that all basic variables keep their values. A resumed path may end in a ray that
  /// proves nothing.
  PathEnd follow(System& system, const PathOptions& options, bool resume = false) {
    begin(system);
    const int row = start(resume);
    return row < 0 ? PathEnd::solved : go_on(options, row, true);
  }

  /// Follows the path from any complementary basis, given by its z. Some of these z and of the w
  /// may be negative: z0 shifts those z by `shift` each and covers those w, so that the path starts
  /// from values >= 0. It may end in a ray that proves nothing. `numerical` when the basis is
  /// singular.
  /// `System` then also has
  /// - double cover_entry(int i): d_i - (M shift)_i, which `row` has as entry n
  /// - void set_shift(const int* columns, const double* shift, int k): from now on the column of z0
  ///   is d - M shift; until the next cover_all_but
  PathEnd follow_from(System& system, const PathOptions& options, const int* basic, int k) {
    begin(system);
    if (k >= basis_.capacity()) return PathEnd::numerical;
    forget_basis();
    for (int p = 0; p < k; ++p) {
      set_column(p, basic[p]);
      set_row(p, basic[p]);
    }
    system.cover_all_but(rows_.data(), k);
    if (k > 0 && !invert_again(k)) return PathEnd::numerical;
    z_.head(k).setZero();
    if (!refresh()) return PathEnd::numerical;
    int entering = -1;
    bool entering_is_z = true;
    if (!start_shifted(options, entering, entering_is_z)) return PathEnd::solved;
    return go_on(options, entering, entering_is_z);
  }

  /// Once solved: iterative refinement of the basic z, for as long as each correction halves the
  /// error. Where the old inverse does not get to rounding, a new one is made.
  void refine() {
    constexpr int kMostCorrections = 6;
    constexpr double kRounding = 1e-15;
    const int k = basis_.size();
    for (const bool again : {false, true}) {
      if (again && !invert_again(k)) return;
      double last = std::numeric_limits<double>::infinity();
      for (int correction = 0; correction < kMostCorrections; ++correction) {
        double error = 0;
        for (int p = 0; p < k; ++p) {
          first_[p] = system_->state(rows_[std::size_t(p)]);
          error = std::max(error, std::abs(first_[p]));
        }
        if (error >= 0.5 * last) break;
        last = error;
        basis_.solve(first_.data(), second_.data());
        z_.head(k) -= second_.head(k);
        system_->set_state(columns_.data(), z_.data(), k);
      }
      if (last <= kRounding * std::max(1., z_.head(k).template lpNorm<Eigen::Infinity>())) return;
    }
  }

  int pivots() const { return pivots_; }
  /// The basic z, without z0 once solved.
  int basis_size() const { return basis_.size(); }
  int basis_column(int p) const { return columns_[std::size_t(p)]; }
  double basis_value(int p) const { return z_[p]; }

  /// Component of the ray's direction along that basic z, and the z that enters (-1: a w does).
  /// Valid after a path that ended in a ray.
  double ray_value(int p) const { return dz_[p]; }
  int ray_entering() const { return entering_is_z_ ? entering_ : -1; }

 private:
  void begin(System& system) {
    system_ = &system;
    pairs_ = system.pairs();
    pivots_ = 0;
  }

  /// Costs O(size of the last basis), however many pairs there are.
  void forget_basis() {
    basis_.clear();
    for (int p = 0; p < listed_; ++p) {
      column_position_[std::size_t(columns_[std::size_t(p)])] = -1;
      row_position_[std::size_t(rows_[std::size_t(p)])] = -1;
    }
    listed_ = 0;
  }

  PathEnd go_on(const PathOptions& options, int entering, bool entering_is_z) {
    System& system = *system_;
    for (; pivots_ < options.most_pivots; ++pivots_) {
      if (!find_direction(entering_is_z, entering)) return PathEnd::numerical;
      const int k = basis_.size();
      const double least =
          options.smallest_pivot * std::max(1., dz_.head(k).template lpNorm<Eigen::Infinity>());

      Blocking blocking;
      for (int p = 0; p < k; ++p)
        blocking.bound(z_[p], dz_[p], least,
                       options.tolerance * system.natural_size(columns_[std::size_t(p)]));
      const auto is_active = [this](int row) { return row_position_[std::size_t(row)] >= 0; };
      system.bound(is_active, least, options.tolerance, blocking);
      if (std::isinf(blocking.theta)) {
        entering_is_z_ = entering_is_z;
        entering_ = entering;
        return PathEnd::ray;
      }
      for (int p = 0; p < k; ++p)
        if (blocking.prefers(z_[p], dz_[p], least)) {
          blocking.pivot = -dz_[p];
          blocking.column = p;
        }
      system.choose(is_active, least, blocking);
      // In a tie z0 leaves: then the problem is solved.
      const int z0 = column_position_[std::size_t(pairs_)];
      if (dz_[z0] < -least && z_[z0] <= -dz_[z0] * blocking.theta) {
        blocking.row = -1;
        blocking.column = z0;
      }
      if (blocking.row < 0 && blocking.column < 0) return PathEnd::numerical;
      if (entering_is_z && blocking.row >= 0 && k == basis_.capacity()) return PathEnd::numerical;

      const double value = blocking.row >= 0 ? system.state(blocking.row) : z_[blocking.column];
      const double slope =
          blocking.row >= 0 ? system.direction(blocking.row) : dz_[blocking.column];
      const double theta = std::max(0., value / -slope);
      z_.head(k) += theta * dz_.head(k);
      const int leaving = blocking.row >= 0 ? blocking.row : columns_[std::size_t(blocking.column)];
      const bool leaving_is_z = blocking.row < 0;
      exchange(entering_is_z, entering, theta, blocking);
      const bool last = leaving == pairs_;
      if (last || (pivots_ + 1) % options.refresh_after == 0) {
        if (!refresh()) return PathEnd::numerical;
      } else {
        system.advance(theta);
      }
      if (last) {
        ++pivots_;
        return PathEnd::solved;
      }
      entering_is_z = !leaving_is_z;
      entering = leaving;
    }
    return PathEnd::limit;
  }

  /// Raises z0 from zero until all w >= 0 and makes it basic. Returns the row whose w is then zero,
  /// or -1 if none was negative.
  int start(bool resume) {
    if (!resume) forget_basis();
    const int k = basis_.size();
    if (k == basis_.capacity()) return -1;
    system_->cover_all_but(rows_.data(), k);
    system_->set_state(columns_.data(), z_.data(), k);
    const int row =
        system_->first_row([this](int other) { return row_position_[std::size_t(other)] >= 0; });
    if (row < 0) return -1;
    system_->row(row, columns_.data(), k, first_.data());
    basis_.solve_transposed(first_.data(), second_.data());
    dz_.head(k).setZero();
    basis_.grow(dz_.data(), second_.data(), system_->cover(row));
    set_column(k, pairs_);
    set_row(k, row);
    z_[k] = -system_->state(row) / system_->cover(row);
    system_->set_state(columns_.data(), z_.data(), k + 1);
    return row;
  }

  /// Raises z0, which shifts the basic z as well, until these and all w are >= 0. The complement of
  /// the one that is then zero enters next. False if nothing was negative.
  bool start_shifted(const PathOptions& options, int& entering, bool& entering_is_z) {
    const int k = basis_.size();
    Eigen::VectorXd& shift = first_;
    double z0 = 0;
    int lowest = -1;
    for (int p = 0; p < k; ++p) {
      const int column = columns_[std::size_t(p)];
      const double size = system_->natural_size(column);
      shift[p] = 0;
      if (z_[p] >= -options.tolerance * size) continue;
      shift[p] = size * (1 + hash_to_unit(3, std::uint64_t(column)));
      if (-z_[p] <= z0 * shift[p]) continue;
      z0 = -z_[p] / shift[p];
      lowest = p;
    }
    const int row =
        system_->first_row([this](int other) { return row_position_[std::size_t(other)] >= 0; });
    if (row < 0 && lowest < 0) return false;
    system_->set_shift(columns_.data(), shift.data(), k);
    const bool row_is_first =
        row >= 0 && (lowest < 0 || -system_->state(row) > z0 * system_->cover(row));
    if (row_is_first) z0 = -system_->state(row) / system_->cover(row);
    z_.head(k) += z0 * shift.head(k);
    dz_.head(k) = -shift.head(k);  // A^-1 times the column of z0
    if (row_is_first) {
      system_->row(row, columns_.data(), k, first_.data());
      basis_.solve_transposed(first_.data(), second_.data());
      basis_.grow(dz_.data(), second_.data(), system_->cover(row));
      set_column(k, pairs_);
      set_row(k, row);
      z_[k] = z0;
      entering = row;
    } else {
      entering = columns_[std::size_t(lowest)];
      basis_.replace_column(lowest, dz_.data());
      column_position_[std::size_t(entering)] = -1;
      set_column(lowest, pairs_);
      z_[lowest] = z0;
    }
    entering_is_z = row_is_first;
    system_->set_state(columns_.data(), z_.data(), basis_.size());
    return true;
  }

  /// dz_: how the basic z change while the entering variable grows by one. In the active rows w
  /// must stay zero; any change found there is the error of the inverse and is taken out. False
  /// where a new inverse does not help either.
  bool find_direction(bool is_z, int entering) {
    for (int attempt = 0; attempt < 2; ++attempt) {
      const int k = basis_.size();
      if (is_z) {
        system_->column(entering, rows_.data(), k, first_.data());
        basis_.solve(first_.data(), dz_.data());
        dz_.head(k) = -dz_.head(k);
      } else {
        const int p = row_position_[std::size_t(entering)];
        dz_.head(k) = Eigen::Map<const Eigen::VectorXd>(basis_.column(p), k);
      }
      for (int correction = 0; correction < 3; ++correction) {
        system_->set_direction(columns_.data(), dz_.data(), k, is_z ? entering : -1);
        double error = 0;
        for (int p = 0; p < k; ++p) {
          const int row = rows_[std::size_t(p)];
          first_[p] = system_->direction(row) - (!is_z && row == entering ? 1 : 0);
          error = std::max(error, std::abs(first_[p]));
        }
        const double size = std::max(1., dz_.head(k).template lpNorm<Eigen::Infinity>());
        if (error <= 1e-11 * size) return true;
        if (!(error < 1e-3 * size)) break;
        basis_.solve(first_.data(), second_.data());
        dz_.head(k) -= second_.head(k);
      }
      if (attempt == 0 && !invert_again(basis_.size())) return false;
    }
    return false;
  }

  bool invert_again(int k) {
    for (int p = 0; p < k; ++p) {
      system_->row(rows_[std::size_t(p)], columns_.data(), k, first_.data());
      matrix_.row(p).head(k) = first_.head(k);
    }
    return basis_.invert(matrix_.data(), int(matrix_.rows()), k);
  }

  /// Computes w from the basic z and corrects these until w = 0 in the active rows, up to rounding.
  bool refresh() {
    for (int correction = 0; correction < 4; ++correction) {
      const int k = basis_.size();
      system_->set_state(columns_.data(), z_.data(), k);
      double error = 0;
      for (int p = 0; p < k; ++p) {
        first_[p] = system_->state(rows_[std::size_t(p)]);
        error = std::max(error, std::abs(first_[p]));
      }
      const double size = k > 0 ? std::max(1., z_.head(k).template lpNorm<Eigen::Infinity>()) : 1;
      if (error <= 1e-14 * size) return true;
      if (correction == 3) return error <= 1e-9 * size;
      if (correction == 2 && error > 1e-11 * size && !invert_again(k)) return false;
      basis_.solve(first_.data(), second_.data());
      z_.head(k) -= second_.head(k);
    }
    return true;
  }

  void exchange(bool entering_is_z, int entering, double theta, const Blocking& blocking) {
    const int k = basis_.size();
    if (blocking.row >= 0) {
      system_->row(blocking.row, columns_.data(), k, first_.data());
      basis_.solve_transposed(first_.data(), second_.data());
    }
    if (entering_is_z) dz_.head(k) = -dz_.head(k);  // now A^-1 times the entering column
    if (entering_is_z && blocking.row >= 0) {
      basis_.grow(dz_.data(), second_.data(), system_->direction(blocking.row));
      set_column(k, entering);
      set_row(k, blocking.row);
      z_[k] = theta;
    } else if (entering_is_z) {
      const int p = blocking.column;
      basis_.replace_column(p, dz_.data());
      column_position_[std::size_t(columns_[std::size_t(p)])] = -1;
      set_column(p, entering);
      z_[p] = theta;
    } else if (blocking.row >= 0) {
      const int p = row_position_[std::size_t(entering)];
      basis_.replace_row(p, second_.data());
      row_position_[std::size_t(entering)] = -1;
      set_row(p, blocking.row);
    } else {
      const int row = row_position_[std::size_t(entering)], column = blocking.column;
      basis_.shrink(row, column);
      row_position_[std::size_t(entering)] = -1;
      column_position_[std::size_t(columns_[std::size_t(column)])] = -1;
      if (row != k - 1) set_row(row, rows_[std::size_t(k) - 1]);
      if (column != k - 1) {
        set_column(column, columns_[std::size_t(k) - 1]);
        z_[column] = z_[k - 1];
      }
    }
  }

  void set_column(int p, int index) {
    listed_ = std::max(listed_, p + 1);
    columns_[std::size_t(p)] = index;
    column_position_[std::size_t(index)] = p;
  }
  void set_row(int p, int index) {
    listed_ = std::max(listed_, p + 1);
    rows_[std::size_t(p)] = index;
    row_position_[std::size_t(index)] = p;
  }

  System* system_ = nullptr;
  int pairs_ = 0;
  BasisInverse basis_;
  std::vector<int> columns_, rows_, column_position_, row_position_;
  Eigen::VectorXd z_, dz_, first_, second_;
  Eigen::MatrixXd matrix_;
  int listed_ = 0;  ///< of columns_ and rows_, since the last forget_basis
  int pivots_ = 0, entering_ = -1;
  bool entering_is_z_ = false;
};

}  // namespace softfinger::internal
