#include "softfinger/geometry/quadric_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "softfinger/geometry/quadric_fit_internal.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kUnknowns = 6;  // A, B, C, two tilts, offset

std::string millimetres(double length_m) {
  std::ostringstream out;
  out << length_m * 1e3 << " mm";
  return out.str();
}

/// Columns: x axis, y axis, normal.
Eigen::Matrix3d frame_along(const Vector3d& normal) {
  const double cos_30_degrees = std::sqrt(0.75);
  const Vector3d axis =
      std::abs(normal.x()) > cos_30_degrees ? Vector3d::UnitY() : Vector3d::UnitX();
  const Vector3d x_axis = (axis - axis.dot(normal) * normal).normalized();
  Eigen::Matrix3d frame;
  frame << x_axis, normal.cross(x_axis), normal;
  return frame;
}

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

/// Weighted linear least squares of the depths in one frame.
struct LinearFit {
  Eigen::MatrixXd columns;  ///< x², y², xy, x, y, 1 of the points, lengths over the region's radius
  Eigen::VectorXd residuals;
  Eigen::Matrix<double, kUnknowns, 1> coefficients;
};

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

/// QR with columns of unit length, which makes its pivots a measure of the points' placing alone.
std::pair<Eigen::ColPivHouseholderQR<Eigen::MatrixXd>, Eigen::RowVectorXd> scaled_qr(
    Eigen::MatrixXd columns) {
  const Eigen::RowVectorXd norms =
      columns.colwise().norm().cwiseMax(std::numeric_limits<double>::min());
  columns.array().rowwise() /= norms.array();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  // Points on a conic (two lines, a circle) fit infinitely many quadrics. Coordinates from STL
  // files carry seven digits, so that what is degenerate shows up as a pivot near 1e-7, not 1e-16.
  qr.setThreshold(1e-5);
  return {qr, norms};
}

LinearFit solve(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& weights,
                const Eigen::Matrix3d& frame, double scale) {
  LinearFit fit;
  fit.columns = quadric_columns(frame, points, scale);
  const Eigen::VectorXd depths = -(frame.col(2).transpose() * points / scale).transpose();

  const Eigen::VectorXd root_weights = weights.cwiseSqrt();
  const auto [qr, norms] = scaled_qr(root_weights.asDiagonal() * fit.columns);
  fit.coefficients =
      qr.solve(root_weights.asDiagonal() * depths).array() / norms.transpose().array();
  fit.residuals = depths - fit.columns * fit.coefficients;
  return fit;
}

/// The same coefficients from the normal equations: half the digits, a tenth of the time.
Eigen::Matrix<double, kUnknowns, 1> solve_roughly(const Eigen::Matrix3Xd& points,
                                                  const Eigen::VectorXd& weights,
                                                  const Eigen::Matrix3d& frame, double scale) {
  // Plain loops: this is where the time goes, also in a build without optimisation.
  double gram[kUnknowns + 1][kUnknowns + 1] = {};
  double axes[3][3];
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) axes[axis][i] = frame(i, axis) / scale;
  const double* p = points.data();
  const double* w = weights.data();
  for (Eigen::Index n = 0; n < points.cols(); ++n, p += 3, ++w) {
    double local[3];
    for (int axis = 0; axis < 3; ++axis)
      local[axis] = axes[axis][0] * p[0] + axes[axis][1] * p[1] + axes[axis][2] * p[2];
    const double x = local[0], y = local[1];
    const double row[kUnknowns + 1] = {x * x, y * y, x * y, x, y, 1, -local[2]};
    for (int i = 0; i < kUnknowns; ++i)
      for (int j = i; j <= kUnknowns; ++j) gram[i][j] += *w * row[i] * row[j];
  }
  Eigen::Matrix<double, kUnknowns, kUnknowns> h;
  Eigen::Matrix<double, kUnknowns, 1> right, norms;
  for (int i = 0; i < kUnknowns; ++i) norms[i] = std::sqrt(gram[i][i]);
  for (int i = 0; i < kUnknowns; ++i) {
    right[i] = gram[i][kUnknowns] / norms[i];
    for (int j = i; j < kUnknowns; ++j) h(j, i) = h(i, j) = gram[i][j] / (norms[i] * norms[j]);
  }
  return h.ldlt().solve(right).cwiseQuotient(norms);
}

/// Covariance of (A, B, C), lengths over the region's radius, for independent errors of the
/// vertices with equal variance. The fit is linear in the vertices' depths z_v: H^-1 sum(b_v z_v),
/// where b_v is the integral of the columns times the hat function of vertex v, so that its
/// covariance is s² H^-1 sum(b_v b_v^T) H^-1. The variance s² is that of the vertices' own
/// residuals, without their mean: the vertices of a curved surface all stand proud of its facets'
/// fit by a sagitta.
Eigen::Matrix3d covariance(const LinearFit& fit, const internal::SurfaceRegion& region,
                           const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3d& frame,
                           double scale) {
  const int inside = region.vertices_within;
  if (inside <= kUnknowns) return Eigen::Matrix3d::Constant(kInfinity);
  using Matrix6 = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  const Matrix6 h = fit.columns.transpose() * region.weights_m2.asDiagonal() * fit.columns;
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(kUnknowns, vertices.cols());
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(vertices.cols());
  for (Eigen::Index i = 0; i < fit.columns.rows(); ++i) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      const double share = region.weights_m2[i] * region.barycentric(c, i);
      b.col(region.corners(c, i)) += share * fit.columns.row(i).transpose();
      areas[region.corners(c, i)] += share;
    }
  }
  const Eigen::MatrixXd gain = h.ldlt().solve(b);
  const Eigen::MatrixXd terms = quadric_columns(frame, vertices, scale).topRows(inside);
  const Eigen::VectorXd depths = -(frame.col(2).transpose() * vertices / scale).transpose();
  Eigen::VectorXd residuals = depths.head(inside) - terms * fit.coefficients;
  const Eigen::VectorXd weights = areas.head(inside) / areas.head(inside).sum();
  residuals.array() -= weights.dot(residuals);
  const double variance =
      weights.dot(residuals.cwiseAbs2()) * inside / static_cast<double>(inside - kUnknowns);
  return variance * (gain * gain.transpose()).topLeftCorner<3, 3>();
}

}  // namespace

namespace internal {

std::array<double, 2> principal_curvatures_per_m(const Quadric& q) {
  const double mean = q.A_per_m + q.B_per_m;
  const double half_difference = std::hypot(q.A_per_m - q.B_per_m, q.C_per_m);
  // The eigenvalue nearer to zero as determinant over the other one: mean - half_difference would
  // lose the digits of the flat direction.
  const double determinant = 4 * q.A_per_m * q.B_per_m - q.C_per_m * q.C_per_m;
  if (mean > 0) return {determinant / (mean + half_difference), mean + half_difference};
  if (mean < 0) return {mean - half_difference, determinant / (mean - half_difference)};
  return {-half_difference, half_difference};
}

std::array<double, 2> principal_curvature_std_per_m(double axis_rad,
                                                    const Eigen::Matrix3d& covariance_per_m2) {
  if (!covariance_per_m2.allFinite()) return {kInfinity, kInfinity};
  const double c = std::cos(axis_rad), s = std::sin(axis_rad);
  const Vector3d along(2 * c * c, 2 * s * s, 2 * c * s), across(2 * s * s, 2 * c * c, -2 * c * s);
  return {std::sqrt(std::max(0.0, along.dot(covariance_per_m2 * along))),
          std::sqrt(std::max(0.0, across.dot(covariance_per_m2 * across)))};
}

QuadricFit fit_quadric(const SurfaceNeighbourhood& neighbourhood, double region_radius_m) {
  if (!(region_radius_m > 0) || !std::isfinite(region_radius_m))
    throw InputError("surface", "radius", millimetres(region_radius_m), "positive and finite");
  if (neighbourhood.distance_m() > region_radius_m) {
    throw InputError("surface", "radius", millimetres(region_radius_m),
                     "at least " + millimetres(neighbourhood.distance_m()) +
                         ", the distance from the point to the nearest triangle");
  }
  const SurfaceRegion region = neighbourhood.region(region_radius_m);
  const int n = region.vertices_within;
  const std::string field = "vertices within " + millimetres(region_radius_m) + " of the point";
  if (n < kUnknowns) {
    throw InputError("surface", field, std::to_string(n),
                     "at least 6 (choose a larger radius or a finer mesh)");
  }

  // Depths are measured from the given point, whose foot on the fitted surface is the origin.
  const Vector3d to_point = neighbourhood.point_m() - neighbourhood.centre_m();
  const Eigen::Matrix3Xd points = region.samples_m.colwise() - to_point;
  const Eigen::Matrix3Xd vertices = region.vertices_m.colwise() - to_point;
  Vector3d normal = region.mean_normal;
  Eigen::Matrix3d frame = frame_along(normal);
  // The facets between too few vertices would pretend to know the curvature: flat.
  if (scaled_qr(quadric_columns(frame, vertices.leftCols(n), region_radius_m)).first.rank() <
      kUnknowns) {
    throw InputError("surface", field, std::to_string(n),
                     "vertices that determine a quadric: these lie on a line or a conic (choose a "
                     "larger radius or a finer mesh)");
  }
  LinearFit fit;
  double tilt = kInfinity, previous = kInfinity;
  const int max_iterations = 100;
  int iteration = 0;
  bool polishing = false;  // most of the way by the normal equations, the end by QR
  for (; iteration < max_iterations; ++iteration) {
    frame = frame_along(normal);
    Eigen::Vector2d tilts;
    if (polishing) {
      fit = solve(points, region.weights_m2, frame, region_radius_m);
      tilts = fit.coefficients.segment<2>(3);
    } else {
      tilts = solve_roughly(points, region.weights_m2, frame, region_radius_m).segment<2>(3);
    }
    tilt = tilts.norm();
    // Below 1e-8 an iteration that has stopped shrinking has arrived at round-off.
    const bool arrived = tilt < 1e-14 || (tilt < 1e-8 && tilt >= 0.5 * previous);
    if (polishing && arrived) break;
    // Half steps where full ones do not contract: the frame then follows a strongly curved region.
    const double step = tilt > 0.5 * previous && tilt >= 1e-8 ? 0.5 : 1.0;
    previous = arrived ? kInfinity : tilt;
    polishing = polishing || arrived;
    normal = (normal + step * (frame.leftCols<2>() * tilts)).normalized();
  }
  if (iteration == max_iterations) {
    throw ConvergenceError("quadric fit", iteration, tilt,
                           "the region is too strongly curved for one quadric: choose a smaller "
                           "radius");
  }

  QuadricFit result;
  const double per_metre = 1 / region_radius_m;
  result.quadric = {fit.coefficients[0] * per_metre, fit.coefficients[1] * per_metre,
                    fit.coefficients[2] * per_metre};
  result.covariance_per_m2 =
      covariance(fit, region, vertices, frame, region_radius_m) * per_metre * per_metre;
  const auto curvatures = internal::principal_curvatures_per_m(result.quadric);
  const double axis = principal_axis(result.quadric);
  const auto curvature_std =
      internal::principal_curvature_std_per_m(axis, result.covariance_per_m2);
  const double largest = std::max(std::abs(curvatures[0]), std::abs(curvatures[1]));
  result.principal.axis_rad = axis;
  for (int i = 0; i < 2; ++i) {
    // Flat: a sagitta of a millionth of the region, or a hundredth of the other direction's
    // curvature that is not significant. A sign that is noise would make a cylinder concave.
    const double noise = std::min(3 * curvature_std[i], 1e-2 * largest);
    result.principal.radii_m[i] =
        radius_from_curvature(curvatures[i], std::max(2e-6 * per_metre, noise));
  }
  for (int i = 0; i < 2; ++i) {
    const double radius = result.principal.radii_m[i];
    result.radii_std_m[i] = std::isinf(radius) ? kInfinity : curvature_std[i] * radius * radius;
  }
  result.normal = normal;
  result.x_axis = frame.col(0);
  result.origin_m = neighbourhood.point_m() - fit.coefficients[5] * region_radius_m * normal;
  result.area_m2 = region.weights_m2.sum();
  result.residual_rms_m =
      region_radius_m *
      std::sqrt(region.weights_m2.dot(fit.residuals.cwiseAbs2()) / result.area_m2);
  result.region_radius_m = region_radius_m;
  result.points = n;
  return result;
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

QuadricFit fit_quadric(const TriangleSurface& surface, const Vector3d& point_m,
                       const Vector3d* outward_normal, double region_radius_m) {
  return internal::fit_quadric(internal::SurfaceNeighbourhood(surface, point_m, outward_normal),
                               region_radius_m);
}

}  // namespace softfinger
