#include "fem/normal_contact.h"

#include <algorithm>
#include <vector>

#include "fem/active_set.h"
#include "fem/positive_definite.h"

namespace softfinger::fem {
namespace {

/// @param approach  from the forces per approach and those that the gap takes away
template <class Approach>
NormalContact solve_active_set(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                               const Approach& approach, const NormalContact* start,
                               TouchingFactor& kept) {
  NormalContact contact;
  ActiveSet set(gap, start ? &start->force : nullptr);
  for (contact.iterations = 1; contact.iterations <= ActiveSet::most_steps; ++contact.iterations) {
    const std::vector<Eigen::Index> touching = set.touching();
    if (kept.nodes != touching) {
      kept.factor = compliance(touching, touching);
      factorise_positive_definite(kept.factor);
      kept.nodes = touching;
    }
    // f = approach * C^-1 1 - C^-1 gap.
    Eigen::MatrixXd right(static_cast<Eigen::Index>(touching.size()), 2);
    right << Eigen::VectorXd::Ones(right.rows()), gap(touching);
    const Eigen::MatrixXd solved = solve_by_factor(kept.factor, right);
    const Eigen::VectorXd per_approach = solved.col(0), from_gap = solved.col(1);
    contact.approach = approach(per_approach, from_gap);
    const Eigen::VectorXd force = contact.approach * per_approach - from_gap;
    contact.force = Eigen::VectorXd::Zero(gap.size());
    contact.force(touching) = force;
    const Eigen::VectorXd clearance =
        (product_with_zeros(compliance, contact.force) + gap).array() - contact.approach;
    if (!set.improve(contact.force, clearance, force.cwiseAbs().maxCoeff(),
                     std::abs(contact.approach) + gap.cwiseAbs().maxCoeff()))
      continue;
    contact.active = static_cast<int>(touching.size());
    contact.complementarity_residual =
        std::max(0.0, -clearance.minCoeff()) / std::abs(contact.approach);
    contact.force = contact.force.cwiseMax(0.0);
    return contact;
  }
  set.give_up();
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
