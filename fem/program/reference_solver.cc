#include "fem/program/reference_solver.h"

#include "fem/base/formatted.h"
#include "fem/base/memory.h"
#include "fem/base/stopwatch.h"
#include "fem/finite/finite_contact.h"
#include "fem/linear/linear_contact.h"
#include "fem/problem/check_problem.h"

namespace softfinger::fem {
namespace {

/// Where the contact reaches a fold of the layer, once more with the ridge of the eroded finger as
/// the core's, which more of the layer bears. What that leaves open is stated. Where all cores
/// fold, the refusal is that of the one that bears most.
template <class Solve>
Result solve_with_any_core(const Problem& problem, const Progress& progress, const Solve& solve) {
  try {
    return solve(CoreWays::smoothed);
  } catch (const FoldedLayer& folded) {
    if (problem.fingertip.core) throw;
    FoldedLayer refusal = folded;
    for (const CoreWays ways : {CoreWays::eroded, CoreWays::eroded_nearer}) {
      progress(std::string(refusal.what()) + "; once more on the core that has a ridge there");
      try {
        return solve(ways);
      } catch (const FoldedLayer& again) {
        // One that names no load is less than any.
        if (again.fits() > refusal.fits()) refusal = again;
      } catch (const ConvergenceError& failure) {
        // Newton's method stops on this core: the fold's refusal tells more.
        progress(failure.what());
        break;
      }
    }
    throw refusal;
  }
}

}  // namespace

Result solve(const Problem& problem, const Progress& progress, const StopRequested& stop,
             ModelCache* cache) {
  check_problem(problem);
  if (stop()) throw Interrupted();
  const Stopwatch watch;
  ModelCache none(0);
  const auto solve_pressing = [&](const Problem& posed, const Pressing& pressing) {
    const ContactTask task{posed, pressing, progress, stop};
    return posed.finite_strain ? finite::solve_finite(task)
                               : solve_linear(task, cache ? *cache : none);
  };
  Result result = solve_with_any_core(problem, progress, [&](CoreWays ways) {
    Pressing pressing = pressing_of(problem, ways);
    try {
      return solve_pressing(problem, pressing);
    } catch (const OffCentre& found) {
      if (stop()) throw Interrupted();
      const Eigen::Vector2d at_mm = 1e3 * pressing.thickness_m * found.centre();
      progress(
          formatted("friction: about the pressure's centre, x %.3g, y %.3g mm from the first "
                    "touch; once more in coordinates that begin there",
                    at_mm.x(), at_mm.y()));
      pressing.bent = pressing.bent.seen_from(found.centre());
      Problem hinted = problem;
      hinted.size_hint_m = found.size_m();
      return solve_pressing(hinted, pressing);
    }
  });
  result.wall_s = watch.seconds();
  result.cpu_s = watch.cpu_seconds();
  result.peak_memory_MB = peak_memory_MB();
  return result;
}

}  // namespace softfinger::fem
