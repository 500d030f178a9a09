// What one answer of the analytic part costs, and what it is worth: every model of the registry on
// a circle, a fingertip and a very long ellipse, with its heap allocations per call and, on
// circles, its relative error against `layer_fredholm`; and the torque from given semi-axes.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <new>
#include <string>

#include "softfinger/friction/max_torque.h"
#include "softfinger/math/elliptic_integrals.h"
#include "softfinger/pressure/pressure_model.h"

namespace {
std::size_t allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return operator new(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace softfinger {
namespace {

/// A silicone fingertip, and a load that makes its contact about as wide as the layer is thick: the
/// middle of the gap between the closed forms.
ContactProblem fingertip(double radii_ratio) {
  ContactProblem problem;
  problem.radii = {0.005 * radii_ratio, 0.005};
  problem.layer = {0.002, 300e3, 0.45};
  problem.load = {1, 0.8};
  problem.options.power_law = {0.002, 0.3, 2.5};
  return problem;
}

void predict(benchmark::State& state, const PressureModel& model, double radii_ratio) {
  ContactProblem problem = fingertip(radii_ratio);
  const Prediction prediction = model.predict(problem);
  if (!prediction.has_answer) {
    state.SkipWithError("no answer here");
    return;
  }
  const std::size_t before = allocations;
  std::size_t calls = 0;
  for (auto _ : state) {
    // Never the same problem twice: slow models keep the last solution.
    problem.load.normal_force_N = 1 + 1e-9 * static_cast<double>(calls % 1000 + 1);
    benchmark::DoNotOptimize(problem);
    benchmark::DoNotOptimize(model.predict(problem));
    ++calls;
  }
  state.counters["allocations"] =
      static_cast<double>(allocations - before) / static_cast<double>(calls);
  const PressureModel* reference = find_pressure_model("layer_fredholm");
  if (!reference || radii_ratio != 1) return;
  const Prediction truth = reference->predict(fingertip(radii_ratio));
  if (!truth.has_answer) return;
  const auto error = [](double value, double true_value) { return value / true_value - 1; };
  state.counters["a_error"] = error(prediction.a_m, truth.a_m);
  state.counters["d_error"] = error(prediction.indentation_m, truth.indentation_m);
  state.counters["torque_error"] = error(prediction.torque_arm_exact_m, truth.torque_arm_exact_m);
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
