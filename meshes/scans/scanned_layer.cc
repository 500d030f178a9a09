#include "meshes/scans/scanned_layer.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace softfinger::meshes {

using Eigen::Vector3d;

namespace {

/// Hermite's cubics on the unit interval, for values and slopes at 0 and 1, and their derivatives.
struct Hermite {
  explicit Hermite(double t)
      : value{(1 + 2 * t) * (1 - t) * (1 - t), t * t * (3 - 2 * t)},
        slope{t * (1 - t) * (1 - t), t * t * (t - 1)},
        value_change{6 * t * (t - 1), 6 * t * (1 - t)},
        slope_change{(1 - t) * (1 - 3 * t), t * (3 * t - 2)} {}
  std::array<double, 2> value, slope, value_change, slope_change;
};

constexpr double smallest_jacobian = 0.05, smallest_stretch = 0.25, largest_stretch = 3;

/// Weight of a valid cell at a distance from the contact, in thicknesses, when layers are compared.
/// It is small beyond `near_rim`, the distance from which a side wall no longer affects the
/// contact.
double worth_of_cell(double distance) { return std::pow(1 + distance * distance, -2); }
constexpr double near_rim = 4;

/// The lattice's spacing, in thicknesses.
constexpr double steps_per_thickness = 2;

}  // namespace

ScannedLayer::ScannedLayer(const SmoothSurface& surface, const SmoothSurface::Point& centre,
                           const Vector3d& x_axis, double thickness, double radius,
                           const SmoothSurface* core, const std::optional<Erosion>& erosion)
    : thickness_(thickness),
      deepest_((core ? 6 : 2) * thickness),
      cloth_(lay_cloth(surface, centre, x_axis, radius, thickness / steps_per_thickness)) {
  Field top;
  const int half = cloth_.half();
  for (int j = -half; j <= half; ++j)
    for (int i = -half; i <= half; ++i) top.push_back(cloth_.node(i, j).position);
  top_ = jets_of(top);
  if (erosion) {
    Field field = core_by(*erosion);
    if (core) field = on_core(*core, std::move(field));
    core_ = jets_of(field);
    find_cells();
    keep_connected();
    return;
  }
  // Plain normals come first: they are exact where the curvature is small.
  std::vector<Jet> best;
  std::vector<ClothEnd> best_cells;
  double most = -1;
  for (const double smoothing : {0.0, 0.25, 0.5, 1.0}) {
    Field field = core_by(smoothing * thickness);
    if (core) field = on_core(*core, std::move(field));
    core_ = jets_of(field);
    const double valid = find_cells();
    // One cell more at the rim does not justify more smoothing.
    if (valid <= most + worth_of_cell(near_rim)) continue;
    most = valid;
    best = core_;
    best_cells = cells_;
  }
  core_ = std::move(best);
  cells_ = std::move(best_cells);
  keep_connected();
}

/// Derivatives by differences of fourth order where the lattice allows it.
std::vector<ScannedLayer::Jet> ScannedLayer::jets_of(const Field& values) const {
  const int half = cloth_.half();
  const auto derivative = [&](const Field& field, int di, int dj) {
    Field result(field.size(), Vector3d::Zero());
    for (int j = -half; j <= half; ++j)
      for (int i = -half; i <= half; ++i) {
        if (!cloth_.lies(i, j)) continue;
        const auto lies = [&](int k) { return cloth_.lies(i + k * di, j + k * dj); };
        const auto at = [&](int k) -> const Vector3d& {
          return field[index(i + k * di, j + k * dj)];
        };
        Vector3d& slope = result[index(i, j)];
        const bool ahead = lies(1), behind = lies(-1);
        if (ahead && behind && lies(2) && lies(-2))
          slope = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / 12;
        else if (ahead && behind)
          slope = (at(1) - at(-1)) / 2;
        else if (ahead)
          slope =
              lies(2) ? Vector3d(-1.5 * at(0) + 2 * at(1) - 0.5 * at(2)) : Vector3d(at(1) - at(0));
        else if (behind)
          slope = lies(-2) ? Vector3d(1.5 * at(0) - 2 * at(-1) + 0.5 * at(-2))
                           : Vector3d(at(0) - at(-1));
      }
    return result;
  };
  const Field by_x = derivative(values, 1, 0), by_y = derivative(values, 0, 1),
              by_xy = derivative(by_x, 0, 1);
  std::vector<Jet> jets(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) jets[k] = {values[k], by_x[k], by_y[k], by_xy[k]};
  return jets;
}

ScannedLayer::Patch ScannedLayer::patch(const std::vector<Jet>& jets, double x, double y) const {
  const double s = cloth_.spacing();
  const int half = cloth_.half();
  const int i = std::clamp(static_cast<int>(std::floor(x / s)), -half, half - 1);
  const int j = std::clamp(static_cast<int>(std::floor(y / s)), -half, half - 1);
  const Hermite along_x(x / s - i), along_y(y / s - j);
  Patch result{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  for (std::size_t v = 0; v < 2; ++v)
    for (std::size_t u = 0; u < 2; ++u) {
      const Jet& jet = jets[index(i + static_cast<int>(u), j + static_cast<int>(v))];
      const Vector3d by_value = along_y.value[v] * jet.value + along_y.slope[v] * jet.by_y,
                     by_slope = along_y.value[v] * jet.by_x + along_y.slope[v] * jet.by_xy;
      result.value += along_x.value[u] * by_value + along_x.slope[u] * by_slope;
      result.by_x += (along_x.value_change[u] * by_value + along_x.slope_change[u] * by_slope) / s;
      result.by_y +=
          (along_x.value[u] *
               (along_y.value_change[v] * jet.value + along_y.slope_change[v] * jet.by_y) +
           along_x.slope[u] *
               (along_y.value_change[v] * jet.by_x + along_y.slope_change[v] * jet.by_xy)) /
          s;
    }
  return result;
}

/// (1 + l² L)^-1 of a field, L the lattice's Laplacian.
ScannedLayer::Field ScannedLayer::smoothed(const Field& field, double length) const {
  const int half = cloth_.half();
  const double weight = std::pow(length / cloth_.spacing(), 2);
  std::vector<int> number(field.size(), -1);
  int count = 0;
  for (int j = -half; j <= half; ++j)
    for (int i = -half; i <= half; ++i)
      if (cloth_.lies(i, j)) number[index(i, j)] = count++;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d right(count, 3);
  for (int j = -half; j <= half; ++j)
    for (int i = -half; i <= half; ++i) {
      const int row = number[index(i, j)];
      if (row < 0) continue;
      right.row(row) = field[index(i, j)].transpose();
      entries.emplace_back(row, row, 1);
      for (const auto& [di, dj] :
           {std::pair(1, 0), std::pair(0, 1), std::pair(-1, 0), std::pair(0, -1)})
        if (cloth_.lies(i + di, j + dj)) {
          entries.emplace_back(row, row, weight);
          entries.emplace_back(row, number[index(i + di, j + dj)], -weight);
        }
    }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::MatrixX3d solution = solver.solve(right);
  Field result = field;
  for (std::size_t k = 0; k < field.size(); ++k)
    if (number[k] >= 0) result[k] = solution.row(number[k]).transpose();
  return result;
}

/// Distance of a point below the top, from a first guess of its foot. The foot is found among the
/// lattice's nodes around the guess, then by Gauss and Newton's method.
double ScannedLayer::depth_below(const Vector3d& point, double x, double y, Vector3d* foot) const {
  const double s = cloth_.spacing();
  const int around = static_cast<int>(std::ceil(1.5 * thickness_ / s));
  const int i0 = static_cast<int>(std::lround(x / s)), j0 = static_cast<int>(std::lround(y / s));
  double nearest = 1e300;
  for (int j = j0 - around; j <= j0 + around; ++j)
    for (int i = i0 - around; i <= i0 + around; ++i) {
      if (!cloth_.lies(i, j)) continue;
      const double distance = (top_[index(i, j)].value - point).squaredNorm();
      if (distance < nearest) {
        nearest = distance;
        x = i * s;
        y = j * s;
      }
    }
  Vector3d at = point;
  double best = std::sqrt(nearest);
  constexpr int iterations = 4;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const int i = static_cast<int>(std::floor(x / s)), j = static_cast<int>(std::floor(y / s));
    if (!cloth_.lies(i, j) || !cloth_.lies(i + 1, j) || !cloth_.lies(i, j + 1) ||
        !cloth_.lies(i + 1, j + 1)) {
      // At the cloth's edge: from the node itself.
      if (iteration == 0)
        at = top_[index(static_cast<int>(std::lround(x / s)), static_cast<int>(std::lround(y / s)))]
                 .value;
      break;
    }
    const Patch on = patch(top_, x, y);
    const double distance = (on.value - point).norm();
    if (iteration == 0 || distance <= best) {
      best = distance;
      at = on.value;
    }
    const Vector3d apart = point - on.value;
    Eigen::Matrix2d metric;
    metric << on.by_x.squaredNorm(), on.by_x.dot(on.by_y), on.by_x.dot(on.by_y),
        on.by_y.squaredNorm();
    const Eigen::Vector2d step =
        metric.inverse() * Eigen::Vector2d(on.by_x.dot(apart), on.by_y.dot(apart));
    if (!step.allFinite()) break;
    x += std::clamp(step.x(), -s / 2, s / 2);
    y += std::clamp(step.y(), -s / 2, s / 2);
  }
  if (foot) *foot = at;
  return best;
}

/// @param smoothing  length over which the directions from the top to the core are smoothed; 0:
///   along the normals
ScannedLayer::Field ScannedLayer::core_by(double smoothing) const {
  const int half = cloth_.half();
  const double s = cloth_.spacing(), h = thickness_;
  Field down(top_.size(), Vector3d::Zero());
  const auto each = [&](const auto& visit) {
    for (int j = -half; j <= half; ++j)
      for (int i = -half; i <= half; ++i)
        if (cloth_.lies(i, j)) visit(i, j, index(i, j));
  };
  each([&](int i, int j, std::size_t k) { down[k] = h * cloth_.node(i, j).normal; });
  if (smoothing > 0) {
    constexpr int rounds = 6;
    for (int round = 0; round < rounds; ++round) {
      down = smoothed(down, smoothing);
      each([&](int i, int j, std::size_t k) {
        if (down[k].norm() < h) down[k] *= h / std::max(down[k].norm(), 1e-3 * h);
        // Along the distance from the top to the depth h.
        Vector3d foot;
        const Vector3d core = top_[k].value - down[k];
        const double depth = depth_below(core, i * s, j * s, &foot);
        if (depth > 1e-3 * h) down[k] = top_[k].value - (foot + h / depth * (core - foot));
      });
    }
    constexpr double last = 0.35;
    down = smoothed(down, last * smoothing);
    // Smoothing took some of the depth away again: it is restored along the direction.
    Field scaled = down;
    each([&](int i, int j, std::size_t k) {
      const double depth = depth_below(top_[k].value - down[k], i * s, j * s, nullptr);
      scaled[k] *= std::clamp(h / depth, 0.8, 1.25);
    });
    down = std::move(scaled);
  }
  Field core(top_.size(), Vector3d::Zero());
  each([&](int, int, std::size_t k) { core[k] = top_[k].value - down[k]; });
  return core;
}

/// Builds the eroded core from the top surface, sampled more finely than its lattice.
ErodedCore ScannedLayer::eroded() const {
  // The tangents at samples h/8 apart turn by 1/8 at most where normals cross at the depth h; a
  // ridge is met by 1/8² of h or better.
  constexpr int per_step = 4;
  // Farther along the surface than a ball of the radius h touches it on both sides of a ridge.
  constexpr double window = 3;
  const int half = cloth_.half();
  const double s = cloth_.spacing();
  constexpr double longest_diagonal = 1.5;
  ErodedCore core(half, longest_diagonal * s, static_cast<int>(std::ceil(window * thickness_ / s)));
  for (int j = -half; j < half; ++j)
    for (int i = -half; i < half; ++i) {
      if (!cloth_.lies(i, j) || !cloth_.lies(i + 1, j) || !cloth_.lies(i, j + 1) ||
          !cloth_.lies(i + 1, j + 1))
        continue;
      for (int v = 0; v < per_step; ++v)
        for (int u = 0; u < per_step; ++u) {
          const Patch on =
              patch(top_, (i + (u + 0.5) / per_step) * s, (j + (v + 0.5) / per_step) * s);
          core.add(i, j, {on.value, on.by_x.cross(on.by_y).normalized()});
        }
    }
  return core;
}

/// Ways to the nearest places of a body that is eroded deeper do not cross before they are there;
/// where they meet the depth h, they end.
ScannedLayer::Field ScannedLayer::core_by(const Erosion& erosion) const {
  const int half = cloth_.half();
  const double h = thickness_;
  const ErodedCore core = eroded();
  const auto each = [&](const auto& visit) {
    for (int j = -half; j <= half; ++j)
      for (int i = -half; i <= half; ++i)
        if (cloth_.lies(i, j))
          visit(i, j, index(i, j),
                ErodedCore::Sample{cloth_.node(i, j).position, cloth_.node(i, j).normal});
  };
  Field down(top_.size(), Vector3d::Zero());
  std::vector<char> has_way(top_.size(), 0);
  each([&](int i, int j, std::size_t k, const ErodedCore::Sample& top) {
    const auto way = core.way_to((1 + erosion.beyond) * h, top, i, j, 3 * deepest_);
    if (way) down[k] = way->normalized();
    has_way[k] = way.has_value();
  });
  down = smoothed(down, erosion.smoothing * h);
  Field result(top_.size(), Vector3d::Zero());
  each([&](int i, int j, std::size_t k, const ErodedCore::Sample& top) {
    // A cell without a core is no part of the layer.
    result[k].setConstant(std::numeric_limits<double>::quiet_NaN());
    if (!has_way[k]) return;
    down[k].normalize();
    result[k] = top.position - core.length_to(h, top, down[k], i, j, deepest_) * down[k];
  });
  return result;
}

/// Returns the points where the lines from the top through `field` meet the core's surface; not a
/// number where they miss it.
ScannedLayer::Field ScannedLayer::on_core(const SmoothSurface& core, Field field) const {
  const int half = cloth_.half();
  for (int j = -half; j <= half; ++j)
    for (int i = -half; i <= half; ++i) {
      if (!cloth_.lies(i, j)) continue;
      const Vector3d& top = top_[index(i, j)].value;
      Vector3d& at = field[index(i, j)];
      const Vector3d up = (top - at).normalized();
      at.setConstant(std::numeric_limits<double>::quiet_NaN());
      // Finds the nearest point of the core on the line: each step intersects the line with the
      // surface's tangent plane at the last point.
      double depth = thickness_;
      constexpr int iterations = 20;
      for (int iteration = 0; iteration < iterations; ++iteration) {
        const auto on = core.project(top - depth * up, up);
        if (!on || !(on->normal.dot(up) > 0.2) || on->to_sample > 2 * core.spacing()) break;
        const double next = (top - on->position).dot(on->normal) / up.dot(on->normal);
        const bool is_found = std::abs(next - depth) < 1e-4 * thickness_;
        depth = next;
        if (!(depth > 0 && depth < deepest_)) break;
        if (!is_found) continue;
        at = top - depth * up;
        break;
      }
    }
  return field;
}

Vector3d ScannedLayer::position(double x, double y, double z) const {
  return (1 + z) * patch(top_, x, y).value - z * patch(core_, x, y).value;
}

Vector3d ScannedLayer::normal(double x, double y) const {
  const Patch top = patch(top_, x, y);
  return top.by_x.cross(top.by_y).normalized();
}

double ScannedLayer::area_ratio(double x, double y) const {
  const Patch top = patch(top_, x, y);
  return top.by_x.cross(top.by_y).norm();
}

/// Tests each cell of the lattice.
/// @returns how many are valid, each by its worth
double ScannedLayer::find_cells() {
  const int half = cloth_.half();
  const double s = cloth_.spacing();
  cells_.assign(top_.size(), ClothEnd::far);
  double valid = 0;
  for (int j = -half; j < half; ++j)
    for (int i = -half; i < half; ++i) {
      ClothEnd& end = cells_[index(i, j)];
      end = ClothEnd::none;
      for (const auto& [di, dj] :
           {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)})
        if (const ClothEnd of = cloth_.node(i + di, j + dj).end; of != ClothEnd::none)
          end = end == ClothEnd::none ? of : std::max(end, of);
      if (end != ClothEnd::none) continue;
      for (const double v : {0.0, 0.5, 1.0})
        for (const double u : {0.0, 0.5, 1.0}) {
          const Patch top = patch(top_, (i + u) * s, (j + v) * s),
                      core = patch(core_, (i + u) * s, (j + v) * s);
          const Vector3d up = top.value - core.value;
          for (const double z : {0.0, -0.5, -1.0}) {
            const Vector3d by_x = (1 + z) * top.by_x - z * core.by_x,
                           by_y = (1 + z) * top.by_y - z * core.by_y;
            const double volume = by_x.cross(by_y).dot(up);
            const double sides = by_x.norm() * by_y.norm() * up.norm();
            if (!(volume > smallest_jacobian * sides) || !(up.norm() < deepest_) ||
                !(volume > smallest_jacobian * thickness_))
              end = ClothEnd::fold;
          }
          for (const double stretch : {top.by_x.norm(), top.by_y.norm()})
            if (!(stretch > smallest_stretch && stretch < largest_stretch)) end = ClothEnd::fold;
        }
      if (end == ClothEnd::none && is_beyond_edge(i, j)) end = ClothEnd::edge;
      if (end == ClothEnd::none)
        valid += worth_of_cell(std::hypot(i + 0.5, j + 0.5) * s / thickness_);
    }
  return valid;
}

bool ScannedLayer::is_beyond_edge(int i, int j) const {
  return cloth_.node(i, j).is_beyond || cloth_.node(i + 1, j).is_beyond ||
         cloth_.node(i, j + 1).is_beyond || cloth_.node(i + 1, j + 1).is_beyond;
}

/// Islands are no part of the layer.
void ScannedLayer::keep_connected() {
  const int half = cloth_.half();
  std::vector<char> reached(cells_.size(), 0);
  std::vector<std::pair<int, int>> front{{0, 0}, {-1, 0}, {0, -1}, {-1, -1}};
  while (!front.empty()) {
    const auto [i, j] = front.back();
    front.pop_back();
    if (i < -half || j < -half || i >= half || j >= half) continue;
    if (reached[index(i, j)] || cells_[index(i, j)] > ClothEnd::edge) continue;
    reached[index(i, j)] = 1;
    for (const auto& [di, dj] :
         {std::pair(1, 0), std::pair(0, 1), std::pair(-1, 0), std::pair(0, -1)})
      front.emplace_back(i + di, j + dj);
  }
  for (std::size_t k = 0; k < cells_.size(); ++k)
    if (cells_[k] <= ClothEnd::edge && !reached[k]) cells_[k] = ClothEnd::fold;
}

/// A rectangle without a length lies between two rows of cells: there one of them is enough.
ClothEnd ScannedLayer::end_in(double low_x, double high_x, double low_y, double high_y) const {
  const double s = cloth_.spacing();
  const int half = cloth_.half();
  constexpr double round_off = 1e-9;
  struct Cells {
    int first, last;
    bool one_is_enough;
  };
  const auto cells_of = [&](double low, double high) {
    const int first = static_cast<int>(std::floor(low / s + round_off));
    const int last = static_cast<int>(std::ceil(high / s - round_off));
    return last > first ? Cells{first, last, false} : Cells{first - 1, first + 1, true};
  };
  const auto both = [](const Cells& cells, ClothEnd one, ClothEnd other) {
    return cells.one_is_enough ? std::min(one, other) : std::max(one, other);
  };
  const Cells x = cells_of(low_x, high_x), y = cells_of(low_y, high_y);
  const auto cell = [&](int i, int j) {
    const bool inside = i >= -half && j >= -half && i < half && j < half;
    return inside ? cells_[index(i, j)] : ClothEnd::far;
  };
  const auto row = [&](int j) {
    ClothEnd end = cell(x.first, j);
    for (int i = x.first + 1; i < x.last; ++i) end = both(x, end, cell(i, j));
    return end;
  };
  ClothEnd end = row(y.first);
  for (int j = y.first + 1; j < y.last; ++j) end = both(y, end, row(j));
  return end;
}

ScannedLayer::Reach ScannedLayer::reach(double angle_rad) const {
  const double step = cloth_.spacing() / 4, x = std::cos(angle_rad), y = std::sin(angle_rad);
  for (double distance = 0;; distance += step) {
    const ClothEnd end =
        end_in(distance * x, distance * x + 1e-6 * step, distance * y, distance * y + 1e-6 * step);
    if (end != ClothEnd::none) return {distance, end};
  }
}

ScannedLayer::Depths ScannedLayer::depths(double distance) const {
  std::vector<double> found;
  const double s = cloth_.spacing();
  const int half = cloth_.half();
  for (int j = -half; j < half; ++j)
    for (int i = -half; i < half; ++i) {
      if (cells_[index(i, j)] != ClothEnd::none || std::hypot(i + 0.5, j + 0.5) * s > distance)
        continue;
      const double x = (i + 0.5) * s, y = (j + 0.5) * s;
      found.push_back(depth_below(patch(core_, x, y).value, x, y, nullptr) / thickness_);
    }
  if (found.empty()) return {};
  std::sort(found.begin(), found.end());
  const auto at = [&](double share) {
    return found[static_cast<std::size_t>(share * static_cast<double>(found.size() - 1))];
  };
  return {at(0.01), at(0.99)};
}

}  // namespace softfinger::meshes
