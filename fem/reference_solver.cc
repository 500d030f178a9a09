#include "fem/reference_solver.h"

#include "fem/check_problem.h"
#include "fem/finite/finite_contact.h"
#include "fem/linear_contact.h"
#include "fem/memory.h"
#include "fem/stopwatch.h"

namespace softfinger::fem {

Result solve(const Problem& problem, const Progress& progress, const StopRequested& stop,
             ModelCache* cache) {
  check_problem(problem);
  if (stop()) throw Interrupted();
  const Stopwatch watch;
  const Pressing pressing = pressing_of(problem);
  const ContactTask task{problem, pressing, progress, stop};
  ModelCache none(0);
  Result result = problem.finite_strain ? finite::solve_finite(task)
                                        : solve_linear(task, cache ? *cache : none);
  result.wall_s = watch.seconds();
  result.cpu_s = watch.cpu_seconds();
  result.peak_memory_MB = peak_memory_MB();
  return result;
}

}  // namespace softfinger::fem
