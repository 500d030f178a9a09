// Ten thousand calibrations whose answers are known: how often the 95 % intervals contain them, and
// what a calibration costs.
//   calibration_bench [sets = 10000]
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "tests/analytic/synthetic_measurements.h"

using namespace softfinger;

namespace {

struct Count {
  int determined = 0, covered = 0, undetermined = 0, undetermined_covered = 0, below = 0;
};

void print(const std::string& name, const Count& count) {
  fmt::print("  {:<22} {:>7} {:>9.1f} % {:>8.1f} % {:>9} {:>9.1f} %\n", name, count.determined,
             100. * count.covered / std::max(1, count.determined),
             100. * count.below / std::max(1, count.determined), count.undetermined,
             100. * count.undetermined_covered / std::max(1, count.undetermined));
}

}  // namespace

int main(int arguments, char** argument) {
  const int sets = arguments > 1 ? std::atoi(argument[1]) : 10000;
  std::array<Count, kParameters> by_parameter{};
  std::array<Count, 3> by_noise{}, with_outliers{};
  int named = 0, missed = 0, wrongly_named = 0, clean = 0, failed = 0;
  std::vector<double> times_ms;
  for (int set = 0; set < sets; ++set) {
    const test::SyntheticCalibration synthetic = test::random_calibration(unsigned(set));
    const std::clock_t start = std::clock();
    Calibration found;
    try {
      found = calibrate(synthetic.problem);
    } catch (const std::exception& error) {
      ++failed;
      fmt::print("set {}: {}\n", set, error.what());
      continue;
    }
    times_ms.push_back(1e3 * double(std::clock() - start) / CLOCKS_PER_SEC);
    for (const ParameterEstimate& estimate : found.parameters) {
      const double truth = synthetic.truth[std::size_t(estimate.parameter)];
      const bool covered = estimate.low <= truth && truth <= estimate.high;
      const auto add = [&](Count& count) {
        ++(estimate.is_determined() ? count.determined : count.undetermined);
        (estimate.is_determined() ? count.covered : count.undetermined_covered) += covered;
        count.below += estimate.is_determined() && truth < estimate.low;
      };
      add(by_parameter[std::size_t(estimate.parameter)]);
      const std::size_t noise = synthetic.noise < 0.02 ? 0 : synthetic.noise < 0.05 ? 1 : 2;
      add((synthetic.outliers > 0 ? with_outliers : by_noise)[noise]);
    }
    if (synthetic.outliers == 0) {
      ++clean;
      wrongly_named += !found.outliers.empty();
    } else {
      named += int(found.outliers.size());
      missed += synthetic.outliers;
    }
  }
  fmt::print("{} sets, {} failed\n  {:<22} {:>7} {:>11} {:>10} {:>9} {:>11}\n", sets, failed, "",
             "determ.", "covered", "truth below", "not det.", "covered");
  for (const ParameterRange& range : kParameterRanges) {
    const Count& count = by_parameter[std::size_t(range.parameter)];
    if (count.determined + count.undetermined > 0) print(std::string(range.name), count);
  }
  print("noise 1 %", by_noise[0]);
  print("noise 3 %", by_noise[1]);
  print("noise 10 %", by_noise[2]);
  print("1 %, with outliers", with_outliers[0]);
  print("3 %, with outliers", with_outliers[1]);
  print("10 %, with outliers", with_outliers[2]);
  fmt::print("outliers: {} named of {} there; good points named in {} of {} clean sets\n", named,
             missed, wrongly_named, clean);
  std::sort(times_ms.begin(), times_ms.end());
  if (!times_ms.empty())
    fmt::print("CPU milliseconds: median {:.1f}, 95 % {:.1f}, largest {:.1f}\n",
               times_ms[times_ms.size() / 2], times_ms[times_ms.size() * 95 / 100],
               times_ms.back());
  return 0;
}
