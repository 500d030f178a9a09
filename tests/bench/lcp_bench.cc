// Microseconds per contact problem, cold, over 64 random scenes each; beside it the worst residual,
// the mean number of pivots and how many of the scenes needed a second covering vector.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

void contacts(benchmark::State& state) {
  constexpr int kScenes = 64;
  const int count = int(state.range(0)), vertices = int(state.range(1));
  tests::RandomScenes scenes(100);
  std::vector<ContactLcp> problems;
  // Scenes where all contacts separate cost nothing: they are left out.
  while (problems.size() < kScenes) {
    problems.push_back(scenes.next(count, vertices));
    double least = 0;
    for (int i = 0; i < count; ++i) least = std::min(least, problems.back().free_velocity[4 * i]);
    if (least >= 0) problems.pop_back();
  }
  ContactLcpSolver solver(count, vertices);
  ContactSolution solution;
  solution.resize(count);
  double worst = 0, pivots = 0;
  int again = 0, failures = 0;
  for (const ContactLcp& problem : problems) {
    const LcpResult result = solver.solve(problem, solution);
    failures += result.status != LcpStatus::solved;
    worst = std::max(worst, result.residual);
    pivots += result.pivots;
    again += result.attempts > 1;
  }
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(solver.solve(problems[i++ % kScenes], solution));
  state.counters["residual"] = worst;
  state.counters["pivots"] = pivots / kScenes;
  state.counters["second_attempts"] = again;
  state.counters["failures"] = failures;
}

BENCHMARK(contacts)
    ->ArgNames({"contacts", "u"})
    ->ArgsProduct({{1, 4, 5, 10, 20}, {16, 32, 128}})
    ->Args({100, 16})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace softfinger

BENCHMARK_MAIN();
