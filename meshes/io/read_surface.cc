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
#include <vector>

#include "meshes/io/orientation.h"
#include "meshes/io/surface_formats.h"
#include "meshes/io/welder.h"
#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

std::string across(double size_m) {
  std::ostringstream out;
  out.precision(3);
  out << size_m << " m across";
  return out.str();
}

/// Refuses a vertex that lies so far from the others that the unit cannot be what is wrong.
void refuse_stray_vertex(const RawSurface& raw, const std::string& path, double metres_per_unit) {
  // From the middle of a finger, however long, the farthest vertex is a few times as far as most.
  constexpr double kStray = 100;
  std::vector<int> used;
  used.reserve(3 * raw.triangles.size());
  for (const auto& corners : raw.triangles) used.insert(used.end(), corners.begin(), corners.end());
  if (used.empty()) return;
  const auto vertex = [&](int v) -> const Vector3d& { return raw.vertices[std::size_t(v)]; };
  const auto median = [&](const auto& value) {
    const auto middle = used.begin() + static_cast<std::ptrdiff_t>(used.size() / 2);
    std::nth_element(used.begin(), middle, used.end(),
                     [&](int one, int other) { return value(one) < value(other); });
    return value(*middle);
  };
  Vector3d centre;
  for (int i = 0; i < 3; ++i) centre[i] = median([&](int v) { return vertex(v)[i]; });
  const auto distance = [&](int v) { return (vertex(v) - centre).norm(); };
  const double usual = median(distance);
  const int farthest = *std::max_element(used.begin(), used.end(), [&](int one, int other) {
    return distance(one) < distance(other);
  });
  if (distance(farthest) * metres_per_unit <= kLargestSurface_m ||
      distance(farthest) <= kStray * usual)
    return;
  const auto [where, name] = place_of_vertex(raw, farthest, path);
  std::ostringstream value, allowed;
  value << "(" << vertex(farthest).x() << ", " << vertex(farthest).y() << ", "
        << vertex(farthest).z() << ")";
  allowed.precision(3);
  allowed << "at most " << std::llround(kLargestSurface_m / metres_per_unit)
          << " of the file's units from the others, most of which lie within " << usual
          << " of their middle";
  throw InputError(where, name, value.str(), allowed.str());
}

/// The middle one of the sizes of a box.
double middle_of(Vector3d size) {
  std::sort(size.begin(), size.end());
  return size[1];
}

double width_of(const RawSurface& raw) {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const auto& corners : raw.triangles)
    for (const int v : corners) {
      low = low.cwiseMin(raw.vertices[std::size_t(v)]);
      high = high.cwiseMax(raw.vertices[std::size_t(v)]);
    }
  return middle_of(high - low);
}

}  // namespace

double guessed_metres_per_unit(double width_in_file) {
  constexpr double kUsualWidth_m = 15e-3, kMillimetre = 1e-3, kMetre = 1;
  const auto distance = [&](double metres_per_unit) {
    return std::abs(std::log(width_in_file * metres_per_unit / kUsualWidth_m));
  };
  return distance(kMetre) < distance(kMillimetre) ? kMetre : kMillimetre;
}

SurfaceFile read_surface(const std::string& path, std::optional<double> metres_per_unit) {
  return parse_surface(read_whole_file(path, "file", kAllowedSurface, kLargestSurface_bytes), path,
                       metres_per_unit);
}

SurfaceFile parse_surface(std::string bytes, const std::string& path,
                          std::optional<double> typed_metres_per_unit) {
  if (typed_metres_per_unit &&
      !(*typed_metres_per_unit > 0 && std::isfinite(*typed_metres_per_unit)))
    throw InputError(path, "unit", *typed_metres_per_unit, "a positive length in metres");
  // Some editors write a byte-order mark before the first word.
  if (bytes.compare(0, 3, "\xEF\xBB\xBF") == 0) bytes.erase(0, 3);
  if (bytes.empty()) throw InputError(path, "file", "empty", kAllowedSurface);
  const RawSurface raw = parse_raw_surface(path, std::move(bytes));
  const double metres_per_unit =
      typed_metres_per_unit ? *typed_metres_per_unit : guessed_metres_per_unit(width_of(raw));
  refuse_stray_vertex(raw, path, metres_per_unit);
  double largest = 0;
  for (const auto& corners : raw.triangles)
    for (const int v : corners)
      largest = std::max(largest, raw.vertices[std::size_t(v)].lpNorm<Eigen::Infinity>());

  SurfaceFile result;
  result.metres_per_unit = metres_per_unit;
  result.is_unit_guessed = !typed_metres_per_unit;
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
  result.width_m = middle_of(high - low);
  if (result.size_m > kLargestSurface_m || result.size_m < kSmallestSurface_m) {
    throw InputError(path, "size", across(result.size_m),
                     "10 micrometres to 5 metres: is the unit right?");
  }
  const Orientation orientation = orient(result.surface);
  result.turned_triangles = orientation.turned_triangles;
  result.is_one_sided = orientation.is_one_sided;
  return result;
}

SurfaceFile parse_converted_surface(const ConvertedMesh& mesh, const std::string& path,
                                    std::optional<double> typed_metres_per_unit) {
  SurfaceFile file = parse_surface(
      mesh.stl, path, typed_metres_per_unit ? typed_metres_per_unit : mesh.metres_per_unit);
  file.own_metres_per_unit = mesh.metres_per_unit;
  file.left_out = mesh.note;
  return file;
}

std::string repairs(const SurfaceFile& file) {
  std::vector<std::string> said;
  if (!file.left_out.empty()) said.push_back(file.left_out);
  if (file.degenerate_triangles > 0 || file.duplicate_triangles > 0)
    said.push_back(std::to_string(file.degenerate_triangles) + " degenerate and " +
                   std::to_string(file.duplicate_triangles) + " duplicate triangles were left out");
  const std::size_t triangles = file.surface.triangles.size();
  if (file.was_inside_out())
    said.push_back("all triangles faced inwards and were turned");
  else if (file.turned_triangles > 0)
    said.push_back(std::to_string(file.turned_triangles) + " of " + std::to_string(triangles) +
                   " triangles faced the other way than their neighbours and were turned");
  if (file.hidden_triangles > 0)
    said.push_back(std::to_string(file.hidden_triangles) + " of " +
                   std::to_string(triangles + file.hidden_triangles) +
                   " triangles lie inside, where nothing touches them, and were left out");
  if (file.is_one_sided)
    said.push_back(
        "its triangles cannot all face one side, as those of a Moebius strip: which side is "
        "outside "
        "depends on the triangle");
  std::string text;
  for (const std::string& sentence : said) text += (text.empty() ? "" : "; ") + sentence;
  return text;
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

  write_whole_file(path, [&](std::ostream& out) { out << bytes; });
}

}  // namespace softfinger::meshes
