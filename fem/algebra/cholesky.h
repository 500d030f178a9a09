#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "softfinger/input/errors.h"

namespace softfinger::fem {

/// A sparse symmetric positive definite matrix: lower triangle, compressed columns, rows ascending.
struct SparseSymmetricMatrix {
  int size = 0;
  std::vector<int> column_begin;  ///< size + 1
  std::vector<int> row;
  std::vector<double> value;
};

/// A factorisation that would not fit, refused before it is made.
class NotEnoughMemory : public InputError {
 public:
  using InputError::InputError;
};

/// The graph of a matrix whose unknowns are merged in groups, such as those of a node, that share
/// all their neighbours: without values.
/// @param group  of each unknown, numbered by their first unknowns
SparseSymmetricMatrix quotient_graph(const SparseSymmetricMatrix& matrix,
                                     const std::vector<int>& group);

/// An ordering of the unknowns that keeps the fill low, by nested dissection of the whole graph.
/// @param matrix  of which only the graph counts
/// @throws ConvergenceError when memory runs out
std::vector<int> nested_dissection(const SparseSymmetricMatrix& matrix);

/// The precision in which a factor is kept and applied. A step of Newton's method whose residual is
/// exact needs no more than single precision, at half of the time and memory. The relative error of
/// such a solution is of the order of 6e-8 times the matrix's condition number.
enum class Precision { full, single };

/// Supernodal Cholesky factor whose last unknowns are chosen, so that its trailing block is the
/// factor of the Schur complement on them: one factorisation gives the condensed stiffness of the
/// contact surface, with no right-hand side solved for it.
class CholeskyFactor {
 public:
  /// @param dissection  of the matrix, or of one with nearly its graph
  /// @param last        unknowns to eliminate last
  /// @throws NotEnoughMemory, before the factorisation, when its memory would not be available;
  /// ConvergenceError when the matrix is not positive definite.
  CholeskyFactor(const SparseSymmetricMatrix& matrix, const std::vector<int>& dissection,
                 const std::vector<int>& last, Precision precision = Precision::full);
  /// Symbolic analysis only; its predicted memory is checked. The factor is of no use before
  /// `factorise`.
  /// @param matrix  of which only the graph counts
  /// @throws NotEnoughMemory
  static std::unique_ptr<CholeskyFactor> analysed(const SparseSymmetricMatrix& matrix,
                                                  const std::vector<int>& dissection,
                                                  const std::vector<int>& last,
                                                  Precision precision = Precision::full);
  ~CholeskyFactor();

  /// Factorises another matrix with the same graph, in place. The analysis is kept.
  /// @throws ConvergenceError as the constructor; the factor is then of no use but for this
  /// function
  void factorise(const SparseSymmetricMatrix& matrix);

  CholeskyFactor(const CholeskyFactor&) = delete;
  CholeskyFactor& operator=(const CholeskyFactor&) = delete;

  /// Inverse of the Schur complement on `last`, in the order of `last`: the displacements of these
  /// unknowns per unit force on one of them. Dense, symmetric.
  Eigen::MatrixXd compliance_of_last() const&;
  /// Computes the same and gives the factor's memory back: nothing else may be asked of it then.
  Eigen::MatrixXd compliance_of_last() &&;

  /// The Schur complement on `last` itself, in the order of `last`: forces on these unknowns per
  /// displacement of one of them, all others of them held. Dense, symmetric.
  Eigen::MatrixXd stiffness_of_last() const;

  Eigen::VectorXd solve(const Eigen::VectorXd& right_hand_side) const;

  /// `solve` in its two halves, where forces on `last` are known only after the first: L^-1 of the
  /// right-hand side, L the factor, in the order of elimination.
  Eigen::VectorXd forward(const Eigen::VectorXd& right_hand_side) const;
  /// @returns the forces that hold `last` at zero displacement, against what `forward` is of
  Eigen::VectorXd force_on_last(const Eigen::VectorXd& forward) const;
  /// Makes `forward` that of a right-hand side with these forces on `last` as well.
  void add_to_last(const Eigen::VectorXd& force, Eigen::VectorXd& forward) const;
  Eigen::VectorXd backward(const Eigen::VectorXd& forward) const;

 private:
  CholeskyFactor();

  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger::fem
