#include "softfinger/pads/pad_shape.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

/// Borders of the elements between centroid and outline: finer towards the outline, where a thick
/// or compressible pad's U falls to zero.
constexpr std::array<double, 9> kRings = {0, 0.3, 0.52, 0.68, 0.8, 0.88, 0.95, 0.985, 1};
constexpr int kRingNodes = 2 * int(kRings.size()) - 1;
constexpr int kLeastElementsAround = 24;
/// Nodes at 0.95, 0.3, 0.6 and 0.8.
constexpr std::array<int, 4> kProbeRings = {12, 2, 5, 8};
/// k² of the solutions that the modes span, over the inverse square of the outline's size.
constexpr std::array<double, PadShape::kMostModes> kSolved = {0,   1,   4,   12,   36,
                                                              100, 300, 900, 2000, 4096};

double ring_of(int node) {
  return node % 2 == 0 ? kRings[node / 2] : (kRings[node / 2] + kRings[node / 2 + 1]) / 2;
}

/// Quadratic shape functions of an interval at -1 <= t <= 1, nodes -1, 0, 1.
std::array<double, 3> quadratic(double t) { return {t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2}; }
std::array<double, 3> quadratic_slope(double t) { return {t - 0.5, -2 * t, t + 0.5}; }

/// Nodes on the outline, two per element: each side divided evenly, so that vertices end elements.
std::vector<Vector2d> rim_nodes(const std::vector<Vector2d>& vertices, double perimeter) {
  std::vector<Vector2d> nodes;
  const std::size_t count = vertices.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d side = vertices[(i + 1) % count] - vertices[i];
    const int elements =
        std::max(count < kLeastElementsAround / 2 ? 2 : 1,
                 int(std::ceil(kLeastElementsAround * side.norm() / perimeter - 1e-9)));
    for (int j = 0; j < 2 * elements; ++j)
      nodes.push_back(vertices[i] + j / (2.0 * elements) * side);
  }
  return nodes;
}

/// Index of a node: the centroid is 0, then ring after ring; the outline's own come last.
int node_index(int ring, int around, int rim) {
  return ring == 0 ? 0 : 1 + (ring - 1) * rim + around % rim;
}

struct StarElements {
  Eigen::SparseMatrix<double> stiffness, mass;  ///< of the nodes inside
  MatrixXd sources;                             ///< int N s, a column per source
  std::vector<Vector2d> points;
  std::vector<double> areas;
  Eigen::SparseMatrix<double> at_points;  ///< from nodes inside to points
};

/// Quadratic elements between rings and rays. The map is linear along a ray and along a side.
StarElements star_elements(const std::vector<Vector2d>& rim, int inside) {
  constexpr std::array<double, 3> kPlace = {-0.774596669241483, 0, 0.774596669241483};
  constexpr std::array<double, 3> kWeight = {5. / 9, 8. / 9, 5. / 9};
  const int around = int(rim.size());
  std::vector<Eigen::Triplet<double>> stiffness, mass, at_points;
  StarElements result;
  result.sources = MatrixXd::Zero(inside, PadShape::kSources);
  for (std::size_t ring = 0; ring + 1 < kRings.size(); ++ring)
    for (int ray = 0; ray < around; ray += 2) {
      std::array<int, 9> nodes;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          nodes[3 * i + j] = node_index(2 * int(ring) + i, ray + j, around);
      Eigen::Matrix<double, 9, 9> k = Eigen::Matrix<double, 9, 9>::Zero(), m = k;
      const Vector2d &from = rim[ray], &to = rim[(ray + 2) % around];
      for (int p = 0; p < 9; ++p) {
        const double t = kPlace[p / 3], s = kPlace[p % 3];
        const double depth = kRings[ring + 1] - kRings[ring];
        const double rho = kRings[ring] + depth * (1 + t) / 2;
        const Vector2d edge = from + (1 + s) / 2 * (to - from);
        Eigen::Matrix2d jacobian;  // columns: by t, by s
        jacobian << depth / 2 * edge, rho / 2 * (to - from);
        const double area = kWeight[p / 3] * kWeight[p % 3] * jacobian.determinant();
        const Eigen::Matrix2d inverse = jacobian.inverse();
        const auto nt = quadratic(t), ns = quadratic(s), dt = quadratic_slope(t),
                   ds = quadratic_slope(s);
        Eigen::Matrix<double, 9, 1> n;
        Eigen::Matrix<double, 9, 2> slope;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) {
            n(3 * i + j) = nt[i] * ns[j];
            slope.row(3 * i + j) << dt[i] * ns[j], nt[i] * ds[j];
          }
        const Eigen::Matrix<double, 9, 2> gradient = slope * inverse;
        k += area * gradient * gradient.transpose();
        m += area * n * n.transpose();
        const Vector2d point = rho * edge;
        for (int i = 0; i < 9; ++i) {
          if (nodes[i] >= inside) continue;
          result.sources.row(nodes[i]) += area * n(i) * Eigen::RowVector3d(1, point.x(), point.y());
          at_points.emplace_back(int(result.points.size()), nodes[i], n(i));
        }
        result.points.push_back(point);
        result.areas.push_back(area);
      }
      for (int i = 0; i < 9; ++i)
        for (int j = 0; j < 9; ++j)
          if (nodes[i] < inside && nodes[j] < inside) {
            stiffness.emplace_back(nodes[i], nodes[j], k(i, j));
            mass.emplace_back(nodes[i], nodes[j], m(i, j));
          }
    }
  result.stiffness.resize(inside, inside);
  result.stiffness.setFromTriplets(stiffness.begin(), stiffness.end());
  result.mass.resize(inside, inside);
  result.mass.setFromTriplets(mass.begin(), mass.end());
  result.at_points.resize(int(result.points.size()), inside);
  result.at_points.setFromTriplets(at_points.begin(), at_points.end());
  return result;
}

/// Modes that span the given solutions: l_i, and u_i with unit mass as columns.
struct SpannedModes {
  VectorXd stiffness;
  MatrixXd columns;
};

SpannedModes spanned_modes(const StarElements& elements, const MatrixXd& solutions) {
  // Orthonormal in the mass, each twice against rounding; what adds nothing new is dropped.
  MatrixXd basis(solutions.rows(), solutions.cols());
  int count = 0;
  for (int j = 0; j < solutions.cols(); ++j) {
    VectorXd next = solutions.col(j);
    const double before = std::sqrt(next.dot(elements.mass * next));
    for (int twice = 0; twice < 2; ++twice) {
      const VectorXd weighted = elements.mass * next;
      next -= basis.leftCols(count) * (basis.leftCols(count).transpose() * weighted);
    }
    const double left = std::sqrt(next.dot(elements.mass * next));
    if (!(left > 1e-8 * before)) continue;
    basis.col(count++) = next / left;
  }
  const MatrixXd small =
      basis.leftCols(count).transpose() * (elements.stiffness * basis.leftCols(count));
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(small);
  return {solver.eigenvalues(), basis.leftCols(count) * solver.eigenvectors()};
}

}  // namespace

PadShape::PadShape(const ConvexOutline& outline) : outline_(outline) {
  // Everything in units of the outline's size, about the centroid.
  const double size = size_m();
  std::vector<Vector2d> vertices;
  for (const Vector2d& vertex : outline.vertices_m())
    vertices.push_back((vertex - outline.centroid_m()) / size);
  const std::vector<Vector2d> rim = rim_nodes(vertices, outline.perimeter_m() / size);
  const int around = int(rim.size()), inside = 1 + (kRingNodes - 2) * around;
  const StarElements elements = star_elements(rim, inside);

  std::array<MatrixXd, kSources> solutions;
  for (MatrixXd& columns : solutions) columns.resize(inside, kMostModes);
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
  solver.analyzePattern(elements.stiffness);
  for (int j = 0; j < kMostModes; ++j) {
    solver.factorize(elements.stiffness + kSolved[j] * elements.mass);
    const MatrixXd solved = solver.solve(elements.sources);
    for (int s = 0; s < kSources; ++s) solutions[s].col(j) = solved.col(s);
  }

  const double area = std::accumulate(elements.areas.begin(), elements.areas.end(), 0.0);
  samples_.areas_m2.reserve(elements.areas.size());
  for (std::size_t i = 0; i < elements.points.size(); ++i) {
    samples_.points_m.push_back(size * elements.points[i]);
    samples_.areas_m2.push_back(outline.area_m2() / area * elements.areas[i]);
  }
  for (const Vector2d& node : rim) rim_m_.push_back(size * node);

  // Probes lie on nodes.
  std::array<int, kProbes> probe_nodes{};
  probes_m_[0].setZero();
  for (int i = 0; i < 4 * kProbeRays; ++i) {
    const int ring = kProbeRings[std::size_t(i / kProbeRays)];
    const int ray = i % kProbeRays * around / kProbeRays;
    probe_nodes[std::size_t(1 + i)] = node_index(ring, ray, around);
    probes_m_[std::size_t(1 + i)] = size * ring_of(ring) * rim[std::size_t(ray)];
  }

  VectorXd x(elements.points.size()), y = x, r = x, weight = x;
  for (int i = 0; i < x.size(); ++i) {
    x(i) = elements.points[i].x();
    y(i) = elements.points[i].y();
    r(i) = elements.points[i].norm();
    weight(i) = elements.areas[i];
  }
  for (int s = 0; s < kSources; ++s) {
    const SpannedModes modes = spanned_modes(elements, solutions[s]);
    const VectorXd load = modes.columns.transpose() * elements.sources.col(s);
    // c_i u_i at nodes, in SI: U is as large as size² times the source.
    const double scale = s == constant ? 1 : size;
    node_modes_[s] = MatrixXd::Zero(inside, kMostModes);
    for (int i = 0; i < modes.stiffness.size(); ++i)
      node_modes_[s].col(i) = scale * load(i) * modes.columns.col(i);
    samples_.modes[s] = elements.at_points * node_modes_[s];

    Sums& sums = sums_[s];
    const auto row = [&](const VectorXd& of, double unit) {
      Row weights;
      const VectorXd sum = samples_.modes[s].transpose() * weight.cwiseProduct(of);
      for (int i = 0; i < kMostModes; ++i) weights[i] = unit * sum(i);
      return weights;
    };
    sums.stiffness_per_m2.fill(1 / (size * size));
    for (int i = 0; i < modes.stiffness.size(); ++i)
      sums.stiffness_per_m2[i] = modes.stiffness(i) / (size * size);
    const double area_unit = size * size;
    sums.integral = row(VectorXd::Ones(x.size()), area_unit);
    sums.moment_x = row(x, size * area_unit);
    sums.moment_y = row(y, size * area_unit);
    sums.radius = row(r, size * area_unit);
    sums.radius_by_x = row(x.cwiseQuotient(r), area_unit);
    sums.radius_by_y = row(y.cwiseQuotient(r), area_unit);
    for (int i = 0; i < kMostModes; ++i)
      for (int p = 0; p < kProbes; ++p) sums.at_probe[p][i] = node_modes_[s](probe_nodes[p], i);
  }
  radius_integral_m3_ = outline.radius_integral_m3(outline.centroid_m());
  const double area_m2 = size * size;
  radius_by_point_m2_ =
      area_m2 * Vector2d(weight.dot(x.cwiseQuotient(r)), weight.dot(y.cwiseQuotient(r)));
  for (int i = 0; i < kMostModes; ++i)
    torsion_constant_m4_ += 4 * sums_[constant].integral[i] / sums_[constant].stiffness_per_m2[i];
}

void PadShape::at(const Vector2d& point_m, std::array<Row, kSources>& rows) const noexcept {
  for (Row& row : rows) row.fill(0);
  const Vector2d point = point_m - outline_.centroid_m();
  const int around = int(rim_m_.size()), inside = int(node_modes_[constant].rows());
  for (int ray = 0; ray < around; ray += 2) {
    const Vector2d &from = rim_m_[ray], &to = rim_m_[(ray + 2) % around];
    const double whole = from.x() * to.y() - from.y() * to.x();
    // point = rho (from + share side): shares of the triangle centroid, from, to.
    const double to_share = (from.x() * point.y() - from.y() * point.x()) / whole;
    const double from_share = (point.x() * to.y() - point.y() * to.x()) / whole;
    const double rho = to_share + from_share;
    constexpr double kRounding = 1e-12;
    if (to_share < -kRounding || from_share < -kRounding || rho > 1 + kRounding) continue;
    const double share = rho > 0 ? to_share / rho : 0.5;
    std::size_t ring = 0;
    while (ring + 2 < kRings.size() && rho > kRings[ring + 1]) ++ring;
    const auto nt = quadratic(2 * (rho - kRings[ring]) / (kRings[ring + 1] - kRings[ring]) - 1);
    const auto ns = quadratic(2 * share - 1);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int node = node_index(2 * int(ring) + i, ray + j, around);
        if (node >= inside) continue;
        for (int s = 0; s < kSources; ++s)
          for (int mode = 0; mode < kMostModes; ++mode)
            rows[s][mode] += nt[i] * ns[j] * node_modes_[s](node, mode);
      }
    return;
  }
}

}  // namespace softfinger
