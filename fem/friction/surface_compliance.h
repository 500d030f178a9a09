#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fem/layer/layer_model.h"

namespace softfinger::fem {

/// Symmetry of a state of contact, friction included. With a symmetry fewer points are solved for.
enum class Invariance {
  none,       ///< all of the contact is solved for: any tangential force and torque
  half_turn,  ///< rotation by pi about the normal: load and twist; half of the contact
  mirrors     ///< the mirror planes of what is meshed: the load alone; just what is meshed
};

/// Compliances among some nodes of what is meshed, a quarter of the layer or more, by parity.
struct QuarterCompliances {
  const LayerModel& model;
  std::vector<int> nodes;  ///< of the model, ascending
  /// The compliances of all parities. A quarter has: even, odd in x and y; then, unless only a half
  /// turn is needed, odd in x, odd in y. Of a half: even and odd about its plane. Of a whole layer
  /// there is one, of all fields.
  std::vector<Eigen::MatrixXd> by_parity;

  /// The compliance of a turn about the normal, which is odd about each plane.
  const Eigen::MatrixXd& of_turn() const { return by_parity[model.planes().any() ? 1 : 0]; }
};

/// The part of kept compliances that belongs to some of the nodes, with the parities that `fewest`
/// needs; none where `kept` lacks nodes or parities.
std::optional<QuarterCompliances> part_of(const QuarterCompliances& kept,
                                          const std::vector<int>& nodes, Invariance fewest);

/// @param nodes  those that may come into contact, ascending
/// Factorises one problem for each image; of a quarter two if only a half turn's are needed.
QuarterCompliances quarter_compliances(const LayerModel& model, std::vector<int> nodes,
                                       Invariance fewest);

/// Selects the blocks to compose: the tangential one is the largest.
enum class Blocks { all, without_tangential };

/// The surface's compliance among the points of a whole contact, composed of the problems of what
/// is meshed.
///
/// On a curved layer the contact lies in the object's plane, square to the load, as the pressed
/// layer does: a point's normal force is the component along the load, its displacement what its
/// surface sinks by along the load; its tangential forces and displacements are those along its own
/// tangents, turned into that plane by the smallest rotation. So mu P bounds the force of friction,
/// and the torque at full slip is that of the pressure.
///
/// A half turn maps the centre to itself, and a mirror plane its own points. Forces and areas of
/// such points are then the half, or less, of what the contact has there: the compliance stays
/// symmetric, and sums over points times `copies` need no special case.
struct SurfaceCompliance {
  Eigen::Matrix2Xd position;          ///< of each point, in h, seen along the load
  Eigen::VectorXd height;             ///< of each point along the load, in h
  Eigen::Matrix2Xd in_block;          ///< its place on the lattice of the flat block
  Eigen::VectorXd area;               ///< its share of the surface, in h²
  Eigen::MatrixXd normal;             ///< n x n, into the layer
  Eigen::MatrixXd tangential;         ///< 2n x 2n, blocks in the order x, y; empty if left out
  Eigen::MatrixXd normal_tangential;  ///< n x 2n: displacement into the layer by tangential force
  std::vector<int> model_node;        ///< for each point
  Eigen::Matrix2Xd mirrored;          ///< signs of a point's x and y against those of its node
  Eigen::VectorXd images;             ///< of a node's force, which a point's force is made of
  int copies = 1;                     ///< sums over points times this are sums over the contact

  Eigen::Index size() const { return position.cols(); }
};

/// @param invariance  none unless a quarter is meshed
/// @throws NotEnoughMemory
SurfaceCompliance surface_compliance(const QuarterCompliances& quarters, Invariance invariance,
                                     Blocks blocks = Blocks::all);

}  // namespace softfinger::fem
