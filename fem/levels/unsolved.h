#pragma once

#include <Eigen/Core>
#include <array>
#include <variant>

#include "fem/levels/contact_physics.h"

namespace softfinger::fem {

/// The pressure's centre lies beside where coordinates begin, about which friction turns: the
/// contact has to be solved again in coordinates that begin there.
struct OffCentre {
  Eigen::Vector2d centre;        ///< of the pressure, in h
  std::array<double, 2> size_m;  ///< semi-axes of the contact
};

/// The meshes that the physics shares with an earlier contact are too small or too coarse for this
/// one.
struct MeshesDoNotServe {};

/// Why a contact has no answer yet.
using Unsolved = std::variant<OffCentre, FoldedLayer, MeshesDoNotServe>;

/// A folded layer may be pressed on another core. A load that is not reached is an error.
/// @throws ConvergenceError
Unsolved unsolved_by(const Obstacle& obstacle);

}  // namespace softfinger::fem
