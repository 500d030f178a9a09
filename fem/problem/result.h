#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "fem/problem/mirror_planes.h"
#include "softfinger/input/pressing_friction.h"

namespace softfinger::fem {

/// One discretisation's answer, SI.
struct LevelResult {
  int level = 0;
  int elements_per_semi_axis = 0;
  long unknowns = 0;
  int active_nodes = 0;  ///< nodes that touch, of what is meshed (see `Result::planes`)
  int iterations = 0;    ///< of the active set; at finite strain of Newton's method
  double turn_rad = 0;   ///< from the relative radii's long axis to the contact's
  double load_N = 0;     ///< as given, or what the given approach takes
  double a_m = 0, b_m = 0, indentation_m = 0, peak_pressure_Pa = 0;
  /// int tau r dA and int tau dA of the frictionless pressure, tau the shear law's stress.
  double max_torque_Nm = 0, max_force_N = 0;
  double torque_arm_m = 0;  ///< int p r dA / P of the frictionless pressure
  /// Arm of the pressure as the contact is pressed, with or without friction, and the share of its
  /// area that sticks then.
  double pressure_arm_m = 0, stick_share = 0;
  /// The area that touches, seen along the load, and on the deformed surface. The first is what
  /// models of contact predict. The second has the object's slope, in linear elasticity too.
  double area_projected_m2 = 0, area_m2 = 0;
  double centre_pressure_Pa = 0;  ///< in the contact's middle, where the peak need not be
  /// Points around the contact, seen along the load, in the contact's frame; more than one where it
  /// has parts or holes, the longest first.
  std::vector<Eigen::Matrix2Xd> outlines_m;
  double ellipse_departure = 0;  ///< largest distance of the outline from the ellipse, over b
  double cell_m = 0;  ///< side of the surface's cells; 0 on a mesh from outside, whose cells differ
  /// Whether a smooth pressure was fitted, which tells the edge to a small part of a cell.
  bool fitted = false;
  /// At finite strain: int mu p n_z r dA, the torque seen along the load, and the energy stored.
  double max_torque_projected_Nm = 0, strain_energy_J = 0;
  double load_residual = 0;  ///< |sum of nodal forces - P| / P
  double complementarity_residual =
      0;  ///< worst penetration or tension, relative to d and to the peak pressure
  /// Rms of the pressure fit that gives the edge, relative to the mean pressure; 0 without one.
  double fit_residual = 0;
  double fit_ambiguity = 0;  ///< relative, of a and b: what fits of other degrees would say
  /// Size of the contact that the mesh was made for, relative to this contact: 1 on a mesh of its
  /// own, larger where the meshes of an earlier contact serve.
  double oversize = 1;
  double wall_s = 0, cpu_s = 0;
};

/// Quantities that the side wall of the layer changes, relative.
struct WallChange {
  double a = 0, b = 0, area = 0, indentation = 0, peak_pressure = 0, max_torque = 0, load = 0;
  double max_force = 0;
};

/// Relative, stated at about 95 % confidence.
struct RelativeError {
  double a = 0, b = 0, area = 0, indentation = 0, peak_pressure = 0, max_torque = 0;
  double load = 0;  ///< of what a given approach takes
};

/// Forces of friction on the layer about the contact's centre, along the contact's axes.
struct Wrench {
  double force_x_N = 0, force_y_N = 0, torque_Nm = 0;
};

/// The change of a contact by friction at finite strain, relative to the frictionless one.
struct ShearedContact {
  double area_ratio = 1;           ///< seen along the load
  double peak_pressure_ratio = 1;  ///< of the nodes
  double approach_ratio = 1;       ///< of the indentation, at the same load
};

/// A state on the way from stick to slip. The object's motion counts from the end of the
/// frictionless pressing.
struct FrictionIncrement {
  double shift_x_m = 0, shift_y_m = 0, angle_rad = 0;
  Wrench wrench;
  double slip_fraction = 0;                              ///< of the contact's area
  std::optional<ShearedContact> sheared = std::nullopt;  ///< where it was solved for
};

struct Torsion {
  std::vector<FrictionIncrement> increments;
  PressingFriction pressing = PressingFriction::none;  ///< that the twist starts from
  /// At the start, all points stuck; extrapolated over the levels.
  double stiffness_Nm_per_rad = 0;
  double full_slip_Nm = 0;  ///< torque when every point slips
  /// Stated errors, relative; that of the curve relative to the torque at full slip.
  double stiffness_error = 0, full_slip_error = 0, curve_error = 0;
};

struct LimitPoint {
  Wrench wrench;
  std::optional<ShearedContact> sheared = std::nullopt;
  std::vector<FrictionIncrement> path;  ///< partial slip, when asked for
};

/// Forces of the contact on the nodes of the surface that touch, in all mirror images: seen along
/// the load, from the contact's centre, x along its long axis. They add up to the load.
struct NodalForces {
  std::vector<double> x_m, y_m, force_N;
  std::vector<double> friction_x_N, friction_y_N;  ///< on the layer, while it is pressed
  std::vector<double> area_m2;  ///< share of the surface before it is deformed, seen along the load
};

struct Profile {
  std::vector<double> position_m, pressure_Pa;
};

struct Result {
  /// The layer is meshed on one side of these: a quarter of it with both, a half with one of them.
  MirrorPlanes planes;
  LevelResult finest;
  /// `finest` if it were pressed without friction; set where the problem presses with it.
  std::optional<LevelResult> frictionless;
  std::vector<LevelResult> levels;  ///< coarse to fine, `finest` included
  RelativeError error;
  /// Half of what a clamped side wall changes, from the free one, measured on the coarse level. A
  /// real layer goes on beyond it and lies between the two: all levels are corrected by this much.
  WallChange wall;
  /// The error that facets and noise of a scanned finger leave open, at 95 %: where the surface
  /// lies, what is smoothed away, and the normal of the frame. None: the finger is no scan, or it
  /// cannot be pressed with its vertices moved.
  std::optional<RelativeError> geometry_error;
  /// The place where a scanned finger touches the object first, from the aimed point in the
  /// contact's frame; outlines and profiles count from there.
  std::array<double, 3> first_touch_m{};
  /// The centre of the pressure (x, y), about which friction's motions turn and its torques are
  /// taken, as an offset from `first_touch_m`.
  std::array<double, 2> friction_centre_m{};
  double pressure_exponent =
      0;  ///< n of p0 (1 - r²)^n with the same load, area and peak: pi a b p0 / P - 1
  std::optional<NodalForces> forces;  ///< where the problem asks for them
  Profile along_x, along_y;           ///< nodal pressure from the centre outwards
  std::optional<Torsion> torsion;
  std::vector<LimitPoint> limit_surface;
  /// Stated error of the limit surface's points, relative to the largest force and torque.
  double limit_surface_error = 0;
  bool interrupted = false;  ///< a coarser answer than was asked for, its errors stated accordingly
  std::string vtu_file;      ///< empty when none was asked for
  std::string pvd_file;      ///< of the twist's surface states; empty without
  double wall_s = 0, cpu_s = 0, peak_memory_MB = 0;
};

}  // namespace softfinger::fem
