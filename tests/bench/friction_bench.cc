// Cost of one answer about friction: a point of the exact limit surface, of its six-patch fit and
// of the ellipsoid, utilisation and projection, and the linearisation. Beside each kind of surface,
// its largest error against the exact one in percent, so that speed can be drawn over accuracy.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

#include "softfinger/friction/ellipsoid_deviation.h"
#include "softfinger/friction/linearised_friction.h"
#include "softfinger/friction/six_patch_surface.h"

namespace softfinger {
namespace {

/// Slips spread over the scaled space; a power of two, so that choosing one costs nothing.
constexpr std::size_t kSlips = 1024;
std::vector<Twist> slips(double arm_m) {
  std::vector<Twist> result(kSlips);
  for (std::size_t i = 0; i < kSlips; ++i) {
    const double z = (i + 0.5) / kSlips, heading = 2.39996322972865332 * double(i);
    const double slide = std::sqrt(1 - z * z);
    result[i] = {slide * std::cos(heading), slide * std::sin(heading), z / arm_m};
  }
  return result;
}

template <class Surface>
void wrench(benchmark::State& state, const Surface& surface) {
  const std::vector<Twist> twists = slips(surface.eccentricity_m());
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(surface.wrench_for_twist(twists[i++ % kSlips]));
}

template <class Surface>
void utilisation(benchmark::State& state, const Surface& surface) {
  const std::vector<Twist> twists = slips(surface.eccentricity_m());
  std::vector<LimitWrench> wrenches;
  for (const Twist& t : twists)
    wrenches.push_back(
        {t.velocity_x_m_per_s, t.velocity_y_m_per_s,
         t.angular_velocity_rad_per_s * surface.eccentricity_m() * surface.eccentricity_m()});
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(surface.utilisation(wrenches[i++ % kSlips]));
}

template <class Surface>
void project(benchmark::State& state, const Surface& surface) {
  const double arm = surface.eccentricity_m();
  const std::vector<Twist> twists = slips(arm);
  std::vector<LimitWrench> wrenches;
  for (const Twist& t : twists)
    wrenches.push_back({1.5 * t.velocity_x_m_per_s, 1.5 * t.velocity_y_m_per_s,
                        1.5 * t.angular_velocity_rad_per_s * arm * arm});
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(surface.project(wrenches[i++ % kSlips]));
}

double error_of_patches_percent(const LimitSurface& exact, const SixPatchSurface& patches) {
  double worst = 0;
  for (const Twist& slip : slips(exact.eccentricity_m()))
    worst = std::max(worst, std::abs(patches.support(slip) / exact.support(slip) - 1));
  return 100 * worst;
}

}  // namespace
}  // namespace softfinger

int main(int argc, char** argv) {
  using namespace softfinger;
  using benchmark::RegisterBenchmark;
  for (const double exponent : {0.5, 1.0, 0.7})
    for (const double aspect : {1.0, 2.0, 10.0, 1e4}) {
      const LimitSurface exact(aspect, 1, exponent, 1);
      const SixPatchSurface patches(aspect, 1, exponent, 1);
      const double patch_error = error_of_patches_percent(exact, patches);
      const EllipsoidDeviation deviation = worst_ellipsoid_deviation(exact, exact.ellipsoid());
      const double ellipsoid_error = 100 * std::max(-deviation.lowest, deviation.highest);
      const std::string which =
          "/n:" + std::to_string(exponent).substr(0, 3) + "/aspect:" + std::to_string(int(aspect));
      RegisterBenchmark(("exact_construct" + which).c_str(), [=](benchmark::State& state) {
        double a = aspect;
        for (auto _ : state) {
          benchmark::DoNotOptimize(a);
          benchmark::DoNotOptimize(LimitSurface(a, 1, exponent, 1));
        }
      });
      RegisterBenchmark(("exact_wrench" + which).c_str(),
                        [=](benchmark::State& state) { wrench(state, exact); });
      RegisterBenchmark(("exact_utilisation" + which).c_str(),
                        [=](benchmark::State& state) { utilisation(state, exact); });
      RegisterBenchmark(("exact_project" + which).c_str(),
                        [=](benchmark::State& state) { project(state, exact); });
      RegisterBenchmark(("six_patch_wrench" + which).c_str(), [=](benchmark::State& state) {
        wrench(state, patches);
        state.counters["error_percent"] = patch_error;
      });
      RegisterBenchmark(("six_patch_utilisation" + which).c_str(), [=](benchmark::State& state) {
        utilisation(state, patches);
        state.counters["error_percent"] = patch_error;
      });
      RegisterBenchmark(("ellipsoid_wrench" + which).c_str(), [=](benchmark::State& state) {
        const FrictionEllipsoid ellipsoid = exact.ellipsoid();
        const std::vector<Twist> twists = slips(ellipsoid.eccentricity_m);
        std::size_t i = 0;
        for (auto _ : state)
          benchmark::DoNotOptimize(vertex_for_twist(ellipsoid, twists[i++ % kSlips]));
        state.counters["error_percent"] = ellipsoid_error;
      });
    }
  for (const int count : {6, 12, 20, 64}) {
    const std::string which = "/u:" + std::to_string(count);
    RegisterBenchmark(("linearise_build" + which).c_str(), [=](benchmark::State& state) {
      for (auto _ : state) benchmark::DoNotOptimize(LinearisedFriction(count).inner_bound());
      state.counters["inner_bound"] = LinearisedFriction(count).inner_bound();
    });
    RegisterBenchmark(("linearise_columns" + which).c_str(), [=](benchmark::State& state) {
      const LinearisedFriction friction(count);
      Eigen::Matrix3Xd columns(3, count);
      double arm = 0.001;
      for (auto _ : state) {
        benchmark::DoNotOptimize(arm);
        friction.columns(arm, columns);
        benchmark::DoNotOptimize(columns.data());
        benchmark::ClobberMemory();
      }
    });
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
