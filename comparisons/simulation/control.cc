#include "comparisons/simulation/control.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <istream>
#include <limits>
#include <ostream>

#include "comparisons/simulation/frame_json.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::simulation {
namespace {

using nlohmann::json;

constexpr const char* kWhere = "control";
constexpr double kMostGravity_m_per_s2 = 1e9;  // as in a scene

/// A message that repeats the value can be read, whatever bytes another program sent.
[[noreturn]] void refuse(const std::string& field, const json& value, const std::string& allowed) {
  throw InputError(kWhere, field,
                   text::shortened(value.dump(-1, ' ', false, json::error_handler_t::replace), 200),
                   allowed);
}

/// " (invalid UTF-8 byte at index 18: 0xBC)", or nothing.
std::string utf8_objection(const std::string& line) {
  try {
    (void)json(line).dump();
    return "";
  } catch (const json::type_error& error) {
    const std::string message = error.what();
    return " (" + message.substr(std::min(message.find("invalid"), message.size())) + ")";
  }
}

void check_keys(const json& object, const std::string& field,
                const std::vector<std::string>& known) {
  if (!object.is_object()) refuse(field, object, "an object");
  for (const auto& [key, value] : object.items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      refuse(field + "." + key, value, "one of " + text::joined(known));
}

/// Index of a name, which must be one of the names.
int place_of(const std::string& name, const std::vector<std::string>& names) {
  return int(std::find(names.begin(), names.end(), name) - names.begin());
}

/// Beyond this a step only rounds, or overflows.
constexpr double kMost = 1e12;

double number(const json& value, const std::string& field) {
  if (!value.is_number() || !(std::abs(value.get<double>()) <= kMost))
    refuse(field, value, fmt::format("a number of at most {:g}", kMost));
  return value.get<double>();
}

Eigen::Vector3d vector(const json& value, const std::string& field) {
  if (!value.is_array() || value.size() != 3) refuse(field, value, "three numbers");
  return {number(value[0], field), number(value[1], field), number(value[2], field)};
}

/// The place of a field in a motor.
double& field_of(Motor& motor, const std::string& name) {
  if (name == "stiffness") return motor.stiffness;
  if (name == "damping") return motor.damping;
  if (name == "feed_forward") return motor.feed_forward;
  if (name == "max_effort") return motor.max_effort;
  if (name == "target") return motor.target;
  return motor.target_velocity;
}

const std::vector<std::string> kMotorFields = {"stiffness",  "damping", "feed_forward",
                                               "max_effort", "target",  "target_velocity"};
const std::vector<std::string> kNotNegative = {"stiffness", "damping", "max_effort"};

double motor_number(const json& value, const std::string& field, const std::string& name) {
  // JSON has no infinity.
  if (name == "max_effort" && value.is_null()) return std::numeric_limits<double>::infinity();
  const double result = number(value, field);
  if (result < 0 && std::find(kNotNegative.begin(), kNotNegative.end(), name) != kNotNegative.end())
    refuse(field, value, "not negative");
  return result;
}

}  // namespace

Control::Control(const input::Scene& scene, std::istream& commands, std::ostream& states)
    : scene_(scene), commands_(commands), states_(states) {}

SimulationOptions Control::options() {
  SimulationOptions options;
  options.keeps_frames = false;
  options.go_on = [this](int) { return steps_to_do_ > 0 || read_command(); };
  options.command = [this](TimeStepper& stepper) { act(stepper); };
  options.reached = [this](const Recording& recording, const TimeStepper& stepper) {
    reached(recording, stepper);
  };
  return options;
}

bool Control::read_command() {
  std::string line;
  if (!std::getline(commands_, line)) return false;
  const json command = json::parse(line, nullptr, false);
  if (command.is_discarded())
    throw InputError(kWhere, "command" + utf8_objection(line), text::shortened(line, 200),
                     "a JSON object on one line, in UTF-8");
  check_keys(command, "command", {"steps", "motors", "forces", "gravity_m_per_s2"});
  steps_to_do_ = 1;
  for (const auto& [key, value] : command.items()) {
    if (key == "steps") {
      if (!value.is_number_integer() || value < 1 || value > 1000000)
        refuse(key, value, "a whole number, 1 to 1000000");
      steps_to_do_ = value.get<int>();
    } else if (key == "motors") {
      set_motors(value);
    } else if (key == "forces") {
      set_forces(value);
    } else {
      gravity_m_per_s2_ = vector(value, key);
      if (!(gravity_m_per_s2_->lpNorm<Eigen::Infinity>() <= kMostGravity_m_per_s2))
        refuse(key, value, fmt::format("[x, y, z], each at most {:g}", kMostGravity_m_per_s2));
    }
  }
  return true;
}

void Control::set_motors(const json& motors) {
  std::vector<std::string> joints;
  for (const Motor& motor : scene_.motors)
    joints.push_back(scene_.joints[std::size_t(motor.joint)].name);
  check_keys(motors, "motors", joints);
  for (const auto& [name, fields] : motors.items()) {
    const std::string field = "motors." + name;
    check_keys(fields, field, kMotorFields);
    for (const auto& [key, value] : fields.items())
      motors_[place_of(name, joints)][key] = motor_number(value, field + "." + key, key);
  }
}

void Control::set_forces(const json& forces) {
  std::vector<std::string> bodies;
  for (const input::SceneBody& body : scene_.bodies) bodies.push_back(body.name);
  check_keys(forces, "forces", bodies);
  for (const auto& [name, fields] : forces.items()) {
    const std::string field = "forces." + name;
    check_keys(fields, field, {"force_N", "torque_Nm", "point_in_body_m"});
    AppliedForce force;
    force.body = place_of(name, bodies);
    if (scene_.descriptions[std::size_t(force.body)].fixed)
      refuse(field, fields, "a body that is not fixed");
    for (const auto& [key, value] : fields.items())
      (key == "force_N"     ? force.force_N
       : key == "torque_Nm" ? force.torque_Nm
                            : force.point_in_body_m) = vector(value, field + "." + key);
    forces_[force.body] = force;
  }
}

void Control::act(TimeStepper& stepper) {
  for (const auto& [motor, fields] : motors_)
    for (const auto& [name, value] : fields)
      field_of(stepper.motors()[std::size_t(motor)], name) = value;
  // Those of the scene come first.
  stepper.applied_forces().resize(scene_.forces.size());
  for (const auto& [body, force] : forces_) stepper.applied_forces().push_back(force);
  if (gravity_m_per_s2_) stepper.set_gravity(*gravity_m_per_s2_);
}

void Control::reached(const Recording& recording, const TimeStepper& stepper) {
  if (stepper.steps() > 0) --steps_to_do_;
  const bool has_ended = stepper.steps() >= scene_.steps();
  if (steps_to_do_ > 0 && !has_ended) return;
  const Frame& frame = recording.frames.back();
  json joints = json::array();
  for (std::size_t j = 0; j < scene_.joints.size(); ++j)
    joints.push_back({{"name", scene_.joints[j].name},
                      {"position", stepper.bodies().joint_position(int(j))},
                      {"velocity", stepper.bodies().joint_velocity(int(j))},
                      {"effort", 0.0}});
  for (std::size_t m = 0; m < scene_.motors.size(); ++m)
    joints[std::size_t(scene_.motors[m].joint)]["effort"] = stepper.motor_effort(int(m));
  states_ << json({{"time_s", frame.time_s},
                   {"ended", has_ended},
                   {"bodies", bodies_json(frame, recording.bodies)},
                   {"joints", joints},
                   {"contacts", contacts_json(frame, recording.bodies)}})
                 .dump()
          << std::endl;
}

}  // namespace softfinger::simulation
