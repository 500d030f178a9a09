#include "fem/error_model.h"

#include <algorithm>
#include <cmath>

namespace softfinger::fem {
namespace {

/// A faceted object's edges are rounded: a scanned pad on a sphere's mesh went 5e-4 h less deep
/// than on the facets themselves.
constexpr double depth_by_rounded_edges = 5e-4;
/// A load goes with the approach's power 2 or so.
constexpr double load_per_approach = 2;

double relative_difference(double coarse, double fine) { return std::abs(coarse / fine - 1); }

void add_without_fit(const WithoutFit& missed, int elements_per_semi_axis, RelativeError& error) {
  const double of_edge = missed.cells / elements_per_semi_axis;
  error.a += of_edge + missed.axes;
  error.b += of_edge + missed.axes;
  error.area += 2 * of_edge + missed.area;
}

void add_rounded_edges(double depth, RelativeError& error) {
  const double of_edges = depth_by_rounded_edges / depth;
  error.indentation += of_edges;
  error.load += load_per_approach * of_edges;
}

}  // namespace

double refinement_of(const LevelResult& coarse, const LevelResult& fine) {
  return static_cast<double>(fine.elements_per_semi_axis) / coarse.elements_per_semi_axis;
}

double stated_error(double difference, double refinement, const ErrorConstants& constants,
                    double crossed_cells, int elements) {
  const double cell = 4.0 / elements;
  return difference / (std::pow(refinement, constants.order) - 1) + constants.common +
         constants.coarse * std::pow(cell, constants.coarse_order) +
         constants.across * crossed_cells;
}

double crossed_cells(const LevelResult& level) {
  if (std::abs(std::log(level.oversize)) <= edge_on_cells) return 0;
  const double cell = 8 * level.oversize / level.elements_per_semi_axis;
  return cell * cell;
}

double unresolved_edge(const LevelResult& fine, double thickness_m, double weight) {
  const double b = fine.b_m / thickness_m;
  const double cell = fine.oversize * b / fine.elements_per_semi_axis;
  return weight * cell * cell * cell / b;
}

double cells_away(const LevelResult& fine, double thickness_m, bool layered, double largest) {
  constexpr double longest_circle = 1.02, small = 0.1;
  const double s = std::sqrt(fine.a_m * fine.b_m) / thickness_m;
  return layered || fine.a_m > longest_circle * fine.b_m ? largest * std::min(1.0, small / s) : 0;
}

double cells_on_scan(const LevelResult& fine, double thickness_m, double largest, double up_to) {
  return largest * std::min(1.0, up_to * thickness_m / std::sqrt(fine.a_m * fine.b_m));
}

RelativeError error_of_levels(const ErrorTable& table, const LevelResult& coarse,
                              const LevelResult& fine, const ErrorSetting& setting) {
  const double refinement = refinement_of(coarse, fine), crossed = crossed_cells(fine);
  const auto error = [&](double LevelResult::*quantity, const ErrorConstants& constants) {
    return stated_error(relative_difference(coarse.*quantity, fine.*quantity), refinement,
                        constants, crossed, fine.elements_per_semi_axis);
  };
  const double edge =
      unresolved_edge(fine, setting.thickness_m, table.unresolved_edge) + fine.fit_ambiguity;
  const WallChange& wall = setting.wall;
  RelativeError result;
  result.a = error(&LevelResult::a_m, table.edge) + edge + std::abs(wall.a);
  result.b = error(&LevelResult::b_m, table.edge) + edge + std::abs(wall.b);
  result.area = error(&LevelResult::area_m2, table.area) + 2 * edge + std::abs(wall.area);
  result.peak_pressure =
      error(&LevelResult::peak_pressure_Pa, table.peak) + std::abs(wall.peak_pressure);
  result.indentation = error(&LevelResult::indentation_m, table.integral) +
                       cells_away(fine, setting.thickness_m, setting.layered, table.cells_away) +
                       std::abs(wall.indentation);
  result.load = error(&LevelResult::load_N, table.integral) + std::abs(wall.load);
  result.max_torque =
      error(&LevelResult::max_torque_Nm, table.integral) + std::abs(wall.max_torque);
  if (setting.is_scan) {
    result.indentation += cells_on_scan(fine, setting.thickness_m, 1e-3, 0.1);
    result.load += 2 * cells_on_scan(fine, setting.thickness_m, 1e-3, 0.1);
    result.max_torque += cells_on_scan(fine, setting.thickness_m, 5e-4, 0.5);
  }
  return result;
}

RelativeError error_of_contact(const ErrorTable& table, const LevelResult& coarse,
                               const LevelResult& fine, const ErrorSetting& setting) {
  RelativeError error = error_of_levels(table, coarse, fine, setting);
  if (!setting.fitted) add_without_fit(table.without_fit, fine.elements_per_semi_axis, error);
  if (setting.rounded_edges) add_rounded_edges(fine.indentation_m / setting.thickness_m, error);
  (setting.approach_given ? error.indentation : error.load) = 0;
  return error;
}

bool is_useful(const RelativeError& error, int own_elements) {
  const double known = 1.0 / (8 * own_elements);
  return std::max(error.a, error.b) <= known &&
         std::max(error.indentation, error.max_torque) <= known / 5;
}

ExtrapolatedStiffness extrapolated_stiffness(double coarse, double fine, double refinement,
                                             int elements) {
  const double correction = (fine - coarse) / (std::pow(refinement, stuck_stiffness.order) - 1);
  return {fine + correction,
          stated_error(0, refinement, stuck_stiffness, 0, elements) + std::abs(correction) / fine};
}

double stuck_edge_error(const ErrorTable& table, int elements_per_semi_axis, bool symmetric,
                        bool mesh_is_ours, double misfit) {
  const bool between_nodes = !mesh_is_ours || (table.stuck_edge.without_symmetry && !symmetric) ||
                             misfit > table.stuck_edge.largest_misfit;
  return between_nodes ? stuck_edge_cells / elements_per_semi_axis : 0;
}

}  // namespace softfinger::fem
