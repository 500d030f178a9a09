#include "comparisons/simulation/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <map>

#include "comparisons/input/recorded_contacts.h"
#include "comparisons/prediction/equivalent_exponent.h"
#include "comparisons/simulation/collision.h"
#include "comparisons/simulation/contact_model.h"
#include "softfinger/dynamics/time_stepper.h"
#include "softfinger/friction/linearised_friction.h"

namespace softfinger::simulation {
namespace {

using Clock = std::chrono::steady_clock;

/// e_n at a load by a pressure model, asked anew each time: it takes a microsecond.
class ModelEccentricity final : public EccentricityLaw {
 public:
  ModelEccentricity(const PressureModel& model, const ContactProblem& problem)
      : model_(model), problem_(problem) {}

  double eccentricity_m(double load_N) const noexcept override {
    return load_N > 0 ? predict(load_N).torque_arm_exact_m : 0;
  }
  Prediction predict(double load_N) const noexcept {
    ContactProblem at_load = problem_;
    at_load.load.normal_force_N = load_N;
    return model_.predict(at_load);
  }
  const PressureModel& model() const { return model_; }

 private:
  const PressureModel& model_;
  ContactProblem problem_;
};

/// The touching points of the bodies as contacts with friction.
class SceneContacts final : public ContactFinder {
 public:
  explicit SceneContacts(const input::Scene& scene)
      : scene_(scene),
        all_exact_(scene.friction.rule == input::FrictionSettings::Rule::limit_surface),
        detector_(scene) {
    for (const input::ContactRule& rule : scene.rules)
      if (const auto& table = rule.eccentricity_table; !table.eccentricity_m.empty())
        tables_.emplace(&rule, SampledEccentricity(table.least_load_N, table.largest_load_N,
                                                   table.eccentricity_m));
  }

  void find(const Multibody& bodies, double time_step_s, std::vector<Contact>& contacts) override {
    points_.clear();
    laws_.clear();
    law_of_point_.clear();
    shapes_.clear();
    detector_.find(bodies, time_step_s, points_);
    for (const TouchingPoint& point : points_) {
      const input::ContactRule& rule = scene_.rule(point.a, point.b);
      Contact contact;
      contact.a = point.a;
      contact.b = point.b;
      contact.point_m = point.point_m;
      contact.axes = point.axes;
      contact.gap_m = point.gap_m;
      contact.friction_coefficient = rule.friction_coefficient;
      contact.eccentricity_m = rule.model == "given" ? rule.eccentricity_m : 0;
      contact.id = point.id;
      ContactProblem problem;
      const PressureModel* model =
          point.elliptic ? model_of_contact(scene_, point.a, point.b, point.radii, problem)
                         : nullptr;
      if (model) {
        laws_.emplace_back(*model, problem);
        contact.eccentricity_law = &laws_.back();
        if (const auto table = tables_.find(&rule); table != tables_.end())
          contact.eccentricity_law = &table->second;
        if (rule.exact_limit_surface.value_or(all_exact_)) {
          // The shape changes little with the load: that of the nominal one.
          const Prediction nominal = laws_.back().predict(scene_.nominal_load_N);
          if (nominal.has_answer) {
            shapes_.emplace_back(nominal.b_m / nominal.a_m,
                                 prediction::equivalent_exponent(nominal));
            contact.shape = &shapes_.back();
          }
        }
      }
      law_of_point_.push_back(model ? &laws_.back() : nullptr);
      contacts.push_back(contact);
    }
  }

  CollisionDetector& detector() { return detector_; }
  const ModelEccentricity* law(const Contact& contact) const {
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (points_[i].id == contact.id) return law_of_point_[i];
    return nullptr;
  }
  RelativeRadii radii(const Contact& contact) const {
    for (const TouchingPoint& point : points_)
      if (point.id == contact.id && point.elliptic) return point.radii;
    return {0, 0, 0};
  }

 private:
  const input::Scene& scene_;
  bool all_exact_;
  std::map<const input::ContactRule*, SampledEccentricity> tables_;
  CollisionDetector detector_;
  std::vector<TouchingPoint> points_;
  std::deque<ModelEccentricity> laws_;  ///< deques: contacts point into them
  std::deque<LimitSurfaceShape> shapes_;
  std::vector<const ModelEccentricity*> law_of_point_;
};

Frame frame(const TimeStepper& stepper, const input::Scene& scene, const SceneContacts& finder,
            bool with_contacts) {
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
  if (!with_contacts) return result;
  for (int i = 0; i < int(stepper.contacts().size()); ++i) {
    const Contact& contact = stepper.contacts()[std::size_t(i)];
    const ContactWrench wrench = stepper.wrench(i);
    if (!(wrench.normal_force_N > 0)) continue;
    RecordedContact recorded;
    recorded.a = contact.a;
    recorded.b = contact.b;
    recorded.point_m = contact.point_m;
    recorded.axes = contact.axes;
    recorded.normal_force_N = wrench.normal_force_N;
    recorded.tangent_force_1_N = wrench.tangent_force_1_N;
    recorded.tangent_force_2_N = wrench.tangent_force_2_N;
    recorded.torque_Nm = wrench.torque_Nm;
    recorded.friction_coefficient = contact.friction_coefficient;
    recorded.eccentricity_m = stepper.eccentricity_m(i);
    recorded.model = scene.rule(contact.a, contact.b).model == "given" ? "given" : "rigid";
    recorded.radii = finder.radii(contact);
    if (const ModelEccentricity* law = finder.law(contact)) {
      const Prediction prediction = law->predict(wrench.normal_force_N);
      recorded.semi_axis_a_m = prediction.a_m;
      recorded.semi_axis_b_m = prediction.b_m;
      recorded.pressure_exponent = prediction::equivalent_exponent(prediction);
      recorded.model = std::string(law->model().card().name);
    }
    const FrictionEllipsoid ellipsoid{contact.friction_coefficient * wrench.normal_force_N,
                                      recorded.eccentricity_m};
    // A contact without e_n has no torque; round-off of it would have an infinite utilisation.
    recorded.utilisation =
        ellipsoid.utilisation(wrench.tangent_force_1_N, wrench.tangent_force_2_N,
                              recorded.eccentricity_m > 0 ? wrench.torque_Nm : 0);
    if (!std::isfinite(recorded.utilisation)) recorded.utilisation = 0;
    const Eigen::Vector4d velocity = stepper.contact_velocity(i);
    const double slip = std::hypot(velocity[1], velocity[2], recorded.eccentricity_m * velocity[3]);
    recorded.slides = slip > 1e-9 && recorded.utilisation > 1 - 1e-6;
    result.contacts.push_back(recorded);
  }
  return result;
}

/// Forces near the largest numbers leave a solved step that no file should hold.
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

}  // namespace

double percentile(std::vector<double> values, double p) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double rank = p * double(values.size() - 1);
  return values[std::size_t(std::lround(rank))];
}

Simulation simulate(const input::Scene& scene, const SimulationOptions& options) {
  Simulation result;
  TimeStepper::Options stepping;
  stepping.time_step_s = scene.time_step_s;
  const bool some_exact = std::any_of(
      scene.rules.begin(), scene.rules.end(),
      [](const input::ContactRule& rule) { return rule.exact_limit_surface.value_or(false); });
  stepping.friction_rule =
      scene.friction.rule == input::FrictionSettings::Rule::facets ? FrictionRule::facets
      : some_exact || scene.friction.rule == input::FrictionSettings::Rule::limit_surface
          ? FrictionRule::limit_surface
          : FrictionRule::ellipsoid;
  const LinearisedFriction facets(scene.friction.vertices);
  stepping.friction_vertices.resize(3, facets.count());
  for (int i = 0; i < facets.count(); ++i)
    stepping.friction_vertices.col(i) = facets.vertices()[std::size_t(i)];
  TimeStepper stepper(Multibody(scene.descriptions, scene.joints), scene.motors, stepping);
  SceneContacts finder(scene);
  finder.detector().require_no_overlap(stepper.bodies());
  for (const input::ForceOverTime& force : scene.forces)
    stepper.applied_forces().push_back(
        {force.body, force.point_in_body_m, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});

  Recording& recording = result.recording;
  recording.scene = scene.id;
  recording.question = scene.question;
  recording.time_step_s = scene.time_step_s;
  for (int b = 0; b < stepper.bodies().bodies(); ++b)
    recording.bodies.push_back({scene.bodies[std::size_t(b)].name, stepper.bodies().moves(b),
                                scene.bodies[std::size_t(b)].shapes});
  recording.frames.push_back(frame(stepper, scene, finder, false));

  for (int step = 0; step < scene.steps(); ++step) {
    if (!options.go_on(step)) {
      result.interrupted = true;
      break;
    }
    const auto start = Clock::now();
    // What is commanded holds at the end of the step.
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
    const StepResult stepped = stepper.step(finder);
    result.step_ms.push_back(
        std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    if (!options.record_lcp.empty() && stepper.problem().contacts() > 0)
      input::write_recorded_contacts(stepper.problem(), stepping.friction_vertices,
                                     fmt::format("{} step {}", scene.id, step + 1),
                                     options.record_lcp / fmt::format("step_{:06d}.txt", step + 1));
    if (!stepped.done()) {
      ++result.lcp_failures;
      result.failure = describe_failure(stepper, stepped);
      break;
    }
    Frame reached = frame(stepper, scene, finder, true);
    if (!is_finite(reached)) {
      result.failure = fmt::format(
          "step {} at {:.6g} s moves bodies out of all numbers; hint: look for a force, mass or "
          "velocity that is too large or too small by powers of ten",
          stepper.steps(), stepper.time_s());
      break;
    }
    ++result.steps;
    result.max_residual = std::max(result.max_residual, stepped.lcp.residual);
    result.most_contacts = std::max(result.most_contacts, stepped.contacts);
    result.most_load_iterations = std::max(result.most_load_iterations, stepped.load_iterations);
    result.max_load_disagreement =
        std::max(result.max_load_disagreement, stepped.load_disagreement);
    result.motor_disagreements += !stepped.motors_agree;
    recording.frames.push_back(std::move(reached));
  }
  for (const double ms : result.step_ms) result.wall_s += 1e-3 * ms;
  result.quadric_fits = finder.detector().fits();
  return result;
}

}  // namespace softfinger::simulation
