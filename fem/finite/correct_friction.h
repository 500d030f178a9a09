#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>

#include "fem/finite/finite_pressing.h"
#include "fem/finite/rubbed_pressing.h"
#include "fem/friction/friction_bound.h"
#include "fem/levels/friction_levels.h"
#include "fem/output/surface_series.h"

namespace softfinger::fem::finite {

/// A contact of a whole layer in its equilibrium, on which friction is solved.
struct FrictionMesh {
  FinitePressing* pressed;  ///< never null
  FrictionBound bound;
  /// The mesh's `superposed_stiffness`; empty: it is found.
  Eigen::MatrixXd tangent = {};
};

/// Finds what superposed motions neglect of friction, by solving its states on the deformed layer.
struct FrictionCorrecting {
  FrictionMesh mesh;
  /// Mesh with fewer elements per semi-axis, where there is one. It shows how much the neglected
  /// part of the twist depends on the mesh. The neglected part of the limit surface, a small part
  /// of a wrench, is computed on the mesh with fewer unknowns.
  std::optional<FrictionMesh> coarser = std::nullopt;
  double refinement = 1;   ///< cells of `mesh` over those of `coarser`, along a semi-axis
  bool has_room = false;   ///< whether a larger patch can be meshed
  bool with_turn = false;  ///< a twist to full slip is asked for
  double force = 0;        ///< largest one, which wrenches are relative to
  /// Twist and paths start from the contact as it was pressed with friction, which this drag leads
  /// to; null: from the contact without. Full slip forgets where it started.
  const Drag* drag = nullptr;
  std::function<void(const std::string&)> progress = nullptr;
  /// Called with the turn, in radians, of each solved state of the twist.
  std::function<void(double turn_rad, const RubbedSurface&)> on_solved = nullptr;
};

/// @param superposed  by superposed motions on `mesh`, or on the quarter of it
/// @throws EdgeLeftMargin with room
FrictionCorrection correct_friction(const FrictionCorrecting& correcting,
                                    const FrictionOfLevel& superposed);

}  // namespace softfinger::fem::finite
