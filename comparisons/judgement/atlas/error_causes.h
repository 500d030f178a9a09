#pragma once

#include "comparisons/judgement/atlas/error_atlas.h"

/// Why a predicted largest torque differs from the finite elements': the error as factors, each
/// with a cause of its own.
namespace softfinger::judgement {

/// A contact as friction sees it: semi-axes and torque arm (largest torque over mu P), in one unit.
/// The arm stands for the pressure: it fixes the n of p ~ (1 - x²/a² - y²/b²)^n.
struct TorqueContact {
  double a = 0, b = 0, arm = 0;
};

/// The relative error of the torque's arm (largest torque over friction force), in signed parts:
/// (1 + ellipse) (1 + pressure) = predicted arm / true arm.
struct TorqueCauses {
  double ellipse = 0;   ///< arm(model's a, b; model's n) / arm(true a, b; model's n) - 1
  double pressure = 0;  ///< arm(true a, b; model's n) / true arm - 1
  /// The rule sqrt(ab) of Ciocarlie et al. 2007, (9) and (10), on the model's ellipse: its arm over
  /// the exact one, less 1; the same for every n. To be multiplied where that rule is used.
  double circle_rule = 0;
};
TorqueCauses torque_causes(const TorqueContact& model, const TorqueContact& truth);

/// A run of the atlas in units of h: the contact of the finite elements, and that of a model, which
/// the atlas stores as errors.
TorqueContact contact_of(const AtlasRun& run);
TorqueContact contact_of(const AtlasRun& run, const QuantityErrors& model_errors);

/// n of the pressure that has this arm, -0.99 to 1000.
double exponent_of(const TorqueContact& contact);

/// Largest relative radial distance of the friction ellipsoid with the exact e_n from the exact
/// limit surface of such a contact. Milliseconds.
double ellipsoid_error(double a_over_b, double exponent);

/// The largest part of the ellipsoid that its linearisation with `count` facets' vertices cuts off,
/// relative to the radius. Up to 100 ms.
double facet_error(int count);

}  // namespace softfinger::judgement
