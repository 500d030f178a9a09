#pragma once

#include <optional>
#include <vector>

#include "fem/levels/contact_physics.h"

namespace softfinger::fem {

/// The answers of two levels.
struct SolvedLevels {
  std::vector<LevelResult> results;         ///< coarse to fine
  std::vector<FrictionOfLevel> friction;    ///< of each; empty without friction
  std::optional<LevelResult> frictionless;  ///< of the fine one, where friction pressed it
  WallChange wall;
  double misfit = 0;         ///< largest of both levels: how far contact and mesh differ in size
  bool interrupted = false;  ///< the coarse one is the trial mesh

  const LevelResult& coarse() const { return results.front(); }
  const LevelResult& fine() const { return results.back(); }
};

/// Errors of a scan's contact, from perturbed scans.
struct ScanErrors {
  RelativeError core;                     ///< by a core with a ridge
  std::optional<RelativeError> geometry;  ///< by facets and noise
};

/// Whether meshes of a larger contact, where the levels are on such, tell enough of this one.
bool meshes_serve(const SolvedLevels& levels, const ErrorTable& table, const ContactTask& task);

/// The result with its stated errors, from levels that are corrected for the wall.
/// @param physics  of the finer level
/// @throws InputError where its files cannot be written
Result stated_result(SolvedLevels levels, const ScanErrors& scan, ContactPhysics& physics,
                     const ContactTask& task);

}  // namespace softfinger::fem
