#pragma once

#include "comparisons/prediction/taxel_answer.h"
#include "comparisons/reference/reference_result.h"

namespace softfinger::reference {

/// Readings of a tactile array under the nodal forces of finite elements, friction included, each
/// spread evenly over a square of the node's own area: the consistent forces of biquadratic shape
/// functions then lie on tiles that cover the surface once. What is between two nodes is not
/// resolved.
/// @param layers  of the finger, for depth and displacement, which are those of a flat layer in
///                linear elasticity
/// @pre checked by `check_taxels`
/// @throws InputError naming --taxels
prediction::TaxelAnswer read_taxels(const ReferenceResult& result, const LayerStack& layers,
                                    const prediction::TaxelRequest& request);

}  // namespace softfinger::reference
