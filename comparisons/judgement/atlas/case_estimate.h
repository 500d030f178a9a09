#pragma once

#include <string>

#include "comparisons/input/case.h"
#include "comparisons/judgement/atlas/error_atlas.h"
#include "comparisons/prediction/ask_model.h"

namespace softfinger::judgement {

/// The bounds of a model's errors for a contact of the case. They come from the runs of the kind of
/// finite elements that the case asks for: on a flat layer, on a layer bent over a round finger on
/// a plane (geometry = "curved"), or at finite strain.
/// @param model  its name, or "fem"
ErrorAtlas::Estimate estimate_error(const std::string& model, const input::Case& contact_case,
                                    const ContactProblem& problem);

/// The bounds if the torque comes from the rule of Ciocarlie et al. (2007), which differs from the
/// exact one for ellipses.
QuantityErrors with_torque_rule(const ErrorAtlas::Estimate& estimate, const Prediction& prediction,
                                prediction::TorqueRule rule);

/// The bounds, known for Coulomb's law, for the answer's: the torque tau_0 A e(0) is off by what
/// the area A and an arm are. An arm is between the semi-axes, and Coulomb's own has the pressure's
/// error too: the largest of the three.
QuantityErrors with_shear_law(QuantityErrors bound, const prediction::ModelAnswer& answer);

}  // namespace softfinger::judgement
