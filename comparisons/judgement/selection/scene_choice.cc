#include "comparisons/judgement/selection/scene_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "comparisons/prediction/answer_json.h"
#include "comparisons/simulation/contact_model.h"
#include "comparisons/text/json_text.h"
#include "softfinger/friction/friction_shape.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::judgement {

using simulation::RecordedContact;
using simulation::Recording;
using simulation::Simulation;

const char* const kContactDetailNames[4] = {"point", "ellipsoid", "limit_surface", "fem_table"};

namespace {

/// How much one pair of bodies was loaded: the worst of all its contacts at all times.
struct PairUse {
  PairChoice choice;
  ContactProblem problem;             ///< at the largest load
  input::EccentricityOverLoad table;  ///< of finite elements, where they are needed
};

using Uses = std::map<std::pair<int, int>, PairUse>;

/// The wrench over (mu P, mu P, mu P e_n).
Eigen::Vector3d scaled_wrench(const RecordedContact& contact) {
  const double limit_N = contact.friction_coefficient * contact.normal_force_N;
  return Eigen::Vector3d(contact.tangent_force_1_N, contact.tangent_force_2_N,
                         contact.torque_Nm / contact.eccentricity_m) /
         limit_N;
}

Uses uses_of(const input::Scene& scene, const Recording& recording) {
  Uses uses;
  for (const auto& frame : recording.frames)
    for (const RecordedContact& contact : frame.contacts) {
      if (!(contact.semi_axis_b_m > 0) || !(contact.eccentricity_m > 0) ||
          !(contact.friction_coefficient > 0))
        continue;  // rigid: a point already
      const auto [entry, is_new] = uses.try_emplace(std::minmax(contact.a, contact.b));
      PairUse& use = entry->second;
      PairChoice& choice = use.choice;
      if (is_new) {
        choice.a = entry->first.first;
        choice.b = entry->first.second;
        choice.least_load_N = choice.largest_load_N = contact.normal_force_N;
      }
      if (is_new || contact.normal_force_N > choice.largest_load_N) {
        simulation::model_of_contact(scene, contact.a, contact.b, contact.radii, use.problem);
        use.problem.load.normal_force_N = contact.normal_force_N;
      }
      choice.least_load_N = std::min(choice.least_load_N, contact.normal_force_N);
      choice.largest_load_N = std::max(choice.largest_load_N, contact.normal_force_N);
      const Eigen::Vector3d wrench = scaled_wrench(contact);
      choice.torsion = std::max(choice.torsion, std::abs(wrench.z()));
      const LimitSurfaceShape shape(contact.semi_axis_b_m / contact.semi_axis_a_m,
                                    contact.pressure_exponent);
      const double exact = friction_gauge(&shape, wrench), ellipsoid = wrench.norm();
      choice.utilisation = std::max(choice.utilisation, std::min(exact, 1.));
      // The choice of the surface only matters where the contact may reach one of the two.
      const double change = std::abs(exact / std::max(ellipsoid, 1e-300) - 1);
      if (std::max(exact, ellipsoid) * (1 + change) >= 1)
        choice.surface_change = std::max(choice.surface_change, change);
    }
  return uses;
}

/// A simulation knows the relative radii, not which body is as curved as that: the choice for a
/// curved finger on a plane or for a curved object on a flat finger, whichever demands more.
Choice choose_for_either_finger(const ContactProblem& problem, const SelectionOptions& options) {
  input::Case contact;
  contact.layer = problem.layer;
  contact.object_layer = problem.object_layer;
  contact.shear_law.friction_coefficient = problem.load.friction_coefficient;
  prediction::LocalGeometry geometry;
  geometry.radii = problem.radii;
  const double load_N = problem.load.normal_force_N;
  Choice flat = choose_model(contact, geometry, load_N, options);
  const input::QuadricBody plane{kInfinity, kInfinity, input::FingerShape::paraboloid, 0};
  const input::QuadricBody finger{problem.radii.major_m, problem.radii.minor_m,
                                  input::FingerShape::ellipsoid, 0};
  contact.geometry = input::BodyPair{finger, plane, 0};
  geometry.radii.axis_rad = 0;
  Choice curved = choose_model(contact, geometry, load_N, options);
  const auto error = [](const Choice& choice) {
    return choice.chosen < 0 ? kInfinity : choice.candidates[std::size_t(choice.chosen)].worst;
  };
  return error(flat) > error(curved) ? flat : curved;
}

void decide(PairUse& use, double tolerance) {
  PairChoice& choice = use.choice;
  // A contact that sticks goes on sticking with a smaller e_n, until its limit meets its wrench.
  // Half of that margin is used, since a smaller e_n also moves load to other contacts.
  const double margin = choice.utilisation > 0 ? 1 - choice.utilisation : 1;
  choice.allowed_error = std::max(tolerance, margin / 2);

  SelectionOptions options;
  options.tolerance = choice.allowed_error;
  options.quantities = {Quantity::max_torque};
  for (const PressureModel* model : all_pressure_models())
    // The most accurate simulation has bonded layers: those of finite strain would differ from it.
    if (model->card().hot_path && !model->card().finite_strain && model->card().name != "power_law")
      options.models.emplace_back(model->card().name);
  choice.pressure = choose_for_either_finger(use.problem, options);

  if (choice.torsion <= tolerance) {
    choice.detail = ContactDetail::point;
    choice.reason = fmt::format("carries {} of the torque that it could", percent(choice.torsion));
    return;
  }
  constexpr double kLongest = 100;  // R'/R'' that finite elements take
  const RelativeRadii& radii = use.problem.radii;
  if (choice.pressure.chosen < 0 &&
      (use.problem.has_object_layer() || !(radii.major_m <= kLongest * radii.minor_m))) {
    choice.detail = ContactDetail::limit_surface;
    choice.model = "bonded_layer";
    choice.reason = "the most accurate there is, its error not known: " + choice.pressure.reason;
    return;
  }
  if (choice.pressure.chosen < 0) {
    choice.detail = ContactDetail::fem_table;
    choice.model = "table";
    choice.reason = "no model is known to be accurate enough: " + choice.pressure.reason;
    return;
  }
  const Candidate& model = choice.pressure.candidates[std::size_t(choice.pressure.chosen)];
  choice.model = model.model;
  const bool exact = choice.surface_change > tolerance;
  choice.detail = exact ? ContactDetail::limit_surface : ContactDetail::ellipsoid;
  choice.reason =
      fmt::format("works at {} of its limit, so e_n may be off by {}; {} is within {}; ",
                  percent(choice.utilisation), percent(choice.allowed_error), model.model,
                  percent(model.worst));
  choice.reason +=
      exact ? fmt::format("at its limit the ellipsoid is off by {}", percent(choice.surface_change))
      : choice.surface_change > 0
          ? fmt::format("at its limit the ellipsoid is off by {} only",
                        percent(choice.surface_change))
          : std::string("where it works ellipsoid and exact limit surface agree");
}

void set_rule(input::Scene& scene, const PairUse& use) {
  const PairChoice& choice = use.choice;
  input::ContactRule rule = scene.rule(choice.a, choice.b);
  rule.friction = choice.detail >= ContactDetail::limit_surface ? &input::kLimitSurfaceLaw
                                                                : &input::kEllipsoidLaw;
  const bool has_own_table = std::holds_alternative<input::EccentricityOverLoad>(rule.model);
  if (choice.detail == ContactDetail::point)
    rule.model = input::RigidPoint{};
  else if (choice.detail == ContactDetail::fem_table)
    rule.model = use.table;
  else if (!has_own_table)
    rule.model = find_pressure_model(choice.model);
  const std::size_t count = scene.bodies.size(), a = std::size_t(choice.a),
                    b = std::size_t(choice.b);
  scene.rule_of_pair[a * count + b] = scene.rule_of_pair[b * count + a] = int(scene.rules.size());
  scene.rules.push_back(rule);
}

/// The model with the smallest known error; null: of none is it known.
const Candidate* nearest_model(const Choice& choice) {
  const Candidate* nearest = nullptr;
  for (const Candidate& candidate : choice.candidates)
    if (candidate.bound && (!nearest || candidate.worst < nearest->worst)) nearest = &candidate;
  return nearest;
}

bool alike(const ContactProblem& first, const ContactProblem& other) {
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); };
  return near(first.radii.major_m, other.radii.major_m) &&
         near(first.radii.minor_m, other.radii.minor_m) &&
         near(first.layer.thickness_m, other.layer.thickness_m) &&
         first.layer.youngs_modulus_Pa == other.layer.youngs_modulus_Pa &&
         first.layer.poisson_ratio == other.layer.poisson_ratio;
}

/// Tables for the pairs that need finite elements; pairs that are alike share one over the loads of
/// them all. Where a model is known as well, the better of the two serves.
/// @returns whether a table serves
bool ask_finite_elements(Uses& uses, const FemTable& fem_table) {
  std::vector<PairUse*> asking;
  for (auto& [pair, use] : uses)
    if (use.choice.detail == ContactDetail::fem_table) asking.push_back(&use);
  bool any = false;
  while (!asking.empty()) {
    const auto others = std::stable_partition(
        asking.begin(), asking.end(),
        [first = asking.front()](PairUse* use) { return alike(first->problem, use->problem); });
    input::EccentricityOverLoad table;
    table.least_load_N = asking.front()->choice.least_load_N;
    for (auto use = asking.begin(); use != others; ++use) {
      table.least_load_N = std::min(table.least_load_N, (*use)->choice.least_load_N);
      table.largest_load_N = std::max(table.largest_load_N, (*use)->choice.largest_load_N);
    }
    table.largest_load_N = std::max(table.largest_load_N, 1.01 * table.least_load_N);
    const FemEccentricity found =
        fem_table(asking.front()->problem, table.least_load_N, table.largest_load_N);
    table.eccentricity_m = found.eccentricity_m;
    const double error = found.error + interpolation_error(found.eccentricity_m);
    for (auto use = asking.begin(); use != others; ++use) {
      PairChoice& choice = (*use)->choice;
      choice.reason += "; the table of finite elements is within " + percent(error);
      if (error > choice.allowed_error) choice.reason += ", no better is known";
      const Candidate* nearest = nearest_model(choice.pressure);
      if (nearest && nearest->worst <= error) {
        choice.detail = ContactDetail::limit_surface;
        choice.model = nearest->model;
        continue;
      }
      (*use)->table = table;
      any = true;
    }
    asking.erase(asking.begin(), others);
  }
  return any;
}

MotionChange change_between(const Recording& accurate, const Recording& chosen) {
  MotionChange change;
  const std::size_t frames = std::min(accurate.frames.size(), chosen.frames.size());
  double worst = -1;
  for (std::size_t b = 0; b < accurate.bodies.size(); ++b) {
    if (!accurate.bodies[b].movable) continue;
    const Eigen::Isometry3d& start = accurate.frames.front().poses[b];
    double position_m = 0, rotation_rad = 0;
    for (std::size_t f = 0; f < frames; ++f) {
      const Eigen::Isometry3d &at = accurate.frames[f].poses[b], &other = chosen.frames[f].poses[b];
      const auto angle = [](const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
        return Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle();
      };
      position_m = std::max(position_m, (at.translation() - other.translation()).norm());
      rotation_rad = std::max(rotation_rad, angle(at, other));
      change.travel_m = std::max(change.travel_m, (at.translation() - start.translation()).norm());
      change.turn_rad = std::max(change.turn_rad, angle(start, at));
    }
    change.position_m = std::max(change.position_m, position_m);
    change.rotation_rad = std::max(change.rotation_rad, rotation_rad);
    if (position_m > worst) {
      worst = position_m;
      change.body = accurate.bodies[b].name;
    }
  }
  return change;
}

bool holds(const MotionChange& change, double tolerance) {
  // Where nothing moves, round-off is not a change.
  constexpr double kStill_m = 1e-9, kStill_rad = 1e-9;
  return change.position_m <= tolerance * change.travel_m + kStill_m &&
         change.rotation_rad <= tolerance * std::max(change.turn_rad, 0.) + kStill_rad;
}

/// @throws ConvergenceError when it does not reach its end
Simulation run(const input::Scene& scene, const char* which) {
  Simulation simulation = simulation::simulate(scene);
  if (!simulation.failure.empty())
    throw ConvergenceError(fmt::format("scene {}, {}", scene.id, which), simulation.steps,
                           simulation.max_residual, simulation.failure);
  return simulation;
}

}  // namespace

double interpolation_error(const std::vector<double>& eccentricity_m) {
  double missed = 0;
  for (std::size_t i = 1; i + 1 < eccentricity_m.size(); ++i)
    missed = std::max(missed, std::abs(std::log(eccentricity_m[i] * eccentricity_m[i] /
                                                (eccentricity_m[i - 1] * eccentricity_m[i + 1]))) /
                                  2);
  return missed / 4;
}

SceneChoice choose_for_scene(const input::Scene& scene, double tolerance, const FemTable& fem_table,
                             const std::function<void(const std::string&)>& progress) {
  SceneChoice result;
  input::Scene accurate = scene;
  accurate.friction.law = &input::kLimitSurfaceLaw;
  for (input::ContactRule& rule : accurate.rules) {
    rule.friction = nullptr;
    // An e_n that the scene gives itself stays. A named model is replaced by the most accurate one.
    if (std::holds_alternative<const PressureModel*>(rule.model))
      rule.model = input::AutomaticModel{};
  }
  progress(fmt::format("{}: {} steps with exact limit surfaces", scene.id, scene.steps()));
  Simulation reference = run(accurate, "the most accurate simulation");

  Uses uses = uses_of(accurate, reference.recording);
  for (auto& [pair, use] : uses) decide(use, tolerance);
  if (ask_finite_elements(uses, fem_table)) {
    for (const auto& [pair, use] : uses)
      if (use.choice.detail == ContactDetail::fem_table) set_rule(accurate, use);
    progress(fmt::format("{}: the same with e_n of finite elements", scene.id));
    reference = run(accurate, "the most accurate simulation");
  }
  result.accurate_step_ms = simulation::percentile(reference.step_ms, 0.5);

  while (true) {
    result.scene = accurate;
    for (const auto& [pair, use] : uses) set_rule(result.scene, use);
    progress(fmt::format("{}: the same with what {} pairs of bodies need", scene.id, uses.size()));
    const Simulation chosen = run(result.scene, "with the models chosen");
    result.chosen_step_ms = simulation::percentile(chosen.step_ms, 0.5);
    result.change = change_between(reference.recording, chosen.recording);
    result.motion_holds = holds(result.change, tolerance);
    if (result.motion_holds) break;
    // More detail where there is least, all pairs of that kind at once.
    ContactDetail least = ContactDetail::limit_surface;
    for (const auto& [pair, use] : uses) least = std::min(least, use.choice.detail);
    bool cheap_model = false;
    for (const auto& [pair, use] : uses)
      cheap_model = cheap_model || (!use.choice.model.empty() && use.choice.model != "table" &&
                                    use.choice.model != "bonded_layer");
    if (least >= ContactDetail::limit_surface && !cheap_model) break;
    ++result.refinements;
    for (auto& [pair, use] : uses) {
      PairChoice& choice = use.choice;
      if (choice.detail == least && least < ContactDetail::limit_surface) {
        choice.detail = ContactDetail(int(least) + 1);
        choice.reason = fmt::format("as {}: the motion would change by {:.3g} mm, {:.3g}°",
                                    kContactDetailNames[int(least)], 1e3 * result.change.position_m,
                                    result.change.rotation_rad * 180 / kPi);
      } else if (least < ContactDetail::limit_surface) {
        continue;
      }
      if (choice.model != "table") choice.model = "bonded_layer";
    }
  }
  for (auto& [pair, use] : uses) result.pairs.push_back(std::move(use.choice));
  return result;
}

nlohmann::json to_json(const SceneChoice& choice, double tolerance) {
  using nlohmann::json;
  json choices = json::array();
  for (const PairChoice& pair : choice.pairs) {
    json entry = to_json(pair.pressure);
    entry["bodies"] = {choice.scene.bodies[std::size_t(pair.a)].name,
                       choice.scene.bodies[std::size_t(pair.b)].name};
    entry["detail"] = kContactDetailNames[int(pair.detail)];
    entry["model"] = pair.detail == ContactDetail::point ? json("rigid") : json(pair.model);
    for (const Candidate& candidate : pair.pressure.candidates)
      if (candidate.model == pair.model) {
        entry["error_estimate"] = prediction::to_json(candidate.bound);
        entry["cost_us"] = text::finite_or_null(candidate.cost_us);
      }
    entry["load_range_N"] = {pair.least_load_N, pair.largest_load_N};
    entry["utilisation"] = pair.utilisation;
    entry["torsion"] = pair.torsion;
    entry["surface_change"] = pair.surface_change;
    entry["allowed_error"] = pair.allowed_error;
    entry["reason"] = pair.reason;
    choices.push_back(entry);
  }
  const MotionChange& change = choice.change;
  return {{"case", choice.scene.id},
          {"scene", choice.scene.id},
          {"tolerance", tolerance},
          {"choices", choices},
          {"motion_holds", choice.motion_holds},
          {"motion_change",
           {{"position_m", change.position_m},
            {"rotation_rad", change.rotation_rad},
            {"travel_m", change.travel_m},
            {"turn_rad", change.turn_rad},
            {"body", change.body}}},
          {"refinements", choice.refinements},
          {"step_ms_accurate", choice.accurate_step_ms},
          {"step_ms_chosen", choice.chosen_step_ms}};
}

std::string table(const SceneChoice& choice, double tolerance) {
  std::string text;
  for (const PairChoice& pair : choice.pairs)
    text += fmt::format("  {:<34}{:<14}{:<20}{:>9.3g} N\n    {}\n",
                        choice.scene.bodies[std::size_t(pair.a)].name + " - " +
                            choice.scene.bodies[std::size_t(pair.b)].name,
                        kContactDetailNames[int(pair.detail)],
                        pair.detail == ContactDetail::point ? "rigid" : pair.model,
                        pair.largest_load_N, pair.reason);
  if (choice.pairs.empty()) text += "  no soft contact carries a load: points are enough\n";
  const MotionChange& change = choice.change;
  text += fmt::format(
      "\n  a step takes {:.3g} ms instead of {:.3g} ms with the bonded layer and exact limit "
      "surfaces "
      "everywhere\n  the motion changes by at most {:.3g} mm of {:.3g} mm ({}) and {:.3g}° of "
      "{:.3g}°: {} "
      "{}\n",
      choice.chosen_step_ms, choice.accurate_step_ms, 1e3 * change.position_m,
      1e3 * change.travel_m, change.body, change.rotation_rad * 180 / kPi,
      change.turn_rad * 180 / kPi, choice.motion_holds ? "within" : "more than",
      percent(tolerance));
  return text;
}

}  // namespace softfinger::judgement
