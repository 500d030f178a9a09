#include "softfinger/dynamics/exact/exact_newton.h"

#include <Eigen/LU>
#include <cmath>
#include <iterator>
#include <limits>

#include "softfinger/dynamics/contacts/contact_residual.h"
#include "softfinger/friction/friction_shape.h"

namespace softfinger::internal {
namespace {

/// Number of unknowns from which on the step may be solved for the bodies' velocities instead.
constexpr int kFewUnknowns = 24;
/// Common velocities that cost as much as one unknown when no rows are exchanged.
constexpr int kSparser = 2;

}  // namespace

ExactNewton::ExactNewton(int contact_capacity)
    : contacts_(std::size_t(contact_capacity)),
      first_(std::size_t(contact_capacity)),
      factor_(contact_capacity),
      velocity_(4 * contact_capacity),
      map_(4 * contact_capacity),
      trial_(4 * contact_capacity),
      step_(4 * contact_capacity),
      right_(4 * contact_capacity),
      start_(4 * contact_capacity),
      point_(4 * contact_capacity),
      common_(4 * contact_capacity),
      centre_(4 * contact_capacity),
      reached_(4 * contact_capacity),
      move_(4 * contact_capacity),
      elimination_(4 * contact_capacity),
      pattern_elimination_(4 * contact_capacity) {}

double ExactNewton::evaluate(const ContactOperator& contacts, const Eigen::VectorXd& impulse) {
  contacts.find_velocity(impulse, velocity_);
  return find_map(contacts, impulse);
}

/// F at `impulse`, whose W r is velocity_: map_, and in contacts_ what its derivative is made of.
/// Returns its size.
double ExactNewton::find_map(const ContactOperator& contacts, const Eigen::VectorXd& impulse) {
  double worst = 0;
  for (int i = 0; i < contacts.contacts(); ++i)
    worst = std::max(worst, find_own_map(contacts, impulse, i));
  return worst;
}

/// The part of F that belongs to one contact. Returns its size.
double ExactNewton::find_own_map(const ContactOperator& contacts, const Eigen::VectorXd& impulse,
                                 int i) {
  Contact& contact = contacts_[std::size_t(i)];
  const Eigen::Vector4d own = impulse.segment<4>(4 * i);
  Eigen::Vector4d velocity =
      velocity_.segment<4>(4 * i) + contacts.free_velocity().segment<4>(4 * i);
  const Eigen::Vector3d metric = contacts.friction_metric(i);
  if (compliance_ > 0) {
    const Eigen::Vector4d shift = compliance_ * (own - centre_.segment<4>(4 * i));
    velocity[0] += shift[0];
    velocity.tail<3>() += metric.cwiseProduct(shift.tail<3>());
  }
  const double pressure = own[0];
  contact.touches = pressure > velocity[0];
  Eigen::Vector4d map(std::min(pressure, velocity[0]), 0, 0, 0);
  double size = std::abs(map[0]);
  if (contacts.has_friction(i)) {
    const double limit = std::max(pressure, 0.);
    const Eigen::Vector3d target = metric.cwiseProduct(own.tail<3>()) - velocity.tail<3>();
    // All of it is beyond the limit of a contact that is open, and no step asks for more.
    FrictionExcess excess;
    if (limit > 0 || contact.touches)
      excess = friction_excess(contacts.shape(i), target, limit, metric);
    else
      excess.excess = target;
    contact.slides = excess.excess.squaredNorm() > 0;
    if (contact.slides) contact.boundary_and_hessian << excess.boundary, excess.hessian;
    map.tail<3>() = velocity.tail<3>() + excess.excess;
    // F contains the error of the wrench times A. Along an axis with a small element of A such an
    // error would hardly show. The weights (P + |nu|/A)/(P + |nu|/max A) raise it to what F would
    // be if all elements of A were as large as the largest one.
    const double length = excess.excess.norm();
    Eigen::Array3d weighted = map.tail<3>().array().abs();
    if (length > 0) {
      const Eigen::Array3d inverse = metric.array().inverse();
      weighted *= (limit + length * inverse) * (1 / (limit + length * inverse.minCoeff()));
    }
    size = std::max(size, weighted.maxCoeff());
  }
  map_.segment<4>(4 * i) = map;
  return size / contacts.natural_size(i);
}

/// The step that makes the linearised map zero: step_. False where there is none.
bool ExactNewton::find_step(const ContactOperator& contacts, const Eigen::VectorXd& impulse,
                            double proximal) {
  const int size = number_unknowns(contacts, impulse);
  // Contacts that open lose their impulse. This part of the step is known, and with it the change
  // of the other contacts' velocities.
  contacts.find_velocity(step_, trial_);
  const int most_common = compliance_ > 0 ? kSparser * size : size;
  const bool is_reduced = size >= kFewUnknowns && factor(contacts).rank() < most_common;
  decomposition_ = is_reduced ? factorise_reduced(contacts, impulse, proximal, size)
                              : factorise(contacts, impulse, proximal, size);
  if (decomposition_ == Decomposition::none) return false;
  factored_contacts_ = contacts.contacts();
  for (int i = 0; i < contacts.contacts(); ++i) {
    const int row = first_[std::size_t(i)];
    if (row < 0) continue;
    right_[row] = -map_[4 * i] - trial_[4 * i];
    if (contacts.has_friction(i))
      right_.segment<3>(row + 1) =
          -map_.segment<3>(4 * i + 1) -
          contacts_[std::size_t(i)].sticking * trial_.segment<3>(4 * i + 1);
  }
  substitute_all(contacts);
  if (!right_.head(size).allFinite()) return false;
  for (int i = 0; i < contacts.contacts(); ++i) {
    const int row = first_[std::size_t(i)];
    if (row < 0) continue;
    step_[4 * i] = right_[row];
    if (contacts.has_friction(i)) step_.segment<3>(4 * i + 1) = right_.segment<3>(row + 1);
  }
  return true;
}

const VelocityFactor& ExactNewton::factor(const ContactOperator& contacts) {
  if (!factor_.is_known()) {
    factor_.factorise(contacts);
    pattern_elimination_.set(factor_.pattern());
    if (decomposition_ != Decomposition::of_impulses) decomposition_ = Decomposition::none;
  }
  return factor_;
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

/// du = W ds and, where the contact slides, dnu = D (A ds - du - A grad h dP),
/// D = (1 + P A hess h)^-1: returns D; zero where it sticks.
Eigen::Matrix3d ExactNewton::sliding_part(const Contact& contact, const Eigen::Vector3d& metric,
                                          double pressure) const {
  if (!contact.slides) return Eigen::Matrix3d::Zero();
  return (Eigen::Matrix3d::Identity() +
          std::max(pressure, 0.) * (metric.asDiagonal() * contact.hessian()))
      .inverse();
}

/// The matrix of the touching contacts' impulses, and its decomposition.
ExactNewton::Decomposition ExactNewton::factorise(const ContactOperator& contacts,
                                                  const Eigen::VectorXd& impulse, double proximal,
                                                  int size) {
  DenseElimination::Matrix matrix = elimination_.zeros(size);
  for (int i = 0; i < contacts.contacts(); ++i)
    if (first_[std::size_t(i)] >= 0) assemble_rows(contacts, i, impulse, proximal, matrix);
  return elimination_.factorise() ? Decomposition::of_impulses : Decomposition::none;
}

/// The step's matrix in the velocities that the contacts have in common. If contacts give way,
/// pivots are rarely small, and proximal points need no exact steps. Near a solution they are what
/// the last digits depend on.
ExactNewton::Decomposition ExactNewton::factorise_reduced(const ContactOperator& contacts,
                                                          const Eigen::VectorXd& impulse,
                                                          double proximal, int size) {
  for (int i = 0; i < contacts.contacts(); ++i)
    if (first_[std::size_t(i)] >= 0) find_inverse(contacts, i, impulse[4 * i], proximal);
  if (compliance_ > 0) {
    assemble_reduced(pattern_elimination_.identity());
    if (pattern_elimination_.factorise()) return Decomposition::of_velocities;
  }
  if (factor_.rank() >= size) return factorise(contacts, impulse, proximal, size);
  DenseElimination::Matrix matrix = elimination_.zeros(factor_.rank());
  matrix.diagonal().setOnes();
  assemble_reduced(matrix);
  return elimination_.factorise() ? Decomposition::of_velocities_exchanged : Decomposition::none;
}

/// A_i^-1, B_i C_i, and the one times the other, of a contact that touches.
void ExactNewton::find_inverse(const ContactOperator& contacts, int i, double pressure,
                               double proximal) {
  Contact& contact = contacts_[std::size_t(i)];
  contact.own_inverse.setZero();
  contact.from_velocity.setZero();
  contact.own_inverse(0, 0) = 1 / (compliance_ + proximal);
  contact.from_velocity(0, 0) = 1;
  contact.stiffness = contact.own_inverse;
  if (!contacts.has_friction(i)) return;
  const auto metric = contacts.friction_metric(i).asDiagonal();
  const Eigen::Matrix3d sliding = sliding_part(contact, contacts.friction_metric(i), pressure);
  contact.sticking = Eigen::Matrix3d::Identity() - sliding;
  Eigen::Matrix3d own = sliding * metric + compliance_ * (contact.sticking * metric);
  own.diagonal() += proximal * contacts.friction_metric(i);
  const Eigen::Matrix3d inverse = own.inverse();
  contact.own_inverse.bottomRightCorner<3, 3>() = inverse;
  contact.own_inverse.block<3, 1>(1, 0) =
      inverse * (sliding * (metric * contact.boundary())) / (compliance_ + proximal);
  contact.from_velocity.bottomRightCorner<3, 3>() =
      contact.sticking * factor_.unit(i).tail<3>().asDiagonal();
  contact.stiffness = contact.own_inverse * contact.from_velocity;
}

/// Adds sum L_i^T A_i^-1 B_i C_i L_i.
void ExactNewton::assemble_reduced(Eigen::Ref<Eigen::MatrixXd> matrix) const {
  for (int i = 0; i < factor_.rows().contacts(); ++i) {
    if (first_[std::size_t(i)] < 0) continue;
    factor_.rows().add_product(i, contacts_[std::size_t(i)].stiffness.data(), matrix);
  }
}

/// The step whose change of F is right_, by contacts that touch, from the last decomposition; in
/// its place.
void ExactNewton::substitute_all(const ContactOperator& contacts) {
  if (decomposition_ == Decomposition::of_impulses) {
    elimination_.substitute(right_);
    return;
  }
  const auto read = [&](int i) {
    Eigen::Vector4d own = Eigen::Vector4d::Zero();
    const int row = first_[std::size_t(i)];
    if (contacts.has_friction(i))
      own = right_.segment<4>(row);
    else
      own[0] = right_[row];
    return own;
  };
  common_.head(factor_.rank()).setZero();
  for (int i = 0; i < contacts.contacts(); ++i) {
    if (first_[std::size_t(i)] < 0) continue;
    const Eigen::Vector4d own = contacts_[std::size_t(i)].own_inverse * read(i);
    factor_.rows().add_transposed(i, own.data(), common_);
  }
  if (decomposition_ == Decomposition::of_velocities)
    pattern_elimination_.substitute(common_);
  else
    elimination_.substitute(common_);
  for (int i = 0; i < contacts.contacts(); ++i) {
    const int row = first_[std::size_t(i)];
    if (row < 0) continue;
    const Contact& contact = contacts_[std::size_t(i)];
    Eigen::Vector4d common;
    factor_.rows().multiply(i, common_, common.data());
    const Eigen::Vector4d change = contact.own_inverse * (read(i) - contact.from_velocity * common);
    if (contacts.has_friction(i))
      right_.segment<4>(row) = change;
    else
      right_[row] = change[0];
  }
}

/// Rows of a contact that touches, where they are not zero: dF = -F.
void ExactNewton::assemble_rows(const ContactOperator& contacts, int i,
                                const Eigen::VectorXd& impulse, double proximal,
                                DenseElimination::Matrix& matrix) {
  const int row = first_[std::size_t(i)];
  Contact& contact = contacts_[std::size_t(i)];
  const bool rubs = contacts.has_friction(i);
  const auto metric = contacts.friction_metric(i).asDiagonal();
  Eigen::Matrix3d sliding = Eigen::Matrix3d::Zero();
  if (rubs) sliding = sliding_part(contact, contacts.friction_metric(i), impulse[4 * i]);
  contact.sticking = Eigen::Matrix3d::Identity() - sliding;
  for (const int j : contacts.neighbours(i)) {
    const int column = first_[std::size_t(j)];
    if (column < 0) continue;
    const auto block = contacts.delassus().block<4, 4>(4 * i, 4 * j);
    if (contacts.has_friction(j)) {
      matrix.block<1, 4>(row, column) = block.row(0);
      if (rubs)
        matrix.block<3, 4>(row + 1, column).noalias() = contact.sticking * block.bottomRows<3>();
    } else {
      matrix(row, column) = block(0, 0);
      if (rubs)
        matrix.block<3, 1>(row + 1, column).noalias() = contact.sticking * block.block<3, 1>(1, 0);
    }
  }
  matrix(row, row) += compliance_ + proximal;
  if (!rubs) return;
  matrix.block<3, 3>(row + 1, row + 1) +=
      sliding * metric + compliance_ * (contact.sticking * metric);
  matrix.block<3, 3>(row + 1, row + 1).diagonal() += proximal * contacts.friction_metric(i);
  matrix.block<3, 1>(row + 1, row) -= sliding * (metric * contact.boundary());
}

bool ExactNewton::correct(const ContactOperator& contacts, Eigen::VectorXd& impulse) {
  constexpr int kMostCorrections = 6;
  constexpr double kRoundOff = 1e-14, kSlow = 0.1;
  const int nc = contacts.contacts(), n = 4 * nc;
  iterations_ = 0;
  if (decomposition_ == Decomposition::none || factored_contacts_ != nc) return false;
  double residual = evaluate(contacts, impulse);
  bool slides = false;
  for (int i = 0; i < nc; ++i) {
    const Contact& contact = contacts_[std::size_t(i)];
    if (contact.touches != (first_[std::size_t(i)] >= 0)) return false;
    slides = slides || (contact.touches && contacts.has_friction(i) && contact.slides);
  }
  while (iterations_ < kMostCorrections && residual > kRoundOff) {
    for (int i = 0; i < nc; ++i) {
      const int row = first_[std::size_t(i)];
      if (row < 0) continue;
      right_[row] = -map_[4 * i];
      if (contacts.has_friction(i)) right_.segment<3>(row + 1) = -map_.segment<3>(4 * i + 1);
    }
    substitute_all(contacts);
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

double ExactNewton::approach(const ContactOperator& contacts, Eigen::VectorXd& impulse,
                             int most_iterations, ProximalCourse::Start start) {
  const int n = 4 * contacts.contacts();
  centre_.head(n) = point_.head(n) = reached_.head(n) = impulse.head(n);
  move_.head(n).setZero();
  compliance_ = 0;
  ProximalCourse course;
  course.begin(evaluate(contacts, point_), start);
  while (course.goes_on(most_iterations)) {
    compliance_ = course.compliance;
    const bool has_reached = take_steps(contacts, course);
    if (has_reached)
      course.reach(move_on(n));
    else
      course.fail();
    centre_.head(n) = point_.head(n) = reached_.head(n);
    // If the point is reached, W r is that of the last step.
    const double size = has_reached ? find_map(contacts, centre_) : evaluate(contacts, centre_);
    if (course.arrive(size)) impulse.head(n) = centre_.head(n);
    if (course.stride == 1) continue;
    centre_.head(n) += (course.stride - 1) * move_.head(n);
    point_.head(n) = centre_.head(n);
    course.residual = evaluate(contacts, centre_);
  }
  iterations_ = course.iterations;
  compliance_ = 0;
  return course.best;
}

/// Newton's steps from point_ to the next proximal point. False where they do not reach it.
bool ExactNewton::take_steps(const ContactOperator& contacts, ProximalCourse& course) {
  const int n = 4 * contacts.contacts();
  for (;;) {
    double size = std::numeric_limits<double>::infinity();
    if (find_step(contacts, point_, 0)) {
      point_.head(n) += step_.head(n);
      size = evaluate(contacts, point_);
    }
    const ProximalCourse::Progress progress = course.take_step(size);
    if (progress != ProximalCourse::Progress::going)
      return progress == ProximalCourse::Progress::reached;
  }
}

/// Takes point_ as reached. Returns the cosine between this move and the last one.
double ExactNewton::move_on(int size) {
  step_.head(size) = point_.head(size) - reached_.head(size);
  const double lengths = step_.head(size).norm() * move_.head(size).norm();
  const double cosine = lengths > 0 ? step_.head(size).dot(move_.head(size)) / lengths : 0;
  move_.head(size) = step_.head(size);
  reached_.head(size) = point_.head(size);
  return cosine;
}

}  // namespace softfinger::internal
