#include "fem/algebra/positive_definite.h"

// LAPACK: Cholesky's factor, and from it the inverse and the matrix itself.
extern "C" {
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void spotrf_(const char* uplo, const int* n, float* a, const int* lda, int* info);
void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dpotrs_(const char* uplo, const int* n, const int* columns, const double* a, const int* lda,
             double* b, const int* ldb, int* info);
void dlauum_(const char* uplo, const int* n, double* a, const int* lda, int* info);
}

namespace softfinger::fem {
namespace {

void mirror_lower(Eigen::MatrixXd& matrix) {
  matrix.triangularView<Eigen::StrictlyUpper>() = matrix.transpose();
}

}  // namespace

bool factorise_positive_definite(Eigen::MatrixXd& matrix) {
  const int size = static_cast<int>(matrix.rows());
  int info = 0;
  if (size > 0) dpotrf_("L", &size, matrix.data(), &size, &info);
  return info == 0;
}

bool factorise_positive_definite(Eigen::MatrixXf& matrix) {
  const int size = static_cast<int>(matrix.rows());
  int info = 0;
  if (size > 0) spotrf_("L", &size, matrix.data(), &size, &info);
  return info == 0;
}

Eigen::MatrixXd solve_by_factor(const Eigen::MatrixXd& factor,
                                const Eigen::MatrixXd& right_hand_sides) {
  const int size = static_cast<int>(factor.rows());
  const int columns = static_cast<int>(right_hand_sides.cols());
  int info = 0;
  Eigen::MatrixXd result = right_hand_sides;
  if (size > 0 && columns > 0)
    dpotrs_("L", &size, &columns, factor.data(), &size, result.data(), &size, &info);
  return result;
}

namespace {

template <class Matrix, class Vector>
Vector solve_one_by_factor(const Matrix& factor, const Vector& right_hand_side) {
  // LAPACK's function for many right-hand sides would copy the factor for one.
  Vector result = right_hand_side;
  const auto lower = factor.template triangularView<Eigen::Lower>();
  lower.solveInPlace(result);
  lower.transpose().solveInPlace(result);
  return result;
}

}  // namespace

Eigen::VectorXd solve_vector_by_factor(const Eigen::MatrixXd& factor,
                                       const Eigen::VectorXd& right_hand_side) {
  return solve_one_by_factor(factor, right_hand_side);
}

Eigen::VectorXf solve_vector_by_factor(const Eigen::MatrixXf& factor,
                                       const Eigen::VectorXf& right_hand_side) {
  return solve_one_by_factor(factor, right_hand_side);
}

bool invert_by_factor(Eigen::MatrixXd& factor) {
  const int size = static_cast<int>(factor.rows());
  int info = 0;
  if (size > 0) dpotri_("L", &size, factor.data(), &size, &info);
  return info == 0;
}

void multiply_factor(Eigen::MatrixXd& factor) {
  // LAPACK multiplies U U^T of an upper triangle. In the reverse order of rows and columns L is
  // one.
  const int size = static_cast<int>(factor.rows());
  int info = 0;
  Eigen::MatrixXd upper = factor.reverse();
  if (size > 0) dlauum_("U", &size, upper.data(), &size, &info);
  factor = upper.reverse();
}

Eigen::MatrixXd inverse_of_positive_definite(Eigen::MatrixXd matrix) {
  if (!factorise_positive_definite(matrix) || !invert_by_factor(matrix)) return {};
  mirror_lower(matrix);
  return matrix;
}

Eigen::VectorXd product_with_zeros(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& vector) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(matrix.rows());
  const Eigen::Index size = vector.size();
  for (Eigen::Index begin = 0, end = 0; begin < size; begin = end) {
    for (; begin < size && vector[begin] == 0;) ++begin;
    for (end = begin; end < size && vector[end] != 0;) ++end;
    if (begin < end)
      result.noalias() +=
          matrix.middleCols(begin, end - begin) * vector.segment(begin, end - begin);
  }
  return result;
}

Eigen::VectorXd solve_positive_definite(const Eigen::MatrixXd& matrix,
                                        const Eigen::VectorXd& right_hand_side) {
  Eigen::MatrixXd factor = matrix;
  factorise_positive_definite(factor);
  return solve_vector_by_factor(factor, right_hand_side);
}

}  // namespace softfinger::fem
