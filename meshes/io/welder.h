#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

namespace softfinger::meshes {

/// Gives equal vertices one index. STL repeats a vertex in each of its triangles, and programs that
/// compute in single precision may write it with different last digits: vertices within a few units
/// in the last place are merged.
class Welder {
 public:
  explicit Welder(double tolerance) : tolerance_(tolerance) {}

  int index(const Eigen::Vector3d& point) {
    const auto exact = exact_.find(key(point));
    if (exact != exact_.end()) return exact->second;
    const auto remember = [&](int found) { return exact_[key(point)] = found; };
    const auto cell = [&](double value) {
      return static_cast<std::int64_t>(std::floor(value / (4 * tolerance_)));
    };
    // Cells are four tolerances wide, so that few points have to be compared with neighbouring
    // cells.
    const Eigen::Vector3d low = point.array() - tolerance_, high = point.array() + tolerance_;
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

  std::vector<Eigen::Vector3d> points;

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
  static Key key(const Eigen::Vector3d& p) { return {{p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}}; }
  static std::uint64_t hash(std::int64_t i, std::int64_t j, std::int64_t k) {
    std::uint64_t h = static_cast<std::uint64_t>(i) * 0x9E3779B97F4A7C15u;
    h = (h ^ (h >> 31) ^ static_cast<std::uint64_t>(j)) * 0xBF58476D1CE4E5B9u;
    return (h ^ (h >> 29) ^ static_cast<std::uint64_t>(k)) * 0x94D049BB133111EBu;
  }

  double tolerance_;
  std::unordered_map<Key, int, KeyHash> exact_;
  std::unordered_multimap<std::uint64_t, int> cells_;
};

}  // namespace softfinger::meshes
