#pragma once

#include <cstddef>
#include <filesystem>

#include "comparisons/simulation/recording.h"

/// A recording for ParaView.
namespace softfinger::simulation {

/// motion.pvd and, in the folder `frames` beside it, three files per frame written:
///   bodies_*.vtu    triangles of the movable bodies with their body's index, and the velocity at
///                   each vertex: in single precision, as trajectory.csv has the exact poses
///   contacts_*.vtu  a point per contact with its forces as vectors and what is said of it, exact
///   ellipses_*.vtu  contact ellipses as polygons; none for a point contact
/// and fixed.vtu once, with the bodies that are fixed to the world.
///
/// Arrays are appended as raw bytes. Those that all frames share are compressed, once. Coordinates
/// are not: their digits hardly repeat, so that compressing them costs more time than the
/// simulation and saves a few per cent.
/// @param every_nth  writes each n-th frame, and the last one
/// @throws InputError when a file cannot be written, std::invalid_argument for every_nth < 1.
void write_vtu(const Recording& recording, const std::filesystem::path& folder, int every_nth = 1);

/// The `every_nth` for about 150 frames; for fewer where the triangles of these would fill more
/// than `most_bytes`.
int usual_vtu_interval(const Recording& recording, std::size_t most_bytes = std::size_t(64) << 20);

}  // namespace softfinger::simulation
