#include "softfinger/dynamics/contacts/contact_residual.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/input/constants.h"
#include "softfinger/math/wide.h"

namespace softfinger {
namespace {

/// Rows of W at a time, in a vector that needs no memory of its own. A row alone would be read
/// across the memory, for W is stored by columns.
constexpr int kRowsAtOnce = 64;
using SomeRows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kRowsAtOnce, 1>;

/// rows += term(W) r for the rows of W from `first` on. Contacts that are open have no impulse.
template <class Term, class Rows>
void add_rows(const Eigen::MatrixXd& delassus, const Eigen::VectorXd& impulse, int first,
              const Term& term, Rows& rows) {
  with_best_instructions([&] {
    double* to = rows.data();
    const int count = int(rows.size());
    for (Eigen::Index column = 0; column < impulse.size(); ++column) {
      const double* from = delassus.data() + column * delassus.rows() + first;
      const double factor = term(impulse[column]);
      if (factor == 0) continue;
      for (int row = 0; row < count; ++row) to[row] += factor * term(from[row]);
    }
  });
}

double over(double value, double unit) { return unit > 0 ? value / unit : value; }

/// Impulses and velocities that belong to the loads and weights of a solution.
ContactSolution rebuilt(const ContactLcp& problem, const ContactSolution& solution) {
  ContactSolution result = solution;
  for (int i = 0; i < problem.contacts(); ++i) result.impulse.segment<3>(4 * i + 1).setZero();
  for (const ContactSolution::Weight& weight : solution.weights) {
    const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[weight.contact]);
    result.impulse.segment<3>(4 * weight.contact + 1) +=
        weight.value * arms.cwiseProduct(problem.vertices.col(weight.vertex));
  }
  result.velocity = problem.free_velocity;
  result.velocity.noalias() += problem.delassus * result.impulse;
  return result;
}

/// The rounding of W r over the free velocities where it is so large that a residual says nothing,
/// else 0. Impulses of 1e16 absorb the velocities: they would seem to solve what has no solution.
double rounding_that_hides(const ContactLcp& problem, const ContactSolution& solution) {
  constexpr double kHides = 1e-3;
  const Eigen::VectorXd& impulse = solution.impulse;
  // |W_ij|² <= W_ii W_jj: at most, without looking at W as a whole.
  double loads = 0, answer = 0;
  for (Eigen::Index row = 0; row < impulse.size(); ++row) {
    const double root = std::sqrt(std::max(problem.delassus(row, row), 0.));
    loads += root * std::abs(impulse[row]);
    answer = std::max(answer, row % 4 == 3 ? root * problem.eccentricity_m[row / 4] : root);
  }
  const double most = internal::kRoundings * std::numeric_limits<double>::epsilon() * loads *
                      answer / problem.free_velocity.lpNorm<Eigen::Infinity>();
  if (!(most > kHides)) return 0;
  const double rounding = internal::rounding_of(problem, solution, kInfinity);
  return rounding > kHides ? rounding : 0;
}

}  // namespace

namespace internal {

double residual_of(const ContactLcp& problem, const Eigen::Matrix3Xd& vertices,
                   const ContactSolution& solution, const Eigen::VectorXd& least_along) {
  // Minima and maxima would drop what is not a number.
  if (!all_finite(solution.impulse) || !all_finite(solution.velocity) || !all_finite(solution.slip))
    return kInfinity;
  const double velocity_unit = problem.free_velocity.lpNorm<Eigen::Infinity>();
  const double impulse_unit = solution.impulse.lpNorm<Eigen::Infinity>();
  double worst = 0;
  const auto add = [&worst](double value) { worst = std::max(worst, std::abs(value)); };
  for (int i = 0; i < problem.contacts(); ++i) {
    // P and v_n
    const double normal = solution.impulse[4 * i];
    add(over(std::min(problem.delassus(4 * i, 4 * i) * normal, solution.velocity[4 * i]),
             velocity_unit));
    // lambda and the rest of the cone
    double slack = problem.friction_coefficient[i] * normal;
    for (const ContactSolution::Weight& weight : solution.weights)
      if (weight.contact == i) slack -= weight.value;
    add(std::min(over(solution.slip[i], velocity_unit), over(slack, impulse_unit)));
    // beta = 0, of all vertices without a weight
    add(over(std::min(0., solution.slip[i] + least_along[i]), velocity_unit));
  }
  // beta > 0
  for (const ContactSolution::Weight& weight : solution.weights) {
    const int i = weight.contact;
    const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[i]);
    const Eigen::Vector3d vertex = arms.cwiseProduct(vertices.col(weight.vertex));
    const double diagonal = vertex.dot(problem.delassus.block<3, 3>(4 * i + 1, 4 * i + 1) * vertex);
    const double along = vertices.col(weight.vertex).dot(scaled_slip(problem, solution, i));
    add(over(std::min(diagonal * weight.value, solution.slip[i] + along), velocity_unit));
  }
  return std::max(worst, rounding_that_hides(problem, solution));
}

void add_response(const ContactLcp& problem, const Eigen::VectorXd& impulse,
                  Eigen::VectorXd& velocity) {
  add_rows(
      problem.delassus, impulse, 0, [](double x) { return x; }, velocity);
}

double rounding_of(const ContactLcp& problem, const ContactSolution& solution, double most) {
  double largest = 0;
  const int rows = int(solution.impulse.size());
  SomeRows terms;
  for (int first = 0; first < rows; first += kRowsAtOnce) {
    const int count = std::min(kRowsAtOnce, rows - first);
    terms.setZero(count);
    add_rows(
        problem.delassus, solution.impulse, first, [](double x) { return std::abs(x); }, terms);
    for (int row = first; row < first + count; ++row) {
      const double unit = row % 4 == 3 ? problem.eccentricity_m[row / 4] : 1;
      largest = std::max(largest, unit * terms[row - first]);
    }
  }
  const double velocity_unit = problem.free_velocity.lpNorm<Eigen::Infinity>();
  if (!(velocity_unit > 0)) return 0;
  return std::min(most,
                  kRoundings * std::numeric_limits<double>::epsilon() * largest / velocity_unit);
}

}  // namespace internal

namespace {

/// `velocity_of(contact)`: what its impulses leave it, asked in their order.
template <class VelocityOf>
double exact_residual(const ContactLcp& problem, const ContactSolution& solution,
                      const VelocityOf& velocity_of) {
  const double velocity_unit = problem.free_velocity.lpNorm<Eigen::Infinity>();
  const double impulse_unit = solution.impulse.lpNorm<Eigen::Infinity>();
  double worst = 0;
  const auto add = [&worst](double value, double unit) {
    worst = std::isnan(value) ? kInfinity : std::max(worst, std::abs(over(value, unit)));
  };
  for (int i = 0; i < problem.contacts(); ++i) {
    const Eigen::Vector4d velocity = velocity_of(i);
    if (!internal::all_finite(velocity)) return kInfinity;
    // P and v_n
    const double normal = solution.impulse[4 * i], own = problem.delassus(4 * i, 4 * i);
    add(std::min(own * normal, velocity[0]), velocity_unit);
    // The wrench s: a contact without an arm carries no torque.
    const double arm_m = problem.eccentricity_m[i];
    const Eigen::Vector3d arms(1, 1, arm_m);
    const Eigen::Vector3d slip = arms.cwiseProduct(velocity.tail<3>());
    Eigen::Vector3d wrench = solution.impulse.segment<3>(4 * i + 1);
    if (arm_m > 0) {
      wrench.z() /= arm_m;
    } else {
      add(wrench.z(), impulse_unit);
      wrench.z() = 0;
    }
    // s within mu P K
    const double limit = problem.friction_coefficient[i] * std::max(normal, 0.);
    const FrictionShape* shape = problem.friction_rule == FrictionRule::limit_surface && arm_m > 0
                                     ? problem.shapes[std::size_t(i)]
                                     : nullptr;
    add(std::max(0., friction_gauge(shape, wrench) - limit), impulse_unit);
    // a s - proj(a s - u)
    if (!(problem.friction_coefficient[i] > 0)) continue;
    const Eigen::Matrix3d tangential =
        arms.asDiagonal() * problem.delassus.block<3, 3>(4 * i + 1, 4 * i + 1) * arms.asDiagonal();
    const double largest = tangential.diagonal().maxCoeff();
    const double step = largest > 0 ? largest : own;
    const FrictionExcess excess =
        friction_excess(shape, step * wrench - slip, limit, Eigen::Vector3d::Constant(step));
    add((slip + excess.excess).lpNorm<Eigen::Infinity>(), velocity_unit);
  }
  return std::max(worst, rounding_that_hides(problem, solution));
}

}  // namespace

double contact_residual(const ContactLcp& problem, const ContactSolution& solution) {
  if (!internal::all_finite(solution.impulse) || !internal::all_finite(solution.velocity))
    return kInfinity;
  const ContactSolution own = rebuilt(problem, solution);
  Eigen::VectorXd least_along = Eigen::VectorXd::Zero(problem.contacts());
  for (int i = 0; i < problem.contacts() && problem.vertices.cols() > 0; ++i)
    least_along[i] =
        internal::scaled_slip(problem, own, i).transpose().lazyProduct(problem.vertices).minCoeff();
  const double velocity_error = (solution.velocity - own.velocity).lpNorm<Eigen::Infinity>();
  const double impulse_error = (solution.impulse - own.impulse).lpNorm<Eigen::Infinity>();
  return std::max({internal::residual_of(problem, problem.vertices, own, least_along),
                   over(velocity_error, problem.free_velocity.lpNorm<Eigen::Infinity>()),
                   over(impulse_error, own.impulse.lpNorm<Eigen::Infinity>())});
}

double exact_contact_residual(const ContactLcp& problem, const ContactSolution& solution) {
  if (!internal::all_finite(problem.delassus)) return kInfinity;
  SomeRows velocities;
  return exact_residual(problem, solution, [&](int i) -> Eigen::Vector4d {
    const int within = 4 * i % kRowsAtOnce;
    if (within == 0) {
      const int count = std::min(kRowsAtOnce, 4 * (problem.contacts() - i));
      velocities = problem.free_velocity.segment(4 * i, count);
      add_rows(
          problem.delassus, solution.impulse, 4 * i, [](double x) { return x; }, velocities);
    }
    return velocities.segment<4>(within);
  });
}

double internal::exact_residual_of(const ContactLcp& problem, const ContactSolution& solution) {
  return exact_residual(problem, solution, [&](int i) -> Eigen::Vector4d {
    return solution.velocity.segment<4>(4 * i);
  });
}

}  // namespace softfinger
