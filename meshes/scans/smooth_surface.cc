#include "meshes/scans/smooth_surface.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <nanoflann.hpp>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

template <int dimension>
using Place = Eigen::Matrix<double, dimension, 1>;

/// Points in a k-d tree.
template <int dimension>
class Neighbours {
 public:
  explicit Neighbours(std::vector<Place<dimension>> points)
      : points_{std::move(points)},
        tree_(dimension, points_, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
    tree_.buildIndex();
  }

  /// The `count` nearest ones, or all if there are fewer. @returns their number
  std::size_t find(const Place<dimension>& at, std::size_t count, std::size_t* index,
                   double* squared_distance) const {
    return tree_.knnSearch(at.data(), count, index, squared_distance);
  }

 private:
  struct Points {
    std::vector<Place<dimension>> at;
    std::size_t kdtree_get_point_count() const { return at.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t c) const {
      return at[i][static_cast<Eigen::Index>(c)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  Points points_;
  nanoflann::KDTreeSingleIndexAdaptor<
      nanoflann::L2_Simple_Adaptor<double, Points, double, std::size_t>, Points, dimension,
      std::size_t>
      tree_;
};

/// f(y) = c + g . y + y . Q y / 2 with y = (p - center)/H.
struct Quadric {
  double value = 0;
  Vector3d gradient = Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
};

struct Sample {
  Vector3d position, normal;
  double area = 0;              ///< that it stands for
  double normal_certainty = 1;  ///< of its normal against its position's
};

/// A facet with its corners' normals.
struct Corners {
  std::array<Vector3d, 3> position, normal;
};

/// Returns the rise of an edge over the tangent plane at one end (`own`), limited to 1.5 times that
/// at the other end (`other`); 0 if they differ in sign. On an arc both are equal. A corner's
/// normal that leans towards smaller facets beside it, as where a cylinder ends in a cap, must not
/// curve a long facet.
double limited_rise(double own, double other) {
  constexpr double most = 1.5;
  if (!(own * other > 0)) return 0;
  return std::copysign(std::min(std::abs(own), most * std::abs(other)), own);
}

/// Point and normal of the PN triangle over barycentric coordinates, with limited edges.
Sample on_pn_triangle(const Corners& corners, const Vector3d& w) {
  const auto& p = corners.position;
  const auto& n = corners.normal;
  const auto edge = [&](int i, int j) -> Vector3d {
    const auto from = static_cast<std::size_t>(i), to = static_cast<std::size_t>(j);
    const Vector3d along = p[to] - p[from];
    return (2 * p[from] + p[to] - limited_rise(along.dot(n[from]), -along.dot(n[to])) * n[from]) /
           3;
  };
  const Vector3d b01 = edge(0, 1), b10 = edge(1, 0), b12 = edge(1, 2), b21 = edge(2, 1),
                 b20 = edge(2, 0), b02 = edge(0, 2);
  const Vector3d mean = (b01 + b10 + b12 + b21 + b20 + b02) / 6;
  const Vector3d middle = mean + (mean - (p[0] + p[1] + p[2]) / 3) / 2;
  const double u = w[0], v = w[1], t = w[2];
  Sample sample;
  sample.position = u * u * u * p[0] + v * v * v * p[1] + t * t * t * p[2] +
                    3 * (u * u * v * b01 + u * v * v * b10 + v * v * t * b12 + v * t * t * b21 +
                         t * t * u * b20 + t * u * u * b02) +
                    6 * u * v * t * middle;
  const Vector3d du = 3 * (u * u * p[0] + 2 * u * v * b01 + v * v * b10 + t * t * b20 +
                           2 * t * u * b02 + 2 * v * t * middle);
  const Vector3d dv = 3 * (v * v * p[1] + u * u * b01 + 2 * u * v * b10 + 2 * v * t * b12 +
                           t * t * b21 + 2 * u * t * middle);
  const Vector3d dt = 3 * (t * t * p[2] + v * v * b12 + 2 * v * t * b21 + 2 * t * u * b20 +
                           u * u * b02 + 2 * u * v * middle);
  sample.normal = (dv - du).cross(dt - du);
  const Vector3d facet = (p[1] - p[0]).cross(p[2] - p[0]);
  // A PN triangle that folds has no use for its own normal.
  if (!(sample.normal.dot(facet) > 0.1 * sample.normal.norm() * facet.norm()))
    sample.normal = facet;
  sample.normal.normalize();
  return sample;
}

struct Cell {
  std::array<int, 4> index;
  bool operator==(const Cell& other) const { return index == other.index; }
};
struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::size_t hash = 0;
    for (const int i : cell.index)
      hash = hash * 1000003u + static_cast<std::size_t>(i + 0x40000000);
    return hash;
  }
};

/// The voxel and the octant of the normal.
Cell voxel_of(const Sample& sample, double size) {
  Cell cell{};
  for (std::size_t c = 0; c < 3; ++c)
    cell.index[c] = static_cast<int>(std::floor(sample.position[static_cast<long>(c)] / size));
  cell.index[3] = (sample.normal.x() > 0 ? 1 : 0) + (sample.normal.y() > 0 ? 2 : 0) +
                  (sample.normal.z() > 0 ? 4 : 0);
  return cell;
}

/// A piece of a sharp edge, as a facet beside it sees it.
struct EdgePiece {
  Vector3d from, to;
  Vector3d outward;  ///< unit, in the facet's plane, across the edge
  Vector3d normal;   ///< the facet's

  Vector3d nearest(const Vector3d& point) const {
    const Vector3d along = to - from;
    const double share = (point - from).dot(along) / along.squaredNorm();
    return from + std::clamp(share, 0.0, 1.0) * along;
  }
};

constexpr std::size_t fit_neighbours = 160, blend_neighbours = 13;
/// Distance, in widths, that a difference of the normals by one radian counts for in the search for
/// neighbours in position and normal.
constexpr double normal_weight = 2.5;

}  // namespace

struct SmoothSurface::Implementation {
  double width = 0, spacing = 0;
  std::vector<Sample> samples;  ///< where quadrics are: one per voxel and octant of the normal
  std::vector<Sample> dense;    ///< what they are fitted to
  std::vector<Quadric> quadrics;
  std::vector<Corners> facets;
  std::vector<EdgePiece> sharp_edges;
  std::unique_ptr<Neighbours<3>> edge_places;
  std::unique_ptr<Neighbours<6>> oriented;

  void collect_facets(const TriangleSurface& surface, const Smoothing& smoothing);
  void choose_width(const Smoothing& smoothing);
  void take_samples();
  void fit_quadrics();
  void keep_ends();
  void order_samples();
  void order_edges();

  /// Returns the edge piece nearest to a point, among those whose normals agree with the point's;
  /// nullptr if there is none.
  const EdgePiece* nearest_edge(const Point& point) const;

  Place<6> oriented_place(const Vector3d& position, const Vector3d& normal) const {
    Place<6> result;
    result << position, normal_weight * width * normal;
    return result;
  }

  /// f and its gradient. @returns squared distance to the nearest sample
  double blend(const Vector3d& at, const Vector3d& normal, double& value,
               Vector3d& gradient) const {
    std::array<std::size_t, blend_neighbours> index;
    std::array<double, blend_neighbours> distance;
    const std::size_t count =
        oriented->find(oriented_place(at, normal), blend_neighbours, index.data(), distance.data());
    // The farthest one has no weight, so that neighbours come and go smoothly.
    const double farthest = distance[count - 1] * (1 + 1e-9) + 1e-300;
    double total = 0, nearest = 1e300;
    value = 0;
    gradient.setZero();
    for (std::size_t k = 0; k < count; ++k) {
      const double share = 1 - distance[k] / farthest;
      const double weight = share * share + 1e-12;
      const Quadric& quadric = quadrics[index[k]];
      const Vector3d from = at - samples[index[k]].position, y = from / width;
      const Vector3d bent = quadric.hessian * y;
      value += weight * width * (quadric.value + quadric.gradient.dot(y) + 0.5 * y.dot(bent));
      gradient += weight * (quadric.gradient + bent);
      total += weight;
      nearest = std::min(nearest, from.squaredNorm());
    }
    value /= total;
    gradient /= total;
    return nearest;
  }
};

void SmoothSurface::Implementation::collect_facets(const TriangleSurface& surface,
                                                   const Smoothing& smoothing) {
  const auto& vertices = surface.vertices_m;
  std::vector<std::size_t> near;
  std::vector<Vector3d> normals(surface.triangles.size(), Vector3d::Zero());
  std::vector<double> areas(surface.triangles.size(), 0);
  std::vector<std::vector<std::size_t>> around(vertices.size());
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto& [i, j, k] = surface.triangles[f];
    const Vector3d &a = vertices[static_cast<std::size_t>(i)],
                   &b = vertices[static_cast<std::size_t>(j)],
                   &c = vertices[static_cast<std::size_t>(k)];
    const Vector3d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const Vector3d apart = low.cwiseMax(-high).cwiseMax(0.0);
    if (apart.norm() > smoothing.within) continue;
    const Vector3d area = (b - a).cross(c - a);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    // A needle's normal is round-off.
    if (!(area.norm() > 1e-6 * longest * longest)) continue;
    normals[f] = area.normalized();
    areas[f] = area.norm() / 2;
    near.push_back(f);
    for (const int corner : surface.triangles[f])
      around[static_cast<std::size_t>(corner)].push_back(f);
  }
  const double cos_crease = std::cos(smoothing.crease_rad);
  for (const std::size_t f : near) {
    Corners corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const int one = surface.triangles[f][c], two = surface.triangles[f][(c + 1) % 3];
      const auto& beside = around[static_cast<std::size_t>(one)];
      const bool goes_on = std::any_of(beside.begin(), beside.end(), [&](std::size_t other) {
        const auto& corner = surface.triangles[other];
        return other != f && std::find(corner.begin(), corner.end(), two) != corner.end() &&
               normals[other].dot(normals[f]) > cos_crease;
      });
      if (goes_on) continue;
      const Vector3d &from = vertices[static_cast<std::size_t>(one)],
                     &to = vertices[static_cast<std::size_t>(two)];
      sharp_edges.push_back({from, to, (to - from).cross(normals[f]).normalized(), normals[f]});
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const auto vertex = static_cast<std::size_t>(surface.triangles[f][c]);
      corners.position[c] = vertices[vertex];
      corners.normal[c].setZero();
      for (const std::size_t other : around[vertex]) {
        if (normals[other].dot(normals[f]) < cos_crease) continue;
        const auto& triangle = surface.triangles[other];
        const std::size_t place = static_cast<std::size_t>(
            std::find(triangle.begin(), triangle.end(), static_cast<int>(vertex)) -
            triangle.begin());
        const Vector3d one =
            vertices[static_cast<std::size_t>(triangle[(place + 1) % 3])] - vertices[vertex];
        const Vector3d two =
            vertices[static_cast<std::size_t>(triangle[(place + 2) % 3])] - vertices[vertex];
        // The surface is straighter where facets are larger: small ones beside a large one must not
        // curve it.
        constexpr double much = 2;
        const double weight = std::min(1.0, much * areas[other] / areas[f]);
        corners.normal[c] +=
            weight * std::atan2(one.cross(two).norm(), one.dot(two)) * normals[other];
      }
      corners.normal[c].normalize();
    }
    facets.push_back(corners);
  }
  if (facets.empty())
    throw InputError("surface", "facets near the contact", "none", "a surface around the contact");
}

/// Chooses the width: at least the median edge near the origin, since facets larger than the width
/// define the surface by their corners alone.
void SmoothSurface::Implementation::choose_width(const Smoothing& smoothing) {
  width = smoothing.width;
  const double near = 4 * smoothing.width;
  std::vector<double> edges;
  for (const Corners& facet : facets)
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector3d &a = facet.position[c], &b = facet.position[(c + 1) % 3];
      if (std::min(a.norm(), b.norm()) < near) edges.push_back((b - a).norm());
    }
  if (edges.empty()) return;
  std::nth_element(edges.begin(), edges.begin() + static_cast<long>(edges.size() / 2), edges.end());
  // Slivers of a CAD export have long edges on surfaces that are known well across them: wider than
  // this, features of a finger would be lost.
  constexpr double widest = 3;
  width = std::clamp(edges[edges.size() / 2], smoothing.width, widest * smoothing.width);
}

void SmoothSurface::Implementation::take_samples() {
  constexpr double density = 0.6;
  spacing = density * width;
  std::unordered_set<Cell, CellHash> taken, taken_dense;
  constexpr int most_steps = 400, densest = 6;
  for (const Corners& facet : facets) {
    double longest = 0;
    for (std::size_t c = 0; c < 3; ++c)
      longest = std::max(longest, (facet.position[(c + 1) % 3] - facet.position[c]).norm());
    const double area = (facet.position[1] - facet.position[0])
                            .cross(facet.position[2] - facet.position[0])
                            .norm() /
                        2;
    const int steps = std::clamp(static_cast<int>(std::ceil(longest / spacing)), 1, most_steps);
    // Points inside the facet: none on the edges, which neighbours share.
    for (int i = 0; i < steps; ++i)
      for (int j = 0; i + j < steps; ++j)
        for (const double shift : {1.0 / 3, 2.0 / 3}) {
          const double u = (i + shift) / steps, v = (j + shift) / steps;
          if (u + v >= 1) continue;
          Sample sample = on_pn_triangle(facet, {1 - u - v, u, v});
          sample.area = area / (steps * steps);
          // Noise of the vertices tilts small facets more than it moves them, against the width.
          sample.normal_certainty = std::min(1.0, std::pow(longest / width, 2));
          if (!taken_dense.insert(voxel_of(sample, spacing / densest)).second) continue;
          dense.push_back(sample);
          if (taken.insert(voxel_of(sample, spacing)).second) samples.push_back(sample);
        }
  }
}

void SmoothSurface::Implementation::order_samples() {
  std::vector<Place<6>> at;
  for (const Sample& sample : samples) at.push_back(oriented_place(sample.position, sample.normal));
  oriented = std::make_unique<Neighbours<6>>(std::move(at));
}

void SmoothSurface::Implementation::fit_quadrics() {
  quadrics.resize(samples.size());
  std::vector<Place<3>> at;
  for (const Sample& sample : dense) at.push_back(sample.position);
  const Neighbours<3> places(std::move(at));
  std::vector<std::size_t> index(fit_neighbours);
  std::vector<double> distance(fit_neighbours);
  // A column for each equation: value and gradient at each neighbour.
  Eigen::Matrix<double, 10, Eigen::Dynamic> equations(10, 4 * fit_neighbours);
  Eigen::VectorXd targets(equations.cols());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t count =
        places.find(samples[i].position, fit_neighbours, index.data(), distance.data());
    Eigen::Index used = 0;
    const auto add = [&](const Eigen::Matrix<double, 10, 1>& equation, double target,
                         double weight) {
      equations.col(used) = std::sqrt(weight) * equation;
      targets[used++] = std::sqrt(weight) * target;
    };
    for (std::size_t k = 0; k < count; ++k) {
      const Sample& other = dense[index[k]];
      const double facing = std::max(0.0, other.normal.dot(samples[i].normal));
      const double weight = std::exp(-distance[k] / (width * width)) * facing * facing *
                            other.area / (spacing * spacing);
      if (!(weight > 1e-12)) continue;
      const Vector3d y = (other.position - samples[i].position) / width;
      Eigen::Matrix<double, 10, 1> row;
      row << 1, y, y.x() * y.x() / 2, y.y() * y.y() / 2, y.z() * y.z() / 2, y.x() * y.y(),
          y.y() * y.z(), y.z() * y.x();
      add(row, 0, weight);
      const double gradient_weight = 0.25 * other.normal_certainty;
      row << 0, 1, 0, 0, y.x(), 0, 0, y.y(), 0, y.z();
      add(row, other.normal.x(), gradient_weight * weight);
      row << 0, 0, 1, 0, 0, y.y(), 0, y.x(), y.z(), 0;
      add(row, other.normal.y(), gradient_weight * weight);
      row << 0, 0, 0, 1, 0, 0, y.z(), 0, y.y(), y.x();
      add(row, other.normal.z(), gradient_weight * weight);
    }
    Eigen::Matrix<double, 10, 10> normal =
        equations.leftCols(used) * equations.leftCols(used).transpose();
    const Eigen::Matrix<double, 10, 1> right = equations.leftCols(used) * targets.head(used);
    // Curvatures that few neighbours leave undetermined become zero.
    normal.diagonal().array() += 1e-9;
    normal.diagonal().tail<6>().array() += 1e-6;
    const Eigen::Matrix<double, 10, 1> c =
        normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    Quadric& quadric = quadrics[i];
    quadric.value = c[0];
    quadric.gradient = c.segment<3>(1);
    quadric.hessian << c[4], c[7], c[9], c[7], c[5], c[8], c[9], c[8], c[6];
  }
}

/// Cuts the edges into short pieces, of which those are kept where the surface ends: behind a step,
/// a seam of the mesh or a needle it goes on.
void SmoothSurface::Implementation::keep_ends() {
  std::vector<EdgePiece> ends;
  for (const EdgePiece& edge : sharp_edges) {
    const double length = (edge.to - edge.from).norm();
    if (!(length > 0)) continue;
    constexpr double most_pieces = 400;
    const int pieces = static_cast<int>(std::ceil(std::min(most_pieces, length / width)));
    for (int i = 0; i < pieces; ++i) {
      EdgePiece piece = edge;
      piece.from = edge.from + (edge.to - edge.from) * i / pieces;
      piece.to = edge.from + (edge.to - edge.from) * (i + 1) / pieces;
      const Vector3d middle = (piece.from + piece.to) / 2;
      constexpr double across = 2.5, beside = 1.3;  // of the samples' spacing
      double value = 0;
      Vector3d gradient;
      const double squared_distance =
          blend(middle + across * spacing * edge.outward, edge.normal, value, gradient);
      if (squared_distance < std::pow(beside * spacing, 2)) continue;
      ends.push_back(piece);
    }
  }
  sharp_edges = std::move(ends);
}

void SmoothSurface::Implementation::order_edges() {
  if (sharp_edges.empty()) return;
  std::vector<Place<3>> middles;
  for (const EdgePiece& piece : sharp_edges) middles.push_back((piece.from + piece.to) / 2);
  edge_places = std::make_unique<Neighbours<3>>(std::move(middles));
}

const EdgePiece* SmoothSurface::Implementation::nearest_edge(const Point& point) const {
  if (!edge_places) return nullptr;
  constexpr std::size_t most = 16;
  std::array<std::size_t, most> index;
  std::array<double, most> distance;
  const std::size_t count = edge_places->find(point.position, most, index.data(), distance.data());
  const EdgePiece* found = nullptr;
  double nearest = 1e300, most_outward = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const EdgePiece& piece = sharp_edges[index[k]];
    constexpr double facing = 0.5;
    if (piece.normal.dot(point.normal) < facing) continue;
    const Vector3d apart = point.position - piece.nearest(point.position);
    const double away = apart.norm(), outward = apart.dot(piece.outward);
    // Beyond a corner both of its edges are equally far: the point is beyond the one that it is
    // more in front of.
    const double same = 1e-6 * width;
    if (away > nearest + same || (away > nearest - same && outward < most_outward)) continue;
    nearest = away;
    most_outward = outward;
    found = &piece;
  }
  return found;
}

std::optional<double> SmoothSurface::beyond_edge(const Point& point) const {
  const EdgePiece* const edge = implementation_->nearest_edge(point);
  if (!edge) return std::nullopt;
  // Distances are measured along the surface: it need not go through the edges of the facets.
  const Vector3d on_edge = edge->nearest(point.position);
  Vector3d apart = point.position - on_edge;
  apart -= apart.dot(point.normal) * point.normal;
  const double outward = apart.dot(edge->outward);
  // Beside the end of an edge nothing ends.
  constexpr double in_front = 0.65;
  if (!(outward > in_front * apart.norm())) return -apart.norm();
  // If samples lie beyond the edge too, the edge belongs to another sheet.
  std::size_t sample = 0;
  double distance = 0;
  implementation_->oriented->find(implementation_->oriented_place(point.position, point.normal), 1,
                                  &sample, &distance);
  constexpr double beyond = 0.1, clearly = 2;
  const Vector3d& facet = implementation_->samples[sample].position;
  if ((facet - on_edge).dot(edge->outward) > beyond * spacing()) return -apart.norm();
  // A point with samples of its own close by is not beyond the edge either: the edge lies deeper,
  // or aside.
  if (outward > clearly * spacing() && distance < spacing() * spacing()) return -apart.norm();
  return outward;
}

std::optional<Vector3d> SmoothSurface::edge_near(const Point& point, double distance) const {
  const EdgePiece* const edge = implementation_->nearest_edge(point);
  if (!edge || (point.position - edge->nearest(point.position)).norm() > distance)
    return std::nullopt;
  return (edge->to - edge->from).normalized();
}

SmoothSurface::SmoothSurface(const TriangleSurface& surface, const Smoothing& smoothing) {
  auto made = std::make_unique<Implementation>();
  made->collect_facets(surface, smoothing);
  made->choose_width(smoothing);
  made->width *= smoothing.widening;
  made->take_samples();
  made->fit_quadrics();
  made->order_samples();
  made->keep_ends();
  made->order_edges();
  implementation_ = std::move(made);
}

SmoothSurface::SmoothSurface(std::unique_ptr<const Implementation> implementation)
    : implementation_(std::move(implementation)) {}

SmoothSurface::SmoothSurface(SmoothSurface&&) noexcept = default;
SmoothSurface::~SmoothSurface() = default;

SmoothSurface SmoothSurface::turned(const Eigen::Quaterniond& turn) const {
  const Eigen::Matrix3d matrix = turn.toRotationMatrix();
  const auto turn_all = [&](auto&... vectors) { ((vectors = matrix * vectors), ...); };
  auto made = std::make_unique<Implementation>();
  made->width = implementation_->width;
  made->spacing = implementation_->spacing;
  made->samples = implementation_->samples;
  made->quadrics = implementation_->quadrics;
  made->facets = implementation_->facets;
  made->sharp_edges = implementation_->sharp_edges;
  for (Sample& sample : made->samples) turn_all(sample.position, sample.normal);
  for (Quadric& quadric : made->quadrics) {
    turn_all(quadric.gradient);
    quadric.hessian = matrix * quadric.hessian * matrix.transpose();
  }
  for (Corners& facet : made->facets)
    for (std::size_t c = 0; c < 3; ++c) turn_all(facet.position[c], facet.normal[c]);
  for (EdgePiece& piece : made->sharp_edges)
    turn_all(piece.from, piece.to, piece.outward, piece.normal);
  made->order_samples();
  made->order_edges();
  return SmoothSurface(std::move(made));
}

double SmoothSurface::width() const { return implementation_->width; }
double SmoothSurface::spacing() const { return implementation_->spacing; }

std::optional<SmoothSurface::Point> SmoothSurface::project(const Vector3d& from,
                                                           const Vector3d& normal) const {
  constexpr int most_steps = 8;
  const double tolerance = 1e-7 * implementation_->width;
  Point point{from, normal, 0};
  for (int step = 0; step < most_steps; ++step) {
    double value = 0;
    Vector3d gradient;
    const double nearest = implementation_->blend(point.position, point.normal, value, gradient);
    const double square = gradient.squaredNorm();
    if (!(square > 0.04)) return std::nullopt;  // far from any sample, or between two sheets
    const Vector3d move = -value / square * gradient;
    if (!move.allFinite() || move.norm() > 8 * implementation_->width) return std::nullopt;
    point.position += move;
    point.normal = gradient / std::sqrt(square);
    point.to_sample = std::sqrt(nearest);
    if (move.norm() < tolerance) return point;
  }
  return point;
}

SmoothSurface::Departure SmoothSurface::departure(const Point& from, double distance) const {
  Departure result;
  double squares = 0;
  for (const Corners& facet : implementation_->facets) {
    const Vector3d centre = (facet.position[0] + facet.position[1] + facet.position[2]) / 3;
    const Vector3d normal = (facet.position[1] - facet.position[0])
                                .cross(facet.position[2] - facet.position[0])
                                .normalized();
    if ((centre - from.position).norm() > distance || normal.dot(from.normal) < 0) continue;
    for (const Vector3d& at : {centre, facet.position[0], facet.position[1], facet.position[2]}) {
      const auto on = project(at, normal);
      if (!on) continue;
      const double apart = (on->position - at).norm();
      squares += apart * apart / 4;
      result.largest = std::max(result.largest, apart);
    }
    ++result.facets;
  }
  if (result.facets > 0) result.rms = std::sqrt(squares / result.facets);
  return result;
}

}  // namespace softfinger::meshes
