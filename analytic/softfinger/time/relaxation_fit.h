#pragma once

#include <limits>
#include <vector>

#include "softfinger/time/relaxation.h"

namespace softfinger {

/// A force measured while the approach stands still.
struct HeldForce {
  double time_s = 0;   ///< since the approach stopped, >= 0
  double force_N = 0;  ///< > 0
};

/// One fitted term with its standard deviations.
struct FittedTerm {
  RelaxationTerm term;
  double share_std = 0;
  double log_time_std = 0;  ///< of ln time
};

/// Relaxation from force against time at constant approach.
struct RelaxationFit {
  double force_at_once_N = 0;
  std::vector<FittedTerm> terms;  ///< by falling time; none: the force did not fall beyond chance
  double long_time_modulus = 1, long_time_modulus_std = 0;  ///< E(infinity)/E0
  double scatter_N = 0;  ///< standard deviation of the forces about the fit
  std::vector<double> predicted_N;
  /// Akaike's criterion, corrected for few data, with 0, 1, .. terms; infinite where no such fit
  /// exists. The smallest one was taken.
  std::vector<double> criterion;
};

/// Least squares of F(t) = F0 E(t)/E0 with as many terms, at most three, as Akaike's corrected
/// criterion allows. At constant approach the contact stays, so that the force is in proportion to
/// the modulus, for any shape and any model. The starting values are the best of all combinations
/// of times from a grid of 24, to half the first and twice the last reading; then Levenberg and
/// Marquardt.
///
/// @throws InputError for fewer than six forces, for times that are not finite, >= 0 and
/// different, and for forces that are not finite and > 0
RelaxationFit fit_relaxation(const std::vector<HeldForce>& forces);

}  // namespace softfinger
