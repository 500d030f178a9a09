#pragma once

#include <Eigen/Core>

#include "softfinger/input/contact_problem.h"

/// Forces and displacements on a rectangle are differences of four "corner responses": with
/// R(X, Y) = int_0^X int_0^Y f dy dx of a point force's field f, a rectangle between the corners
/// (x1, y1) and (x2, y2), seen from the force, has R(x2, y2) - R(x1, y2) - R(x2, y1) + R(x1, y1).
/// Sums over many rectangles telescope to those of the outermost corners, to rounding.
namespace softfinger::taxels {

/// A corner response at the offsets X = (i + 1/2) step_x, Y = (j + 1/2) step_y: coefficient (i, j).
using CornerTable = Eigen::ArrayXXd;

/// Offsets for which tables are made. Cells of `step_x` by `step_y` carry the forces, and corners
/// lie on corners of cells.
struct OffsetLattice {
  int count_x = 0, count_y = 0;
  double step_x_m = 0, step_y_m = 0;
};

/// Responses of stress at one depth under a point force of 1 N, for a layer bonded to a rigid base.
struct StressCorners {
  CornerTable
      normal;  ///< odd in X and in Y; 1/4 far away, so that the force through a plane is 1 N
  CornerTable shear_x;  ///< even in X, odd in Y, up to a function of Y, which differences lose
  CornerTable shear_y;  ///< odd in X, even in Y, likewise
};

/// The half-space's part is in closed form (the normal one is Newmark's of 1935), the layer's is a
/// Hankel transform of `LayerStress::excess`, tabulated and integrated: absolute error of `normal`
/// below 1e-7, of the shears below 1e-7.
/// @param depth_m  0 < z <= h
/// Cost: 20 ms, and 0.2 us per offset.
StressCorners stress_corners(const ElasticLayer& layer, double depth_m,
                             const OffsetLattice& lattice);

/// Responses of stress at one depth under a point force of 1 N along the surface: along x (`_x`) or
/// along y (`_y`).
struct ShearCorners {
  CornerTable normal_x;          ///< even in X, odd in Y, up to a function of Y
  CornerTable normal_y;          ///< odd in X, even in Y, likewise
  CornerTable along_x, along_y;  ///< shear along the force: odd in X and in Y; 1/4 far away
  CornerTable across;            ///< shear across the force: even in X and in Y, likewise
};

/// The half-space's part is in closed form (Cerruti's, integrated), the layer's tabulated and
/// integrated as above.
/// @param depth_m  0 < z <= h
/// Cost: as above.
ShearCorners shear_corners(const ElasticLayer& layer, double depth_m, const OffsetLattice& lattice);

/// Response of the surface's normal displacement, in m² per N, to a force of 1 N along the surface:
/// along x even in X and odd in Y, along y the other way round, up to functions of one of them.
struct LiftCorners {
  CornerTable x, y;
};
/// Point forces lie in the middles of the cells that carry them: cells of the size c change it by
/// about (c/h)²/10 and, where the shear varies over a length L, (c/L)²/10.
LiftCorners lift_corners(const ElasticLayer& layer, const OffsetLattice& lattice);

/// Response of the surface's normal displacement, in m² per N, to a force that is spread evenly
/// over one cell: for the displacement averaged over a rectangle, divide by its area. Linear
/// elasticity of the stack on a rigid base, without friction; odd in X and in Y. Error about 1e-5
/// of the half-space's displacement, where cells are smaller than the layer is thick.
CornerTable displacement_corners(const LayerStack& layer, const OffsetLattice& lattice);

}  // namespace softfinger::taxels
