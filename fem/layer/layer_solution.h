#pragma once

#include <deal.II/lac/vector.h>

#include <vector>

#include "fem/layer/layer_model.h"
#include "fem/layer/layer_space.h"

namespace softfinger::fem {

/// Displacement and pressure of a pressed layer, per degree of freedom. It refers to its model.
struct LayerSolution {
  const LayerSpace& space;  ///< its mesh is in metres
  const std::vector<ElasticConstants>& sublayers;
  double youngs_modulus_Pa = 0;  ///< the unit of the sublayers' moduli
  dealii::Vector<double> displacement_m;
  /// Non-zero at the normal displacements of the surface only.
  dealii::Vector<double> contact_pressure_Pa;
};

}  // namespace softfinger::fem
