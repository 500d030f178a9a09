#include "meshes/scans/cloth.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;
const double kMostTurned = std::cos(115 * kPi / 180);
const double kSharpest = std::cos(72 * kPi / 180);

constexpr std::array<std::pair<int, int>, 4> neighbours{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

class Layer {
 public:
  Layer(const SmoothSurface& surface, const SmoothSurface::Point& centre, const Vector3d& x_axis,
        double radius, double spacing)
      : surface_(surface),
        centre_(centre),
        radius_(radius),
        cloth_(static_cast<int>(std::ceil(radius / spacing)) + 1, spacing) {
    Vector3d x = x_axis - x_axis.dot(centre.normal) * centre.normal;
    if (!(x.norm() > 1e-6)) x = centre.normal.unitOrthogonal();
    x.normalize();
    const Vector3d y = centre.normal.cross(x);
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        place(i, j, centre.position + spacing * (i * x + j * y), centre.normal);
    cloth_.node(0, 0).position = centre.position;
    cloth_.node(0, 0).normal = centre.normal;
  }

  Cloth grow() {
    constexpr int between_rings = 2, at_end = 12;
    relax(between_rings);
    while (add_ring()) relax(between_rings);
    relax(at_end);
    return std::move(cloth_);
  }

 private:
  bool is_wanted(int i, int j) const {
    return cloth_.contains(i, j) && std::hypot(i, j) * cloth_.spacing() <= radius_;
  }

  /// @param guess  of the node's place
  void place(int i, int j, const Vector3d& guess, const Vector3d& normal) {
    Cloth::Node& node = cloth_.node(i, j);
    const auto on = surface_.project(guess, normal);
    constexpr double farthest_move = 0.7, farthest_sample = 1.3;
    const bool is_off = !on || on->to_sample > farthest_sample * surface_.spacing();
    if (!on || (is_off && !is_beside_edge(*on))) {
      node.end = ClothEnd::rim;
    } else if (on->normal.dot(centre_.normal) < kMostTurned) {
      node.end = ClothEnd::turned;
    } else if (on->normal.dot(normal) < kSharpest ||
               (on->position - guess).norm() > farthest_move * cloth_.spacing()) {
      node.end = ClothEnd::crease;
    } else {
      node.end = ClothEnd::none;
      node.is_beyond = is_off;
      node.position = on->position;
      node.normal = on->normal;
    }
  }

  /// Whether a cell up to a sharp edge may need a node there, beyond it.
  bool is_beside_edge(const SmoothSurface::Point& point) const {
    const std::optional<double> beyond = surface_.beyond_edge(point);
    constexpr double farthest = 1.5;
    return beyond && std::abs(*beyond) < farthest * cloth_.spacing();
  }

  /// Adds the nodes beside those that lie. @returns whether there were any
  bool add_ring() {
    struct New {
      int i, j;
      Vector3d guess, normal;
    };
    std::vector<New> ring;
    const int half = cloth_.half();
    for (int j = -half; j <= half; ++j)
      for (int i = -half; i <= half; ++i) {
        if (!is_wanted(i, j) || cloth_.node(i, j).end != ClothEnd::far) continue;
        Vector3d guess = Vector3d::Zero(), normal = Vector3d::Zero();
        int count = 0;
        for (const auto& [di, dj] : neighbours) {
          if (!cloth_.lies(i + di, j + dj) || !cloth_.lies(i + 2 * di, j + 2 * dj)) continue;
          const Cloth::Node& next = cloth_.node(i + di, j + dj);
          guess += 2 * next.position - cloth_.node(i + 2 * di, j + 2 * dj).position;
          normal += next.normal;
          ++count;
        }
        if (count > 0) ring.push_back({i, j, guess / count, normal.normalized()});
      }
    bool added = false;
    for (const New& node : ring) {
      place(node.i, node.j, node.guess, node.normal);
      added = added || cloth_.lies(node.i, node.j);
    }
    return added;
  }

  /// Relaxes the cloth as rigidly as possible: turns the lattice at each corner of each cell to fit
  /// its nodes, and finds the nodes whose edges are nearest to those of the turned lattices.
  void relax(int times) {
    number_nodes();
    for (int time = 0; time < times; ++time) {
      std::vector<Eigen::Triplet<double>> entries;
      Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(count_, 3);
      const int half = cloth_.half();
      for (int j = -half; j < half; ++j)
        for (int i = -half; i < half; ++i) {
          if (!cloth_.lies(i, j) || !cloth_.lies(i + 1, j) || !cloth_.lies(i, j + 1) ||
              !cloth_.lies(i + 1, j + 1))
            continue;
          for (const int v : {0, 1})
            for (const int u : {0, 1}) add_corner(i, j, u, v, entries, right);
        }
      // Nodes in no cell stay where they are; the pinned one too.
      constexpr double hold = 1e-7, pin = 1e6;
      for (int j = -half; j <= half; ++j)
        for (int i = -half; i <= half; ++i) {
          if (!cloth_.lies(i, j)) continue;
          const double held = i == 0 && j == 0 ? pin : hold;
          const int row = number(i, j);
          entries.emplace_back(row, row, held);
          right.row(row) += held * cloth_.node(i, j).position.transpose();
        }
      Eigen::SparseMatrix<double> matrix(count_, count_);
      matrix.setFromTriplets(entries.begin(), entries.end());
      if (time == 0) {
        solver_.compute(matrix);
        if (solver_.info() != Eigen::Success) return;
      }
      const Eigen::MatrixX3d relaxed = solver_.solve(right);
      for (int j = -half; j <= half; ++j)
        for (int i = -half; i <= half; ++i) {
          if (!cloth_.lies(i, j) || (i == 0 && j == 0)) continue;
          Cloth::Node& node = cloth_.node(i, j);
          const auto on = surface_.project(relaxed.row(number(i, j)).transpose(), node.normal);
          if (!on || on->normal.dot(node.normal) < kSharpest) continue;
          node.position = on->position;
          node.normal = on->normal;
        }
    }
  }

  /// The corner (u, v) of the cell whose lowest node is (i, j).
  void add_corner(int i, int j, int u, int v, std::vector<Eigen::Triplet<double>>& entries,
                  Eigen::MatrixX3d& right) const {
    const double s = cloth_.spacing();
    const int left = number(i, j + v), right_of = number(i + 1, j + v), low = number(i + u, j),
              high = number(i + u, j + 1);
    const Vector3d along_x = (cloth_.node(i + 1, j + v).position - cloth_.node(i, j + v).position),
                   along_y = (cloth_.node(i + u, j + 1).position - cloth_.node(i + u, j).position);
    const Vector3d& normal = cloth_.node(i + u, j + v).normal;
    const Vector3d x = normal.unitOrthogonal(), y = normal.cross(x);
    const double angle =
        std::atan2(along_x.dot(y) - along_y.dot(x), along_x.dot(x) + along_y.dot(y));
    const Vector3d turned_x = s * (std::cos(angle) * x + std::sin(angle) * y),
                   turned_y = s * (-std::sin(angle) * x + std::cos(angle) * y);
    const auto add = [&](int from, int to, const Vector3d& edge) {
      entries.emplace_back(from, from, 1);
      entries.emplace_back(to, to, 1);
      entries.emplace_back(from, to, -1);
      entries.emplace_back(to, from, -1);
      right.row(to) += edge.transpose();
      right.row(from) -= edge.transpose();
    };
    add(left, right_of, turned_x);
    add(low, high, turned_y);
  }

  void number_nodes() {
    const int half = cloth_.half();
    numbers_.assign(static_cast<std::size_t>((2 * half + 1) * (2 * half + 1)), -1);
    count_ = 0;
    for (int j = -half; j <= half; ++j)
      for (int i = -half; i <= half; ++i)
        if (cloth_.lies(i, j))
          numbers_[static_cast<std::size_t>((i + half) + (2 * half + 1) * (j + half))] = count_++;
  }
  int number(int i, int j) const {
    const int half = cloth_.half();
    return numbers_[static_cast<std::size_t>((i + half) + (2 * half + 1) * (j + half))];
  }

  const SmoothSurface& surface_;
  const SmoothSurface::Point centre_;
  const double radius_;
  Cloth cloth_;
  std::vector<int> numbers_;
  int count_ = 0;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace

Cloth lay_cloth(const SmoothSurface& surface, const SmoothSurface::Point& centre,
                const Vector3d& x_axis, double radius, double spacing) {
  return Layer(surface, centre, x_axis, radius, spacing).grow();
}

}  // namespace softfinger::meshes
