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

/// Solves a contact, whatever its physics, on two meshes that tell its error:
///   1. trial meshes, each pressed and made anew, until mesh and contact agree in size;
///   2. two levels, the elements per semi-axis doubled between them, each discretised, pressed,
///      measured and rubbed, with the contact's edge on cell edges;
///   3. the stated error from their difference (error_model.h).
///
/// When it is stopped after its first level, the last trial mesh takes the coarse level's place.
/// Times and memory of the result are left to the caller.
/// @throws InputError, ConvergenceError, Interrupted
Outcome<Result, Unsolved> solve_on_levels(ContactPhysics& physics, const ContactTask& task);

}  // namespace softfinger::fem
