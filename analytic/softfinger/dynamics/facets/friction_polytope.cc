#include "softfinger/dynamics/facets/friction_polytope.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "softfinger/dynamics/contacts/repeatable_random.h"

namespace softfinger::internal {
namespace {

/// Products are made for so many vertices at a time, for the sake of vector instructions. The last
/// vertex is repeated to fill a block.
constexpr int kBlock = 8;
using Block = Eigen::Array<double, kBlock, 1>;

int whole_blocks(int vertices) { return (vertices + kBlock - 1) / kBlock * kBlock; }

Block along(const Eigen::MatrixX3d& vertices, int first, const Eigen::Vector3d& direction) {
  const auto part = [&](int axis) { return Block::Map(&vertices(first, axis)); };
  return direction[0] * part(0) + direction[1] * part(1) + direction[2] * part(2);
}

constexpr int kCoarseVertices = 6, kMostCoarseFacets = 20;  // of 6 vertices, all triples
constexpr double kPlaneRoundOff = 1e-12;

}  // namespace

FrictionPolytope::FrictionPolytope(int most_vertices)
    : vertices_(whole_blocks(most_vertices), 3),
      moved_(whole_blocks(most_vertices), 3),
      along_(whole_blocks(most_vertices)),
      coarse_(kMostCoarseFacets) {
  // A hull of n points has at most 2 n - 4 facets, and all may lie in the cone of one coarse facet.
  for (CoarseFacet& coarse : coarse_) coarse.found.reserve(std::size_t(2 * most_vertices));
}

void FrictionPolytope::set(const Eigen::Matrix3Xd& vertices) {
  const int count = int(vertices.cols());
  if (count == count_ && vertices_.topRows(count) == vertices.transpose()) return;
  count_ = count;
  vertices_.topRows(count) = vertices.transpose();
  for (int j = count; count > 0 && j < whole_blocks(count); ++j)
    vertices_.row(j) = vertices_.row(count - 1);
  for (int j = 0; j < whole_blocks(count); ++j)
    moved_.row(j) =
        (1 - kMoved * hash_to_unit(0, std::uint64_t(std::min(j, count - 1)))) * vertices_.row(j);
  radius_ = count > 0 ? vertices.colwise().norm().maxCoeff() : 0;
  choose_coarse_facets();
}

double FrictionPolytope::farthest(const Eigen::Vector3d& direction) const {
  Block farthest_of = Block::Constant(-std::numeric_limits<double>::infinity());
  for (int first = 0; first < count_; first += kBlock)
    farthest_of = farthest_of.max(along(vertices_, first, direction));
  return farthest_of.maxCoeff();
}

int FrictionPolytope::beyond(const Vertices& vertices, const Eigen::Vector3d& direction,
                             double most) {
  if (count_ <= 0) return -1;
  Block farthest_of = Block::Constant(-std::numeric_limits<double>::infinity());
  for (int first = 0; first < count_; first += kBlock) {
    const Block part = along(vertices, first, direction);
    Block::Map(&along_[first]) = part;
    farthest_of = farthest_of.max(part);
  }
  const double farthest = farthest_of.maxCoeff();  // without its index: that is much faster
  if (!(farthest > most)) return -1;
  int index = 0;
  while (along_[index] != farthest) ++index;
  return index;
}

bool FrictionPolytope::find_facet(const Eigen::Vector3d& direction, Facet& facet) {
  const double size = direction.norm();
  if (!(size > 0)) return false;
  // Moved a little: exactly along an edge or a vertex the search would cycle.
  const Eigen::Vector3d ray = direction / size + kMoved * Eigen::Vector3d(0.33, 0.77, -0.54);
  const auto end = coarse_.begin() + coarse_count_;
  const auto coarse = std::find_if(coarse_.begin(), end, [&](const CoarseFacet& other) {
    return other.cone.least_weight(ray) >= -kPlaneRoundOff;
  });
  if (coarse == end) return false;
  // A ray this close to an edge is searched for anew: a known facet might not be the one that the
  // search would find.
  constexpr double kInside = 1e-9;
  for (const Cone& known : coarse->found) {
    if (!(known.least_weight(ray) > kInside)) continue;
    facet = known.corners;
    return true;
  }
  Cone cone = coarse->cone;
  if (!search(cone, ray)) return false;
  facet = cone.corners;
  if (cone.least_weight(ray) > kInside && coarse->found.size() < coarse->found.capacity())
    coarse->found.push_back(cone);
  return true;
}

/// Moves from a cone of vertices around `ray` to that of the facet that the ray meets. This is a
/// linear programme, solved by the simplex method: write `ray` as a sum of vertices with weights >=
/// 0 whose sum is least.
bool FrictionPolytope::search(Cone& cone, const Eigen::Vector3d& ray) {
  constexpr int kMostTurns = 32;
  Eigen::Matrix3d corners;
  for (std::size_t c = 0; c < 3; ++c) corners.col(Eigen::Index(c)) = moved(cone.corners[c]);
  for (int turn = 0; turn < kMostTurns; ++turn) {
    const Eigen::Vector3d normal = cone.inverse.colwise().sum().transpose();
    const int entering = beyond(moved_, normal, 1 + kPlaneRoundOff);
    if (entering < 0) return true;
    const Eigen::Vector3d weights = cone.inverse * ray, slope = cone.inverse * moved(entering);
    int leaving = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 3; ++c) {
      if (slope[c] <= kPlaneRoundOff) continue;
      const double ratio = std::max(weights[c], 0.) / slope[c];
      if (ratio >= least) continue;
      leaving = c;
      least = ratio;
    }
    if (leaving < 0) return false;
    cone.corners[std::size_t(leaving)] = entering;
    corners.col(leaving) = moved(entering);
    cone.inverse = corners.inverse();
  }
  return false;
}

/// Takes a few vertices far from each other and finds the facets of their hull by trying all
/// triples.
void FrictionPolytope::choose_coarse_facets() {
  constexpr double kFlat = 1e-6;
  coarse_count_ = 0;
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
        for (std::size_t n = 0; n < 3; ++n) corners.col(Eigen::Index(n)) = moved(facet[n]);
        if (!(std::abs(corners.determinant()) > kFlat)) continue;
        const Eigen::Matrix3d inverse = corners.inverse();
        const Eigen::Vector3d normal = inverse.colwise().sum().transpose();
        bool is_outside = true;
        for (int n = 0; n < most; ++n)
          is_outside &= moved(far_apart[std::size_t(n)]).dot(normal) <= 1 + kPlaneRoundOff;
        if (!is_outside) continue;
        CoarseFacet& coarse = coarse_[std::size_t(coarse_count_++)];
        coarse.cone = {facet, inverse};
        coarse.found.clear();
      }
}

}  // namespace softfinger::internal
