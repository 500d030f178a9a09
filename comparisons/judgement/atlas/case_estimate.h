#pragma once

#include <string>

#include "comparisons/input/case.h"
#include "comparisons/judgement/atlas/error_atlas.h"
#include "comparisons/prediction/ask_model.h"

namespace softfinger::judgement {

/// The bounds of a model on a case's contact: of a flat layer, or, where the case asks for finite
/// elements on the finger's own curved core, of one bent over a round finger pressed on a plane;
/// where it asks for finite strain, against that.
/// @param model  its name, or "fem"
ErrorAtlas::Estimate estimate_error(const std::string& model, const input::Case& contact_case,
                                    const ContactProblem& problem);

/// The bounds when the torque is the seed's rule, which for ellipses differs from the exact one.
QuantityErrors with_torque_rule(const ErrorAtlas::Estimate& estimate, const Prediction& prediction,
                                prediction::TorqueRule rule);

}  // namespace softfinger::judgement
