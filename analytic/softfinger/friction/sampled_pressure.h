#pragma once

#include <vector>

#include "softfinger/friction/limit_surface.h"

namespace softfinger {

/// Pressure known at points: the resultant over the piece of the contact that a point stands for,
/// e.g. pressure times area at the quadrature points of a mesh.
struct PressureSample {
  double x_m = 0, y_m = 0;    ///< in the contact plane
  double normal_force_N = 0;  ///< >= 0; samples without force (or not finite) are ignored
};

/// Force, torque and limit surface of a contact whose pressure is given at points. Same sign and
/// same questions as LimitSurface; nothing is assumed about the shape of the contact or of the
/// pressure. Torques are about `reference`, the centre of pressure by default.
///
/// Every sample stands for a small disc of radius `patch_radius_m` with uniform pressure, whose
/// friction ellipsoid has the support function F sqrt(v² + (2/3 r omega)²). The radius matters only
/// to samples within a few radii of the centre of rotation. A sample of radius zero exactly at that
/// centre contributes nothing, the middle of the wrenches that Coulomb's law allows there. A
/// surface of such samples has flat facets, and its normals jump between them: with the discs' true
/// radius, sqrt(area / pi), `utilisation` and `project` converge faster.
///
/// Cost: 5 ns per sample and wrench, ten to thirty wrenches per utilisation or projection. Only
/// the constructor allocates (it copies the samples); only it throws (std::bad_alloc).
/// Accuracy is that of the samples as a quadrature.
class SampledPressure {
 public:
  /// @param samples         any number; with no force at all nothing can be carried
  /// @param friction        mu >= 0
  /// @param patch_radius_m  radius of a sample's patch, >= 0
  SampledPressure(const std::vector<PressureSample>& samples, double friction,
                  double patch_radius_m = 0);

  double normal_force_N() const noexcept { return normal_force_N_; }
  double max_force_N() const noexcept { return friction_ * normal_force_N_; }
  double center_x_m() const noexcept { return center_x_m_; }  ///< centre of pressure
  double center_y_m() const noexcept { return center_y_m_; }

  /// Moves the point about which torques are taken and whose velocity a twist gives.
  void set_reference(double x_m, double y_m) noexcept;

  /// e_n about the reference: (sum F |r - reference|) / sum F.
  double eccentricity_m() const noexcept { return eccentricity_m_; }
  double max_torque_Nm() const noexcept { return max_force_N() * eccentricity_m_; }
  FrictionEllipsoid ellipsoid() const noexcept { return {max_force_N(), eccentricity_m_}; }

  LimitWrench wrench_for_twist(const Twist& twist) const noexcept;
  /// Counter-clockwise turn about a finite point.
  LimitWrench wrench_for_center_of_rotation(double x_m, double y_m) const noexcept;
  double support(const Twist& twist) const noexcept;
  double utilisation(const LimitWrench& wrench) const noexcept;
  bool contains(const LimitWrench& wrench) const noexcept { return utilisation(wrench) <= 1; }
  LimitWrench project(const LimitWrench& wrench) const noexcept;

 private:
  Eigen::Vector3d scaled_wrench(const Eigen::Vector3d& twist,
                                Eigen::Matrix3d* hessian) const noexcept;

  std::vector<PressureSample> samples_;
  double friction_ = 0, patch_arm_m_ = 0;
  double normal_force_N_ = 0, center_x_m_ = 0, center_y_m_ = 0;
  double reference_x_m_ = 0, reference_y_m_ = 0, eccentricity_m_ = 0;
};

}  // namespace softfinger
