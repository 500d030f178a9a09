#pragma once

#include "softfinger/fft/layer_contact.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/taxels/taxel_grid.h"

/// Forces of a contact on cells. Each is conservative: the cells' forces add up to the load, to
/// rounding.
namespace softfinger::taxels {

/// Cells without forces that cover a contact: 64 or more along each of its axes, but at most 64
/// along a taxel's side.
/// @param half_x_m, half_y_m  > 0: the contact lies within -half .. half
/// @throws InputError for a grid outside of its ranges, and for taxels far smaller than the contact
ForceCells cells_for(const TaxelGrid& grid, double half_x_m, double half_y_m);

/// A model's own pressure, integrated over each cell: by Gauss's rule inside; where the contact's
/// edge is near, along chords of the ellipse in the angle in which the pressure is smooth there,
/// between the places where the edge crosses a side of the cell. The sum then misses the load by
/// what the model's pressure does (closed forms: 1e-6), and `normalisation` makes it the load.
/// `layer_fft` has its forces per cell: use the other function.
/// @pre prediction.has_answer
/// @throws InputError as `cells_for`
/// Cost: about 10 ms.
ForceCells forces_on_cells(const PressureModel& model, const ContactProblem& problem,
                           const Prediction& prediction, const TaxelGrid& grid);

/// The forces on the cells of `layer_fft`, each spread evenly over its cell.
/// @throws InputError as `cells_for`
ForceCells forces_on_cells(const LayerContact& contact, const TaxelGrid& grid);

/// Forces that are spread evenly over rectangles, for instance those of the nodes of finite
/// elements over the nodes' surroundings.
struct SpreadForce {
  double x_m = 0, y_m = 0;              ///< centre
  double half_x_m = 0, half_y_m = 0;    ///< > 0
  double force_N = 0;                   ///< normal
  double shear_x_N = 0, shear_y_N = 0;  ///< friction on the layer
};

/// @param load_N  that the forces add up to, within a few per mille
/// @throws InputError as `cells_for`
ForceCells forces_on_cells(const std::vector<SpreadForce>& forces, double load_N,
                           const TaxelGrid& grid);

}  // namespace softfinger::taxels
