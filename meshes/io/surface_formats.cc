#include "meshes/io/surface_formats.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string_view>
#include <system_error>

#include "meshes/io/cut_polygon.h"
#include "meshes/io/read_surface.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

void require_triangles(const std::string& path, std::size_t count) {
  if (count == 0) throw InputError(path, "triangles", "0", "at least one triangle");
  if (count > kMostTriangles)
    throw InputError(path, "triangles", std::to_string(count),
                     "at most " + std::to_string(kMostTriangles));
}

bool is_text(std::string_view bytes) {
  return std::none_of(bytes.begin(), bytes.end(), [](unsigned char c) {
    return c < 32 && c != '\t' && c != '\n' && c != '\r' && c != '\f' && c != '\v';
  });
}

/// The triangle count that a binary STL's header announces.
std::uint32_t announced_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= kStlHeader) std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}
std::size_t announced_bytes(std::string_view bytes) {
  return kStlHeader + kStlTriangle * static_cast<std::size_t>(announced_triangles(bytes));
}

std::string at_line(const std::string& path, int line) { return path + ":" + std::to_string(line); }

/// Cuts the next blank-separated word off the front.
std::string_view next_word(std::string_view& line) {
  const auto first = line.find_first_not_of(" \t\r\n\f\v");
  if (first == std::string_view::npos) return line = {};
  const auto last = std::min(line.find_first_of(" \t\r\n\f\v", first), line.size());
  const auto word = line.substr(first, last - first);
  line.remove_prefix(last);
  return word;
}

constexpr const char* kAllowedCoordinates =
    "three finite numbers of at most 3.4e38, single precision";

/// Three coordinates, and nothing that is no finite number of single precision.
Vector3d parse_coordinates(const std::string& where, std::string_view rest) {
  Vector3d point;
  for (int i = 0; i < 3; ++i) {
    const std::string_view word = next_word(rest);
    const std::string_view digits = !word.empty() && word[0] == '+' ? word.substr(1) : word;
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    // The library reports numbers too small for double precision as out of range: they are zero.
    const bool tiny =
        error == std::errc::result_out_of_range && digits.find("e-") != std::string_view::npos;
    if (digits.empty() || (error != std::errc() && !tiny) || end != digits.data() + digits.size() ||
        !(std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()))) {
      throw InputError(where, "vertex coordinate", word.empty() ? "missing" : std::string(word),
                       kAllowedCoordinates);
    }
    point[i] = tiny ? 0 : static_cast<float>(value);
  }
  return point;
}

/// "vertex 2 of triangle 7", for a file that has three vertices of its own for each triangle.
std::string name_of_stl_vertex(std::size_t vertex) {
  return "vertex " + std::to_string(vertex % 3 + 1) + " of triangle " +
         std::to_string(vertex / 3 + 1);
}

/// Three new vertices.
void add_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, RawSurface& surface) {
  const int first = static_cast<int>(surface.vertices.size());
  for (const Vector3d& vertex : {a, b, c}) surface.vertices.push_back(vertex);
  surface.triangles.push_back({first, first + 1, first + 2});
}

RawSurface parse_binary_stl(const std::string& path, std::string_view bytes) {
  const std::uint32_t count = announced_triangles(bytes);
  require_triangles(path, count);
  RawSurface surface;
  surface.vertices.reserve(3 * std::size_t{count});
  surface.triangles.reserve(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    // A triangle's record: its normal, three vertices, two bytes of attributes.
    Eigen::Matrix<float, 3, 3> vertices;
    std::memcpy(vertices.data(), bytes.data() + kStlHeader + kStlTriangle * t + 12,
                sizeof(float) * 9);
    for (Eigen::Index i = 0; i < 9; ++i) {
      const float value = vertices.reshaped()[i];
      if (!std::isfinite(value))
        throw InputError(
            path, "coordinate of " + name_of_stl_vertex(3 * std::size_t{t} + std::size_t(i / 3)),
            std::isnan(value) ? "nan" : "infinite", kAllowedCoordinates);
    }
    add_triangle(vertices.col(0).cast<double>(), vertices.col(1).cast<double>(),
                 vertices.col(2).cast<double>(), surface);
  }
  return surface;
}

/// @param lower  the file in lower case
RawSurface parse_ascii_stl(const std::string& path, const std::string& lower) {
  std::string_view text = lower;
  int line_number = 0, facets = 0, complete = 0, solids = 0, ended = 0;
  RawSurface surface;
  std::vector<Vector3d> vertices;  // of all facets so far
  while (!text.empty()) {
    ++line_number;
    const auto length = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
    const std::string_view word = next_word(line);
    if (word == "solid") ++solids;
    if (word == "endsolid") ++ended;
    if (word == "facet") ++facets;
    if (word == "vertex") {
      vertices.push_back(parse_coordinates(at_line(path, line_number), line));
      surface.lines.push_back(line_number);
    }
    if (word == "endfacet" && static_cast<std::size_t>(++complete) * 3 != vertices.size()) {
      throw InputError(at_line(path, line_number), "facet " + std::to_string(complete),
                       "not a triangle", "three vertices between facet and endfacet");
    }
  }
  if (ended < solids || complete != facets ||
      vertices.size() != 3 * static_cast<std::size_t>(facets)) {
    throw InputError(path, "ASCII STL", "ends early at line " + std::to_string(line_number),
                     "a file that ends with endsolid (is it truncated?)");
  }
  require_triangles(path, static_cast<std::size_t>(facets));
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3)
    add_triangle(vertices[i], vertices[i + 1], vertices[i + 2], surface);
  return surface;
}

/// Joins lines of an OBJ file that end in a backslash with the next one, and keeps the line
/// numbers.
std::string with_whole_lines(const std::string& text) {
  std::string whole;
  std::size_t joined = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t end = text.compare(i, 3, "\\\r\n") == 0 ? 3
                            : text.compare(i, 2, "\\\n") == 0 ? 2
                                                              : 0;
    if (end > 0) {
      whole += ' ';
      ++joined;
      i += end - 1;
    } else if (text[i] == '\n') {
      whole.append(joined + 1, '\n');
      joined = 0;
    } else {
      whole += text[i];
    }
  }
  return whole;
}

/// Reads an OBJ file line by line.
class ObjReader {
 public:
  explicit ObjReader(const std::string& path) : path_(path) {}

  /// @param whole_lines  see with_whole_lines
  RawSurface read(const std::string& whole_lines) {
    std::string_view text = whole_lines;
    while (!text.empty()) {
      ++line_;
      const auto length = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, length);
      text.remove_prefix(std::min(length + 1, text.size()));
      const std::string_view word = next_word(line);
      if (word == "v") {
        surface_.vertices.push_back(parse_coordinates(at_line(path_, line_), line));
        surface_.lines.push_back(line_);
        ++defined_[0];
      } else if (word == "vt") {
        ++defined_[1];
      } else if (word == "vn") {
        ++defined_[2];
      } else if (word == "f") {
        read_face(line);
      }
    }
    // A positive index may point forward, so the counts are known only now.
    for (int kind = 0; kind < 3; ++kind)
      if (largest_[kind].index > defined_[kind])
        throw out_of_range(largest_[kind].line, kind, largest_[kind].index);
    require_triangles(path_, triangles_);
    for (const std::vector<int>& polygon : polygons_)
      cut_polygon(polygon, surface_.vertices, surface_.triangles);
    return std::move(surface_);
  }

 private:
  static constexpr const char* kKinds[] = {"vertex index", "texture index", "normal index"};

  InputError out_of_range(int line, int kind, long index) const {
    const std::string count = std::to_string(defined_[kind]);
    return InputError(at_line(path_, line), kKinds[kind], std::to_string(index),
                      "1 to " + count + ", or -" + count + " to -1 from the end");
  }

  void read_face(std::string_view line) {
    std::vector<int> polygon;
    for (std::string_view corner = next_word(line); !corner.empty() && corner[0] != '#';
         corner = next_word(line))
      polygon.push_back(read_corner(corner));
    // The time to cut a polygon grows as the square of its corners: a second at this limit.
    constexpr std::size_t kMostCorners = 10'000;
    if (polygon.size() < 3 || polygon.size() > kMostCorners) {
      throw InputError(at_line(path_, line_), "face", std::to_string(polygon.size()) + " corners",
                       "3 to " + std::to_string(kMostCorners));
    }
    triangles_ += polygon.size() - 2;
    polygons_.push_back(std::move(polygon));
  }

  /// "7", "7/1", "7//2" or "7/1/2". @returns the vertex, from 0
  int read_corner(std::string_view corner) {
    const std::string_view whole = corner;
    long vertex = 0;
    for (int kind = 0; kind < 3; ++kind) {
      const auto slash = std::min(corner.find('/'), corner.size());
      const std::string_view digits = corner.substr(0, slash);
      corner.remove_prefix(std::min(slash + 1, corner.size()));
      if (digits.empty() && kind > 0) continue;
      long index = 0;
      const auto [end, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), index);
      if (error != std::errc() || end != digits.data() + digits.size()) {
        throw InputError(at_line(path_, line_), "face corner", std::string(whole),
                         "vertex, vertex/texture or vertex/texture/normal, integers");
      }
      if (index == 0 || index < -defined_[kind]) throw out_of_range(line_, kind, index);
      if (index > largest_[kind].index) largest_[kind] = {index, line_};
      // A negative index counts from the last one so far.
      if (kind == 0) vertex = index > 0 ? index - 1 : defined_[0] + index;
    }
    return static_cast<int>(std::min<long>(vertex, std::numeric_limits<int>::max()));
  }

  struct Use {
    long index = 0;
    int line = 0;
  };

  const std::string& path_;
  int line_ = 0;
  std::array<long, 3> defined_{};  ///< positions, texture coordinates, normals
  std::array<Use, 3> largest_;
  std::size_t triangles_ = 0;
  std::vector<std::vector<int>> polygons_;
  RawSurface surface_;
};

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

std::pair<std::string, std::string> place_of_vertex(const RawSurface& surface, int vertex,
                                                    const std::string& path) {
  const auto v = static_cast<std::size_t>(vertex);
  if (surface.lines.empty()) return {path, name_of_stl_vertex(v)};
  return {at_line(path, surface.lines[v]), "vertex"};
}

RawSurface parse_raw_surface(const std::string& path, std::string bytes) {
  const bool text = is_text(bytes);
  // A binary STL may begin with "solid", too: only the file's size shows that it is binary.
  const bool whole_binary =
      !text && bytes.size() >= kStlHeader && announced_bytes(bytes) <= bytes.size();
  if (whole_binary && announced_bytes(bytes) == bytes.size()) {
    return parse_binary_stl(path, bytes);
  }
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  if (text) {
    std::string_view rest(bytes);
    if (lower_case(std::string(next_word(rest))) == "solid") {
      return parse_ascii_stl(path, lower_case(std::move(bytes)));
    }
    const bool vertices = bytes.compare(0, 2, "v ") == 0 || bytes.find("\nv ") != std::string::npos;
    if (vertices || extension == ".obj") {
      return ObjReader(path).read(with_whole_lines(bytes));
    }
  } else if (whole_binary && extension == ".stl" && announced_triangles(bytes) > 0) {
    // Some programs append notes of their own after the triangles; these are ignored. If the rest
    // could hold more triangles than the header announces, the header is more likely damaged.
    if (bytes.size() - announced_bytes(bytes) >=
        kStlTriangle * (std::size_t{1} + announced_triangles(bytes)))
      throw InputError(path, "file size", std::to_string(bytes.size()) + " bytes",
                       std::to_string(announced_bytes(bytes)) + " bytes for the " +
                           std::to_string(announced_triangles(bytes)) +
                           " triangles that its binary STL header announces (a damaged header?)");
    bytes.resize(announced_bytes(bytes));
    return parse_binary_stl(path, bytes);
  } else if (extension == ".stl" && bytes.size() >= kStlHeader) {
    throw InputError(path, "file size", std::to_string(bytes.size()) + " bytes",
                     std::to_string(announced_bytes(bytes)) + " bytes for the " +
                         std::to_string(announced_triangles(bytes)) +
                         " triangles that its binary STL header announces (truncated, or not a "
                         "mesh?)");
  }
  throw InputError(path, "file", "not a mesh", kAllowedSurface);
}

}  // namespace softfinger::meshes
