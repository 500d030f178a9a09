#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "fem/layer/layer_model.h"
#include "fem/pad/pad_mesh.h"

namespace softfinger::fem {

/// Forces on the nodes of a pad's face per displacement of one of them, all others of them held.
struct FaceStiffness {
  Parity parity;
  std::vector<int> node;       ///< of each row
  std::vector<int> component;  ///< of each row: 0 along x, 1 along y, 2 into the pad
  Eigen::MatrixXd stiffness;
};

/// The elements of a flat pad whose bottom is bonded and whose sides are free, E = h = 1. They are
/// those of the layer (element_stiffness.h): nothing locks as nu -> 1/2.
class PadModel {
 public:
  /// @throws InputError for cells of no or negative volume
  PadModel(const PlacedMesh& mesh, MirrorPlanes planes, double poisson_ratio);
  ~PadModel();
  PadModel(const PadModel&) = delete;
  PadModel& operator=(const PadModel&) = delete;

  /// Nodes of the face that can be touched: of one side of each mirror plane.
  const std::vector<SurfaceNode>& nodes() const;
  const std::vector<SurfaceFace>& faces() const;
  MirrorPlanes planes() const;
  long unknowns() const;

  /// Factorises the problem of fields of a parity, which serves every motion of the face, stuck and
  /// frictionless.
  /// @throws NotEnoughMemory, ConvergenceError
  FaceStiffness face_stiffness(Parity parity);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger::fem
