#include "meshes/io/read_surface.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <set>
#include <sstream>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"

// Assimp parses the file. Before that, this file looks for defects that Assimp accepts without a
// message: texts that are not numbers, truncated files, indices out of range. Here the line or the
// triangle is known, so that the message can name it.

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;
const char* const kAllowedFile = "a readable STL (binary or ASCII) or OBJ file";

/// Lets Assimp open no file. An OBJ file can name other files, of materials, and Assimp would open
/// any path that is written there.
class NoFiles : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

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

void check_coordinates(const std::string& where, std::string_view rest) {
  for (int i = 0; i < 3; ++i) {
    const std::string_view word = next_word(rest);
    const std::string_view digits = !word.empty() && word[0] == '+' ? word.substr(1) : word;
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    // The library reports denormal numbers as out of range as well: they count as zero here.
    const bool tiny =
        error == std::errc::result_out_of_range && digits.find("e-") != std::string_view::npos;
    if (digits.empty() || (error != std::errc() && !tiny) || end != digits.data() + digits.size() ||
        !(std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()))) {
      throw InputError(where, "vertex coordinate", word.empty() ? "missing" : std::string(word),
                       "three finite numbers");
    }
  }
}

void check_binary_stl(const std::string& path, std::string_view bytes) {
  const std::uint32_t count = announced_triangles(bytes);
  require_triangles(path, count);
  for (std::uint32_t t = 0; t < count; ++t) {
    std::array<float, 9> coordinates;
    std::memcpy(coordinates.data(), bytes.data() + kStlHeader + kStlTriangle * t + 12,
                sizeof coordinates);
    for (float value : coordinates) {
      if (!std::isfinite(value)) {
        throw InputError(path, "coordinate of triangle " + std::to_string(t + 1),
                         std::isnan(value) ? "nan" : "infinite", "finite numbers");
      }
    }
  }
}

/// @param text  lower case
void check_ascii_stl(const std::string& path, std::string_view text) {
  int line_number = 0, facets = 0, complete = 0, vertices = 0, solids = 0, ended = 0;
  while (!text.empty()) {
    ++line_number;
    const auto length = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
    const std::string_view word = next_word(line);
    if (word == "solid") ++solids;
    if (word == "endsolid") ++ended;
    if (word == "facet") ++facets;
    if (word == "endfacet" && ++complete * 3 != vertices) {
      throw InputError(at_line(path, line_number), "facet " + std::to_string(complete),
                       "not a triangle", "three vertices between facet and endfacet");
    }
    if (word == "vertex") {
      ++vertices;
      check_coordinates(at_line(path, line_number), line);
    }
  }
  if (ended < solids || complete != facets || vertices != 3 * facets) {
    throw InputError(path, "ASCII STL", "ends early at line " + std::to_string(line_number),
                     "a file that ends with endsolid (is it truncated?)");
  }
  require_triangles(path, static_cast<std::size_t>(facets));
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

void check_obj(const std::string& path, std::string_view text) {
  struct Use {
    long largest = 0;
    int line = 0;
  };
  std::array<long, 3> defined{};  // positions, texture coordinates, normals
  std::array<Use, 3> used;
  const char* const kinds[] = {"vertex index", "texture index", "normal index"};
  const auto out_of_range = [&](int line, int kind, long index, long count) {
    return InputError(
        at_line(path, line), kinds[kind], std::to_string(index),
        "1 to " + std::to_string(count) + ", or -" + std::to_string(count) + " to -1 from the end");
  };
  int line_number = 0;
  std::size_t triangles = 0;
  while (!text.empty()) {
    ++line_number;
    const auto length = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
    const std::string_view word = next_word(line);
    if (word == "vt") ++defined[1];
    if (word == "vn") ++defined[2];
    if (word == "v") {
      ++defined[0];
      check_coordinates(at_line(path, line_number), line);
    }
    if (word != "f") continue;
    int corners = 0;
    for (std::string_view corner = next_word(line); !corner.empty() && corner[0] != '#';
         corner = next_word(line)) {
      ++corners;
      const std::string_view whole = corner;
      for (int kind = 0; kind < 3; ++kind) {
        const auto slash = std::min(corner.find('/'), corner.size());
        const std::string_view digits = corner.substr(0, slash);
        corner.remove_prefix(std::min(slash + 1, corner.size()));
        if (digits.empty() && kind > 0) continue;
        long index = 0;
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), index);
        if (error != std::errc() || end != digits.data() + digits.size()) {
          throw InputError(at_line(path, line_number), "face corner", std::string(whole),
                           "vertex, vertex/texture or vertex/texture/normal, integers");
        }
        if (index == 0 || index < -defined[kind])
          throw out_of_range(line_number, kind, index, defined[kind]);
        if (index > used[kind].largest) used[kind] = {index, line_number};
      }
    }
    // The time to triangulate a polygon grows as the square of its corners: two seconds at this
    // limit.
    constexpr int kMostCorners = 10'000;
    if (corners < 3 || corners > kMostCorners) {
      throw InputError(at_line(path, line_number), "face", std::to_string(corners) + " corners",
                       "3 to " + std::to_string(kMostCorners));
    }
    triangles += static_cast<std::size_t>(corners) - 2;
  }
  // A positive index may point forward, so the counts are known only now.
  for (int kind = 0; kind < 3; ++kind)
    if (used[kind].largest > defined[kind])
      throw out_of_range(used[kind].line, kind, used[kind].largest, defined[kind]);
  require_triangles(path, triangles);
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Decides by content, not by the file's name, and checks.
/// @return Assimp's name of the format
const char* check_content(const std::string& path, std::string& bytes) {
  const bool text = is_text(bytes);
  // A binary STL may begin with "solid", too: only its size tells.
  const bool whole_binary =
      !text && bytes.size() >= kStlHeader && announced_bytes(bytes) <= bytes.size();
  if (whole_binary && announced_bytes(bytes) == bytes.size()) {
    check_binary_stl(path, bytes);
    return "stl";
  }
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  if (text) {
    std::string_view rest(bytes);
    if (lower_case(std::string(next_word(rest))) == "solid") {
      bytes = lower_case(std::move(bytes));
      check_ascii_stl(path, bytes);
      return "stl";
    }
    const bool vertices = bytes.compare(0, 2, "v ") == 0 || bytes.find("\nv ") != std::string::npos;
    if (vertices || extension == ".obj") {
      bytes = with_whole_lines(bytes);
      check_obj(path, bytes);
      return "obj";
    }
  } else if (whole_binary && extension == ".stl" && announced_triangles(bytes) > 0) {
    // Some programs append notes of their own. A rest that could hold as many triangles again is
    // more likely a damaged header.
    if (bytes.size() - announced_bytes(bytes) >=
        kStlTriangle * (std::size_t{1} + announced_triangles(bytes)))
      throw InputError(path, "file size", std::to_string(bytes.size()) + " bytes",
                       std::to_string(announced_bytes(bytes)) + " bytes for the " +
                           std::to_string(announced_triangles(bytes)) +
                           " triangles that its binary STL header announces (a damaged header?)");
    bytes.resize(announced_bytes(bytes));
    check_binary_stl(path, bytes);
    return "stl";
  } else if (extension == ".stl" && bytes.size() >= kStlHeader) {
    throw InputError(path, "file size", std::to_string(bytes.size()) + " bytes",
                     std::to_string(announced_bytes(bytes)) + " bytes for the " +
                         std::to_string(announced_triangles(bytes)) +
                         " triangles that its binary STL header announces (truncated, or not a "
                         "mesh?)");
  }
  throw InputError(path, "file", "not a mesh", kAllowedFile);
}

/// Gives equal vertices one index. STL repeats a vertex in each of its triangles, and programs that
/// compute in single precision may write it with different last digits: vertices within a few units
/// in the last place are merged.
class Welder {
 public:
  explicit Welder(double tolerance) : tolerance_(tolerance) {}

  int index(const Vector3d& point) {
    const auto exact = exact_.find(key(point));
    if (exact != exact_.end()) return exact->second;
    const auto remember = [&](int found) { return exact_[key(point)] = found; };
    const auto cell = [&](double value) {
      return static_cast<std::int64_t>(std::floor(value / (4 * tolerance_)));
    };
    // Cells are four tolerances wide, so that few points have to be compared with neighbouring
    // cells.
    const Vector3d low = point.array() - tolerance_, high = point.array() + tolerance_;
    for (auto i = cell(low[0]); i <= cell(high[0]); ++i)
      for (auto j = cell(low[1]); j <= cell(high[1]); ++j)
        for (auto k = cell(low[2]); k <= cell(high[2]); ++k) {
          const auto range = cells_.equal_range(hash(i, j, k));
          for (auto it = range.first; it != range.second; ++it)
            if ((points[it->second] - point).norm() <= tolerance_) return remember(it->second);
        }
    const int added = static_cast<int>(points.size());
    points.push_back(point);
    cells_.emplace(hash(cell(point[0]), cell(point[1]), cell(point[2])), added);
    return remember(added);
  }

  std::vector<Vector3d> points;

 private:
  struct Key {
    std::array<double, 3> x;
    bool operator==(const Key& other) const { return x == other.x; }
  };
  struct KeyHash {
    std::size_t operator()(const Key& k) const {
      const std::hash<double> h;
      return static_cast<std::size_t>(hash(static_cast<std::int64_t>(h(k.x[0])),
                                           static_cast<std::int64_t>(h(k.x[1])),
                                           static_cast<std::int64_t>(h(k.x[2]))));
    }
  };
  // Adding zero turns -0 into +0, which hashes differently.
  static Key key(const Vector3d& p) { return {{p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}}; }
  static std::uint64_t hash(std::int64_t i, std::int64_t j, std::int64_t k) {
    std::uint64_t h = static_cast<std::uint64_t>(i) * 0x9E3779B97F4A7C15u;
    h = (h ^ (h >> 31) ^ static_cast<std::uint64_t>(j)) * 0xBF58476D1CE4E5B9u;
    return (h ^ (h >> 29) ^ static_cast<std::uint64_t>(k)) * 0x94D049BB133111EBu;
  }

  double tolerance_;
  std::unordered_map<Key, int, KeyHash> exact_;
  std::unordered_multimap<std::uint64_t, int> cells_;
};

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
  return parse_surface(read_whole_file(path, "file", kAllowedFile, kLargestSurface_bytes), path,
                       metres_per_unit);
}

SurfaceFile parse_surface(std::string bytes, const std::string& path, double metres_per_unit) {
  if (!(metres_per_unit > 0) || !std::isfinite(metres_per_unit))
    throw InputError(path, "unit", std::to_string(metres_per_unit), "a positive length in metres");
  // Some editors write a byte-order mark before the first word.
  if (bytes.compare(0, 3, "\xEF\xBB\xBF") == 0) bytes.erase(0, 3);
  if (bytes.empty()) throw InputError(path, "file", "empty", kAllowedFile);
  const char* const format = check_content(path, bytes);

  Assimp::Importer importer;
  importer.SetIOHandler(new NoFiles);  // which the importer owns
  const aiScene* scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate, format);
  if (!scene)
    throw InputError(path, "file", std::string("not a mesh (") + importer.GetErrorString() + ")",
                     kAllowedFile);

  double largest = 0;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      for (unsigned i = 0; i < 3; ++i) {
        const double value = mesh.mVertices[v][i];
        if (!std::isfinite(value))
          throw InputError(path, "coordinate", std::to_string(value), "finite numbers");
        largest = std::max(largest, std::abs(value));
      }
    }
  }

  SurfaceFile result;
  Welder welder(std::max(4 * static_cast<double>(std::numeric_limits<float>::epsilon()) * largest,
                         std::numeric_limits<double>::min()));
  std::set<std::array<int, 3>> known;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      std::array<int, 3> triangle;
      for (unsigned i = 0; i < 3; ++i) {
        const auto& v = mesh.mVertices[face.mIndices[i]];
        triangle[i] = welder.index({v.x, v.y, v.z});
      }
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
