#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "comparisons/input/friction_law.h"
#include "comparisons/input/shape.h"
#include "softfinger/input/contact_problem.h"

/// Record of a simulation: poses and contacts over time, for files and for the page.
namespace softfinger::simulation {

struct RecordedBody {
  std::string name;
  bool movable = true;               ///< false: fixed to the world
  std::vector<input::Shape> shapes;  ///< may be empty
};

/// A contact at the end of a step. Forces and torque act on body `b`; -them on body `a`.
struct RecordedContact {
  int a = -1, b = -1;  ///< bodies; a fixed one may be among them
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  /// Columns: first tangent (along the long axis), second tangent, normal from `a` to `b`.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  RelativeRadii radii;                          ///< of the quadrics there; zero: a point contact
  SurfaceCurvature finger_curvature;            ///< of the body with the layer, along `axes`
  double semi_axis_a_m = 0, semi_axis_b_m = 0;  ///< of the contact ellipse; 0: a point contact
  double normal_force_N = 0, tangent_force_1_N = 0, tangent_force_2_N = 0, torque_Nm = 0;
  double friction_coefficient = 0;  ///< largest force over normal force, that was used
  double eccentricity_m = 0;        ///< e_n that was used; 0: carries no torque
  double pressure_exponent = 0.5;   ///< n of the exact limit surface
  const input::FrictionLaw* friction = &input::kEllipsoidLaw;  ///< that held
  /// Share of its friction limit that the contact uses by its law, 1 at the limit. For facets by
  /// the ellipsoid on which their corners lie, so that a contact may slide at a little less than 1.
  double utilisation = 0;
  bool slides = false;  ///< as the solver decided: at its limit, faster than 1 nm/s; it may creep
  std::string model;    ///< "rigid", or the pressure model
};

struct Frame {
  double time_s = 0;
  std::vector<Eigen::Isometry3d> poses;                                           ///< of every body
  std::vector<Eigen::Vector3d> velocities_m_per_s, angular_velocities_rad_per_s;  ///< of the same
  std::vector<RecordedContact> contacts;
};

/// Two bodies of which one is soft, in contacts whose error is not known, or that are taken as
/// rigid points though one of the bodies is soft.
struct UnknownContact {
  int a = -1, b = -1;
  std::string why;  ///< as `error_bound` has it; empty: taken as rigid points
  int steps = 0;    ///< in which there was such a contact
  double first_s = 0;
  /// The largest ones, by the contact's own model: slope a/R' or b/R'' at the edge, indentation
  /// over thickness, sqrt(ab) over thickness, and load. Zero for rigid points but for the load.
  double slope = 0, strain = 0, size = 0, load_N = 0;
};

/// "left_tip - object: the error of its model is not known (...): in 12 of 2000 steps, first at
/// 0.1 s, with up to ..."
std::string in_words(const UnknownContact& contact, const std::vector<RecordedBody>& bodies,
                     int steps);

struct Recording {
  std::string scene, question;
  double time_step_s = 0;
  std::vector<RecordedBody> bodies;
  std::vector<Frame> frames;  ///< one per step, the first one at the start
  std::vector<UnknownContact> unknown;
};

}  // namespace softfinger::simulation
