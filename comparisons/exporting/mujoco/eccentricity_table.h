#pragma once

#include <vector>

#include "softfinger/input/contact_problem.h"

namespace softfinger::exporting {

/// e_n(P) of `fingertip_layer`, tabulated for a simulator's inner loop: straight lines in ln P and
/// ln e_n. With the load in units of E* h³/R, R = sqrt(R'R''), it reaches from 1e-6 to 1e4, from
/// Hertz' contact to one far larger than the layer is thick; beyond it e_n is constant.
/// Relative error against the model: at most 1e-4 (see the test). Cost: about 30 ns.
class EccentricityTable {
 public:
  /// @param problem  radii, layer, the finger's curvature; its load does not count
  explicit EccentricityTable(const ContactProblem& problem);

  /// False where the model has no answer for this contact.
  bool has_answer() const { return !log_eccentricity_.empty(); }

  /// The eccentricity in m. @param load_N  >= 0
  double at(double load_N) const;

 private:
  double log_first_load_ = 0;
  std::vector<double> log_eccentricity_;
};

}  // namespace softfinger::exporting
