// Cost and accuracy of one answer of the analytic part: every model of the registry on
// a circle, a fingertip and a very long ellipse, with its heap allocations per call and, on the
// first two, its relative errors; `bonded_layer` all over its table and at its edges; the torque
// from given semi-axes; derivatives and batches; the stiffness of a stuck contact; and a fit of 200
// points, with its error and the standard deviation that it states.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "softfinger/accuracy/error_bound.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/layer/stuck_stiffness.h"
#include "softfinger/math/elliptic_integrals.h"
#include "softfinger/pressure/gradient.h"
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
  // The finger has half of the gap's curvature.
  problem.finger_curvature = {0.5 / problem.radii.major_m, 0.5 / problem.radii.minor_m, 0};
  return problem;
}

struct Truth {
  double a_m, b_m, indentation_m, torque_arm_m;
};

/// Exact answers for the fingertips above.
std::optional<Truth> exact_contact(double radii_ratio) {
  if (radii_ratio == 1) {
    const PressureModel* reference = find_pressure_model("layer_fredholm");
    if (!reference) return std::nullopt;
    const Prediction truth = reference->predict(fingertip(radii_ratio));
    if (!truth.has_answer) return std::nullopt;
    return Truth{truth.a_m, truth.b_m, truth.indentation_m, truth.torque_arm_exact_m};
  }
  // elliptic_layer_contact_at_load(P R/(E* h³) = 3.322916667, 4, LayerKernel(0.45), ..) to a
  // residual of 1e-10, R = 10 mm, h = 2 mm: a spectral solution, which agrees with published ones
  // of its kind within 2e-6 (at nu = 0.45, R'/R'' = 10).
  if (radii_ratio == 4)
    return Truth{3.426448513e-3, 1.599617717e-3, 3.193807599e-4, 1.492302328e-3};
  return std::nullopt;
}

void predict_differentiated(benchmark::State& state, const PressureModel& model) {
  ContactProblem problem = fingertip(4);
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(problem);
    benchmark::DoNotOptimize(predict_with_gradient(model, problem));
  }
}

/// Items per second are contacts.
void predict_many(benchmark::State& state, const PressureModel& model, bool is_rubbed) {
  constexpr std::size_t kCount = 4096;
  const ContactProblem problem = fingertip(4);
  const auto all = [](double value) { return std::vector<double>(kCount, value); };
  std::vector<double> loads_N(kCount);
  for (std::size_t i = 0; i < kCount; ++i) loads_N[i] = 0.1 + 1e-3 * double(i);
  const auto moduli_Pa = all(problem.layer.youngs_modulus_Pa);
  const auto ratios = all(problem.layer.poisson_ratio);
  const auto thicknesses_m = all(problem.layer.thickness_m);
  const auto majors_m = all(problem.radii.major_m), minors_m = all(problem.radii.minor_m);
  const auto xx = all(problem.finger_curvature.xx_per_m);
  const auto yy = all(problem.finger_curvature.yy_per_m), xy = all(0);
  ContactBatch batch;
  batch.count = kCount;
  batch.normal_force_N = loads_N.data();
  batch.youngs_modulus_Pa = moduli_Pa.data();
  batch.poisson_ratio = ratios.data();
  batch.thickness_m = thicknesses_m.data();
  batch.radius_major_m = majors_m.data();
  batch.radius_minor_m = minors_m.data();
  batch.finger_xx_per_m = xx.data();
  batch.finger_yy_per_m = yy.data();
  batch.finger_xy_per_m = xy.data();
  batch.options = problem.options;
  const std::vector<double> mu(kCount, 0.8);
  if (is_rubbed) batch.pressing_friction_coefficient = mu.data();
  std::array<std::vector<double>, 6> out;
  for (std::vector<double>& one : out) one.resize(kCount);
  const PredictionBatch found = {out[0].data(), out[1].data(), out[2].data(),
                                 out[3].data(), out[4].data(), out[5].data()};
  for ([[maybe_unused]] auto _ : state) {
    predict_batch(model, batch, found);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(std::int64_t(state.iterations()) * std::int64_t(kCount));
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
  const std::optional<Truth> truth = exact_contact(radii_ratio);
  if (!truth) return;
  state.counters["a_error"] = prediction.a_m / truth->a_m - 1;
  state.counters["b_error"] = prediction.b_m / truth->b_m - 1;
  state.counters["d_error"] = prediction.indentation_m / truth->indentation_m - 1;
  state.counters["torque_error"] = prediction.torque_arm_exact_m / truth->torque_arm_m - 1;
}

/// `bonded_layer` where its contact has about that size: the largest of these times is what an
/// evaluation costs at most.
void predict_bonded(benchmark::State& state, double size, double poisson_ratio,
                    double radii_ratio) {
  const PressureModel& model = *find_pressure_model("bonded_layer");
  ContactProblem problem;
  problem.radii = {std::sqrt(radii_ratio), 1 / std::sqrt(radii_ratio)};
  problem.layer = {1, 1, poisson_ratio};
  double low = -100, high = 100;  // of ln P
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    problem.load = {std::exp(middle), 1};
    const Prediction prediction = model.predict(problem);
    (prediction.a_m * prediction.b_m < size * size ? low : high) = middle;
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(problem);
    benchmark::DoNotOptimize(model.predict(problem));
  }
}

/// Sublayers of equal thickness that become firmer towards the base.
void predict_stack(benchmark::State& state, std::size_t count, double ratio) {
  const PressureModel& model = *find_pressure_model("stack_layer");
  ContactProblem problem = fingertip(ratio);
  problem.stack.count = count;
  for (std::size_t i = 0; i < count; ++i)
    problem.stack.sublayers[i] = {problem.layer.thickness_m / double(count), 1e5 * (1 + double(i)),
                                  0.45};
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(problem);
    benchmark::DoNotOptimize(model.predict(problem));
  }
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

void stiffness_of_stuck_contact(benchmark::State& state, double aspect) {
  double a_m = 0.001 * aspect, b_m = 0.001, thickness_m = 0.002, youngs_modulus_Pa = 3e5,
         poisson_ratio = 0.45;
  for (auto _ : state) {
    benchmark::DoNotOptimize(a_m);
    benchmark::DoNotOptimize(b_m);
    benchmark::DoNotOptimize(thickness_m);
    benchmark::DoNotOptimize(
        stuck_stiffness(a_m, b_m, thickness_m, youngs_modulus_Pa, poisson_ratio));
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
  for (const double size : {0.005, 0.0101, 1.0, 99.0, 1000.0})
    for (const double poisson_ratio : {0.0, 0.3, 0.49, 0.5})
      for (const double ratio : {1.0, 4.0, 99.9, 1e4}) {
        char name[80];
        std::snprintf(name, sizeof name, "bonded_layer/s:%g/nu:%g/ratio:%g", size, poisson_ratio,
                      ratio);
        benchmark::RegisterBenchmark(name, [=](benchmark::State& state) {
          predict_bonded(state, size, poisson_ratio, ratio);
        });
      }
  for (const std::size_t count : {2, 5, 8})
    for (const double ratio : {1.0, 4.0})
      benchmark::RegisterBenchmark(
          ("stack_layer/sublayers:" + std::to_string(count) +
           "/ratio:" + std::to_string(int(ratio)))
              .c_str(),
          [=](benchmark::State& state) { predict_stack(state, count, ratio); });
  for (const double exponent : {0.5, 0.7})
    for (const double aspect : {1.0, 2.0, 1e4})
      benchmark::RegisterBenchmark(
          ("torque_arm_exact/n:" + std::to_string(exponent) +
           "/aspect:" + std::to_string(int(aspect)))
              .c_str(),
          [=](benchmark::State& state) { torque_arm_exact(state, aspect, exponent); });
  for (const double aspect : {1.0, 2.0, 20.0})
    benchmark::RegisterBenchmark(
        ("stuck_stiffness/aspect:" + std::to_string(int(aspect))).c_str(),
        [=](benchmark::State& state) { stiffness_of_stuck_contact(state, aspect); });
  for (const double q : {1.0, 0.25, 1e-8})
    benchmark::RegisterBenchmark(("elliptic_integrals/q:" + std::to_string(q)).c_str(),
                                 [=](benchmark::State& state) { integrals(state, q); });
  for (const char* name : {"hertz", "bonded_layer"})
    benchmark::RegisterBenchmark(("error_bound/" + std::string(name)).c_str(),
                                 [name](benchmark::State& state) {
                                   const PressureModel& model = *find_pressure_model(name);
                                   const ContactProblem problem = fingertip(4);
                                   for ([[maybe_unused]] auto _ : state)
                                     benchmark::DoNotOptimize(error_bound(model, problem));
                                 });
  for (const PressureModel* model : all_pressure_models()) {
    if (!model->card().hot_path) continue;
    const std::string name(model->card().name);
    benchmark::RegisterBenchmark(
        ("predict_with_gradient/" + name).c_str(),
        [model](benchmark::State& state) { predict_differentiated(state, *model); });
    benchmark::RegisterBenchmark(
        ("predict_batch/" + name).c_str(),
        [model](benchmark::State& state) { predict_many(state, *model, /*is_rubbed=*/false); });
    benchmark::RegisterBenchmark(
        ("predict_batch/rubbed/" + name).c_str(),
        [model](benchmark::State& state) { predict_many(state, *model, /*is_rubbed=*/true); });
  }
  benchmark::RegisterBenchmark("fit_quadric/points:200", fit);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
