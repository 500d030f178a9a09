#include "softfinger/taxels/taxel_array.h"

#include <algorithm>
#include <cmath>

#include "softfinger/taxels/corner_response.h"

namespace softfinger::taxels {
namespace {

/// Coefficients of a table at signed offsets: the sign that the response has where X, Y or both are
/// negative.
enum class Parity { odd_odd, even_odd, odd_even, even_even };

/// Sums of the forces' responses at all corners of taxels: (column, row).
/// @param values  of the cells of `forces`
Eigen::ArrayXXd at_corners(const ForceCells& forces, const Eigen::ArrayXXd& values,
                           const CornerTable& table, Parity parity) {
  const bool even_x = parity == Parity::even_odd || parity == Parity::even_even,
             even_y = parity == Parity::odd_even || parity == Parity::even_even;
  const TaxelGrid& grid = forces.grid;
  Eigen::ArrayXXd corners = Eigen::ArrayXXd::Zero(grid.columns + 1, grid.rows + 1);
  const int cells_x = int(values.rows()), cells_y = int(values.cols());
  for (int row = 0; row <= grid.rows; ++row)
    for (int j = 0; j < cells_y; ++j) {
      // The corner lies (dy + 1/2) cells from the cell's middle.
      const int dy = row * forces.per_taxel_y - (forces.begin_y + j) - 1;
      const int place_y = dy >= 0 ? dy : -dy - 1;
      const double sign_y = dy >= 0 || even_y ? 1 : -1;
      for (int column = 0; column <= grid.columns; ++column) {
        double sum = 0;
        for (int i = 0; i < cells_x; ++i) {
          const int dx = column * forces.per_taxel_x - (forces.begin_x + i) - 1;
          const double part = values(i, j) * table(dx >= 0 ? dx : -dx - 1, place_y);
          sum += dx >= 0 || even_x ? part : -part;
        }
        corners(column, row) += sign_y * sum;
      }
    }
  return corners;
}

/// A row per row of taxels.
Eigen::ArrayXXd on_taxels(const Eigen::ArrayXXd& corners) {
  const Eigen::Index columns = corners.rows() - 1, rows = corners.cols() - 1;
  return (corners.block(1, 1, columns, rows) - corners.block(0, 1, columns, rows) -
          corners.block(1, 0, columns, rows) + corners.block(0, 0, columns, rows))
      .transpose();
}

Eigen::ArrayXXd on_surface(const ForceCells& forces, const Eigen::ArrayXXd& values) {
  Eigen::ArrayXXd result = Eigen::ArrayXXd::Zero(forces.grid.rows, forces.grid.columns);
  const auto taxel = [](int cell, int per_taxel) { return cell >= 0 ? cell / per_taxel : -1; };
  for (int j = 0; j < int(values.cols()); ++j) {
    const int row = taxel(forces.begin_y + j, forces.per_taxel_y);
    if (row < 0 || row >= forces.grid.rows) continue;
    for (int i = 0; i < int(values.rows()); ++i)
      if (const int column = taxel(forces.begin_x + i, forces.per_taxel_x);
          column >= 0 && column < forces.grid.columns)
        result(row, column) += values(i, j);
  }
  return result;
}

/// All offsets between cells and corners of taxels.
OffsetLattice lattice_of(const ForceCells& forces) {
  const auto count = [](int begin, int cells, int taxels, int per_taxel) {
    return std::max(taxels * per_taxel - begin, begin + cells) + 1;
  };
  return {
      count(forces.begin_x, int(forces.force_N.rows()), forces.grid.columns, forces.per_taxel_x),
      count(forces.begin_y, int(forces.force_N.cols()), forces.grid.rows, forces.per_taxel_y),
      forces.step_x_m(), forces.step_y_m()};
}

}  // namespace

ArrayMoments moments_of(const TaxelReadings& readings) {
  double force = 0, xx = 0, yy = 0, arm = 0;
  for (int row = 0; row < readings.grid.rows; ++row)
    for (int column = 0; column < readings.grid.columns; ++column) {
      const double f = readings.force_N(row, column);
      const double x = readings.grid.x_m(column), y = readings.grid.y_m(row);
      force += f;
      xx += f * x * x;
      yy += f * y * y;
      arm += f * std::hypot(x, y);
    }
  return {std::sqrt(std::max(0., xx / force)), std::sqrt(std::max(0., yy / force)), arm / force};
}

double covering_pitch_m(int columns, int rows, double half_x_m, double half_y_m, double depth_m) {
  const auto pitch = [&](int count, double half_m) {
    return 2 * (half_m + 2 * depth_m) / (count > 2 ? count - 2 : count);
  };
  return std::max(pitch(columns, half_x_m), pitch(rows, half_y_m));
}

TaxelReadings read_taxels(const ForceCells& forces, const LayerStack& layer, double depth_m) {
  if (!(depth_m >= 0 && depth_m <= layer.thickness_m()))
    throw InputError("taxels", "depth_m", depth_m,
                     "0 (the surface) to the layer's thickness, " +
                         internal::number_text(layer.thickness_m(), 6));
  if (depth_m > 0 && layer.count > 1)
    throw InputError("taxels", "depth_m", depth_m, "0 for a layer of several sublayers");
  const OffsetLattice lattice = lattice_of(forces);
  TaxelReadings readings;
  readings.grid = forces.grid;
  readings.depth_m = depth_m;
  readings.load_N = forces.force_N.sum();
  const double area_m2 = forces.grid.pitch_m * forces.grid.pitch_m;
  const auto seen = [&](const Eigen::ArrayXXd& values, const CornerTable& table, Parity parity) {
    return on_taxels(at_corners(forces, values, table, parity));
  };
  readings.displacement_m =
      seen(forces.force_N, displacement_corners(layer, lattice), Parity::odd_odd) / area_m2;
  if (forces.has_shear() && layer.count == 1) {
    const LiftCorners lift = lift_corners(layer.surface(), lattice);
    readings.displacement_m += (seen(forces.shear_x_N, lift.x, Parity::even_odd) +
                                seen(forces.shear_y_N, lift.y, Parity::odd_even)) /
                               area_m2;
  }
  if (depth_m == 0) {
    readings.force_N = on_surface(forces, forces.force_N);
    // Zero without friction.
    readings.shear_x_N = on_surface(forces, forces.shear_x_N);
    readings.shear_y_N = on_surface(forces, forces.shear_y_N);
    return readings;
  }
  const StressCorners stress = stress_corners(layer.surface(), depth_m, lattice);
  readings.force_N = seen(forces.force_N, stress.normal, Parity::odd_odd);
  readings.shear_x_N = seen(forces.force_N, stress.shear_x, Parity::even_odd);
  readings.shear_y_N = seen(forces.force_N, stress.shear_y, Parity::odd_even);
  if (!forces.has_shear()) return readings;
  const ShearCorners shear = shear_corners(layer.surface(), depth_m, lattice);
  readings.force_N += seen(forces.shear_x_N, shear.normal_x, Parity::even_odd) +
                      seen(forces.shear_y_N, shear.normal_y, Parity::odd_even);
  readings.shear_x_N += seen(forces.shear_x_N, shear.along_x, Parity::odd_odd) +
                        seen(forces.shear_y_N, shear.across, Parity::even_even);
  readings.shear_y_N += seen(forces.shear_y_N, shear.along_y, Parity::odd_odd) +
                        seen(forces.shear_x_N, shear.across, Parity::even_even);
  return readings;
}

ModelReadings read_taxels(const PressureModel& model, const ContactProblem& problem,
                          const Prediction& prediction, int columns, int rows,
                          std::optional<double> pitch_m, double depth_m) {
  const auto grid = [&](double half_x_m, double half_y_m) {
    return TaxelGrid{
        columns, rows,
        pitch_m ? *pitch_m : covering_pitch_m(columns, rows, half_x_m, half_y_m, depth_m)};
  };
  ModelReadings result;
  if (model.card().name == "layer_fft") {
    const LayerContact contact = solve_layer_contact(
        problem.radii, problem.finger_layers(), problem.object_layer, problem.load.normal_force_N);
    // The outermost cells reach beyond the edge.
    result.forces = forces_on_cells(
        contact, grid(contact.edge.a + contact.grid.size_x, contact.edge.b + contact.grid.size_y));
  } else {
    result.forces =
        forces_on_cells(model, problem, prediction, grid(prediction.a_m, prediction.b_m));
  }
  result.readings = read_taxels(result.forces, problem.finger_layers(), depth_m);
  return result;
}

}  // namespace softfinger::taxels
