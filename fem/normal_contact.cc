#include "fem/normal_contact.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <vector>

#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

/// @param approach  of forces approach * per_approach - from_gap
template <class Approach>
NormalContact solve_active_set(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                               const Approach& approach, const NormalContact* start,
                               TouchingFactor& kept) {
  const Eigen::Index count = gap.size();
  NormalContact contact;
  contact.force = Eigen::VectorXd::Zero(count);

  // Without a start, from the nodes of a generous initial contact: the set then shrinks, mostly
  // monotonically.
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return gap[i] < gap[j]; });
  std::vector<char> active(static_cast<std::size_t>(count), 0);
  if (start)
    for (Eigen::Index i = 0; i < count; ++i)
      active[static_cast<std::size_t>(i)] = start->force[i] > 0;
  else
    for (std::size_t i = 0; i < (order.size() + 1) / 2; ++i)
      active[static_cast<std::size_t>(order[i])] = 1;

  constexpr int limit = 200;
  std::size_t fewest_changes = order.size() + 1;
  int since_improvement = 0;
  for (contact.iterations = 1; contact.iterations <= limit; ++contact.iterations) {
    std::vector<Eigen::Index> set;
    for (Eigen::Index i = 0; i < count; ++i)
      if (active[static_cast<std::size_t>(i)]) set.push_back(i);
    if (kept.nodes != set) {
      kept.factor.compute(compliance(set, set));
      kept.nodes = set;
    }
    // f = approach * C^-1 1 - C^-1 gap.
    const Eigen::VectorXd per_approach =
        kept.factor.solve(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(set.size())));
    const Eigen::VectorXd from_gap = kept.factor.solve(gap(set).eval());
    contact.approach = approach(per_approach, from_gap);
    const Eigen::VectorXd force = contact.approach * per_approach - from_gap;
    contact.force.setZero();
    contact.force(set) = force;
    const Eigen::VectorXd clearance = (compliance(Eigen::all, set) * force -
                                       Eigen::VectorXd::Constant(count, contact.approach) + gap);

    // Round-off of the solve decides neither way: such nodes stay where they are.
    const double force_floor = 1e-12 * force.cwiseAbs().maxCoeff();
    const double clearance_floor = 1e-12 * (std::abs(contact.approach) + gap.cwiseAbs().maxCoeff());
    std::size_t changes = 0;
    Eigen::Index worst = -1;
    double worst_violation = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      auto& is_active = active[static_cast<std::size_t>(i)];
      const bool leaves = is_active && contact.force[i] < -force_floor;
      const bool enters = !is_active && clearance[i] < -clearance_floor;
      if (!leaves && !enters) continue;
      ++changes;
      const double violation = leaves ? -contact.force[i] / (force_floor * 1e12)
                                      : -clearance[i] / (clearance_floor * 1e12);
      if (violation > worst_violation) {
        worst_violation = violation;
        worst = i;
      }
    }
    if (changes == 0) {
      contact.active = static_cast<int>(set.size());
      contact.complementarity_residual =
          std::max(0.0, -clearance.minCoeff()) / std::abs(contact.approach);
      contact.force = contact.force.cwiseMax(0.0);
      return contact;
    }
    // All at once while that makes progress (few steps); when it stalls, one node at a time, which
    // cannot cycle for a positive definite compliance.
    if (changes < fewest_changes) {
      fewest_changes = changes;
      since_improvement = 0;
    } else {
      ++since_improvement;
    }
    const bool one_at_a_time = since_improvement > 8;
    for (Eigen::Index i = 0; i < count; ++i) {
      auto& is_active = active[static_cast<std::size_t>(i)];
      const bool wrong =
          is_active ? contact.force[i] < -force_floor : clearance[i] < -clearance_floor;
      if (wrong && (!one_at_a_time || i == worst)) is_active = !is_active;
    }
    if (std::none_of(active.begin(), active.end(), [](char value) { return value; }))
      active[static_cast<std::size_t>(order.front())] = 1;
  }
  throw ConvergenceError("active set of the contact", limit, static_cast<double>(fewest_changes),
                         "the contact keeps changing by this many nodes; refine the mesh");
}

}  // namespace

NormalContact solve_normal_contact(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                                   double load, const NormalContact* start, TouchingFactor* kept) {
  TouchingFactor own;
  NormalContact contact = solve_active_set(
      compliance, gap,
      [&](const Eigen::VectorXd& per_approach, const Eigen::VectorXd& from_gap) {
        return (load + from_gap.sum()) / per_approach.sum();
      },
      start, kept ? *kept : own);
  contact.load_residual = std::abs(contact.force.sum() - load) / load;
  return contact;
}

NormalContact solve_normal_contact_at(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                                      double approach) {
  TouchingFactor own;
  return solve_active_set(
      compliance, gap, [&](auto&&...) { return approach; }, nullptr, own);
}

}  // namespace softfinger::fem
