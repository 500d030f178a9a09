#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "softfinger/dynamics/contact_lcp.h"
#include "softfinger/dynamics/contact_residual.h"
#include "softfinger/dynamics/contact_system.h"

/// Internal: what differs between the rules of friction when a contact problem is solved.
namespace softfinger::internal {

/// Largest violation by the last solution, over the natural size, for which no vertex is added.
constexpr double kToleratedViolation = 1e-13;

/// How one of the attempts at a problem differs from the others. Each also has a covering vector of
/// its own, by its number.
struct Attempt {
  double tolerance;               ///< see PathOptions
  double smallest_pivot;          ///< see PathOptions
  int refresh_after;              ///< see PathOptions
  bool has_all_vertices = false;  ///< with facets: use all vertices from the start
  double proximal = 0;            ///< with facets: see ContactOperator::set
  int newton_passes = 0;          ///< with exact friction: see ExactNewton::solve
  int newton_patience = 0;
};
/// Cheap: values are only advanced from pivot to pivot and computed again after every eighth.
constexpr Attempt kQuick{1e-12, 1e-9, 8};
/// Without the rounding that this accumulates.
constexpr Attempt kCareful{1e-12, 1e-9, 1};
constexpr int kMostAttempts = 32;

/// Largest number of basic z on a path: P, lambda and four vertices per contact, z0, and two more
/// as a margin.
inline int largest_basis(int contacts) { return 6 * contacts + 3; }

/// What is being solved, and where the answer goes.
struct Task {
  const ContactLcp& problem;
  ContactSolution& solution;
  LcpResult& result;
  /// Up to that much rounding explains the residual of a good point. A warm start is content with
  /// more: the last solution had it, too. A cold one finds better points than the rounding of one
  /// of them tells.
  double most_rounding = kSolved;

  /// Whether the solution at hand is as good as its impulses can be told.
  bool is_good(double residual) const {
    return residual <= kGood ||
           (residual <= most_rounding && residual <= rounding_of(problem, solution, most_rounding));
  }
};

/// Limits of a path that are the same for all attempts.
inline PathOptions usual_path(int contacts) {
  PathOptions options;
  options.tolerance = 1e-12;
  // Paths to a solution take far fewer pivots. One that takes so many repeats itself.
  options.most_pivots = 100 * contacts + 200;
  options.refresh_after = 8;
  return options;
}

/// The best point of a problem so far.
struct BestPoint {
  double residual = std::numeric_limits<double>::infinity();
  bool is_good = false;     ///< nothing better is looked for
  bool is_rounded = false;  ///< rounding alone explains the residual

  /// Whether it is a solution.
  bool is_solved(bool may_be_rounded) const {
    return residual <= kSolved || (may_be_rounded && is_rounded);
  }
  /// A solution is better than any other point.
  bool is_worse_than(double reached, bool rounded) const {
    const bool solves = reached <= kSolved || rounded;
    return solves != is_solved(true) ? solves : reached < residual;
  }
  void forget() { *this = {}; }
};

/// A rule of friction: which vertices take part in the path, and how its last point becomes a
/// solution.
class FrictionStrategy {
 public:
  virtual ~FrictionStrategy() = default;

  /// Gives the problem to the system; no point is known yet.
  virtual void begin(const ContactLcp& problem) = 0;
  virtual const Attempt& attempt(int number) const = 0;
  /// The vertices that this attempt starts with. Its covering vector has been chosen.
  virtual void start(const ContactLcp& problem, int attempt) = 0;
  /// The same for a path from the last problem's basis.
  virtual void start_warm(const ContactLcp& problem) = 0;

  /// Tries the last problem's impulses: those of its contact continued[i] for contact i, none where
  /// that is -1. True when they lead to the solution.
  virtual bool continue_impulse(const Task& task, const Eigen::VectorXd& last_impulse,
                                const std::vector<int>& continued) = 0;
  /// The index of a vertex of the last problem in this one; -1: there is no room for it.
  virtual int continue_vertex(const ContactPair& pair, const Eigen::Vector3d& corner) = 0;

  /// Adds the vertices that the solution at the path's end violates. False where there are none, or
  /// where the solution is already good: the path then need not go on.
  virtual bool add_vertices(const Task& task) = 0;
  /// After the last vertices have been added.
  virtual void refine_path() = 0;
  /// Writes the point that the path has led to as a solution; returns its residual.
  virtual double read_path(const Task& task) = 0;
  /// Completes the solution without impulses by its lambda; returns its residual.
  virtual double read_zero(const Task& task) = 0;
  /// Writes the best point so far as a solution. False where it was not kept: then its attempt has
  /// to be made once more.
  virtual bool restore_best(const Task& task) = 0;
  /// Looks for the solution before the first path. True where it is found.
  virtual bool do_before_path(const Task&) { return false; }
  /// The same at greater length, for problems that are not infeasible without friction.
  virtual bool has_more_before_path(const Task&) const { return false; }
  virtual bool do_more_before_path(const Task&) { return false; }
  /// After the last path has failed: looks for the solution in another way.
  virtual void do_without_path(const Task&) {}
  /// Of all impulses with the same effect takes the least ones, where the rule can tell them.
  virtual void take_least_impulse(const Task&) {}
  virtual BestPoint& best() = 0;
  int best_attempt() const { return best_attempt_; }

 protected:
  int attempt_ = 0, best_attempt_ = 0;
};

}  // namespace softfinger::internal
