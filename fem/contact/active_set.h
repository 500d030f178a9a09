#pragma once

#include <Eigen/Core>
#include <vector>

namespace softfinger::fem {

/// Finds which nodes of a surface touch, by a primal-dual active set. The caller solves with the
/// nodes that are `touching`, and `improve` moves those that pull or penetrate, until none does.
class ActiveSet {
 public:
  /// @param gap    n, any origin
  /// @param force  n, > 0 on the nodes that likely touch; null or nowhere > 0: the half of the
  /// nodes with the smallest gaps, from which the set shrinks, mostly monotonically
  ActiveSet(const Eigen::VectorXd& gap, const Eigen::VectorXd* force);

  std::vector<Eigen::Index> touching() const { return nodes(true); }
  std::vector<Eigen::Index> free() const { return nodes(false); }

  /// Moves nodes between the two. Round-off decides neither way: nodes that pull or penetrate by
  /// less than 1e-12 of the scales stay where they are.
  /// @param force      n, at the nodes that touch
  /// @param clearance  n, at the free ones
  /// @returns whether none had to be moved
  bool improve(const Eigen::VectorXd& force, const Eigen::VectorXd& clearance, double force_scale,
               double clearance_scale);

  /// Steps after which a caller gives up, with what it says then.
  static constexpr int most_steps = 200;
  [[noreturn]] void give_up() const;

 private:
  std::vector<Eigen::Index> nodes(bool touching) const;

  std::vector<char> touches_;
  Eigen::Index nearest_;  ///< node of the smallest gap: a contact has one at least
  Eigen::Index fewest_changes_;
  int since_improvement_ = 0;
};

}  // namespace softfinger::fem
