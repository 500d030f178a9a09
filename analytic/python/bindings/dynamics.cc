#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <memory>

#include "analytic/python/bindings/contacts.h"
#include "softfinger/dynamics/step/time_stepper.h"

namespace softfinger::python {
namespace {

using Pose = Eigen::Matrix4d;

/// e_n of a model at any load of a contact.
class ModelEccentricity final : public EccentricityLaw {
 public:
  ModelEccentricity(const std::string& model, const py::dict& numbers)
      : model_(model_named(model)), problem_(Contacts(numbers).problem(0)) {}

  double eccentricity_m(double load_N) const noexcept override {
    ContactProblem at_load = problem_;
    at_load.load.normal_force_N = load_N;
    return load_N > 0 ? model_.predict(at_load).torque_arm_exact_m : 0;
  }

 private:
  const PressureModel& model_;
  ContactProblem problem_;
};

/// The contacts that a function of Python's finds. Its laws live as long as the step.
class PythonContacts final : public ContactFinder {
 public:
  PythonContacts(py::function find, std::string friction)
      : find_(std::move(find)), friction_(std::move(friction)) {}

  void find(const Multibody&, double time_step_s, std::vector<Contact>& contacts) override {
    const py::gil_scoped_acquire one_at_a_time;
    shapes_.clear();
    found_ = find_(time_step_s);
    for (const py::handle item : found_) contacts.push_back(contact_of(item));
  }

 private:
  Contact contact_of(const py::handle item) {
    Contact contact;
    contact.a = py::cast<int>(item.attr("a"));
    contact.b = py::cast<int>(item.attr("b"));
    contact.point_m = py::cast<Eigen::Vector3d>(item.attr("point_m"));
    contact.axes = py::cast<Eigen::Matrix3d>(item.attr("axes"));
    contact.gap_m = py::cast<double>(item.attr("gap_m"));
    contact.friction_coefficient = py::cast<double>(item.attr("friction_coefficient"));
    contact.id = py::cast<long>(item.attr("id"));
    const py::object eccentricity = item.attr("eccentricity_m");
    if (py::isinstance<ModelEccentricity>(eccentricity))
      contact.eccentricity_law = py::cast<const ModelEccentricity*>(eccentricity);
    else
      contact.eccentricity_m = py::cast<double>(eccentricity);
    if (const py::object shape = item.attr("shape"); !shape.is_none()) {
      const auto [aspect, exponent] = py::cast<std::pair<double, double>>(shape);
      contact.shape = shape_of(aspect, exponent);
    }
    return contact;
  }

  const FrictionShape* shape_of(double aspect, double exponent) {
    if (friction_ == "limit_surface")
      shapes_.push_back(std::make_unique<LimitSurfaceShape>(aspect, exponent));
    else if (friction_ == "six_patches")
      shapes_.push_back(std::make_unique<SixPatchShape>(aspect, exponent));
    else
      return nullptr;
    return shapes_.back().get();
  }

  py::function find_;
  std::string friction_;
  py::list found_;  ///< keeps laws alive
  std::vector<std::unique_ptr<const FrictionShape>> shapes_;
};

BodyDescription body_of(const py::handle item) {
  BodyDescription body;
  body.name = py::cast<std::string>(item.attr("name"));
  body.fixed = py::cast<bool>(item.attr("fixed"));
  body.mass.mass_kg = py::cast<double>(item.attr("mass_kg"));
  body.mass.center_m = py::cast<Eigen::Vector3d>(item.attr("center_m"));
  body.mass.inertia_kg_m2 = py::cast<Eigen::Matrix3d>(item.attr("inertia_kg_m2"));
  body.pose.matrix() = py::cast<Pose>(item.attr("pose"));
  body.velocity_m_per_s = py::cast<Eigen::Vector3d>(item.attr("velocity_m_per_s"));
  body.angular_velocity_rad_per_s =
      py::cast<Eigen::Vector3d>(item.attr("angular_velocity_rad_per_s"));
  return body;
}

JointDescription joint_of(const py::handle item) {
  JointDescription joint;
  const auto kind = py::cast<std::string>(item.attr("kind"));
  joint.name = py::cast<std::string>(item.attr("name"));
  joint.kind = kind == "revolute"    ? JointKind::revolute
               : kind == "prismatic" ? JointKind::prismatic
               : kind == "ball"      ? JointKind::ball
                                     : JointKind::fixed;
  joint.parent = py::cast<int>(item.attr("parent"));
  joint.child = py::cast<int>(item.attr("child"));
  joint.anchor_m = py::cast<Eigen::Vector3d>(item.attr("anchor_m"));
  joint.axis = py::cast<Eigen::Vector3d>(item.attr("axis"));
  joint.start = py::cast<double>(item.attr("start"));
  joint.lower = py::cast<double>(item.attr("lower"));
  joint.upper = py::cast<double>(item.attr("upper"));
  return joint;
}

/// Sets a motor to what the object says; its joint stays.
void drive(Motor& motor, const py::handle item) {
  motor.stiffness = py::cast<double>(item.attr("stiffness"));
  motor.damping = py::cast<double>(item.attr("damping"));
  motor.feed_forward = py::cast<double>(item.attr("feed_forward"));
  motor.max_effort = py::cast<double>(item.attr("max_effort"));
  motor.target = py::cast<double>(item.attr("target"));
  motor.target_velocity = py::cast<double>(item.attr("target_velocity"));
}

/// Bodies, joints and motors as softfinger/_simulation.py describes and has checked them.
class Stepper {
 public:
  Stepper(const py::list& bodies, const py::list& joints, const py::list& motors, py::function find,
          const py::dict& options)
      : finder_(std::move(find), py::cast<std::string>(options["friction"])),
        stepper_(multibody(bodies, joints), motors_of(motors), options_of(options)) {}

  py::dict step() {
    StepResult step;
    {
      const py::gil_scoped_release others_may_run;
      step = stepper_.step(finder_);
    }
    py::dict result;
    result["done"] = step.done();
    result["is_infeasible"] = step.lcp.proof == RayProof::infeasible;
    result["residual"] = step.lcp.residual;
    result["contacts"] = step.contacts;
    result["motors_agree"] = step.motors_agree;
    result["load_disagreement"] = step.load_disagreement;
    return result;
  }

  Pose pose(int b) const { return bodies().pose(b).matrix(); }
  Eigen::Vector3d velocity_m_per_s(int b) const {
    return bodies().moves(b) ? bodies().velocity_at(b, bodies().center_of_mass_m(b))
                             : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }
  Eigen::Vector3d angular_velocity_rad_per_s(int b) const {
    return bodies().moves(b) ? bodies().angular_velocity(b)
                             : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }
  Eigen::VectorXd velocity() const { return bodies().velocity(); }
  void set_velocity(const Eigen::VectorXd& velocity) { stepper_.bodies().set_velocity(velocity); }
  double joint_position(int j) const { return bodies().joint_position(j); }
  double joint_velocity(int j) const { return bodies().joint_velocity(j); }
  double motor_effort(int m) const { return stepper_.motor_effort(m); }
  void drive_motor(int m, const py::handle motor) {
    drive(stepper_.motors()[std::size_t(m)], motor);
  }
  void set_gravity(const Eigen::Vector3d& gravity_m_per_s2) {
    stepper_.set_gravity(gravity_m_per_s2);
  }
  /// One force per body, which the body keeps until it is set anew.
  void apply(int b, const Eigen::Vector3d& point_in_body_m, const Eigen::Vector3d& force_N,
             const Eigen::Vector3d& torque_Nm) {
    std::vector<AppliedForce>& forces = stepper_.applied_forces();
    for (AppliedForce& force : forces)
      if (force.body == b) {
        force = {b, point_in_body_m, force_N, torque_Nm};
        return;
      }
    forces.push_back({b, point_in_body_m, force_N, torque_Nm});
  }
  double time_s() const { return stepper_.time_s(); }
  double energy_J() const {
    return bodies().kinetic_energy_J() +
           bodies().potential_energy_J(stepper_.options().gravity_m_per_s2);
  }

  py::list contacts() const {
    py::list result;
    for (int i = 0; i < int(stepper_.contacts().size()); ++i) {
      const Contact& contact = stepper_.contacts()[std::size_t(i)];
      const ContactWrench wrench = stepper_.wrench(i);
      py::dict entry;
      entry["a"] = contact.a;
      entry["b"] = contact.b;
      entry["id"] = contact.id;
      entry["point_m"] = contact.point_m;
      entry["axes"] = contact.axes;
      entry["gap_m"] = contact.gap_m;
      entry["friction_coefficient"] = contact.friction_coefficient;
      entry["normal_force_N"] = wrench.normal_force_N;
      entry["tangent_force_1_N"] = wrench.tangent_force_1_N;
      entry["tangent_force_2_N"] = wrench.tangent_force_2_N;
      entry["torque_Nm"] = wrench.torque_Nm;
      entry["eccentricity_m"] = stepper_.eccentricity_m(i);
      entry["slip_m_per_s"] = stepper_.solution().slip[i];
      result.append(entry);
    }
    return result;
  }

 private:
  const Multibody& bodies() const { return stepper_.bodies(); }

  static Multibody multibody(const py::list& bodies, const py::list& joints) {
    std::vector<BodyDescription> described;
    for (const py::handle body : bodies) described.push_back(body_of(body));
    std::vector<JointDescription> joined;
    for (const py::handle joint : joints) joined.push_back(joint_of(joint));
    return {described, joined};
  }
  static std::vector<Motor> motors_of(const py::list& motors) {
    std::vector<Motor> result;
    for (const py::handle item : motors) {
      result.emplace_back();
      result.back().joint = py::cast<int>(item.attr("joint"));
      drive(result.back(), item);
    }
    return result;
  }
  static TimeStepper::Options options_of(const py::dict& chosen) {
    TimeStepper::Options options;
    options.time_step_s = py::cast<double>(chosen["time_step_s"]);
    options.gravity_m_per_s2 = py::cast<Eigen::Vector3d>(chosen["gravity_m_per_s2"]);
    options.friction_rule = py::cast<std::string>(chosen["friction"]) == "ellipsoid"
                                ? FrictionRule::ellipsoid
                                : FrictionRule::limit_surface;
    return options;
  }

  PythonContacts finder_;
  TimeStepper stepper_;
};

}  // namespace

void bind_dynamics(py::module_& module) {
  py::class_<ModelEccentricity>(module, "ModelEccentricity")
      .def(py::init<const std::string&, const py::dict&>())
      .def("__call__", &ModelEccentricity::eccentricity_m);
  py::class_<Stepper>(module, "Stepper")
      .def(py::init<const py::list&, const py::list&, const py::list&, py::function,
                    const py::dict&>())
      .def("step", &Stepper::step)
      .def("pose", &Stepper::pose)
      .def("velocity_m_per_s", &Stepper::velocity_m_per_s)
      .def("angular_velocity_rad_per_s", &Stepper::angular_velocity_rad_per_s)
      .def_property("velocity", &Stepper::velocity, &Stepper::set_velocity)
      .def("joint_position", &Stepper::joint_position)
      .def("joint_velocity", &Stepper::joint_velocity)
      .def("motor_effort", &Stepper::motor_effort)
      .def("drive_motor", &Stepper::drive_motor)
      .def("set_gravity", &Stepper::set_gravity)
      .def("apply", &Stepper::apply)
      .def("contacts", &Stepper::contacts)
      .def_property_readonly("time_s", &Stepper::time_s)
      .def_property_readonly("energy_J", &Stepper::energy_J);
}

}  // namespace softfinger::python
