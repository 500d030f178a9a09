#pragma once

#include <Eigen/Core>
#include <vector>

#include "fem/layer_model.h"

namespace softfinger::fem {

/// The ellipse under which a nodal pressure is spread, and what the pressure is in its middle.
struct PressureEllipse {
  double a = 0, b = 0;  ///< along x and y
  double diamond = 0;   ///< e4: the edge is at 1 + e4 cos 4t in scaled polar coordinates
  double peak = 0;      ///< fitted pressure at the centre
  double residual = 0;  ///< rms of (nodal - fitted) pressure over the mean pressure
};

/// A surface that has been deformed, by where the points of its faces have gone.
class SurfaceDeformation {
 public:
  virtual ~SurfaceDeformation() = default;
  struct Point {
    Eigen::Vector3d position;
    double area_ratio;  ///< deformed area per area of the faces
  };
  /// @param xi,eta  0 to 1, along the face's sides
  virtual Point at(std::size_t face, double xi, double eta) const = 0;
};

/// Fits p = sqrt(1 - r²) (c0 + c1 X + c2 Y + c3 X² + c4 XY + c5 Y²), X = x²/a², Y = y²/b², r² = X +
/// Y, to nodal forces: the moments of p with the surface's shape functions, in the norm of their
/// lumped mass.
///
/// The root is the pressure's true behaviour at its edge, which is what makes a and b well defined;
/// the polynomial leaves the shape inside free, since on a layer it is no power of 1 - r².
/// @param force  per node of the quarter model
/// @param a, b   first guess
/// @param deformation  where the surface is deformed: p is then the pressure on the deformed
/// surface, and r is measured there, along each ray from the centre. (On the undeformed surface the
/// force per area is pressure times stretch. Both fall as a square root at the edge, and their
/// product does not.) The ellipse that is returned is still that of the undeformed faces.
/// @throws ConvergenceError when the fit leaves the patch.
PressureEllipse fit_pressure_ellipse(const std::vector<SurfaceNode>& nodes,
                                     const std::vector<SurfaceFace>& faces,
                                     const Eigen::VectorXd& force, double a, double b,
                                     const SurfaceDeformation* deformation = nullptr);

}  // namespace softfinger::fem
