#pragma once

#include <nlohmann/json.hpp>

#include "comparisons/input/case.h"
#include "comparisons/judgement/atlas/error_atlas.h"

namespace softfinger::judgement {

/// The summary of the atlas that the pages show (report/README.md, "atlas"): error quantiles and
/// cost of every model and finite-element level, errors on the grid, causes of torque errors,
/// friction laws. The costs of fast models are measured in this call. Null for an atlas without
/// flat runs. Takes about a second.
nlohmann::json atlas_overview(const AtlasFile& atlas);

/// Errors of each model and of linear finite elements at finite strain, by indentation and
/// Poisson's ratio (report/README.md, "finite_strain"): quantiles over the runs of each kind.
nlohmann::json finite_strain_overview(const AtlasFile& atlas);

/// Place of a contact on the maps: {"id", "load_N", "poisson_ratio", "radii_ratio", "s", "seed"}; s
/// by the bonded layer, null without answer.
nlohmann::json map_mark(const input::Case& contact_case, const ContactProblem& problem);

/// The marks of the built-in cases that are the fingertips of Ciocarlie et al. (2007).
nlohmann::json seed_marks();

}  // namespace softfinger::judgement
