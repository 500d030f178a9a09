#include "softfinger/geometry/quadric_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include "softfinger/geometry/quadric_fit_internal.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/math/dense_solvers.h"

namespace softfinger {
namespace {

using Eigen::Vector3d;

constexpr int kUnknowns = 6;  // A, B, C, two tilts, offset
// Quantile of the normal distribution: a value lies within it with probability sqrt(0.95), and two
// independent ones both do with 0.95.
constexpr double kCoverageQuantile = 2.236;
constexpr double kFinestDigit = 1e-9;  // no mesh file carries more of the region's radius

double radius_from_curvature(double curvature, double flat_below) {
  return std::abs(curvature) <= flat_below ? kInfinity : 1 / curvature;
}

double principal_axis(const Quadric& q) {
  const double difference = q.B_per_m - q.A_per_m;
  const double size = std::max({std::abs(q.A_per_m), std::abs(q.B_per_m), std::abs(q.C_per_m)});
  if (std::hypot(difference, q.C_per_m) <= 1e-14 * size) return 0;  // umbilic: any direction
  const double axis = std::atan2(-q.C_per_m, difference) / 2;
  return axis <= -kPi / 2 ? axis + kPi : axis;
}

using Coefficients = Eigen::Matrix<double, kUnknowns, 1>;

constexpr int kMonomials = 10;  // of three coordinates, up to degree 2
using Monomials = Eigen::Matrix<double, Eigen::Dynamic, kMonomials>;

/// x², y², xy, x, y, 1 per point, in a frame, lengths over `scale`.
Eigen::MatrixXd quadric_columns(const Eigen::Matrix3d& frame, const Eigen::Matrix3Xd& points,
                                double scale) {
  const Eigen::Matrix<double, 2, Eigen::Dynamic> local =
      frame.leftCols<2>().transpose() * points / scale;
  Eigen::MatrixXd columns(points.cols(), kUnknowns);
  columns.col(0) = local.row(0).array().square();
  columns.col(1) = local.row(1).array().square();
  columns.col(2) = local.row(0).array() * local.row(1).array();
  columns.col(3) = local.row(0);
  columns.col(4) = local.row(1);
  columns.col(5).setOnes();
  return columns;
}

/// Least squares with columns of unit length. The pivots then measure only how well the points are
/// placed.
internal::LeastSquaresSolution scaled_least_squares(Eigen::MatrixXd columns,
                                                    const Eigen::VectorXd& right) {
  // Points on a conic (two lines, a circle) fit infinitely many quadrics. Coordinates from STL
  // files carry seven digits: for such points the pivot that should vanish is near 1e-7, not 1e-16.
  constexpr double kThreshold = 1e-5;
  Coefficients norms;
  for (int k = 0; k < kUnknowns; ++k) {
    norms[k] = std::max(columns.col(k).norm(), std::numeric_limits<double>::min());
    columns.col(k) /= norms[k];
  }
  internal::LeastSquaresSolution found = internal::least_squares(columns, right, kThreshold);
  for (int k = 0; k < kUnknowns; ++k) found.solution(k, 0) /= norms[k];
  return found;
}

/// The facets of a region and what a quadric looks like on them.
///
/// Facets are chords: between its vertices a convex surface lies above them. They are therefore
/// compared with the facets that the quadric would have between the same vertices. What is left is
/// noise without bias, however coarse the mesh. But a large facet can also mean that the surface
/// itself is flat there. The share of chords says how the facets are read: 1, as chords; 0, as the
/// surface itself.
class Facets {
 public:
  Facets(const internal::SurfaceRegion& region, const Eigen::Matrix3Xd& vertices, double scale)
      : region_(region), vertices_(vertices), scale_(scale) {
    const auto n = region.weights_m2.size();
    points_.resize(3, n);
    interpolate();
  }

  const Eigen::Matrix3Xd& vertices() const { return vertices_; }
  const Eigen::Matrix3Xd& points() const { return points_; }
  const internal::SurfaceRegion& region() const { return region_; }
  double scale() const { return scale_; }

  /// Share of the region's area in facets longer than the region's radius.
  double long_share() const {
    double area = 0;
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      double longest = 0;
      for (int corner = 0; corner < 3; ++corner) {
        const Vector3d edge = vertices_.col(region_.corners(corner, i)) -
                              vertices_.col(region_.corners((corner + 1) % 3, i));
        longest = std::max(longest, edge.norm() / scale_);
      }
      if (longest > 1) area += region_.weights_m2[i];
    }
    return area / region_.weights_m2.sum();
  }

  void take_as_chords(double share) { chord_share_ = share; }
  void move(Eigen::Index vertex, const Vector3d& by) {
    vertices_.col(vertex) += by;
    interpolate();
  }

  /// x², y², xy, x, y, 1 of the vertices.
  Eigen::MatrixXd vertex_terms(const Eigen::Matrix3d& frame) const {
    return quadric_columns(frame, vertices_, scale_);
  }
  /// Returns the same terms at the samples: a blend of the exact ones and of those interpolated
  /// linearly on the facet, the latter weighted by `chord_share_`.
  Eigen::MatrixXd terms(const Eigen::Matrix3d& frame) const {
    // Plain loops: this is where the time goes, also in a build without optimisation.
    const Eigen::MatrixXd of_vertices = vertex_terms(frame);
    Eigen::MatrixXd result = quadric_columns(frame, points_, scale_);
    const Eigen::Index rows = result.rows(), vertices = of_vertices.rows();
    const int* corners = region_.corners.data();
    const double* shares = region_.barycentric.data();
    // The interpolation of x, y and 1 changes nothing.
    for (int column = 0; column < 3; ++column) {
      const double* vertex = of_vertices.data() + column * vertices;
      double* term = result.data() + column * rows;
      for (Eigen::Index i = 0; i < 3 * rows; i += 3, ++term) {
        const double chord = shares[i] * vertex[corners[i]] +
                             shares[i + 1] * vertex[corners[i + 1]] +
                             shares[i + 2] * vertex[corners[i + 2]];
        *term += chord_share_ * (chord - *term);
      }
    }
    return result;
  }
  Eigen::VectorXd depths(const Eigen::Matrix3d& frame) const {
    return -(frame.col(2).transpose() * points_ / scale_).transpose();
  }
  Eigen::VectorXd vertex_depths(const Eigen::Matrix3d& frame) const {
    return -(frame.col(2).transpose() * vertices_ / scale_).transpose();
  }

  /// X², Y², Z², XY, XZ, YZ, X, Y, Z, 1 per sample, in the mesh's axes, the products interpolated
  /// as `terms` are.
  Monomials monomials() const {
    Monomials result(points_.cols(), kMonomials);
    const auto products = [](const Vector3d& p) {
      Eigen::Matrix<double, 1, 6> row;
      row << p.x() * p.x(), p.y() * p.y(), p.z() * p.z(), p.x() * p.y(), p.x() * p.z(),
          p.y() * p.z();
      return row;
    };
    Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor> of_vertices(vertices_.cols(), 6);
    for (Eigen::Index v = 0; v < vertices_.cols(); ++v)
      of_vertices.row(v) = products(vertices_.col(v) / scale_);
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      const Vector3d point = points_.col(i) / scale_;
      const Eigen::Matrix<double, 1, 6> own = products(point);
      Eigen::Matrix<double, 1, 6> chord = Eigen::Matrix<double, 1, 6>::Zero();
      for (int corner = 0; corner < 3; ++corner)
        chord += region_.barycentric(corner, i) * of_vertices.row(region_.corners(corner, i));
      result.row(i) << own + chord_share_ * (chord - own), point.transpose(), 1;
    }
    return result;
  }

 private:
  void interpolate() {
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      points_.col(i).setZero();
      for (int corner = 0; corner < 3; ++corner)
        points_.col(i) +=
            region_.barycentric(corner, i) * vertices_.col(region_.corners(corner, i));
    }
  }

  const internal::SurfaceRegion& region_;
  Eigen::Matrix3Xd vertices_, points_;
  double scale_;
  double chord_share_ = 1;
};

/// The least-squares problem of a region, reduced once to ten rows that hold in every frame: terms
/// and depths in a frame are combinations of the monomials, and the triangular factor R of
/// weights^1/2 monomials = Q R contains all that is needed of these. As accurate as the problem
/// itself.
class ReducedProblem {
 public:
  explicit ReducedProblem(const Facets& facets) {
    // In blocks that stay in the fastest memory, each below the factor of all before it.
    constexpr Eigen::Index kBlock = 256;
    Monomials monomials = facets.monomials();
    monomials.array().colwise() *= facets.region().weights_m2.array().sqrt();
    factor_.setZero();
    for (Eigen::Index first = 0; first < monomials.rows(); first += kBlock)
      add(monomials.middleRows(first, std::min(kBlock, monomials.rows() - first)));
  }

  Coefficients solve(const Eigen::Matrix3d& frame) const {
    const Vector3d x = frame.col(0), y = frame.col(1);
    Eigen::Matrix<double, kMonomials, kUnknowns> terms;
    terms.setZero();
    const auto product = [](const Vector3d& u, const Vector3d& v) {
      Eigen::Matrix<double, 6, 1> of_monomials;
      of_monomials << u.x() * v.x(), u.y() * v.y(), u.z() * v.z(), u.x() * v.y() + u.y() * v.x(),
          u.x() * v.z() + u.z() * v.x(), u.y() * v.z() + u.z() * v.y();
      return of_monomials;
    };
    terms.col(0).head<6>() = product(x, x);
    terms.col(1).head<6>() = product(y, y);
    terms.col(2).head<6>() = product(x, y);
    terms.col(3).segment<3>(6) = x;
    terms.col(4).segment<3>(6) = y;
    terms(kMonomials - 1, 5) = 1;
    const Eigen::Matrix<double, kMonomials, kUnknowns> columns = factor_ * terms;
    const Eigen::Matrix<double, kMonomials, 1> depths = -(factor_.middleCols<3>(6) * frame.col(2));
    return scaled_least_squares(columns, depths).solution.col(0);
  }

 private:
  /// One Householder reflection per column. Its vector has one entry in the factor, which is
  /// triangular, and those of the rows to be added.
  void add(Eigen::Ref<Monomials> rows) {
    for (int k = 0; k < kMonomials; ++k) {
      auto vector = rows.col(k);
      const double square = vector.squaredNorm();
      if (!(square > 0)) continue;
      const double norm = std::sqrt(square + factor_(k, k) * factor_(k, k));
      const double reflected = factor_(k, k) > 0 ? -norm : norm;
      const double head = factor_(k, k) - reflected;
      const double twice_over_square = 2 / (square + head * head);
      factor_(k, k) = reflected;
      for (int j = k + 1; j < kMonomials; ++j) {
        auto column = rows.col(j);
        const double along = twice_over_square * (head * factor_(k, j) + vector.dot(column));
        factor_(k, j) -= along * head;
        column -= along * vector;
      }
    }
  }

  Eigen::Matrix<double, kMonomials, kMonomials> factor_;
};

/// The normal for which the fitted tilts vanish, and the coefficients in its frame.
struct TangentFit {
  Vector3d normal;
  Eigen::Matrix3d frame;
  Coefficients coefficients;
};

TangentFit fit_tangent(const Facets& facets, const Vector3d& first_normal) {
  const ReducedProblem problem(facets);
  TangentFit fit;
  fit.normal = first_normal;
  double tilt = kInfinity, previous = kInfinity, step = 1;
  Vector3d last_turn = Vector3d::Zero();
  const int max_iterations = 100;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    fit.frame = surface_axes(fit.normal);
    fit.coefficients = problem.solve(fit.frame);
    const Eigen::Vector2d tilts = fit.coefficients.segment<2>(3);
    tilt = tilts.norm();
    // Below 1e-8 an iteration that has stopped shrinking has arrived at round-off.
    const bool arrived = tilt < 1e-14 || (tilt < 1e-8 && tilt >= 0.5 * previous);
    if (arrived) return fit;
    const Vector3d turn = fit.frame.leftCols<2>() * tilts;
    // Half steps where full ones do not contract: the frame then follows a strongly curved region.
    // Otherwise the last step shows by which one the tilt would have vanished.
    const double left = last_turn.dot(turn) / last_turn.squaredNorm();
    step = tilt > 0.5 * previous && tilt >= 1e-8 ? 0.5
           : std::isfinite(left)                 ? std::clamp(step / (1 - left), 0.5, 1.5)
                                                 : 1.0;
    last_turn = turn;
    previous = tilt;
    fit.normal = (fit.normal + step * turn).normalized();
  }
  throw ConvergenceError("quadric fit", max_iterations, tilt,
                         "the region is too strongly curved for one quadric: choose a smaller "
                         "radius");
}

/// Statistics of the vertices' residuals, lengths over the region's radius. The fit is linear in
/// the vertices' depths z: coefficients = gain z.
struct Residuals {
  Eigen::VectorXd of_vertices;
  /// Variance of each residual for vertices of independent errors of unit variance: below 1 where
  /// the fit follows the vertex.
  Eigen::VectorXd variances;
  Eigen::VectorXd areas;  ///< of the region that belongs to each vertex
  Eigen::MatrixXd gain;
  int freedom = 0;
  double degrees = 0;   ///< of freedom of the variance, fewer than `freedom` for unequal influence
  double variance = 0;  ///< of the vertices' errors
};

Eigen::VectorXd vertex_residuals(const Facets& facets, const TangentFit& fit,
                                 const Eigen::VectorXd& areas) {
  Eigen::VectorXd result =
      facets.vertex_depths(fit.frame) - facets.vertex_terms(fit.frame) * fit.coefficients;
  // If the facets are taken as the surface itself, all vertices of a curved surface lie above the
  // fit by its sagitta.
  result.array() -= areas.dot(result) / areas.sum();
  return result;
}

Residuals residuals(const Facets& facets, const TangentFit& fit, int outliers) {
  using Matrix6 = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  using Columns6 = Eigen::Matrix<double, kUnknowns, Eigen::Dynamic>;
  Residuals r;
  const auto& region = facets.region();
  const Columns6 terms = facets.terms(fit.frame).transpose();
  const Eigen::MatrixXd vertex_terms = facets.vertex_terms(fit.frame);
  const Eigen::Index n = vertex_terms.rows();
  Matrix6 h = Matrix6::Zero();
  Columns6 sums = Columns6::Zero(kUnknowns, n);
  r.areas = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < terms.cols(); ++i) {
    const Coefficients weighted = region.weights_m2[i] * terms.col(i);
    h.noalias() += weighted * terms.col(i).transpose();
    for (int corner = 0; corner < 3; ++corner) {
      const double share = region.weights_m2[i] * region.barycentric(corner, i);
      sums.col(region.corners(corner, i)) += region.barycentric(corner, i) * weighted;
      r.areas[region.corners(corner, i)] += share;
    }
  }
  r.gain = internal::solve_semidefinite(h, sums);
  r.of_vertices = vertex_residuals(facets, fit, r.areas);
  const Matrix6 spread = r.gain * r.gain.transpose();
  r.variances.resize(n);
  double squares = 0, expected = 0, expected_squares = 0;
  r.freedom = -kUnknowns - outliers;
  for (Eigen::Index v = 0; v < n; ++v) {
    const double leverage = vertex_terms.row(v).dot(r.gain.col(v));
    r.variances[v] =
        1 - 2 * leverage + vertex_terms.row(v) * spread * vertex_terms.row(v).transpose();
    if (!(r.areas[v] > 0)) continue;
    ++r.freedom;
    // Weighted by influence, since the errors of vertices near the rim matter most to the
    // curvatures.
    const double influence = r.gain.col(v).head<3>().squaredNorm();
    squares += influence * r.of_vertices[v] * r.of_vertices[v];
    expected += influence * r.variances[v];
    expected_squares += std::pow(influence * r.variances[v], 2);
  }
  r.degrees = std::min<double>(r.freedom, expected * expected / expected_squares);
  r.variance = squares / expected + kFinestDigit * kFinestDigit;
  return r;
}

/// Student's quantile over the normal one, for `nu` degrees of freedom (Abramowitz & Stegun,
/// 26.7.5).
double student_factor(double nu) {
  const double z = kCoverageQuantile;
  const double z2 = z * z, z4 = z2 * z2, z6 = z4 * z2;
  return 1 + (z2 + 1) / (4 * nu) + (5 * z4 + 16 * z2 + 3) / (96 * nu * nu) +
         (3 * z6 + 19 * z4 + 17 * z2 - 15) / (384 * nu * nu * nu);
}

/// Covariance of (A, B, C), lengths over the region's radius, for independent errors of the
/// vertices, widened by Student's factor: two standard deviations then cover the stated
/// share of cases also where the size of the errors is known from few vertices only.
Eigen::Matrix3d covariance(const Residuals& r) {
  if (r.freedom < 1) return Eigen::Matrix3d::Constant(kInfinity);
  const double student = kCoverageQuantile * student_factor(r.degrees);
  const Eigen::Matrix<double, 3, Eigen::Dynamic> gain = r.gain.topRows<3>();
  return student * student / 4 * r.variance * gain * gain.transpose();
}

constexpr int kHigher = 9;  // x³, x²y, xy², y³, x⁴, x³y, x²y², xy³, y⁴
using Higher = Eigen::Matrix<double, kHigher, 1>;
using HigherColumns = Eigen::Matrix<double, Eigen::Dynamic, kHigher>;

/// The terms of third and fourth order per point, in a frame, lengths over `scale`.
HigherColumns higher_columns(const Eigen::Matrix3d& frame, const Eigen::Matrix3Xd& points,
                             double scale) {
  HigherColumns columns(points.cols(), kHigher);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector2d at = frame.leftCols<2>().transpose() * points.col(i) / scale;
    const double x = at.x(), y = at.y(), xx = x * x, xy = x * y, yy = y * y;
    columns.row(i) << xx * x, xx * y, xy * y, yy * y, xx * xx, xx * xy, xx * yy, xy * yy, yy * yy;
  }
  return columns;
}

/// A surface's terms of third and fourth order near a point, and what they do to a quadric's
/// coefficients that were fitted without them. Lengths over the region's radius.
struct HigherOrders {
  Coefficients change = Coefficients::Zero();  ///< to be added to the quadric's coefficients
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of the corrected A, B, C
};

/// Depths that are expected of a surface beyond its quadric. With x'Kx = k r² and x'K²x = k² r²,
/// the depth r²k / (1 + (1 - fullness k² r²)^1/2) is a circle for a fullness of 1, as in the
/// principal sections of a sphere, a torus and a cylinder, a parabola for 0, and an ellipse
/// otherwise. Of third and fourth order a circle is expected, of more what the fullness says.
struct Expectation {
  Eigen::VectorXd depths;  ///< below the quadric, at the given points
  Eigen::VectorXd beyond;  ///< the part of it that is of more than fourth order
};

Expectation expectation(const Coefficients& quadric, double fullness, const Eigen::Matrix3d& frame,
                        const Eigen::Matrix3Xd& points, double scale) {
  Expectation expected;
  Eigen::Matrix2d curvature;
  curvature << 2 * quadric[0], quadric[2], quadric[2], 2 * quadric[1];
  const Eigen::Index n = points.cols();
  expected.depths.resize(n);
  expected.beyond.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector2d at = frame.leftCols<2>().transpose() * points.col(i) / scale;
    const Eigen::Vector2d slope = curvature * at;
    constexpr double kFarthest = 0.99;  // no circle reaches farther than its radius
    const double twice = at.dot(slope), square = slope.squaredNorm();
    const double full = fullness * square;
    expected.beyond[i] =
        twice * (1 / (1 + std::sqrt(1 - std::min(full, kFarthest))) - 0.5 - full / 8);
    expected.depths[i] = twice * square / 8 + expected.beyond[i];
  }
  return expected;
}

/// Fourth-order terms of `expectation` for a fullness of 1, x'Kx x'K²x / 8.
Higher circle_terms(const Coefficients& quadric) {
  const double a = 2 * quadric[0], b = quadric[2], d = 2 * quadric[1];
  const double p = a * a + b * b, q = b * (a + d), s = b * b + d * d;
  Higher terms;
  terms << 0, 0, 0, 0, a * p, 2 * (a * q + b * p), a * s + 4 * b * q + d * p, 2 * (b * s + d * q),
      d * s;
  return terms / 8;
}

/// Usual differences of the terms of third and fourth order from what is expected: as where
/// the curvature changes by itself within a third of its radius, and as a circle from its parabola.
Higher usual_departure(const Coefficients& quadric) {
  const auto k = internal::principal_curvatures_per_m({quadric[0], quadric[1], quadric[2]});
  const double largest = std::max(std::abs(k[0]), std::abs(k[1]));
  const double third = largest * largest / 2, fourth = largest * largest * largest / 8;
  // The squares are binomials: the same in all directions.
  const double root3 = std::sqrt(3.0), root6 = std::sqrt(6.0);
  Higher departure;
  departure << third, root3 * third, root3 * third, third, fourth, 2 * fourth, root6 * fourth,
      2 * fourth, fourth;
  return departure;
}

/// The misfit of the vertices in the directions that the terms can explain, and the rest.
struct Evidence {
  Higher eigenvalues, squares;  ///< `squares`: of the misfit, along each direction
  double rest = 0;              ///< square of what no term explains
  int freedom = 0;              ///< of the vertices beyond the quadric

  /// Minus twice the logarithm of the likelihood of the misfit, for vertices of independent errors
  /// and terms that scatter `width` times as expected.
  double cost(double variance, double width2) const {
    double product = 1, sum = 0;
    int explained = 0;
    for (int i = 0; i < kHigher; ++i) {
      if (!(eigenvalues[i] > 0)) continue;
      const double expected = variance + width2 * eigenvalues[i];
      product *= expected / variance;
      sum += squares[i] / expected;
      ++explained;
    }
    return std::log(product) + freedom * std::log(variance) + sum + rest / variance;
  }
};

/// Ratio of the variance of a mean of the vertices' residuals to that of as many independent ones.
/// A surface that no terms of fourth order follow, as on a seam where its curvature jumps, leaves
/// waves that neighbours share: there are no more independent residuals than waves, however fine
/// the mesh.
double waviness(const Facets& facets, const Eigen::VectorXd& left_over,
                const Eigen::VectorXd& weights) {
  const auto& region = facets.region();
  double together = 0, squares = 0;
  for (Eigen::Index i = 0; i < region.weights_m2.size(); ++i) {
    // Samples of one facet follow each other.
    if (i > 0 && region.corners.col(i) == region.corners.col(i - 1)) continue;
    for (int k = 0; k < 3; ++k) {
      const int v = region.corners(k, i), w = region.corners((k + 1) % 3, i);
      const double weight = std::sqrt(weights[v] * weights[w]);
      together += weight * left_over[v] * left_over[w];
      squares += weight * (left_over[v] * left_over[v] + left_over[w] * left_over[w]) / 2;
    }
  }
  constexpr double kUsual = 0.3;  // from there on it is no chance
  constexpr double kWaves = 2;    // a seam between two curvatures leaves as few across a region
  const double correlation = squares > 0 ? together / squares : 0;
  const double wavy = std::clamp((correlation - kUsual) / (1 - kUsual), 0.0, 1.0);
  return 1 + wavy * std::max(0.0, double((weights.array() > 0).count()) / kWaves - 1);
}

/// Estimates the terms of higher order from the residuals that the quadric leaves at the vertices
/// and takes their part out of its coefficients. How far the terms may scatter about what is
/// expected of them, and how large the vertices' errors are, is chosen such that the residuals are
/// most likely (empirical Bayes): many exact vertices determine the terms, few or noisy ones leave
/// them as expected, and the covariance says how much is left open.
/// @param rounding  standard deviation of the coordinates' last digit
HigherOrders higher_orders(const Facets& facets, const TangentFit& fit, const Residuals& r,
                           double rounding) {
  using Columns6 = Eigen::Matrix<double, kUnknowns, kHigher>;
  using Square = Eigen::Matrix<double, kHigher, kHigher>;
  HigherOrders result;
  const Eigen::MatrixXd terms = facets.vertex_terms(fit.frame);
  const HigherColumns higher = higher_columns(fit.frame, facets.vertices(), facets.scale());
  const Columns6 shift = r.gain * higher;  // of the coefficients by each term
  const HigherColumns unexplained = higher - terms * shift;
  const Eigen::VectorXd weights = r.areas * (double((r.areas.array() > 0).count()) / r.areas.sum());
  const double floor = kFinestDigit * kFinestDigit;

  const HigherColumns weighted = weights.asDiagonal() * unexplained;
  const Square normal = weighted.transpose() * unexplained;
  Coefficients quadric = fit.coefficients, departed = Coefficients::Zero();
  Higher deviation;
  Square gain_core = Square::Zero(), open_core = Square::Zero();
  Expectation expected;
  Eigen::VectorXd left_over;
  double variance = floor, width2 = 1, degrees = r.degrees, fullness = 1;
  // Few vertices do not tell noise from terms: the likeliest variance is often none at all.
  double mean_variance = floor;
  Coefficients turn = Coefficients::Zero(), last_turn = turn;
  double step = 1;
  // First with circles alone, from which the rest starts nearer.
  constexpr int kCircleRounds = 4, kMostRounds = 25;
  for (int round = 0; round < kMostRounds; ++round) {
    expected = expectation(quadric, fullness, fit.frame, facets.vertices(), facets.scale());
    deviation = usual_departure(quadric);
    const Coefficients expected_shift = r.gain * expected.depths;
    const Eigen::VectorXd misfit = r.of_vertices - expected.depths + terms * expected_shift;
    const Higher right = deviation.asDiagonal() * (weighted.transpose() * misfit);
    const Eigen::SelfAdjointEigenSolver<Square> eigen(
        Square(deviation.asDiagonal() * normal * deviation.asDiagonal()));
    const Higher along = eigen.eigenvectors().transpose() * right;
    Evidence evidence;
    evidence.freedom = std::max(1, r.freedom);
    evidence.rest = misfit.cwiseAbs2().dot(weights);
    // The terms of a surface so curved grow without end: nothing is known of its apex.
    constexpr double kRunsAway = 20;
    const double of_fit = fit.coefficients.head<3>().norm();
    if (!std::isfinite(evidence.rest) || !(quadric.head<3>().norm() <= kRunsAway * of_fit)) {
      result.change.setZero();
      result.covariance.setConstant(kInfinity);
      return result;
    }
    const double largest = std::max(2 * evidence.rest / evidence.freedom, 4 * floor);
    const double none = 1e-12 * std::max(eigen.eigenvalues()[kHigher - 1], 0.0);
    for (int i = 0; i < kHigher; ++i) {
      const bool seen = eigen.eigenvalues()[i] > none && kHigher - i <= r.freedom;
      evidence.eigenvalues[i] = seen ? eigen.eigenvalues()[i] : 0;
      evidence.squares[i] = seen ? along[i] * along[i] / evidence.eigenvalues[i] : 0;
      evidence.rest -= evidence.squares[i];
    }
    evidence.rest = std::max(evidence.rest, 0.0);
    double best = kInfinity, all = 0, all_variances = 0;
    for (double width = 1; width < 50; width *= 3)
      for (double trial = floor; trial <= largest; trial *= 2.5) {
        // Wider scatter has to pay for itself.
        const double cost = evidence.cost(trial, width * width) + 2 * std::log(width);
        if (cost < best) {
          const double before = std::exp((cost - best) / 2);
          all *= before;
          all_variances *= before;
          best = cost;
          variance = trial;
          width2 = width * width;
        }
        const double likelihood = std::exp((best - cost) / 2);
        all += likelihood;
        all_variances += likelihood * trial;
      }
    mean_variance = all_variances / all;
    Higher shrunk, left;
    degrees = r.freedom;
    for (int i = 0; i < kHigher; ++i) {
      const double expected_size = variance + width2 * evidence.eigenvalues[i];
      shrunk[i] = evidence.eigenvalues[i] > 0 ? width2 / expected_size : 0;
      const double share = shrunk[i] * evidence.eigenvalues[i];
      left[i] = width2 * (1 - share) * (1 - share);
      degrees -= share;
    }
    const Square& u = eigen.eigenvectors();
    gain_core = u * shrunk.asDiagonal() * u.transpose();
    open_core = u * left.asDiagonal() * u.transpose();
    const Higher departure = deviation.asDiagonal() * gain_core * right;
    left_over = misfit - unexplained * departure;
    result.change = -expected_shift - shift * departure;
    // An ellipse of this fullness is what the surface is like beyond the fourth order, too.
    const Higher circle = circle_terms(quadric);
    const Higher squared_inverse = deviation.cwiseAbs2().cwiseInverse();
    const double size = circle.tail<5>().cwiseAbs2().dot(squared_inverse.tail<5>());
    const double fuller =
        circle.tail<5>().cwiseProduct(departure.tail<5>()).dot(squared_inverse.tail<5>()) / size;
    if (round >= kCircleRounds)
      fullness = std::isfinite(fuller) ? std::clamp(1 + fuller, 0.0, 4.0) : 1;
    departed = -shift * (departure - (fullness - 1) * circle);
    // The terms change the quadric, which changes what is expected of them. The last step tells by
    // which one the two would have agreed.
    turn = fit.coefficients + result.change - quadric;
    constexpr double kArrived = 1e-13;
    if (round > kCircleRounds && turn.head<3>().norm() <= kArrived * quadric.head<3>().norm())
      break;
    const double kept = last_turn.dot(turn) / last_turn.squaredNorm();
    step = std::isfinite(kept) && round != kCircleRounds + 1
               ? std::clamp(step / (1 - kept), 0.3, 1.2)
               : 1.0;
    last_turn = turn;
    quadric += step * turn;
  }
  if (r.freedom < 1) {
    result.covariance.setConstant(kInfinity);
    return result;
  }
  // The corrected coefficients per depth of each vertex.
  const Columns6 per_term = shift * deviation.asDiagonal();
  const Eigen::Matrix<double, kUnknowns, Eigen::Dynamic> by_residual =
      per_term * gain_core * deviation.asDiagonal() * weighted.transpose();
  const Eigen::MatrixXd gain = r.gain - by_residual + (by_residual * terms).eval() * r.gain;
  const double factor = student_factor(std::max(1.0, std::min(degrees, r.degrees)));
  const Eigen::Matrix<double, 3, Eigen::Dynamic> first = gain.topRows<3>();
  const Eigen::Matrix<double, 3, kHigher> open = per_term.topRows<3>();
  // Terms beyond the fourth order are known as far as the fullness is.
  const double unknown = std::sqrt(open_core.trace() / (kHigher * width2));
  constexpr double kSeries = 0.1;
  const Vector3d cut_off = std::max(kSeries, unknown) * (first * expected.beyond);
  // It shows in no residual where whole rings of vertices are rounded alike, as around a pole.
  variance = std::max({variance, mean_variance, rounding * rounding});
  const Vector3d unsettled = turn.head<3>();  // few vertices may leave it turning
  const Vector3d unlike = kSeries * departed.head<3>();
  result.covariance = kCoverageQuantile * kCoverageQuantile / 4 *
                      (factor * factor * variance * waviness(facets, left_over, weights) * first *
                           first.transpose() +
                       open * open_core * open.transpose() + cut_off * cut_off.transpose() +
                       unlike * unlike.transpose() + unsettled * unsettled.transpose());
  return result;
}

/// Terms of higher order where facets are read as the surface itself, whose vertices tell nothing
/// of what is between them: the terms are what is expected of them.
HigherOrders expected_orders(const Facets& facets, const TangentFit& fit, const Residuals& r) {
  using Matrix6 = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  using Columns6 = Eigen::Matrix<double, kUnknowns, kHigher>;
  const Eigen::MatrixXd terms = facets.terms(fit.frame);
  const HigherColumns higher = higher_columns(fit.frame, facets.points(), facets.scale());
  const auto weighted = facets.region().weights_m2.asDiagonal() * terms;
  const Matrix6 normal = terms.transpose() * weighted;
  const Columns6 shift =
      internal::solve_semidefinite(normal, Eigen::MatrixXd((weighted).transpose() * higher));
  HigherOrders result;
  result.covariance = covariance(r);
  Coefficients quadric = fit.coefficients;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::VectorXd depths =
        expectation(quadric, 1, fit.frame, facets.points(), facets.scale()).depths;
    const Eigen::VectorXd right = weighted.transpose() * depths;
    result.change = -internal::solve_semidefinite(normal, Eigen::MatrixXd(right));
    quadric = fit.coefficients + result.change;
  }
  const Eigen::Matrix<double, 3, kHigher> open =
      shift.topRows<3>() * usual_departure(quadric).asDiagonal();
  result.covariance += kCoverageQuantile * kCoverageQuantile / 4 * open * open.transpose();
  return result;
}

/// A quadric in the frame of its own tangent plane.
struct Apex {
  Coefficients coefficients;  ///< without tilts
  Vector3d normal;
  Eigen::Matrix3d frame;
};

/// The curvature, at the foot of the given point, of a surface whose quadric has a tilt: in the
/// tangent plane there. Lengths over the region's radius.
Apex apex_of(const TangentFit& fit, const Coefficients& c) {
  const double dx = c[3], dy = c[4];
  Apex apex;
  apex.normal = (fit.frame * Vector3d(dx, dy, 1)).normalized();
  apex.frame = surface_axes(apex.normal);
  // Second fundamental form in the directions (1, 0, -dx), (0, 1, -dy), over the slope.
  const double slope = std::sqrt(1 + dx * dx + dy * dy);
  Eigen::Matrix2d form;
  form << 2 * c[0], c[2], c[2], 2 * c[1];
  const Eigen::Matrix2d axes = (fit.frame.transpose() * apex.frame).topLeftCorner<2, 2>();
  const Eigen::Matrix2d curvature = axes.transpose() * form * axes / slope;
  apex.coefficients << curvature(0, 0) / 2, curvature(1, 1) / 2, curvature(0, 1), 0, 0,
      c[5] / slope;
  return apex;
}

/// Estimate of the share of chords: the kinks between facets over those between the facets of the
/// fitted quadric, by least squares. Large facets have the largest weight, as their sagittas have
/// in the fit. 1 for the mesh of a quadric; less where facets are large because the surface is
/// flat.
double kink_ratio(const Facets& facets, const TangentFit& fit) {
  const auto& region = facets.region();
  const Eigen::Matrix2Xd xy =
      fit.frame.leftCols<2>().transpose() * facets.vertices() / facets.scale();
  const Eigen::VectorXd model = facets.vertex_terms(fit.frame) * fit.coefficients;
  const Eigen::VectorXd depths = facets.vertex_depths(fit.frame);
  struct Facet {
    Eigen::Vector3i corners;
    double area;
    Eigen::Matrix<double, 2, 3> gradient;  ///< of a function given by its values at the corners
  };
  std::vector<Facet> list;
  std::map<std::pair<int, int>, std::size_t> first_at;
  Eigen::VectorXd functional = Eigen::VectorXd::Zero(xy.cols());
  double weight_sum = 0;
  for (Eigen::Index i = 0; i < region.weights_m2.size(); ++i) {
    // Samples of one facet follow each other.
    if (i > 0 && region.corners.col(i) == region.corners.col(i - 1)) continue;
    Facet facet;
    facet.corners = region.corners.col(i);
    Eigen::Matrix2d edges;
    for (int k = 0; k < 2; ++k)
      edges.col(k) = xy.col(facet.corners[k + 1]) - xy.col(facet.corners[0]);
    facet.area = std::abs(edges.determinant()) / 2;
    if (!(facet.area > 1e-12 * edges.squaredNorm())) continue;
    facet.gradient.rightCols<2>() = edges.transpose().inverse();
    facet.gradient.col(0) = -facet.gradient.rightCols<2>().rowwise().sum();
    for (int k = 0; k < 3; ++k) {
      const int v = facet.corners[k], w = facet.corners[(k + 1) % 3];
      const auto [entry, added] = first_at.emplace(std::minmax(v, w), list.size());
      if (added) continue;
      const Facet& other = list[entry->second];
      const Eigen::Vector2d edge = xy.col(w) - xy.col(v);
      const double length = edge.norm();
      const Eigen::Vector2d across(edge.y() / length, -edge.x() / length);
      double kink = 0;
      for (int c = 0; c < 3; ++c) {
        kink += across.dot(facet.gradient.col(c)) * model[facet.corners[c]];
        kink -= across.dot(other.gradient.col(c)) * model[other.corners[c]];
      }
      const double height = 2 * facet.area / length, other_height = 2 * other.area / length;
      const double both = height + other_height;
      // A flat sliver's kink is mostly noise.
      const double weight = length * both * std::pow(height * other_height / both, 2) * kink;
      for (int c = 0; c < 3; ++c) {
        functional[facet.corners[c]] += weight * across.dot(facet.gradient.col(c));
        functional[other.corners[c]] -= weight * across.dot(other.gradient.col(c));
      }
      weight_sum += weight * kink;
    }
    list.push_back(facet);
  }
  return weight_sum > 0 ? functional.dot(depths) / weight_sum : 1;
}

/// The share of chords to fit with, between 0 and 1.
double chord_share(const Facets& facets, const TangentFit& fit) {
  const auto ramp = [](double from_0, double to_1, double value) {
    return std::clamp((value - from_0) / (to_1 - from_0), 0.0, 1.0);
  };
  // Facets whose corners lie outside the region say nothing about the surface inside.
  const double inside = ramp(0.7, 0.4, facets.long_share());
  return inside > 0 ? inside * ramp(0.55, 0.85, kink_ratio(facets, fit)) : 0;
}

/// The vertex that stands out alone: farther from the fit than eight times what is usual, and twice
/// as far as its neighbours. -1 when there is none.
Eigen::Index spike(const Facets& facets, const Residuals& r) {
  std::vector<double> sizes;
  Eigen::VectorXd relative = Eigen::VectorXd::Zero(r.areas.size());
  for (Eigen::Index v = 0; v < r.areas.size(); ++v) {
    if (!(r.areas[v] > 0)) continue;
    // The fit has to follow this vertex: its residual is small whatever its error.
    relative[v] = std::abs(r.of_vertices[v]) / std::sqrt(std::max(r.variances[v], 0.05));
    sizes.push_back(relative[v]);
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const double usual = std::max(1.4826 * *middle, 100 * kFinestDigit);  // of a normal distribution
  Eigen::Index found;
  if (relative.maxCoeff(&found) < 8 * usual) return -1;
  const auto& corners = facets.region().corners;
  for (Eigen::Index i = 0; i < corners.cols(); ++i) {
    if ((corners.col(i).array() != found).all()) continue;
    for (int k = 0; k < 3; ++k)
      if (corners(k, i) != found && relative[corners(k, i)] > relative[found] / 2) return -1;
  }
  return found;
}

}  // namespace

Eigen::Matrix3d surface_axes(const Vector3d& normal) {
  const double cos_30_degrees = std::sqrt(0.75);
  const Vector3d axis =
      std::abs(normal.x()) > cos_30_degrees ? Vector3d::UnitY() : Vector3d::UnitX();
  const Vector3d x_axis = (axis - axis.dot(normal) * normal).normalized();
  Eigen::Matrix3d frame;
  frame << x_axis, normal.cross(x_axis), normal;
  return frame;
}

namespace internal {

std::string millimetres(double length_m) {
  std::ostringstream out;
  out.precision(4);
  out << length_m * 1e3 << " mm";
  return out.str();
}

std::array<double, 2> principal_curvatures_per_m(const Quadric& q) {
  const double mean = q.A_per_m + q.B_per_m;
  const double half_difference = std::hypot(q.A_per_m - q.B_per_m, q.C_per_m);
  // The eigenvalue nearer to zero as determinant over the other one: mean - half_difference would
  // lose the digits of the flat direction.
  const double determinant = 4 * q.A_per_m * q.B_per_m - q.C_per_m * q.C_per_m;
  // On a round surface the quotient's rounding must not turn the order round.
  if (mean > 0) {
    const double larger = mean + half_difference;
    return {std::min(determinant / larger, larger), larger};
  }
  if (mean < 0) {
    const double smaller = mean - half_difference;
    return {smaller, std::max(determinant / smaller, smaller)};
  }
  return {-half_difference, half_difference};
}

Eigen::Matrix2d principal_curvature_covariance_per_m2(const Quadric& q,
                                                      const Eigen::Matrix3d& covariance_per_m2) {
  if (!covariance_per_m2.allFinite()) return Eigen::Vector2d::Constant(kInfinity).asDiagonal();
  const double axis = principal_axis(q);
  const double c = std::cos(axis), s = std::sin(axis);
  const Vector3d along(2 * c * c, 2 * s * s, 2 * c * s), across(2 * s * s, 2 * c * c, -2 * c * s);
  // The curvatures are A + B -+ |d| with d = (A - B, C); this is d's component across itself.
  const Vector3d turning(-2 * c * s, 2 * c * s, c * c - s * s);
  Eigen::Matrix<double, 2, 3> gradient;
  gradient << along.transpose(), across.transpose();
  Eigen::Matrix2d result = gradient * covariance_per_m2 * gradient.transpose();
  const double size = std::hypot(q.A_per_m - q.B_per_m, q.C_per_m);
  // 1.5: |d| itself has been pushed up, where it is no larger than its noise.
  const double sideways = std::sqrt(std::max(0.0, turning.dot(covariance_per_m2 * turning)));
  const double splitting = std::hypot(size, 1.5 * sideways) - size;
  result += splitting * splitting * Eigen::Matrix2d{{1, -1}, {-1, 1}};
  return result;
}

double radius_std_m(double curvature_per_m, double std_per_m) {
  if (std::isinf(std_per_m)) return kInfinity;
  const double relative = std_per_m / std::abs(curvature_per_m);
  return relative / std::max(1 - 2 * relative, 0.1) / std::abs(curvature_per_m);
}

namespace {

void check_radius(const SurfaceNeighbourhood& neighbourhood, double region_radius_m) {
  if (!(region_radius_m > 0) || !std::isfinite(region_radius_m))
    throw InputError("surface", "radius", millimetres(region_radius_m), "positive and finite");
  if (neighbourhood.distance_m() > region_radius_m) {
    throw InputError("surface", "radius", millimetres(region_radius_m),
                     "at least " + millimetres(neighbourhood.distance_m()) +
                         ", the distance from the point to the nearest triangle");
  }
}

/// Checks the vertices alone: samples of their flat facets would seem to determine a quadric even
/// where the vertices lie on a conic.
void check_determined(const SurfaceRegion& region, const Eigen::Matrix3Xd& vertices,
                      double region_radius_m) {
  const int n = region.vertices_within;
  const std::string field = "vertices within " + millimetres(region_radius_m) + " of the point";
  if (n < kUnknowns) {
    throw InputError("surface", field, std::to_string(n),
                     "at least 6 (choose a larger radius or a finer mesh)");
  }
  const Eigen::Matrix3d frame = surface_axes(region.mean_normal);
  const Eigen::MatrixXd columns = quadric_columns(frame, vertices.leftCols(n), region_radius_m);
  if (scaled_least_squares(columns, Eigen::VectorXd::Zero(n)).rank < kUnknowns) {
    throw InputError("surface", field, std::to_string(n),
                     "vertices that determine a quadric: these lie on a line or a conic (choose a "
                     "larger radius or a finer mesh)");
  }
}

/// A fit, its residuals, and the number of vertices that it leaves out.
struct RobustFit {
  TangentFit fit;
  Residuals scatter;
  int outliers = 0;
};

/// Moves a vertex onto the quadric that is fitted without it, so that neither its facets' chords
/// nor their depths count. The fit follows the vertex by its leverage, which each step measures for
/// the next; where it follows wholly, steps stay short.
TangentFit fit_without(Facets& facets, Eigen::Index vertex, const RobustFit& with) {
  TangentFit fit = with.fit;
  double residual = with.scatter.of_vertices[vertex], step = residual;
  constexpr int kMostSteps = 8;
  constexpr double kLeast = 0.05;
  for (int i = 0; i < kMostSteps && std::abs(residual) > kFinestDigit; ++i) {
    facets.move(vertex, step * facets.scale() * fit.normal);
    fit = fit_tangent(facets, fit.normal);
    const double left = vertex_residuals(facets, fit, with.scatter.areas)[vertex];
    const double leverage = 1 - (residual - left) / step;
    step = leverage > 0 && leverage < 1 ? left / std::max(1 - leverage, kLeast) : left;
    residual = left;
  }
  return fit;
}

/// Fits a region without its outliers. At most one vertex in twenty is left out: more are no
/// errors, but the surface.
RobustFit fit_without_spikes(Facets& facets, const SurfaceRegion& region) {
  RobustFit found;
  found.fit = fit_tangent(facets, region.mean_normal);
  found.scatter = residuals(facets, found.fit, 0);
  const int most = (found.scatter.freedom + kUnknowns) / 20;
  for (; found.outliers < most; ++found.outliers) {
    const Eigen::Index v = spike(facets, found.scatter);
    if (v < 0) break;
    found.fit = fit_without(facets, v, found);
    found.scatter = residuals(facets, found.fit, found.outliers + 1);
  }
  return found;
}

}  // namespace

void set_principal_radii(QuadricFit& result, double region_radius_m) {
  const auto curvatures = principal_curvatures_per_m(result.quadric);
  const Eigen::Matrix2d curvature_covariance =
      principal_curvature_covariance_per_m2(result.quadric, result.covariance_per_m2);
  const double largest = std::max(std::abs(curvatures[0]), std::abs(curvatures[1]));
  result.principal.axis_rad = principal_axis(result.quadric);
  for (int i = 0; i < 2; ++i) {
    const double std = std::sqrt(curvature_covariance(i, i));
    // A direction counts as flat (infinite radius) if its sagitta is at most a millionth of the
    // region's radius. It also counts as flat if its curvature is within three standard deviations
    // of zero and at most a hundredth of the larger one: noise could otherwise give a cylinder a
    // concave direction.
    const double noise = std::min(3 * std, 1e-2 * largest);
    const double radius =
        radius_from_curvature(curvatures[i], std::max(2e-6 / region_radius_m, noise));
    result.principal.radii_m[i] = radius;
    result.radii_std_m[i] = std::isinf(radius) ? kInfinity : radius_std_m(curvatures[i], std);
  }
}

namespace {

/// Interpretation of a region's facets: only their vertices lie on the surface, or they are the
/// surface itself.
enum class Reading { vertices, facets };

QuadricFit fit_region(const SurfaceNeighbourhood& neighbourhood, double region_radius_m,
                      Reading reading) {
  check_radius(neighbourhood, region_radius_m);
  const SurfaceRegion region = neighbourhood.region(region_radius_m);
  // Depths are measured from the given point. The origin is its foot on the fitted surface.
  const Vector3d to_point = neighbourhood.point_m() - neighbourhood.centre_m();
  const Eigen::Matrix3Xd vertices = region.vertices_m.colwise() - to_point;
  if (reading == Reading::vertices) check_determined(region, vertices, region_radius_m);
  Facets facets(region, vertices, region_radius_m);
  if (reading == Reading::facets) facets.take_as_chords(0);
  RobustFit found = fit_without_spikes(facets, region);
  const double chords = reading == Reading::vertices ? chord_share(facets, found.fit) : 1;
  // Mesh files carry single precision. Of a rounded number the error is 1/sqrt(12) of its step.
  const double rounding = std::sqrt(1.0 / 12) * std::numeric_limits<float>::epsilon() *
                          neighbourhood.centre_m().cwiseAbs().maxCoeff() / region_radius_m;
  HigherOrders higher = reading == Reading::vertices
                            ? higher_orders(facets, found.fit, found.scatter, rounding)
                            : expected_orders(facets, found.fit, found.scatter);
  Apex apex = apex_of(found.fit, found.fit.coefficients + higher.change);
  if (chords < 1) {
    const Vector3d as_chords = apex.coefficients.head<3>();
    facets.take_as_chords(chords);
    found.fit = fit_tangent(facets, found.fit.normal);
    found.scatter = residuals(facets, found.fit, found.outliers);
    higher = expected_orders(facets, found.fit, found.scatter);
    apex = apex_of(found.fit, found.fit.coefficients + higher.change);
    // The share of chords is an estimate. Where it is less than 1, the fit that reads all facets as
    // chords may be the right one: two standard deviations reach a little beyond it.
    constexpr double kReach = 1.2;
    const Vector3d other_reading = kReach / 2 * (apex.coefficients.head<3>() - as_chords);
    higher.covariance += other_reading * other_reading.transpose();
  }
  const TangentFit& fit = found.fit;

  QuadricFit result;
  const double per_metre = 1 / region_radius_m;
  const Coefficients& coefficients = apex.coefficients;
  result.quadric = {coefficients[0] * per_metre, coefficients[1] * per_metre,
                    coefficients[2] * per_metre};
  result.covariance_per_m2 = higher.covariance * per_metre * per_metre;
  set_principal_radii(result, region_radius_m);
  result.normal = apex.normal;
  result.x_axis = apex.frame.col(0);
  result.origin_m = neighbourhood.point_m() - coefficients[5] * region_radius_m * apex.normal;
  result.area_m2 = region.weights_m2.sum();
  const Eigen::VectorXd distances =
      facets.depths(fit.frame) -
      quadric_columns(fit.frame, facets.points(), region_radius_m) * fit.coefficients;
  result.residual_rms_m =
      region_radius_m * std::sqrt(region.weights_m2.dot(distances.cwiseAbs2()) / result.area_m2);
  result.region_radius_m = region_radius_m;
  result.points = region.vertices_within;
  result.outliers = found.outliers;
  result.sharpest_kink_rad = region.sharp_kink_rad;
  // A coarse or noisy mesh has kinks everywhere: an edge is one that exceeds them clearly.
  const double sharp = 35 * kPi / 180;
  if (region.sharp_kink_rad > std::max(sharp, 6 * region.usual_kink_rad))
    result.surface_kind = SurfaceKind::sharp_edge;
  return result;
}

}  // namespace

QuadricFit fit_quadric(const SurfaceNeighbourhood& neighbourhood, double region_radius_m) {
  return fit_region(neighbourhood, region_radius_m, Reading::vertices);
}

QuadricFit fit_quadric_to_facets(const SurfaceNeighbourhood& neighbourhood,
                                 double region_radius_m) {
  return fit_region(neighbourhood, region_radius_m, Reading::facets);
}

}  // namespace internal

Quadric quadric_from_radii(double radius_x_m, double radius_y_m) {
  return {0.5 / radius_x_m, 0.5 / radius_y_m, 0};
}

PrincipalCurvature principal_curvature(const Quadric& quadric) {
  const auto curvatures = internal::principal_curvatures_per_m(quadric);
  const double largest = std::max(std::abs(curvatures[0]), std::abs(curvatures[1]));
  const double round_off = 4 * std::numeric_limits<double>::epsilon() * largest;
  return {{radius_from_curvature(curvatures[0], round_off),
           radius_from_curvature(curvatures[1], round_off)},
          principal_axis(quadric)};
}

namespace {

constexpr double kSmallerRegion = 0.8, kLargerRegion = 1.25;  // in radii

/// Whether a region of another radius holds the same part of the surface.
bool is_same_region(const internal::SurfaceNeighbourhood& neighbourhood, double radius_m,
                    double other_radius_m) {
  const double area = neighbourhood.region(radius_m).weights_m2.sum(),
               other = neighbourhood.region(other_radius_m).weights_m2.sum();
  constexpr double kRounding = 1e-9;
  return std::abs(other - area) <= kRounding * area;
}

}  // namespace

bool is_whole_surface(const TriangleSurface& surface, const Vector3d& point_m,
                      const Vector3d* outward_normal, double region_radius_m) {
  return is_same_region(internal::SurfaceNeighbourhood(surface, point_m, outward_normal),
                        region_radius_m, kLargerRegion * region_radius_m);
}

std::array<double, 2> radii_region_change_m(const TriangleSurface& surface, const Vector3d& point_m,
                                            const Vector3d* outward_normal, const QuadricFit& fit) {
  const internal::SurfaceNeighbourhood neighbourhood(surface, point_m, outward_normal);
  const auto curvatures = internal::principal_curvatures_per_m(fit.quadric);
  std::array<double, 2> change{-1, -1};
  for (double factor : {kSmallerRegion, kLargerRegion}) {
    try {
      if (is_same_region(neighbourhood, fit.region_radius_m, factor * fit.region_radius_m))
        continue;
      const auto other = internal::principal_curvatures_per_m(
          internal::fit_quadric(neighbourhood, factor * fit.region_radius_m).quadric);
      for (int i : {0, 1}) change[i] = std::max(change[i], std::abs(other[i] - curvatures[i]));
    } catch (const InputError&) {  // too few vertices: the other region has to do
    } catch (const ConvergenceError&) {
    }
  }
  for (int i : {0, 1}) {
    const double radius = fit.principal.radii_m[i];
    change[i] = change[i] < 0 || std::isinf(radius) ? kInfinity : change[i] * radius * radius;
  }
  return change;
}

QuadricFit fit_quadric(const TriangleSurface& surface, const Vector3d& point_m,
                       const Vector3d* outward_normal, double region_radius_m) {
  return internal::fit_quadric(internal::SurfaceNeighbourhood(surface, point_m, outward_normal),
                               region_radius_m);
}

}  // namespace softfinger
