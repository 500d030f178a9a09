#pragma once

#include <optional>

/// Growth exponent of a round contact of a bonded layer with its load: gamma = d ln a/d ln P. It
/// depends on s = a/h and Poisson's ratio alone, so a measured exponent determines the thickness
/// without any modulus: 1/3 on a thick layer (Hertz), 1/4 on a thin compressible one (Winkler), 1/6
/// on a thin incompressible one.
namespace softfinger {

/// Quantity whose growth exponent is asked for.
enum class Growing {
  radius,     ///< a
  torque_arm  ///< (int p r dA)/P, slower by some 6 % of gamma, because the pressure changes its
              ///< shape
};

/// gamma at s = a/h by the Fredholm equation (circular_contact.h), to 1e-6. Cost: twice that of
/// `circular_layer_contact`; the other functions ask for it some twenty times. 0 < s <= 100, nu in
/// [0, 1/2].
double layer_growth_exponent(double s, double poisson_ratio, Growing what = Growing::radius);

/// Returns the s = a/h at which a layer has this exponent, the smallest if there are several:
/// between nu = 0.4 and 1/2, gamma falls below 1/4 before it rises to it. Nothing when no layer
/// between s = 0.05 and 20 has it: near 1/3 the layer is too thick for its thickness to matter.
std::optional<double> layer_size_of_exponent(double exponent, double poisson_ratio,
                                             Growing what = Growing::radius);

/// The smallest gamma of s from 0.05 to 20, to some 1e-3.
double smallest_layer_exponent(double poisson_ratio);

/// A layer under a sphere, by its contact's radius at one load.
struct MatchedLayer {
  double thickness_m;        ///< h = a/s
  double youngs_modulus_Pa;  ///< by the load
  double torque_arm_over_a;  ///< (int p r dA)/(P a)
};

/// @param s         a/h, of layer_size_of_exponent
/// @param a_m       the contact's radius at the load
/// @param radius_m  of the sphere, or R = R' = R'' of the gap
MatchedLayer match_layer(double s, double a_m, double normal_force_N, double radius_m,
                         double poisson_ratio);

}  // namespace softfinger
