#include "meshes/io/read_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "meshes/io/surface_formats.h"
#include "meshes/io/welder.h"
#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

/// Whether the surface is closed with all normals inwards. It is closed if its triangles use every
/// edge once in each direction; the sign of the enclosed volume then tells where the normals point.
bool is_inside_out(const TriangleSurface& surface) {
  std::vector<std::array<int, 3>> edges;  // smaller vertex, larger vertex, direction
  double six_volumes = 0;
  const Vector3d& origin =
      surface.vertices_m.front();  // any point would do; a near one avoids rounding errors
  for (const auto& t : surface.triangles) {
    for (int i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b ? 0 : 1});
    }
    six_volumes +=
        (surface.vertices_m[t[0]] - origin)
            .dot((surface.vertices_m[t[1]] - origin).cross(surface.vertices_m[t[2]] - origin));
  }
  if (!(six_volumes < 0)) return false;
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 0; e < edges.size(); e += 2) {
    if (e + 1 >= edges.size() || edges[e][0] != edges[e + 1][0] || edges[e][1] != edges[e + 1][1] ||
        edges[e][2] == edges[e + 1][2])
      return false;
  }
  return true;
}

std::string across(double size_m) {
  std::ostringstream out;
  out.precision(3);
  out << size_m << " m across";
  return out.str();
}

}  // namespace

SurfaceFile read_surface(const std::string& path, double metres_per_unit) {
  return parse_surface(read_whole_file(path, "file", kAllowedSurface, kLargestSurface_bytes), path,
                       metres_per_unit);
}

SurfaceFile parse_surface(std::string bytes, const std::string& path, double metres_per_unit) {
  if (!(metres_per_unit > 0) || !std::isfinite(metres_per_unit))
    throw InputError(path, "unit", metres_per_unit, "a positive length in metres");
  // Some editors write a byte-order mark before the first word.
  if (bytes.compare(0, 3, "\xEF\xBB\xBF") == 0) bytes.erase(0, 3);
  if (bytes.empty()) throw InputError(path, "file", "empty", kAllowedSurface);
  const RawSurface raw = parse_raw_surface(path, std::move(bytes));
  double largest = 0;
  for (const Vector3d& vertex : raw.vertices)
    largest = std::max(largest, vertex.lpNorm<Eigen::Infinity>());

  SurfaceFile result;
  Welder welder(std::max(4 * static_cast<double>(std::numeric_limits<float>::epsilon()) * largest,
                         std::numeric_limits<double>::min()));
  std::set<std::array<int, 3>> known;
  for (const auto& corners : raw.triangles) {
    std::array<int, 3> triangle;
    for (std::size_t i = 0; i < 3; ++i)
      triangle[i] = welder.index(raw.vertices[std::size_t(corners[i])]);
    const Vector3d &a = welder.points[triangle[0]], &b = welder.points[triangle[1]],
                   &c = welder.points[triangle[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    // Thinner than single precision resolves: its normal would consist of rounding errors.
    if ((b - a).cross(c - a).norm() <= 1e-6 * longest * longest) {
      ++result.degenerate_triangles;
      continue;
    }
    auto sorted = triangle;
    std::sort(sorted.begin(), sorted.end());
    if (!known.insert(sorted).second) {
      ++result.duplicate_triangles;
      continue;
    }
    result.surface.triangles.push_back(triangle);
  }
  if (result.surface.triangles.empty()) {
    throw InputError(path, "triangles",
                     "0 (" + std::to_string(result.degenerate_triangles) + " degenerate ones)",
                     "at least one triangle");
  }

  // Vertices that belonged only to dropped triangles are removed.
  std::vector<int> renumbered(welder.points.size(), -1);
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (auto& triangle : result.surface.triangles) {
    for (int& v : triangle) {
      if (renumbered[v] < 0) {
        renumbered[v] = static_cast<int>(result.surface.vertices_m.size());
        result.surface.vertices_m.push_back(metres_per_unit * welder.points[v]);
        low = low.cwiseMin(result.surface.vertices_m.back());
        high = high.cwiseMax(result.surface.vertices_m.back());
      }
      v = renumbered[v];
    }
  }
  result.size_m = (high - low).norm();
  if (result.size_m > kLargestSurface_m || result.size_m < kSmallestSurface_m) {
    throw InputError(path, "size", across(result.size_m),
                     "10 micrometres to 5 metres: is the unit right?");
  }
  if (is_inside_out(result.surface)) {
    result.was_inside_out = true;
    for (auto& triangle : result.surface.triangles) std::swap(triangle[1], triangle[2]);
  }
  return result;
}

void write_stl_mm(const TriangleSurface& surface, const std::string& path) {
  std::string bytes(kStlHeader + kStlTriangle * surface.triangles.size(), '\0');
  const std::string_view title = "binary STL, millimetres";  // not "solid": that means ASCII
  std::copy(title.begin(), title.end(), bytes.begin());
  const auto count = static_cast<std::uint32_t>(surface.triangles.size());
  std::memcpy(&bytes[80], &count, sizeof count);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [i, j, k] = surface.triangles[t];
    const Vector3d &a = surface.vertices_m[i], &b = surface.vertices_m[j],
                   &c = surface.vertices_m[k];
    Eigen::Matrix<float, 3, 4> values;
    values << (b - a).cross(c - a).normalized().cast<float>(), (1e3 * a).cast<float>(),
        (1e3 * b).cast<float>(), (1e3 * c).cast<float>();
    std::memcpy(&bytes[kStlHeader + kStlTriangle * t], values.data(), sizeof(float) * 12);
  }

  // The file gets its name when it is complete, so that no reader finds half of it.
  const std::string failure = write_whole_file(path, [&](std::ostream& out) { out << bytes; });
  if (!failure.empty())
    throw InputError(path, "output", "cannot be written (" + failure + ")",
                     "a folder that can be written, with " + std::to_string(bytes.size()) +
                         " bytes free (is the disk full?)");
}

}  // namespace softfinger::meshes
