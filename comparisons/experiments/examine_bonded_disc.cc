#include <fmt/format.h>

#include <algorithm>

#include "comparisons/experiments/examine.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pads/pad_model.h"
#include "softfinger/pads/pad_shape.h"

namespace softfinger::experiments {
namespace {

/// Stress per extension below the knee, by least squares with a zero of its own.
double slope_Pa(const BondedDisc& disc) {
  double count = 0, mean_x = 0, mean_y = 0;
  const auto each = [&](auto add) {
    for (std::size_t i = 0; i < disc.extension.size(); ++i)
      if (disc.extension[i] < disc.knee_extension) add(disc.extension[i], disc.stress_Pa[i]);
  };
  each([&](double x, double y) {
    ++count;
    mean_x += x;
    mean_y += y;
  });
  mean_x /= count;
  mean_y /= count;
  double xx = 0, xy = 0;
  each([&](double x, double y) {
    xx += (x - mean_x) * (x - mean_x);
    xy += (x - mean_x) * (y - mean_y);
  });
  return xy / xx;
}

}  // namespace

void examine_bonded_disc(const BondedDisc& disc, Examined& examined) {
  const double area_m2 = kPi / 4 * disc.diameter_m * disc.diameter_m;
  const double whole_N_per_m = slope_Pa(disc) * area_m2 / disc.thickness_m;
  // Machine and disc give one after the other.
  const double alone_N_per_m = 1 / (1 / whole_N_per_m - 1 / disc.machine_N_per_m);
  const PadShape shape(ConvexOutline::disc(disc.diameter_m));
  const auto modulus_Pa = [&](double stiffness_N_per_m, double nu) {
    // Stiffness is in proportion to E. Linear theory draws as it presses.
    constexpr double kUnit_Pa = 1e6;
    PadProblem problem;
    problem.shape = &shape;
    problem.layer = {disc.thickness_m, kUnit_Pa, nu};
    problem.load.normal_force_N = 1;
    problem.pressing = PadPressing::stuck;
    const PadPrediction answer = find_pad_model("pad_layer")->predict(problem);
    if (!answer.has_answer)
      throw InputError("[bonded_disc]", "disc", "", "a disc that pad_layer has an answer for");
    return kUnit_Pa * stiffness_N_per_m / answer.normal_stiffness_N_per_m;
  };
  const auto infer = [&](const char* reading, double stiffness_N_per_m) {
    if (!(stiffness_N_per_m > 0)) return;
    double low = INFINITY, high = 0;
    for (const double nu : disc.poisson_ratios) {
      low = std::min(low, modulus_Pa(stiffness_N_per_m, nu));
      high = std::max(high, modulus_Pa(stiffness_N_per_m, nu));
    }
    examined.inferred.push_back(
        {"youngs_modulus",
         "Pa",
         "of the stiffness below the knee",
         {modulus_Pa(stiffness_N_per_m, disc.poisson_ratios.front()), low, high},
         reading});
  };
  infer("machine's give is in the extension", alone_N_per_m);
  infer("extension is the rubber's", whole_N_per_m);
  examined.sentence = fmt::format(
      "{:.3g} N/mm below the knee with the machine of {:.3g} N/mm{}; the rubber's modulus is not "
      "known, so that only it can be inferred.",
      1e-3 * whole_N_per_m, 1e-3 * disc.machine_N_per_m,
      alone_N_per_m > 0 ? fmt::format(", {:.3g} N/mm without", 1e-3 * alone_N_per_m) : "");
}

}  // namespace softfinger::experiments
