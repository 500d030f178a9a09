#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace softfinger::fem {

/// The shape of a pad's face or of an object's, a convex one.
struct FlatShape {
  enum class Kind { disc, rectangle, polygon };
  Kind kind = Kind::disc;
  double radius_m = 0;                          ///< of a disc, > 0
  std::array<double, 2> lengths_m{};            ///< of a rectangle along x and y, > 0
  double corner_radius_m = 0;                   ///< of a rectangle, 0 to half of its shorter length
  std::vector<std::array<double, 2>> points_m;  ///< of a polygon, in order around it
};

/// An object's face that is smaller than the pad's.
struct ObjectFace {
  FlatShape shape;
  std::array<double, 2> offset_m{};  ///< of its origin from the pad's
  double angle_rad = 0;              ///< about its own origin
};

/// An object that is curved along x and y, without an end: a cylinder (one radius infinite), a
/// sphere or another quadric, gap x²/(2 R_x) + y²/(2 R_y) about its middle.
struct CurvedObject {
  std::array<double, 2> radii_m{};   ///< > 0, not both infinite
  std::array<double, 2> offset_m{};  ///< of its middle from the pad's
};

/// Conditions along the face while it is pressed.
enum class PadPressing {
  frictionless,
  stuck,  ///< no point moves along the face from the first touch on
};

/// A flat pad: a block of rubber bonded to a rigid backing, its side walls free, pressed by a rigid
/// flat face, or by a curved object that does not turn. The origin is that of the outline's
/// coordinates; a disc or rectangle lies about it.
struct PadProblem {
  std::string name = "pad";
  FlatShape outline;
  /// Radius of the fillet between face and side walls, which lies outside of `outline` and stays
  /// clear; 0 to 0.9 times the thickness. Below a twentieth of that it is left out.
  double edge_radius_m = 0;
  double thickness_m = 0;          ///< > 0
  double youngs_modulus_Pa = 0;    ///< > 0
  double poisson_ratio = 0;        ///< 0 to 1/2
  std::optional<ObjectFace> face;  ///< none: a plane that is larger than the pad
  /// In the place of a flat face: on a rectangle, without friction, no `load_point_m`.
  std::optional<CurvedObject> object;
  PadPressing pressing = PadPressing::frictionless;
  double load_N = 0;  ///< > 0
  /// The line along which the load acts; none: the one that does not tilt the face.
  std::optional<std::array<double, 2>> load_point_m;
  double friction_coefficient = 0;  ///< > 0
  int limit_surface = 0;            ///< points of full slip; 0: none
  int level = 2;                    ///< 1 to 3
};

}  // namespace softfinger::fem
