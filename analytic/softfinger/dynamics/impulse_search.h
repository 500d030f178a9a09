#pragma once

#include <Eigen/Core>
#include <functional>
#include <utility>

#include "softfinger/dynamics/exact_newton.h"
#include "softfinger/dynamics/friction_strategy.h"
#include "softfinger/dynamics/least_impulse.h"

/// Internal: from impulses to a solution with exact friction, without a path.
namespace softfinger::internal {

/// One search: the impulses where it is, the best ones so far and all that it writes to. Several
/// searches at the same time need a task each, whose solution and result are their own; the
/// problem and the contacts are only read.
class ImpulseSearch {
 public:
  ImpulseSearch(const ContactOperator& contacts, int contact_capacity);

  void begin_problem() { newton_.begin_problem(); }

  /// How much of Newton's method a polish takes, see ExactNewton::solve, how often `approach`
  /// eases, and where from it starts.
  static constexpr int kEasedStarts = 4, kMostIterationsOfEased = 400;
  struct Effort {
    int passes, patience;
    int eased_starts = kEasedStarts;
    ProximalCourse::Start start = ProximalCourse::Start::far;
  };

  /// Where the search is, scaled.
  Eigen::VectorXd& impulse() { return impulse_; }
  /// The best point so far, with its impulses, scaled.
  struct Found {
    BestPoint best;
    Eigen::VectorXd impulse;

    void take_if_better(Found&& other) {
      if (best.is_worse_than(other.best.residual, other.best.is_rounded)) std::swap(*this, other);
    }
  };
  const Found& found() const { return found_; }
  const ContactOperator& contacts() const { return contacts_; }
  /// W = C L L^T of the problem.
  const VelocityFactor& factor() { return newton_.factor(contacts_); }
  BestPoint& best() { return found_.best; }
  /// After others have searched: nothing is left of the last step, nor of the least impulses, that
  /// `correct` could use.
  void continue_from(const Found& found);

  /// From normal impulses `normal(contact)` alone, by a few of Gauss-Seidel's sweeps.
  template <class Normal>
  void start_from(const Normal& normal, int sweeps);
  /// From `impulse`, which may be far away, by proximal points.
  /// @param is_needed  asked now and then; where it says no, the search may end anywhere
  void approach(const Task& task, int most_iterations, Effort effort,
                const std::function<bool()>& is_needed = {});
  /// The same without easing. Whether that may help.
  bool come_close(const Task& task, int most_iterations, Effort effort,
                  const std::function<bool()>& is_needed = {});
  /// Bodies that are wedged by impulses up to a thousand times larger than needed hide the solution
  /// in the rounding of W r. From the least impulses that make the same velocities proximal points
  /// come closer. What is still and what slides cannot be told for certain before: there are
  /// several. False where there are none.
  /// @param wedged  where proximal points have ended
  bool go_to_eased(const Task& task, const Eigen::VectorXd& wedged, int number);
  /// |F| of points that are close enough for Newton's method, or for easing.
  static constexpr double kClose = 1e-6;
  /// From `impulse` by Newton's method.
  void polish(const Task& task, Effort effort);
  struct Corrected {
    bool is_good = false;
    bool is_still = false;  ///< the least impulses: there are no others to look for
  };
  /// From `impulse` by the last least impulses or the matrix of Newton's last step.
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
  bool refine(const Task& task, double reached, Effort effort);
  void ease(const Task& task, Effort effort, const std::function<bool()>& is_needed);
  double extract(const Task& task) const;
  int size() const { return 4 * contacts_.contacts(); }
  void start(int sweeps);

  const ContactOperator& contacts_;
  ExactNewton newton_;
  LeastImpulse least_;
  Found found_;
  Eigen::VectorXd impulse_, velocity_, wedged_;  ///< scaled
};

template <class Normal>
void ImpulseSearch::start_from(const Normal& normal, int sweeps) {
  impulse_.head(size()).setZero();
  for (int i = 0; i < contacts_.contacts(); ++i) impulse_[4 * i] = normal(i);
  start(sweeps);
}

}  // namespace softfinger::internal
