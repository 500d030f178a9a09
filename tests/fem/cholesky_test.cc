#include "fem/algebra/cholesky.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>

#include "fem/base/memory.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

/// Seven-point Laplacian plus one on a cube of `side`³ points.
SparseSymmetricMatrix laplacian(int side) {
  SparseSymmetricMatrix matrix;
  matrix.size = side * side * side;
  matrix.column_begin.push_back(0);
  for (int i = 0; i < matrix.size; ++i) {
    const auto add = [&](int row, double value) {
      matrix.row.push_back(row);
      matrix.value.push_back(value);
    };
    add(i, 7);
    if ((i + 1) % side != 0) add(i + 1, -1);
    if (i / side % side + 1 < side) add(i + side, -1);
    if (i + side * side < matrix.size) add(i + side * side, -1);
    matrix.column_begin.push_back(static_cast<int>(matrix.row.size()));
  }
  return matrix;
}

Eigen::MatrixXd dense(const SparseSymmetricMatrix& matrix) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(matrix.size, matrix.size);
  for (int column = 0; column < matrix.size; ++column)
    for (int k = matrix.column_begin[static_cast<std::size_t>(column)];
         k < matrix.column_begin[static_cast<std::size_t>(column) + 1]; ++k) {
      const int row = matrix.row[static_cast<std::size_t>(k)];
      result(row, column) = result(column, row) = matrix.value[static_cast<std::size_t>(k)];
    }
  return result;
}

/// Tolerances are those of full precision; single precision has a coarser unit of round-off.
class CholeskyFactorIn : public testing::TestWithParam<Precision> {
 protected:
  double within(double of_full_precision) const {
    return GetParam() == Precision::full
               ? of_full_precision
               : of_full_precision * std::numeric_limits<float>::epsilon() /
                     std::numeric_limits<double>::epsilon();
  }
};
INSTANTIATE_TEST_SUITE_P(Precisions, CholeskyFactorIn,
                         testing::Values(Precision::full, Precision::single),
                         [](const auto& test) -> std::string {
                           return test.param == Precision::full ? "full" : "single";
                         });

TEST_P(CholeskyFactorIn, InvertsTheSchurComplementInTheOrderAskedFor) {
  const SparseSymmetricMatrix matrix = laplacian(8);
  const std::vector<int> last{77, 3, 124, 50, 4};
  const CholeskyFactor factor(matrix, nested_dissection(matrix), last, GetParam());
  const Eigen::MatrixXd inverse = dense(matrix).inverse();
  EXPECT_LT((factor.compliance_of_last() - inverse(last, last)).norm(), within(1e-13));
  const Eigen::MatrixXd stiffness = Eigen::MatrixXd(inverse(last, last)).inverse();
  EXPECT_LT((factor.stiffness_of_last() - stiffness).norm(), within(1e-12) * stiffness.norm());
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.size, -1, 1);
  EXPECT_LT((factor.solve(right) - inverse * right).norm(), within(1e-12));
}

// Forces on the last unknowns that are known only after the first half of the work.
TEST_P(CholeskyFactorIn, SolvesInHalves) {
  const SparseSymmetricMatrix matrix = laplacian(8);
  const std::vector<int> last{77, 3, 124, 50, 4};
  const CholeskyFactor factor(matrix, nested_dissection(matrix), last, GetParam());
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.size, -1, 1);
  Eigen::VectorXd forward = factor.forward(right);
  const Eigen::VectorXd solution = factor.solve(right);
  EXPECT_LT((factor.backward(forward) - solution).norm(), within(1e-13));
  // The force that holds them still is the Schur complement times their free displacement.
  const Eigen::VectorXd force = factor.stiffness_of_last() * solution(last);
  EXPECT_LT((factor.force_on_last(forward) - force).norm(), within(1e-12) * force.norm());
  const Eigen::VectorXd more = Eigen::VectorXd::LinSpaced(5, 3, -2);
  Eigen::VectorXd with_more = right;
  for (std::size_t i = 0; i < last.size(); ++i)
    with_more[last[i]] += more[static_cast<Eigen::Index>(i)];
  factor.add_to_last(more, forward);
  EXPECT_LT((factor.backward(forward) - factor.solve(with_more)).norm(), within(1e-13));
}

// The entries that are given are reordered: those of another matrix as well.
TEST_P(CholeskyFactorIn, FactorisesAnotherMatrixOfTheSameGraph) {
  const SparseSymmetricMatrix matrix = laplacian(8);
  SparseSymmetricMatrix other = matrix;
  for (std::size_t i = 0; i < other.value.size(); ++i)
    other.value[i] *= 1 + 0.1 * std::sin(static_cast<double>(i));
  const std::vector<int> last{77, 3, 124, 50, 4};
  CholeskyFactor factor(matrix, nested_dissection(matrix), last, GetParam());
  factor.factorise(other);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.size, -1, 1);
  const Eigen::VectorXd expected = dense(other).llt().solve(right);
  EXPECT_LT((factor.solve(right) - expected).norm(), within(1e-13) * expected.norm());
  const Eigen::MatrixXd compliance = dense(other).inverse();
  EXPECT_LT((factor.compliance_of_last() - compliance(last, last)).norm(),
            within(1e-13) * compliance.norm());
}

TEST(QuotientGraph, OfDoubledUnknownsIsTheGraphOfTheirPairs) {
  const SparseSymmetricMatrix one = laplacian(3);
  const Eigen::MatrixXd pattern = dense(one).cwiseAbs().cwiseMin(1);
  // Each unknown twice, all coupled; the second ones after all first ones.
  SparseSymmetricMatrix doubled;
  doubled.size = 2 * one.size;
  doubled.column_begin.push_back(0);
  std::vector<int> group;
  for (int column = 0; column < doubled.size; ++column) {
    group.push_back(column % one.size);
    for (int row = column; row < doubled.size; ++row)
      if (pattern(row % one.size, column % one.size) > 0) doubled.row.push_back(row);
    doubled.column_begin.push_back(static_cast<int>(doubled.row.size()));
  }
  const SparseSymmetricMatrix graph = quotient_graph(doubled, group);
  ASSERT_EQ(graph.size, one.size);
  for (int column = 0; column < one.size; ++column)
    for (int row = 0; row < one.size; ++row) {
      const auto begin = graph.row.begin() + graph.column_begin[static_cast<std::size_t>(column)],
                 end = graph.row.begin() + graph.column_begin[static_cast<std::size_t>(column) + 1];
      EXPECT_EQ(std::count(begin, end, row), row >= column ? pattern(row, column) : 0);
    }
}

TEST_P(CholeskyFactorIn, RefusesAMatrixThatIsNotPositiveDefinite) {
  SparseSymmetricMatrix matrix = laplacian(4);
  matrix.value[0] = -7;
  EXPECT_THROW(CholeskyFactor(matrix, nested_dissection(matrix), {1}, GetParam()),
               ConvergenceError);
}

/// Runs in a child process, since a limit on the address space cannot be taken back.
void factorise_in_little_memory() {
  const SparseSymmetricMatrix matrix = laplacian(40);
  // Enough for the ordering and the analysis, not for the factor of about 150 MB.
  std::ifstream statistics("/proc/self/statm");
  long pages = 0;
  statistics >> pages;
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = static_cast<rlim_t>(pages * sysconf(_SC_PAGESIZE)) + (100 << 20);
  setrlimit(RLIMIT_AS, &limit);
  try {
    const CholeskyFactor factor(matrix, nested_dissection(matrix), {1});
  } catch (const InputError& error) {
    std::cerr << error.what() << std::endl;
    _exit(3);
  }
  _exit(0);
}

TEST(CholeskyFactorDeathTest, RefusesAJobThatWouldNotFitAndSaysHowMuchItNeeds) {
  EXPECT_EXIT(factorise_in_little_memory(), testing::ExitedWithCode(3),
              "memory = [0-9]+ MB for 64000 unknowns.*[0-9]+ MB available");
}

TEST(Memory, PeakIsAtLeastWhatWasTouched) {
  const std::vector<char> touched(64 << 20, 1);
  EXPECT_GE(peak_memory_MB(), 64);
  EXPECT_GT(available_memory_MB(), 0);
  EXPECT_EQ(touched.back(), 1);
}

}  // namespace
}  // namespace softfinger::fem
