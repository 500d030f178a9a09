#include "fem/algebra/cholesky.h"

#include <suitesparse/cholmod.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "fem/algebra/positive_definite.h"
#include "fem/algebra/supernodal_factor.h"
#include "fem/base/memory.h"
#include "fem/base/threads.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

struct CholeskyFactor::Implementation {
  Implementation() { cholmod_start(&common); }
  ~Implementation() {
    free_factor();
    cholmod_finish(&common);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  cholmod_common common{};
  cholmod_factor* analysis = nullptr;  ///< CHOLMOD's, without numbers
  std::unique_ptr<SupernodalFactor<double>> full;
  std::unique_ptr<SupernodalFactor<float>> single;  ///< in its place
  int size = 0;
  std::vector<int> last;
  std::vector<int> order;  ///< unknowns in the order of elimination
  /// The matrix in that order: CHOLMOD would permute it anew, twice, for each factorisation.
  SparseSymmetricMatrix ordered;
  std::vector<int> source;  ///< of each entry, in the matrix that is given

  void analyse(const SparseSymmetricMatrix& matrix, const std::vector<int>& dissection,
               const std::vector<int>& of_last, Precision precision);
  void set_ordered(const SparseSymmetricMatrix& matrix);
  void free_factor() {
    full.reset();
    single.reset();
    cholmod_free_factor(&analysis, &common);
  }

  /// Columns of the factor's trailing block, in the order of elimination.
  /// @param visit  called with their rows, the column's own first, with the entries, and how many
  template <class Visit>
  void for_each_trailing_column(const Visit& visit) const;
  template <class Value, class Visit>
  void for_each_trailing_column_of(const Value* values, const Visit& visit) const;
  /// The trailing block of the factor, lower triangle.
  Eigen::MatrixXd trailing_factor() const;
  Eigen::MatrixXd inverse_of_trailing(Eigen::MatrixXd block) const;
  /// A symmetric matrix of which the lower triangle is given, from the order of elimination.
  Eigen::MatrixXd in_order_of_last(const Eigen::MatrixXd& lower) const;
  /// The place of each of `last` in the order of elimination.
  std::vector<int> place_of_last() const;
};

namespace {

/// CHOLMOD only reads the input, but its interface takes no pointer to const.
cholmod_sparse view_of(const SparseSymmetricMatrix& matrix) {
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(matrix.size);
  view.nzmax = matrix.row.size();
  view.p = const_cast<int*>(matrix.column_begin.data());
  view.i = const_cast<int*>(matrix.row.data());
  view.x = const_cast<double*>(matrix.value.data());
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = view.packed = 1;
  return view;
}

/// The chosen unknowns moved to the end: the rest keeps its small fill, and the end is dense
/// anyway.
std::vector<int> with_last(const std::vector<int>& dissection, const std::vector<int>& last) {
  std::vector<char> is_last(dissection.size(), 0);
  for (const int unknown : last) is_last[static_cast<std::size_t>(unknown)] = 1;
  std::vector<int> ordering;
  ordering.reserve(dissection.size());
  for (const char end : {0, 1})
    for (const int unknown : dissection)
      if (is_last[static_cast<std::size_t>(unknown)] == end) ordering.push_back(unknown);
  return ordering;
}

/// The size of the factor is known from the analysis. A job that does not fit is refused: the
/// system would end whichever process it chooses when memory runs out.
void require_memory(const cholmod_factor& factor, const SparseSymmetricMatrix& matrix,
                    std::size_t last, Precision precision) {
  constexpr double bytes_per_MB = 1024 * 1024;
  // The factor, the matrix in the order of elimination, the trailing block and its inverse.
  const double entries = static_cast<double>(matrix.row.size());
  const double bytes = precision == Precision::single ? sizeof(float) : sizeof(double);
  const double needed_MB = (bytes * static_cast<double>(factor.xsize) + 2 * 12.0 * entries +
                            2 * 8.0 * static_cast<double>(last) * static_cast<double>(last)) /
                           bytes_per_MB;
  const double available_MB = available_memory_MB();
  if (needed_MB <= available_MB) return;
  const auto text = [](double value) { return std::to_string(std::lround(value)); };
  throw NotEnoughMemory("finite elements", "memory",
                        text(needed_MB) + " MB for " + std::to_string(matrix.size) + " unknowns",
                        "at most the " + text(available_MB) + " MB available; use a lower level");
}

}  // namespace

SparseSymmetricMatrix quotient_graph(const SparseSymmetricMatrix& matrix,
                                     const std::vector<int>& group) {
  SparseSymmetricMatrix graph;
  graph.column_begin.push_back(0);
  std::vector<int> last_seen_by(group.size(), -1);
  for (int column = 0; column < matrix.size; ++column) {
    const int own = group[static_cast<std::size_t>(column)];
    if (own != graph.size) continue;  // its first unknown has all neighbours
    for (int k = matrix.column_begin[static_cast<std::size_t>(column)];
         k < matrix.column_begin[static_cast<std::size_t>(column) + 1]; ++k) {
      const int other = group[static_cast<std::size_t>(matrix.row[static_cast<std::size_t>(k)])];
      int& seen_by = last_seen_by[static_cast<std::size_t>(other)];
      if (other < own || seen_by == own) continue;
      seen_by = own;
      graph.row.push_back(other);
    }
    std::sort(graph.row.begin() + graph.column_begin.back(), graph.row.end());
    graph.column_begin.push_back(static_cast<int>(graph.row.size()));
    ++graph.size;
  }
  return graph;
}

std::vector<int> nested_dissection(const SparseSymmetricMatrix& matrix) {
  const auto lock = lock_global_state();
  cholmod_common common{};
  cholmod_start(&common);
  common.print = 0;
  cholmod_sparse view = view_of(matrix);
  view.x = nullptr;
  view.xtype = CHOLMOD_PATTERN;
  std::vector<int> ordering(view.nrow);
  const bool done =
      cholmod_metis(&view, nullptr, 0, /*postorder=*/1, ordering.data(), &common) != 0;
  cholmod_finish(&common);
  if (!done)
    throw ConvergenceError("fill-reducing ordering", 0, 0,
                           "METIS refused the matrix or memory ran out");
  return ordering;
}

CholeskyFactor::CholeskyFactor(const SparseSymmetricMatrix& matrix,
                               const std::vector<int>& dissection, const std::vector<int>& last,
                               Precision precision)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->analyse(matrix, dissection, last, precision);
  factorise(matrix);
}

CholeskyFactor::CholeskyFactor() : implementation_(std::make_unique<Implementation>()) {}

std::unique_ptr<CholeskyFactor> CholeskyFactor::analysed(const SparseSymmetricMatrix& matrix,
                                                         const std::vector<int>& dissection,
                                                         const std::vector<int>& last,
                                                         Precision precision) {
  std::unique_ptr<CholeskyFactor> result(new CholeskyFactor);
  result->implementation_->analyse(matrix, dissection, last, precision);
  return result;
}

void CholeskyFactor::Implementation::analyse(const SparseSymmetricMatrix& matrix,
                                             const std::vector<int>& dissection,
                                             const std::vector<int>& of_last, Precision precision) {
  common.print = 0;
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.final_ll = 1;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_GIVEN;
  common.postorder = 1;
  size = matrix.size;
  last = of_last;

  cholmod_sparse view = view_of(matrix);
  std::vector<int> ordering = with_last(dissection, of_last);
  analysis = cholmod_analyze_p(&view, ordering.data(), nullptr, 0, &common);
  if (!analysis || common.status != CHOLMOD_OK)
    throw ConvergenceError("Cholesky factorisation", 0, common.memory_usage / 1e6,
                           "memory ran out; use a lower level");
  require_memory(*analysis, matrix, last.size(), precision);
  if (precision == Precision::single)
    single = std::make_unique<SupernodalFactor<float>>(*analysis);
  else
    full = std::make_unique<SupernodalFactor<double>>(*analysis);
}

void CholeskyFactor::factorise(const SparseSymmetricMatrix& matrix) {
  SparseSymmetricMatrix& ordered = implementation_->ordered;
  if (ordered.column_begin.empty()) implementation_->set_ordered(matrix);
  for (std::size_t i = 0; i < ordered.value.size(); ++i)
    ordered.value[i] = matrix.value[static_cast<std::size_t>(implementation_->source[i])];
  const int failed = implementation_->single ? implementation_->single->factorise(ordered)
                                             : implementation_->full->factorise(ordered);
  if (failed < matrix.size)
    throw ConvergenceError(
        "Cholesky factorisation", failed, 0,
        "the stiffness is not positive definite; is the mesh inverted or nu too near 1/2?");
}

CholeskyFactor::~CholeskyFactor() = default;

/// Takes the ordering over from the analysis, which then is that of the ordered matrix. It is as
/// large as the matrix: what made that may be gone by now.
void CholeskyFactor::Implementation::set_ordered(const SparseSymmetricMatrix& matrix) {
  auto* permutation = static_cast<int*>(analysis->Perm);
  order.assign(permutation, permutation + size);
  std::iota(permutation, permutation + size, 0);
  analysis->ordering = CHOLMOD_NATURAL;
  std::vector<int> place(order.size());
  for (int i = 0; i < size; ++i)
    place[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] = i;
  // Entries sorted by their row, then stably by their column: rows ascend in each column.
  struct Entry {
    int row, column, source;
  };
  const auto for_each_entry = [&](const auto& visit) {
    for (int column = 0; column < matrix.size; ++column)
      for (int k = matrix.column_begin[static_cast<std::size_t>(column)];
           k < matrix.column_begin[static_cast<std::size_t>(column) + 1]; ++k) {
        const int one = place[static_cast<std::size_t>(column)],
                  other = place[static_cast<std::size_t>(matrix.row[static_cast<std::size_t>(k)])];
        visit(Entry{std::max(one, other), std::min(one, other), k});
      }
  };
  std::vector<int> row_begin(order.size() + 1, 0), column_begin(order.size() + 1, 0);
  for_each_entry([&](const Entry& entry) {
    ++row_begin[static_cast<std::size_t>(entry.row) + 1];
    ++column_begin[static_cast<std::size_t>(entry.column) + 1];
  });
  std::partial_sum(row_begin.begin(), row_begin.end(), row_begin.begin());
  std::partial_sum(column_begin.begin(), column_begin.end(), column_begin.begin());
  std::vector<Entry> by_row(matrix.row.size());
  for_each_entry([&](const Entry& entry) {
    by_row[static_cast<std::size_t>(row_begin[static_cast<std::size_t>(entry.row)]++)] = entry;
  });
  ordered.size = size;
  ordered.column_begin = column_begin;
  ordered.row.resize(by_row.size());
  ordered.value.resize(by_row.size());
  source.resize(by_row.size());
  for (const Entry& entry : by_row) {
    const auto at =
        static_cast<std::size_t>(column_begin[static_cast<std::size_t>(entry.column)]++);
    ordered.row[at] = entry.row;
    source[at] = entry.source;
  }
}

/// A supernode that straddles the first of the last unknowns contributes its trailing columns and
/// rows only.
template <class Visit>
void CholeskyFactor::Implementation::for_each_trailing_column(const Visit& visit) const {
  if (single)
    for_each_trailing_column_of(single->values(), visit);
  else
    for_each_trailing_column_of(full->values(), visit);
}

template <class Value, class Visit>
void CholeskyFactor::Implementation::for_each_trailing_column_of(const Value* values,
                                                                 const Visit& visit) const {
  const auto* super = static_cast<const int*>(analysis->super);
  const auto* row_begin = static_cast<const int*>(analysis->pi);
  const auto* value_begin = static_cast<const int*>(analysis->px);
  const auto* rows = static_cast<const int*>(analysis->s);
  const int first = size - static_cast<int>(last.size());
  for (std::size_t node = 0; node < analysis->nsuper; ++node) {
    if (super[node + 1] <= first) continue;
    const int row_count = row_begin[node + 1] - row_begin[node];
    for (int column = std::max(super[node], first); column < super[node + 1]; ++column) {
      const int skipped = column - super[node];
      const Value* entries =
          values + value_begin[node] + static_cast<std::ptrdiff_t>(skipped) * row_count;
      visit(rows + row_begin[node] + skipped, entries + skipped, row_count - skipped);
    }
  }
}

Eigen::MatrixXd CholeskyFactor::Implementation::trailing_factor() const {
  const int count = static_cast<int>(last.size()), first = size - count;
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(count, count);
  for_each_trailing_column([&](const int* row, const auto* entry, int entries) {
    for (int i = 0; i < entries; ++i) block(row[i] - first, row[0] - first) = entry[i];
  });
  return block;
}

std::vector<int> CholeskyFactor::Implementation::place_of_last() const {
  const int first = size - static_cast<int>(last.size());
  std::vector<int> place(static_cast<std::size_t>(size), -1);
  for (int i = first; i < size; ++i)
    place[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] = i;
  std::vector<int> result;
  for (const int unknown : last) {
    result.push_back(place[static_cast<std::size_t>(unknown)]);
    if (result.back() < 0)
      throw ConvergenceError("condensation on the contact surface", unknown, 0,
                             "the ordering did not keep the contact unknowns last");
  }
  return result;
}

Eigen::MatrixXd CholeskyFactor::Implementation::in_order_of_last(
    const Eigen::MatrixXd& lower) const {
  const std::vector<int> place = place_of_last();
  const int count = static_cast<int>(place.size()), first = size - count;
  Eigen::MatrixXd result(count, count);
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i) {
      const int one = place[static_cast<std::size_t>(i)] - first,
                other = place[static_cast<std::size_t>(j)] - first;
      result(i, j) = lower(std::max(one, other), std::min(one, other));
    }
  return result;
}

Eigen::MatrixXd CholeskyFactor::Implementation::inverse_of_trailing(Eigen::MatrixXd block) const {
  if (!invert_by_factor(block))
    throw ConvergenceError("condensation on the contact surface", 0, 0, "the factor is singular");
  return in_order_of_last(block);
}

Eigen::MatrixXd CholeskyFactor::compliance_of_last() const& {
  return implementation_->inverse_of_trailing(implementation_->trailing_factor());
}

Eigen::MatrixXd CholeskyFactor::compliance_of_last() && {
  Eigen::MatrixXd block = implementation_->trailing_factor();
  implementation_->free_factor();
  return implementation_->inverse_of_trailing(std::move(block));
}

Eigen::MatrixXd CholeskyFactor::stiffness_of_last() const {
  Eigen::MatrixXd block = implementation_->trailing_factor();
  multiply_factor(block);
  return implementation_->in_order_of_last(block);
}

Eigen::VectorXd CholeskyFactor::solve(const Eigen::VectorXd& right_hand_side) const {
  return backward(forward(right_hand_side));
}

Eigen::VectorXd CholeskyFactor::forward(const Eigen::VectorXd& right_hand_side) const {
  Eigen::VectorXd result = right_hand_side(implementation_->order);
  if (!implementation_->single) {
    implementation_->full->forward(result);
    return result;
  }
  Eigen::VectorXf rounded = result.cast<float>();
  implementation_->single->forward(rounded);
  return rounded.cast<double>();
}

Eigen::VectorXd CholeskyFactor::backward(const Eigen::VectorXd& forward) const {
  Eigen::VectorXd solution = forward;
  if (implementation_->single) {
    Eigen::VectorXf rounded = forward.cast<float>();
    implementation_->single->backward(rounded);
    solution = rounded.cast<double>();
  } else {
    implementation_->full->backward(solution);
  }
  Eigen::VectorXd result(forward.size());
  result(implementation_->order) = solution;
  return result;
}

Eigen::VectorXd CholeskyFactor::force_on_last(const Eigen::VectorXd& forward) const {
  Eigen::VectorXd in_order = Eigen::VectorXd::Zero(forward.size());
  implementation_->for_each_trailing_column([&](const int* row, const auto* entry, int entries) {
    for (int i = 0; i < entries; ++i) in_order[row[i]] += entry[i] * forward[row[0]];
  });
  const std::vector<int> place = implementation_->place_of_last();
  Eigen::VectorXd result(place.size());
  for (std::size_t i = 0; i < place.size(); ++i)
    result[static_cast<Eigen::Index>(i)] = in_order[place[i]];
  return result;
}

void CholeskyFactor::add_to_last(const Eigen::VectorXd& force, Eigen::VectorXd& forward) const {
  Eigen::VectorXd left = Eigen::VectorXd::Zero(forward.size());
  const std::vector<int> place = implementation_->place_of_last();
  for (std::size_t i = 0; i < place.size(); ++i)
    left[place[i]] = force[static_cast<Eigen::Index>(i)];
  implementation_->for_each_trailing_column([&](const int* row, const auto* entry, int entries) {
    const double solution = left[row[0]] / entry[0];
    for (int i = 1; i < entries; ++i) left[row[i]] -= entry[i] * solution;
    forward[row[0]] += solution;
  });
}

}  // namespace softfinger::fem
