#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

/// The problem that every model of this project solves: an elastic layer on a rigid core, the
/// relative curvature of the two bodies, a load. SI units; the suffix of a name is its unit.
namespace softfinger {

/// Homogeneous, isotropic, linearly elastic layer bonded to a rigid base.
struct ElasticLayer {
  double thickness_m = 0;        ///< h > 0
  double youngs_modulus_Pa = 0;  ///< E > 0
  double poisson_ratio = 0;      ///< 0 <= nu <= 1/2

  /// G = E / (2 (1 + nu))
  double shear_modulus_Pa() const { return youngs_modulus_Pa / (2 * (1 + poisson_ratio)); }

  /// E* = E / (1 - nu²), for a rigid object
  double plane_strain_modulus_Pa() const {
    return youngs_modulus_Pa / (1 - poisson_ratio * poisson_ratio);
  }

  /// Oedometric (confined) modulus M = E (1 - nu) / ((1 + nu)(1 - 2 nu)); infinite at nu = 1/2.
  double oedometric_modulus_Pa() const {
    const double compressibility = 1 - 2 * poisson_ratio;
    return compressibility > 0
               ? youngs_modulus_Pa * (1 - poisson_ratio) / ((1 + poisson_ratio) * compressibility)
               : std::numeric_limits<double>::infinity();
  }
};

/// Layers that are bonded to each other, from the surface inwards, and to a rigid base.
struct LayerStack {
  static constexpr std::size_t kMost = 8;
  std::array<ElasticLayer, kMost> sublayers{};
  std::size_t count = 0;  ///< 0: none

  LayerStack() = default;
  /// One layer; none if it has no thickness.
  LayerStack(const ElasticLayer& layer) : count(layer.thickness_m == 0 ? 0 : 1) {
    sublayers[0] = layer;
  }

  const ElasticLayer& surface() const { return sublayers[0]; }
  double thickness_m() const {
    double sum_m = 0;
    for (std::size_t i = 0; i < count; ++i) sum_m += sublayers[i].thickness_m;
    return sum_m;
  }
};

/// Relative radii of curvature of an undeformed contact: the gap between the surfaces is
/// x²/(2 R') + y²/(2 R''), x along the long axis of the contact (Ciocarlie et al. 2007, eq. 8).
struct RelativeRadii {
  double major_m = 0;   ///< R' >= R'' > 0
  double minor_m = 0;   ///< R''
  double axis_rad = 0;  ///< direction of x, counter-clockwise from the first body's x axis
};

/// Curvature of a surface along the contact's axes x and y: depth below the tangent plane is
/// (xx x² + yy y²)/2 + xy x y, so that a convex surface has positive curvatures.
struct SurfaceCurvature {
  double xx_per_m = 0, yy_per_m = 0, xy_per_m = 0;
};

/// Curvature of a surface with principal radii `radius_x_m`, `radius_y_m` (infinite: flat,
/// negative: hollow) along axes of its own, seen along axes that are turned from them by
/// `turn_rad`, counter-clockwise.
inline SurfaceCurvature curvature_along(double radius_x_m, double radius_y_m, double turn_rad) {
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  const double x_per_m = 1 / radius_x_m, y_per_m = 1 / radius_y_m;
  return {x_per_m * c * c + y_per_m * s * s, x_per_m * s * s + y_per_m * c * c,
          (y_per_m - x_per_m) * s * c};
}

struct ContactLoad {
  double normal_force_N = 0;        ///< P > 0
  double friction_coefficient = 0;  ///< mu >= 0
};

/// Which modulus an elastic foundation gives a column of the layer.
enum class WinklerModulus {
  oedometric,  ///< M, confined: right for a thin compressible layer bonded to its base
  youngs  ///< E, free sides: as Ciocarlie et al. (2007) may have meant; right for a bonded layer at
          ///< nu = 0 only
};

/// Empirical contact of Xydias & Kao (1999): a = coefficient P^exponent for a round contact,
/// pressure ~ (1 - (r/a)^k)^(1/k). A coefficient of zero: no such law is known for this finger.
struct PowerLaw {
  double radius_coefficient = 0;  ///< c in a_m = c (P_N)^gamma, >= 0
  double radius_exponent =
      1.0 / 3;                   ///< gamma, 0 < gamma < 1: 1/3 linear elastic, towards 0 stiffening
  double pressure_exponent = 2;  ///< k >= 1: 2 Hertz-like, larger flatter
};

/// Options of individual models; the others ignore them.
struct ModelOptions {
  WinklerModulus winkler_modulus = WinklerModulus::oedometric;
  PowerLaw power_law;
};

struct ContactProblem {
  RelativeRadii radii;
  ElasticLayer layer;
  ContactLoad load;
  ElasticLayer object_layer{};  ///< bonded to the object's rigid core; thickness 0: a rigid object
  ModelOptions options{};
  /// Curvature of the finger's own, undeformed surface, which carries the layer; the object has the
  /// rest of the relative curvature. Zero: a flat layer under a curved object.
  SurfaceCurvature finger_curvature{};
  /// The object is the exact sphere, not its paraboloid. Only models of large deformation see it.
  bool is_object_spherical = false;

  /// Sublayers of the finger's layer, for models that know them (`PressureModel::knows_stacks`);
  /// `layer` is then the homogeneous layer that stands for them. None: the layer is homogeneous.
  LayerStack stack{};

  bool has_object_layer() const { return object_layer.thickness_m > 0; }
  LayerStack finger_layers() const { return stack.count > 0 ? stack : LayerStack(layer); }
};

}  // namespace softfinger
