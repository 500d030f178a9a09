#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "softfinger/fft/contact_edge.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/input/errors.h"

namespace softfinger {

/// Gap in metres between the undeformed surfaces at (x, y) metres in the contact's plane: smooth on
/// the scale of a cell, zero at first touch. It is only called inside the window.
using GapFunction = std::function<double(double x_m, double y_m)>;

/// Search window: a rectangle that must contain the contact but may be much larger.
struct GapWindow {
  double centre_x_m = 0, centre_y_m = 0;
  double half_width_x_m = 0, half_width_y_m = 0;  ///< > 0
};

/// The contact is larger than the window: the gap outside it would be needed.
class ContactReachesBorder : public ConvergenceError {
 public:
  ContactReachesBorder(const std::string& stage, int iteration, double residual)
      : ConvergenceError(stage, iteration, residual,
                         "the contact reaches the border of the window in which the gap is known") {
  }
};

struct LayerContactOptions {
  /// Cells along each side of the final grid, which is 1.15 times as wide as the contact: a power
  /// of two from 32 to 1024. The errors of approach and torque fall like its square or faster.
  int cells = 128;
  /// Root mean square of the gap that is left in the contact over the approach. 1e-5 is far below
  /// the discretisation's error at 128 cells: tighter values change no digit that holds.
  double tolerance = 1e-5;
  int max_iterations = 1000;  ///< of each grid; 20 to 40 are usual
};

/// Frictionless contact of an arbitrary gap with elastic layers. Everything in the gap's frame, SI.
struct LayerContact {
  fft::CellGrid grid;          ///< metres; centre of cell (row, column) at (x(column), y(row))
  Eigen::ArrayXd pressure_Pa;  ///< mean over each cell, index = row * columns + column; the sum
                               ///< times `grid.cell_area()` is the load, to rounding
  Eigen::ArrayXd gap_m;        ///< mean over each cell between the deformed surfaces
  double approach_m = 0;       ///< of the bodies, from where the gap function is zero
  fft::ContactEdge edge;       ///< metres: best-fitting ellipse, area, shape of the region
  /// Displacements of the surfaces of the two layers at the largest pressure; the second is 0
  /// without an object's layer.
  double layer_displacement_m = 0, object_displacement_m = 0;
  double peak_pressure_Pa = 0;  ///< at the centre of an even contact, otherwise of all cells
  double centre_of_pressure_x_m = 0, centre_of_pressure_y_m = 0;
  double torque_arm_m = 0;  ///< (int p r dA)/P, r from the centre of pressure

  int iterations = 0;              ///< on the final grid
  int convolutions = 0;            ///< on the final grid
  double residual = 0;             ///< rms of the gap in the contact over the approach
  double penetration = 0;          ///< largest overlap outside the contact over the approach
  double cells_per_thickness = 0;  ///< thinnest layer (of a stack the surface's sublayer) over the
                                   ///< larger side of a cell

  /// Pressure at a point, continuous and zero at `edge`: the cells' p², which vanishes linearly
  /// there, divided by 1 - r² and interpolated. Integrates to the load within about 1e-3.
  double pressure_at_Pa(double x_m, double y_m) const;
};

/// Contact of a gap with an elastic layer (or a stack of sublayers) bonded to a rigid base, and
/// where `object_layer` has a thickness, with a second one bonded to the object: their
/// displacements add.
///
/// Minimises the complementary energy over pressures that are constant per cell and not negative
/// (a Galerkin method, whose energy, approach and moments converge much faster than the pressure
/// itself), with the influence of one cell on another as in influence.h, by conjugate gradients
/// with exact complementarity at a given load (I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206).
/// Coarse grids of 32 cells find where the contact is.
///
/// Measured against exact solutions (nu 0 to 1/2, sqrt(ab)/h 0.05 to 20, R'/R'' to 10) at 128
/// cells: approach and torque within 3e-4 (1e-5 but for nu = 1/2, sqrt(ab)/h = 20), a and b within
/// 0.07 %. A layer thinner than two cells is not resolved: see `cells_per_thickness`.
///
/// @param load_N  > 0
/// @throws InputError        options or arguments outside their ranges
/// @throws ContactReachesBorder  the contact reaches the window's border
/// @throws ConvergenceError  the contact is not one region with a smooth edge, a layer is thinner
///                           than 1/64 of a cell, or the iteration stalls
/// Cost: about 40 ms at 128 cells (one core), 12 MB.
LayerContact solve_layer_contact(const GapFunction& gap_m, const GapWindow& window,
                                 const LayerStack& layer, const LayerStack& object_layer,
                                 double load_N, const LayerContactOptions& options = {});

/// Solves the contact for the quadric gap x²/(2R') + y²/(2R''), x along the larger radius, on a
/// quarter of the grid: about 15 ms. The dimensionless problem is rounded to 40 bits, so that the
/// answer does not depend on the units.
LayerContact solve_layer_contact(const RelativeRadii& radii, const LayerStack& layer,
                                 const LayerStack& object_layer, double load_N,
                                 const LayerContactOptions& options = {});

}  // namespace softfinger
