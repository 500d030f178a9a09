#pragma once

/// Shore hardness of a soft, incompressible rubber from its Young's modulus, and back. A modulus
/// from a hardness, and a hardness from a modulus, are rough: see kHardnessModulusFactor.
namespace softfinger::experiments {

/// Gent, Rubber Chemistry and Technology 31 (1958): E = 0.0981 (56 + 7.62336 S)/(0.137505 (254 -
/// 2.54 S)) MPa for Shore A. Gent compared it with rubbers of S 20 to 80; below it is an
/// extrapolation. A modulus softer than that of S = 0 has a negative S, which is 0 on the dial.
double modulus_of_shore_a_Pa(double shore_a);
double shore_a_of_modulus(double youngs_modulus_Pa);
constexpr double kLeastTrustedShoreA = 20;

/// A durometer of type OO (ASTM D2240) is a sphere of 1.19 mm radius on a spring of 0.203 + 0.00908
/// H N, which stands out by 2.54 (1 - H/100) mm, so that H follows from Hertz's contact of that
/// sphere on a thick pad: (4/3) E/(1 - nu²) sqrt(R) d^(3/2) = F (in this way Mix and Giacomin, J.
/// Testing and Evaluation 39 (2011), derive all scales). Below H = 50 the sphere sinks in by more
/// than its radius.
double modulus_of_shore_oo_Pa(double shore_oo, double poisson_ratio);
double shore_oo_of_modulus(double youngs_modulus_Pa, double poisson_ratio);

/// The factor by which a modulus of either relation may be wrong, up and down: supposed by us. For
/// scale: lg E = 0.0235 S - 0.6403 (E in MPa), which is used for Shore A as well, is 8 % below
/// Gent's at S = 20 and 18 % above at S = 3; rubbers of one hardness differ among themselves, too.
constexpr double kHardnessModulusFactor = 2;

}  // namespace softfinger::experiments
