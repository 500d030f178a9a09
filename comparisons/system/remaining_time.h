#pragma once

#include <cstddef>
#include <optional>

namespace softfinger::system {

/// Estimate of how long a set of jobs still takes. The expected times need only be right among
/// themselves: what the finished jobs took corrects the pace, and what the running ones have used
/// so far counts as done. Between the ends of two jobs the time counts down.
class RemainingTime {
 public:
  /// @param jobs        number of jobs
  /// @param expected_s  of all of them, one after the other, > 0
  /// @param parallel    how many run side by side, >= 1
  RemainingTime(std::size_t jobs, double expected_s, int parallel);

  /// A job has ended, `now_s` after the start of all.
  /// @param expected_s  of this job
  /// @param took_s      that it ran; none: not known, then guessed from what all have used
  void finished(double expected_s, std::optional<double> took_s, double now_s);

  /// Seconds, >= 0.
  double left_s(double now_s) const;

 private:
  double workers() const;

  std::size_t jobs_;
  double all_s_, to_do_s_, used_s_ = 0;
  int parallel_;
  double estimate_s_, estimated_at_s_ = 0;
};

}  // namespace softfinger::system
