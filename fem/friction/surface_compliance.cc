#include "fem/friction/surface_compliance.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "fem/algebra/cholesky.h"
#include "fem/base/memory.h"

namespace softfinger::fem {
namespace {

/// A point of the contact: an image of a node.
struct Point {
  int index;  ///< among the chosen nodes
  Image image;
};

/// Parities of the problems, in the order of QuarterCompliances. A field is odd only about a mirror
/// plane.
std::vector<Parity> parities_for(MirrorPlanes planes, Invariance fewest) {
  std::vector<Parity> parities{{false, false}};
  if (fewest == Invariance::mirrors) return parities;
  if (planes.any()) parities.push_back({planes.x, planes.y});
  if (planes.both() && fewest == Invariance::none)
    parities.insert(parities.end(), {{true, false}, {false, true}});
  return parities;
}

/// Signs of the displacement components of an image against those of the node itself.
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

/// Refuses a contact whose compliance does not fit in memory: its blocks (7 matrices of points x
/// points) and the factors that friction computes from them.
void require_memory(std::size_t points) {
  constexpr double matrices = 16;  // of points x points
  const auto count = static_cast<double>(points);
  const double needed_MB = matrices * 8 * count * count / kBytesPerMB;
  const double available_MB = available_memory_MB();
  if (needed_MB <= available_MB) return;
  const auto text = [](double value) { return std::to_string(std::lround(value)); };
  throw NotEnoughMemory("friction", "memory",
                        text(needed_MB) + " MB for " + std::to_string(points) + " contact points",
                        "at most the " + text(available_MB) + " MB available; use a lower level");
}

}  // namespace

std::optional<QuarterCompliances> part_of(const QuarterCompliances& kept,
                                          const std::vector<int>& nodes, Invariance fewest) {
  const std::size_t problems = parities_for(kept.model.planes(), fewest).size();
  if (kept.by_parity.size() < problems ||
      !std::includes(kept.nodes.begin(), kept.nodes.end(), nodes.begin(), nodes.end()))
    return std::nullopt;
  std::vector<Eigen::Index> rows;
  for (const int node : nodes) {
    const auto place = std::lower_bound(kept.nodes.begin(), kept.nodes.end(), node);
    for (int c = 0; c < 3; ++c) rows.push_back(3 * (place - kept.nodes.begin()) + c);
  }
  QuarterCompliances result{kept.model, nodes, {}};
  for (std::size_t problem = 0; problem < problems; ++problem)
    result.by_parity.push_back(kept.by_parity[problem](rows, rows));
  return result;
}

QuarterCompliances quarter_compliances(const LayerModel& model, std::vector<int> nodes,
                                       Invariance fewest) {
  QuarterCompliances result{model, std::move(nodes), {}};
  result.by_parity = model.vector_compliances(parities_for(model.planes(), fewest), result.nodes);
  return result;
}

SurfaceCompliance surface_compliance(const QuarterCompliances& quarters, Invariance invariance,
                                     Blocks blocks) {
  const LayerModel& model = quarters.model;
  const std::vector<int>& nodes = quarters.nodes;
  const MirrorPlanes planes = model.planes();
  const bool half_turn = invariance == Invariance::half_turn;
  const bool mirrors = invariance == Invariance::mirrors;
  constexpr double on_plane = 1e-9;
  const auto is_on_x = [&](const SurfaceNode& node) { return planes.x && node.x < on_plane; };
  const auto is_on_y = [&](const SurfaceNode& node) { return planes.y && node.y < on_plane; };
  std::vector<Point> points;
  std::vector<double> share;  // 1 / number of the group's rotations that leave the point in place
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const SurfaceNode& node = model.nodes()[static_cast<std::size_t>(nodes[i])];
    const bool on_x = is_on_x(node), on_y = is_on_y(node);
    for (int number = 0; number < planes.images(); ++number) {
      const Image image = planes.image(number);
      // A mirror plane's own points have no second image; after a half turn the upper half serves
      // for the lower, and half of the line y = 0 for the other half.
      if ((image.mirror_x && on_x) || (image.mirror_y && on_y)) continue;
      if (mirrors && number > 0) continue;
      if (half_turn && (image.mirror_y || (image.mirror_x && on_y))) continue;
      points.push_back({static_cast<int>(i), image});
      share.push_back(half_turn && on_x && on_y ? 0.5 : 1.0);
    }
  }

  const auto count = static_cast<Eigen::Index>(points.size());
  require_memory(points.size());
  SurfaceCompliance result;
  result.copies = half_turn ? 2 : mirrors ? planes.images() : 1;
  result.position.resize(2, count);
  result.height.resize(count);
  result.in_block.resize(2, count);
  result.area.resize(count);
  result.model_node.resize(points.size());
  result.mirrored.resize(2, count);
  result.images.resize(count);
  Eigen::VectorXd cosine(count);  // of the surface's slope
  for (Eigen::Index p = 0; p < count; ++p) {
    const Point& point = points[static_cast<std::size_t>(p)];
    const int index = nodes[static_cast<std::size_t>(point.index)];
    const SurfaceNode& node = model.nodes()[static_cast<std::size_t>(index)];
    result.model_node[static_cast<std::size_t>(p)] = index;
    const Eigen::Vector2d mirror = point.image.signs().head<2>();
    result.position.col(p) = mirror.cwiseProduct(node.position.head<2>());
    result.height[p] = node.position.z();
    result.in_block.col(p) = mirror.cwiseProduct(Eigen::Vector2d(node.x, node.y));
    cosine[p] = node.normal.z();
    // A node on a mirror plane has half of its weight in what is meshed, on two planes a quarter.
    const double parts = mirrors ? 1 : (is_on_x(node) ? 2 : 1) * (is_on_y(node) ? 2 : 1);
    result.mirrored.col(p) = mirror;
    result.images[p] = parts * share[static_cast<std::size_t>(p)];
    result.area[p] = node.weight * node.area_ratio * cosine[p] * result.images[p];
  }

  const bool tangential = blocks == Blocks::all;
  if (tangential) result.tangential = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  result.normal = Eigen::MatrixXd::Zero(count, count);
  result.normal_tangential = Eigen::MatrixXd::Zero(count, 2 * count);
  // In each parity, a force on a point and its copies is copies / images of it on what is meshed.
  const double scale = static_cast<double>(result.copies) / planes.images();
  const std::vector<Parity> parities = parities_for(planes, invariance);
  for (std::size_t problem = 0; problem < parities.size(); ++problem) {
    const Parity parity = parities[problem];
    const Eigen::MatrixXd& meshed = quarters.by_parity[problem];
    for (Eigen::Index q = 0; q < count; ++q) {
      const Point& at = points[static_cast<std::size_t>(q)];
      const Eigen::Vector3d column_sign = scale * signs(at.image, parity);
      for (Eigen::Index p = 0; p < count; ++p) {
        const Point& of = points[static_cast<std::size_t>(p)];
        const Eigen::Matrix3d block = signs(of.image, parity).asDiagonal() *
                                      meshed.block<3, 3>(3 * of.index, 3 * at.index) *
                                      column_sign.asDiagonal();
        if (tangential) result.tangential.block<2, 2>(2 * p, 2 * q) += block.topLeftCorner<2, 2>();
        result.normal(p, q) += block(2, 2);
        result.normal_tangential.block<1, 2>(p, 2 * q) += block.bottomLeftCorner<1, 2>();
      }
    }
  }
  const auto sinking = cosine.cwiseInverse().asDiagonal();
  result.normal = sinking * result.normal * sinking;
  result.normal_tangential = sinking * result.normal_tangential;
  return result;
}

}  // namespace softfinger::fem
