#pragma once

#include "comparisons/report/html.h"

namespace softfinger::report {

/// Pictures of the surfaces that quadrics were fitted to: facets coloured by their distance from
/// the quadric, the region, depth lines, the contact. Empty without meshes.
Html fit_pictures(const Json& load);

}  // namespace softfinger::report
