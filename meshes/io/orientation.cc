#include "meshes/io/orientation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

/// A triangle's edge: the smaller vertex first, and whether the triangle runs through it that way.
struct Side {
  int from, to;
  int number;  ///< three times the triangle's, and 0 to 2
  bool forwards;
};

struct Neighbour {
  int triangle = -1;    ///< none
  bool agrees = false;  ///< runs through the common edge in the opposite direction
};

struct Neighbours {
  std::vector<Neighbour> of_side;  ///< three for each triangle
  bool closed = true;              ///< every edge has two triangles
};

Neighbours neighbours_in(const TriangleSurface& surface) {
  std::vector<Side> sides;
  sides.reserve(3 * surface.triangles.size());
  for (const auto& triangle : surface.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = triangle[i], b = triangle[(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<int>(sides.size()), a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& one, const Side& other) {
    return std::tie(one.from, one.to) < std::tie(other.from, other.to);
  });
  Neighbours found;
  found.of_side.resize(sides.size());
  for (std::size_t start = 0, end = 0; start < sides.size(); start = end) {
    const Side& one = sides[start];
    while (end < sides.size() && sides[end].from == one.from && sides[end].to == one.to) ++end;
    if (end - start != 2) {
      found.closed = false;
      continue;
    }
    const Side& other = sides[start + 1];
    const bool agrees = one.forwards != other.forwards;
    found.of_side[std::size_t(one.number)] = {other.number / 3, agrees};
    found.of_side[std::size_t(other.number)] = {one.number / 3, agrees};
  }
  return found;
}

/// Whether each triangle is to be turned so that it agrees with its neighbours.
class Turns {
 public:
  explicit Turns(const Neighbours& neighbours)
      : neighbours_(neighbours), state_(neighbours.of_side.size() / 3, State::unknown) {
    for (std::size_t t = 0; t < state_.size(); ++t)
      if (state_[t] == State::unknown) settle_part(static_cast<int>(t));
  }

  bool of(std::size_t triangle) const { return state_[triangle] == State::turned; }
  bool is_one_sided() const { return is_one_sided_; }

 private:
  enum class State : char { unknown, kept, turned };

  void settle_part(int first) {
    std::vector<int> part{first};
    state(first) = State::kept;
    bool has_two_sides = true;
    std::size_t turned = 0;
    for (std::size_t head = 0; head < part.size(); ++head) {
      const State here = state(part[head]);
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& [other, agrees] = neighbours_.of_side[3 * std::size_t(part[head]) + i];
        if (other < 0) continue;
        const bool turn = (here == State::turned) == agrees;
        const State wanted = turn ? State::turned : State::kept;
        if (state(other) == State::unknown) {
          state(other) = wanted;
          part.push_back(other);
          turned += turn;
        } else if (state(other) != wanted) {
          has_two_sides = false;
        }
      }
    }
    if (!has_two_sides) is_one_sided_ = true;
    const bool most_are_turned = 2 * turned > part.size();
    for (const int t : part) {
      const bool turn = has_two_sides && (state(t) == State::turned) != most_are_turned;
      state(t) = turn ? State::turned : State::kept;
    }
  }

  State& state(int triangle) { return state_[std::size_t(triangle)]; }

  const Neighbours& neighbours_;
  std::vector<State> state_;
  bool is_one_sided_ = false;
};

double six_volumes(const TriangleSurface& surface) {
  // Any point would do; a near one avoids rounding errors.
  const Vector3d& origin = surface.vertices_m.front();
  double sum = 0;
  for (const auto& [i, j, k] : surface.triangles)
    sum += (surface.vertices_m[i] - origin)
               .dot((surface.vertices_m[j] - origin).cross(surface.vertices_m[k] - origin));
  return sum;
}

}  // namespace

Orientation orient(TriangleSurface& surface) {
  const Neighbours neighbours = neighbours_in(surface);
  const Turns turns(neighbours);
  const auto turn = [](std::array<int, 3>& triangle) { std::swap(triangle[1], triangle[2]); };
  Orientation result;
  result.is_one_sided = turns.is_one_sided();
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (turns.of(t)) {
      turn(surface.triangles[t]);
      ++result.turned_triangles;
    }
  if (neighbours.closed && !result.is_one_sided && six_volumes(surface) < 0) {
    for (auto& triangle : surface.triangles) turn(triangle);
    result.turned_triangles = static_cast<int>(surface.triangles.size()) - result.turned_triangles;
  }
  return result;
}

}  // namespace softfinger::meshes
