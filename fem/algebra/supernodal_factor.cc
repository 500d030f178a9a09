#include "fem/algebra/supernodal_factor.h"

#include <suitesparse/cholmod.h>

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "fem/base/threads.h"

// BLAS and LAPACK, declared as Eigen does.
extern "C" {
int ssyrk_(const char* uplo, const char* trans, const int* n, const int* k, const float* alpha,
           const float* a, const int* lda, const float* beta, float* c, const int* ldc);
int dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha,
           const double* a, const int* lda, const double* beta, double* c, const int* ldc);
int sgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k,
           const float* alpha, const float* a, const int* lda, const float* b, const int* ldb,
           const float* beta, float* c, const int* ldc);
int dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k,
           const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
           const double* beta, double* c, const int* ldc);
int strsm_(const char* side, const char* uplo, const char* transa, const char* diag, const int* m,
           const int* n, const float* alpha, const float* a, const int* lda, float* b,
           const int* ldb);
int dtrsm_(const char* side, const char* uplo, const char* transa, const char* diag, const int* m,
           const int* n, const double* alpha, const double* a, const int* lda, double* b,
           const int* ldb);
void spotrf_(const char* uplo, const int* n, float* a, const int* lda, int* info);
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
int strsv_(const char* uplo, const char* trans, const char* diag, const int* n, const float* a,
           const int* lda, float* x, const int* incx);
int dtrsv_(const char* uplo, const char* trans, const char* diag, const int* n, const double* a,
           const int* lda, double* x, const int* incx);
int sgemv_(const char* trans, const int* m, const int* n, const float* alpha, const float* a,
           const int* lda, const float* x, const int* incx, const float* beta, float* y,
           const int* incy);
int dgemv_(const char* trans, const int* m, const int* n, const double* alpha, const double* a,
           const int* lda, const double* x, const int* incx, const double* beta, double* y,
           const int* incy);
}

namespace softfinger::fem {
namespace {

template <class Value>
struct Blas;

template <>
struct Blas<float> {
  static constexpr float one = 1, none = 0, minus_one = -1;
  static constexpr auto syrk = ssyrk_;
  static constexpr auto gemm = sgemm_;
  static constexpr auto trsm = strsm_;
  static constexpr auto potrf = spotrf_;
  static constexpr auto trsv = strsv_;
  static constexpr auto gemv = sgemv_;
};

template <>
struct Blas<double> {
  static constexpr double one = 1, none = 0, minus_one = -1;
  static constexpr auto syrk = dsyrk_;
  static constexpr auto gemm = dgemm_;
  static constexpr auto trsm = dtrsm_;
  static constexpr auto potrf = dpotrf_;
  static constexpr auto trsv = dtrsv_;
  static constexpr auto gemv = dgemv_;
};

/// C = beta C + alpha A B^T of which the first columns of A are B: the lower triangle of C's square
/// on top, and all below it.
/// @param rows     of A and C
/// @param columns  of C, rows of B
/// @param depth    columns of A and B
template <class Value>
void multiply(int rows, int columns, int depth, const Value& alpha, const Value* a, int stride_a,
              const Value& beta, Value* c, int stride_c) {
  const int below = rows - columns;
  Blas<Value>::syrk("L", "N", &columns, &depth, &alpha, a, &stride_a, &beta, c, &stride_c);
  if (below > 0)
    Blas<Value>::gemm("N", "T", &below, &columns, &depth, &alpha, a + columns, &stride_a, a,
                      &stride_a, &beta, c + columns, &stride_c);
}

/// Less work than this is not worth another thread: multiplications of about a millisecond.
constexpr double least_work = 1e7;
/// Columns or rows of a block of dense work.
constexpr int block_size = 256;

/// Calls a function of the beginning and the end of each block of a range at the same time.
template <class OfBlock>
void by_blocks(int begin, int end, int block, const OfBlock& of_block) {
  in_parallel((end - begin + block - 1) / block,
              [&](int i) { of_block(begin + i * block, std::min(end, begin + (i + 1) * block)); });
}

}  // namespace

/// A descendant's rows from one on, up to another one, that lie among a supernode's columns.
template <class Value>
struct SupernodalFactor<Value>::Update {
  int descendant, from, to;
};

/// A thread's memory for one supernode, kept for the next one.
template <class Value>
struct SupernodalFactor<Value>::Workspace {
  std::vector<int> place;  ///< of the matrix's rows among the supernode's own ones
  std::vector<Value> product;
  std::vector<int> target;
};

/// Descendants are in lists, each in that of the supernode which has its next row.
template <class Value>
struct SupernodalFactor<Value>::Run {
  Run(const SparseSymmetricMatrix& matrix, int count, int size)
      : ordered(matrix), first(at(count) + 1, -1), next(first), position(first), failed(size) {}

  const SparseSymmetricMatrix& ordered;
  std::vector<int> first, next, position;
  std::atomic<int> failed;  ///< first column so far; the matrix's size: none
  Pool<Workspace> workspaces{[] { return std::make_unique<Workspace>(); }};
};

template <class Value>
SupernodalFactor<Value>::SupernodalFactor(const cholmod_factor& analysis)
    : super_(static_cast<const int*>(analysis.super)),
      row_begin_(static_cast<const int*>(analysis.pi)),
      value_begin_(static_cast<const int*>(analysis.px)),
      rows_(static_cast<const int*>(analysis.s)),
      size_(static_cast<int>(analysis.n)),
      count_(static_cast<int>(analysis.nsuper)),
      value_count_(analysis.xsize),
      supernode_of_(analysis.n),
      children_(analysis.nsuper + 1),
      first_of_(analysis.nsuper + 1),
      work_(analysis.nsuper + 1, 0) {
  for (int node = 0; node < count_; ++node)
    std::fill(supernode_of_.begin() + super_[node], supernode_of_.begin() + super_[node + 1], node);
  for (int node = 0; node <= count_; ++node) {
    const Nodes& children = children_[at(node)];
    first_of_[at(node)] = children.empty() ? node : first_of_[at(children.front())];
    if (node == count_) break;
    const double rows = row_count(node);
    work_[at(node)] += column_count(node) * rows * rows / 2;
    const int above = parent(node);
    children_[at(above)].push_back(node);
    work_[at(above)] += work_[at(node)];
  }
}

/// The parent in the elimination tree; `count_` for a root.
template <class Value>
int SupernodalFactor<Value>::parent(int node) const {
  const int columns = column_count(node);
  return columns < row_count(node) ? supernode_of_[at(rows(node)[columns])] : count_;
}

template <class Value>
int SupernodalFactor<Value>::factorise(const SparseSymmetricMatrix& ordered) {
  if (!values_) values_.reset(new Value[value_count_]);
  Run run(ordered, count_, size_);
  eliminate_subtree(run, count_);
  return run.failed;
}

/// @param root  of the subtree that is being eliminated
/// @param left  gets the descendants whose next row is in a supernode above it
template <class Value>
void SupernodalFactor<Value>::enlist(Run& run, int node, int row, int root, Nodes& left) const {
  run.position[at(node)] = row;
  if (row == row_count(node)) return;
  const int above = supernode_of_[at(rows(node)[row])];
  if (above > root) {
    left.push_back(node);
    return;
  }
  run.next[at(node)] = run.first[at(above)];
  run.first[at(above)] = node;
}

/// @returns descendants with rows above the subtree, in the order in which one thread enlists them
template <class Value>
auto SupernodalFactor<Value>::eliminate_subtree(Run& run, int root) -> Nodes {
  Nodes left;
  if (work_[at(root)] < least_work) {
    for (int node = first_of_[at(root)]; node <= std::min(root, count_ - 1); ++node)
      eliminate(run, node, root, left);
    return left;
  }
  // Neighbours that are not worth a thread each share one.
  const Nodes& children = children_[at(root)];
  std::vector<Nodes> parts;
  double work = least_work;
  for (const int child : children) {
    if (work + work_[at(child)] > least_work) {
      parts.emplace_back();
      work = 0;
    }
    parts.back().push_back(child);
    work += work_[at(child)];
  }
  std::vector<Nodes> left_by(parts.size());
  in_parallel(static_cast<int>(parts.size()), [&](int part) {
    for (const int child : parts[at(part)])
      for (const int node : eliminate_subtree(run, child)) left_by[at(part)].push_back(node);
  });
  for (const Nodes& nodes : left_by)
    for (const int node : nodes) enlist(run, node, run.position[at(node)], root, left);
  if (root < count_) eliminate(run, root, root, left);
  return left;
}

template <class Value>
void SupernodalFactor<Value>::eliminate(Run& run, int node, int root, Nodes& left) {
  if (run.failed < super_[node]) return;
  std::vector<Update> updates;
  run.workspaces.with([&](Workspace& workspace) { updates = gather(run, node, workspace); });
  for (const Update& update : updates) enlist(run, update.descendant, update.to, root, left);
  const int columns = column_count(node);
  if (const int factorised = factorise_columns(node); factorised < columns) {
    int failed = run.failed;
    while (super_[node] + factorised < failed &&
           !run.failed.compare_exchange_weak(failed, super_[node] + factorised)) {
    }
    return;
  }
  enlist(run, node, columns, root, left);
}

/// The supernode's entries of the matrix, less what its descendants subtract.
template <class Value>
auto SupernodalFactor<Value>::gather(Run& run, int node, Workspace& workspace)
    -> std::vector<Update> {
  const int columns = column_count(node), row_total = row_count(node);
  Value* const own = values(node);
  std::fill(own, own + static_cast<std::ptrdiff_t>(columns) * row_total, Blas<Value>::none);
  std::vector<int>& place = workspace.place;
  place.resize(at(size_));
  for (int i = 0; i < row_total; ++i) place[at(rows(node)[i])] = i;
  const SparseSymmetricMatrix& ordered = run.ordered;
  for (int column = 0; column < columns; ++column) {
    Value* of_column = own + static_cast<std::ptrdiff_t>(column) * row_total;
    const auto begin = at(ordered.column_begin[at(super_[node] + column)]),
               end = at(ordered.column_begin[at(super_[node] + column + 1)]);
    for (std::size_t k = begin; k < end; ++k)
      of_column[place[at(ordered.row[k])]] = static_cast<Value>(ordered.value[k]);
  }
  std::vector<Update> updates;
  double work = 0;
  for (int other = run.first[at(node)]; other >= 0; other = run.next[at(other)]) {
    const int from = run.position[at(other)], end = row_count(other);
    int to = from;
    while (to < end && rows(other)[to] < super_[node + 1]) ++to;
    updates.push_back({other, from, to});
    work += static_cast<double>(to - from) * (end - from) * column_count(other);
  }
  if (work < least_work || columns <= block_size) {
    for (const Update& update : updates)
      subtract(update, node, 0, columns, place, workspace.product, workspace.target);
  } else {
    by_blocks(0, columns, block_size, [&](int begin, int end) {
      std::vector<Value> product;
      std::vector<int> target;
      for (const Update& update : updates)
        subtract(update, node, begin, end, place, product, target);
    });
  }
  return updates;
}

/// The product of a descendant's rows with those among some of the supernode's columns.
template <class Value>
void SupernodalFactor<Value>::subtract(const Update& update, int node, int begin, int end,
                                       const std::vector<int>& place, std::vector<Value>& product,
                                       std::vector<int>& target) {
  const int* const their_rows = rows(update.descendant);
  const auto row_of = [&](int column) {
    return static_cast<int>(
        std::lower_bound(their_rows + update.from, their_rows + update.to, super_[node] + column) -
        their_rows);
  };
  const int from = row_of(begin), to = row_of(end);
  if (from == to) return;
  const int stride = row_count(update.descendant), all = stride - from;
  const auto needed = static_cast<std::size_t>(all) * at(to - from);
  if (product.size() < needed) product.resize(needed);
  multiply(all, to - from, column_count(update.descendant), Blas<Value>::one,
           static_cast<const Value*>(values(update.descendant)) + from, stride, Blas<Value>::none,
           product.data(), all);
  const Value* entry = product.data();
  const int own_stride = row_count(node);
  target.resize(at(all));
  for (int i = 0; i < all; ++i) target[at(i)] = place[at(their_rows[from + i])];
  for (int j = 0; j < to - from; ++j) {
    Value* of_column = values(node) + static_cast<std::ptrdiff_t>(target[at(j)]) * own_stride;
    for (int i = j; i < all; ++i) of_column[target[at(i)]] -= entry[i];
    entry += all;
  }
}

/// Factorises the columns of a supernode from which all is subtracted.
/// @returns how many of its columns are positive definite
template <class Value>
int SupernodalFactor<Value>::factorise_columns(int node) {
  const int columns = column_count(node), stride = row_count(node), below = stride - columns;
  Value* const own = values(node);
  const bool is_worthwhile = static_cast<double>(columns) * columns * columns > 3 * least_work;
  const int panel = is_worthwhile ? block_size : std::max(1, columns);
  const auto entry = [&](int row, int column) {
    return own + row + static_cast<std::ptrdiff_t>(column) * stride;
  };
  const auto solve_rows = [&](int begin, int end, int column, int count) {
    by_blocks(begin, end, block_size, [&](int row, int row_end) {
      const int rows = row_end - row;
      Blas<Value>::trsm("R", "L", "T", "N", &rows, &count, &Blas<Value>::one, entry(column, column),
                        &stride, entry(row, column), &stride);
    });
  };
  for (int k = 0; k < columns; k += panel) {
    const int count = std::min(panel, columns - k), next = k + count;
    int info = 0;
    Blas<Value>::potrf("L", &count, entry(k, k), &stride, &info);
    if (info > 0) return k + info - 1;
    solve_rows(next, columns, k, count);
    by_blocks(next, columns, block_size, [&](int column, int column_end) {
      multiply(columns - column, column_end - column, count, Blas<Value>::minus_one,
               static_cast<const Value*>(entry(column, k)), stride, Blas<Value>::one,
               entry(column, column), stride);
    });
  }
  if (static_cast<double>(below) * columns * columns < least_work) {
    if (below > 0)
      Blas<Value>::trsm("R", "L", "T", "N", &below, &columns, &Blas<Value>::one, own, &stride,
                        entry(columns, 0), &stride);
  } else {
    solve_rows(columns, stride, 0, columns);
  }
  return columns;
}

template <class Value>
void SupernodalFactor<Value>::forward(Vector& x) const {
  const int step = 1;
  Vector gathered(size_);
  for (int node = 0; node < count_; ++node) {
    const int columns = column_count(node), stride = row_count(node), below = stride - columns;
    const Value* own = values(node);
    Value* of_node = x.data() + super_[node];
    Blas<Value>::trsv("L", "N", "N", &columns, own, &stride, of_node, &step);
    if (below == 0) continue;
    const int* row = rows(node) + columns;
    for (int i = 0; i < below; ++i) gathered[i] = x[row[i]];
    Blas<Value>::gemv("N", &below, &columns, &Blas<Value>::minus_one, own + columns, &stride,
                      of_node, &step, &Blas<Value>::one, gathered.data(), &step);
    for (int i = 0; i < below; ++i) x[row[i]] = gathered[i];
  }
}

template <class Value>
void SupernodalFactor<Value>::backward(Vector& x) const {
  const int step = 1;
  Vector gathered(size_);
  for (int node = count_ - 1; node >= 0; --node) {
    const int columns = column_count(node), stride = row_count(node), below = stride - columns;
    const Value* own = values(node);
    Value* of_node = x.data() + super_[node];
    const int* row = rows(node) + columns;
    for (int i = 0; i < below; ++i) gathered[i] = x[row[i]];
    if (below > 0)
      Blas<Value>::gemv("T", &below, &columns, &Blas<Value>::minus_one, own + columns, &stride,
                        gathered.data(), &step, &Blas<Value>::one, of_node, &step);
    Blas<Value>::trsv("L", "T", "N", &columns, own, &stride, of_node, &step);
  }
}

template class SupernodalFactor<float>;
template class SupernodalFactor<double>;

}  // namespace softfinger::fem
