#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fem/finite/deformation.h"
#include "fem/problem/material_choice.h"

/// Hyperelastic materials: W(F) = Psi(F) + U(J). The elements take U at a volume ratio of their own
/// (three-field mixed form), so a material gives its two parts apart. Stresses in any one unit.
namespace softfinger::fem::finite {

/// Psi with its derivatives by F.
struct Response {
  double energy = 0;
  Eigen::Matrix3d stress;  ///< first Piola-Kirchhoff
  Matrix9d tangent;
};

/// U of a volume ratio with its derivatives.
struct VolumetricResponse {
  double energy = 0, pressure = 0, modulus = 0;  ///< U, U', U''
};

class VolumetricPart {
 public:
  VolumetricPart(VolumetricLaw law, double modulus) : law_(law), modulus_(modulus) {}
  VolumetricResponse operator()(double volume_ratio) const;
  VolumetricLaw law() const { return law_; }

 private:
  VolumetricLaw law_;
  double modulus_;
};

class Material {
 public:
  explicit Material(const VolumetricPart& volumetric) : volumetric_(volumetric) {}
  virtual ~Material() = default;

  /// Psi. @pre volume ratio > 0
  /// @param with_tangent  false: the tangent is left as it is
  virtual Response respond(const Deformation& deformation, bool with_tangent = true) const = 0;
  /// U. @pre volume ratio > 0
  VolumetricResponse respond_to_volume(double volume_ratio) const {
    return volumetric_(volume_ratio);
  }

  /// W, dW/dF, d²W/dF² at a point, with both parts at the same J.
  Response whole(const Deformation& deformation) const;

 private:
  VolumetricPart volumetric_;
};

/// With G = E/(2 (1 + nu)), k = E/(3 (1 - 2 nu)), lambda = k - 2 G/3, I1 = tr(F^T F),
/// I2 = |cof F|², and the isochoric invariants I1* = J^(-2/3) I1, I2* = J^(-4/3) I2:
///   neo-Hookean, quadratic:    G/2 (I1* - 3) + k/2 (J - 1)²
///   neo-Hookean, logarithmic:  G/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)²
///   Mooney-Rivlin:             c10 (I1* - 3) + c01 (I2* - 3) + U(J), 2 (c10 + c01) = G
///   Yeoh:                      c10 (I1* - 3) + c20 (I1* - 3)² + c30 (I1* - 3)³ + U(J), 2 c10 = G
/// with U = k/2 (J - 1)² or k/2 (ln J)² in the last two.
/// (G. A. Holzapfel, Nonlinear Solid Mechanics, 2000, sections 6.4 and 6.5; O. H. Yeoh, Rubber
/// Chemistry and Technology 66, 1993.)
/// @param poisson_ratio  0 <= nu < 1/2
/// @throws InputError for parameters that make no stable material: in uniaxial, equibiaxial or
/// planar stretch of the incompressible material, from 0.4 to 2.5, its stress would fall.
std::unique_ptr<const Material> make_material(const MaterialChoice& choice, double youngs_modulus,
                                              double poisson_ratio);

}  // namespace softfinger::fem::finite
