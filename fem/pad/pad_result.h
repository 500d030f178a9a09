#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "fem/problem/result.h"

namespace softfinger::fem {

/// A pad's answer on one mesh, SI. Pairs of numbers are along x and y, or about x and y.
struct PadLevel {
  int level = 0, cells_across = 0, cells_deep = 0;
  long unknowns = 0;
  int face_nodes = 0;
  double cpu_s = 0;

  double area_m2 = 0;  ///< that the object covers
  /// Half-lengths along x and y of the contact with a curved object; 0: a flat one.
  std::array<double, 2> contact_half_lengths_m{};
  double normal_stiffness_N_per_m = 0;  ///< load over approach of a face that does not tilt
  double indentation_m = 0;             ///< of the face where the load acts
  double peak_pressure_Pa = 0;          ///< within 0.95 of the outline: its edge is singular
  double pressure_arm_m = 0;            ///< int p r dA / P about the pressure's centre, as pressed
  double eccentricity_m = 0;            ///< the arm of frictionless pressing
  double max_torque_Nm = 0;             ///< mu P eccentricity
  /// Moment per angle of a face that is free to approach, as pressed.
  std::array<double, 2> tilt_stiffness_Nm_per_rad{};
  /// Moment per angle where the face is free to move sideways, too.
  std::array<double, 2> free_tilt_stiffness_Nm_per_rad{};
  /// Largest moment of the load about the centre of stiffness without any tension.
  std::array<double, 2> tilt_limit_Nm{}, free_tilt_limit_Nm{};
  double torsional_stiffness_Nm_per_rad = 0;        ///< stuck, free to move sideways
  std::array<double, 2> shear_stiffness_N_per_m{};  ///< stuck, the face held parallel
  std::array<double, 2> shear_moment_Nm_per_m{};    ///< moment that holds it so: about y, about x
};

/// Relative errors of the quantities of `PadLevel`, at about 95 % confidence.
struct PadError {
  double normal_stiffness = 0, indentation = 0, peak_pressure = 0, pressure_arm = 0;
  double eccentricity = 0, max_torque = 0, torsional_stiffness = 0;
  std::array<double, 2> tilt_stiffness{}, free_tilt_stiffness{}, tilt_limit{}, free_tilt_limit{};
  std::array<double, 2> shear_stiffness{};
};

/// The pressure of a pad at its nodes: sum of pressure times weight is the load.
struct PadPressure {
  std::vector<double> x_m, y_m, pressure_Pa, weight_m2;
};

struct PadResult {
  PadLevel finest;
  std::vector<PadLevel> levels;  ///< coarse to fine, `finest` included
  PadError error;
  MirrorPlanes planes;  ///< a quarter was meshed, or the whole
  std::array<double, 2> load_point_m{};
  std::array<double, 2> stiffness_centre_m{};  ///< a load there does not tilt the face
  std::array<double, 2> tilt_rad{};            ///< deeper at larger x, at larger y
  std::array<double, 2> centre_of_pressure_m{};
  double uniform_arm_m = 0;           ///< int r dA / A about the face's centroid
  double lifted_share = 0;            ///< of the area, in which the face has lifted off
  PadPressure pressure;               ///< as pressed
  std::vector<Wrench> limit_surface;  ///< about the pressure's centre
  double wall_s = 0, cpu_s = 0, peak_memory_MB = 0;
};

}  // namespace softfinger::fem
