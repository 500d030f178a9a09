#pragma once

#include "fem/finite/finite_pressing.h"

namespace softfinger::tests {

/// Work of the indenter over four small steps from `start`, over the strain energy that it adds,
/// less one. On one mesh the discrete energy's derivative by the approach is the discrete load,
/// whatever the mesh. The load has kinks where nodes begin to touch, which Boole's rule misses:
/// with jumps of its slope of a tenth, by step/(320 d) at most each.
struct EnergyBalance {
  double departure, kinks;
};

inline EnergyBalance energy_balance(fem::finite::FinitePressing& pressing, double start) {
  double energy[5], load[5];
  constexpr double step = 1e-3;
  for (int i = 0; i < 5; ++i) {
    pressing.press({0, start + i * step});
    energy[i] = pressing.equilibrium().energy;
    load[i] = pressing.equilibrium().load;
  }
  const double work =
      2 * step / 45 * (7 * load[0] + 32 * load[1] + 12 * load[2] + 32 * load[3] + 7 * load[4]);
  return {work / (energy[4] - energy[0]) - 1, step / (320 * start)};
}

}  // namespace softfinger::tests
