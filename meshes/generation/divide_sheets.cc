#include "meshes/generation/divide_sheets.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace softfinger::meshes {
namespace {

/// Corners of a cell by their place along its three directions, of which the first is the lowest
/// bit; of a face by two.
constexpr std::array<std::size_t, 8> corner_at{0, 1, 3, 2, 4, 5, 7, 6};

class Sheets {
 public:
  Sheets(const HexahedralMesh& mesh, const std::function<int(int, int)>& parts) {
    for (const auto& cell : mesh.cells)
      for (std::size_t direction : {0, 1, 2}) {
        const std::size_t first = sheet_of(edge(cell, 0, direction));
        for (std::size_t corner = 1; corner < 8; ++corner)
          if (!(corner >> direction & 1))
            parent_[root(sheet_of(edge(cell, corner, direction)))] = root(first);
      }
    parts_.assign(parent_.size(), 1);
    for (const auto& [ends, sheet] : sheets_) {
      int& most = parts_[root(sheet)];
      most = std::max(most, parts(ends.first, ends.second));
    }
  }

  int parts_of(int from, int to) { return parts_[root(sheets_.at(std::minmax(from, to)))]; }

 private:
  using Edge = std::pair<int, int>;  ///< by its vertices, the lower one first

  static Edge edge(const std::array<int, 8>& cell, std::size_t corner, std::size_t direction) {
    return std::minmax(
        {cell[corner_at[corner]], cell[corner_at[corner | std::size_t{1} << direction]]});
  }
  std::size_t sheet_of(const Edge& edge) {
    const auto [found, is_new] = sheets_.emplace(edge, parent_.size());
    if (is_new) parent_.push_back(found->second);
    return found->second;
  }
  std::size_t root(std::size_t sheet) {
    while (parent_[sheet] != sheet) sheet = parent_[sheet] = parent_[parent_[sheet]];
    return sheet;
  }

  std::map<Edge, std::size_t> sheets_;
  std::vector<std::size_t> parent_;
  std::vector<int> parts_;
};

/// Vertices of the divided mesh. One that several cells have is known by the corners that it is
/// interpolated from and their shares, as ratios of whole numbers.
class Vertices {
 public:
  Vertices(const std::vector<Eigen::Vector3d>& old, std::vector<Eigen::Vector3d>& made)
      : old_(old), made_(made) {}

  template <std::size_t count>
  int at(const std::array<int, count>& corner, const std::array<int, count>& share) {
    Key key;
    int common = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (share[i] == 0) continue;
      key.emplace_back(corner[i], share[i]);
      common = std::gcd(common, share[i]);
    }
    double sum = 0;
    for (auto& [vertex, of_vertex] : key) sum += of_vertex /= common;
    std::sort(key.begin(), key.end());
    const auto [found, is_new] = numbers_.emplace(key, static_cast<int>(made_.size()));
    if (is_new) {
      Eigen::Vector3d place = Eigen::Vector3d::Zero();
      for (const auto& [vertex, of_vertex] : key)
        place += of_vertex / sum * old_[static_cast<std::size_t>(vertex)];
      made_.push_back(place);
    }
    return found->second;
  }

 private:
  using Key = std::vector<std::pair<int, int>>;
  const std::vector<Eigen::Vector3d>& old_;
  std::vector<Eigen::Vector3d>& made_;
  std::map<Key, int> numbers_;
};

/// Shares of the corners at the place `at` of `parts` along each direction.
template <std::size_t directions>
std::array<int, std::size_t{1} << directions> shares(const std::array<int, directions>& at,
                                                     const std::array<int, directions>& parts) {
  std::array<int, std::size_t{1} << directions> result{};
  for (std::size_t corner = 0; corner < result.size(); ++corner) {
    result[corner] = 1;
    for (std::size_t d = 0; d < directions; ++d)
      result[corner] *= corner >> d & 1 ? at[d] : parts[d] - at[d];
  }
  return result;
}

/// The corners of a cell or a face, by their places along its directions.
template <std::size_t count>
std::array<int, count> by_place(const std::array<int, count>& around) {
  std::array<int, count> result{};
  for (std::size_t i = 0; i < count; ++i) result[i] = around[corner_at[i]];
  return result;
}

}  // namespace

LayerMesh divide_sheets(const LayerMesh& mesh, const std::function<int(int, int)>& parts) {
  Sheets sheets(mesh.hexahedra, parts);
  LayerMesh result;
  HexahedralMesh& divided = result.hexahedra;
  Vertices vertices(mesh.hexahedra.vertices, divided.vertices);
  for (std::size_t c = 0; c < mesh.hexahedra.cells.size(); ++c) {
    const std::array<int, 8> cell = by_place(mesh.hexahedra.cells[c]);
    const std::array<int, 3> of_cell{sheets.parts_of(cell[0], cell[1]),
                                     sheets.parts_of(cell[0], cell[2]),
                                     sheets.parts_of(cell[0], cell[4])};
    for (int i = 0; i < of_cell[0]; ++i)
      for (int j = 0; j < of_cell[1]; ++j)
        for (int k = 0; k < of_cell[2]; ++k) {
          std::array<int, 8> part{};
          for (int corner = 0; corner < 8; ++corner)
            part[corner_at[static_cast<std::size_t>(corner)]] = vertices.at(
                cell,
                shares<3>({i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)}, of_cell));
          divided.cells.push_back(part);
          divided.region.push_back(mesh.hexahedra.region[c]);
        }
  }
  const auto divide_faces = [&](const std::vector<std::array<int, 4>>& faces,
                                std::vector<std::array<int, 4>>& made) {
    for (const auto& around : faces) {
      const std::array<int, 4> face = by_place(around);
      const std::array<int, 2> of_face{sheets.parts_of(face[0], face[1]),
                                       sheets.parts_of(face[0], face[2])};
      for (int i = 0; i < of_face[0]; ++i)
        for (int j = 0; j < of_face[1]; ++j) {
          std::array<int, 4> part{};
          for (int corner = 0; corner < 4; ++corner)
            part[corner_at[static_cast<std::size_t>(corner)]] =
                vertices.at(face, shares<2>({i + (corner & 1), j + (corner >> 1)}, of_face));
          made.push_back(part);
        }
    }
  };
  divide_faces(mesh.contact, result.contact);
  divide_faces(mesh.core, result.core);
  return result;
}

}  // namespace softfinger::meshes
