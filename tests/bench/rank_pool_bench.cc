// Cost of handing out a task: mpirun -np N rank_pool_bench, for tasks of no and of 10 ms length.

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <numeric>

#include "comparisons/distributed/rank_pool.h"

int main(int argument_count, char** arguments) {
  using namespace softfinger;
  const distributed::MpiSession mpi(argument_count, arguments);
  constexpr long kLong_us = 10000;
  // A task's number says how long it takes.
  const distributed::RankTask work = [](long task) {
    if (task % 2 == 1) usleep(kLong_us);
    return std::string();
  };
  if (mpi.rank() != 0) {
    distributed::serve_tasks(work);
    return 0;
  }
  distributed::RankPool pool(work);
  for (const bool is_long : {false, true}) {
    const std::size_t count = is_long ? 100 * static_cast<std::size_t>(mpi.size()) : 20000;
    const std::vector<long> tasks(count, is_long ? 1 : 0);
    const auto start = std::chrono::steady_clock::now();
    pool.run(tasks, [](long, const std::string&) {});
    const double wall_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (is_long)
      std::printf("tasks of 10 ms: %.2f ms each, with %d ranks\n",
                  1e3 * wall_s / double(count) * mpi.size(), mpi.size());
    else
      std::printf("empty tasks: %.1f us each, with %d ranks\n", 1e6 * wall_s / double(count),
                  mpi.size());
  }
}
