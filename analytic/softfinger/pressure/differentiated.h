#pragma once

#include "softfinger/input/contact_problem.h"
#include "softfinger/layer/contact_numbers.h"

/// The derivatives that a model's answer carries.
namespace softfinger {

/// Numbers of a contact problem that answers change smoothly with. The largest torque is the
/// friction coefficient times load and torque arm, which needs no derivative of a model.
enum ContactVariable {
  kNormalForce,        ///< P in N
  kPoissonRatio,       ///< nu; at 1/2 the derivative from below
  kThickness,          ///< h in m
  kRadiusMajor,        ///< R' in m, with the finger's curvature kept
  kRadiusMinor,        ///< R'' in m, likewise; at R' = R'' of a longer R' and a shorter R''
  kFingerCurvatureX,   ///< of the finger along x in 1/m, with R', R'' kept
  kFingerCurvatureY,   ///< along y
  kFingerCurvatureXY,  ///< its twist
  kYoungsModulus,      ///< E in Pa
  kContactVariables
};
/// Derivatives are carried with respect to all but E: that one follows from the load's.
using DifferentiatedNumber = Dual<kYoungsModulus>;
using DifferentiatedInput = ContactInputOf<DifferentiatedNumber>;

struct DifferentiatedContact {
  ContactNumbersOf<DifferentiatedNumber> numbers;
  /// Whether the contact is elastic: its lengths depend on P/E, so that
  /// E d/dE = -P d/dP. Otherwise E does not matter.
  bool is_elastic = true;
};

inline DifferentiatedInput differentiated_input(const ContactProblem& problem) noexcept {
  const auto variable = [](double value, ContactVariable which) {
    return DifferentiatedNumber::variable(value, which);
  };
  const SurfaceCurvature& finger = problem.finger_curvature;
  return {variable(problem.load.normal_force_N, kNormalForce),
          problem.layer.youngs_modulus_Pa,
          variable(problem.layer.poisson_ratio, kPoissonRatio),
          variable(problem.layer.thickness_m, kThickness),
          variable(problem.radii.major_m, kRadiusMajor),
          variable(problem.radii.minor_m, kRadiusMinor),
          variable(finger.xx_per_m, kFingerCurvatureX),
          variable(finger.yy_per_m, kFingerCurvatureY),
          variable(finger.xy_per_m, kFingerCurvatureXY)};
}

}  // namespace softfinger
