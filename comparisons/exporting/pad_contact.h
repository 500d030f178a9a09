#pragma once

#include <array>
#include <memory>
#include <string>

#include "comparisons/exporting/contact_curve.h"
#include "comparisons/exporting/robot_file.h"
#include "comparisons/exporting/shape_pad.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/input/case.h"
#include "comparisons/prediction/pad_answer.h"

/// A flat pad's contact for simulators and controllers.
namespace softfinger::exporting {

struct PadContact {
  std::unique_ptr<PadShape> shape;
  prediction::PadAnswer answer;  ///< of pad_layer, at the nominal load
  SoftContact contact;           ///< has a face

  /// Half lengths along x and y of the rectangle around the middle in which the centre of pressure
  /// may lie: beyond, the pad tips. It lies within the outline, and is all of it for a rectangle.
  std::array<double, 2> tipping_half_lengths_m() const;
  /// The farthest that the load may act from the middle along x, or along y, before the rim lifts
  /// off.
  std::array<double, 2> lift_off_half_lengths_m() const;
};

/// @param contact_case  of a flat pad
/// @param load_N        > 0
PadContact ask_pad_contact(const input::Case& contact_case, double load_N,
                           const prediction::Demand& demand);

/// The answer at the nominal load in the form of a curved contact's: e_n is one for all loads.
ContactCurve pad_curve(const PadContact& made, const input::Case& contact_case,
                       const LoadRange& loads);

/// A robot's shape in place of a flat one, its corners or rim at e_n from the pad's middle.
struct CornerShape {
  std::string words;  ///< in the format's words: its size, or a box in place of what has no size
  std::string kind;   ///< "box" or "cylinder", whose own size it is; empty: another shape
  std::string name, value;  ///< of the size
};
/// @param end  of the shape
CornerShape corner_shape(RobotFormat format, const RobotShape& shape, const FlatEnd& end,
                         const PadFace& face);

/// The first trap of every export of a pad.
/// @param in_pyramids  `Simulator::friction_is_pyramid`
constexpr const char* pad_points_trap(bool in_pyramids) {
  return in_pyramids
             ? "take the box: four points at the corners hold torque and tilting by their forces, "
               "with force and torque together 25 % below to 65 % above the friction ellipsoid, by "
               "the pyramid's directions (the pad itself up to 9 % below); the box tips before the "
               "pad does. One point, a small sphere in the pad's middle, has the torque by the "
               "engine's law and does not hold against tilting. Never both: the pad's own face as "
               "a box carries two to three times the torque by its corners' forces alone, and "
               "torsional friction adds to it"
             : "take the box, or Drake's patch: four points at the corners hold torque and tilting "
               "by their forces (force and torque together 10 to 20 % below the friction "
               "ellipsoid, the pad itself up to 9 %); the box tips before the pad does. One point, "
               "a small sphere in the pad's middle, has the torque by the engine's law and does "
               "not hold against tilting. Never both: the pad's own face as a box carries about "
               "twice the torque by its corners' forces alone, and torsional friction adds to it";
}

}  // namespace softfinger::exporting
