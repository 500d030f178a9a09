#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "softfinger/input/contact_problem.h"

/// Runs the same problems in several engines. An engine is one file engines/NAME.cc; see
/// README.md.
namespace softfinger::benchmark {

struct Body {
  enum class Shape { ball, box, capsule };
  enum class Freedom { none, along_x, all };
  std::string name;
  Shape shape = Shape::box;
  /// A ball has its radius three times; a capsule, along y, has its radius, half the distance of
  /// the caps' centres, and its radius again.
  Eigen::Vector3d half_size_m = Eigen::Vector3d::Zero();
  double mass_kg = 0;                                    ///< homogeneous
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< at the start, unturned, at rest
  Freedom freedom = Freedom::all;
  /// Carries the scene's soft layer. A box presses with a side across x: a flat pad.
  bool is_fingertip = false;

  Eigen::Vector3d inertia_kg_m2() const;  ///< about the centre, principal
};

/// A force that acts from a time on, at the body's centre, in world axes. A later one of the same
/// body replaces it.
struct Load {
  int body = -1;
  double from_s = 0;
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero(), torque_Nm = Eigen::Vector3d::Zero();
};

struct Scene {
  std::vector<Body> bodies;
  std::vector<Load> loads;  ///< in the order of time
  Eigen::Vector3d gravity_m_per_s2 = Eigen::Vector3d::Zero();
  double time_step_s = 1e-3, duration_s = 1;
  std::vector<double> sample_times_s;  ///< within the duration, ascending
  /// Contact of a fingertip: layer, radii and friction. Its load is the nominal one, at which
  /// engines with a constant e_n evaluate it.
  ContactProblem contact;
  double rigid_friction_coefficient = 0.5;  ///< of all other contacts

  bool has_fingertips() const;
  /// The last load of a body at a time; zero before the first one.
  Load load_at(int body, double time_s) const;
};

/// e_n of fingertip_layer.
double eccentricity_m(ContactProblem contact, double load_N);
/// e_n of pad_layer, of a box that presses with its side across x.
double pad_eccentricity_m(const ContactProblem& contact, const Body& pad);
/// Half size of what stands for a fingertip in an engine that makes points of it, as `softfinger
/// export` says: of a pad a box whose corners lie at e_n.
Eigen::Vector3d exported_half_size_m(const Scene& scene, const Body& body);

struct State {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero(), velocity_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d angular_velocity_rad_per_s = Eigen::Vector3d::Zero();  ///< world axes
};

struct Motion {
  std::vector<std::vector<State>> samples;  ///< by sample time, then by body
  int steps = 0;
  double wall_s = 0;    ///< of the steps alone, without setting up
  std::string failure;  ///< in words; empty: it ran to the end
};

struct Engine {
  std::string name;   ///< "mujoco_exported"
  std::string title;  ///< "MuJoCo, exported lines"
  std::string told;   ///< contact data that the engine is given, and its settings
  Motion (*run)(const Scene& scene) = nullptr;
};

/// Engine whose library was missing when this program was built.
struct AbsentEngine {
  std::string name, package;
};

const std::vector<Engine>& all_engines();
const std::vector<AbsentEngine>& absent_engines();

}  // namespace softfinger::benchmark
