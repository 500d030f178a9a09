#pragma once

#include <string>

#include "fem/friction/surface_compliance.h"

namespace softfinger::fem {

/// Writes the surface's compliance for use by others: one line of JSON that says what follows
/// (`format`, `points`, `byte_order`, units, arrays with name, rows, columns in file order), a line
/// feed, then the arrays as 64-bit floats, row by row:
///   position_m (n x 2), area_m2 (n), normal_m_per_N (n x n), tangential_m_per_N (2n x 2n),
///   normal_tangential_m_per_N (n x 2n).
/// Displacements are into the layer and along x, y of the contact; forces likewise.
/// @throws InputError when the file cannot be written
void write_compliance(const std::string& path, const SurfaceCompliance& surface, double thickness_m,
                      double youngs_modulus_Pa, double poisson_ratio);

}  // namespace softfinger::fem
