#include "fem/program/reference_solver.h"

#include <utility>
#include <variant>

#include "fem/base/formatted.h"
#include "fem/base/memory.h"
#include "fem/base/stopwatch.h"
#include "fem/finite/finite_contact.h"
#include "fem/linear/linear_contact.h"
#include "fem/problem/check_problem.h"

namespace softfinger::fem {
namespace {

/// Solves with a core that the layer bears. If the contact reaches a fold of the layer, it is
/// solved once more with the ridge of the eroded finger as the core's, which more of the layer
/// bears. What that leaves open is stated. Where all cores fold, the refusal is that of the one
/// that bears most.
/// @param solve  with a core
template <class Solve>
Result solve_with_any_core(const Problem& problem, const Progress& progress, const Solve& solve) {
  Outcome<Result, FoldedLayer> answer = solve(CoreWays::smoothed);
  if (answer) return *std::move(answer);
  FoldedLayer folded = answer.reason();
  if (problem.fingertip.core) throw folded.refusal;
  for (const CoreWays ways : {CoreWays::eroded, CoreWays::eroded_nearer}) {
    progress(std::string(folded.refusal.what()) + "; once more on the core that has a ridge there");
    try {
      answer = solve(ways);
    } catch (const ConvergenceError& failure) {
      // Newton's method stops on this core: the fold's refusal tells more.
      progress(failure.what());
      break;
    }
    if (answer) return *std::move(answer);
    // One that names no load is less than any.
    if (answer.reason().fits > folded.fits) folded = answer.reason();
  }
  throw folded.refusal;
}

/// Solves a contact in the units of its layer; with friction in coordinates that begin where the
/// pressure's centre is.
/// @param solve_pressing  the problem, posed in given coordinates
template <class SolvePressing>
Outcome<Result, FoldedLayer> solve_about_centre(const Problem& problem, Pressing pressing,
                                                const Progress& progress, const StopRequested& stop,
                                                const SolvePressing& solve_pressing) {
  Outcome<Result, Unsolved> answer = solve_pressing(problem, pressing);
  if (!answer)
    if (const auto* found = std::get_if<OffCentre>(&answer.reason())) {
      if (stop()) throw Interrupted();
      const Eigen::Vector2d at_mm = 1e3 * pressing.thickness_m * found->centre;
      progress(
          formatted("friction: about the pressure's centre, x %.3g, y %.3g mm from the first "
                    "touch; once more in coordinates that begin there",
                    at_mm.x(), at_mm.y()));
      pressing.bent = pressing.bent.seen_from(found->centre);
      Problem hinted = problem;
      hinted.size_hint_m = found->size_m;
      answer = solve_pressing(hinted, pressing);
    }
  if (answer) return *std::move(answer);
  return std::get<FoldedLayer>(answer.reason());
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
    return solve_about_centre(problem, pressing_of(problem, ways), progress, stop, solve_pressing);
  });
  result.wall_s = watch.seconds();
  result.cpu_s = watch.cpu_seconds();
  result.peak_memory_MB = peak_memory_MB();
  return result;
}

}  // namespace softfinger::fem
