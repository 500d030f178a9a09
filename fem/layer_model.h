#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

namespace softfinger::fem {

/// How a layer is meshed for a contact of semi-axes a >= b. Lengths in units of the thickness h.
struct LayerDiscretisation {
  double a = 1, b = 1;
  int elements_per_semi_axis = 8;  ///< finest cells along b
  double patch = 1.25;             ///< contact is possible within this multiple of the ellipse
  double extent = 6;               ///< free side wall at a + extent, b + extent

  /// Finest cells along a: as many as along b, more where cells would be longer than three times
  /// their width.
  int elements_along_a() const;
};

/// A node where the surface can be touched.
struct SurfaceNode {
  double x = 0, y = 0;
  double weight = 0;  ///< integral of its shape function over the quarter surface, > 0
};

/// A finest face of the surface, an axis-parallel rectangle, with the nodes of its biquadratic
/// shape functions (index x + 3 y; -1 where the node cannot be touched).
struct SurfaceFace {
  double x = 0, y = 0, size_x = 0, size_y = 0;
  std::array<int, 9> node;
};

/// What a displacement field does under the mirrors x -> -x and y -> -y: an even one is its own
/// mirror image (no normal displacement on the plane), an odd one its negative (normal displacement
/// only). Every field on the whole layer is a sum of four such fields, each known from a quarter.
struct Parity {
  bool odd_x = false, odd_y = false;
};

/// Quarter of an elastic layer bonded to a rigid base, condensed on the displacements of its
/// surface nodes. Lengths / h, stresses / E: one model serves every load, radius, modulus and
/// coefficient of friction for which the contact stays inside the patch.
///
/// Q2 displacements; the volumetric strain is projected on discontinuous linear functions per
/// element (Q2/P1disc with the pressure condensed), which neither locks nor oscillates as nu ->
/// 1/2.
class LayerModel {
 public:
  /// @param poisson_ratio  0 <= nu < 1/2
  /// @throws ConvergenceError from the factorisation.
  LayerModel(const LayerDiscretisation& discretisation, double poisson_ratio);
  ~LayerModel();
  LayerModel(const LayerModel&) = delete;
  LayerModel& operator=(const LayerModel&) = delete;

  const LayerDiscretisation& discretisation() const;
  const std::vector<SurfaceNode>& nodes() const;
  const std::vector<SurfaceFace>& faces() const;
  long unknowns() const;

  /// Displacement into the layer per unit force into it on the quarter model, n x n, for fields
  /// even in x and y.
  const Eigen::MatrixXd& compliance() const;

  /// Displacement per unit force on the quarter model, fields of the given parity, for some of the
  /// nodes: 3 x 3 blocks in the order x, y, z, where z points into the layer. Rows and columns of
  /// components that the parity fixes are zero. Each call factorises.
  Eigen::MatrixXd vector_compliance(Parity parity, const std::vector<int>& nodes) const;

  /// Displacement, stress and contact pressure of the quarter in SI units, atomically.
  /// @param force  per surface node, in units of E h²
  /// @throws InputError when the file cannot be written
  void write_vtu(const std::string& path, const Eigen::VectorXd& force, double thickness_m,
                 double youngs_modulus_Pa) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger::fem
