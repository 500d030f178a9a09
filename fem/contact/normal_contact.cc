#include "fem/contact/normal_contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <iterator>
#include <vector>

#include "fem/algebra/positive_definite.h"
#include "fem/contact/active_set.h"

namespace softfinger::fem {

using Eigen::Index;

namespace {

/// Solves C f = right among the nodes that touch by the factor of nearly the same nodes: those that
/// have left are held at zero force by displacements of their own, those that have come border it.
/// Where too many have, the factor is replaced, as that costs less then.
class TouchingSolver {
 public:
  TouchingSolver(const Eigen::MatrixXd& compliance, const std::vector<Index>& touching,
                 TouchingFactor& kept)
      : kept_(kept), touching_(touching) {
    std::vector<Index> left = find_changes();
    // A column of the border costs 2 n² operations and their memory, a factor n³/3.
    constexpr std::size_t share = 16;
    if (share * (left.size() + come_.size()) > touching.size()) {
      kept_.factor = compliance(touching, touching);
      factorise_positive_definite(kept_.factor);
      kept_.nodes = touching;
      kept_.per_displacement =
          solve_vector_by_factor(kept_.factor, Eigen::VectorXd::Ones(kept_.factor.rows()));
      left = find_changes();
    }
    const auto came = static_cast<Index>(come_.size()),
               changes = came + static_cast<Index>(left.size());
    if (changes == 0) return;
    border_ = Eigen::MatrixXd::Zero(kept_.factor.rows(), changes);
    border_.leftCols(came) = compliance(kept_.nodes, come_);
    for (Index k = came; k < changes; ++k) border_(left[static_cast<std::size_t>(k - came)], k) = 1;
    of_border_ = solve_by_factor(kept_.factor, border_);
    Eigen::MatrixXd complement = -border_.transpose() * of_border_;
    complement.topLeftCorner(came, came) += compliance(come_, come_);
    complement_.compute(complement);
  }

  /// Forces on the touching nodes, by displacements of all, of which theirs count.
  Eigen::VectorXd force(const Eigen::VectorXd& displacement) const {
    return with_border(solve_vector_by_factor(kept_.factor, displacement(kept_.nodes)),
                       displacement);
  }
  /// The forces that a displacement of 1 causes.
  Eigen::VectorXd force_per_displacement(Index all) const {
    return with_border(kept_.per_displacement, Eigen::VectorXd::Ones(all));
  }

 private:
  /// @returns places of those that have left among the kept nodes
  std::vector<Index> find_changes() {
    come_.clear();
    std::set_difference(touching_.begin(), touching_.end(), kept_.nodes.begin(), kept_.nodes.end(),
                        std::back_inserter(come_));
    std::vector<Index> left;
    for (std::size_t k = 0; k < kept_.nodes.size(); ++k)
      if (!std::binary_search(touching_.begin(), touching_.end(), kept_.nodes[k]))
        left.push_back(static_cast<Index>(k));
    return left;
  }

  Eigen::VectorXd with_border(Eigen::VectorXd of_kept, const Eigen::VectorXd& displacement) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(displacement.size());
    if (border_.cols() > 0) {
      Eigen::VectorXd right = -border_.transpose() * of_kept;
      const auto came = static_cast<Index>(come_.size());
      right.head(came) += displacement(come_);
      const Eigen::VectorXd at_border = complement_.solve(right);
      of_kept -= of_border_ * at_border;
      force(come_) = at_border.head(came);
    }
    force(kept_.nodes) = of_kept;
    return force(touching_);
  }

  TouchingFactor& kept_;
  const std::vector<Index>& touching_;
  std::vector<Index> come_;
  Eigen::MatrixXd border_, of_border_;  ///< the latter by the factor
  Eigen::PartialPivLU<Eigen::MatrixXd> complement_;
};

/// @param approach  from the forces per approach and those that the gap takes away
template <class Approach>
NormalContact solve_active_set(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                               const Approach& approach, const NormalContact* start,
                               TouchingFactor& kept) {
  NormalContact contact;
  ActiveSet set(gap, start ? &start->force : nullptr);
  for (contact.iterations = 1; contact.iterations <= ActiveSet::most_steps; ++contact.iterations) {
    const std::vector<Index> touching = set.touching();
    const TouchingSolver solver(compliance, touching, kept);
    // f = approach * C^-1 1 - C^-1 gap.
    const Eigen::VectorXd per_approach = solver.force_per_displacement(gap.size()),
                          from_gap = solver.force(gap);
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
