#pragma once

#include <deal.II/lac/vector.h>

#include <string>

#include "fem/layer/layer_space.h"

namespace dealii {
template <int dim>
class DataPostprocessor;
}

namespace softfinger::fem {

/// Fields of a pressed layer for a file. All per degree of freedom, but for `of_cells`.
struct LayerFields {
  const LayerSpace& space;  ///< its mesh is in metres: see MeshInMetres
  const dealii::Vector<double>& displacement_m;
  /// Non-zero at the normal displacements of the surface only.
  const dealii::Vector<double>& contact_pressure_Pa;
  const dealii::DataPostprocessor<dim>* of_displacement = nullptr;  ///< null: nothing more
  std::string name_of_cells = {};                                   ///< empty: no field of cells
  dealii::Vector<double> of_cells = {};
};

/// Writes the fields to a VTU file, atomically. The library's output is instantiated here alone.
/// @throws InputError when the file cannot be written
void write_fields(const std::string& path, const LayerFields& fields);

}  // namespace softfinger::fem
