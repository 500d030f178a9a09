#pragma once

#include <algorithm>
#include <cmath>

#include "softfinger/dynamics/contacts/contact_residual.h"

/// Internal: when proximal points go on, and how.
namespace softfinger::internal {

/// The course of proximal points from one start, see ExactNewton::approach: the contacts'
/// compliance, how far ahead the next point is looked for, and when to end. |F| without unit.
struct ProximalCourse {
  /// State after one of Newton's steps towards the next point.
  enum class Progress { going, reached, failed };

  double compliance = 1;  ///< c
  double stride = 1;      ///< from the last point but one to the next r0; 1: the last point itself
  double residual = 0;    ///< |F| at r0
  double best = 0;        ///< the least |F| of all points
  double halved = 0;
  int iterations = 0, last_halved = 0, steps = 0;

  /// A start may lie anywhere, or at the impulses of a problem much like this one.
  enum class Start { far, near };

  /// Begins at a start whose |F| is `size`. The nearer it is to the solution, the less compliance
  /// the contacts need: in steady motion this leaves a third of the iterations.
  void begin(double size, Start start = Start::far) {
    constexpr double kOfRoot = 0.1, kLeast = 1e-5;
    *this = {};
    residual = best = halved = size;
    if (start == Start::near) compliance = std::clamp(kOfRoot * std::sqrt(size), kLeast, 1.);
  }

  /// Whether a further point is worth looking for. Points can go round in circles. Close to the
  /// solution rounding or kinks of F can stop them. In both cases |F| is no longer halved.
  bool goes_on(int most_iterations) {
    constexpr double kClose = 1e-6;
    constexpr int kPatience = 250, kPatienceClose = 80;
    if (best < halved / 2) {
      halved = best;
      last_halved = iterations;
    }
    return best > kGood && iterations < most_iterations &&
           iterations <= last_halved + (best < kClose ? kPatienceClose : kPatience);
  }

  /// @param size  |F| after the step; not finite: there was none
  Progress take_step(double size) {
    constexpr int kMostSteps = 5;
    constexpr double kReached = 0.7;  // of |F|: the next point need not be exact
    ++iterations;
    if (std::isfinite(size)) {
      if (size < kReached * residual) return end(Progress::reached);
      if (++steps < kMostSteps) return Progress::going;
    }
    return end(Progress::failed);
  }

  /// The point is reached. Heavy bodies that press through light ones have impulses that must
  /// change a lot to change velocities a little, while c cannot be small for what the light ones do
  /// meanwhile: points crawl along a line. The next r0 then lies ahead on it.
  /// @param cosine  between the last two moves
  void reach(double cosine) {
    constexpr double kStraight = 0.97, kLonger = 1.3, kLongest = 256;
    constexpr double kStiffer = 0.5, kLeast = 1e-10;
    stride = cosine > kStraight ? std::min(kLonger * stride, kLongest) : 1;
    compliance = std::max(kStiffer * compliance, kLeast);
  }

  /// Prepares another attempt where the next point was not reached: from the same r0, or from the
  /// last point if r0 was ahead of it.
  void fail() {
    constexpr double kSofter = 10, kMost = 1e5;
    if (stride > 1)
      stride = 1;
    else
      compliance = std::min(kSofter * compliance, kMost);
  }

  /// Records the arrival at the next point, whose |F| is `size`. Returns whether it is the best
  /// one.
  bool arrive(double size) {
    residual = size;
    if (!(residual < best)) return false;
    best = residual;
    return true;
  }

 private:
  Progress end(Progress progress) {
    steps = 0;
    return progress;
  }
};

}  // namespace softfinger::internal
