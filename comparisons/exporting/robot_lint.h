#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/exporting/robot_shapes.h"

/// The contact numbers that somebody typed into a robot's file, against what is possible.
namespace softfinger::exporting {

enum class LintVerdict { possible, doubtful, impossible };
/// "impossible"
const char* name_of(LintVerdict verdict);

/// A number of the file. The limits are those of a pad of the geom's own size; NaN: there is none.
struct LintedNumber {
  const XmlElement* element = nullptr;  ///< where it is typed
  std::string owner;                    ///< geom "tip"
  std::string name;                     ///< friction[1]
  std::string meaning;                  ///< torsional friction, m
  std::string typed;
  double value = 0;  ///< NaN: it is no number
  double least = 0, most = 0;
  LintVerdict verdict = LintVerdict::possible;
  std::string reason;  ///< empty: it is possible
  std::string advice;  ///< what to type; empty: it is possible
};

struct LintConditions {
  double load_N = 1;
  double youngs_modulus_Pa = 1e7;  ///< of the hardest pad that is thought of; incompressible
};

/// The levers and the stiffness of a contact on a shape. A lever is the largest torque about the
/// normal over the largest tangential force: the mean distance from the middle, weighted by the
/// pressure.
struct PadLimits {
  double reach_m =
      0;  ///< no point of the shape's surface lies farther from the middle of a contact
  double hertz_lever_m = 0;  ///< 3 pi/16 a of Hertz' circle, at the load, of the hardest pad
  /// 2/3 a, of the largest circle that the shape holds; of a box that of its largest face.
  double uniform_lever_m = 0;
  double punch_lever_m = 0;            ///< of a rigid flat punch: 3 pi/8 times the uniform one
  double punch_stiffness_N_per_m = 0;  ///< 2 E* a of that punch
};

/// The size of the box around a mesh, in metres; null: it cannot be read.
using MeshSize = std::function<std::optional<Eigen::Vector3d>(const NamedMesh&)>;

/// Null for a shape without a size.
std::optional<PadLimits> limits_of(const RobotShape& shape, const LintConditions& conditions,
                                   const MeshSize& mesh_size);

/// Judges every number on sliding, torsional and rolling friction, solref, solimp, stiffness and
/// patch radius that the file states, in the order of the file. A number that a default gives to
/// several geoms is judged on the smallest of them.
std::vector<LintedNumber> lint(const XmlFile& file, const LintConditions& conditions,
                               const MeshSize& mesh_size);

}  // namespace softfinger::exporting
