#pragma once

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/vector.h>

#include <string>
#include <vector>

#include "fem/dimension.h"
#include "fem/layer_model.h"

namespace softfinger::fem {

/// Writes displacement_m, stress_Pa (tensor), mean_pressure_Pa and contact_pressure_Pa, of
/// several sublayers also their numbers, to a VTU file, atomically. The handler's mesh is in
/// metres.
///
/// @param displacement_m       per dof of the three-component handler
/// @param contact_pressure_Pa  per dof, non-zero at normal displacements of the surface only
/// @param sublayers            by the cells' material; their moduli over `youngs_modulus_Pa`
/// @throws InputError when the file cannot be written
void write_solution(const std::string& path, const dealii::Mapping<3>& mapping,
                    const dealii::DoFHandler<3>& dofs, const dealii::Vector<double>& displacement_m,
                    const dealii::Vector<double>& contact_pressure_Pa, double youngs_modulus_Pa,
                    const std::vector<ElasticConstants>& sublayers);

}  // namespace softfinger::fem
