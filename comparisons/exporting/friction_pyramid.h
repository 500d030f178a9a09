#pragma once

#include <algorithm>
#include <cmath>

#include "comparisons/exporting/pad_face.h"

/// Points whose friction is a pyramid with a square base: along each of two axes that lie in the
/// contact's plane the force is at most mu N, so that it is sqrt(2) mu N between them. The engine
/// chooses the axes, whatever the orientation of the points. ODE and DART share this law.
namespace softfinger::exporting {

/// The largest torque about the normal of points that share a load, over mu P times their distance
/// from the middle (1 under Coulomb's law), at the least and the most favourable orientation. It is
/// the least dissipation of a turn about any centre c (limit analysis), which falls apart into the
/// two axes: sum_i |x_i - c_x| + |y_i - c_y|, each sum least at the coordinates' median.
struct PyramidTorque {
  double least = 1, most = 1;

  /// In the middle: the torque is off by at most `worst_error` to either side.
  double middle() const { return (least + most) / 2; }
  double worst_error() const { return (most - least) / (most + least); }
};

/// Three points on a circle, at equal angles.
inline PyramidTorque three_points_in_pyramids() {
  // One of them on an axis; and turned by 15 degrees.
  return {(3 + 2 * std::sqrt(3.0)) / 6, (std::sqrt(2.0) + std::sqrt(6.0)) / std::sqrt(12.0)};
}

/// The corners of a rectangle with the face's sides; of a disc's rim, those of its square.
inline PyramidTorque corners_in_pyramids(const PadFace& face) {
  const double diagonal_m = std::hypot(face.length_m, face.width_m),
               cosine = face.length_m / diagonal_m, sine = face.width_m / diagonal_m;
  // With one diagonal along an axis; with the sides along the axes, and halfway between them.
  return {(1 + std::abs(cosine * cosine - sine * sine) + 2 * cosine * sine) / 2,
          std::max(cosine + sine, std::sqrt(2.0) * std::max(cosine, sine))};
}

/// The face with a smaller e_n, by which `PadFace` places points so that in pyramids they have the
/// face's torque: within `PyramidTorque::worst_error`, whatever the directions.
inline PadFace face_in_pyramids(PadFace face) {
  face.eccentricity_m /= corners_in_pyramids(face).middle();
  return face;
}

}  // namespace softfinger::exporting
