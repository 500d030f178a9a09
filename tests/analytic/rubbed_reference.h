#pragma once

#include <array>
#include <limits>

/// Independent solutions of a rigid paraboloid pressed with friction on a bonded layer.
namespace softfinger {

/// Units h = E* = R = 1. At the load P with which the frictionless contact has the size s.
struct RubbedReference {
  double nu, s, mu;
  double load, a, indentation, peak, arm;
};
constexpr double kAllSticks = std::numeric_limits<double>::infinity();

/// The layer's exact compliance in Hankel transforms, Coulomb's law in increments: without
/// friction against the integral equation 1e-4, without slip against ln(3 - 4 nu) on the half-space
/// 2e-4, halved increments 6e-4 at most.
constexpr std::array<RubbedReference, 15> kRubbedReferences{{
    {0.3, 0.5, 0.1, 0.175282, 0.497184, 0.189073, 0.357996, 0.29063},
    {0.3, 0.5, 0.3, 0.175282, 0.494258, 0.188499, 0.357036, 0.288573},
    {0.3, 0.5, kAllSticks, 0.175282, 0.493482, 0.188402, 0.356872, 0.288381},
    {0.3, 1.0, 0.3, 1.67866, 0.993847, 0.646635, 0.855309, 0.578834},
    {0.3, 3.0, 0.3, 92.3901, 2.99447, 4.92305, 5.92069, 1.67539},
    {0.45, 0.5, 0.3, 0.178134, 0.499905, 0.179937, 0.342312, 0.294164},
    {0.45, 1.0, 0.1, 1.8018, 0.999142, 0.590898, 0.904292, 0.582076},
    {0.45, 3.0, 0.1, 124.015, 2.96298, 4.2469, 8.86229, 1.61576},
    {0.45, 3.0, kAllSticks, 124.015, 2.93265, 4.17252, 9.11916, 1.59513},
    {0.49, 0.5, 0.3, 0.179435, 0.499984, 0.175061, 0.344335, 0.294203},
    {0.49, 1.0, 0.1, 1.86229, 0.99675, 0.56118, 0.947808, 0.578992},
    {0.49, 1.0, kAllSticks, 1.86229, 0.994636, 0.556418, 0.954476, 0.577557},
    {0.49, 3.0, 0.1, 147.977, 2.93888, 3.70526, 11.3352, 1.58027},
    {0.49, 3.0, 0.3, 147.977, 2.84792, 3.48403, 12.4815, 1.51378},
    {0.49, 3.0, kAllSticks, 147.977, 2.83021, 3.42821, 12.5259, 1.50671},
}};

/// A rigid sphere of R = 5 h on a neo-Hookean layer of nu = 0.49 that sticks, units h = E* = 1, at
/// the load P with which the frictionless contact has its arm: an independent axisymmetric
/// solution, whose work is its energy to 1.3e-4.
struct StuckAtFiniteStrain {
  double load, a, indentation, arm, frictionless_arm;
};
constexpr std::array<StuckAtFiniteStrain, 3> kStuckAtFiniteStrain{{
    {0.283169, 0.91369, 0.097405, 0.524409, 0.54316},
    {2.08887, 1.49959, 0.229188, 0.813085, 0.910752},
    {6.23923, 1.89956, 0.350662, 0.992981, 1.18119},
}};

}  // namespace softfinger
