#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fem/contact/contact_edge.h"
#include "fem/layer/layer_model.h"

namespace softfinger::fem {

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

/// Nodal forces on a regular grid of faces, of the quarter x, y >= 0 of a symmetric contact.
struct NodalPressure {
  const std::vector<SurfaceNode>& nodes;
  const std::vector<SurfaceFace>& faces;
  const Eigen::VectorXd& force;  ///< per node, along the surface's normal
  bool layered = false;          ///< of several materials: the pressure may be any
  /// Deformation of the surface, if any: the pressure is then that on the deformed surface, and the
  /// distance from the centre is measured there, along each ray. (On the undeformed surface the
  /// force per area is pressure times stretch. Both fall as a square root at the edge, and their
  /// product does not.) The edge that is found is still that of the undeformed faces.
  const SurfaceDeformation* deformation = nullptr;
};

/// A smooth pressure that ends at a smooth edge.
struct PressureFit {
  ContactEdge edge;
  double centre_pressure = 0;  ///< at the edge's centre
  double peak = 0;             ///< largest
  double residual = 0;         ///< rms of (nodal - fitted) pressure over the mean pressure
  int degree = 0;              ///< of the polynomial
  double ambiguity = 0;        ///< relative difference in a or b of other degrees that fit as well
};

/// Fits p = sqrt(1 - r²) times a polynomial to nodal forces: the moments of p with the surface's
/// shape functions, in the norm of their lumped mass. r is the distance from the centre relative to
/// the edge's, which is a Fourier series in the scaled polar angle (contact_edge.h).
///
/// The root is the pressure's true behaviour at its edge, which is what makes the edge well
/// defined. The polynomial leaves the shape inside free. In a homogeneous layer a low degree is
/// known to do; elsewhere (a firm skin moves the peak away from the centre) it is the lowest one
/// that generalised cross-validation finds as good as any.
/// By symmetry it is one in x² and y², and the edge an ellipse along the axes with a fourth
/// harmonic.
/// @param edge  first guess
/// @returns none where no such pressure is found: the contact is no single smooth patch, the fit
/// leaves the faces, or the residual stays large
std::optional<PressureFit> fit_pressure(const NodalPressure& pressure, const ContactEdge& edge);

}  // namespace softfinger::fem
