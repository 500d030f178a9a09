#include "comparisons/judgement/selection/scene_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <variant>

#include "comparisons/prediction/answer_json.h"
#include "comparisons/simulation/contact_model.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/friction/friction_shape.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/stack_models.h"

namespace softfinger::judgement {

using simulation::RecordedContact;
using simulation::Recording;
using simulation::Simulation;

const char* const kContactDetailNames[5] = {"point", "ellipsoid", "six_patches", "limit_surface",
                                            "fem_table"};

namespace {

/// Use of one pair of bodies: the worst of all its contacts at all times.
struct PairUse {
  PairChoice choice;
  FingerContact contact;              ///< at the largest load
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

/// Whether a body is one sphere, so that not only its curvature is known.
bool is_sphere(const input::SceneBody& body) {
  return body.shapes.size() == 1 && std::holds_alternative<input::Sphere>(body.shapes[0].kind);
}

bool has_mesh(const input::SceneBody& body) {
  return std::any_of(body.shapes.begin(), body.shapes.end(), [](const input::Shape& shape) {
    return std::holds_alternative<input::Mesh>(shape.kind);
  });
}

FingerContact finger_contact(const input::Scene& scene, const RecordedContact& contact) {
  FingerContact result;
  ContactProblem& problem = result.problem;
  problem = *simulation::soft_contact(scene, contact.a, contact.b, contact.radii);
  problem.load.normal_force_N = contact.normal_force_N;
  problem.finger_curvature = contact.finger_curvature;
  const input::SceneBody &a = scene.bodies[std::size_t(contact.a)],
                         &b = scene.bodies[std::size_t(contact.b)];
  result.is_finger_spherical = is_sphere(a.layer ? a : b);
  problem.is_object_spherical = is_sphere(a.layer ? b : a);
  result.has_mesh = has_mesh(a) || has_mesh(b);
  return result;
}

/// Finite elements take one layer, on a finger that is nowhere hollow, and no contact that is
/// nearly a line.
bool takes_finite_elements(const ContactProblem& problem) {
  constexpr double kLongest = 100;  // R'/R''
  const SurfaceCurvature& finger = problem.finger_curvature;
  const double mean_per_m = (finger.xx_per_m + finger.yy_per_m) / 2;
  const double spread_per_m = std::hypot((finger.xx_per_m - finger.yy_per_m) / 2, finger.xy_per_m);
  const bool is_hollow = mean_per_m < spread_per_m - 1e-6 / problem.radii.minor_m;
  return !problem.has_object_layer() && !is_hollow &&
         problem.radii.major_m <= kLongest * problem.radii.minor_m;
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
        use.contact = finger_contact(scene, contact);
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

/// The choice for the finger as it is curved in the scene.
Choice choose_for_finger(const ContactProblem& problem, const SelectionOptions& options) {
  input::Case contact;
  contact.layer = problem.layer;
  contact.object_layer = problem.object_layer;
  contact.shear_law.friction_coefficient = problem.load.friction_coefficient;
  prediction::LocalGeometry geometry;
  geometry.radii = problem.radii;
  geometry.finger_curvature = problem.finger_curvature;
  geometry.is_object_spherical = problem.is_object_spherical;
  return choose_model(contact, geometry, problem.load.normal_force_N, options);
}

/// Fingers that mirror each other meet the same curvature but for the places that they happen to
/// touch, and for how finely a mesh is cut.
bool alike(const FingerContact& one, const FingerContact& another) {
  constexpr double kNear = 0.02;
  const ContactProblem &first = one.problem, &other = another.problem;
  // The finger's part of the relative curvature.
  const auto near_part = [](double a, double b, double radius_m) {
    return std::abs(a - b) * radius_m <= kNear;
  };
  const SurfaceCurvature &of_first = first.finger_curvature, &of_other = other.finger_curvature;
  const double mean_m = std::sqrt(first.radii.major_m) * std::sqrt(first.radii.minor_m);
  const auto near = [](double a, double b) { return std::abs(a - b) <= kNear * std::abs(b); };
  const auto same = [](const ElasticLayer& layer, const ElasticLayer& compared) {
    return layer.thickness_m == compared.thickness_m &&
           layer.youngs_modulus_Pa == compared.youngs_modulus_Pa &&
           layer.poisson_ratio == compared.poisson_ratio;
  };
  return near(first.radii.major_m, other.radii.major_m) &&
         near(first.radii.minor_m, other.radii.minor_m) && same(first.layer, other.layer) &&
         first.has_object_layer() == other.has_object_layer() &&
         (!first.has_object_layer() || same(first.object_layer, other.object_layer)) &&
         first.load.friction_coefficient == other.load.friction_coefficient &&
         near_part(of_first.xx_per_m, of_other.xx_per_m, first.radii.major_m) &&
         near_part(of_first.yy_per_m, of_other.yy_per_m, first.radii.minor_m) &&
         // Fingers that mirror each other twist the other way.
         near_part(std::abs(of_first.xy_per_m), std::abs(of_other.xy_per_m), mean_m) &&
         first.is_object_spherical == other.is_object_spherical &&
         one.is_finger_spherical == another.is_finger_spherical;
}

/// Gives pairs that are alike the same demands: the largest of each.
void share_demands(Uses& uses) {
  std::vector<PairUse*> left;
  for (auto& [pair, use] : uses) left.push_back(&use);
  while (!left.empty()) {
    const auto others = std::stable_partition(
        left.begin(), left.end(),
        [first = left.front()](PairUse* use) { return alike(first->contact, use->contact); });
    PairChoice most = left.front()->choice;
    FingerContact contact = left.front()->contact;
    for (auto use = left.begin(); use != others; ++use) {
      const PairChoice& own = (*use)->choice;
      most.least_load_N = std::min(most.least_load_N, own.least_load_N);
      if (own.largest_load_N > most.largest_load_N) {
        most.largest_load_N = own.largest_load_N;
        contact = (*use)->contact;
      }
      most.utilisation = std::max(most.utilisation, own.utilisation);
      most.torsion = std::max(most.torsion, own.torsion);
      most.surface_change = std::max(most.surface_change, own.surface_change);
    }
    for (auto use = left.begin(); use != others; ++use) {
      PairChoice& own = (*use)->choice;
      most.a = own.a;
      most.b = own.b;
      own = most;
      (*use)->contact = contact;
    }
    left.erase(left.begin(), others);
  }
}

/// The cheapest friction law that is enough near the limit.
/// @param surface_change  how far the ellipsoid is off there
const input::FrictionLaw* sufficient_friction(double surface_change, double tolerance) {
  // Relative error of six patches for any ellipse; see six_patch_surface.h.
  constexpr double kPatches = 0.021;
  if (surface_change <= tolerance) return &input::kEllipsoidLaw;
  return kPatches <= tolerance ? &input::kSixPatchesLaw : &input::kLimitSurfaceLaw;
}

/// The model that the most accurate simulation gives these bodies.
std::string default_model_name(const PairUse& use) {
  return std::string(default_model(use.contact.problem).card().name);
}

void decide(PairUse& use, double tolerance) {
  PairChoice& choice = use.choice;
  // A contact that sticks goes on sticking with a smaller e_n, until its limit meets its wrench.
  // Half of that margin is used, since a smaller e_n also moves load to other contacts.
  const double margin = choice.utilisation > 0 ? 1 - choice.utilisation : 1;
  choice.allowed_error = std::max(tolerance, margin / 2);

  SelectionOptions options;
  options.demand.tolerance = choice.allowed_error;
  options.demand.quantities.fill(false);
  options.demand.quantities[std::size_t(Quantity::max_torque)] = true;
  for (const PressureModel* model : all_pressure_models())
    if (model->card().hot_path && !model->card().is_empirical &&
        (!is_for_stacks(*model) || use.contact.problem.stack.count > 0 ||
         use.contact.problem.has_object_layer()))
      options.models.emplace_back(model->card().name);
  choice.pressure = choose_for_finger(use.contact.problem, options);
  choice.friction = sufficient_friction(choice.surface_change, tolerance);

  if (choice.torsion <= tolerance) {
    choice.detail = ContactDetail::point;
    choice.reason =
        fmt::format("carries {} of the torque that it could", text::percent(choice.torsion));
    return;
  }
  if (choice.pressure.chosen < 0 && !takes_finite_elements(use.contact.problem)) {
    choice.detail = ContactDetail::limit_surface;
    choice.friction = &input::kLimitSurfaceLaw;
    choice.model = default_model_name(use);
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
  const bool is_ellipsoid = choice.friction == &input::kEllipsoidLaw;
  constexpr double kRoundOff = 1e-9;
  choice.detail = is_ellipsoid                                ? ContactDetail::ellipsoid
                  : choice.friction == &input::kSixPatchesLaw ? ContactDetail::six_patches
                                                              : ContactDetail::limit_surface;
  choice.reason =
      fmt::format("works at {} of its limit, so e_n may be off by {}; {} is within {}; ",
                  text::percent(choice.utilisation), text::percent(choice.allowed_error),
                  model.model, text::percent(model.worst));
  choice.reason += !is_ellipsoid ? fmt::format("at its limit the ellipsoid is off by {}",
                                               text::percent(choice.surface_change))
                   : choice.surface_change > kRoundOff
                       ? fmt::format("at its limit the ellipsoid is off by {} only",
                                     text::percent(choice.surface_change))
                       : std::string("where it works ellipsoid and exact limit surface agree");
}

void set_rule(input::Scene& scene, const PairUse& use) {
  const PairChoice& choice = use.choice;
  input::ContactRule rule = scene.rule(choice.a, choice.b);
  rule.friction = choice.detail == ContactDetail::point ? &input::kEllipsoidLaw : choice.friction;
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
        [first = asking.front()](PairUse* use) { return alike(first->contact, use->contact); });
    input::EccentricityOverLoad table;
    table.least_load_N = asking.front()->choice.least_load_N;
    for (auto use = asking.begin(); use != others; ++use) {
      table.least_load_N = std::min(table.least_load_N, (*use)->choice.least_load_N);
      table.largest_load_N = std::max(table.largest_load_N, (*use)->choice.largest_load_N);
    }
    table.largest_load_N = std::max(table.largest_load_N, 1.01 * table.least_load_N);
    const FemEccentricity found =
        fem_table(asking.front()->contact, table.least_load_N, table.largest_load_N);
    table.eccentricity_m = found.eccentricity_m;
    const double error = found.error + interpolation_error(found.eccentricity_m);
    for (auto use = asking.begin(); use != others; ++use) {
      PairChoice& choice = (*use)->choice;
      choice.reason +=
          "; the table of finite elements of the finger itself is within " + text::percent(error);
      if ((*use)->contact.has_mesh) choice.reason += ", for the quadrics fitted to the meshes";
      if (error > choice.allowed_error) choice.reason += ", no better is known";
      const Candidate* nearest = nearest_model(choice.pressure);
      if (nearest && nearest->worst <= error) {
        choice.detail = ContactDetail::limit_surface;
        choice.friction = &input::kLimitSurfaceLaw;
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

/// Differences below these can come from round-off and the solver's residual, summed over the
/// steps.
constexpr double kStill_m = 1e-9, kStill_rad = 1e-9;

bool holds(const MotionChange& change, double tolerance) {
  // Round-off is not a change, even where nothing moves.
  return change.position_m <= tolerance * change.travel_m + kStill_m &&
         change.rotation_rad <= tolerance * std::max(change.turn_rad, 0.) + kStill_rad;
}

const input::FrictionLaw* law_of(ContactDetail detail) {
  return detail == ContactDetail::six_patches     ? &input::kSixPatchesLaw
         : detail == ContactDetail::limit_surface ? &input::kLimitSurfaceLaw
                                                  : &input::kEllipsoidLaw;
}

/// More detail where there is least, all pairs of that kind at once; then the most accurate models
/// and friction laws.
/// @returns whether there was any to add
bool refine(Uses& uses, const MotionChange& change) {
  ContactDetail least = ContactDetail::limit_surface;
  bool any_cheap = false;
  for (const auto& [pair, use] : uses) {
    const PairChoice& choice = use.choice;
    least = std::min(least, choice.detail);
    any_cheap = any_cheap || choice.friction != &input::kLimitSurfaceLaw ||
                (!choice.model.empty() && choice.model != "table" &&
                 choice.model != default_model_name(use));
  }
  if (least >= ContactDetail::limit_surface && !any_cheap) return false;
  for (auto& [pair, use] : uses) {
    PairChoice& choice = use.choice;
    const auto would_change = [&](const std::string& as) {
      return fmt::format("as {}: the motion would change {}", as, in_words(change));
    };
    if (least >= ContactDetail::limit_surface) {
      if (choice.friction != &input::kLimitSurfaceLaw)
        choice.reason += "; " + would_change(std::string(choice.friction->name));
      choice.friction = &input::kLimitSurfaceLaw;
    } else if (choice.detail == least) {
      choice.reason = would_change(kContactDetailNames[int(least)]);
      choice.detail = ContactDetail(int(least) + 1);
      choice.friction = law_of(choice.detail);
    } else {
      continue;
    }
    if (choice.model != "table") choice.model = default_model_name(use);
  }
  return true;
}

/// See SceneChoice. A table is looked up in a tenth of a microsecond.
double models_step_ms(const Uses& uses) {
  constexpr double kTable_us = 0.1;
  constexpr int kRounds = 2;
  double cost_us = 0;
  for (const auto& [pair, use] : uses) {
    const PairChoice& choice = use.choice;
    if (choice.model == "table") cost_us += kRounds * kTable_us;
    for (const Candidate& candidate : choice.pressure.candidates)
      if (candidate.model == choice.model && std::isfinite(candidate.cost_us))
        cost_us += kRounds * candidate.cost_us;
  }
  return 1e-3 * cost_us;
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

namespace {

/// Takes the contacts' utilisation from the reference with tables: the e_n before was not the
/// finger's.
void take_utilisation(const input::Scene& accurate, const Recording& reference, double tolerance,
                      Uses& uses) {
  Uses again = uses_of(accurate, reference);
  share_demands(again);
  for (auto& [pair, use] : uses) {
    const auto found = again.find(pair);
    if (found == again.end()) continue;
    PairChoice& choice = use.choice;
    const PairChoice& now = found->second.choice;
    choice.utilisation = now.utilisation;
    choice.torsion = now.torsion;
    choice.surface_change = now.surface_change;
    if (choice.detail == ContactDetail::fem_table)
      choice.friction = sufficient_friction(choice.surface_change, tolerance);
  }
}

}  // namespace

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
  progress(fmt::format("{}: {} steps as it is written", scene.id, scene.steps()));
  result.plain = run(scene, "as it is written").recording;
  progress(fmt::format("{}: the same with exact limit surfaces", scene.id));
  Simulation reference = run(accurate, "the most accurate simulation");

  Uses uses = uses_of(accurate, reference.recording);
  share_demands(uses);
  for (auto& [pair, use] : uses) decide(use, tolerance);
  if (ask_finite_elements(uses, fem_table)) {
    for (const auto& [pair, use] : uses)
      if (use.choice.detail == ContactDetail::fem_table) {
        PairUse exact = use;
        exact.choice.friction = &input::kLimitSurfaceLaw;
        set_rule(accurate, exact);
      }
    progress(fmt::format("{}: the same with e_n of finite elements", scene.id));
    reference = run(accurate, "the most accurate simulation");
    result.reference_has_tables = true;
    take_utilisation(accurate, reference.recording, tolerance, uses);
  }
  result.accurate_step_ms = simulation::percentile(reference.step_ms, 0.5);

  while (true) {
    result.scene = accurate;
    for (const auto& [pair, use] : uses) set_rule(result.scene, use);
    progress(fmt::format("{}: the same with what {} pairs of bodies need", scene.id, uses.size()));
    Simulation chosen = run(result.scene, "with the models chosen");
    result.chosen_step_ms = simulation::percentile(chosen.step_ms, 0.5);
    result.change = change_between(reference.recording, chosen.recording);
    result.motion_holds = holds(result.change, tolerance);
    result.chosen = std::move(chosen.recording);
    if (result.motion_holds) break;
    if (!refine(uses, result.change)) break;
    ++result.refinements;
  }
  result.plain_change = change_between(result.plain, result.chosen);
  result.models_step_ms = models_step_ms(uses);
  for (auto& [pair, use] : uses) result.pairs.push_back(std::move(use.choice));
  return result;
}

std::string reference_in_words(const SceneChoice& choice) {
  return choice.reference_has_tables ? "e_n of finite elements where no model is known to be "
                                       "accurate enough, the recommended "
                                       "model elsewhere, and exact limit surfaces"
                                     : "the recommended model and exact limit surfaces everywhere";
}

std::string in_words(const MotionChange& change) {
  const auto part = [](double changed, double moved, double still, double unit, const char* name) {
    if (!(moved > still) && !(changed > still)) return std::string();
    return (changed > still ? fmt::format("at most {:.3g}{}", unit * changed, name)
                            : fmt::format("less than {:.1g}{}", unit * still, name)) +
           (moved > still ? fmt::format(" of {:.3g}{}", unit * moved, name) : " of none");
  };
  const std::string place = part(change.position_m, change.travel_m, kStill_m, 1e3, " mm"),
                    turn = part(change.rotation_rad, change.turn_rad, kStill_rad, 180 / kPi, "°");
  if (place.empty() && turn.empty()) return "not at all: nothing moves";
  return "by " + place + (place.empty() || turn.empty() ? "" : " and ") + turn +
         (turn.empty() ? ", nothing turns" : "") + " (" + change.body + ")";
}

std::string saving_in_words(const SceneChoice& choice) {
  // The medians of two runs of the same scene differ by less than this on a quiet machine.
  constexpr double kWorthwhile = 0.1;
  const double saved = 1 - choice.chosen_step_ms / choice.accurate_step_ms;
  const std::string models = fmt::format("the pressure models take {:.2g} µs of a step's {:.3g} µs",
                                         1e3 * choice.models_step_ms, 1e3 * choice.chosen_step_ms);
  if (!(choice.accurate_step_ms > 0)) return "nothing was simulated";
  if (saved >= kWorthwhile)
    return fmt::format(
        "a step saves {} of its {:.3g} µs, by the friction laws and what the solver needs for "
        "them: {}",
        text::percent(saved), 1e3 * choice.accurate_step_ms, models);
  return fmt::format(
      "there is no time to save in this scene: {}, and the rest, finding contacts and solving for "
      "them, remains whatever the models are",
      models);
}

nlohmann::json to_json(const SceneChoice& choice, double tolerance) {
  using nlohmann::json;
  json choices = json::array();
  for (const PairChoice& pair : choice.pairs) {
    json entry = to_json(pair.pressure);
    entry["bodies"] = {choice.scene.bodies[std::size_t(pair.a)].name,
                       choice.scene.bodies[std::size_t(pair.b)].name};
    entry["detail"] = kContactDetailNames[int(pair.detail)];
    entry["friction"] = pair.detail == ContactDetail::point ? "none" : pair.friction->name;
    entry["model"] = pair.detail == ContactDetail::point ? json("rigid") : json(pair.model);
    for (const Candidate& candidate : pair.pressure.candidates)
      if (candidate.model == pair.model) {
        entry["error_bound"] = prediction::to_json(candidate.bound);
        entry["cost_us"] = text::finite_or_null(candidate.cost_us);
      }
    entry["load_range_N"] = {pair.least_load_N, pair.largest_load_N};
    entry["utilisation"] = pair.utilisation;
    entry["torsion"] = pair.torsion;
    entry["surface_change"] = pair.surface_change;
    entry["allowed_error"] = pair.allowed_error;
    entry["reason"] = pair.reason;
    if (const auto* samples =
            std::get_if<input::EccentricityOverLoad>(&choice.scene.rule(pair.a, pair.b).model))
      entry["eccentricity_table"] = {{"loads_N", {samples->least_load_N, samples->largest_load_N}},
                                     {"eccentricity_m", samples->eccentricity_m}};
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
          {"motion_change_in_words", in_words(change)},
          {"reference", reference_in_words(choice)},
          {"refinements", choice.refinements},
          {"step_ms_accurate", choice.accurate_step_ms},
          {"step_ms_chosen", choice.chosen_step_ms},
          {"step_ms_models", choice.models_step_ms},
          {"saving", saving_in_words(choice)}};
}

std::string table(const SceneChoice& choice, double tolerance) {
  std::string text;
  for (const PairChoice& pair : choice.pairs)
    text += fmt::format("  {:<34}{:<14}{:<16}{:<14}{:>9.3g} N\n    {}\n",
                        choice.scene.bodies[std::size_t(pair.a)].name + " - " +
                            choice.scene.bodies[std::size_t(pair.b)].name,
                        kContactDetailNames[int(pair.detail)],
                        pair.detail == ContactDetail::point ? "rigid" : pair.model,
                        pair.detail == ContactDetail::point ? "" : pair.friction->name,
                        pair.largest_load_N, pair.reason);
  if (choice.pairs.empty()) text += "  no soft contact carries a load: points are enough\n";
  text += "\n  " + saving_in_words(choice) + "\n";
  text += fmt::format(
      "  a step takes {:.3g} ms instead of {:.3g} ms with {}\n"
      "  against that the motion changes {}: {} {}\n",
      choice.chosen_step_ms, choice.accurate_step_ms, reference_in_words(choice),
      in_words(choice.change), choice.motion_holds ? "within" : "more than",
      text::percent(tolerance));
  return text;
}

}  // namespace softfinger::judgement
