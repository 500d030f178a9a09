#include "comparisons/simulation/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "softfinger/input/constants.h"

namespace softfinger::simulation {
namespace {

using Eigen::Vector3d;
using Segment = TriangleTree::Segment;
using Block = TriangleTree::Block;
using Triangle = std::array<Vector3d, 3>;

constexpr int kInLeaf = 4;

/// The two nearest points of a pair.
struct Points {
  Vector3d first = Vector3d::Zero(), second = Vector3d::Zero();
  double square = std::numeric_limits<double>::infinity();

  void take(const Vector3d& one, const Vector3d& other) {
    const double apart = (one - other).squaredNorm();
    if (!(apart < square)) return;
    first = one;
    second = other;
    square = apart;
  }
};

Vector3d nearest_on(const Segment& segment, const Vector3d& point) {
  const Vector3d along = segment.to - segment.from;
  const double square = along.squaredNorm();
  if (!(square > 0)) return segment.from;
  return segment.from + std::clamp(along.dot(point - segment.from) / square, 0., 1.) * along;
}

/// Decides by the region of the triangle's plane in which the point lies (Ericson, Real-Time
/// Collision Detection, 2005, section 5.1.5).
Vector3d nearest_on(const Triangle& triangle, const Vector3d& point) {
  const auto& [a, b, c] = triangle;
  const Vector3d ab = b - a, ac = c - a, ap = point - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vector3d bp = point - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double of_c = d1 * d4 - d3 * d2;
  if (of_c <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vector3d cp = point - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double of_b = d5 * d2 - d1 * d6;
  if (of_b <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double of_a = d3 * d6 - d5 * d4;
  if (of_a <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double whole = of_a + of_b + of_c;
  // A triangle without area has no inside.
  if (!(whole > 0)) return nearest_on(Segment{a, (b - a).norm() > (c - a).norm() ? b : c}, point);
  return a + of_b / whole * ab + of_c / whole * ac;
}

/// Two segments: each one's line parameter, clamped (Ericson, section 5.1.9).
void take_segments(const Segment& one, const Segment& other, Points& points) {
  const Vector3d d1 = one.to - one.from, d2 = other.to - other.from, r = one.from - other.from;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r);
  if (!(a > 0) || !(e > 0)) return;  // points are taken elsewhere
  const double b = d1.dot(d2), c = d1.dot(r), across = a * e - b * b;
  double s = across > 0 ? std::clamp((b * f - c * e) / across, 0., 1.) : 0;
  double t = (b * s + f) / e;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0., 1.);
    s = std::clamp((b * t - c) / a, 0., 1.);
  }
  points.take(one.from + s * d1, other.from + t * d2);
}

/// Takes the point where a segment goes through a triangle as the nearest one of both.
void take_crossing(const Triangle& triangle, const Segment& segment, Points& points) {
  const Vector3d ab = triangle[1] - triangle[0], ac = triangle[2] - triangle[0];
  const Vector3d normal = ab.cross(ac);
  const double from = normal.dot(segment.from - triangle[0]);
  const double to = normal.dot(segment.to - triangle[0]);
  if (!(from * to < 0)) return;
  const Vector3d at = segment.from + from / (from - to) * (segment.to - segment.from);
  const double square = normal.squaredNorm();
  const double on_c = ab.cross(at - triangle[0]).dot(normal) / square;
  const double on_b = (at - triangle[0]).cross(ac).dot(normal) / square;
  if (on_b >= 0 && on_c >= 0 && on_b + on_c <= 1) points.take(at, at);
}

/// The nearest points of cores and triangles.
class SegmentProbe {
 public:
  explicit SegmentProbe(const Segment& segment)
      : segment_(segment),
        along_(segment.to - segment.from),
        middle_((segment.from + segment.to) / 2),
        half_size_(along_.cwiseAbs() / 2) {
    if (along_.squaredNorm() > 0) along_over_square_ = along_ / along_.squaredNorm();
  }
  /// A bound on the distance of all that lies in a ball and in a box around the same centre: by the
  /// ball, or by the boxes, which are much thinner around a part of a surface and a short segment.
  double least_m(const Vector3d& centre, double radius_m, const Vector3d& half_size_m) const {
    const Vector3d apart = centre - segment_.from;
    const double part = std::clamp(along_over_square_.dot(apart), 0., 1.);
    const Vector3d between = (centre - middle_).cwiseAbs() - half_size_ - half_size_m;
    return std::max((apart - part * along_).norm() - radius_m, between.cwiseMax(0).norm());
  }
  /// @param limit_m  what is farther away need not be found
  Points nearest(const Triangle& triangle, double limit_m) const {
    const Vector3d least = triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]);
    const Vector3d most = triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]);
    const Vector3d half_size = (most - least) / 2;
    Points points;
    if (least_m((least + most) / 2, half_size.norm(), half_size) > limit_m) return points;
    take(triangle, segment_, points);
    return points;
  }
  static void take(const Triangle& triangle, const Segment& segment, Points& points) {
    for (const Vector3d& end : {segment.from, segment.to})
      points.take(nearest_on(triangle, end), end);
    if (segment.from == segment.to) return;
    for (std::size_t k = 0; k < 3; ++k)
      take_segments({triangle[k], triangle[(k + 1) % 3]}, segment, points);
    take_crossing(triangle, segment, points);
  }

 private:
  Segment segment_;
  Vector3d along_, along_over_square_ = Vector3d::Zero();
  Vector3d middle_, half_size_;  ///< of the box around it
};

/// Works in the block's frame.
class BlockProbe {
 public:
  explicit BlockProbe(const Block& block)
      : pose_(block.pose),
        into_(block.pose.inverse(Eigen::Isometry)),
        across_(into_.linear().cwiseAbs()),
        half_(block.half_size_m) {}
  /// A bound by the box, whose extents along the block's axes bound it: the ball around the
  /// triangles of a flat side reaches far beyond it, so that along a face of the block many would
  /// seem near.
  double least_m(const Vector3d& centre, double radius_m, const Vector3d& half_size_m) const {
    const Vector3d apart = (into_ * centre).cwiseAbs() - half_;
    return std::max(apart.cwiseMax(0).norm() - radius_m,
                    (apart - across_ * half_size_m).cwiseMax(0).norm());
  }
  /// See SegmentProbe.
  Points nearest(const Triangle& in_mesh, double limit_m) const {
    Triangle triangle;
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = into_ * in_mesh[k];
    const Vector3d least = triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]);
    const Vector3d most = triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]);
    Points points;
    if ((least - half_).cwiseMax(-half_ - most).cwiseMax(0).squaredNorm() > limit_m * limit_m)
      return points;
    for (std::size_t k = 0; k < 3; ++k) {
      points.take(triangle[k], triangle[k].cwiseMax(-half_).cwiseMin(half_));
      take_entry({triangle[k], triangle[(k + 1) % 3]}, points);
    }
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 4; ++side) {
        Vector3d start = -half_;
        if (side & 1) start[(axis + 1) % 3] *= -1;
        if (side & 2) start[(axis + 2) % 3] *= -1;
        Vector3d end = start;
        end[axis] *= -1;
        // Both boxes lie along the axes. Most edges are farther away than the nearest point.
        const Vector3d apart =
            (least - start.cwiseMax(end)).cwiseMax(start.cwiseMin(end) - most).cwiseMax(0);
        if (apart.squaredNorm() > std::min(points.square, limit_m * limit_m)) continue;
        SegmentProbe::take(triangle, {start, end}, points);
      }
    points.first = pose_ * points.first;
    points.second = pose_ * points.second;
    return points;
  }

 private:
  /// Takes the point where a triangle's edge enters the block as the nearest one of both.
  void take_entry(const Segment& edge, Points& points) const {
    const Vector3d along = edge.to - edge.from;
    double enters = 0, leaves = 1;
    for (int axis = 0; axis < 3; ++axis) {
      if (along[axis] == 0) {
        if (std::abs(edge.from[axis]) > half_[axis]) return;
        continue;
      }
      const double low = (-half_[axis] - edge.from[axis]) / along[axis];
      const double high = (half_[axis] - edge.from[axis]) / along[axis];
      enters = std::max(enters, std::min(low, high));
      leaves = std::min(leaves, std::max(low, high));
    }
    if (enters > leaves) return;
    const Vector3d at = edge.from + enters * along;
    points.take(at, at);
  }

  Eigen::Isometry3d pose_, into_;
  Eigen::Matrix3d across_;  ///< from a box's half size to its extent along the block's axes
  Vector3d half_;
};

}  // namespace

TriangleTree::TriangleTree(const TriangleSurface& surface)
    : surface_(surface), order_(surface.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(surface.triangles.size());
  build(0, int(order_.size()));
  collect_vertices();
}

/// The node of a range of `order_`, halved across the longest side of the box around its triangles.
int TriangleTree::build(int first, int count) {
  Vector3d least = Vector3d::Constant(kInfinity), most = -least;
  for (int i = first; i < first + count; ++i)
    for (int k = 0; k < 3; ++k) {
      least = least.cwiseMin(corner(order_[std::size_t(i)], k));
      most = most.cwiseMax(corner(order_[std::size_t(i)], k));
    }
  const int index = int(nodes_.size());
  Node node;
  node.centre = (least + most) / 2;
  node.half_size_m = (most - least) / 2;
  double square = 0;
  for (int i = first; i < first + count; ++i)
    for (int k = 0; k < 3; ++k)
      square = std::max(square, (corner(order_[std::size_t(i)], k) - node.centre).squaredNorm());
  node.radius_m = std::sqrt(square);
  nodes_.push_back(node);
  if (count <= kInLeaf) {
    nodes_.back().first = first;
    nodes_.back().count = count;
    return index;
  }
  int axis = 0;
  (most - least).maxCoeff(&axis);
  const auto place = [&](int t) {
    return corner(t, 0)[axis] + corner(t, 1)[axis] + corner(t, 2)[axis];
  };
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count,
                   [&](int one, int other) { return place(one) < place(other); });
  const int left = build(first, count / 2);
  const int right = build(first + count / 2, count - count / 2);
  nodes_[std::size_t(index)].left = left;
  nodes_[std::size_t(index)].right = right;
  return index;
}

void TriangleTree::collect_vertices() {
  std::vector<char> taken(surface_.vertices_m.size(), char(false));
  for (Node& node : nodes_) {
    node.first_vertex = int(vertices_m_.size());
    for (int i = node.first; i < node.first + node.count; ++i)
      for (const int vertex : surface_.triangles[std::size_t(order_[std::size_t(i)])])
        if (!std::exchange(taken[std::size_t(vertex)], char(true)))
          vertices_m_.push_back(surface_.vertices_m[std::size_t(vertex)]);
    node.vertex_count = int(vertices_m_.size()) - node.first_vertex;
  }
}

TriangleTree::Nearest TriangleTree::nearest(const Core& core, double limit_m, int guess) const {
  if (const auto* segment = std::get_if<Segment>(&core))
    return search(SegmentProbe(*segment), limit_m, guess);
  return search(BlockProbe(std::get<Block>(core)), limit_m, guess);
}

template <class Probe>
TriangleTree::Nearest TriangleTree::search(const Probe& probe, double limit_m, int guess) const {
  Nearest result;
  result.distance_m = limit_m;
  const auto look_at = [&](int t) {
    const Triangle triangle = {corner(t, 0), corner(t, 1), corner(t, 2)};
    const Points points = probe.nearest(triangle, result.distance_m);
    const double distance_m = std::sqrt(points.square);
    if (!(distance_m < result.distance_m)) return;
    result = {distance_m, points.first, points.second, t};
  };
  const auto least_m = [&](const Node& node) {
    return probe.least_m(node.centre, node.radius_m, node.half_size_m);
  };
  if (guess >= 0 && guess < int(surface_.triangles.size())) look_at(guess);
  struct Waiting {
    int node;
    double least_m;
  };
  // Depth first: one sibling waits per level of a tree of halves.
  std::array<Waiting, 128> waiting;
  int count = 0;
  waiting[std::size_t(count++)] = {0, least_m(nodes_[0])};
  while (count > 0) {
    const Waiting next = waiting[std::size_t(--count)];
    if (next.least_m >= result.distance_m) continue;
    const Node& node = nodes_[std::size_t(next.node)];
    for (int i = node.first; i < node.first + node.count; ++i) {
      const int t = order_[std::size_t(i)];
      if (t != guess) look_at(t);
    }
    if (node.count > 0) continue;
    Waiting near{node.left, least_m(nodes_[std::size_t(node.left)])};
    Waiting far{node.right, least_m(nodes_[std::size_t(node.right)])};
    if (far.least_m < near.least_m) std::swap(near, far);
    if (far.least_m < result.distance_m) waiting[std::size_t(count++)] = far;
    if (near.least_m < result.distance_m) waiting[std::size_t(count++)] = near;
  }
  return result;
}

/// The solid angles of all triangles sum to 4 pi within and to 0 outside (Van Oosterom, Strackee,
/// IEEE Trans. Biomed. Eng. 30, 1983).
bool TriangleTree::contains(const Vector3d& point) const {
  const Node& all = nodes_.front();
  if (((point - all.centre).cwiseAbs() - all.half_size_m).maxCoeff() > 0) return false;
  double sum = 0;
  for (int t = 0; t < int(surface_.triangles.size()); ++t) {
    const Vector3d a = corner(t, 0) - point, b = corner(t, 1) - point, c = corner(t, 2) - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum +=
        std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum > kPi;  // half of the angles' sum of 2 pi, for each is half of a solid angle
}

Vector3d TriangleTree::support(const Vector3d& direction) const {
  // By boxes: balls around the triangles of a flat side reach far beyond it.
  const Vector3d across = direction.cwiseAbs();
  double farthest = -kInfinity;
  Vector3d result = corner(0, 0);
  struct Waiting {
    int node;
    double most;  ///< a bound on how far its vertices reach
  };
  const auto bounded = [&](int node) {
    const Node& box = nodes_[std::size_t(node)];
    return Waiting{node, direction.dot(box.centre) + across.dot(box.half_size_m)};
  };
  std::array<Waiting, 128> waiting;
  int count = 0;
  waiting[std::size_t(count++)] = bounded(0);
  while (count > 0) {
    const Waiting next = waiting[std::size_t(--count)];
    if (next.most <= farthest) continue;
    const Node& node = nodes_[std::size_t(next.node)];
    for (int v = node.first_vertex; v < node.first_vertex + node.vertex_count; ++v) {
      const Vector3d& vertex = vertices_m_[std::size_t(v)];
      const double along = direction.dot(vertex);
      if (along <= farthest) continue;
      farthest = along;
      result = vertex;
    }
    if (node.count > 0) continue;
    Waiting near = bounded(node.left), far = bounded(node.right);
    if (!(near.most > far.most)) std::swap(near, far);
    if (far.most > farthest) waiting[std::size_t(count++)] = far;
    if (near.most > farthest) waiting[std::size_t(count++)] = near;
  }
  return result;
}

Vector3d TriangleTree::normal(int triangle) const {
  return (corner(triangle, 1) - corner(triangle, 0))
      .cross(corner(triangle, 2) - corner(triangle, 0))
      .normalized();
}

TriangleSurface TriangleTree::within(const Vector3d& centre, double radius_m) const {
  std::vector<int> found, waiting = {0};
  while (!waiting.empty()) {
    const Node& node = nodes_[std::size_t(waiting.back())];
    waiting.pop_back();
    if ((node.centre - centre).norm() > node.radius_m + radius_m) continue;
    for (int i = node.first; i < node.first + node.count; ++i) {
      const int t = order_[std::size_t(i)];
      const Vector3d near = nearest_on({corner(t, 0), corner(t, 1), corner(t, 2)}, centre);
      if ((near - centre).norm() <= radius_m) found.push_back(t);
    }
    if (node.count == 0) waiting.insert(waiting.end(), {node.right, node.left});
  }
  std::sort(found.begin(), found.end());  // in the surface's own order
  TriangleSurface result;
  std::unordered_map<int, int> number;
  for (const int t : found) {
    std::array<int, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const int vertex = surface_.triangles[std::size_t(t)][k];
      const auto [entry, added] = number.emplace(vertex, int(result.vertices_m.size()));
      if (added) result.vertices_m.push_back(surface_.vertices_m[std::size_t(vertex)]);
      corners[k] = entry->second;
    }
    result.triangles.push_back(corners);
  }
  return result;
}

}  // namespace softfinger::simulation
