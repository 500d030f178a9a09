#pragma once

#include <string>
#include <vector>

#include "fem/friction_study.h"
#include "fem/reference_solver.h"

namespace softfinger::fem {

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

  /// The PVD file of what has been written. @returns its path, empty without states
  std::string finish();

 private:
  void write(const FrictionalContact& contact, const FrictionState& state);

  const Problem& problem_;
  std::vector<double> angles_rad_;
};

}  // namespace softfinger::fem
