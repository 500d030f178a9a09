#pragma once

#include <Eigen/Core>
#include <string>

#include "fem/layer/layer_model.h"

namespace softfinger::fem {

/// Writes the pressed layer's displacement_m, stress_Pa (tensor), mean_pressure_Pa and
/// contact_pressure_Pa to a VTU file, atomically. Where there are several sublayers, it writes
/// their numbers too.
/// @param force  per surface node, in units of E h²
/// @throws InputError when the file cannot be written
void write_vtu(const std::string& path, const LayerModel& model, const Eigen::VectorXd& force,
               double thickness_m, double youngs_modulus_Pa);

}  // namespace softfinger::fem
