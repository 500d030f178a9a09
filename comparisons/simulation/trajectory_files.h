#pragma once

#include <filesystem>
#include <string>

#include "comparisons/simulation/recording.h"

/// A recording as files for other programs. SI units, the suffix of a column or key is its unit;
/// vectors in world axes; every number is written with the digits that give it back exactly.
namespace softfinger::simulation {

/// One row per step and body, fixed bodies too:
///   time_s, body, position_x_m, _y_m, _z_m, quaternion_w, _x, _y, _z (body to world, w >= 0),
///   velocity_x_m_per_s, ..., angular_velocity_x_rad_per_s, ...
/// @throws std::out_of_range when a frame lacks a body.
std::string trajectory_csv(const Recording& recording);

/// One row per step and contact:
///   time_s, body_a, body_b, point_x_m, ..., normal_x, ... (from a to b), semi_axis_a_m,
///   semi_axis_b_m (0: a point), long_axis_x, ..., normal_force_N, tangential_force_x_N, ... and
///   torque_about_normal_Nm (both on b), friction_coefficient, eccentricity_m, pressure_exponent,
///   utilisation, slides (true or false: at its friction limit and faster than 1 nm/s, so that it
///   may but creep), model, friction_law
/// @throws std::out_of_range when a contact names a body that does not exist.
std::string contacts_csv(const Recording& recording);

/// The recording as one JSON object:
///   { "scene", "question", "time_step_s",
///     "bodies": [ { "name", "movable", "shapes": [ { "kind", sizes, "position_m",
///                   "quaternion_wxyz" } ] } ],      a mesh by its counts: the VTU files have it
///     "frames": [ { "time_s", "position_m": [[x, y, z], one per body], "quaternion_wxyz",
///                   "velocity_m_per_s", "angular_velocity_rad_per_s",
///                   "contacts": [ { "a", "b" (indices of bodies), "point_m", "normal",
///                     "long_axis", "semi_axes_m", "normal_force_N", "tangential_force_N",
///                     "torque_about_normal_Nm", "friction_coefficient", "eccentricity_m",
///                     "pressure_exponent", "utilisation", "slides", "model",
///                     "friction_law" } ] } ] }
std::string trajectory_json(const Recording& recording);

/// trajectory.csv, contacts.csv and trajectory.json in a folder that exists, all or none.
/// @throws InputError when they cannot be written.
void write_trajectory(const Recording& recording, const std::filesystem::path& folder);

}  // namespace softfinger::simulation
