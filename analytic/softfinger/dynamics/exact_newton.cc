#include "softfinger/dynamics/exact_newton.h"

#include <Eigen/LU>
#include <cmath>
#include <iterator>

#include "softfinger/dynamics/contact_residual.h"

namespace softfinger::internal {

ExactNewton::ExactNewton(int contact_capacity)
    : contacts_(std::size_t(contact_capacity)),
      first_(std::size_t(contact_capacity)),
      velocity_(4 * contact_capacity),
      map_(4 * contact_capacity),
      trial_(4 * contact_capacity),
      step_(4 * contact_capacity),
      right_(4 * contact_capacity),
      start_(4 * contact_capacity),
      point_(4 * contact_capacity),
      matrix_(4 * contact_capacity, 4 * contact_capacity),
      pivots_(std::size_t(4 * contact_capacity)) {}

/// F at `impulse`: map_, and in contacts_ what its derivative is made of. Returns its size.
double ExactNewton::evaluate(const ContactOperator& contacts, const Eigen::VectorXd& impulse) {
  contacts.find_velocity(impulse, velocity_);
  velocity_.head(4 * contacts.contacts()) += contacts.free_velocity().head(4 * contacts.contacts());
  double worst = 0;
  for (int i = 0; i < contacts.contacts(); ++i) {
    Contact& contact = contacts_[std::size_t(i)];
    const double pressure = impulse[4 * i];
    const double normal_velocity = velocity_[4 * i];
    contact.touches = pressure > normal_velocity;
    map_[4 * i] = std::min(pressure, normal_velocity);
    map_.segment<3>(4 * i + 1).setZero();
    if (contacts.has_friction(i)) {
      const Eigen::Vector3d slip = velocity_.segment<3>(4 * i + 1);
      const double limit = std::max(pressure, 0.);
      contact.metric = contacts.friction_metric(i);
      contact.excess = friction_excess(
          contacts.shape(i), contact.metric.cwiseProduct(impulse.segment<3>(4 * i + 1)) - slip,
          limit, contact.metric);
      const Eigen::Vector3d map = slip + contact.excess.excess;
      map_.segment<3>(4 * i + 1) = map;
      // F contains the error of the wrench times A. Along an axis with a small element of A such an
      // error would hardly show. The weights raise it to what F would be if all elements of A were
      // as large as the largest one.
      const double length = contact.excess.excess.norm(), largest = contact.metric.maxCoeff();
      Eigen::Array3d weight = Eigen::Array3d::Ones();
      if (length > 0)
        weight = (limit + length / contact.metric.array()) / (limit + length / largest);
      worst = std::max(worst, (weight * map.array()).abs().maxCoeff() / contacts.natural_size(i));
    }
    worst = std::max(worst, std::abs(map_[4 * i]) / contacts.natural_size(i));
  }
  return worst;
}

/// The step that makes the linearised map zero: step_. False where there is none.
bool ExactNewton::find_step(const ContactOperator& contacts, const Eigen::VectorXd& impulse,
                            double proximal) {
  const int size = number_unknowns(contacts, impulse);
  // Contacts that open lose their impulse. This part of the step is known, and with it the change
  // of the other contacts' velocities.
  contacts.find_velocity(step_, trial_);
  for (int i = 0; i < contacts.contacts(); ++i)
    if (first_[std::size_t(i)] >= 0) assemble_rows(contacts, i, impulse, proximal, size);
  if (!eliminate(size)) return false;
  factored_contacts_ = contacts.contacts();
  for (int i = 0; i < contacts.contacts(); ++i) {
    const int row = first_[std::size_t(i)];
    if (row < 0) continue;
    step_[4 * i] = right_[row];
    if (contacts.has_friction(i)) step_.segment<3>(4 * i + 1) = right_.segment<3>(row + 1);
  }
  return true;
}

/// Contacts that touch have one unknown, or four with friction. Those that do not lose their
/// impulse, which is their step. Returns the number of unknowns.
int ExactNewton::number_unknowns(const ContactOperator& contacts, const Eigen::VectorXd& impulse) {
  const int nc = contacts.contacts();
  step_.head(4 * nc).setZero();
  int size = 0;
  for (int i = 0; i < nc; ++i) {
    first_[std::size_t(i)] = -1;
    if (contacts_[std::size_t(i)].touches) {
      first_[std::size_t(i)] = size;
      size += contacts.has_friction(i) ? 4 : 1;
    } else {
      step_.segment<4>(4 * i) = -impulse.segment<4>(4 * i);
    }
  }
  return size;
}

/// Rows of a contact that touches: dF = -F, with du = W ds and, where it slides,
/// dnu = D (A ds - du - A grad h dP), D = (1 + P A hess h)^-1; D = 0 where it sticks.
void ExactNewton::assemble_rows(const ContactOperator& contacts, int i,
                                const Eigen::VectorXd& impulse, double proximal, int size) {
  const int row = first_[std::size_t(i)];
  const Contact& contact = contacts_[std::size_t(i)];
  const bool rubs = contacts.has_friction(i);
  const auto metric = contact.metric.asDiagonal();
  Eigen::Matrix3d sliding = Eigen::Matrix3d::Zero();
  if (rubs && contact.excess.excess.squaredNorm() > 0)
    sliding = (Eigen::Matrix3d::Identity() +
               std::max(impulse[4 * i], 0.) * (metric * contact.excess.hessian))
                  .inverse();
  const Eigen::Matrix3d sticking = Eigen::Matrix3d::Identity() - sliding;
  matrix_.block(row, 0, rubs ? 4 : 1, size).setZero();
  for (int j = 0; j < contacts.contacts(); ++j) {
    const int column = first_[std::size_t(j)];
    if (column < 0) continue;
    const auto block = contacts.delassus().block<4, 4>(4 * i, 4 * j);
    if (contacts.has_friction(j)) {
      matrix_.block<1, 4>(row, column) = block.row(0);
      if (rubs) matrix_.block<3, 4>(row + 1, column).noalias() = sticking * block.bottomRows<3>();
    } else {
      matrix_(row, column) = block(0, 0);
      if (rubs) matrix_.block<3, 1>(row + 1, column).noalias() = sticking * block.block<3, 1>(1, 0);
    }
  }
  matrix_(row, row) += proximal;
  right_[row] = -map_[4 * i] - trial_[4 * i];
  if (!rubs) return;
  matrix_.block<3, 3>(row + 1, row + 1) += sliding * metric;
  matrix_.block<3, 3>(row + 1, row + 1).diagonal() += proximal * contact.metric;
  matrix_.block<3, 1>(row + 1, row) -= sliding * (metric * contact.excess.boundary);
  right_.segment<3>(row + 1) =
      -map_.segment<3>(4 * i + 1) - sticking * trial_.segment<3>(4 * i + 1);
}

/// matrix_ x = right_ by Gauss' elimination with row pivoting, in place; x in right_.
///
/// Not Eigen::PartialPivLU: it allocates in every call, two vectors of permutations, and buffers of
/// its products from 400 unknowns on, which a step of a simulator must not. Up to 20 unknowns it
/// takes 1.2 to 1.8 times as long as this, at 40 the same, at 80 and 400 0.6 and 0.34 times.
bool ExactNewton::eliminate(int size) {
  factored_ = 0;
  for (int p = 0; p < size; ++p) {
    int best = p;
    for (int row = p + 1; row < size; ++row)
      if (std::abs(matrix_(row, p)) > std::abs(matrix_(best, p))) best = row;
    const double pivot = matrix_(best, p);
    if (!(std::abs(pivot) > 0)) return false;
    pivots_[std::size_t(p)] = best;
    if (best != p) matrix_.row(best).segment(p, size - p).swap(matrix_.row(p).segment(p, size - p));
    // Of contacts in the order of their bodies only near ones feel each other: the rest is zero.
    int last = size - 1;
    while (last > p && matrix_(last, p) == 0) --last;
    auto multipliers = matrix_.col(p).segment(p + 1, last - p);
    multipliers /= pivot;
    for (int column = p + 1; column < size; ++column) {
      const double factor = matrix_(p, column);
      if (factor != 0)
        matrix_.col(column).segment(p + 1, last - p).noalias() -= factor * multipliers;
    }
  }
  factored_ = size;
  substitute(size);
  return right_.head(size).allFinite();
}

/// The solution by the decomposition in matrix_.
void ExactNewton::substitute(int size) {
  for (int p = 0; p < size; ++p) {
    std::swap(right_[pivots_[std::size_t(p)]], right_[p]);
    if (right_[p] != 0)
      right_.segment(p + 1, size - p - 1).noalias() -=
          right_[p] * matrix_.col(p).segment(p + 1, size - p - 1);
  }
  for (int p = size - 1; p >= 0; --p) {
    right_[p] /= matrix_(p, p);
    if (right_[p] != 0) right_.head(p).noalias() -= right_[p] * matrix_.col(p).head(p);
  }
}

bool ExactNewton::correct(const ContactOperator& contacts, Eigen::VectorXd& impulse) {
  constexpr int kMostCorrections = 6;
  constexpr double kRoundOff = 1e-14, kSlow = 0.1;
  const int nc = contacts.contacts(), n = 4 * nc;
  iterations_ = 0;
  if (factored_ == 0 || factored_contacts_ != nc) return false;
  double residual = evaluate(contacts, impulse);
  bool slides = false;
  for (int i = 0; i < nc; ++i) {
    const Contact& contact = contacts_[std::size_t(i)];
    if (contact.touches != (first_[std::size_t(i)] >= 0)) return false;
    slides = slides || (contact.touches && contacts.has_friction(i) &&
                        contact.excess.excess.squaredNorm() > 0);
  }
  while (iterations_ < kMostCorrections && residual > kRoundOff) {
    for (int i = 0; i < nc; ++i) {
      const int row = first_[std::size_t(i)];
      if (row < 0) continue;
      right_[row] = -map_[4 * i];
      if (contacts.has_friction(i)) right_.segment<3>(row + 1) = -map_.segment<3>(4 * i + 1);
    }
    substitute(factored_);
    point_.head(n) = impulse.head(n);
    for (int i = 0; i < nc; ++i) {
      const int row = first_[std::size_t(i)];
      if (row < 0) continue;
      impulse[4 * i] += right_[row];
      if (contacts.has_friction(i)) impulse.segment<3>(4 * i + 1) += right_.segment<3>(row + 1);
    }
    ++iterations_;
    const double next = evaluate(contacts, impulse);
    if (!(next < residual)) {
      impulse.head(n) = point_.head(n);
      break;
    }
    const bool slow = next > kSlow * residual;
    residual = next;
    if (slow) break;
  }
  return residual <= (slides ? kRoundOff : kGood);
}

/// Newton's iteration from `start_`. A step is halved until |F| decreases; in a pass with
/// `full_steps` it is always taken in full. Keeps the best point in `impulse`; returns its |F|.
double ExactNewton::descend(const ContactOperator& contacts, const Pass& pass, double best,
                            Eigen::VectorXd& impulse) {
  // A pass that converges, quadratically, takes fewer iterations. That between contacts which are
  // nearly the same is linear: it goes on while it halves |F| within as many.
  constexpr int kMostIterations = 400;
  constexpr int kMostHalvings = 6;      // to 1/64 of a step
  constexpr double kConverged = 1e-15;  // a few roundings
  const int n = 4 * contacts.contacts();
  point_.head(n) = start_.head(n);
  double residual = evaluate(contacts, point_);
  double halved = residual;
  int last_halved = 0;
  for (int iteration = 0; iteration < kMostIterations && residual > kConverged; ++iteration) {
    if (residual < halved / 2) {
      halved = residual;
      last_halved = iteration;
    }
    if (iteration >= last_halved + patience_) break;
    if (!find_step(contacts, point_, pass.proximal)) break;
    ++iterations_;
    right_.head(n) = point_.head(n);
    double fraction = 1, next = residual;
    for (int halving = 0; halving <= kMostHalvings; ++halving, fraction *= 0.5) {
      point_.head(n) = right_.head(n) + fraction * step_.head(n);
      next = evaluate(contacts, point_);
      if (next < residual || pass.full_steps) break;
    }
    if (!(next < residual) && !pass.full_steps) break;
    residual = next;
    if (residual >= best) continue;
    best = residual;
    impulse.head(n) = point_.head(n);
  }
  return best;
}

double ExactNewton::solve(const ContactOperator& contacts, Eigen::VectorXd& impulse, int passes,
                          int patience) {
  patience_ = patience;
  // Each proximal term is tried twice, with halved steps and with full ones, because a descent of
  // |F| can stop at a kink of F that full steps jump over. Larger proximal terms bound the impulses
  // of nearly redundant contacts, which otherwise grow without limit.
  constexpr double kProximals[] = {1e-10, 1e-8, 1e-6, 1e-4};
  static_assert(2 * std::size(kProximals) == kMostPasses);
  const int n = 4 * contacts.contacts();
  start_.head(n) = impulse.head(n);
  iterations_ = 0;
  double best = evaluate(contacts, impulse);
  for (int pass = 0; pass < passes && best > kGood; ++pass)
    best = descend(contacts, {kProximals[pass / 2], pass % 2 == 1}, best, impulse);
  return best;
}

}  // namespace softfinger::internal
