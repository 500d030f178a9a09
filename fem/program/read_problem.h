#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "fem/problem/problem.h"
#include "softfinger/input/triangle_surface.h"

namespace softfinger::fem {

/// Readers of the files that a problem names. The caller gives them, so that problems can be
/// checked by a program without gmsh.
struct MeshReaders {
  std::function<TriangleSurface(const std::string& path, double metres_per_unit)> surface;
  std::function<std::shared_ptr<const meshes::LayerMesh>(
      const std::string& path, double metres_per_unit, const std::vector<std::string>& regions)>
      layer;
};

/// The text of one problem, or of an array of them.
/// @param where  the file's name, for messages
/// @throws InputError with line and column where the text is no JSON, and for brackets nested
/// deeper than any problem's.
nlohmann::json parse_problems(const std::string& text, const std::string& where);

/// One problem with the keys of README.md, every value checked: its type, that it is finite, its
/// range. What no single value shows (R' >= R'', sublayers as thick as the layer) is left to the
/// solver. Keys that are not known are skipped.
/// @throws InputError naming the key ("layer.sublayers[1].thickness_m"), and what the readers throw
Problem read_problem(const nlohmann::json& input, const MeshReaders& readers);

}  // namespace softfinger::fem
