#pragma once

#include <optional>
#include <string>

#include "comparisons/input/case.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/reference/reference_result.h"

namespace softfinger::judgement {

/// Bound of the distance between an answer of the finite elements and the finger itself.
struct ReferenceBound {
  std::optional<prediction::QuantityErrors> bound;  ///< of |relative error|; NaN: not known
  std::string evidence;                             ///< for the bound, or why there is none
};

/// Contact that the finite elements solved, and their result.
struct SolvedReference {
  const input::Case& contact_case;  ///< as it was solved
  const prediction::LocalGeometry& geometry;
  const reference::ReferenceResult& result;
  bool is_full = false;  ///< `reference::is_full_reference`
  bool within_theory = true;
  bool by_approach = false;  ///< the load is a result
};

/// Bound for a solved contact. For the full reference it is what elements and a scan's facets leave
/// open, together. A flat layer in linear theory is what `bonded_layer` solves: its distance to the
/// finger is known and added to the elements' own error. For any other idealisation no bound is
/// known.
ReferenceBound bound_of(const SolvedReference& solved);

}  // namespace softfinger::judgement
