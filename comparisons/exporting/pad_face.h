#pragma once

#include <array>
#include <cmath>

namespace softfinger::exporting {

/// The flat face of a pad, for engines that make several contact points of it, or that have a
/// pressure.
struct PadFace {
  double length_m = 0, width_m = 0;  ///< of the contact, along x and y
  double area_m2 = 0;
  double thickness_m = 0;             ///< of the soft layer
  double eccentricity_m = 0;          ///< e_n of a load in the middle
  double corner_distance_m = 0;       ///< of the outline's farthest corner from its middle
  double uniform_eccentricity_m = 0;  ///< e_n that uniform pressure on the face would have
  /// Likewise on a box of this length and width: a rectangle is its own box.
  double box_uniform_eccentricity_m = 0;

  /// Relative error of the torque where an engine makes points at the face's own corners, and where
  /// it has a uniform pressure on the face.
  double error_of_points() const { return corner_distance_m / eccentricity_m - 1; }
  double error_of_pressure() const { return uniform_eccentricity_m / eccentricity_m - 1; }

  /// Half lengths of the box of the face's aspect ratio whose corners lie at e_n from its middle.
  /// Four points at the corners share a load in the middle: they slip together, at mu P e_n.
  std::array<double, 2> corner_box_m() const {
    return scaled_m(eccentricity_m / std::hypot(length_m, width_m));
  }
  /// Half lengths of the box of the face's aspect ratio on which uniform pressure has this e_n.
  std::array<double, 2> pressed_box_m() const {
    return scaled_m(eccentricity_m / box_uniform_eccentricity_m / 2);
  }

 private:
  std::array<double, 2> scaled_m(double factor) const {
    return {factor * length_m, factor * width_m};
  }
};

}  // namespace softfinger::exporting
