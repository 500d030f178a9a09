#include "comparisons/explorer/pad_explorer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "comparisons/explorer/json_parts.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/exporting/soft_pad.h"
#include "softfinger/input/constants.h"
#include "softfinger/pads/pad_error.h"

namespace softfinger::explorer {
namespace {

using Eigen::Vector2d;

std::string pair_text(double first, double second) {
  return "[" + json_number(first) + "," + json_number(second) + "]";
}

std::string pad_bound_json(const std::optional<PadErrors>& bound) {
  if (!bound) return "null";
  return fmt::format(
      "{{\"max_torque\":{},\"indentation\":{},\"pressure_arm\":{},\"peak_pressure\":{},"
      "\"tilt_stiffness\":{}}}",
      json_number(bound->max_torque), json_number(bound->indentation),
      json_number(bound->pressure_arm), json_number(bound->peak_pressure),
      json_number(bound->tilt_stiffness));
}

std::string pad_model_json(const PadModel& model, const PadQuestion& question) {
  const PadProblem& problem = question.problem;
  const PadPrediction p = model.predict(problem);
  std::optional<PadErrors> bound;
  if (question.is_covered) bound = pad_error_bound(model, problem);
  List objections;
  for (const ValidityCheck& check : p.validity)
    if (!check.holds()) objections.add(json_string(check.message));
  if (!question.is_covered)
    objections.add(
        json_string("the object's edge presses into the pad, which these models do not know: no "
                    "bound is known"));
  const double needed = friction_that_sticks(problem.layer.poisson_ratio);
  if (problem.pressing == PadPressing::stuck && problem.load.friction_coefficient < needed) {
    objections.add(json_string(
        fmt::format("below a friction coefficient of {:.2g} the rim slips while it is pressed: "
                    "indentation, stiffness and pressure lie between those of both pressings, and "
                    "only the torque's bound is known",
                    needed)));
    if (bound)
      bound->indentation = bound->peak_pressure = bound->pressure_arm = bound->tilt_stiffness =
          kNaN;
  }
  const auto told = [&](double value) { return json_number(p.has_answer ? value : kNaN); };
  return fmt::format(
      "{{\"name\":{},\"has_answer\":{},\"max_torque_Nm\":{},\"eccentricity_m\":{},"
      "\"pressure_arm_m\":{},\"indentation_m\":{},\"normal_stiffness_N_per_m\":{},"
      "\"peak_pressure_Pa\":{},\"tilt_stiffness_Nm_per_rad\":[{},{}],\"tilt_limit_Nm\":[{},{}],"
      "\"bound\":{},\"usable\":{},\"objections\":{}}}",
      json_string(model.card().name), p.has_answer,
      told(problem.load.friction_coefficient * problem.load.normal_force_N * p.eccentricity_m),
      told(p.eccentricity_m), told(p.pressure_arm_m), told(p.indentation_m),
      told(p.normal_stiffness_N_per_m), told(p.peak_pressure_Pa),
      told(p.tilt_stiffness_Nm_per_rad[0]), told(p.tilt_stiffness_Nm_per_rad[1]),
      told(p.tilt_limit_Nm[0]), told(p.tilt_limit_Nm[1]), pad_bound_json(bound),
      bound && bound->max_torque <= question.tolerance, objections.text());
}

/// The outline's corners and points between them, close enough for a picture.
std::vector<Vector2d> rim_of(const ConvexOutline& outline) {
  constexpr double kPoints = 60;
  const auto& corners = outline.vertices_m();
  std::vector<Vector2d> rim;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d side = corners[(i + 1) % corners.size()] - corners[i];
    const int parts = std::max(1, int(std::lround(kPoints * side.norm() / outline.perimeter_m())));
    for (int part = 0; part < parts; ++part) rim.push_back(corners[i] + side * part / parts);
  }
  return rim;
}

std::string map_json(const PadModel& model, const PadProblem& problem) {
  constexpr int kRings = 18;
  const ConvexOutline& outline = problem.shape->outline();
  const Vector2d& centre = outline.centroid_m();
  const std::vector<Vector2d> rim = rim_of(outline);
  std::array<double, kRings + 1> rings;
  // Closer towards the rim, where the pressure changes fast.
  for (int ring = 0; ring <= kRings; ++ring)
    rings[std::size_t(ring)] = std::sin(kPi / 2 * ring / kRings);
  List points, parts, pressures;
  for (const double part : rings) parts.add(json_number(part));
  for (std::size_t i = 0; i < rim.size(); ++i) {
    points.add(pair_text(rim[i].x(), rim[i].y()));
    const Vector2d middle = (rim[i] + rim[(i + 1) % rim.size()]) / 2;
    for (std::size_t ring = 0; ring < kRings; ++ring)
      pressures.add(json_number(model.pressure_Pa(
          problem, centre + (rings[ring] + rings[ring + 1]) / 2 * (middle - centre))));
  }
  return fmt::format("{{\"rim_m\":{},\"rings\":{},\"pressure_Pa\":{}}}", points.text(),
                     parts.text(), pressures.text());
}

/// Farthest point of the outline from its centroid in a direction of length 1.
double reach_of(const ConvexOutline& outline, const Vector2d& direction) {
  double inside = 0, outside = outline.extent_m().norm();
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = (inside + outside) / 2;
    (outline.contains(outline.centroid_m() + middle * direction) ? inside : outside) = middle;
  }
  return inside;
}

/// Positions and pressures on the line through the centroid.
std::pair<std::string, std::string> line_json(const PadModel& model, const PadProblem& problem,
                                              const Vector2d& axis) {
  constexpr int kSteps = 80;
  const ConvexOutline& outline = problem.shape->outline();
  const double back = -reach_of(outline, -axis), front = reach_of(outline, axis);
  List positions, pressures;
  for (int i = 0; i <= kSteps; ++i) {
    const double at = back + (front - back) * (1 - std::cos(kPi * i / kSteps)) / 2;
    positions.add(json_number(at));
    pressures.add(json_number(model.pressure_Pa(problem, outline.centroid_m() + at * axis)));
  }
  return {positions.text(), pressures.text()};
}

std::string pad_simulators_json(const PadModel& model, const PadProblem& problem,
                                const PadPrediction& prediction) {
  exporting::SoftContact contact = exporting::soft_pad(model, problem, prediction);
  contact.origin = fmt::format("explorer, {}, {:.4g} N", model.card().name, contact.load_N);
  List list;
  for (const exporting::Simulator& simulator : exporting::all_simulators())
    list.add(fmt::format("{{\"name\":{},\"text\":{}}}", json_string(simulator.name),
                         json_string(box_lines(simulator, contact).text + "\n" +
                                     point_lines(simulator, contact).text)));
  return list.text();
}

}  // namespace

std::string pad_answer(const PadQuestion& question) {
  const PadProblem& problem = question.problem;
  const ConvexOutline& outline = problem.shape->outline();
  List models;
  for (const PadModel* model : all_pad_models()) models.add(pad_model_json(*model, question));
  const PadModel& shown = *all_pad_models()[std::size_t(question.shown)];
  const PadPrediction prediction = shown.predict(problem);
  std::string map = "null", profile = "null", simulators = "[]";
  if (prediction.has_answer) {
    map = map_json(shown, problem);
    const auto [x_m, along_x] = line_json(shown, problem, Vector2d::UnitX());
    const auto [y_m, along_y] = line_json(shown, problem, Vector2d::UnitY());
    profile = fmt::format("{{\"x_m\":{},\"along_x_Pa\":{},\"y_m\":{},\"along_y_Pa\":{}}}", x_m,
                          along_x, y_m, along_y);
    simulators = pad_simulators_json(shown, problem, prediction);
  }
  return fmt::format(
      "{{\"models\":{},\"area_m2\":{},\"shape_factor\":{},\"centre_m\":{},\"extent_m\":{},"
      "\"map\":{},\"profile\":{},\"simulators\":{}}}",
      models.text(), json_number(outline.area_m2()),
      json_number(outline.area_m2() / outline.perimeter_m() / problem.layer.thickness_m),
      pair_text(outline.centroid_m().x(), outline.centroid_m().y()),
      pair_text(outline.extent_m().x(), outline.extent_m().y()), map, profile, simulators);
}

}  // namespace softfinger::explorer
