#include "comparisons/prediction/pad_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "comparisons/prediction/answer_json.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"
#include "softfinger/pads/pad_law.h"

namespace softfinger::prediction {
namespace {

/// Evenly spread twists about a centre, for a contact of arm e: speed and e omega together are 1.
std::vector<Twist> spread_twists(double arm_m, int count) {
  const double golden_angle = kPi * (3 - std::sqrt(5.0));
  std::vector<Twist> twists;
  for (int i = 0; i < count; ++i) {
    const double height = 1 - (2 * i + 1.0) / count;
    const double speed = std::sqrt(1 - height * height);
    twists.push_back(
        {speed * std::cos(golden_angle * i), speed * std::sin(golden_angle * i), height / arm_m});
  }
  return twists;
}

double median_cost_ns(const PadModel& model, const PadProblem& problem, double budget_ns) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  double spent = 0;
  while (times.empty() || (spent < budget_ns && times.size() < 1000)) {
    const auto start = Clock::now();
    model.predict(problem);
    times.push_back(std::chrono::duration<double, std::nano>(Clock::now() - start).count());
    spent += times.back();
  }
  std::nth_element(times.begin(), times.begin() + std::ptrdiff_t(times.size() / 2), times.end());
  return times[times.size() / 2];
}

nlohmann::json bound_json(const PadAnswer& answer) {
  if (!answer.bound) return nullptr;
  const PadErrors& bound = *answer.bound;
  return {{"a", nullptr},
          {"b", nullptr},
          {"area", text::finite_or_null(answer.bound_of(Quantity::area))},
          {"indentation", text::finite_or_null(bound.indentation)},
          {"peak_pressure", text::finite_or_null(bound.peak_pressure)},
          {"max_torque", text::finite_or_null(bound.max_torque)},
          {"pressure_arm", text::finite_or_null(bound.pressure_arm)},
          {"normal_stiffness", text::finite_or_null(bound.indentation)},
          {"tilt_stiffness", text::finite_or_null(bound.tilt_stiffness)},
          {"tangential_stiffness", text::finite_or_null(bound.tangential_stiffness)},
          {"torsional_stiffness", text::finite_or_null(bound.torsional_stiffness)}};
}

/// Distance by which a fillet moves the outline that bears further out.
double bearing_distance_m(const input::PadPair& pair, const ElasticLayer& layer) {
  if (pair.curved || pair.covered < 1) return 0;
  const double radius_m = pair.finger.edge_radius_m;
  return 0.95 * radius_m / (1 + 1.75 * radius_m / layer.thickness_m);
}

/// A fillet's part in the bounds: what finite elements of squares and of 4 : 1 (fillets to 0.4 of
/// the thickness, nu 0.3 and 0.49) leave of its effect, the largest of each.
void widen_by_fillet(const input::PadPair& pair, const ElasticLayer& layer, PadErrors& bound) {
  const ConvexOutline& face = pair.contact;
  const double further =
      bearing_distance_m(pair, layer) * face.perimeter_m() / (2 * face.area_m2());
  bound.max_torque += 0.45 * further;
  bound.pressure_arm += 0.45 * further;
  bound.indentation += 1.6 * further;
  bound.peak_pressure += 2 * further;
  bound.tilt_stiffness += 2.5 * further;
  bound.tangential_stiffness += 2 * further;
  bound.torsional_stiffness += 2 * further;
}

/// A bound, or why there is none.
void assess_pad(const input::PadPair& pair, const Demand& demand, PadAnswer& answer) {
  if (answer.prediction.has_answer) answer.bound = pad_error_bound(*answer.model, answer.problem);
  if (answer.bound) widen_by_fillet(pair, answer.problem.layer, *answer.bound);
  answer.evidence =
      answer.problem.cylinder
          ? "95 % of finite-element runs of whole pads (linear) that line_layer was not fitted to"
      : answer.model->card().name == "pad_uniform"
          ? "its distance from pad_layer, and pad_layer's own bound"
          : "95 % of finite-element runs of whole pads (linear) that pad_layer was not fitted to";
  if (pair.covered < kCovered) {
    answer.bound.reset();
    answer.prediction.validity.add(
        {"covered", pair.covered, kCovered, false,
         "the object's face ends within the pad: its edge presses into the rubber beside it, which "
         "these models do not know"});
  }
  if (!answer.bound) {
    answer.evidence = "no bound is known";
    for (const ValidityCheck& check : answer.prediction.validity)
      if (!check.holds() && std::string(check.check) != "poisson_ratio")
        answer.evidence = std::string("no bound is known: ") + check.message;
    const double size_m = answer.problem.shape->size_m();
    if (size_m > pads::kLargestWidth * answer.problem.layer.thickness_m)
      answer.evidence = fmt::format(
          "no bound is known: its torque arm is that of a disc of radius {:.3g} mm, "
          "and errors are known to {:g} times the thickness, {:.3g} mm",
          1e3 * size_m, pads::kLargestWidth,
          1e3 * pads::kLargestWidth * answer.problem.layer.thickness_m);
  }
  const double needed = friction_that_sticks(answer.problem.layer.poisson_ratio);
  const double mu = answer.problem.load.friction_coefficient;
  if (answer.problem.pressing == PadPressing::stuck && mu < needed) {
    answer.prediction.validity.add(
        {"friction_sticks", mu, needed, false,
         "with so little friction the rim slips while it is pressed: indentation, stiffness and "
         "pressure lie between those of pressing = \"stuck\" and \"frictionless\"; the largest "
         "torque is the same"});
    if (answer.bound) {
      answer.bound->indentation = answer.bound->peak_pressure = answer.bound->pressure_arm =
          answer.bound->tilt_stiffness = kNaN;
      answer.evidence +=
          "; the friction does not hold the rim, so that only the torque's bound is known";
    }
  }
  double worst = 0;
  for (std::size_t q = 0; q < kQuantities; ++q)
    if (demand.quantities[q]) worst = std::max(worst, answer.bound_of(Quantity(q)));
  answer.usable = answer.bound && worst <= demand.tolerance;
}

std::string describe_curved(const input::PadPair& pair, const ElasticLayer& layer) {
  const Eigen::Vector2d sides_mm = 1e3 * pair.pad.extent_m();
  const auto radius = [](double radius_m) {
    return std::isinf(radius_m) ? std::string("inf") : fmt::format("{:.4g}", 1e3 * radius_m);
  };
  if (pair.is_roller)
    return fmt::format(
        "roller, a line of {:.4g} mm across a relative radius of {} mm, {:.3g} thicknesses long, "
        "pressed without friction",
        sides_mm.x(), radius(pair.curved->radius_y_m), 1e-3 * sides_mm.x() / layer.thickness_m);
  return fmt::format(
      "flat pad of {:.4g} x {:.4g} mm under an object of the radii {} and {} mm, pressed without "
      "friction",
      sides_mm.x(), sides_mm.y(), radius(pair.curved->radius_x_m), radius(pair.curved->radius_y_m));
}

}  // namespace

double PadAnswer::area_m2() const { return (1 - prediction.lifted_share) * contact().area_m2(); }

ConvexOutline PadAnswer::contact() const {
  if (!problem.cylinder || !prediction.has_answer) return face;
  return ConvexOutline::rounded_rectangle(face.extent_m().x(), 2 * prediction.half_width_m)
      .moved(0, {prediction.centre_x_m, prediction.centre_y_m});
}

double PadAnswer::bound_of(Quantity quantity) const {
  if (!bound) return kInfinity;
  const auto known = [](double error) { return std::isfinite(error) ? error : kInfinity; };
  if (quantity == Quantity::indentation) return known(bound->indentation);
  if (quantity == Quantity::peak_pressure) return known(bound->peak_pressure);
  if (quantity == Quantity::max_torque) return known(bound->max_torque);
  if (quantity == Quantity::area) return bound->area;
  return 0;
}

ConvexOutline bearing_outline(const input::Case& contact_case) {
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  const double further_m = bearing_distance_m(pair, contact_case.layer);
  return further_m > 0 ? pair.contact.expanded(further_m) : pair.contact;
}

std::vector<const PadModel*> pad_models_by_name(const std::string& names, bool under_cylinder) {
  const std::vector<const PadModel*> possible =
      under_cylinder ? std::vector<const PadModel*>{&line_layer()} : all_pad_models();
  if (names == "all" || names == "everything") return possible;
  std::vector<std::string> known;
  for (const PadModel* model : possible) known.emplace_back(model->card().name);
  std::vector<const PadModel*> models;
  for (std::size_t start = 0; start <= names.size();) {
    const std::size_t end = std::min(names.find(',', start), names.size());
    const std::string name = names.substr(start, end - start);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw InputError("command line",
                       "--model: \"" + text::shortened(name) + "\" is no model of " +
                           (under_cylinder ? "line contacts" : "flat pads"),
                       "", text::joined(known) + ", all");
    const PadModel* model = possible[std::size_t(found - known.begin())];
    if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
    start = end + 1;
  }
  return models;
}

PadAnswer ask_pad_model(const PadModel& model, const input::Case& contact_case,
                        const PadShape& shape, double load_N, const Demand& demand,
                        double budget_ns) {
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  PadAnswer answer;
  answer.model = &model;
  answer.face = pair.contact;
  answer.problem = {
      &shape,        contact_case.layer, {load_N, contact_case.shear_law.friction_coefficient},
      pair.pressing, pair.load_at_m,     {}};
  if (pair.curved && pair.curved->is_cylinder())
    answer.problem.cylinder = CylinderOnPad{pair.curved->radius_y_m, pair.offset_m.y()};
  answer.prediction = model.predict(answer.problem);
  answer.cost_ns = median_cost_ns(model, answer.problem, budget_ns);
  assess_pad(pair, demand, answer);
  return answer;
}

void refuse_tipping(const input::PadPair& pair, const PadAnswer& answer) {
  if (!pair.load_at_m || answer.prediction.has_answer) return;
  const Eigen::Vector2d middle_m = pair.contact.centroid_m();
  const auto stands = [&](double share) {
    PadProblem nearer = answer.problem;
    nearer.load_at_m = middle_m + share * (*pair.load_at_m - middle_m);
    return answer.model->predict(nearer).has_answer;
  };
  if (!stands(0)) return;  // the load's place is not the reason
  double known = 0, unknown = 1;
  while (unknown - known > 1e-3) {
    const double share = (known + unknown) / 2;
    (stands(share) ? known : unknown) = share;
  }
  const Eigen::Vector2d at_mm = 1e3 * *pair.load_at_m,
                        most_mm = 1e3 * (middle_m + known * (*pair.load_at_m - middle_m));
  throw InputError(pair.load_at_where, "load_at_mm",
                   fmt::format("[{:.4g}, {:.4g}]", at_mm.x(), at_mm.y()),
                   fmt::format("to [{:.4g}, {:.4g}] in this direction: beyond, nearly all of the "
                               "face has lifted off and the pad is about to tip",
                               most_mm.x(), most_mm.y()));
}

double indentation_at_load_m(const PadAnswer& answer) {
  const PadPrediction& p = answer.prediction;
  if (!answer.problem.load_at_m) return p.indentation_m;
  const Eigen::Vector2d from_middle_m =
      *answer.problem.load_at_m - answer.problem.shape->outline().centroid_m();
  // A turn about x makes the pad deeper along y.
  return p.indentation_m + p.tilt_rad[1] * from_middle_m.x() + p.tilt_rad[0] * from_middle_m.y();
}

SampledPressure limit_surface_of(const PadAnswer& answer) {
  const auto samples = answer.model->slipping_pressure(answer.problem);
  const double area_m2 = answer.contact().area_m2() / double(samples.size());
  return {samples, answer.problem.load.friction_coefficient, std::sqrt(area_m2 / kPi)};
}

PadEllipsoidDeviation ellipsoid_deviation_of(const PadAnswer& answer,
                                             const SampledPressure& surface) {
  constexpr int kTwists = 800;
  const FrictionEllipsoid ellipsoid = answer.friction_ellipsoid();
  PadEllipsoidDeviation deviation;
  for (const Twist& twist : spread_twists(ellipsoid.eccentricity_m, kTwists)) {
    const LimitWrench wrench = surface.wrench_for_twist(twist);
    const double apart =
        ellipsoid.utilisation(wrench.force_x_N, wrench.force_y_N, wrench.torque_Nm) - 1;
    deviation.lowest = std::min(deviation.lowest, apart);
    deviation.highest = std::max(deviation.highest, apart);
  }
  return deviation;
}

nlohmann::json to_json(const PadAnswer& answer, int limit_surface_points) {
  const PadPrediction& p = answer.prediction;
  const ConvexOutline outline = answer.contact();
  const bool is_line = answer.problem.cylinder.has_value();
  const FrictionEllipsoid limit = answer.friction_ellipsoid();
  const auto number = [&](double value) {
    return p.has_answer ? text::finite_or_null(value) : nlohmann::json();
  };
  // A line's model leaves at zero those numbers that it does not state.
  const auto of_pad = [&](double value) {
    return is_line && value == 0 ? nlohmann::json() : number(value);
  };
  const auto pair = [&](const std::array<double, 2>& values) {
    return nlohmann::json{of_pad(values[0]), of_pad(values[1])};
  };
  nlohmann::json points = nlohmann::json::array();
  for (const Eigen::Vector2d& vertex : outline.vertices_m())
    points.push_back({vertex.x(), vertex.y()});
  nlohmann::json result = {
      {"load_N", answer.problem.load.normal_force_N},
      {"model", answer.model->card().name},
      {"contact", is_line ? "line" : "patch"},
      {"a_m", is_line ? number(outline.extent_m().x() / 2) : nlohmann::json()},
      {"b_m", is_line ? number(p.half_width_m) : nlohmann::json()},
      {"axis_rad", is_line ? nlohmann::json(0) : nlohmann::json()},
      {"area_m2", answer.area_m2()},
      {"area_projected_m2", answer.area_m2()},
      {"outline_m", points},
      {"shape_factor",
       outline.area_m2() / outline.perimeter_m() / answer.problem.layer.thickness_m},
      {"pressing", answer.problem.pressing == PadPressing::stuck ? "stuck" : "frictionless"},
      {"indentation_m", number(p.indentation_m)},
      {"normal_stiffness_N_per_m", number(p.normal_stiffness_N_per_m)},
      {"peak_pressure_Pa", number(p.peak_pressure_Pa)},
      {"centre_of_pressure_m", {number(p.centre_x_m), number(p.centre_y_m)}},
      {"pressure_arm_m", number(p.pressure_arm_m)},
      {"eccentricity_m", number(p.eccentricity_m)},
      {"shear_law", "coulomb"},
      {"max_force_N", number(limit.max_force_N)},
      {"max_torque_Nm", number(limit.max_torque_Nm())},
      {"torque_rule", "exact"},
      {"tilt_limit_Nm", pair(p.tilt_limit_Nm)},
      {"tilt_utilisation", number(p.tilt_utilisation)},
      {"lifted_share", number(p.lifted_share)},
      {"tilt_rad", {number(p.tilt_rad[0]), number(p.tilt_rad[1])}},
      {"tilt_stiffness_Nm_per_rad", pair(p.tilt_stiffness_Nm_per_rad)},
      {"torsional_stiffness_Nm_per_rad", of_pad(p.torsional_stiffness_Nm_per_rad)},
      {"tangential_stiffness_N_per_m", pair(p.tangential_stiffness_N_per_m)},
      {"rolling_stiffness_Nm_per_rad", {nullptr, nullptr}},
      {"valid", answer.usable},
      {"validity", to_json(p.validity)},
      {"usable", answer.usable},
      {"error_bound", bound_json(answer)},
      {"error_evidence", answer.evidence},
      {"geometry_error", nullptr},
      {"cost_ns", answer.cost_ns}};
  if (limit_surface_points <= 0) return result;
  nlohmann::json& surface_points = result["limit_surface"] = nlohmann::json::array();
  result["limit_surface_model"] = result["ellipsoid_deviation"] = nullptr;
  if (!p.has_answer || !(limit.max_torque_Nm() > 0)) return result;
  const SampledPressure surface = limit_surface_of(answer);
  const PadEllipsoidDeviation deviation = ellipsoid_deviation_of(answer, surface);
  result["limit_surface_model"] = "exact";
  result["ellipsoid_deviation"] = {deviation.lowest, deviation.highest};
  for (const Twist& twist : spread_twists(limit.eccentricity_m, limit_surface_points)) {
    const LimitWrench point = surface.wrench_for_twist(twist);
    surface_points.push_back(
        {{"fx_N", point.force_x_N}, {"fy_N", point.force_y_N}, {"torque_Nm", point.torque_Nm}});
  }
  return result;
}

std::string describe(const input::PadPair& pair, const ElasticLayer& layer) {
  if (pair.curved) return describe_curved(pair, layer);
  const ConvexOutline& contact = pair.contact;
  const Eigen::Vector2d extent_mm = 1e3 * contact.extent_m();
  std::string words = fmt::format(
      "flat pad, contact {:.4g} x {:.4g} mm of {:.4g} mm², shape factor S = area/(perimeter h) = "
      "{:.3g}, pressed {}",
      extent_mm.x(), extent_mm.y(), 1e6 * contact.area_m2(),
      contact.area_m2() / contact.perimeter_m() / layer.thickness_m,
      pair.pressing == PadPressing::stuck ? "stuck" : "without friction");
  if (pair.covered < 1)
    words += fmt::format("; the object's face covers {:.0f} % of the pad", 100 * pair.covered);
  return words;
}

}  // namespace softfinger::prediction
