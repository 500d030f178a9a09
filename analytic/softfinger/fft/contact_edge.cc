#include "softfinger/fft/contact_edge.h"

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/math/dense_solvers.h"

namespace softfinger::fft {
namespace {

constexpr int kEdgePoints = 128;
constexpr int kHighestHarmonic = 6;

[[noreturn]] void fail(int iteration, double residual) {
  throw ConvergenceError("edge of the contact", iteration, residual,
                         "the contact is not one smooth region, or it has too few cells");
}

/// Values of the harmonics at an angle: 1, cos 2t, cos 4t, cos 6t for an even contact, otherwise
/// all up to 6 t.
Eigen::VectorXd harmonics(double angle, bool even) {
  Eigen::VectorXd values(even ? kHighestHarmonic / 2 + 1 : 2 * kHighestHarmonic + 1);
  values[0] = 1;
  if (even) {
    for (int k = 1; 2 * k <= kHighestHarmonic; ++k) values[k] = std::cos(2 * k * angle);
  } else {
    for (int k = 1; k <= kHighestHarmonic; ++k) {
      values[2 * k - 1] = std::cos(k * angle);
      values[2 * k] = std::sin(k * angle);
    }
  }
  return values;
}

/// Symmetric root of a positive matrix M: (M + sqrt(det M) I) / sqrt(tr M + 2 sqrt(det M)).
Eigen::Matrix2d root(const Eigen::Matrix2d& matrix) {
  const double determinant = std::sqrt(matrix.determinant());
  return (matrix + determinant * Eigen::Matrix2d::Identity()) /
         std::sqrt(matrix.trace() + 2 * determinant);
}

/// Neighbouring cells of a row (`along_x`) or a column between whose middles the edge passes.
struct Crossing {
  Eigen::Vector2d inside, outside;  // middles
  double pressure, gap;             // of the cell inside, of the cell outside
  bool along_x;
};

std::vector<Crossing> find_crossings(const CellGrid& grid, const Eigen::ArrayXd& pressure,
                                     const Eigen::ArrayXd& gap) {
  std::vector<Crossing> crossings;
  const auto add = [&](int i1, int j1, int i2, int j2) {
    const int one = i1 * grid.columns + j1, two = i2 * grid.columns + j2;
    if ((pressure[one] > 0) == (pressure[two] > 0)) return;
    Crossing crossing{
        {grid.x(j1), grid.y(i1)}, {grid.x(j2), grid.y(i2)}, pressure[one], gap[two], i1 == i2};
    if (pressure[two] > 0) {
      std::swap(crossing.inside, crossing.outside);
      crossing.pressure = pressure[two];
      crossing.gap = gap[one];
    }
    crossing.gap = std::max(0.0, crossing.gap);
    crossings.push_back(crossing);
  };
  for (int i = 0; i < grid.rows; ++i)
    for (int j = 0; j < grid.columns; ++j) {
      if (j + 1 < grid.columns) add(i, j, i, j + 1);
      if (i + 1 < grid.rows) add(i, j, i + 1, j);
    }
  return crossings;
}

}  // namespace

double ContactEdge::relative_radius(double x, double y) const {
  const Eigen::Vector2d u = to_scaled * (Eigen::Vector2d(x, y) - centre);
  const double r = u.norm();
  if (r == 0) return 0;
  // cos kt and sin kt by rotating (cos t, sin t).
  const double c = u.x() / r, s = u.y() / r;
  double cosine = 1, sine = 0, edge = 1 + harmonics[0];
  for (int k = 1; k <= kHighestHarmonic; ++k) {
    const double next = c * cosine - s * sine;
    sine = s * cosine + c * sine;
    cosine = next;
    edge += harmonics[2 * k - 1] * cosine + harmonics[2 * k] * sine;
  }
  return r / edge;
}

ContactEdge fit_contact_edge(const CellGrid& grid, const Eigen::ArrayXd& pressure,
                             const Eigen::ArrayXd& gap, double compliance, bool even) {
  // First guess: the ellipse with the moments of the cells in contact.
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Matrix2d shape = Eigen::Matrix2d::Zero();
  int count = 0;
  for (int i = 0, k = 0; i < grid.rows; ++i)
    for (int j = 0; j < grid.columns; ++j, ++k) {
      if (!(pressure[k] > 0)) continue;
      const bool at_border =
          i + 1 == grid.rows || j + 1 == grid.columns || (!even && (i == 0 || j == 0));
      const Eigen::Vector2d x(grid.x(j), grid.y(i));
      if (at_border) fail(0, x.norm());
      centre += x;
      shape += x * x.transpose();
      ++count;
    }
  if (count < (even ? 4 : 16)) fail(0, count);
  centre = even ? Eigen::Vector2d::Zero() : Eigen::Vector2d(centre / count);
  shape = 4 * (shape / count - centre * centre.transpose());
  if (even) shape(0, 1) = shape(1, 0) = 0;

  // Sinking of a cell under its own pressure when the edge passes it, over compliance, pressure and
  // cell size. For long rows of equal cells it is 0.88: the second difference of x² ln x / pi, by
  // which the displacement of a row exceeds that of its neighbour. The value here leaves no bias in
  // the semi-axes of the Hertz contact, and less than a thirtieth of a cell for all layers and for
  // cells up to 4 : 1.
  constexpr double kOwnDisplacement = 0.7;
  const std::vector<Crossing> crossings = find_crossings(grid, pressure, gap);
  Eigen::Matrix2d stretch;
  Eigen::VectorXd coefficients;
  constexpr int kIterations = 12;
  constexpr double kTolerance = 1e-9;
  double change = 1;
  for (int iteration = 0; change > kTolerance; ++iteration) {
    if (iteration == kIterations) fail(iteration, change);
    stretch = root(shape);
    const Eigen::Matrix2d inverse = stretch.inverse();
    const Eigen::Index unknowns = harmonics(0, even).size();
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    for (const Crossing& crossing : crossings) {
      // The edge's normal in units of cells, and the size of a cell along it. Crossings of rows and
      // of columns are weighted with the cos² of their angle to the normal: together they then
      // count all directions alike.
      Eigen::Vector2d u = inverse * (0.5 * (crossing.inside + crossing.outside) - centre);
      const Eigen::Vector2d normal_direction = (inverse * u).normalized();
      const double across_x = std::pow(normal_direction.x() * grid.size_x, 2);
      const double across_y = std::pow(normal_direction.y() * grid.size_y, 2);
      const double weight = (crossing.along_x ? across_x : across_y) / (across_x + across_y);
      const double push =
          kOwnDisplacement * compliance * crossing.pressure * std::sqrt(across_x + across_y);
      const double fraction = push / (push + crossing.gap);
      u = inverse * (crossing.inside + fraction * (crossing.outside - crossing.inside) - centre);
      const double r = u.norm();
      const Eigen::VectorXd basis = harmonics(std::atan2(u.y(), u.x()), even);
      normal += weight * basis * basis.transpose();
      right += weight * (r - 1) * basis;
    }
    coefficients = internal::solve_semidefinite(normal, right);
    if (!(coefficients.cwiseAbs().sum() < 0.7)) fail(iteration, coefficients.cwiseAbs().sum());
    const double mean = coefficients[0];
    const double c2 = coefficients[even ? 1 : 3], s2 = even ? 0 : coefficients[4];
    const Eigen::Vector2d shift =
        even ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(coefficients[1], coefficients[2]);
    Eigen::Matrix2d strain;
    strain << 1 + mean + c2, s2, s2, 1 + mean - c2;
    centre += stretch * shift;
    shape = stretch * strain * strain * stretch;
    change = std::abs(mean) + std::abs(c2) + std::abs(s2) + shift.norm();
  }

  ContactEdge edge;
  edge.centre = centre;
  // Eigenvalues of the shape are the squares of the semi-axes.
  const double half_sum = 0.5 * shape.trace();
  const double half_difference = std::hypot(0.5 * (shape(0, 0) - shape(1, 1)), shape(0, 1));
  edge.a = std::sqrt(half_sum + half_difference);
  edge.b = std::sqrt(half_sum - half_difference);
  edge.axis_rad = 0.5 * std::atan2(2 * shape(0, 1), shape(0, 0) - shape(1, 1));
  // The axes of a circle on a quarter of the grid differ by rounding only: their direction is then
  // meaningless and set to 0.
  if (even && edge.b > edge.a * (1 - 1e-9)) edge.axis_rad = 0;
  edge.points.resize(2, kEdgePoints);
  edge.to_scaled = stretch.inverse();
  edge.harmonics = Eigen::VectorXd::Zero(2 * kHighestHarmonic + 1);
  if (even)
    for (int k = 0; 2 * k <= kHighestHarmonic; ++k)
      edge.harmonics[k == 0 ? 0 : 4 * k - 1] = coefficients[k];
  else
    edge.harmonics = coefficients;
  double mean_square = 0;
  for (int k = 0; k < kEdgePoints; ++k) {
    const double angle = 2 * kPi * k / kEdgePoints;
    const double radius = 1 + harmonics(angle, even).dot(coefficients);
    mean_square += radius * radius / kEdgePoints;
    edge.deviation = std::max(edge.deviation, std::abs(radius - 1));
    edge.points.col(k) =
        centre + stretch * (radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  edge.area = kPi * mean_square * stretch.determinant();
  edge.diamond = coefficients[even ? 2 : 7];
  return edge;
}

}  // namespace softfinger::fft
