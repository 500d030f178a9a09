#pragma once

#include <cmath>

#include "softfinger/input/contact_problem.h"
#include "softfinger/layer/stuck_stiffness.h"

namespace softfinger::exporting {

/// Ratio of neighbouring loads in central differences in ln P: large against the unevenness of the
/// models' tables and small enough for a local exponent.
constexpr double kLoadStep = 1.1;

/// dP/dd = P/(n d), n the exponent of d in P. Exact for a power law, unlike a difference of P over
/// one of d.
/// @param indentation_m   at the load
/// @param below_m, above_m  the same at the load over and times kLoadStep
inline double normal_stiffness_N_per_m(double load_N, double indentation_m, double below_m,
                                       double above_m) {
  const double exponent = std::log(above_m / below_m) / (2 * std::log(kLoadStep));
  return load_N / (exponent * indentation_m);
}

/// Torque per rotation about the normal of the stuck contact, by `stuck_stiffness` on its ellipse;
/// 0 for several sublayers or two layers, where it is not known.
inline double torsional_stiffness_Nm_per_rad(const ContactProblem& problem, double a_m,
                                             double b_m) {
  if (problem.finger_layers().count > 1 || problem.has_object_layer()) return 0;
  const ElasticLayer& layer = problem.layer;
  return stuck_stiffness(a_m, b_m, layer.thickness_m, layer.youngs_modulus_Pa, layer.poisson_ratio)
      .torsional_Nm_per_rad;
}

}  // namespace softfinger::exporting
