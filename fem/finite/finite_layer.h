#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fem/finite/element.h"
#include "fem/finite/tangent_contact.h"
#include "fem/layer/layer_model.h"

namespace softfinger::fem::finite {

/// A plane in which an object touches a surface node: what its displacements are turned into.
struct NodeFrame {
  /// Columns: tangents and, last, the outward normal of the finger's surface.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  /// Contact force per height of the object times the object's curvature: a node that moves along a
  /// curved object turns the force on it.
  Eigen::Matrix2d curvature_force = Eigen::Matrix2d::Zero();
};

/// A hyperelastic layer bonded to a rigid core at finite strain, on the mesh that `LayerModel`
/// would have, with its present state. Lengths in h, stresses in E.
class FiniteLayer {
 public:
  /// @param shape  null: flat
  /// @param planes  of layer, object and load, as of `LayerModel`
  /// @param materials  of the sublayers, from the surface inwards
  FiniteLayer(const LayerDiscretisation& discretisation, std::shared_ptr<const LayerShape> shape,
              MirrorPlanes planes, std::vector<std::shared_ptr<const Material>> materials);
  /// A homogeneous one.
  FiniteLayer(const LayerDiscretisation& discretisation, std::shared_ptr<const LayerShape> shape,
              MirrorPlanes planes, std::shared_ptr<const Material> material)
      : FiniteLayer(discretisation, std::move(shape), planes,
                    std::vector<std::shared_ptr<const Material>>{std::move(material)}) {}
  /// The whole layer, from a coarse mesh from outside, refined as by `LayerModel`.
  FiniteLayer(const LayerDiscretisation& discretisation, const meshes::LayerMesh& mesh,
              double thickness_m, std::vector<std::shared_ptr<const Material>> materials);
  /// Makes a layer as the first constructor does, or tells why a scan has none at the contact.
  static Outcome<std::shared_ptr<FiniteLayer>, FoldedLayer> made(
      const LayerDiscretisation& discretisation, std::shared_ptr<const LayerShape> shape,
      MirrorPlanes planes, std::vector<std::shared_ptr<const Material>> materials);
  ~FiniteLayer();
  FiniteLayer(const FiniteLayer&) = delete;
  FiniteLayer& operator=(const FiniteLayer&) = delete;

  const LayerDiscretisation& discretisation() const;
  const std::vector<SurfaceNode>& nodes() const;
  const std::vector<SurfaceFace>& faces() const;
  long unknowns() const;
  MirrorPlanes planes() const;
  /// Whether the faces are a grid of rectangles in the block, and no mesh from outside.
  bool has_grid() const;
  std::size_t sublayers() const;

  /// Present position of a surface node.
  Eigen::Vector3d position(std::size_t node) const;

  /// Positions of the nine nodes of a face, also of nodes that cannot be touched.
  std::array<Eigen::Vector3d, 9> face_positions(std::size_t face) const;

  /// The nodes that tell a field at one of a face's nine places, with their shares: one, or several
  /// where a node hangs.
  std::vector<std::pair<int, double>> node_shares(std::size_t face, std::size_t place) const;

  double strain_energy() const;

  /// Volume ratio and principal stretches over all quadrature points, present state.
  double smallest_volume_ratio() const;

  /// Linearises about the present state and factorises.
  /// @param frames  one for each surface node
  /// @param force   contact force on each, into the layer along its frame's normal
  /// @returns the largest nodal force out of balance
  double linearise(const std::vector<NodeFrame>& frames, const Eigen::VectorXd& force);

  /// Linearises with friction.
  /// @param force  per node: along the tangents of its frame and into the layer
  double linearise(const std::vector<NodeFrame>& frames, const Eigen::Matrix3Xd& force,
                   Along along);

  /// The residual of the present state, with the tangent of the last linearisation: what a
  /// modified Newton's method goes on with.
  /// @param force  as of `linearise`; the tangents' curvature keeps the one of then
  /// @returns the largest nodal force out of balance, at the pressure that Newton's step leads to
  double update_residual(const std::vector<NodeFrame>& frames, const Eigen::VectorXd& force);
  double update_residual(const std::vector<NodeFrame>& frames, const Eigen::Matrix3Xd& force);

  /// Call after `linearise`. The share of its own diagonal that was added to the tangent to make it
  /// positive definite; 0 where it was so by itself, with the surface nodes held.
  double shift() const;

  /// Call after `linearise`. The response of the displacements that it was condensed to: of each
  /// surface node along its normal, or three along the axes of its frame. Those that a mirror plane
  /// fixes have zero rows.
  SurfaceResponse surface_response() const;
  /// The response's stiffness with its memory: the response cannot be asked for again.
  Eigen::MatrixXd take_surface_stiffness();
  /// The force of that response alone.
  Eigen::VectorXd surface_force() const;

  /// Call after `linearise`. Computes the step to the equilibrium with these contact forces and
  /// displacements of the surface nodes, which go together by `surface_response`.
  /// @returns its largest nodal displacement
  double find_step(const Eigen::VectorXd& force, const Eigen::VectorXd& displacement);

  /// Goes to the start of the step plus this fraction of it. May be called again.
  /// @returns smallest volume ratio; where that is not positive, `linearise` must not be called
  double take_step(double fraction);

  /// The resistance of some surface nodes to small motions superposed on the present state: their
  /// forces per displacement with all else free, in 3 x 3 blocks along the axes of their frames.
  /// The tangent is the deformed state's own, geometric stiffness and the frames' `curvature_force`
  /// included. Rows and columns of components that the parity fixes are zero; a whole layer takes
  /// every motion. Factorises, which ends what `linearise` made.
  /// @param frames  one for each surface node
  /// @param nodes   that an object holds along their normals
  /// @throws ConvergenceError where the state so held is not stable against these motions
  Eigen::MatrixXd superposed_stiffness(const std::vector<NodeFrame>& frames,
                                       const Eigen::VectorXd& force, Parity parity,
                                       const std::vector<int>& nodes);

  /// displacement_m, contact_pressure_Pa and, per element, the volume ratio, on the undeformed
  /// mesh, atomically: warped by the displacement it is the deformed layer.
  /// @param pressure  Cauchy pressure of each surface node, in units of E
  /// @throws InputError when the file cannot be written
  void write_vtu(const std::string& path, const Eigen::VectorXd& pressure, double thickness_m,
                 double youngs_modulus_Pa) const;

  /// Takes over the state of the same layer on another mesh, interpolated: where Newton's method
  /// can go on from. It may have mirror planes that this one has not. What the other mesh does not
  /// cover stays as it was.
  void continue_from(const FiniteLayer& other);

  /// Gives the memory of the tangent and its factorisation back.
  void release_factor();

  /// The state, to come back to.
  struct State;
  std::shared_ptr<const State> state() const;
  void restore(const State& state);
  /// Sum of states times weights, which sum to 1.
  void restore(const std::vector<std::shared_ptr<const State>>& states,
               const Eigen::VectorXd& weights);
  /// The displacements of all nodes, every component.
  Eigen::VectorXd displacements() const;

 private:
  struct Implementation;
  explicit FiniteLayer(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger::fem::finite
