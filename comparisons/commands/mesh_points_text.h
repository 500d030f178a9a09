#pragma once

#include <Eigen/Core>
#include <string>

#include "comparisons/report/mesh_page.h"

/// What the commands `mesh` and `fit` share: vectors from the command line, points of a surface and
/// the lines of a case for them.
namespace softfinger::commands {

/// "X,Y,Z". @throws InputError(flag)
Eigen::Vector3d parse_vector(const std::string& flag, const std::string& text,
                             const std::string& allowed);

/// A text as a value of TOML, in quotes.
std::string toml_text(const std::string& text);

/// The line of [geometry]: "finger = { mesh = .., point_mm = .., normal = .. }".
std::string geometry_line(const std::string& mesh, const std::string& unit,
                          const report::MeshPoint& point);

/// "5,374 triangles, closed, 16.2 x 12.1 x 28.0 mm"
std::string facts_in_words(const TriangleSurface& surface);

}  // namespace softfinger::commands
