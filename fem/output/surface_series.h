#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "fem/friction/friction_study.h"
#include "fem/problem/problem.h"

namespace softfinger::fem {

/// The contact surface under friction, in the units of its model.
struct RubbedSurface {
  enum State { apart = 0, sticks = 1, slips = 2 };
  struct Point {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double pressure = 0;
    Eigen::Vector3d shear = Eigen::Vector3d::Zero();  ///< on the layer, per area
    Eigen::Vector3d slip = Eigen::Vector3d::Zero();   ///< of the object against the layer
    State state = apart;
  };
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 4>> quadrilaterals;  ///< of points, in circular order
};

/// The contact surface through a twist, for ParaView: one VTU per increment with pressure, shear,
/// slip and state (1 sticks, 2 slips, 0 does not touch), and a PVD whose time is the angle. Each
/// file is written as its state comes.
class SurfaceSeries {
 public:
  /// Writes into the problem's output directory, or nothing when it has none.
  explicit SurfaceSeries(const Problem& problem) : problem_(problem) {}

  /// The function to call with each state of a level. It writes the states of the finest level
  /// only.
  OnState of(int level);

  /// Writes the next state. One that is not turned further than the last begins the twist anew.
  void add(double turn_rad, const RubbedSurface& surface);

  /// The PVD file of what has been written. @returns its path, empty without states
  std::string finish();

 private:
  const Problem& problem_;
  std::vector<double> angles_rad_;
};

}  // namespace softfinger::fem
