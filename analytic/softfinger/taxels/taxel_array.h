#pragma once

#include <Eigen/Core>
#include <optional>

#include "softfinger/taxels/contact_forces.h"

/// Readings of a tactile array on or inside of the layer. The path of the data: a model's pressure
/// (or other forces) -> forces on small cells (contact_forces.h) -> through the layer to a depth
/// (layer_stress.h, corner_response.h) -> forces on taxels.
namespace softfinger::taxels {

/// Readings of all taxels; arrays have a row per row of the grid, along y, and a column per column.
struct TaxelReadings {
  TaxelGrid grid;
  double depth_m = 0;
  Eigen::ArrayXXd force_N;  ///< normal, compression positive
  /// On what lies below, x along the contact's long axis; on the surface the friction that is
  /// known.
  Eigen::ArrayXXd shear_x_N, shear_y_N;
  Eigen::ArrayXXd displacement_m;  ///< of the surface above the taxel, into the layer, mean
  double load_N = 0;

  Eigen::ArrayXXd pressure_Pa() const { return force_N / (grid.pitch_m * grid.pitch_m); }
  /// Force that passes beside the array.
  double outside_N() const { return load_N - force_N.sum(); }
};

/// A contact as an array shows it: the taxels' forces as point forces in their centres.
struct ArrayMoments {
  double spread_x_m = 0, spread_y_m = 0;  ///< root of the mean of x², of y²
  double arm_m = 0;                       ///< sum r f / sum f
};

/// @pre the forces' sum is positive
ArrayMoments moments_of(const TaxelReadings& readings);

/// The pitch with which an array covers the contact and one taxel on each side; at depth, where the
/// pressure has spread, two depths more on each side. With one or two taxels along an axis these
/// alone cover the contact there.
double covering_pitch_m(int columns, int rows, double half_x_m, double half_y_m, double depth_m);

/// Reads the forces on all taxels. The normal ones add up to the load within rounding as far as the
/// array reaches: on the surface over the contact, at depth over the infinite plane.
///
/// Through the layer the forces act as point forces in the middles of their cells, seen by whole
/// taxels: cells of the size c change a taxel's share by about c²/(48 a pitch), 1e-5, and at depths
/// of less than a cell the shear by about exp(-2 pi z/c) of the pressure's change over a cell.
/// Stress at depth and the displacement are those of a flat layer on a rigid base in linear
/// elasticity, whichever model the forces are from. What friction adds to the displacement is known
/// for one sublayer.
/// @param layer    of one sublayer where depth_m > 0
/// @param depth_m  0 (the surface) to the layer's thickness (the base)
/// @throws InputError
/// Cost: 10 ms on the surface, which displacement takes, and 40 ms at depth, for 16 x 16 taxels
/// that cover the contact.
TaxelReadings read_taxels(const ForceCells& forces, const LayerStack& layer, double depth_m);

/// Readings of a model's contact.
struct ModelReadings {
  TaxelReadings readings;
  ForceCells forces;  ///< that they are made of
};

/// @param pitch_m  none: `covering_pitch_m`
/// @pre prediction.has_answer
/// @throws InputError; for `layer_fft`, which is solved anew, what solve_layer_contact throws
ModelReadings read_taxels(const PressureModel& model, const ContactProblem& problem,
                          const Prediction& prediction, int columns, int rows,
                          std::optional<double> pitch_m, double depth_m);

}  // namespace softfinger::taxels
