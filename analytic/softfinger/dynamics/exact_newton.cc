#include "softfinger/dynamics/exact_newton.h"

#include <Eigen/LU>
#include <cmath>
#include <iterator>
#include <limits>

#include "softfinger/dynamics/contact_residual.h"
#include "softfinger/friction/ball_excess.h"
#include "softfinger/friction/friction_shape.h"
#include "softfinger/math/repeat.h"
#include "softfinger/math/wide.h"

namespace softfinger::internal {
namespace {

/// From that many unknowns on the step may be solved in fewer ones.
constexpr int kFewUnknowns = 24;
/// Common velocities that cost as much as one unknown when no rows are exchanged.
constexpr int kSparser = 2;

/// Rows of four contacts from their columns, and back.
inline void load_columns(const double* const (&from)[kFour], Four& a, Four& b, Four& c, Four& d) {
  load(from[0], a);
  load(from[1], b);
  load(from[2], c);
  load(from[3], d);
  transpose(a, b, c, d);
}
inline void store_columns(const Four& a, const Four& b, const Four& c, const Four& d,
                          double* const (&to)[kFour]) {
  Four columns[kFour] = {a, b, c, d};
  transpose(columns[0], columns[1], columns[2], columns[3]);
  repeat<kFour>([&](int i) { store(columns[i], to[i]); });
}

/// A matrix times a vector. Eigen adds the last row's products from behind: so do these, and the
/// bits agree.
inline void multiply(const Four (&matrix)[3][3], const Four (&vector)[3], Four (&product)[3]) {
  for (int i = 0; i < 3; ++i) {
    const Four first = matrix[i][0] * vector[0], second = matrix[i][1] * vector[1],
               last = matrix[i][2] * vector[2];
    product[i] = i < 2 ? (first + second) + last : first + (second + last);
  }
}

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
  const int nc = contacts.contacts();
  double worst = 0;
  for (int next = 0; next < nc;) {
    const int first = nc < kFour ? next : std::min(next, nc - kFour);
    const int count = std::min(kFour, nc - first);
    if (count < kFour || !find_four_maps(contacts, impulse, first, worst))
      for (int i = first; i < first + count; ++i)
        worst = std::max(worst, find_own_map(contacts, impulse, i));
    next = first + count;
  }
  return worst;
}

/// That of one contact. Returns its size.
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

/// The same bits for four contacts from `first` on at once, and the largest of `worst` and their
/// sizes. False where friction is not the ball's, or leaves the range of doubles.
bool ExactNewton::find_four_maps(const ContactOperator& contacts, const Eigen::VectorXd& impulse,
                                 int first, double& worst) {
  for (int i = first; i < first + kFour; ++i)
    if (contacts.has_friction(i) && contacts.shape(i)) return false;
  return with_best_instructions([&] {
    const auto load_rows = [first](const Eigen::VectorXd& given, Four(&rows)[4]) {
      const double* own = given.data() + 4 * first;
      load_columns({own, own + 4, own + 8, own + 12}, rows[0], rows[1], rows[2], rows[3]);
    };
    const Four none = {};
    Four own[4], velocity[4], other[4], metric[3], natural_size;
    FourConditions rubs;
    load_rows(impulse, own);
    load_rows(velocity_, velocity);
    load_rows(contacts.free_velocity(), other);
    for (int row = 0; row < 4; ++row) velocity[row] = velocity[row] + other[row];
    for (int i = 0; i < kFour; ++i) {
      const double* given = contacts.friction_metric(first + i).data();
      for (int k = 0; k < 3; ++k) metric[k][i] = given[k];
      natural_size[i] = contacts.natural_size(first + i);
      rubs[i] = contacts.has_friction(first + i) ? -1 : 0;
    }
    if (compliance_ > 0) {
      load_rows(centre_, other);
      velocity[0] = velocity[0] + compliance_ * (own[0] - other[0]);
      for (int k = 0; k < 3; ++k)
        velocity[k + 1] = velocity[k + 1] + metric[k] * (compliance_ * (own[k + 1] - other[k + 1]));
    }
    const Four& pressure = own[0];
    const FourConditions touches = pressure > velocity[0];
    const Four limit = pressure < 0 ? none : pressure;
    Four map[4], target[3], excess[3];
    map[0] = velocity[0] < pressure ? velocity[0] : pressure;
    for (int k = 0; k < 3; ++k) target[k] = metric[k] * own[k + 1] - velocity[k + 1];
    const FourConditions is_asked = rubs & ((limit > 0) | touches);
    for (int k = 0; k < 3; ++k) excess[k] = is_asked ? target[k] : none;
    BallExcesses ball;
    if (!find_excesses(excess, limit, metric, ball)) return false;
    for (int k = 0; k < 3; ++k) {
      excess[k] = is_asked ? ball.length * ball.boundary[k] : target[k];
      map[k + 1] = rubs ? velocity[k + 1] + excess[k] : none;
    }
    Four length = excess[0] * excess[0] + excess[1] * excess[1] + excess[2] * excess[2];
    const FourConditions slides = length > 0;
    Four size = map[0] < 0 ? -map[0] : map[0], parts[3];
    for (int k = 0; k < 3; ++k) parts[k] = map[k + 1] < 0 ? -map[k + 1] : map[k + 1];
    if (has_any(slides)) {
      take_root(length, length);
      Four inverse[3];
      for (int k = 0; k < 3; ++k) inverse[k] = 1 / metric[k];
      Four least = inverse[0] < inverse[1] ? inverse[0] : inverse[1];
      least = inverse[2] < least ? inverse[2] : least;
      const Four weight = 1 / (limit + length * least);
      for (int k = 0; k < 3; ++k)
        parts[k] = length > 0 ? parts[k] * ((limit + length * inverse[k]) * weight) : parts[k];
    }
    for (int k = 0; k < 3; ++k) size = parts[k] > size ? parts[k] : size;
    size = size / natural_size;
    for (int i = 0; i < kFour; ++i) {
      Contact& contact = contacts_[std::size_t(first + i)];
      worst = std::max(worst, size[i]);
      contact.touches = touches[i];
      contact.slides = slides[i];
    }
    double* to[kFour];
    for (int i = 0; i < kFour; ++i) to[i] = map_.data() + 4 * (first + i);
    store_columns(map[0], map[1], map[2], map[3], to);
    if (!has_any(ball.slides)) return true;
    Four hessian[3][3];
    const Four inverse_length = 1 / ball.length;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) {
        const double one = row == column ? 1 : 0;
        const Four element = (one - ball.boundary[row] * ball.boundary[column]) * inverse_length;
        hessian[row][column] = ball.slides ? element : none;
      }
    for (int i = 0; i < kFour; ++i)
      to[i] = contacts_[std::size_t(first + i)].boundary_and_hessian.data();
    store_columns(ball.boundary[0], ball.boundary[1], ball.boundary[2], hessian[0][0], to);
    for (double*& next : to) next += kFour;
    store_columns(hessian[1][0], hessian[2][0], hessian[0][1], hessian[1][1], to);
    for (double*& next : to) next += kFour;
    store_columns(hessian[2][1], hessian[0][2], hessian[1][2], hessian[2][2], to);
    return true;
  });
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
    if (decomposition_ != Decomposition::of_impulses) forget_step();
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

/// The same in the velocities that the contacts have in common. Where contacts give way, pivots are
/// rarely small, and proximal points need no exact steps. Near a solution they are what the last
/// digits depend on.
ExactNewton::Decomposition ExactNewton::factorise_reduced(const ContactOperator& contacts,
                                                          const Eigen::VectorXd& impulse,
                                                          double proximal, int size) {
  int group[kFour], count = 0;
  for (int i = 0; i < contacts.contacts(); ++i) {
    if (first_[std::size_t(i)] < 0) continue;
    group[count++] = i;
    if (count < kFour) continue;
    find_four_inverses(contacts, group, impulse, proximal);
    count = 0;
  }
  for (int k = 0; k < count; ++k) find_inverse(contacts, group[k], impulse[4 * group[k]], proximal);
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

/// The same bits for four contacts at once.
void ExactNewton::find_four_inverses(const ContactOperator& contacts, const int (&group)[kFour],
                                     const Eigen::VectorXd& impulse, double proximal) {
  using Rows = Four[3][3];
  const auto invert = [](const Rows& m, Rows& inverse) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        inverse[j][i] = m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3] -
                        m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3];
    const Four part = inverse[0][0] * m[0][0] + inverse[0][1] * m[1][0] + inverse[0][2] * m[2][0];
    const Four factor = 1 / part;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) inverse[i][j] = inverse[i][j] * factor;
  };
  with_best_instructions([&] {
    const Four none = {};
    const double yielding = compliance_ + proximal;
    Four boundary[3], hessian[3][3], metric[3], unit[3], pressure;
    FourConditions rubs, slides;
    {
      const double* from[kFour];
      for (int i = 0; i < kFour; ++i)
        from[i] = contacts_[std::size_t(group[i])].boundary_and_hessian.data();
      load_columns(from, boundary[0], boundary[1], boundary[2], hessian[0][0]);
      for (const double*& next : from) next += kFour;
      load_columns(from, hessian[1][0], hessian[2][0], hessian[0][1], hessian[1][1]);
      for (const double*& next : from) next += kFour;
      load_columns(from, hessian[2][1], hessian[0][2], hessian[1][2], hessian[2][2]);
    }
    for (int i = 0; i < kFour; ++i) {
      const double *own_metric = contacts.friction_metric(group[i]).data(),
                   *own_unit = factor_.unit(group[i]).data();
      for (int k = 0; k < 3; ++k) metric[k][i] = own_metric[k];
      for (int k = 0; k < 3; ++k) unit[k][i] = own_unit[k + 1];
      pressure[i] = std::max(impulse[4 * group[i]], 0.);
      rubs[i] = contacts.has_friction(group[i]) ? -1 : 0;
      slides[i] = contacts_[std::size_t(group[i])].slides ? -1 : 0;
    }
    Four matrix[3][3], sliding[3][3], sticking[3][3], inverse[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        matrix[i][j] = (i == j ? 1. : 0.) + pressure * (metric[i] * hessian[i][j]);
    invert(matrix, sliding);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        sliding[i][j] = slides ? sliding[i][j] : none;
        sticking[i][j] = (i == j ? 1. : 0.) - sliding[i][j];
        matrix[i][j] = sliding[i][j] * metric[j] + compliance_ * (sticking[i][j] * metric[j]);
        if (i == j) matrix[i][j] = matrix[i][j] + proximal * metric[i];
      }
    invert(matrix, inverse);
    Four pushed[3], turned[3], moved[3], follows[3][3], stiffness[3][3];
    for (int i = 0; i < 3; ++i) pushed[i] = metric[i] * boundary[i];
    multiply(sliding, pushed, turned);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) follows[i][j] = rubs ? sticking[i][j] * unit[j] : none;
      for (int j = 0; j < 3; ++j) inverse[i][j] = rubs ? inverse[i][j] : none;
    }
    multiply(inverse, turned, moved);
    for (int i = 0; i < 3; ++i) {
      moved[i] = rubs ? moved[i] / yielding : none;
      for (int j = 0; j < 3; ++j)
        stiffness[i][j] = inverse[i][0] * follows[0][j] + inverse[i][1] * follows[1][j] +
                          inverse[i][2] * follows[2][j];
    }
    const Four one = 1 + none, normal = one / yielding;
    const auto store_all = [&](Eigen::Matrix4d Contact::*member, const Four& corner,
                               const Four(&column)[3], const Four(&rest)[3][3]) {
      double* to[kFour];
      for (int i = 0; i < kFour; ++i) to[i] = (contacts_[std::size_t(group[i])].*member).data();
      store_columns(corner, column[0], column[1], column[2], to);
      for (int j = 0; j < 3; ++j) {
        for (double*& next : to) next += kFour;
        store_columns(none, rest[0][j], rest[1][j], rest[2][j], to);
      }
    };
    const Four nothing[3] = {};
    store_all(&Contact::own_inverse, normal, moved, inverse);
    store_all(&Contact::from_velocity, one, nothing, follows);
    store_all(&Contact::stiffness, normal, moved, stiffness);
    for (int i = 0; i < kFour; ++i) {
      Eigen::Matrix3d& own = contacts_[std::size_t(group[i])].sticking;
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) own(row, column) = sticking[row][column][i];
    }
  });
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
                             int most_iterations, const std::function<bool()>& is_needed,
                             ProximalCourse::Start start) {
  const int n = 4 * contacts.contacts();
  centre_.head(n) = point_.head(n) = reached_.head(n) = impulse.head(n);
  move_.head(n).setZero();
  compliance_ = 0;
  ProximalCourse course;
  course.begin(evaluate(contacts, point_), start);
  while (course.goes_on(most_iterations)) {
    if (is_needed && !is_needed()) break;
    compliance_ = course.compliance;
    const bool has_reached = take_steps(contacts, course);
    if (has_reached)
      course.reach(move_on(n));
    else
      course.fail();
    centre_.head(n) = point_.head(n) = reached_.head(n);
    // Where the point is reached, W r is that of the last step.
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
