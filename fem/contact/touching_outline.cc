#include "fem/contact/touching_outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace softfinger::fem {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Outlines = Outcome<std::vector<Eigen::Matrix2Xd>, OutgrownPatch>;

/// Share of the way from a touching node to an open one at which the edge lies.
double edge_between(double pressure, double clearance, double distance, double modulus) {
  if (!(clearance > 0)) return 1;
  // (p/A)² + (3 E* g / (4 A))^(2/3) = distance falls as A grows.
  const double opening = 0.75 * modulus * clearance;
  const auto reach = [&](double A) {
    return std::pow(pressure / A, 2) + std::pow(opening / A, 2.0 / 3);
  };
  double low = pressure / std::sqrt(distance), high = low;
  while (reach(high) > distance) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (reach(middle) > distance ? low : high) = middle;
  }
  return std::min(1.0, std::pow(pressure / high, 2) / distance);
}

/// A node of one of the images.
struct ImageNode {
  int node = -1;
  Image image;

  bool operator<(const ImageNode& other) const {
    return std::tie(node, image.mirror_y, image.mirror_x) <
           std::tie(other.node, other.image.mirror_y, other.image.mirror_x);
  }
};

class Tracer {
 public:
  explicit Tracer(const TouchingState& state) : state_(state) {}

  Outlines trace() {
    for (const std::array<int, 3>& triangle : state_.triangles)
      cross({{triangle[0], {}}, {triangle[1], {}}, {triangle[2], {}}});
    if (!state_.triangles.empty()) return chain();
    for (int image = 0; image < state_.planes.images(); ++image)
      for (const SurfaceFace& face : state_.faces) add_face(face, state_.planes.image(image));
    return chain();
  }

 private:
  void add_face(const SurfaceFace& face, Image image) {
    for (const std::size_t corner : {0, 1, 3, 4}) cross_square(face, corner, image);
    // Counter-clockwise around the face.
    constexpr std::array<std::array<std::size_t, 3>, 4> sides{
        {{0, 1, 2}, {2, 5, 8}, {8, 7, 6}, {6, 3, 0}}};
    for (const auto& side : sides) {
      if (!std::all_of(side.begin(), side.end(), [&](std::size_t k) {
            return face.node[k] >= 0 &&
                   state_.nodes[static_cast<std::size_t>(face.node[k])].on_edge;
          }))
        continue;
      for (const std::size_t half : {0, 1}) {
        const ImageNode from = node_of(face, side[half], image),
                        to = node_of(face, side[half + 1], image);
        cross({beyond(from), beyond(to), to, from});
      }
    }
  }

  /// The contact ends where the finger does: as if an open node lay at the same place.
  static ImageNode beyond(ImageNode at) { return {-2 - at.node, at.image}; }

  /// The lattice's edge that an outline crosses: from a touching node to an open one.
  using Crossing = std::pair<ImageNode, ImageNode>;

  ImageNode node_of(const SurfaceFace& face, std::size_t k, Image image) const {
    const int node = face.node[k];
    if (node < 0) return {};
    const SurfaceNode& at = state_.nodes[static_cast<std::size_t>(node)];
    constexpr double on_plane = 1e-9;
    // A mirror plane's own nodes have no second image.
    if (std::abs(at.x) < on_plane) image.mirror_x = false;
    if (std::abs(at.y) < on_plane) image.mirror_y = false;
    return {node, image};
  }

  bool touches(ImageNode at) const { return at.node >= 0 && state_.pressure[at.node] > 0; }

  Vector2d place(ImageNode at) const {
    return at.image.signs().head<2>().cwiseProduct(state_.position.col(at.node));
  }

  Vector2d place(const Crossing& crossing) const {
    const Vector2d inside = place(crossing.first);
    if (crossing.second.node < 0) return inside;
    const Vector2d outside = place(crossing.second);
    return inside + edge_between(state_.pressure[crossing.first.node],
                                 state_.clearance[crossing.second.node], (outside - inside).norm(),
                                 state_.modulus) *
                        (outside - inside);
  }

  /// Adds the outline's pieces in a quarter of a face, with what touches on their left.
  void cross_square(const SurfaceFace& face, std::size_t corner, Image image) {
    std::vector<ImageNode> around;
    for (const std::size_t step : {0, 1, 4, 3})
      around.push_back(node_of(face, corner + step, image));
    if (std::any_of(around.begin(), around.end(), [](ImageNode at) { return at.node < 0; })) return;
    // Mirror images run clockwise.
    const Vector2d one = place(around[2]) - place(around[0]),
                   other = place(around[3]) - place(around[1]);
    if (one.x() * other.y() < one.y() * other.x()) std::swap(around[1], around[3]);
    cross(around);
  }

  /// @param around  nodes of a triangle or square, counter-clockwise
  void cross(const std::vector<ImageNode>& around) {
    // Walking around, the outline enters where a touching node is followed by an open one.
    std::vector<Crossing> leaves, enters;
    for (std::size_t i = 0; i < around.size(); ++i) {
      const ImageNode here = around[i], next = around[(i + 1) % around.size()];
      if (touches(here) && !touches(next)) leaves.emplace_back(here, next);
      if (!touches(here) && touches(next)) enters.emplace_back(next, here);
    }
    if (leaves.size() == 2 && touches(around[0])) std::swap(enters[0], enters[1]);
    for (std::size_t i = 0; i < leaves.size(); ++i) next_[leaves[i]] = enters[i];
  }

  Outlines chain() {
    std::vector<Eigen::Matrix2Xd> result;
    while (!next_.empty()) {
      std::vector<Vector2d> points;
      auto at = next_.begin();
      const Crossing start = at->first;
      Crossing to;
      while (at != next_.end()) {
        points.push_back(place(at->first));
        to = at->second;
        next_.erase(at);
        at = next_.find(to);
      }
      if (to < start || start < to)
        return OutgrownPatch{{"outline of the contact", static_cast<int>(points.size()),
                              points.back().norm(), "it leaves the refined patch"}};
      if (points.size() < 3) continue;
      Eigen::Matrix2Xd polygon(2, static_cast<Index>(points.size()));
      for (std::size_t i = 0; i < points.size(); ++i)
        polygon.col(static_cast<Index>(i)) = points[i];
      result.push_back(std::move(polygon));
    }
    return result;
  }

  const TouchingState& state_;
  std::map<Crossing, Crossing> next_;
};

}  // namespace

Outcome<std::vector<Eigen::Matrix2Xd>, OutgrownPatch> touching_outlines(
    const TouchingState& state) {
  return Tracer(state).trace();
}

}  // namespace softfinger::fem
