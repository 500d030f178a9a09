#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/mirror_planes.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
struct LayerMesh;
}

namespace softfinger::fem {

/// How a layer is meshed for a contact of semi-axes a along x and b along y, of which a is the
/// longer one unless the layer is a scan's. Lengths in units of the thickness h.
struct LayerDiscretisation {
  double a = 1, b = 1;
  int elements_per_semi_axis = 8;  ///< n: finest cells along the shorter one
  double patch = 1.25;             ///< contact is possible within this multiple of the ellipse
  double extent = 6;               ///< side wall at a + extent, b + extent: see README.md
  bool is_scan = false;            ///< the shape ends where it must, not at the block's sides
  bool clamped_wall = false;       ///< the side wall is bonded too, else it is free
  /// Depths of the interfaces between bonded sublayers, from the surface on: no cell crosses one.
  std::vector<double> interfaces;

  /// Share of the reach below that the refined patch may take: a last cell has to fit beside it.
  static constexpr double usable_reach = 0.98;
  /// How far the block may go along x and y: the surface may end. Infinite for a flat layer.
  double reach_x = std::numeric_limits<double>::infinity();
  double reach_y = std::numeric_limits<double>::infinity();

  /// Finest cells along a and b: n, more where cells would be longer than three times their width.
  int elements_along_a() const;
  int elements_along_b() const;

  /// Of the surface along x and y, for the patch and a cell beside it.
  Eigen::Vector2d needed_reach() const;
  bool is_within_reach() const;
};

/// The layer bent onto a finger: the image of a flat block in the contact's frame. Lengths in h.
class LayerShape {
 public:
  virtual ~LayerShape() = default;
  /// For another thread: what the copy covers changes nothing here. Null where threads may share
  /// this one.
  virtual std::shared_ptr<const LayerShape> copy() const { return nullptr; }
  /// Position in space of the block's point (x, y, z), -1 <= z <= 0; z = 0 is the surface, z = -1
  /// the rigid core.
  virtual Eigen::Vector3d position(double x, double y, double z) const = 0;
  /// Outward unit normal of the surface.
  virtual Eigen::Vector3d normal(double x, double y) const = 0;
  /// Surface area per area of the block.
  virtual double area_ratio(double x, double y) const = 0;
  /// Of the shape alone: x where position(-x, y) is the mirror image of position(x, y), and y
  /// likewise.
  virtual MirrorPlanes planes() const = 0;

  /// Makes sure that the shape is known up to this distance from the contact, where the surface
  /// goes that far.
  virtual void cover(double /*radius*/) const {}
  /// What there is of the layer under a rectangle of the block.
  enum class Cover {
    whole,
    cut,  ///< the shape cannot go on, though the finger does
    rim,  ///< the finger ends
    /// The finger ends in it, at a sharp edge or a little beside it; the shape goes on.
    edge,
  };
  virtual Cover covers(double /*low_x*/, double /*high_x*/, double /*low_y*/,
                       double /*high_y*/) const {
    return Cover::whole;
  }
  /// Whether the finger has sharp edges nearby: beyond them it ends.
  virtual bool has_edges() const { return false; }
  /// How far a point of the surface lies beyond a sharp edge, negative on this side of it. The
  /// shape goes on a little beyond, so that cells can be fitted to the edge.
  virtual double beyond_edge(double /*x*/, double /*y*/) const {
    return -std::numeric_limits<double>::infinity();
  }
};

inline bool ends_finger(LayerShape::Cover cover) {
  return cover == LayerShape::Cover::rim || cover == LayerShape::Cover::edge;
}

/// A contact lies or reaches where a scan's layer would fold, though the finger goes on.
class FoldedLayer : public InputError {
 public:
  /// @param fits  share of the load or approach with which it does not; none where not known
  explicit FoldedLayer(const InputError& error, std::optional<double> fits = std::nullopt)
      : InputError(error), fits_(fits) {}
  const std::optional<double>& fits() const { return fits_; }

 private:
  std::optional<double> fits_;
};

/// A node where the surface can be touched.
struct SurfaceNode {
  double x = 0, y = 0;  ///< in the block: arc lengths from the contact point on a bent layer
  double weight = 0;    ///< integral of its shape function over the block's surface, > 0
  double area_ratio = 1;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in space
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< outward
  bool at_end = false;   ///< of the surface that can be touched, beside what is not meshed
  bool on_edge = false;  ///< on the finger's sharp edge, at which its layer ends
};

/// Of a node, seen along the load.
inline double seen_area(const SurfaceNode& node) {
  return node.weight * node.area_ratio * node.normal.z();
}

/// A finest face of the surface, an axis-parallel rectangle, with the nodes of its biquadratic
/// shape functions (index x + 3 y; -1 where the node cannot be touched). On a mesh from outside it
/// is the unit square of its own coordinates, wherever it lies.
struct SurfaceFace {
  double x = 0, y = 0, size_x = 0, size_y = 0;
  std::array<int, 9> node;
};

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

/// Which displacements of the surface nodes a layer is condensed to.
enum class Along {
  normals,  ///< one per node, into the layer
  all,      ///< three per node: along its tangents, and into the layer
};

/// Whether friction may act on a node: it is condensed to all of its displacements, others to that
/// into the layer.
using Rubs = std::function<bool(const SurfaceNode&)>;
inline bool none_rubs(const SurfaceNode&) { return false; }
inline bool all_rub(const SurfaceNode&) { return true; }

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
  /// @param rubs       of a whole layer only: one factorisation then serves pressing and friction
  ///                   on these nodes
  /// @throws InputError where the shape folds an element, FoldedLayer where a scan's do all,
  ///         ConvergenceError from the factorisation
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
  /// nodes: 3 x 3 blocks in the order x, y, z, where z points into the layer. On a bent layer they
  /// are along each node's normal and the tangents that the smallest rotation makes of x and y.
  /// Rows and columns of components that the parity fixes on the mirror planes are zero. Each call
  /// factorises, unless the model is condensed to all displacements of the nodes.
  Eigen::MatrixXd vector_compliance(Parity parity, const std::vector<int>& nodes) const;
  /// The same for several parities.
  std::vector<Eigen::MatrixXd> vector_compliances(const std::vector<Parity>& parities,
                                                  const std::vector<int>& nodes) const;

  /// Displacement, stress and contact pressure of what is meshed in SI units, atomically.
  /// @param force  per surface node, in units of E h²
  /// @throws InputError when the file cannot be written
  void write_vtu(const std::string& path, const Eigen::VectorXd& force, double thickness_m,
                 double youngs_modulus_Pa) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger::fem
