#include "fem/levels/error_model.h"

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

/// Cells of a mesh from outside differ: about so many of them lie along the shorter semi-axis.
double cell_of(const LevelResult& level) {
  return level.cell_m > 0 ? level.cell_m : level.b_m / level.elements_per_semi_axis;
}

/// Errors of a, b and the area where the outline is that of the nodes.
RelativeError error_of_outline(const OutlineScatter& scatter, const LevelResult& coarse,
                               const LevelResult& fine) {
  const double refinement = refinement_of(coarse, fine);
  const auto of_axis = [&](double LevelResult::*axis) {
    const auto known = [&](const LevelResult& level) {
      return scatter.axes * cell_of(level) / level.*axis;
    };
    return outline_error(relative_difference(coarse.*axis, fine.*axis), known(coarse), known(fine),
                         refinement);
  };
  const auto of_area = [&](const LevelResult& level) {
    return 2 * scatter.radius * cell_of(level) / std::sqrt(level.a_m * level.b_m);
  };
  RelativeError result;
  result.a = of_axis(&LevelResult::a_m);
  result.b = of_axis(&LevelResult::b_m);
  result.area = outline_error(relative_difference(coarse.area_m2, fine.area_m2), of_area(coarse),
                              of_area(fine), refinement);
  return result;
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

double outline_error(double difference, double coarse, double fine, double refinement) {
  return fine + std::max(0.0, difference - std::hypot(coarse, fine)) / (refinement - 1);
}

RelativeError error_of_compressing(const LevelResult& contact, double thickness_m,
                                   double compressed) {
  const double change = compressed * contact.a_m * contact.b_m / (thickness_m * thickness_m);
  RelativeError result;
  result.a = result.b = 0.6 * change;
  result.area = change;
  result.peak_pressure = 1.2 * change;
  result.indentation = 2.1 * change;
  result.load = load_per_approach * 2.1 * change;
  result.max_torque = 0.3 * change;
  return result;
}

RelativeError error_of_levels(const ErrorTable& table, const LevelResult& coarse,
                              const LevelResult& fine, const ErrorSetting& setting) {
  const double refinement = refinement_of(coarse, fine), crossed = crossed_cells(fine);
  ErrorConstants integral = table.integral;
  if (setting.rubbed) integral.order = std::min(integral.order, order_of_rubbed_pressing);
  const double larger = setting.in_time ? std::max(1.0, fine.oversize) : 1;
  const int elements = std::max(1, static_cast<int>(fine.elements_per_semi_axis / larger));
  const auto error = [&](double LevelResult::*quantity, const ErrorConstants& constants) {
    return stated_error(relative_difference(coarse.*quantity, fine.*quantity), refinement,
                        constants, crossed, elements);
  };
  const double edge =
      unresolved_edge(fine, setting.thickness_m, table.unresolved_edge) + fine.fit_ambiguity;
  const auto of_wall = [&](double WallChange::*correction) {
    return missed_of_wall * std::abs(setting.wall.*correction);
  };
  RelativeError result;
  if (setting.fitted) {
    result.a = error(&LevelResult::a_m, table.edge);
    result.b = error(&LevelResult::b_m, table.edge);
    result.area = error(&LevelResult::area_m2, table.area);
  } else {
    result = error_of_outline(table.outline, coarse, fine);
  }
  result.a += edge + of_wall(&WallChange::a);
  result.b += edge + of_wall(&WallChange::b);
  result.area += 2 * edge + of_wall(&WallChange::area);
  result.peak_pressure =
      error(&LevelResult::peak_pressure_Pa, table.peak) + of_wall(&WallChange::peak_pressure);
  if (setting.rubbed) result.peak_pressure += rounded_cusp * setting.coupling;
  result.indentation = error(&LevelResult::indentation_m, integral) +
                       cells_away(fine, setting.thickness_m, setting.layered, table.cells_away) +
                       of_wall(&WallChange::indentation);
  result.load = error(&LevelResult::load_N, integral) + of_wall(&WallChange::load);
  if (setting.rubbed) {
    result.indentation += table.load_steps;
    result.load += load_per_approach * table.load_steps;
  }
  result.max_torque =
      error(&LevelResult::max_torque_Nm, table.integral) + of_wall(&WallChange::max_torque);
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
