#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "comparisons/input/friction_law.h"
#include "comparisons/input/setting.h"
#include "comparisons/input/shape.h"
#include "softfinger/dynamics/bodies/multibody.h"
#include "softfinger/dynamics/step/time_stepper.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/input/shear_law.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/time/relaxation.h"

/// A scene as its file describes it: bodies, joints, motors, contacts, and what happens to them.
namespace softfinger::input {

/// Friction law of a scene's contacts, where no [[contact]] names another.
struct FrictionSettings {
  const FrictionLaw* law = &kEllipsoidLaw;
  int vertices = 16;  ///< of `facets`
};

struct SceneBody {
  std::string name;
  std::vector<Shape> shapes;
  std::optional<ElasticLayer> layer;  ///< a soft surface on a rigid core
  Relaxation relaxation;              ///< of the layer, whose modulus is the instantaneous one
  bool is_mass_derived = false;       ///< mass or inertia are those of the shapes
};

/// `model = "auto"`: a point where both bodies are rigid, else the pressure model that
/// simulation::model_of_contact chooses.
struct AutomaticModel {};
/// `model = "rigid"`: a point that carries no torque about the normal.
struct RigidPoint {};
/// `model = "given"`: this e_n at any load.
struct GivenEccentricity {
  double eccentricity_m = 0;
};
/// `model = "table"`: e_n over the load, from finite elements or measurements. The ellipse is that
/// of the automatic model.
struct EccentricityOverLoad {
  double least_load_N = 0, largest_load_N = 0;
  std::vector<double> eccentricity_m;  ///< evenly spaced in ln P, at least two
};
/// Source of a contact's e_n; a pressure model by its name.
using ContactModel = std::variant<AutomaticModel, RigidPoint, GivenEccentricity,
                                  EccentricityOverLoad, const PressureModel*>;

/// Properties of the contacts of two bodies.
struct ContactRule {
  /// Shear law of the contact. Only its coefficient is used at a point contact, whose area is not
  /// known.
  ShearLaw shear_law = ShearLaw::coulomb(0.5);
  ContactModel model;
  const FrictionLaw* friction = nullptr;  ///< null: the scene's
  double restitution = 0;                 ///< Newton's
  bool collide = true;
  /// Whether soft contacts give way elastically before they slide, see
  /// softfinger/dynamics/step/presliding.h.
  bool presliding = false;
};

/// A value over time: constant before the first and after the last point.
struct TimeTable {
  std::vector<double> time_s;
  Eigen::MatrixXd values;  ///< a row per time
  bool smooth = false;     ///< eased between the points, at rest in each; else straight lines

  Eigen::VectorXd value(double time_s) const;
  Eigen::VectorXd rate(double time_s) const;
};

/// A motor's target or feed-forward over time.
struct Motion {
  int motor = -1;
  bool is_effort = false;
  TimeTable table;  ///< one column: rad, m, N m or N
};

struct ForceOverTime {
  int body = -1;
  Eigen::Vector3d point_in_body_m = Eigen::Vector3d::Zero();
  TimeTable table;  ///< six columns: force in N, torque in N m, world axes
};

struct Scene {
  std::string id, question;
  std::filesystem::path file;
  std::string text;
  double time_step_s = 1e-3, duration_s = 1;
  double nominal_load_N = 5;  ///< contact models are chosen and meshes are fitted for this load
  FrictionSettings friction;
  std::vector<SceneBody> bodies;
  std::vector<BodyDescription> descriptions;  ///< of the same bodies
  std::vector<JointDescription> joints;
  std::vector<LoopDescription> loops;
  std::vector<Motor> motors;
  std::vector<Motion> motions;
  std::vector<ForceOverTime> forces;
  TimeTable gravity;  ///< three columns, m/s2
  /// Generalised, as Multibody has them, where bodies on joints have velocities; empty: those of
  /// the free bodies' descriptions.
  Eigen::VectorXd start_velocity;

  const ContactRule& rule(int body, int other) const {
    return rules[std::size_t(rule_of_pair[std::size_t(body) * bodies.size() + std::size_t(other)])];
  }
  const FrictionLaw& friction_law(int body, int other) const {
    const FrictionLaw* own = rule(body, other).friction;
    return own ? *own : *friction.law;
  }
  std::vector<ContactRule> rules;
  std::vector<int> rule_of_pair;  ///< bodies x bodies

  /// Repairs of the scene's meshes, doubts about their units, and unusual values.
  std::vector<std::string> remarks;

  int steps() const;
};

/// Reads and checks a scene file. Mesh files are looked up relative to the scene's folder, then
/// among the built-in meshes.
/// @throws InputError with where = "file:line" for anything missing, unknown, of the wrong type or
/// out of range.
/// @param file  "-": standard input
Scene read_scene(const std::filesystem::path& file, const Settings& settings = {});
/// Whether the file is meant to be a scene, not a case: it has a table [simulation].
/// @throws InputError when it is no TOML
bool is_scene(const std::filesystem::path& file);
Scene parse_scene(const std::string& text, const std::filesystem::path& file,
                  const Settings& settings = {});

}  // namespace softfinger::input
