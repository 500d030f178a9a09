#include "softfinger/dynamics/exact/least_impulse.h"

#include <algorithm>
#include <cmath>

#include "softfinger/dynamics/contacts/contact_residual.h"
#include "softfinger/math/wide.h"

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

/// to -= the sum of matrix(pivot, k) times column k of `matrix`, k < columns, in the rows from
/// `begin` on. By four; most are zero.
void subtract_columns(const MatrixXd& matrix, int columns, int pivot, int begin, int end,
                      double* to) {
  const std::ptrdiff_t stride = matrix.outerStride();
  int k = 0;
  for (; k + kFour <= columns; k += kFour) {
    const double* first = &matrix(0, k);
    const double x[] = {first[pivot], first[stride + pivot], first[2 * stride + pivot],
                        first[3 * stride + pivot]};
    if (x[0] == 0 && x[1] == 0 && x[2] == 0 && x[3] == 0) continue;
    for (int row = begin; row < end; ++row)
      to[row] -= x[0] * first[row] + x[1] * first[stride + row] + x[2] * first[2 * stride + row] +
                 x[3] * first[3 * stride + row];
  }
  for (; k < columns; ++k) {
    const double* own = &matrix(0, k);
    const double factor = own[pivot];
    if (factor == 0) continue;
    for (int row = begin; row < end; ++row) to[row] -= factor * own[row];
  }
}

/// Cholesky's decomposition of the lower half in place. False where the matrix is not positive
/// definite.
bool decompose(MatrixXd& matrix, int size) {
  return with_best_instructions([&] {
    for (int p = 0; p < size; ++p) {
      double* own = &matrix(0, p);
      subtract_columns(matrix, p, p, p, size, own);
      if (!(own[p] > 0)) return false;
      const double root = std::sqrt(own[p]), inverse = 1 / root;
      own[p] = root;
      for (int row = p + 1; row < size; ++row) own[row] *= inverse;
    }
    return true;
  });
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
    : number_(std::size_t(contact_capacity)),
      factor_(contact_capacity),
      matrix_(4 * contact_capacity, 4 * contact_capacity),
      original_(4 * contact_capacity),
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
  owner_.reserve(4 * std::size_t(contact_capacity));
  order_.reserve(std::size_t(contact_capacity));
}

/// Finds what each contact does. False if all that touch could not share their impulses anyhow.
bool LeastImpulse::classify(const ContactOperator& contacts, const Eigen::VectorXd& velocity,
                            double none) {
  touching_.clear();
  rows_ = 0;
  for (int i = 0; i < contacts.contacts(); ++i) {
    const double still = none * contacts.natural_size(i);
    number_[std::size_t(i)] = -1;
    if (velocity[4 * i] > still) continue;
    Touching touching{i, Mode::normal, Vector3d::Zero(), {}, rows_, 1, Matrix4d::Zero(), true};
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
    touching.along = contacts.impulse_scale().segment<4>(4 * i);
    if (touching.mode == Mode::slides) {
      touching.along.tail<3>() = touching.along.tail<3>().cwiseProduct(touching.friction);
      touching.along /= std::sqrt(1 + touching.friction.squaredNorm());
    } else if (touching.mode == Mode::normal) {
      touching.along.tail<3>().setZero();
    }
    rows_ += touching.rows;
    number_[std::size_t(i)] = int(touching_.size());
    touching_.push_back(touching);
  }
  return touching_.size() > 1;
}

/// The elements of S W S, in the directions of C, that `one` and `other` share in the column of
/// `other`'s direction `row`.
Vector4d LeastImpulse::shared_elements(const ContactLcp& problem, const Touching& one,
                                       const Touching& other, int row) const {
  const auto block = problem.delassus.block<4, 4>(4 * one.contact, 4 * other.contact);
  const Vector4d elements =
      other.rows == 4 ? Vector4d(one.along.cwiseProduct(block.col(row)) * other.along[row])
                      : Vector4d(one.along.cwiseProduct(block * other.along));
  return one.rows == 4 ? elements : Vector4d(elements.sum(), 0, 0, 0);
}

/// S W S = L L^T in the directions of C. A contact that slides has one, in units of its length.
/// Cholesky's method. Contacts with the fewest neighbours come first, as long as their pivots are
/// large, among their own and among all: so L stays as sparse as the bodies are coupled. Then the
/// largest pivots that are left; small ones before large ones would cost L y its digits.
void LeastImpulse::factorise(const ContactLcp& problem, const ContactOperator& contacts) {
  constexpr double kLarge = 1e-1, kEarly = 1e-4, kNone = 1e-13;
  owner_.clear();
  order_.clear();
  for (int i = 0; i < int(touching_.size()); ++i) {
    const Touching& touching = touching_[std::size_t(i)];
    order_.push_back(i);
    for (int row = 0; row < touching.rows; ++row) {
      diagonal_[touching.row + row] =
          shared_elements(problem, touching, touching, row)[touching.rows == 4 ? row : 0];
      owner_.push_back(i);
    }
  }
  original_.head(rows_) = diagonal_.head(rows_);
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    const auto size = [&](int i) {
      return contacts.neighbours(touching_[std::size_t(i)].contact).size();
    };
    return size(a) < size(b) || (size(a) == size(b) && a < b);
  });
  const double largest = original_.head(rows_).maxCoeff();
  rank_ = 0;
  for (const int i : order_) {
    const Touching& touching = touching_[std::size_t(i)];
    for (;;) {
      int row = 0;
      diagonal_.segment(touching.row, touching.rows).maxCoeff(&row);
      row += touching.row;
      if (!(diagonal_[row] > std::max(kLarge * original_[row], kEarly * largest))) break;
      eliminate(problem, contacts, row);
    }
  }
  for (int row = 0; diagonal_.head(rows_).maxCoeff(&row) > kNone * largest;)
    eliminate(problem, contacts, row);
  factor_.clear();
  for (const Touching& touching : touching_)
    factor_.append(touching.rows, rank_, [&](int k) { return &matrix_(touching.row, k); });
}

/// The next column of L, by the pivot of this row. What is left of S W S below a dozen roundings is
/// zero.
void LeastImpulse::eliminate(const ContactLcp& problem, const ContactOperator& contacts,
                             int pivot) {
  const Touching& own = touching_[std::size_t(owner_[std::size_t(pivot)])];
  auto column = matrix_.col(rank_).head(rows_);
  column.setZero();
  for (const int i : contacts.neighbours(own.contact)) {
    if (number_[std::size_t(i)] < 0) continue;
    const Touching& other = touching_[std::size_t(number_[std::size_t(i)])];
    column.segment(other.row, other.rows) =
        shared_elements(problem, other, own, pivot - own.row).head(other.rows);
  }
  with_best_instructions(
      [&] { subtract_columns(matrix_, rank_, pivot, 0, rows_, &matrix_(0, rank_)); });
  const double root = std::sqrt(diagonal_[pivot]), inverse = 1 / root;
  const double rounding = kRoundingLeft * kRoundingLeft * original_[pivot];
  for (int row = 0; row < rows_; ++row) {
    double& element = column[row];
    if (element == 0) continue;
    if (diagonal_[row] == 0 || element * element <= rounding * original_[row]) {
      element = 0;
      continue;
    }
    element *= inverse;
    diagonal_[row] -= element * element;
  }
  column[pivot] = root;
  diagonal_[pivot] = 0;
  ++rank_;
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

/// y = L x, of the touching contacts' rows.
void LeastImpulse::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  for (int i = 0; i < factor_.contacts(); ++i)
    factor_.multiply(i, x, y.data() + touching_[std::size_t(i)].row);
}

/// x = L^T y
void LeastImpulse::multiply_transposed(const Eigen::VectorXd& y, Eigen::VectorXd& x) const {
  x.head(rank_).setZero();
  for (int i = 0; i < factor_.contacts(); ++i)
    factor_.add_transposed(i, y.data() + touching_[std::size_t(i)].row, x);
}

/// L^T proj_C(L y) - L^T r*; returns the dual function.
double LeastImpulse::gradient() {
  multiply_transposed(projected_, gradient_);
  gradient_.head(rank_) -= wanted_.head(rank_);
  return projected_.head(rows_).squaredNorm() / 2 - wanted_.head(rank_).dot(dual_.head(rank_));
}

/// Newton's step of y: step_.
bool LeastImpulse::step() {
  constexpr double kProximal = 1e-12;  // of the diagonal, which may be singular
  matrix_.topLeftCorner(rank_, rank_).setZero();
  for (int i = 0; i < factor_.contacts(); ++i)
    factor_.add_lower_product(i, touching_[std::size_t(i)].derivative.data(), matrix_);
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
    multiply_transposed(right_, step_);
    substitute(matrix_, rank_, step_);
    substitute(matrix_, rank_, step_);
    multiply(step_, target_);
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
  multiply_transposed(target_, wanted_);
  const double size = wanted_.head(rank_).lpNorm<Eigen::Infinity>();
  if (!(size > 0)) return false;
  constexpr int kMostSteps = 25, kMostHalvings = 12;
  constexpr double kRoundOff = 1e-11;
  // From y = 0, where all cones meet their apex, the first step is that of free impulses.
  dual_.head(rank_).setZero();
  target_.head(rows_).setZero();
  project(true);
  double value = gradient(), error = size;
  for (int steps = 0; steps < kMostSteps && error > accuracy * size; ++steps) {
    if (!step()) return false;
    right_.head(rank_) = dual_.head(rank_);
    const double slope = gradient_.head(rank_).dot(step_.head(rank_));
    double fraction = 1, next = value, reached = error;
    for (int halving = 0;; ++halving, fraction *= 0.5) {
      dual_.head(rank_) = right_.head(rank_) + fraction * step_.head(rank_);
      multiply(dual_, target_);
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
