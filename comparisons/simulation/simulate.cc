#include "comparisons/simulation/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <unordered_map>
#include <variant>

#include "comparisons/input/recorded_contacts.h"
#include "comparisons/simulation/collision.h"
#include "comparisons/simulation/contact_creep.h"
#include "comparisons/simulation/contact_model.h"
#include "comparisons/simulation/presliding_contacts.h"
#include "comparisons/simulation/shape_pair.h"
#include "comparisons/simulation/soft_faces.h"
#include "softfinger/accuracy/error_bound.h"
#include "softfinger/dynamics/step/time_stepper.h"
#include "softfinger/friction/linearised_friction.h"
#include "softfinger/friction/shear_limit.h"
#include "softfinger/pressure/equivalent_exponent.h"

namespace softfinger::simulation {
namespace {

using Clock = std::chrono::steady_clock;

/// e_n, and the friction coefficient under a shear law other than Coulomb's, at a load by a
/// pressure model. Nothing is kept, for the model takes only a microsecond, and ten with such a
/// law.
class ModelEccentricity final : public EccentricityLaw {
 public:
  ModelEccentricity(const PressureModel& model, const ContactProblem& problem, const ShearLaw& law,
                    const EffectiveLoad& effective)
      : model_(model), problem_(problem), law_(law), effective_(effective) {}

  double eccentricity_m(double load_N) const noexcept override {
    if (!(load_N > 0)) return 0;
    const Prediction prediction = predict(load_N);
    return law_.has_shear_strength() ? limit(prediction, load_N).eccentricity_m
                                     : prediction.torque_arm_exact_m;
  }
  std::optional<double> friction_coefficient(double load_N) const noexcept override {
    if (!law_.has_shear_strength()) return std::nullopt;
    return effective_friction(limit(predict(load_N), load_N), load_N);
  }
  /// n of the pressure (1 - s²)^n with the same largest torque over largest force: its limit
  /// surface stands for that of the law within 1 %, exactly so under a constant stress.
  double limit_exponent(Prediction prediction, double load_N) const {
    if (law_.has_shear_strength())
      prediction.torque_arm_exact_m = limit(prediction, load_N).eccentricity_m;
    return equivalent_exponent(prediction);
  }
  Prediction predict(double load_N) const noexcept { return model_.predict(problem_at(load_N)); }
  const PressureModel& model() const { return model_; }
  /// The elastic contact that is as large as this one under a load.
  ContactProblem problem_at(double load_N) const {
    ContactProblem at_load = problem_;
    at_load.load.normal_force_N = effective_.of(load_N);
    return at_load;
  }

 private:
  FrictionEllipsoid limit(const Prediction& prediction, double load_N) const noexcept {
    if (!prediction.has_answer) return {};
    return friction_ellipsoid(
        law_, {prediction.a_m, prediction.b_m, equivalent_exponent(prediction), load_N});
  }

  const PressureModel& model_;
  ContactProblem problem_;
  ShearLaw law_;
  EffectiveLoad effective_;
};

/// The touching points of the bodies as contacts with friction.
class SceneContacts final : public ContactFinder {
 public:
  /// The description from which a contact was made.
  struct Origin {
    RelativeRadii radii{0, 0, 0};                 ///< zero: a point contact
    const ModelEccentricity* pressure = nullptr;  ///< null: no pressure model
    const input::FrictionLaw* friction = nullptr;
  };

  explicit SceneContacts(const input::Scene& scene)
      : scene_(scene), detector_(scene), faces_(scene) {
    for (const input::ContactRule& rule : scene.rules)
      if (const auto* table = std::get_if<input::EccentricityOverLoad>(&rule.model))
        tables_.emplace(&rule, SampledEccentricity(table->least_load_N, table->largest_load_N,
                                                   table->eccentricity_m));
  }

  void find(const Multibody& bodies, double time_step_s, std::vector<Contact>& contacts) override {
    points_.clear();
    presliding_.clear();
    origins_.clear();
    pressures_.clear();
    shapes_.clear();
    detector_.find(bodies, time_step_s, points_);
    forget_creep_of_others();
    for (const TouchingPoint& point : points_) contacts.push_back(contact_at(point));
    const std::size_t first = contacts.size();
    faces_.describe(points_, bodies, contacts);
    for (std::size_t i = first; i < contacts.size(); ++i) {
      const Contact& friction = contacts[i];
      origins_[friction.id].friction = &input::kEllipsoidLaw;
      if (!scene_.rule(friction.a, friction.b).presliding) continue;
      const SoftFaces::Face& face = *faces_.face(friction);
      presliding_.add_face(friction.id, face.stuck, face.aspect, face.size,
                           relaxation_of(friction.a, friction.b));
    }
    presliding_.prepare(bodies, time_step_s, contacts);
  }
  /// After a step that is done.
  void settle(const TimeStepper& stepper) {
    presliding_.settle(stepper);
    faces_.settle(stepper);
    for (int i = 0; i < int(stepper.contacts().size()); ++i) {
      const auto creep = creep_.find(stepper.contacts()[std::size_t(i)].id);
      if (creep != creep_.end())
        creep->second.hold(stepper.wrench(i).normal_force_N, scene_.time_step_s);
    }
  }
  /// The soft flat face that a contact belongs to; null: a point of its own.
  const SoftFaces::Face* face(const Contact& contact) const { return faces_.face(contact); }

  CollisionDetector& detector() { return detector_; }
  /// Origin of a contact that the last `find` returned.
  const Origin& origin(const Contact& contact) const { return origins_.at(contact.id); }

 private:
  Contact contact_at(const TouchingPoint& point) {
    const input::ContactRule& rule = scene_.rule(point.a, point.b);
    Contact contact;
    contact.a = point.a;
    contact.b = point.b;
    contact.point_m = point.point_m;
    contact.axes = point.axes;
    contact.gap_m = point.gap_m;
    contact.friction_coefficient = rule.shear_law.friction_coefficient;
    contact.restitution = rule.restitution;
    if (const auto* given = std::get_if<input::GivenEccentricity>(&rule.model))
      contact.eccentricity_m = given->eccentricity_m;
    contact.id = point.id;
    if (!point.elliptic) contact.face = pair_of(point.id);
    Origin& origin = origins_[point.id];
    origin.friction = &scene_.friction_law(point.a, point.b);
    if (point.elliptic) {
      origin.radii = point.radii;
      add_pressure(point, rule, origin, contact);
    }
    // A law that needs the pressure is replaced where none is known.
    if (origin.friction->shape && !contact.shape) origin.friction = &input::kEllipsoidLaw;
    return contact;
  }

  void add_pressure(const TouchingPoint& point, const input::ContactRule& rule, Origin& origin,
                    Contact& contact) {
    const auto soft = soft_contact(scene_, point.a, point.b, point.radii);
    if (!soft) return;
    ContactProblem problem = *soft;
    // The layer follows the curvature of the body that carries it.
    const SurfaceCurvature& of_a = point.curvature_of_a;
    const bool a_is_finger = scene_.bodies[std::size_t(point.a)].layer.has_value();
    problem.finger_curvature =
        a_is_finger ? of_a
                    : SurfaceCurvature{1 / point.radii.major_m - of_a.xx_per_m,
                                       1 / point.radii.minor_m - of_a.yy_per_m, -of_a.xy_per_m};
    problem.is_object_spherical = a_is_finger ? point.b_is_sphere : point.a_is_sphere;
    const PressureModel& model = model_of_contact(scene_, point.a, point.b, problem);
    const Relaxation& relaxation = relaxation_of(point.a, point.b);
    EffectiveLoad effective;
    if (!relaxation.is_elastic())
      effective = creep_.try_emplace(contact.id, relaxation).first->second.over(scene_.time_step_s);
    origin.pressure = &pressures_.emplace_back(model, problem, rule.shear_law, effective);
    contact.eccentricity_law = origin.pressure;
    if (rule.presliding) presliding_.add(contact.id, model, problem, effective, relaxation);
    if (const auto table = tables_.find(&rule); table != tables_.end())
      contact.eccentricity_law = &table->second;
    if (!origin.friction->shape) return;
    // The shape changes little with the load: that of the nominal one.
    const Prediction nominal = origin.pressure->predict(scene_.nominal_load_N);
    if (!nominal.has_answer) return;
    shapes_.push_back(
        origin.friction->shape(nominal.b_m / nominal.a_m,
                               origin.pressure->limit_exponent(nominal, scene_.nominal_load_N)));
    contact.shape = shapes_.back().get();
  }

  /// Elastic where two layers have no common modulus: `UnknownContacts` tells of them.
  const Relaxation& relaxation_of(int a, int b) {
    const auto [known, is_new] = relaxations_.try_emplace({a, b});
    if (is_new)
      known->second =
          common_relaxation(scene_.bodies[std::size_t(a)], scene_.bodies[std::size_t(b)])
              .value_or(Relaxation());
    return known->second;
  }

  void forget_creep_of_others() {
    if (creep_.empty()) return;
    std::set<long> here;
    for (const TouchingPoint& point : points_) here.insert(point.id);
    for (auto creep = creep_.begin(); creep != creep_.end();)
      creep = here.count(creep->first) ? std::next(creep) : creep_.erase(creep);
  }

  const input::Scene& scene_;
  std::map<std::pair<int, int>, Relaxation> relaxations_;
  std::unordered_map<long, ContactCreep> creep_;  ///< by the contact's id
  std::map<const input::ContactRule*, SampledEccentricity> tables_;
  CollisionDetector detector_;
  std::vector<TouchingPoint> points_;
  std::unordered_map<long, Origin> origins_;  ///< by the contact's id
  std::deque<ModelEccentricity> pressures_;   ///< a deque: contacts point into it
  PreslidingContacts presliding_;
  SoftFaces faces_;
  std::vector<std::unique_ptr<const FrictionShape>> shapes_;
};

/// A contact sticks when its slip is below this, in m/s: a nanometre per second, or the error of
/// the solver's velocities, where that is larger.
double least_slip_m_per_s(const TimeStepper& stepper, const StepResult& step) {
  return std::max(1e-9, step.lcp.residual * stepper.free_velocity().lpNorm<Eigen::Infinity>());
}

/// See RecordedContact. @param shape  that the law built for the contact; null: the ellipsoid
double utilisation(const RecordedContact& contact, const FrictionShape* shape) {
  const double limit_N = contact.friction_coefficient * contact.normal_force_N;
  // A contact without e_n has no torque; round-off of it would have an infinite utilisation.
  const double torque_Nm = contact.eccentricity_m > 0 ? contact.torque_Nm : 0;
  const double used =
      shape && contact.eccentricity_m > 0
          ? friction_gauge(shape,
                           Eigen::Vector3d(contact.tangent_force_1_N, contact.tangent_force_2_N,
                                           torque_Nm / contact.eccentricity_m)) /
                limit_N
          : FrictionEllipsoid{limit_N, contact.eccentricity_m}.utilisation(
                contact.tangent_force_1_N, contact.tangent_force_2_N, torque_Nm);
  return std::isfinite(used) ? used : 0;
}

RecordedContact recorded(const TimeStepper& stepper, int index, const SceneContacts& finder,
                         const input::Scene& scene, double least_slip_m_per_s) {
  const Contact& contact = stepper.contacts()[std::size_t(index)];
  const SceneContacts::Origin& origin = finder.origin(contact);
  const ContactWrench wrench = stepper.wrench(index);
  RecordedContact result;
  result.a = contact.a;
  result.b = contact.b;
  result.point_m = contact.point_m;
  result.axes = contact.axes;
  result.normal_force_N = wrench.normal_force_N;
  result.tangent_force_1_N = wrench.tangent_force_1_N;
  result.tangent_force_2_N = wrench.tangent_force_2_N;
  result.torque_Nm = wrench.torque_Nm;
  result.friction_coefficient = stepper.friction_coefficient(index);
  result.eccentricity_m = stepper.eccentricity_m(index);
  result.friction = origin.friction;
  result.radii = origin.radii;
  result.model =
      std::holds_alternative<input::GivenEccentricity>(scene.rule(contact.a, contact.b).model)
          ? "given"
      : finder.face(contact) ? "pad_layer"
                             : "rigid";
  if (origin.pressure) {
    const Prediction prediction = origin.pressure->predict(wrench.normal_force_N);
    result.semi_axis_a_m = prediction.a_m;
    result.semi_axis_b_m = prediction.b_m;
    result.pressure_exponent = origin.pressure->limit_exponent(prediction, wrench.normal_force_N);
    result.model = std::string(origin.pressure->model().card().name);
    result.finger_curvature = origin.pressure->problem_at(1).finger_curvature;
  }
  result.utilisation = utilisation(result, contact.shape);
  // The solver's own decision: its slip lambda is complementary to what is left of the friction
  // limit, so that it is not zero only where the contact is at the limit of its law.
  result.slides = stepper.solution().slip[index] > least_slip_m_per_s;
  return result;
}

/// Collects the soft contacts of which nothing is known, once for each pair of bodies and reason.
class UnknownContacts {
 public:
  explicit UnknownContacts(const input::Scene& scene) : scene_(scene) {}

  void look_at(const TimeStepper& stepper, const SceneContacts& finder) {
    seen_.clear();
    for (int i = 0; i < int(stepper.contacts().size()); ++i) {
      const double load_N = stepper.wrench(i).normal_force_N;
      if (load_N > 0) look_at(stepper.contacts()[std::size_t(i)], load_N, stepper.time_s(), finder);
    }
  }
  std::vector<UnknownContact> found() const {
    std::vector<UnknownContact> all;
    for (const auto& [key, contact] : found_) all.push_back(contact);
    return all;
  }

 private:
  using Key = std::tuple<int, int, std::string>;

  void look_at(const Contact& contact, double load_N, double time_s, const SceneContacts& finder) {
    const input::ContactModel& model = scene_.rule(contact.a, contact.b).model;
    const bool is_soft =
        scene_.bodies[std::size_t(contact.a)].layer || scene_.bodies[std::size_t(contact.b)].layer;
    // Who gives e_n, or wants a point, knows what he does.
    if (!is_soft || finder.face(contact) || std::holds_alternative<input::RigidPoint>(model) ||
        std::holds_alternative<input::GivenEccentricity>(model) ||
        std::holds_alternative<input::EccentricityOverLoad>(model))
      return;
    const ModelEccentricity* pressure = finder.origin(contact).pressure;
    if (!pressure) {
      UnknownContact& point = add(contact, "", time_s);
      point.load_N = std::max(point.load_N, load_N);
      return;
    }
    const ContactProblem problem = pressure->problem_at(load_N);
    const Prediction prediction = pressure->predict(load_N);
    if (!common_relaxation(scene_.bodies[std::size_t(contact.a)],
                           scene_.bodies[std::size_t(contact.b)]))
      note(contact, "of two layers that relax differently, taken as if neither did", problem,
           prediction, load_N, time_s);
    const ErrorBound bound = error_bound(problem, prediction);
    if (!bound.known) note(contact, bound.outside, problem, prediction, load_N, time_s);
  }

  void note(const Contact& contact, const std::string& why, const ContactProblem& problem,
            const Prediction& prediction, double load_N, double time_s) {
    UnknownContact& unknown = add(contact, why, time_s);
    const double thickness_m = problem.layer.thickness_m;
    unknown.load_N = std::max(unknown.load_N, load_N);
    unknown.slope = std::max({unknown.slope, prediction.a_m / problem.radii.major_m,
                              prediction.b_m / problem.radii.minor_m});
    unknown.strain = std::max(unknown.strain, prediction.indentation_m / thickness_m);
    unknown.size = std::max(unknown.size, std::sqrt(prediction.a_m * prediction.b_m) / thickness_m);
  }

  UnknownContact& add(const Contact& contact, const std::string& why, double time_s) {
    const auto [a, b] = std::minmax(contact.a, contact.b);
    const Key key{a, b, why};
    const auto [entry, is_new] = found_.try_emplace(key);
    UnknownContact& unknown = entry->second;
    if (is_new) {
      unknown.a = a;
      unknown.b = b;
      unknown.why = why;
      unknown.first_s = time_s;
    }
    // Several contacts of two bodies count once.
    if (seen_.insert(key).second) ++unknown.steps;
    return unknown;
  }

  const input::Scene& scene_;
  std::map<Key, UnknownContact> found_;
  std::set<Key> seen_;  ///< in this step
};

/// The bodies where they are, without contacts.
Frame bodies_now(const TimeStepper& stepper) {
  const Multibody& bodies = stepper.bodies();
  Frame result;
  result.time_s = stepper.time_s();
  for (int b = 0; b < bodies.bodies(); ++b) {
    result.poses.push_back(bodies.pose(b));
    result.velocities_m_per_s.push_back(bodies.moves(b)
                                            ? bodies.velocity_at(b, bodies.center_of_mass_m(b))
                                            : Eigen::Vector3d::Zero());
    result.angular_velocities_rad_per_s.push_back(bodies.moves(b) ? bodies.angular_velocity(b)
                                                                  : Eigen::Vector3d::Zero());
  }
  return result;
}

/// The bodies and their contacts at the end of a step.
Frame frame_after(const StepResult& step, const TimeStepper& stepper, const SceneContacts& finder,
                  const input::Scene& scene) {
  Frame result = bodies_now(stepper);
  const double least_slip = least_slip_m_per_s(stepper, step);
  for (int i = 0; i < int(stepper.contacts().size()); ++i) {
    // The points of a soft face are seen in the contact of its friction.
    if (stepper.contacts()[std::size_t(i)].role == Contact::FaceRole::soft_point) continue;
    const ContactWrench wrench = stepper.wrench(i);
    if (wrench.normal_force_N > 0)
      result.contacts.push_back(recorded(stepper, i, finder, scene, least_slip));
  }
  return result;
}

/// Forces near the largest floating-point numbers can overflow in a step that counts as solved. No
/// file should hold the result.
bool is_finite(const Frame& frame) {
  bool finite = true;
  for (std::size_t b = 0; b < frame.poses.size(); ++b)
    finite = finite && frame.poses[b].matrix().allFinite() &&
             frame.velocities_m_per_s[b].allFinite() &&
             frame.angular_velocities_rad_per_s[b].allFinite();
  for (const RecordedContact& contact : frame.contacts)
    finite = finite && contact.point_m.allFinite() && contact.axes.allFinite() &&
             std::isfinite(contact.normal_force_N) && std::isfinite(contact.tangent_force_1_N) &&
             std::isfinite(contact.tangent_force_2_N) && std::isfinite(contact.torque_Nm) &&
             std::isfinite(contact.eccentricity_m);
  return finite;
}

std::string describe_failure(const TimeStepper& stepper, const StepResult& step) {
  const char* what = step.lcp.proof == RayProof::infeasible ? "no impulses keep the bodies apart"
                     : step.lcp.status == LcpStatus::infeasible_or_ray
                         ? "friction jams them"
                         : "the contact problem was not solved within the iteration limit";
  std::string contacts;
  const Eigen::VectorXd& ray = stepper.solution().ray;
  const double most = ray.size() > 0 ? ray.cwiseAbs().maxCoeff() : 0;
  int named = 0;
  for (int i = 0; i < int(stepper.contacts().size()); ++i) {
    const Contact& contact = stepper.contacts()[std::size_t(i)];
    const bool takes_part =
        most > 0 ? ray.segment<4>(4 * i).cwiseAbs().maxCoeff() > 1e-9 * most : true;
    if (!takes_part || ++named > 8) continue;
    contacts += fmt::format("{}\"{}\" and \"{}\" at ({:.4g}, {:.4g}, {:.4g}) mm",
                            contacts.empty() ? "" : "; ", stepper.bodies().body(contact.a).name,
                            stepper.bodies().body(contact.b).name, 1e3 * contact.point_m.x(),
                            1e3 * contact.point_m.y(), 1e3 * contact.point_m.z());
  }
  return fmt::format("step {} at {:.6g} s has no solution: {}: {}", stepper.steps() + 1,
                     stepper.time_s(), what, contacts);
}

/// The solver has one rule for all contacts of a step. A contact without a shape of its own has the
/// ellipsoid under the rule for shapes, so that this rule holds ellipsoids and shapes together; the
/// scene's reader sees to it that facets are not mixed with others.
FrictionRule solver_rule(const input::Scene& scene) {
  for (const input::ContactRule& rule : scene.rules)
    if (rule.friction && rule.friction->shape) return rule.friction->solver_rule;
  return scene.friction.law->solver_rule;
}

TimeStepper stepper_of(const input::Scene& scene) {
  TimeStepper::Options options;
  options.time_step_s = scene.time_step_s;
  options.friction_rule = solver_rule(scene);
  const LinearisedFriction facets(scene.friction.vertices);
  options.friction_vertices.resize(3, facets.count());
  for (int i = 0; i < facets.count(); ++i)
    options.friction_vertices.col(i) = facets.vertices()[std::size_t(i)];
  Multibody bodies(scene.descriptions, scene.joints, scene.loops);
  if (scene.start_velocity.size() > 0) bodies.set_velocity(scene.start_velocity);
  TimeStepper stepper(std::move(bodies), scene.motors, options);
  for (const input::ForceOverTime& force : scene.forces)
    stepper.applied_forces().push_back(
        {force.body, force.point_in_body_m, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  return stepper;
}

/// Sets gravity, motors and forces to what the scene wants at the end of the coming step.
void command(TimeStepper& stepper, const input::Scene& scene) {
  const double time_s = stepper.time_s() + scene.time_step_s;
  stepper.set_gravity(scene.gravity.value(time_s));
  for (const input::Motion& motion : scene.motions) {
    Motor& motor = stepper.motors()[std::size_t(motion.motor)];
    if (motion.is_effort) {
      motor.feed_forward = motion.table.value(time_s)[0];
    } else {
      motor.target = motion.table.value(time_s)[0];
      motor.target_velocity = motion.table.rate(time_s)[0];
    }
  }
  for (std::size_t f = 0; f < scene.forces.size(); ++f) {
    const Eigen::VectorXd values = scene.forces[f].table.value(time_s);
    stepper.applied_forces()[f].force_N = values.head<3>();
    stepper.applied_forces()[f].torque_Nm = values.tail<3>();
  }
}

Recording empty_recording(const input::Scene& scene, const Multibody& bodies) {
  Recording recording;
  recording.scene = scene.id;
  recording.question = scene.question;
  recording.time_step_s = scene.time_step_s;
  for (int b = 0; b < bodies.bodies(); ++b) {
    const input::SceneBody& body = scene.bodies[std::size_t(b)];
    recording.bodies.push_back({body.name, bodies.moves(b), body.shapes});
  }
  return recording;
}

/// Counts a step that is done.
void count(const StepResult& step, Simulation& result) {
  ++result.steps;
  result.max_residual = std::max(result.max_residual, step.lcp.residual);
  result.most_contacts = std::max(result.most_contacts, step.contacts);
  result.most_load_iterations = std::max(result.most_load_iterations, step.load_iterations);
  result.max_load_disagreement = std::max(result.max_load_disagreement, step.load_disagreement);
  result.motor_disagreements += !step.motors_agree;
}

}  // namespace

std::string in_words(const UnknownContact& contact, const std::vector<RecordedBody>& bodies,
                     int steps) {
  const std::string who =
      bodies[std::size_t(contact.a)].name + " – " + bodies[std::size_t(contact.b)].name;
  const std::string when = fmt::format("in {} of {} steps, first at {:.4g} s, up to {:.3g} N",
                                       contact.steps, steps, contact.first_s, contact.load_N);
  if (contact.why.empty())
    return fmt::format(
        "{}: soft, but taken as rigid points without torque where they touch at a flat face, an "
        "edge, along a line or in a saddle: there is no ellipse ({})",
        who, when);
  return fmt::format(
      "{}: how far off its e_n is cannot be said, it is {}: {}; slope at the edge up to {:.2g}, "
      "indentation {:.2g} and size sqrt(ab) {:.3g} times the layer's thickness",
      who, contact.why, when, contact.slope, contact.strain, contact.size);
}

double percentile(std::vector<double> values, double p) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double rank = p * double(values.size() - 1);
  return values[std::size_t(std::lround(rank))];
}

SeparatedBodies separate_overlapping_bodies(input::Scene& scene) {
  SeparatedBodies result;
  const auto found = CollisionDetector(scene).overlaps(stepper_of(scene).bodies());
  if (found.empty()) return result;
  const auto rule = int(scene.rules.size());
  scene.rules.push_back({});
  scene.rules.back().collide = false;
  const auto in_quotes = [&](int body) {
    std::string quoted = "\"";
    for (const char letter : scene.bodies[std::size_t(body)].name) {
      if (letter == '"' || letter == '\\') quoted += '\\';
      quoted += letter;
    }
    return quoted + "\"";
  };
  const std::size_t count = scene.bodies.size();
  for (const CollisionDetector::Overlap& overlap : found) {
    const auto a = std::size_t(overlap.a), b = std::size_t(overlap.b);
    scene.rule_of_pair[a * count + b] = scene.rule_of_pair[b * count + a] = rule;
    const std::string first = in_quotes(overlap.a), second = in_quotes(overlap.b);
    result.tables +=
        fmt::format("[[contact]]\nbodies = [{}, {}]\ncollide = false\n\n", first, second);
    result.remarks.push_back(
        fmt::format("{} and {} overlap by {:.3g} mm at the start: they pass through each other",
                    first, second, overlap.depth_m * 1e3));
  }
  return result;
}

Simulation simulate(const input::Scene& scene, const SimulationOptions& options) {
  Simulation result;
  TimeStepper stepper = stepper_of(scene);
  SceneContacts finder(scene);
  finder.detector().require_no_overlap(stepper.bodies());
  UnknownContacts unknown(scene);
  Recording& recording = result.recording;
  recording = empty_recording(scene, stepper.bodies());
  recording.frames.push_back(bodies_now(stepper));
  options.reached(recording, stepper);

  for (int step = 0; step < scene.steps(); ++step) {
    if (!options.go_on(step)) {
      result.interrupted = true;
      break;
    }
    const auto start = Clock::now();
    command(stepper, scene);
    options.command(stepper);
    StepResult stepped;
    try {
      stepped = stepper.step(finder);
    } catch (const CollisionError& error) {
      result.failure =
          fmt::format("step {} at {:.6g} s: {}", step + 1, stepper.time_s(), error.what());
      break;
    }
    result.step_ms.push_back(
        std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    if (!options.record_lcp.empty() && stepper.free_velocity().size() > 0)
      input::write_recorded_contacts(stepper.problem(), stepper.options().friction_vertices,
                                     fmt::format("{} step {}", scene.id, step + 1),
                                     options.record_lcp / fmt::format("step_{:06d}.txt", step + 1));
    if (!stepped.done()) {
      ++result.lcp_failures;
      result.failure = describe_failure(stepper, stepped);
      break;
    }
    finder.settle(stepper);
    Frame reached = frame_after(stepped, stepper, finder, scene);
    if (!is_finite(reached)) {
      result.failure = fmt::format(
          "step {} at {:.6g} s gives positions, velocities or forces that are not finite; hint: "
          "look for a force, mass or velocity that is too large or too small by powers of ten",
          stepper.steps(), stepper.time_s());
      break;
    }
    count(stepped, result);
    unknown.look_at(stepper, finder);
    if (!options.keeps_frames) recording.frames.clear();
    recording.frames.push_back(std::move(reached));
    options.reached(recording, stepper);
  }
  for (const double ms : result.step_ms) result.wall_s += 1e-3 * ms;
  recording.unknown = unknown.found();
  result.quadric_fits = finder.detector().fits();
  return result;
}

}  // namespace softfinger::simulation
