#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "fem/pad/pad_model.h"

namespace softfinger::fem {

/// Rigid motions of the face that a pad's forces are known for, each of size 1. The normal n points
/// into the pad.
enum FaceMotion : int {
  approach,  ///< n = 1
  tilt_x,    ///< n = x: deeper at larger x, a turn about y
  tilt_y,    ///< n = y, a turn about x
  shear_x,   ///< u_x = 1
  shear_y,   ///< u_y = 1
  twist,     ///< u = (-y, x)
  face_motions
};

/// Forces that rigid motions of the touched face take, over the whole of it, E = h = 1.
class FaceResponse {
 public:
  explicit FaceResponse(PadModel& model);

  Eigen::Index size() const { return place_.cols(); }
  const Eigen::Matrix2Xd& place() const { return place_; }
  /// Integral of each node's shape function, > 0; they add up to the touched area.
  const Eigen::VectorXd& weight() const { return weight_; }
  double area() const { return weight_.sum(); }

  /// Normal forces of the stuck face (all displacements given), nodes by `FaceMotion`.
  const Eigen::MatrixXd& stuck() const { return stuck_; }
  /// Resultants of the stuck face: work of a motion against the forces of another one.
  const Eigen::Matrix<double, face_motions, face_motions>& stuck_resultants() const {
    return stuck_resultants_;
  }
  /// Normal forces of the frictionless face (normal displacements given), nodes by the first three
  /// motions.
  const Eigen::MatrixXd& frictionless() const { return frictionless_; }
  const Eigen::Matrix3d& frictionless_resultants() const { return frictionless_resultants_; }

  /// Normal force per normal displacement of the frictionless face, all nodes by all.
  Eigen::MatrixXd frictionless_stiffness() const;

  /// The pressure that has given nodal forces: in the space of the elements, per node.
  Eigen::VectorXd pressure_of(const Eigen::VectorXd& force) const { return mass_->solve(force); }
  /// Integral of a function of place and pressure over the touched face.
  double integral(const Eigen::VectorXd& pressure,
                  const std::function<double(const Eigen::Vector2d&, double)>& of) const;

 private:
  /// A node of the whole face as an image of a node of what is meshed.
  struct ImageNode {
    int node = 0;
    bool mirror_x = false, mirror_y = false;
    int images = 1;  ///< that coincide with it
  };
  struct NormalStiffness {
    Parity parity;
    std::vector<int> row_of_node;  ///< -1: a mirror plane holds it
    Eigen::MatrixXd stiffness;
  };

  void number_images(const PadModel& model);
  void add_parity(const FaceStiffness& face, const PadModel& model);
  void find_mass();

  int meshed_images_ = 1;  ///< that make the whole face
  std::vector<ImageNode> image_;
  Eigen::Matrix2Xd place_;
  Eigen::VectorXd weight_;
  std::vector<std::array<int, 9>> faces_;
  Eigen::MatrixXd stuck_, frictionless_;
  Eigen::Matrix<double, face_motions, face_motions> stuck_resultants_;
  Eigen::Matrix3d frictionless_resultants_;
  std::vector<NormalStiffness> normal_;
  std::unique_ptr<Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>> mass_;
};

}  // namespace softfinger::fem
