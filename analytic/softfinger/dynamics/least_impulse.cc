#include "softfinger/dynamics/least_impulse.h"

#include <algorithm>
#include <cmath>

#include "softfinger/dynamics/contact_residual.h"

namespace softfinger::internal {
namespace {

using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::Vector4d;

/// The point of the cone |s| <= P nearest to (P, s), and its derivative.
Vector4d project_onto_cone(const Vector4d& point, Matrix4d& derivative) {
  const double normal = point[0], length = point.tail<3>().norm();
  derivative.setZero();
  if (length <= normal) {
    derivative.setIdentity();
    return point;
  }
  if (length <= -normal) return Vector4d::Zero();
  const Vector3d direction = point.tail<3>() / length;
  const double projected = (normal + length) / 2;
  derivative(0, 0) = 0.5;
  derivative.block<1, 3>(0, 1) = 0.5 * direction.transpose();
  derivative.block<3, 1>(1, 0) = 0.5 * direction;
  derivative.block<3, 3>(1, 1) = projected / length * Eigen::Matrix3d::Identity() +
                                 (0.5 - projected / length) * direction * direction.transpose();
  Vector4d result;
  result << projected, projected * direction;
  return result;
}

/// matrix += left^T right, by pieces for which Eigen allocates nothing. Only the lower half is of
/// use.
void add_product(const MatrixXd& left, const MatrixXd& right, int rows, int columns,
                 MatrixXd& matrix) {
  constexpr int kPiece = 64;
  for (int r = 0; r < rows; r += kPiece) {
    const int height = std::min(kPiece, rows - r);
    for (int i = 0; i < columns; i += kPiece)
      for (int j = 0; j <= i; j += kPiece) {
        const int wide = std::min(kPiece, columns - i), across = std::min(kPiece, columns - j);
        matrix.block(i, j, wide, across).noalias() +=
            left.block(r, i, height, wide).transpose() * right.block(r, j, height, across);
      }
  }
}

/// Cholesky's decomposition of the lower half in place. False where the matrix is not positive
/// definite.
bool decompose(MatrixXd& matrix, int size) {
  for (int p = 0; p < size; ++p) {
    if (!(matrix(p, p) > 0)) return false;
    const double root = std::sqrt(matrix(p, p));
    const int below = size - p - 1;
    matrix(p, p) = root;
    matrix.col(p).segment(p + 1, below) /= root;
    for (int j = p + 1; j < size; ++j)
      matrix.col(j).segment(j, size - j).noalias() -=
          matrix(j, p) * matrix.col(p).segment(j, size - j);
  }
  return true;
}

/// The solution by that decomposition, in place.
void substitute(const MatrixXd& matrix, int size, Eigen::VectorXd& right) {
  for (int p = 0; p < size; ++p) {
    right[p] /= matrix(p, p);
    right.segment(p + 1, size - p - 1).noalias() -=
        right[p] * matrix.col(p).segment(p + 1, size - p - 1);
  }
  for (int p = size - 1; p >= 0; --p) {
    const int below = size - p - 1;
    right[p] = (right[p] - matrix.col(p).segment(p + 1, below).dot(right.segment(p + 1, below))) /
               matrix(p, p);
  }
}

}  // namespace

LeastImpulse::LeastImpulse(int contact_capacity)
    : factor_(4 * contact_capacity, 4 * contact_capacity),
      turned_(4 * contact_capacity, 4 * contact_capacity),
      matrix_(4 * contact_capacity, 4 * contact_capacity),
      diagonal_(4 * contact_capacity),
      dual_(4 * contact_capacity),
      wanted_(4 * contact_capacity),
      gradient_(4 * contact_capacity),
      step_(4 * contact_capacity),
      target_(4 * contact_capacity),
      projected_(4 * contact_capacity),
      right_(4 * contact_capacity),
      velocity_(4 * contact_capacity) {
  touching_.reserve(std::size_t(contact_capacity));
  order_.reserve(std::size_t(4 * contact_capacity));
}

/// What each contact does. False where all that touch could not share their impulses anyhow.
bool LeastImpulse::classify(const ContactOperator& contacts, const Eigen::VectorXd& velocity,
                            double none) {
  touching_.clear();
  rows_ = 0;
  for (int i = 0; i < contacts.contacts(); ++i) {
    const double still = none * contacts.natural_size(i);
    if (velocity[4 * i] > still) continue;
    Touching touching{i, Mode::normal, Vector3d::Zero(), rows_, 1, Matrix4d::Zero(), true};
    if (contacts.has_friction(i)) {
      const Vector3d slip = velocity.segment<3>(4 * i + 1);
      if (slip.lpNorm<Eigen::Infinity>() > still) {
        touching.mode = Mode::slides;
        touching.friction = -contacts.boundary_point(i, slip);
      } else {
        touching.mode = Mode::sticks;
        touching.rows = 4;
      }
    }
    rows_ += touching.rows;
    touching_.push_back(touching);
  }
  return touching_.size() > 1;
}

/// S W S = L L^T in the directions of C. A contact that slides has one, in units of its length.
void LeastImpulse::factorise(const ContactLcp& problem, const ContactOperator& contacts) {
  const Eigen::VectorXd& scale = contacts.impulse_scale();
  const auto direction = [&](const Touching& touching) {
    Vector4d along = scale.segment<4>(4 * touching.contact);
    if (touching.mode == Mode::slides) {
      along.tail<3>() = along.tail<3>().cwiseProduct(touching.friction);
      along /= std::sqrt(1 + touching.friction.squaredNorm());
    } else if (touching.mode == Mode::normal) {
      along.tail<3>().setZero();
    }
    return along;
  };
  for (const Touching& one : touching_) {
    const Vector4d along = direction(one);
    for (const Touching& other : touching_) {
      if (other.row > one.row) break;
      const auto block = problem.delassus.block<4, 4>(4 * one.contact, 4 * other.contact);
      const Vector4d across = direction(other);
      const Matrix4d scaled = along.asDiagonal() * block * across.asDiagonal();
      if (one.rows == 4 && other.rows == 4)
        turned_.block<4, 4>(one.row, other.row) = scaled;
      else if (one.rows == 4)
        turned_.block<4, 1>(one.row, other.row) = scaled.rowwise().sum();
      else if (other.rows == 4)
        turned_.block<1, 4>(one.row, other.row) = scaled.colwise().sum();
      else
        turned_(one.row, other.row) = scaled.sum();
    }
  }
  // Cholesky's method, the largest remaining diagonal element first.
  constexpr double kRounding = 1e-13;
  diagonal_.head(rows_) = turned_.topLeftCorner(rows_, rows_).diagonal();
  const double least = kRounding * diagonal_.head(rows_).maxCoeff();
  for (rank_ = 0; rank_ < rows_; ++rank_) {
    int pivot = 0;
    const double most = diagonal_.head(rows_).maxCoeff(&pivot);
    if (!(most > least)) break;
    auto column = factor_.col(rank_).head(rows_);
    column.head(pivot) = turned_.row(pivot).head(pivot).transpose();
    column.tail(rows_ - pivot) = turned_.col(pivot).segment(pivot, rows_ - pivot);
    for (int k = 0; k < rank_; ++k)
      if (factor_(pivot, k) != 0)
        column.noalias() -= factor_(pivot, k) * factor_.col(k).head(rows_);
    column /= std::sqrt(most);
    diagonal_.head(rows_) -= column.cwiseAbs2();
    diagonal_[pivot] = 0;
  }
}

/// projected_ = proj_C(target_), and its derivative. As if free: C has no bounds.
void LeastImpulse::project(bool as_if_free) {
  for (Touching& touching : touching_) {
    const int row = touching.row;
    touching.is_free = true;
    if (as_if_free) {
      touching.derivative.setIdentity();
      projected_.segment(row, touching.rows) = target_.segment(row, touching.rows);
    } else if (touching.mode == Mode::sticks) {
      const Vector4d point = target_.segment<4>(row);
      projected_.segment<4>(row) = project_onto_cone(point, touching.derivative);
      touching.is_free = projected_.segment<4>(row) == point;
    } else {
      touching.derivative(0, 0) = target_[row] > 0 ? 1 : 0;
      projected_[row] = std::max(target_[row], 0.);
      touching.is_free = target_[row] > 0;
    }
  }
}

/// L^T proj_C(L y) - L^T r*; returns the dual function.
double LeastImpulse::gradient() {
  gradient_.head(rank_).noalias() =
      factor_.topLeftCorner(rows_, rank_).transpose() * projected_.head(rows_);
  gradient_.head(rank_) -= wanted_.head(rank_);
  return projected_.head(rows_).squaredNorm() / 2 - wanted_.head(rank_).dot(dual_.head(rank_));
}

/// Newton's step of y: step_.
bool LeastImpulse::step() {
  constexpr double kProximal = 1e-12;  // of the diagonal, which may be singular
  for (int column = 0; column < rank_; ++column)
    for (const Touching& touching : touching_) {
      const int row = touching.row;
      if (touching.rows == 4)
        turned_.block<4, 1>(row, column).noalias() =
            touching.derivative * factor_.block<4, 1>(row, column);
      else
        turned_(row, column) = touching.derivative(0, 0) * factor_(row, column);
    }
  matrix_.topLeftCorner(rank_, rank_).setZero();
  add_product(factor_, turned_, rows_, rank_, matrix_);
  const double largest = matrix_.diagonal().head(rank_).maxCoeff();
  matrix_.diagonal().head(rank_).array() += kProximal * largest;
  step_.head(rank_) = -gradient_.head(rank_);
  if (!decompose(matrix_, rank_)) return false;
  substitute(matrix_, rank_, step_);
  return step_.head(rank_).allFinite();
}

/// The scaled velocities of the touching contacts in the directions of C: right_.
void LeastImpulse::read_velocity(const ContactOperator& contacts, const Eigen::VectorXd& impulse) {
  contacts.find_velocity(impulse, velocity_);
  velocity_.head(4 * contacts.contacts()) += contacts.free_velocity().head(4 * contacts.contacts());
  for (const Touching& touching : touching_)
    for (int row = 0; row < touching.rows; ++row) {
      const int at = 4 * touching.contact + row;
      const double scale = contacts.velocity_scale()[at];
      right_[touching.row + row] =
          scale > 0 ? velocity_[at] * contacts.impulse_scale()[at] / scale : 0;
    }
}

bool LeastImpulse::is_within_bounds(const ContactOperator& contacts,
                                    const Eigen::VectorXd& impulse) const {
  for (const Touching& touching : touching_) {
    const auto own = impulse.segment<4>(4 * touching.contact);
    if (!(own[0] > 0)) return false;
    if (touching.mode == Mode::sticks && own.tail<3>().norm() >= own[0]) return false;
  }
  for (int i = 0, next = 0; i < contacts.contacts(); ++i) {
    if (next < int(touching_.size()) && touching_[std::size_t(next)].contact == i)
      ++next;
    else if (!(velocity_[4 * i] > 0) || !impulse.segment<4>(4 * i).isZero(0))
      return false;
  }
  return true;
}

/// r changes by L (L^T L)^-2 L^T (-v), the least change that makes v = L L^T r + v_free zero.
bool LeastImpulse::follow(const ContactOperator& contacts, Eigen::VectorXd& impulse) {
  constexpr int kMostCorrections = 3;
  constexpr double kRoundOff = 1e-15;
  if (followed_ != contacts.contacts()) return false;
  read_velocity(contacts, impulse);
  double size = right_.head(rows_).lpNorm<Eigen::Infinity>();
  for (int correction = 0; correction < kMostCorrections && size > kRoundOff; ++correction) {
    step_.head(rank_).noalias() =
        factor_.topLeftCorner(rows_, rank_).transpose() * right_.head(rows_);
    substitute(matrix_, rank_, step_);
    substitute(matrix_, rank_, step_);
    target_.head(rows_).noalias() = factor_.topLeftCorner(rows_, rank_) * step_.head(rank_);
    for (const Touching& touching : touching_)
      impulse.segment(4 * touching.contact, touching.rows) -=
          target_.segment(touching.row, touching.rows);
    const double last = size;
    read_velocity(contacts, impulse);
    size = right_.head(rows_).lpNorm<Eigen::Infinity>();
    if (!(size < 0.5 * last)) break;
  }
  return is_within_bounds(contacts, impulse);
}

bool LeastImpulse::find(const ContactLcp& problem, const ContactOperator& contacts,
                        const Eigen::VectorXd& velocity, Eigen::VectorXd& impulse, double none,
                        double accuracy) {
  followed_ = -1;
  if (!classify(contacts, velocity, none)) return false;
  factorise(problem, contacts);
  if (rank_ == rows_) return false;  // the impulses are unique
  for (const Touching& touching : touching_) {
    const auto own = impulse.segment<4>(4 * touching.contact);
    if (touching.mode == Mode::slides)
      target_[touching.row] = own[0] * std::sqrt(1 + touching.friction.squaredNorm());
    else
      target_.segment(touching.row, touching.rows) = own.head(touching.rows);
  }
  const auto apply = [&] {
    target_.head(rows_).noalias() = factor_.topLeftCorner(rows_, rank_) * dual_.head(rank_);
  };
  wanted_.head(rank_).noalias() =
      factor_.topLeftCorner(rows_, rank_).transpose() * target_.head(rows_);
  const double size = wanted_.head(rank_).lpNorm<Eigen::Infinity>();
  if (!(size > 0)) return false;
  constexpr int kMostSteps = 25, kMostHalvings = 12;
  constexpr double kRoundOff = 1e-11;
  // From y = 0, where all cones meet their apex, the first step is that of free impulses.
  dual_.head(rank_).setZero();
  apply();
  project(true);
  double value = gradient(), error = size;
  for (int steps = 0; steps < kMostSteps && error > accuracy * size; ++steps) {
    if (!step()) return false;
    right_.head(rank_) = dual_.head(rank_);
    const double slope = gradient_.head(rank_).dot(step_.head(rank_));
    double fraction = 1, next = value, reached = error;
    for (int halving = 0;; ++halving, fraction *= 0.5) {
      dual_.head(rank_) = right_.head(rank_) + fraction * step_.head(rank_);
      apply();
      project(false);
      next = gradient();
      reached = gradient_.head(rank_).lpNorm<Eigen::Infinity>();
      // Close to the answer the function's decrease is below its rounding, the gradient's is not.
      if (steps == 0 || next <= value + 1e-4 * fraction * slope || reached < 0.5 * error ||
          halving == kMostHalvings)
        break;
    }
    const double last = error;
    error = reached;
    value = next;
    if (steps > 1 && error < kRoundOff * size && error >= 0.5 * last) break;
  }
  if (!(error <= std::max(accuracy, kRoundOff) * size)) return false;
  const bool is_free = std::all_of(
      touching_.begin(), touching_.end(),
      [](const Touching& touching) { return touching.mode != Mode::slides && touching.is_free; });
  if (is_free) followed_ = contacts.contacts();
  for (int i = 0; i < contacts.contacts(); ++i) impulse.segment<4>(4 * i).setZero();
  for (const Touching& touching : touching_) {
    auto own = impulse.segment<4>(4 * touching.contact);
    if (touching.mode == Mode::slides) {
      own[0] = projected_[touching.row] / std::sqrt(1 + touching.friction.squaredNorm());
      own.tail<3>() = own[0] * touching.friction;
    } else {
      own.head(touching.rows) = projected_.segment(touching.row, touching.rows);
    }
  }
  return true;
}

}  // namespace softfinger::internal
