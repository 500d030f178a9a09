#include "fem/contact/pressure_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace softfinger::fem {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

/// Finds the face under a point: the finest faces form a regular grid.
class FaceGrid {
 public:
  explicit FaceGrid(const std::vector<SurfaceFace>& faces) : faces_(faces) {
    low_x_ = low_y_ = std::numeric_limits<double>::infinity();
    for (const auto& face : faces) {
      size_x_ = face.size_x;
      size_y_ = face.size_y;
      low_x_ = std::min(low_x_, face.x);
      low_y_ = std::min(low_y_, face.y);
    }
    for (const auto& face : faces) {
      columns_ = std::max(columns_, column(face.x + 0.5 * face.size_x) + 1);
      rows_ = std::max(rows_, row(face.y + 0.5 * face.size_y) + 1);
    }
    index_.assign(static_cast<std::size_t>(columns_ * rows_), -1);
    for (std::size_t i = 0; i < faces.size(); ++i)
      index_[cell(faces[i].x + 0.5 * size_x_, faces[i].y + 0.5 * size_y_)] = static_cast<int>(i);
  }

  int columns() const { return columns_; }
  int rows() const { return rows_; }

  const SurfaceFace* find(double x, double y) const {
    if (x < low_x_ || y < low_y_ || column(x) >= columns_ || row(y) >= rows_) return nullptr;
    const int i = index_[cell(x, y)];
    return i < 0 ? nullptr : &faces_[static_cast<std::size_t>(i)];
  }

 private:
  int column(double x) const { return static_cast<int>((x - low_x_) / size_x_); }
  int row(double y) const { return static_cast<int>((y - low_y_) / size_y_); }
  std::size_t cell(double x, double y) const {
    return static_cast<std::size_t>(column(x) + columns_ * row(y));
  }

  const std::vector<SurfaceFace>& faces_;
  double low_x_ = 0, low_y_ = 0, size_x_ = 1, size_y_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<int> index_;
};

/// Monomials in x² and y² up to a degree.
class Polynomial {
 public:
  explicit Polynomial(int degree) : degree_(degree), values_(terms()) {}

  Index terms() const { return (degree_ + 1) * (degree_ + 2) / 2; }

  const VectorXd& at(double x, double y) {
    x *= x;
    y *= y;
    Index k = 0;
    double x_power = 1;
    for (int i = 0; i <= degree_; ++i, x_power *= x) {
      double term = x_power;
      for (int j = 0; i + j <= degree_; ++j, term *= y) values_[k++] = term;
    }
    return values_;
  }

 private:
  int degree_;
  VectorXd values_;
};

/// Sums of values times shape functions, for each node of the faces. A ray has many points in a row
/// on one face: its nine nodes are only looked up when the ray leaves it.
class FaceShares {
 public:
  FaceShares(Index values, Index nodes)
      : of_nodes_(MatrixXd::Zero(values, nodes)), of_face_(MatrixXd::Zero(values, 9)) {}

  /// @param along_x,along_y  the point's three quadratic shape functions along the face's sides
  void add(const SurfaceFace& face, const double* along_x, const double* along_y,
           const VectorXd& values) {
    if (&face != face_) {
      hand_over();
      face_ = &face;
    }
    const Index count = values.size();
    double* share = of_face_.data();
    for (int k = 0; k < 9; ++k, share += count) {
      const double shape = along_x[k % 3] * along_y[k / 3];
      for (Index i = 0; i < count; ++i) share[i] += shape * values[i];
    }
  }

  const MatrixXd& of_nodes() {
    hand_over();
    return of_nodes_;
  }

 private:
  void hand_over() {
    for (Index k = 0; face_ && k < 9; ++k)
      if (const int node = face_->node[static_cast<std::size_t>(k)]; node >= 0)
        of_nodes_.col(node) += of_face_.col(k);
    of_face_.setZero();
    face_ = nullptr;
  }

  MatrixXd of_nodes_, of_face_;
  const SurfaceFace* face_ = nullptr;
};

/// The edge has this many parameters: its semi-axes and the fourth harmonic.
constexpr Index edge_changes = 3;

/// Changes of rho at the angle t, per unit of each.
Eigen::Vector3d radial_changes(double angle) {
  return {std::pow(std::cos(angle), 2), std::pow(std::sin(angle), 2), std::cos(4 * angle)};
}

ContactEdge changed(ContactEdge edge, const Eigen::Vector3d& by) {
  edge.a *= std::exp(by[0]);
  edge.b *= std::exp(by[1]);
  // Swapped, not assigned: gcc 12 warns of freed memory in Eigen's resize of an empty vector.
  if (VectorXd none = VectorXd::Zero(5); edge.cosine.size() == 0) edge.cosine.swap(none);
  edge.cosine[4] += by[2];
  return edge;
}

class Fit {
 public:
  explicit Fit(const NodalPressure& pressure)
      : faces_(pressure.faces),
        grid_(faces_),
        deformation_(pressure.deformation),
        layered_(pressure.layered),
        root_weight_(static_cast<Index>(pressure.nodes.size())) {
    for (std::size_t i = 0; i < pressure.nodes.size(); ++i)
      root_weight_[static_cast<Index>(i)] = std::sqrt(pressure.nodes[i].weight);
    target_ = pressure.force.cwiseQuotient(root_weight_);
  }

  /// Finds the best polynomial for an edge.
  /// @returns the sum of squares that is left
  double find_polynomial(const ContactEdge& edge, int degree) {
    degree_ = degree;
    Polynomial polynomial(degree);
    VectorXd row;
    moments_ = integrate(edge, polynomial.terms(), [&](const Point& at) -> const VectorXd& {
      row = at.area * at.root * polynomial.at(at.x, at.y);
      return row;
    });
    solver_.compute(moments_);
    coefficients_ = solver_.solve(target_);
    left_over_ = target_ - moments_ * coefficients_;
    return left_over_.squaredNorm();
  }

  /// Changes of the fitted moments per change of the edge, for the pressure found last, which is
  /// zero at the edge itself. The polynomial follows the edge: what it can make up for is left out
  /// (variable projection; L. Kaufman, BIT 15, 1975), without which the steps would be too short.
  /// In layered materials they stay short: the high degrees that are tried there make up for nearly
  /// any edge, which on few cells would wander off from the first guess (by 3 % at n = 4).
  MatrixXd derivative(const ContactEdge& edge) {
    Polynomial polynomial(degree_);
    VectorXd radial;
    MatrixXd changes = integrate(edge, edge_changes, [&](const Point& at) -> const VectorXd& {
      const double inside = coefficients_.dot(polynomial.at(at.x, at.y));
      radial = radial_changes(at.angle);
      const double r = at.fraction;
      radial *= at.area * inside * r * r / (std::max(at.root, smallest_root) * at.edge);
      return radial;
    });
    if (!layered_) changes -= moments_ * solver_.solve(changes);
    return changes;
  }

  const VectorXd& left_over() const { return left_over_; }
  bool left_faces() const { return left_faces_; }

  /// The pressure found last. @param r  of the way to the edge
  double pressure_at(double x, double y, double r) const {
    return std::sqrt(std::max(0.0, 1 - r * r)) * coefficients_.dot(Polynomial(degree_).at(x, y));
  }

  /// Number of nodes that carry force.
  Index carrying() const { return (target_.array() > 0).count(); }
  Index terms() const { return coefficients_.size(); }

 private:
  static constexpr double smallest_root = 1e-3;

  /// A point of the contact in scaled coordinates.
  struct Point {
    double x, y;      ///< relative to a, b from the centre; on a deformed surface as seen there
    double fraction;  ///< r: of the way to the edge
    double root;      ///< sqrt(1 - r²)
    double area;      ///< that the point stands for, deformed
    double edge;      ///< rho
    double angle, cosine, sine;
  };

  /// Enough for about ten points per face along each direction, so that points crossing a face's
  /// edge do not make the moments rough.
  int points_per_quarter() const {
    return std::max(120, 10 * std::max(grid_.columns(), grid_.rows()));
  }

  /// Integrals of functions of the point times every shape function: a row for each node. With the
  /// edge at rho(t) and r = sin s the root is cos s: dA = a b rho² sin s cos s ds dt.
  template <class Functions>
  MatrixXd integrate(const ContactEdge& edge, Index count, const Functions& functions) {
    left_faces_ = false;
    FaceShares shares(count, target_.size());
    const int steps = points_per_quarter();
    const double step = M_PI / 2 / steps;
    const ArrayXd angle = step * (ArrayXd::LinSpaced(steps, 0, steps - 1) + 0.5);
    const ArrayXd sine_of = angle.sin(), cosine_of = angle.cos();
    for (int j = 0; j < steps; ++j) {
      Point point{};
      point.angle = angle[j];
      point.cosine = std::cos(point.angle);
      point.sine = std::sin(point.angle);
      point.edge = edge.radius(point.angle);
      const Vector2d ray(edge.a * point.edge * point.cosine, edge.b * point.edge * point.sine);
      // Distances from the centre on a deformed surface, x in units of a and y of b.
      double deformed_edge = 1;
      const auto deformed_radius = [&](const Eigen::Vector3d& position) {
        return std::hypot(position.x() / edge.a, position.y() / edge.b);
      };
      if (deformation_) {
        if (const SurfaceFace* face = grid_.find(ray.x(), ray.y()))
          deformed_edge = deformed_radius(deformed(*face, ray).position);
        else
          left_faces_ = true;
      }
      const double of_ray = edge.a * edge.b * point.edge * point.edge * step * step;
      for (int i = 0; i < steps; ++i) {
        const Vector2d at = sine_of[i] * ray;
        const SurfaceFace* face = grid_.find(at.x(), at.y());
        if (!face) {
          left_faces_ = true;
          continue;
        }
        point.fraction = sine_of[i];
        point.root = cosine_of[i];
        point.area = of_ray * sine_of[i] * cosine_of[i];
        if (deformation_) {
          const SurfaceDeformation::Point moved = deformed(*face, at);
          point.fraction = deformed_radius(moved.position) / deformed_edge;
          point.root = std::sqrt(std::max(0.0, 1 - point.fraction * point.fraction));
          point.area *= moved.area_ratio;
        }
        point.x = point.fraction * point.edge * point.cosine;
        point.y = point.fraction * point.edge * point.sine;
        const VectorXd& values = functions(point);
        const double xi = (at.x() - face->x) / face->size_x,
                     eta = (at.y() - face->y) / face->size_y;
        const double along_x[] = {(1 - xi) * (1 - 2 * xi), 4 * xi * (1 - xi), xi * (2 * xi - 1)};
        const double along_y[] = {(1 - eta) * (1 - 2 * eta), 4 * eta * (1 - eta),
                                  eta * (2 * eta - 1)};
        shares.add(*face, along_x, along_y, values);
      }
    }
    return root_weight_.cwiseInverse().asDiagonal() * shares.of_nodes().transpose();
  }

  SurfaceDeformation::Point deformed(const SurfaceFace& face, const Vector2d& at) const {
    return deformation_->at(static_cast<std::size_t>(&face - faces_.data()),
                            (at.x() - face.x) / face.size_x, (at.y() - face.y) / face.size_y);
  }

  const std::vector<SurfaceFace>& faces_;
  const FaceGrid grid_;
  const SurfaceDeformation* deformation_;
  const bool layered_;
  VectorXd root_weight_, target_, coefficients_, left_over_;
  MatrixXd moments_;  ///< of the polynomial's terms, for the edge found last
  Eigen::HouseholderQR<MatrixXd> solver_;
  int degree_ = 0;
  bool left_faces_ = false;
};

/// An edge, and how well a pressure of some degree ends there.
struct Candidate {
  ContactEdge edge;
  int degree = 0;
  double squares = std::numeric_limits<double>::infinity();  ///< that are left
  double validated = std::numeric_limits<double>::infinity();
};

/// Levenberg-Marquardt in the edge; the pressure's coefficients are eliminated.
/// @returns none where it does not converge on the faces
std::optional<Candidate> fit_of_degree(Fit& fit, ContactEdge edge, int degree) {
  constexpr double tolerance = 1e-5, longest_step = 0.1;
  constexpr int limit = 40;
  double damping = 1e-4, squares = fit.find_polynomial(edge, degree);
  // Hardly more nodes than unknowns tell nothing.
  const auto unknowns = static_cast<double>(fit.terms() + edge_changes);
  const double left = static_cast<double>(fit.carrying()) - unknowns;
  if (left < unknowns) return std::nullopt;
  for (int iteration = 0; iteration < limit; ++iteration) {
    const MatrixXd derivative = fit.derivative(edge);
    const MatrixXd normal = derivative.transpose() * derivative;
    const VectorXd descent = derivative.transpose() * fit.left_over();
    bool settled = false;
    for (bool better = false; !better && !settled;) {
      MatrixXd damped = normal;
      damped.diagonal() *= 1 + damping;
      Eigen::Vector3d step = damped.ldlt().solve(descent);
      if (!step.allFinite()) return std::nullopt;
      step = step.cwiseMax(-longest_step).cwiseMin(longest_step);
      const ContactEdge next = changed(edge, step);
      const double with_step = fit.find_polynomial(next, degree);
      better = with_step <= squares;
      settled = step.cwiseAbs().maxCoeff() < tolerance || damping > 1e6;
      if (better) {
        edge = next;
        squares = with_step;
        damping = std::max(1e-9, damping / 10);
      } else {
        damping *= 10;
        fit.find_polynomial(edge, degree);
      }
    }
    if (!settled) continue;
    if (fit.left_faces()) return std::nullopt;
    // Generalised cross-validation: what an unseen node would miss.
    return Candidate{edge, degree, squares, squares / (left * left)};
  }
  return std::nullopt;
}

/// Pressures of a fit whose residual is larger are not those of one smooth patch.
constexpr double largest_residual = 0.08;

}  // namespace

std::optional<PressureFit> fit_pressure(const NodalPressure& pressure, const ContactEdge& edge) {
  Fit fit(pressure);
  // The thinner the layer, the flatter the pressure inside and the steeper at the edge (lengths are
  // in units of the thickness).
  const int first = std::min(edge.a, edge.b) < 4 ? 2 : 3, highest = pressure.layered ? 6 : first;
  std::vector<Candidate> found;
  double validated = std::numeric_limits<double>::infinity();
  for (int degree = first; degree <= highest; ++degree)
    if (const auto candidate = fit_of_degree(fit, edge, degree)) {
      found.push_back(*candidate);
      validated = std::min(validated, candidate->validated);
    }
  // The simplest fit is taken of those that are as good as any, within the discretisation's noise.
  constexpr double as_good = 1.15;
  found.erase(
      std::remove_if(found.begin(), found.end(),
                     [&](const Candidate& one) { return one.validated > as_good * validated; }),
      found.end());
  if (found.empty()) return std::nullopt;
  const Candidate* best = &found.front();
  fit.find_polynomial(best->edge, best->degree);
  PressureFit result;
  result.edge = best->edge;
  result.degree = best->degree;
  for (const Candidate& other : found)
    result.ambiguity = std::max({result.ambiguity, std::abs(other.edge.a / best->edge.a - 1),
                                 std::abs(other.edge.b / best->edge.b - 1)});
  const double area = M_PI / 4 * best->edge.a * best->edge.b;
  result.residual = std::sqrt(best->squares / area) / (pressure.force.sum() / area);
  if (!(result.residual < largest_residual)) return std::nullopt;
  result.centre_pressure = fit.pressure_at(0, 0, 0);
  constexpr int steps = 64;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      const double t = M_PI / 2 * j / (steps - 1.0), r = i / (1.0 * steps);
      const double rho = result.edge.radius(t);
      result.peak =
          std::max(result.peak, fit.pressure_at(r * rho * std::cos(t), r * rho * std::sin(t), r));
    }
  return result;
}

}  // namespace softfinger::fem
