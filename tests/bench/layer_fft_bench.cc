// Cost of one contact with a bonded layer on a grid of 64, 128 and 256 cells a side: a quadric,
// solved on a quarter of the grid, and the same gap turned and given as a function.
#include <benchmark/benchmark.h>

#include "softfinger/fft/layer_contact.h"

namespace softfinger {
namespace {

const ElasticLayer kLayer{0.003, 2e5, 0.49};
constexpr double kLoad_N = 2;

void quadric(benchmark::State& state) {
  LayerContactOptions options;
  options.cells = static_cast<int>(state.range(0));
  for (auto _ : state)
    benchmark::DoNotOptimize(
        solve_layer_contact(RelativeRadii{0.016, 0.008}, kLayer, {}, kLoad_N, options));
}
BENCHMARK(quadric)->Arg(64)->Arg(128)->Arg(256)->Unit(benchmark::kMillisecond);

void general_gap(benchmark::State& state) {
  LayerContactOptions options;
  options.cells = static_cast<int>(state.range(0));
  const auto gap_m = [](double x, double y) {
    const double u = 0.8 * x + 0.6 * y, v = 0.8 * y - 0.6 * x;
    return u * u / 0.032 + v * v / 0.016;
  };
  for (auto _ : state)
    benchmark::DoNotOptimize(
        solve_layer_contact(gap_m, GapWindow{0, 0, 0.01, 0.01}, kLayer, {}, kLoad_N, options));
}
BENCHMARK(general_gap)->Arg(64)->Arg(128)->Arg(256)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace softfinger

BENCHMARK_MAIN();
