#pragma once

#include <string>

#include "comparisons/input/case.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/reference/reference_result.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::reference {

/// Whether a result lies within the theory by which it was found. The elements' own errors say
/// nothing of that: they are those of solving the theory's equations. Linear elasticity knows small
/// strains and slopes only; finite strain has no check here, its solver stops where it must.
/// @param contact_case  as it was solved
Validity theory_limits(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                       const ReferenceResult& result);

/// "beyond linear theory: small_strain 0.95, holds below 0.18"; empty where all checks hold.
std::string beyond_limits_in_words(const Validity& validity);

}  // namespace softfinger::reference
