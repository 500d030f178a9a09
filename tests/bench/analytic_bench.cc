// What one answer of the analytic part costs: every model of the registry on a circle, a fingertip
// and a very long ellipse, and the torque from given semi-axes.
#include <benchmark/benchmark.h>

#include <string>

#include "softfinger/friction/max_torque.h"
#include "softfinger/math/elliptic_integrals.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

void predict(benchmark::State& state, const PressureModel& model, double radii_ratio) {
  ContactProblem problem;
  problem.radii = {0.005 * radii_ratio, 0.005};
  problem.layer = {0.002, 300e3, 0.45};
  problem.load = {1, 0.8};
  for (auto _ : state) {
    benchmark::DoNotOptimize(problem);
    benchmark::DoNotOptimize(model.predict(problem));
  }
}

void torque_arm_exact(benchmark::State& state, double aspect, double exponent) {
  double a_m = 0.001 * aspect, b_m = 0.001;
  for (auto _ : state) {
    benchmark::DoNotOptimize(a_m);
    benchmark::DoNotOptimize(b_m);
    benchmark::DoNotOptimize(torque_arm_exact_m(a_m, b_m, exponent));
  }
}

void integrals(benchmark::State& state, double q) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(q);
    benchmark::DoNotOptimize(elliptic_integrals(q));
  }
}

}  // namespace
}  // namespace softfinger

int main(int argc, char** argv) {
  using namespace softfinger;
  for (const PressureModel* model : all_pressure_models())
    for (const double ratio : {1.0, 4.0, 1e4})
      benchmark::RegisterBenchmark(
          ("predict/" + std::string(model->card().name) + "/ratio:" + std::to_string(int(ratio)))
              .c_str(),
          [model, ratio](benchmark::State& state) { predict(state, *model, ratio); });
  for (const double exponent : {0.5, 0.7})
    for (const double aspect : {1.0, 2.0, 1e4})
      benchmark::RegisterBenchmark(
          ("torque_arm_exact/n:" + std::to_string(exponent) +
           "/aspect:" + std::to_string(int(aspect)))
              .c_str(),
          [=](benchmark::State& state) { torque_arm_exact(state, aspect, exponent); });
  for (const double q : {1.0, 0.25, 1e-8})
    benchmark::RegisterBenchmark(("elliptic_integrals/q:" + std::to_string(q)).c_str(),
                                 [=](benchmark::State& state) { integrals(state, q); });
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
