#pragma once

#include <string>

#include "comparisons/input/case.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/quantity.h"
#include "softfinger/input/errors.h"

/// Steps that a user can take where an answer is not usable. A remedy is named only after it was
/// tried.
namespace softfinger::judgement {

struct NextStep {
  std::string reason;  ///< "the mesh leaves 24 % open"
  std::string step;  ///< "press at the nearest point that is usable, 1.2 mm away: finger = { .. }"

  std::string in_words() const { return reason + ": " + step; }
};

/// Tried in this order: the recommended model, the nearest point of the mesh, the best place of all
/// its sides, a smaller or larger load, and where none of them helps the radii, finite elements or
/// what has to be left out of the case.
///
/// Asks models for other loads (microseconds) and, for a mesh, at up to a hundred other points
/// nearby and fifty on all sides, usually 0.6 s and at most 6 s of the processor: for people, not
/// for loops.
/// @param resolver   of the case
/// @param answer     not usable, with its assessment
/// @param demand     by which it was assessed
NextStep next_step(const input::Case& contact_case, const prediction::GeometryResolver& resolver,
                   const prediction::ModelAnswer& answer, const prediction::Demand& demand);

/// Next step where the resolver refused the geometry, so that there is no answer.
NextStep next_step(const input::Case& contact_case, const prediction::GeometryResolver& resolver,
                   double load_N, const InputError& refusal, const prediction::Demand& demand);

/// `resolver.resolve(load_N)`, whose refusal also says the next step.
/// @throws InputError
prediction::LocalGeometry resolve_or_advise(const input::Case& contact_case,
                                            const prediction::GeometryResolver& resolver,
                                            double load_N, const prediction::Demand& demand = {});

}  // namespace softfinger::judgement
