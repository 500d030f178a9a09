#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/exporting/contact_curve.h"
#include "comparisons/exporting/mjcf.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/exporting/xml_text.h"
#include "softfinger/input/contact_problem.h"

/// The exported contact, written into the model of a robot.
namespace softfinger::exporting {

enum class RobotFormat { mjcf, urdf, sdf };

/// "MJCF"
std::string_view name_of(RobotFormat format);

/// The format that the root element names: mujoco, robot, sdf.
/// @throws InputError for another one
RobotFormat format_of(const XmlFile& file);

/// Contact to be written, with the data that only some formats take.
struct RobotContact {
  SoftContact contact;
  /// Errors of torque and force in the simulator, over the loads: "-31.6 to +43.0 % of the torque,
  /// 0.5 to 10 N".
  std::string torque_error, force_error;
  /// The mass that the contact moves, for MuJoCo only: for a solref with the model's normal
  /// stiffness.
  std::optional<double> effective_mass_kg;
  /// The contact of the plugin for MuJoCo (exporting/mujoco/softfinger_mujoco.h).
  std::optional<ContactProblem> plugin;
  /// The size that a flat pad's shape should have: its kind, "box" or "cylinder", the size's name
  /// and value; for a finger of one shape.
  std::optional<std::array<std::string, 3>> corner_size;
  /// The depth of the fingertip's innermost point, for Drake only; empty: that of its shape.
  std::optional<double> depth_m;
};

/// @throws InputError for a simulator that does not read friction from such files
void require_reader(const XmlFile& file, const Simulator& simulator);

/// A finger as it is named, and its geoms or collisions.
struct FingerParts {
  std::string name;
  std::vector<const XmlElement*> elements;
};

/// @param fingers  MJCF: geoms, or bodies for all their geoms that touch others; URDF, SDF:
/// collisions, or links for all their collisions; also LINK::COLLISION, MODEL::LINK::COLLISION
/// @throws InputError for a finger that the file has not or has several of, with the nearest name,
/// and for a geom of MJCF that touches nothing
std::vector<FingerParts> find_fingers(const XmlFile& file, const Mjcf& mjcf,
                                      const std::vector<std::string>& fingers);

/// Writes the contact of each finger into the file, or into the one that it includes and that holds
/// the finger.
/// @param fingers   as in `find_fingers`
/// @param contacts  one for each finger, or one for all of them
/// @throws InputError as `find_fingers` and `require_reader`, for flags of MJCF under which
/// friction has no effect, and for a shape whose depth is not known
/// @returns what else decides about the contact, as files that are not read, a sentence each
std::vector<std::string> apply_contact(XmlFile& file, const std::vector<std::string>& fingers,
                                       const Simulator& simulator,
                                       const std::vector<RobotContact>& contacts);

/// The numbers of solref and solimp that give MuJoCo's contact of a mass a stiffness and critical
/// damping. With a constant impedance d, solimp="d d w", and solref="-k -b" MuJoCo's law is
/// a_ref = -b v/d - k r/d and f = m d/(1 - d) (a_ref - ...), so that dP/dr = k m/(1 - d).
struct MujocoSpring {
  double impedance = 0.95;
  double stiffness_per_s2 = 0, damping_per_s = 0;  ///< k = K (1 - d)/m, b = 2 (1 - d) sqrt(K/m)
};
MujocoSpring mujoco_spring(double normal_stiffness_N_per_m, double mass_kg);

}  // namespace softfinger::exporting
