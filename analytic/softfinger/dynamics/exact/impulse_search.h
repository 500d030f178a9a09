#pragma once

#include <Eigen/Core>

#include "softfinger/dynamics/contacts/solve_task.h"
#include "softfinger/dynamics/exact/exact_newton.h"
#include "softfinger/dynamics/exact/least_impulse.h"

/// Internal: from impulses to a solution with exact friction, without a path.
namespace softfinger::internal {

/// A search has a place, which are impulses, and remembers the best place so far.
class ImpulseSearch {
 public:
  ImpulseSearch(const ContactOperator& contacts, int contact_capacity);

  void begin_problem() { newton_.begin_problem(); }

  /// Limits of a search: passes and patience of `ExactNewton::solve`, the number of restarts by
  /// `approach` from the least impulses of a wedged state, and the kind of start.
  static constexpr int kEasedStarts = 4, kMostIterationsOfEased = 400;
  struct Effort {
    int passes, patience;
    int eased_starts = kEasedStarts;
    ProximalCourse::Start start = ProximalCourse::Start::far;
  };

  /// The place of the search, scaled.
  Eigen::VectorXd& impulse() { return impulse_; }
  /// The best point so far.
  BestPoint& best() { return best_; }

  /// Starts from the normal impulses `normal(contact)` alone, by a few of Gauss-Seidel's sweeps.
  template <class Normal>
  void start_from(const Normal& normal, int sweeps);
  /// Solves from `impulse`, which may be far from the solution: proximal points first, then
  /// Newton's method.
  void approach(const Task& task, int most_iterations, Effort effort);
  /// Solves from `impulse`, which must be near the solution, by Newton's method.
  void polish(const Task& task, Effort effort);
  struct Corrected {
    bool is_good = false;
    bool is_still = false;  ///< the least impulses: there are no others to look for
  };
  /// Corrects `impulse` by the last least impulses or by the matrix of Newton's last step.
  Corrected correct(const Task& task);
  void forget_still() { least_.forget(); }

  /// Takes `impulse` as the best point if it is better: a solution, or one of a smaller residual.
  void keep_if_better(const Task& task);
  /// Writes the best impulses as the solution; returns the residual.
  double restore_best(const Task& task);
  /// The least impulses with the same velocities in place of the best ones: LeastImpulse. The
  /// solution is left as it is where their residual would be more than ten times as large.
  void take_least_impulse(const Task& task);
  /// Writes lambda = h(u) of a solution with its impulses and velocities; returns the residual.
  double complete(const Task& task) const;

 private:
  void ease(const Task& task, Effort effort);
  bool go_to_eased(const Task& task, int number);
  double extract(const Task& task) const;
  int size() const { return 4 * contacts_.contacts(); }
  void start(int sweeps);

  const ContactOperator& contacts_;
  ExactNewton newton_;
  LeastImpulse least_;
  BestPoint best_;
  Eigen::VectorXd best_impulse_, impulse_, velocity_, wedged_;  ///< scaled
};

template <class Normal>
void ImpulseSearch::start_from(const Normal& normal, int sweeps) {
  impulse_.head(size()).setZero();
  for (int i = 0; i < contacts_.contacts(); ++i) impulse_[4 * i] = normal(i);
  start(sweeps);
}

}  // namespace softfinger::internal
