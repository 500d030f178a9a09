#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "fem/algebra/cholesky.h"

// CHOLMOD's name for its analysis.
struct cholmod_factor_struct;

namespace softfinger::fem {

/// Numeric part of a supernodal Cholesky factor L, on CHOLMOD's analysis. Left-looking: each
/// supernode takes what its descendants subtract from it (E. G. Ng, B. W. Peyton, SIAM J. Sci.
/// Comput. 14, 1993). Subtrees of the elimination tree are factorised at the same time, and a large
/// supernode by blocks of its columns. Each entry's sum has one order for any number of threads.
///
/// It is our own because CHOLMOD 3 factorises in double precision only and does not work on several
/// subtrees at a time. MUMPS takes 2.7 times the CPU time and twice the memory
/// (docs/tried_and_not_kept.md).
/// @tparam Value  float or double
template <class Value>
class SupernodalFactor {
 public:
  using Vector = Eigen::Matrix<Value, Eigen::Dynamic, 1>;

  /// @param analysis  postordered; outlives this
  explicit SupernodalFactor(const cholmod_factor_struct& analysis);

  /// Supernode after supernode by columns, as the analysis says.
  const Value* values() const { return values_.get(); }

  /// @returns the first column where the matrix is not positive definite; its size where it is
  int factorise(const SparseSymmetricMatrix& ordered);

  /// L^-1 x, in place.
  void forward(Vector& x) const;
  /// L^-T x, in place.
  void backward(Vector& x) const;

 private:
  struct Run;
  struct Update;
  struct Workspace;
  using Nodes = std::vector<int>;

  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  int column_count(int node) const { return super_[node + 1] - super_[node]; }
  int row_count(int node) const { return row_begin_[node + 1] - row_begin_[node]; }
  const int* rows(int node) const { return rows_ + row_begin_[node]; }
  Value* values(int node) { return values_.get() + value_begin_[node]; }
  const Value* values(int node) const { return values_.get() + value_begin_[node]; }
  int parent(int node) const;

  Nodes eliminate_subtree(Run& run, int root);
  void eliminate(Run& run, int node, int root, Nodes& left);
  std::vector<Update> gather(Run& run, int node, Workspace& workspace);
  void enlist(Run& run, int node, int row, int root, Nodes& left) const;
  void subtract(const Update& update, int node, int begin, int end, const std::vector<int>& place,
                std::vector<Value>& product, std::vector<int>& target);
  int factorise_columns(int node);

  const int *super_, *row_begin_, *value_begin_, *rows_;
  const int size_, count_;
  const std::size_t value_count_;
  std::unique_ptr<Value[]> values_;  ///< none before the first factorisation
  std::vector<int> supernode_of_;    ///< per column
  std::vector<Nodes> children_;      ///< in the elimination tree; of the last one: its roots
  std::vector<int> first_of_;        ///< of each subtree, in postorder
  std::vector<double> work_;         ///< of each subtree, multiplications
};

}  // namespace softfinger::fem
