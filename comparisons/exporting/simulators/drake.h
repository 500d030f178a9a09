#pragma once

#include <array>

#include "comparisons/exporting/simulator.h"
#include "softfinger/input/contact_problem.h"

namespace softfinger::exporting {

/// An elastic foundation, pressure = stiffness times depth, under a load.
struct Foundation {
  double stiffness_Pa_per_m = 0;
  double indentation_m = 0;
  double a_m = 0, b_m = 0;  ///< semi-axes of its contact

  double eccentricity_m() const;
  /// dP/dd = 2 P/d.
  double normal_stiffness_N_per_m() const;
};

/// The foundation whose contact with the gap x²/(2R') + y²/(2R'') has this e_n at this load. With
/// the approach d, its semi-axes are a = sqrt(2 d R') and b = sqrt(2 d R''), the load is P = pi
/// stiffness sqrt(R'R'') d², and e_n is that of the pressure 1 - x²/a² - y²/b²: (11) to (13) of
/// Ciocarlie et al. 2007. It grows as P^(1/4).
Foundation foundation_with_eccentricity(const RelativeRadii& radii, double load_N,
                                        double eccentricity_m);

/// The one that has this approach at this load.
Foundation foundation_with_indentation(const RelativeRadii& radii, double load_N,
                                       double indentation_m);

/// A flat pad as an elastic foundation, whose pressure under a flat face is uniform. A pad presses
/// harder in its middle: a smaller box has its torque.
struct PressedBox {
  std::array<double, 2> half_lengths_m{};
  double stiffness_Pa_per_m = 0;  ///< that gives the box the pad's dP/dd
};

inline PressedBox pressed_box(const SoftContact& contact) {
  PressedBox box;
  box.half_lengths_m = contact.face->pressed_box_m();
  const auto [x_m, y_m] = box.half_lengths_m;
  box.stiffness_Pa_per_m = contact.normal_stiffness_N_per_m / (4 * x_m * y_m);
  return box;
}

}  // namespace softfinger::exporting
