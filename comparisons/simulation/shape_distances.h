#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <utility>
#include <vector>

#include "comparisons/input/shape.h"

namespace softfinger::simulation {

/// Which shapes are near each other, and how near, by the library FCL. Its types stay in the .cc
/// file, for its headers are slow to compile. Half-spaces take part in nothing here: they are
/// infinite, and a support point says how far away they are.
class ShapeDistances {
 public:
  explicit ShapeDistances(const std::vector<const input::ShapeKind*>& shapes);
  ~ShapeDistances();

  /// Pairs of shapes, lower index first, whose boxes along the world's axes are nearer than this.
  /// @param poses  of all shapes, in the world
  std::vector<std::pair<int, int>> near_pairs(const std::vector<Eigen::Isometry3d>& poses,
                                              double distance_m);

  struct Nearest {
    double distance_m = 0;  ///< not positive: the shapes overlap, and the points mean nothing
    Eigen::Vector3d on_a = Eigen::Vector3d::Zero(), on_b = Eigen::Vector3d::Zero();  ///< world
    bool has_points = true;  ///< false: those that FCL gives do not belong to the distance
  };
  /// Nearest points of two shapes at poses of their own, to `tolerance_m`. Of faces that are
  /// parallel to rounding, any two across the gap: FCL 0.7 may even give two that lie beside the
  /// smaller face (a box of 40 mm above a table: 7 of 2,000,000 poses, by up to 0.7 mm).
  Nearest nearest(int a, const Eigen::Isometry3d& pose_a, int b, const Eigen::Isometry3d& pose_b,
                  double tolerance_m) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger::simulation
