#include "fem/contact/active_set.h"

#include <algorithm>
#include <numeric>

#include "softfinger/input/errors.h"

namespace softfinger::fem {

using Eigen::Index;

namespace {

constexpr double round_off = 1e-12;
/// Steps without fewer changes than ever before, after which nodes move one at a time. Chosen, not
/// measured.
constexpr int patience = 8;

}  // namespace

ActiveSet::ActiveSet(const Eigen::VectorXd& gap, const Eigen::VectorXd* force)
    : touches_(static_cast<std::size_t>(gap.size()), 0), fewest_changes_(gap.size() + 1) {
  std::vector<Index> order(touches_.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return gap[i] < gap[j]; });
  nearest_ = order.front();
  if (force && force->maxCoeff() > 0)
    for (Index i = 0; i < gap.size(); ++i) touches_[static_cast<std::size_t>(i)] = (*force)[i] > 0;
  else
    for (std::size_t i = 0; i < (order.size() + 1) / 2; ++i)
      touches_[static_cast<std::size_t>(order[i])] = 1;
}

std::vector<Index> ActiveSet::nodes(bool touching) const {
  std::vector<Index> result;
  for (std::size_t i = 0; i < touches_.size(); ++i)
    if ((touches_[i] != 0) == touching) result.push_back(static_cast<Index>(i));
  return result;
}

bool ActiveSet::improve(const Eigen::VectorXd& force, const Eigen::VectorXd& clearance,
                        double force_scale, double clearance_scale) {
  std::vector<Index> wrong;
  Index worst = -1;
  double worst_violation = 0;
  for (Index i = 0; i < force.size(); ++i) {
    const double violation = touches_[static_cast<std::size_t>(i)]
                                 ? -force[i] / force_scale
                                 : -clearance[i] / clearance_scale;
    if (!(violation > round_off)) continue;
    wrong.push_back(i);
    if (violation > worst_violation) {
      worst_violation = violation;
      worst = i;
    }
  }
  if (wrong.empty()) return true;
  const auto changes = static_cast<Index>(wrong.size());
  if (changes < fewest_changes_) {
    fewest_changes_ = changes;
    since_improvement_ = 0;
  } else {
    ++since_improvement_;
  }
  // All at once while that makes progress (few steps); when it stalls, the worst one alone, which
  // cannot cycle for a positive definite compliance.
  if (since_improvement_ > patience) wrong = {worst};
  for (const Index i : wrong) {
    char& touches = touches_[static_cast<std::size_t>(i)];
    touches = !touches;
  }
  if (std::none_of(touches_.begin(), touches_.end(), [](char touches) { return touches; }))
    touches_[static_cast<std::size_t>(nearest_)] = 1;
  return false;
}

void ActiveSet::give_up() const {
  throw ConvergenceError("active set of the contact", most_steps,
                         static_cast<double>(fewest_changes_),
                         "the contact keeps changing by this many nodes; refine the mesh");
}

}  // namespace softfinger::fem
