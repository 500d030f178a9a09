#include "fem/surface_compliance.h"

#include <array>
#include <cmath>
#include <utility>

namespace softfinger::fem {
namespace {

/// One of the four images of a quarter: itself, mirrored at x = 0, at y = 0, at both.
struct Image {
  bool mirror_x = false, mirror_y = false;
};
constexpr std::array<Image, 4> images{{{false, false}, {true, false}, {false, true}, {true, true}}};
constexpr std::array<Parity, 4> parities{
    {{false, false}, {true, true}, {true, false}, {false, true}}};

/// A point of the contact: an image of a quarter node.
struct Point {
  int index;  ///< among the chosen nodes
  Image image;
};

/// Signs of the displacement components of an image against those of its quarter node.
Eigen::Vector3d signs(Image image, Parity parity) {
  Eigen::Vector3d result = Eigen::Vector3d::Ones();
  if (image.mirror_x) {
    result[0] = -result[0];
    if (parity.odd_x) result = -result;
  }
  if (image.mirror_y) {
    result[1] = -result[1];
    if (parity.odd_y) result = -result;
  }
  return result;
}

}  // namespace

QuarterCompliances quarter_compliances(const LayerModel& model, std::vector<int> nodes,
                                       Invariance fewest) {
  QuarterCompliances result{model, std::move(nodes), {}};
  const std::size_t problems = fewest == Invariance::half_turn ? 2 : 4;
  for (std::size_t problem = 0; problem < problems; ++problem)
    result.by_parity.push_back(model.vector_compliance(parities[problem], result.nodes));
  return result;
}

SurfaceCompliance surface_compliance(const QuarterCompliances& quarters, Invariance invariance,
                                     Blocks blocks) {
  const LayerModel& model = quarters.model;
  const std::vector<int>& nodes = quarters.nodes;
  const bool half_turn = invariance == Invariance::half_turn;
  std::vector<Point> points;
  std::vector<double> share;  // 1 / number of the group's rotations that leave the point in place
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const SurfaceNode& node = model.nodes()[static_cast<std::size_t>(nodes[i])];
    constexpr double on_plane = 1e-9;
    const bool on_x = node.x < on_plane, on_y = node.y < on_plane;
    for (const Image image : images) {
      // A mirror plane's own points have no second image; after a half turn the upper half serves
      // for the lower, and half of the line y = 0 for the other half.
      if ((image.mirror_x && on_x) || (image.mirror_y && on_y)) continue;
      if (half_turn && (image.mirror_y || (image.mirror_x && on_y))) continue;
      points.push_back({static_cast<int>(i), image});
      share.push_back(half_turn && on_x && on_y ? 0.5 : 1.0);
    }
  }

  const auto count = static_cast<Eigen::Index>(points.size());
  SurfaceCompliance result;
  result.copies = half_turn ? 2 : 1;
  result.position.resize(2, count);
  result.area.resize(count);
  result.quarter_node.resize(points.size());
  for (Eigen::Index p = 0; p < count; ++p) {
    const Point& point = points[static_cast<std::size_t>(p)];
    const int quarter = nodes[static_cast<std::size_t>(point.index)];
    const SurfaceNode& node = model.nodes()[static_cast<std::size_t>(quarter)];
    result.quarter_node[static_cast<std::size_t>(p)] = quarter;
    result.position.col(p) << (point.image.mirror_x ? -node.x : node.x),
        (point.image.mirror_y ? -node.y : node.y);
    // The quarter's weight counts a mirror plane's nodes by the part that lies in the quarter.
    const double parts = (node.x < 1e-9 ? 2 : 1) * (node.y < 1e-9 ? 2 : 1);
    result.area[p] = node.weight * parts * share[static_cast<std::size_t>(p)];
  }

  const bool tangential = blocks == Blocks::all;
  if (tangential) result.tangential = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  result.normal = Eigen::MatrixXd::Zero(count, count);
  result.normal_tangential = Eigen::MatrixXd::Zero(count, 2 * count);
  // A force on a point and its copies has in each parity a quarter force of copies / 4 of it.
  const double scale = result.copies / 4.0;
  const std::size_t problems = half_turn ? 2 : 4;
  for (std::size_t problem = 0; problem < problems; ++problem) {
    const Parity parity = parities[problem];
    const Eigen::MatrixXd& quarter = quarters.by_parity[problem];
    for (Eigen::Index q = 0; q < count; ++q) {
      const Point& at = points[static_cast<std::size_t>(q)];
      const Eigen::Vector3d column_sign = scale * signs(at.image, parity);
      for (Eigen::Index p = 0; p < count; ++p) {
        const Point& of = points[static_cast<std::size_t>(p)];
        const Eigen::Matrix3d block = signs(of.image, parity).asDiagonal() *
                                      quarter.block<3, 3>(3 * of.index, 3 * at.index) *
                                      column_sign.asDiagonal();
        if (tangential) result.tangential.block<2, 2>(2 * p, 2 * q) += block.topLeftCorner<2, 2>();
        result.normal(p, q) += block(2, 2);
        result.normal_tangential.block<1, 2>(p, 2 * q) += block.bottomLeftCorner<1, 2>();
      }
    }
  }
  return result;
}

}  // namespace softfinger::fem
