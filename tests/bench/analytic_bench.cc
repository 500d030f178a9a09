// What one answer of the analytic part costs, and what it is worth: every model of the registry on
// a circle, a fingertip and a very long ellipse, with its heap allocations per call and, on
// circles, its relative error against `layer_fredholm`; the torque from given semi-axes; and a fit
// of 200 points, with its error and the standard deviation that it states.
#include <benchmark/benchmark.h>

#include <random>
#include <string>

#include "softfinger/friction/max_torque.h"
#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/math/elliptic_integrals.h"
#include "softfinger/pressure/pressure_model.h"
#include "tests/allocation_counter.h"
#include "tests/geometry/random_quadrics.h"

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
  const std::size_t before = testing::allocations();
  std::size_t calls = 0;
  for (auto _ : state) {
    // Never the same problem twice: slow models keep the last solution.
    problem.load.normal_force_N = 1 + 1e-9 * static_cast<double>(calls % 1000 + 1);
    benchmark::DoNotOptimize(problem);
    benchmark::DoNotOptimize(model.predict(problem));
    ++calls;
  }
  state.counters["allocations"] =
      static_cast<double>(testing::allocations() - before) / static_cast<double>(calls);
  const PressureModel* reference = find_pressure_model("layer_fredholm");
  if (!reference || radii_ratio != 1) return;
  const Prediction truth = reference->predict(fingertip(radii_ratio));
  if (!truth.has_answer) return;
  const auto error = [](double value, double true_value) { return value / true_value - 1; };
  state.counters["a_error"] = error(prediction.a_m, truth.a_m);
  state.counters["d_error"] = error(prediction.indentation_m, truth.indentation_m);
  state.counters["torque_error"] = error(prediction.torque_arm_exact_m, truth.torque_arm_exact_m);
}

/// A noisy quadric of about 200 points, as a mesh around the contact point gives them.
void fit(benchmark::State& state) {
  std::mt19937 random(1);
  samples::RandomQuadricOptions options;
  options.fewest_points = options.most_points = 200;
  const samples::RandomQuadric quadric = samples::random_quadric(random, options);
  const Eigen::Vector3d up(0, 0, 1);
  QuadricFit result;
  for (auto _ : state)
    benchmark::DoNotOptimize(result = fit_quadric(quadric.surface, Eigen::Vector3d::Zero(), &up,
                                                  quadric.region_radius_m));
  state.counters["radius_error"] = result.principal.radii_m[1] / quadric.radii_m[1] - 1;
  state.counters["radius_std"] = result.radii_std_m[1] / quadric.radii_m[1];
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
    for (const double ratio : {1.0, 4.0, 100.0, 1e4})
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
  benchmark::RegisterBenchmark("fit_quadric/points:200", fit);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
