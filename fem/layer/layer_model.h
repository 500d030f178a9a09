#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fem/base/outcome.h"
#include "fem/layer/layer_discretisation.h"
#include "fem/layer/layer_shape.h"
#include "fem/layer/surface_nodes.h"
#include "fem/problem/mirror_planes.h"

namespace softfinger::meshes {
struct LayerMesh;
}

namespace softfinger::fem {

/// Symmetry of a displacement field under the mirrors x -> -x and y -> -y: an even one is its own
/// mirror image (no normal displacement on the plane), an odd one its negative (normal displacement
/// only). Every field on the whole layer is a sum of four such fields, each known from a quarter;
/// or of two that are even and odd about one plane, each known from a half.
struct Parity {
  bool odd_x = false, odd_y = false;
};

/// Elastic constants of a sublayer.
struct ElasticConstants {
  double youngs_ratio = 1;   ///< E over the unit of stress
  double poisson_ratio = 0;  ///< 0 <= nu < 1/2

  bool operator==(const ElasticConstants& other) const {
    return youngs_ratio == other.youngs_ratio && poisson_ratio == other.poisson_ratio;
  }
};

/// A second layer, which is bonded to the object and touches the first one. Both are flat.
struct OppositeLayer {
  double thickness = 1;  ///< over h
  ElasticConstants constants;

  bool operator==(const OppositeLayer& other) const {
    return thickness == other.thickness && constants == other.constants;
  }
};

/// The displacements of the surface nodes that a layer is condensed to.
enum class Along {
  normals,  ///< one per node, into the layer
  all,      ///< three per node: along its tangents, and into the layer
};

/// Whether friction may act on a node ("it rubs"). Such a node is condensed to all of its
/// displacements, others to the one into the layer.
using Rubs = std::function<bool(const SurfaceNode&)>;
inline bool none_rubs(const SurfaceNode&) { return false; }
inline bool all_rub(const SurfaceNode&) { return true; }

/// Fields of a pressed layer in SI units: see layer_solution.h.
struct LayerSolution;

/// Unknowns of the layer that LayerModel would make of a mesh from outside: cells are halved and
/// counted, nothing is assembled.
long predicted_unknowns(const LayerDiscretisation& discretisation, const meshes::LayerMesh& mesh,
                        double thickness_m);

/// Elastic layer bonded to a rigid base, condensed on the displacements of its surface nodes: one
/// side of it of each mirror plane, so that it is a quarter, a half or the whole. Lengths / h,
/// stresses / E: one model serves every load, radius, modulus and coefficient of friction for which
/// the contact stays inside the patch.
///
/// Q2 displacements; the volumetric strain is projected on discontinuous linear functions per
/// element (Q2/P1disc with the pressure condensed), which neither locks nor oscillates as nu ->
/// 1/2.
class LayerModel {
 public:
  /// @param sublayers  from the surface inwards, one more than interfaces
  /// @param shape      null: flat
  /// @param planes     of layer, object and load
  /// @param rubs       nodes on which friction may act, of a whole layer only: one factorisation
  ///                   then serves pressing and friction
  /// @throws InputError where the shape folds an element, ConvergenceError from the factorisation
  LayerModel(const LayerDiscretisation& discretisation, std::vector<ElasticConstants> sublayers,
             std::shared_ptr<const LayerShape> shape = nullptr, MirrorPlanes planes = both_planes,
             const Rubs& rubs = none_rubs);
  /// A homogeneous one with E = 1.
  LayerModel(const LayerDiscretisation& discretisation, double poisson_ratio,
             std::shared_ptr<const LayerShape> shape = nullptr, MirrorPlanes planes = both_planes);
  /// The whole layer, from a coarse mesh from outside: its cells near the contact are halved
  /// until `elements_per_semi_axis` of them lie along b.
  /// @param sublayers  of the mesh's regions
  LayerModel(const LayerDiscretisation& discretisation, std::vector<ElasticConstants> sublayers,
             const meshes::LayerMesh& mesh, double thickness_m, const Rubs& rubs = none_rubs);
  /// Makes a layer as the first constructor does, or tells why a scan has none at the contact.
  static Outcome<std::shared_ptr<const LayerModel>, FoldedLayer> made(
      const LayerDiscretisation& discretisation, std::vector<ElasticConstants> sublayers,
      std::shared_ptr<const LayerShape> shape, MirrorPlanes planes, const Rubs& rubs = none_rubs);
  /// Two flat layers that face each other, each meshed for the same contact in units of its own
  /// thickness, so that their surface nodes lie at the same places. Displacements are relative ones
  /// of the two surfaces. Forces that press or rub do so on both, in opposite directions: normal
  /// displacements by normal forces, and tangential by tangential ones, add up; what couples the
  /// two (K. L. Johnson, Contact Mechanics, 1985, section 5.1) is the difference, nothing for
  /// layers that are alike. Fields for output are those of the first layer.
  static std::shared_ptr<const LayerModel> facing(const LayerDiscretisation& discretisation,
                                                  std::vector<ElasticConstants> sublayers,
                                                  const OppositeLayer& opposite);
  ~LayerModel();
  LayerModel(const LayerModel&) = delete;
  LayerModel& operator=(const LayerModel&) = delete;

  const LayerDiscretisation& discretisation() const;
  const std::vector<SurfaceNode>& nodes() const;
  const std::vector<SurfaceFace>& faces() const;
  long unknowns() const;
  MirrorPlanes planes() const;

  /// Displacement into the layer along the surface's normal per unit force along it, n x n, for
  /// fields that are even about the mirror planes.
  const Eigen::MatrixXd& compliance() const;

  /// Displacement per unit force on what is meshed, fields of the given parity, for some of the
  /// nodes: 3 x 3 blocks in the order x, y, z, where z points into the layer. On a curved layer
  /// they are along each node's normal and the tangents that the smallest rotation makes of x and
  /// y. Rows and columns of components that the parity fixes on the mirror planes are zero. Each
  /// call factorises, unless the model is condensed to all displacements of the nodes.
  Eigen::MatrixXd vector_compliance(Parity parity, const std::vector<int>& nodes) const;
  /// The compliances for several parities.
  std::vector<Eigen::MatrixXd> vector_compliances(const std::vector<Parity>& parities,
                                                  const std::vector<int>& nodes) const;

  /// Calls `use` with the fields of these forces, for output. The mesh is in metres until it
  /// returns.
  /// @param force  per surface node, in units of E h²
  void with_solution(const Eigen::VectorXd& force, double thickness_m, double youngs_modulus_Pa,
                     const std::function<void(const LayerSolution&)>& use) const;

 private:
  struct Implementation;
  explicit LayerModel(std::unique_ptr<Implementation> implementation);
  void add_opposite(const OppositeLayer& opposite);
  /// Compliances of the opposite layer at these nodes, in this layer's units, added to its own.
  void add_opposite_to(std::vector<Eigen::MatrixXd>& compliances,
                       const std::vector<Parity>& parities, const std::vector<int>& nodes) const;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger::fem
