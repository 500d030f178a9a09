#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fem/contact/rigid_object.h"
#include "fem/finite/finite_layer.h"

/// Frictionless pressing at finite strain, in units of h and E: the surface's nodes against the
/// object's exact surface where they are, by Newton's method on all of it.
///
/// Each iteration is one linear contact problem: tangent, residual and gap are those of the present
/// state, along the object's normal over each node, and the active set of `normal_contact` solves
/// it exactly, the load included. At the end the touching nodes lie on the object to round-off: no
/// penalty.
namespace softfinger::fem::finite {

/// Load or approach by which the layer is pressed; the other one is zero.
struct Drive {
  double load = 0;      ///< P / (E h²)
  double approach = 0;  ///< d / h
};

/// An equilibrium.
struct Equilibrium {
  Eigen::VectorXd force;         ///< of each surface node, its component along the load
  Eigen::VectorXd normal_force;  ///< along the object's normal: its magnitude
  /// Friction on the layer while it is pressed, seen along the load; empty: none.
  Eigen::Matrix2Xd friction;
  double approach = 0;
  double load = 0;    ///< of the whole contact
  double energy = 0;  ///< strain energy of the whole layer
  int active = 0;
  double steepest_rad = 0;    ///< slope of the object where it is touched
  bool reaches_rim = false;   ///< of the region where contact is possible
  double out_of_balance = 0;  ///< largest nodal force out of balance over the largest contact force
  double complementarity_residual = 0;  ///< worst penetration over the approach
  double moment_a = 0, moment_b = 0;    ///< semi-axes from second moments, in the block: rough
};

/// The nodes that touch, as they are: what friction acts on.
struct TouchingNodes {
  std::vector<int> node;                ///< of the layer, ascending
  Eigen::Matrix3Xd position;            ///< present
  std::vector<Eigen::Matrix3d> axes;    ///< of their frames: tangents and outward normal
  std::vector<ObjectHeight> object;     ///< over each
  Eigen::VectorXd force, normal_force;  ///< as in `Equilibrium`

  Eigen::Index size() const { return position.cols(); }
};

/// Whether a node is so near the end of the region where contact is possible that the contact may
/// go on beyond it.
bool reaches_rim(const LayerDiscretisation& mesh, const SurfaceNode& node);

/// Distance of the surface's nodes in the contact.
double node_spacing(const LayerDiscretisation& mesh);

/// The work that an equilibrium took.
struct PressingHistory {
  int steps = 0;       ///< of load, converged ones
  int cuts = 0;        ///< steps that were given up and tried again shorter
  int iterations = 0;  ///< of Newton's method
  int shifts = 0;      ///< tangents that were not positive definite
};

struct PressingOptions {
  double largest_step = 0.12;  ///< of the approach in one step, in h
  double tolerance = 1e-6;  ///< of Newton's step, relative to the approach: the next is its square
};

class FinitePressing {
 public:
  FinitePressing(std::shared_ptr<FiniteLayer> layer, std::shared_ptr<const RigidObject> object,
                 const PressingOptions& options = {});

  /// Goes from the present equilibrium to another one, by steps as large as converge.
  /// @throws ConvergenceError, with the last load that was reached; the equilibrium is then that
  void press(const Drive& drive);

  /// Starts from where another mesh of the same layer has been pressed to, in place of from the
  /// unloaded state.
  /// @pre not pressed
  void continue_from(const FinitePressing& other);

  /// Takes over an equilibrium with friction, in which the layer is.
  /// @param force  per node: along the tangents of its frame, and into the layer
  void take_over(const Eigen::Matrix3Xd& force, double approach, double out_of_balance);

  const Equilibrium& equilibrium() const { return equilibrium_; }
  const PressingHistory& history() const { return history_; }
  const FiniteLayer& layer() const { return *layer_; }

  /// Friction goes on from these: the layer, whose state it changes, and the object, whose height
  /// counts from `offset`.
  const std::shared_ptr<FiniteLayer>& shared_layer() const { return layer_; }
  const std::shared_ptr<const RigidObject>& object() const { return object_; }
  double offset() const { return offset_; }
  void release_factor() { layer_->release_factor(); }

  /// Normals of the object at the nodes' present positions: outward from the finger.
  Eigen::Vector3d normal(std::size_t node) const;

  /// Clearance of each surface node from the object, along the load.
  Eigen::VectorXd clearance() const;

  /// The nodes that touch in the present equilibrium.
  TouchingNodes touching_nodes() const;

  /// Stiffness of the touching nodes about the present equilibrium, see
  /// `FiniteLayer::superposed_stiffness`.
  Eigen::MatrixXd superposed_stiffness(Parity parity);

  /// Sums over the layer's nodes times this are sums over the contact.
  int copies() const { return layer_->planes().images(); }

 private:
  struct Touch;
  std::vector<Touch> touches() const;
  bool try_step(const Drive& drive, bool limited, Equilibrium& reached);
  std::vector<NodeFrame> frames(const std::vector<Touch>& touching,
                                const Eigen::VectorXd& force) const;
  void describe(Equilibrium& equilibrium) const;

  std::shared_ptr<FiniteLayer> layer_;
  std::shared_ptr<const RigidObject> object_;
  PressingOptions options_;
  double offset_ = 0;  ///< of the object's height: the approach counts from the first touch
  double step_;        ///< present largest one
  std::shared_ptr<const FiniteLayer::State> unloaded_;
  bool continues_ = false;  ///< and nothing is converged yet
  Equilibrium equilibrium_;
  PressingHistory history_;
  int failed_iteration_ = 0;
  double failed_residual_ = 0;
};

}  // namespace softfinger::fem::finite
