#include "softfinger/dynamics/exact_newton.h"

#include <Eigen/LU>
#include <cmath>

namespace softfinger::internal {

ExactNewton::ExactNewton(int contacts)
    : contacts_(std::size_t(contacts)),
      first_(std::size_t(contacts)),
      velocity_(4 * contacts),
      map_(4 * contacts),
      trial_(4 * contacts),
      step_(4 * contacts),
      right_(4 * contacts),
      matrix_(4 * contacts, 4 * contacts) {}

/// The natural map, and what its derivative is made of.
double ExactNewton::evaluate(const ContactSystem& system, const Eigen::VectorXd& impulse) {
  system.find_velocity(impulse, velocity_);
  velocity_.head(4 * system.contacts) += system.free_velocity.head(4 * system.contacts);
  double worst = 0;
  for (int i = 0; i < system.contacts; ++i) {
    Contact& contact = contacts_[std::size_t(i)];
    const double pressure = impulse[4 * i];
    const double normal_velocity = velocity_[4 * i];
    contact.touches = pressure > normal_velocity;
    map_[4 * i] = std::min(pressure, normal_velocity);
    map_.segment<3>(4 * i + 1).setZero();
    if (system.has_friction[std::size_t(i)]) {
      const Eigen::Vector3d slip = velocity_.segment<3>(4 * i + 1);
      contact.metric = system.friction_metric(i);
      contact.excess =
          friction_excess(system.shapes[std::size_t(i)],
                          contact.metric.cwiseProduct(impulse.segment<3>(4 * i + 1)) - slip,
                          std::max(pressure, 0.), contact.metric);
      map_.segment<3>(4 * i + 1) = slip + contact.excess.excess;
    }
    worst =
        std::max(worst, map_.segment<4>(4 * i).lpNorm<Eigen::Infinity>() / system.natural_sizes[i]);
  }
  return worst;
}

bool ExactNewton::find_step(const ContactSystem& system, const Eigen::VectorXd& impulse) {
  // Proximal: where W is singular, it becomes this much times the unit matrix.
  constexpr double kProximal = 1e-9;
  const int nc = system.contacts;
  step_.head(4 * nc).setZero();
  int size = 0;
  for (int i = 0; i < nc; ++i) {
    first_[std::size_t(i)] = -1;
    if (contacts_[std::size_t(i)].touches) {
      first_[std::size_t(i)] = size;
      size += system.has_friction[std::size_t(i)] ? 4 : 1;
    } else {
      step_.segment<4>(4 * i) = -impulse.segment<4>(4 * i);
    }
  }
  // What contacts that open do to the others is known.
  system.find_velocity(step_, trial_);
  for (int i = 0; i < nc; ++i) {
    const int row = first_[std::size_t(i)];
    if (row < 0) continue;
    const Contact& contact = contacts_[std::size_t(i)];
    const bool rubs = system.has_friction[std::size_t(i)];
    const int rows = rubs ? 4 : 1;
    // dnu = D (A ds - du - A grad h dP)
    Eigen::Matrix3d sliding = Eigen::Matrix3d::Zero();
    const auto metric = contact.metric.asDiagonal();
    if (rubs && contact.excess.excess.squaredNorm() > 0)
      sliding = (Eigen::Matrix3d::Identity() +
                 std::max(impulse[4 * i], 0.) * (metric * contact.excess.hessian))
                    .inverse();
    const Eigen::Matrix3d sticking = Eigen::Matrix3d::Identity() - sliding;
    matrix_.block(row, 0, rows, size).setZero();
    for (int j = 0; j < nc; ++j) {
      const int column = first_[std::size_t(j)];
      if (column < 0) continue;
      const auto block = system.delassus.block<4, 4>(4 * i, 4 * j);
      if (system.has_friction[std::size_t(j)]) {
        matrix_.block<1, 4>(row, column) = block.row(0);
        if (rubs) matrix_.block<3, 4>(row + 1, column).noalias() = sticking * block.bottomRows<3>();
      } else {
        matrix_(row, column) = block(0, 0);
        if (rubs)
          matrix_.block<3, 1>(row + 1, column).noalias() = sticking * block.block<3, 1>(1, 0);
      }
    }
    matrix_(row, row) += kProximal;
    right_[row] = -map_[4 * i] - trial_[4 * i];
    if (!rubs) continue;
    matrix_.block<3, 3>(row + 1, row + 1) += sliding * metric;
    matrix_.block<3, 3>(row + 1, row + 1).diagonal() += kProximal * contact.metric;
    matrix_.block<3, 1>(row + 1, row) -= sliding * (metric * contact.excess.boundary);
    right_.segment<3>(row + 1) =
        -map_.segment<3>(4 * i + 1) - sticking * trial_.segment<3>(4 * i + 1);
  }
  if (!eliminate(size)) return false;
  for (int i = 0; i < nc; ++i) {
    const int row = first_[std::size_t(i)];
    if (row < 0) continue;
    step_[4 * i] = right_[row];
    if (system.has_friction[std::size_t(i)])
      step_.segment<3>(4 * i + 1) = right_.segment<3>(row + 1);
  }
  return true;
}

/// Gauss' elimination with row pivoting, in place: matrix_ x = right_, x in right_.
bool ExactNewton::eliminate(int size) {
  for (int p = 0; p < size; ++p) {
    int best = p;
    for (int row = p + 1; row < size; ++row)
      if (std::abs(matrix_(row, p)) > std::abs(matrix_(best, p))) best = row;
    const double pivot = matrix_(best, p);
    if (!(std::abs(pivot) > 0)) return false;
    if (best != p) {
      matrix_.row(best).segment(p, size - p).swap(matrix_.row(p).segment(p, size - p));
      std::swap(right_[best], right_[p]);
    }
    auto multipliers = matrix_.col(p).segment(p + 1, size - p - 1);
    multipliers /= pivot;
    for (int column = p + 1; column < size; ++column) {
      const double factor = matrix_(p, column);
      if (factor != 0)
        matrix_.col(column).segment(p + 1, size - p - 1).noalias() -= factor * multipliers;
    }
    if (right_[p] != 0) right_.segment(p + 1, size - p - 1).noalias() -= right_[p] * multipliers;
  }
  for (int p = size - 1; p >= 0; --p) {
    right_[p] /= matrix_(p, p);
    if (right_[p] != 0) right_.head(p).noalias() -= right_[p] * matrix_.col(p).head(p);
  }
  return right_.head(size).allFinite();
}

double ExactNewton::solve(const ContactSystem& system, Eigen::VectorXd& impulse) {
  constexpr int kMostIterations = 20, kMostHalvings = 6;
  constexpr double kConverged = 1e-15;
  const int n = 4 * system.contacts;
  double residual = evaluate(system, impulse);
  for (iterations_ = 0; iterations_ < kMostIterations && residual > kConverged; ++iterations_) {
    if (!find_step(system, impulse)) break;
    double fraction = 1, next = residual;
    const auto old = right_.head(n);
    right_.head(n) = impulse.head(n);
    for (int halving = 0; halving <= kMostHalvings; ++halving, fraction *= 0.5) {
      impulse.head(n) = old + fraction * step_.head(n);
      next = evaluate(system, impulse);
      if (next < residual) break;
    }
    if (!(next < residual)) {
      impulse.head(n) = old;
      evaluate(system, impulse);
      break;
    }
    residual = next;
  }
  return residual;
}

}  // namespace softfinger::internal
