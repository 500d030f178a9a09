#include "softfinger/dynamics/friction_polytope.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace softfinger::internal {
namespace {

constexpr int kCoarseVertices = 6, kMostCoarseFacets = 20;  // of 6 vertices, all triples

}  // namespace

FrictionPolytope::FrictionPolytope(int most_vertices)
    : vertices_(most_vertices, 3), along_(most_vertices) {
  coarse_.reserve(kMostCoarseFacets);
}

void FrictionPolytope::set(const Eigen::Matrix3Xd& vertices) {
  const int count = int(vertices.cols());
  if (count == count_ && vertices_.topRows(count) == vertices.transpose()) return;
  count_ = count;
  vertices_.topRows(count) = vertices.transpose();
  radius_ = count > 0 ? vertices.colwise().norm().maxCoeff() : 0;
  choose_coarse_facets();
}

int FrictionPolytope::beyond(const Eigen::Vector3d& direction, double most) {
  if (count_ <= 0) return -1;
  auto along = along_.head(count_);
  along = direction[0] * vertices_.col(0).head(count_) +
          direction[1] * vertices_.col(1).head(count_) +
          direction[2] * vertices_.col(2).head(count_);
  const double farthest = along.maxCoeff();  // without its index: that is much faster
  if (!(farthest > most)) return -1;
  int index = 0;
  while (along[index] != farthest) ++index;
  return index;
}

/// The simplex method for the least sum of weights with which three vertices make `direction`.
bool FrictionPolytope::find_facet(const Eigen::Vector3d& direction, Facet& facet) {
  constexpr double kRoundOff = 1e-12;
  constexpr int kMostTurns = 32;
  const double size = direction.norm();
  if (!(size > 0)) return false;
  const Eigen::Vector3d ray = direction / size;
  const auto start = std::find_if(coarse_.begin(), coarse_.end(), [&](const CoarseFacet& coarse) {
    return (coarse.inverse * ray).minCoeff() >= -kRoundOff;
  });
  if (start == coarse_.end()) return false;
  facet = start->corners;
  Eigen::Matrix3d inverse = start->inverse, corners;
  for (std::size_t c = 0; c < 3; ++c) corners.col(Eigen::Index(c)) = vertex(facet[c]);
  for (int turn = 0; turn < kMostTurns; ++turn) {
    const Eigen::Vector3d normal = inverse.colwise().sum().transpose();
    const int entering = beyond(normal, 1 + kRoundOff);
    if (entering < 0) return true;
    const Eigen::Vector3d weights = inverse * ray, slope = inverse * vertex(entering);
    int leaving = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 3; ++c) {
      if (slope[c] <= kRoundOff) continue;
      const double ratio = std::max(weights[c], 0.) / slope[c];
      if (ratio >= least) continue;
      leaving = c;
      least = ratio;
    }
    if (leaving < 0) return false;
    facet[std::size_t(leaving)] = entering;
    corners.col(leaving) = vertex(entering);
    inverse = corners.inverse();
  }
  return false;
}

/// The facets of the hull of a few vertices that lie far apart.
void FrictionPolytope::choose_coarse_facets() {
  constexpr double kFlat = 1e-6, kRoundOff = 1e-12;
  coarse_.clear();
  std::array<int, kCoarseVertices> far_apart{};
  const int most = std::min(count_, kCoarseVertices);
  for (int n = 0; n < most; ++n) {
    double best = -1;
    for (int j = 0; n > 0 && j < count_; ++j) {
      double nearest = std::numeric_limits<double>::infinity();
      for (int m = 0; m < n; ++m)
        nearest = std::min(nearest, (vertex(j) - vertex(far_apart[std::size_t(m)])).squaredNorm());
      if (nearest <= best) continue;
      best = nearest;
      far_apart[std::size_t(n)] = j;
    }
  }
  for (int a = 0; a < most; ++a)
    for (int b = a + 1; b < most; ++b)
      for (int c = b + 1; c < most; ++c) {
        const Facet facet = {far_apart[std::size_t(a)], far_apart[std::size_t(b)],
                             far_apart[std::size_t(c)]};
        Eigen::Matrix3d corners;
        for (std::size_t n = 0; n < 3; ++n) corners.col(Eigen::Index(n)) = vertex(facet[n]);
        if (!(std::abs(corners.determinant()) > kFlat)) continue;
        const Eigen::Matrix3d inverse = corners.inverse();
        const Eigen::Vector3d normal = inverse.colwise().sum().transpose();
        bool is_outside = true;
        for (int n = 0; n < most; ++n)
          is_outside &= vertex(far_apart[std::size_t(n)]).dot(normal) <= 1 + kRoundOff;
        if (is_outside) coarse_.push_back({facet, inverse});
      }
}

}  // namespace softfinger::internal
