#include "comparisons/simulation/presliding_contacts.h"

#include <cmath>
#include <utility>

#include "softfinger/pressure/equivalent_exponent.h"

namespace softfinger::simulation {
namespace {

StuckStiffness of_layer(const Prediction& prediction, const ElasticLayer& layer) {
  return stuck_stiffness(prediction.a_m, prediction.b_m, layer.thickness_m, layer.youngs_modulus_Pa,
                         layer.poisson_ratio);
}

/// The layer that turns more of the two.
const ElasticLayer& softer_layer(const Prediction& prediction, const ContactProblem& problem) {
  if (!problem.has_object_layer()) return problem.layer;
  return of_layer(prediction, problem.layer).torsional_Nm_per_rad <
                 of_layer(prediction, problem.object_layer).torsional_Nm_per_rad
             ? problem.layer
             : problem.object_layer;
}

double in_series(double first, double second) { return first * second / (first + second); }

Eigen::Vector3d compliance_of(const PreslidingElements& elements) {
  const Eigen::Vector3d stiffness = elements.stiffness();
  return (stiffness.array() > 0).select(stiffness.cwiseInverse(), 0.);
}

}  // namespace

std::optional<StuckStiffness> stuck_stiffness_at(const PressureModel& model,
                                                 const ContactProblem& problem, double load_N) {
  ContactProblem at_load = problem;
  at_load.load.normal_force_N = load_N;
  const Prediction prediction = model.predict(at_load);
  if (!prediction.has_answer || !(prediction.b_m > 0)) return std::nullopt;
  const StuckStiffness finger = of_layer(prediction, problem.layer);
  if (!problem.has_object_layer()) return finger;
  const StuckStiffness object = of_layer(prediction, problem.object_layer);
  return StuckStiffness{in_series(finger.torsional_Nm_per_rad, object.torsional_Nm_per_rad),
                        in_series(finger.tangential_x_N_per_m, object.tangential_x_N_per_m),
                        in_series(finger.tangential_y_N_per_m, object.tangential_y_N_per_m)};
}

std::optional<StuckStiffness> PreslidingContacts::Described::stuck_at(double load_N) const {
  if (model) return stuck_stiffness_at(*model, problem, effective.of(load_N));
  return face;
}

void PreslidingContacts::add(long id, const PressureModel& model, const ContactProblem& problem,
                             const EffectiveLoad& effective, const Relaxation& relaxation) {
  Described described;
  described.model = &model;
  described.problem = problem;
  described.effective = effective;
  described.relaxation = relaxation;
  now_.insert_or_assign(id, described);
}

void PreslidingContacts::add_face(long id, const StuckStiffness& stuck, double aspect, double size,
                                  const Relaxation& relaxation) {
  Described described;
  described.relaxation = relaxation;
  described.face = stuck;
  described.face_aspect = aspect;
  described.face_size = size;
  now_.insert_or_assign(id, described);
}

const PreslidingElements& PreslidingContacts::elements_of(const Described& contact) {
  // All of a face's size stays in contact: a shift sticks as a whole, until all of it slides. The
  // curve of a twist is that of the flattest pressure it is known for.
  double growth = 0, exponent = 0.5, aspect = contact.face_aspect, size = contact.face_size;
  if (contact.model) {
    const double load_N = contact.problem.load.normal_force_N, more_N = 1.01 * load_N;
    const Prediction prediction = contact.model->predict(contact.problem);
    const auto stuck = contact.stuck_at(load_N), grown = contact.stuck_at(more_N);
    growth = 1. / 3;
    if (stuck && grown) {
      growth = std::log(grown->tangential_x_N_per_m / stuck->tangential_x_N_per_m) /
               std::log(more_N / load_N);
      exponent = equivalent_exponent(prediction);
      aspect = prediction.b_m / prediction.a_m;
      size = prediction.a_m / softer_layer(prediction, contact.problem).thickness_m;
    }
  }
  // To a hundredth: the curves change by less than they are known.
  const auto rounded = [](double value) { return int(std::lround(100 * value)); };
  const std::tuple key{rounded(growth), rounded(exponent), rounded(aspect), rounded(size)};
  const auto known = made_.find(key);
  if (known != made_.end()) return known->second;
  return made_
      .emplace(key, PreslidingElements(ShiftCurve(growth), TwistCurve(exponent, aspect, size)))
      .first->second;
}

void PreslidingContacts::prepare(const Multibody& bodies, double time_step_s,
                                 std::vector<Contact>& contacts) {
  for (auto held = held_.begin(); held != held_.end();)
    held = now_.count(held->first) ? std::next(held) : held_.erase(held);
  if (now_.empty()) return;
  for (Contact& contact : contacts) {
    const auto described = now_.find(contact.id);
    if (described == now_.end()) continue;
    const Described& own = described->second;
    auto found = held_.find(contact.id);
    const bool is_new = found == held_.end();
    const double load_N = is_new ? own.problem.load.normal_force_N : found->second.load_N;
    const auto stuck = own.stuck_at(load_N);
    if (!stuck) continue;
    if (is_new) found = held_.emplace(contact.id, Held{elements_of(own), load_N}).first;
    Held& held = found->second;
    const Eigen::Matrix3d turn_of_a = bodies.pose(contact.a).linear();
    if (is_new) {
      held.elements.set_relaxation(own.relaxation);
      held.elements.set_limits(*stuck, 0, 0);
    } else {
      held.elements.relax(time_step_s);
      const Eigen::Vector3d before = contact.axes.transpose() * (turn_of_a * held.axis_on_a);
      held.elements.turn_axes(-std::atan2(before.y(), before.x()));
    }
    held.axis_on_a = turn_of_a.transpose() * contact.axes.col(0);
    contact.compliance = compliance_of(held.elements);
    contact.elastic_wrench = held.elements.wrench();
  }
}

void PreslidingContacts::settle(const TimeStepper& stepper) {
  for (int i = 0; i < int(stepper.contacts().size()); ++i) {
    const Contact& contact = stepper.contacts()[std::size_t(i)];
    if (contact.compliance.isZero(0)) continue;
    const ContactWrench wrench = stepper.wrench(i);
    const auto held = held_.find(contact.id);
    const auto described = now_.find(contact.id);
    if (held == held_.end() || described == now_.end()) continue;
    const double load_N = wrench.normal_force_N;
    const auto stuck = described->second.stuck_at(load_N);
    if (!(load_N > 0) || !stuck) {
      held_.erase(held);  // what does not press holds nothing
      continue;
    }
    const double largest_force_N = stepper.friction_coefficient(i) * load_N;
    PreslidingElements& elements = held->second.elements;
    const auto press = [&] {
      elements.set_limits(*stuck, largest_force_N, largest_force_N * stepper.eccentricity_m(i));
    };
    // A new contact holds nothing until it has a load. Later what the step was solved with is moved
    // first: the new load then takes energy out of the springs only.
    if (!held->second.is_pressed) press();
    held->second.is_pressed = true;
    const Eigen::Vector3d reached(wrench.tangent_force_1_N, wrench.tangent_force_2_N,
                                  wrench.torque_Nm);
    elements.move((contact.elastic_wrench - reached).cwiseProduct(contact.compliance));
    press();
    held->second.load_N = load_N;
  }
}

}  // namespace softfinger::simulation
