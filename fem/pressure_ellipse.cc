#include "fem/pressure_ellipse.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

/// Products X^i Y^j with i + j <= degree.
constexpr int terms_of(int degree) { return (degree + 1) * (degree + 2) / 2; }

/// All terms of the polynomial.
template <int degree>
Eigen::Matrix<double, terms_of(degree), 1> polynomial(double X, double Y) {
  Eigen::Matrix<double, terms_of(degree), 1> values;
  int k = 0;
  double x_power = 1;
  for (int i = 0; i <= degree; ++i, x_power *= X) {
    double term = x_power;
    for (int j = 0; i + j <= degree; ++j, term *= Y) values[k++] = term;
  }
  return values;
}

/// Finds the face under a point: the finest faces form a regular grid.
class FaceGrid {
 public:
  explicit FaceGrid(const std::vector<SurfaceFace>& faces) : faces_(faces) {
    for (const auto& face : faces) {
      size_x_ = face.size_x;
      size_y_ = face.size_y;
      columns_ = std::max(columns_, column(face.x + 0.5 * face.size_x) + 1);
      rows_ = std::max(rows_, row(face.y + 0.5 * face.size_y) + 1);
    }
    index_.assign(static_cast<std::size_t>(columns_ * rows_), -1);
    for (std::size_t i = 0; i < faces.size(); ++i)
      index_[cell(faces[i].x + 0.5 * size_x_, faces[i].y + 0.5 * size_y_)] = static_cast<int>(i);
  }

  /// Enough for about ten points per face along each direction, so that points crossing a face's
  /// edge do not make the moments rough.
  int points_per_quarter() const { return std::max(120, 10 * std::max(columns_, rows_)); }

  const SurfaceFace* find(double x, double y) const {
    if (column(x) >= columns_ || row(y) >= rows_) return nullptr;
    const int i = index_[cell(x, y)];
    return i < 0 ? nullptr : &faces_[static_cast<std::size_t>(i)];
  }

 private:
  int column(double x) const { return static_cast<int>(x / size_x_); }
  int row(double y) const { return static_cast<int>(y / size_y_); }
  std::size_t cell(double x, double y) const {
    return static_cast<std::size_t>(column(x) + columns_ * row(y));
  }

  const std::vector<SurfaceFace>& faces_;
  double size_x_ = 1, size_y_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<int> index_;
};

/// Not of a fixed size, as the polynomials are: the decomposition is compiled once for all degrees.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& target) {
  return matrix.householderQr().solve(target);
}

class Fit {
 public:
  /// @param degree  of the polynomial, 2 or 3
  Fit(int degree, const std::vector<SurfaceNode>& nodes, const std::vector<SurfaceFace>& faces,
      const Eigen::VectorXd& force, const SurfaceDeformation* deformation)
      : degree_(degree),
        faces_(faces),
        grid_(faces),
        deformation_(deformation),
        root_weight_(static_cast<Eigen::Index>(nodes.size())) {
    for (std::size_t i = 0; i < nodes.size(); ++i)
      root_weight_[static_cast<Eigen::Index>(i)] = std::sqrt(nodes[i].weight);
    target_ = force.cwiseQuotient(root_weight_);
  }

  /// Residual with the best polynomial for these semi-axes.
  Eigen::VectorXd residual(double a, double b, double diamond) {
    Eigen::MatrixXd model = degree_ == 2 ? moments<2>(a, b, diamond) : moments<3>(a, b, diamond);
    for (Eigen::Index k = 0; k < model.cols(); ++k) model.col(k).array() /= root_weight_.array();
    coefficients_ = least_squares(model, target_);
    return target_ - model * coefficients_;
  }

  double peak() const { return coefficients_[0]; }
  bool left_patch() const { return left_patch_; }

 private:
  /// Moments of root times polynomial (columns) with every shape function (rows). With the edge at
  /// g(v) in scaled polar coordinates and r = g sin t the root is cos t: dA = a b g² sin t cos t dt
  /// dv. The number of terms is fixed at compile time, because sums over a hundred thousand points
  /// run over them.
  template <int degree>
  Eigen::MatrixXd moments(double a, double b, double diamond) {
    constexpr int terms = terms_of(degree);
    left_patch_ = false;
    const int steps = grid_.points_per_quarter();
    const double step = M_PI / 2 / steps;
    const Eigen::ArrayXd angle = step * (Eigen::ArrayXd::LinSpaced(steps, 0, steps - 1) + 0.5);
    const Eigen::ArrayXd sine = angle.sin(), cosine = angle.cos();
    const Eigen::ArrayXd edge = 1 + diamond * (4 * angle).cos();
    Eigen::Matrix<double, terms, Eigen::Dynamic> result;
    result.setZero(terms, target_.size());
    // Distance of each ray's end from the centre on a deformed surface, x in units of a and y of b.
    Eigen::ArrayXd deformed_edge = Eigen::ArrayXd::Ones(steps);
    const auto deformed_radius = [&](const Eigen::Vector3d& position) {
      return std::hypot(position.x() / a, position.y() / b);
    };
    for (int j = 0; deformation_ && j < steps; ++j) {
      const double x = a * edge[j] * cosine[j], y = b * edge[j] * sine[j];
      if (const SurfaceFace* face = grid_.find(x, y))
        deformed_edge[j] = deformed_radius(point_of(*face, x, y).position);
      else
        left_patch_ = true;
    }
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j) {
        double x = edge[j] * sine[i] * cosine[j], y = edge[j] * sine[i] * sine[j];
        const SurfaceFace* face = grid_.find(a * x, b * y);
        if (!face) {
          left_patch_ = true;
          continue;
        }
        double area = a * b * edge[j] * edge[j] * sine[i] * cosine[i] * step * step;
        const double xi = (a * x - face->x) / face->size_x, eta = (b * y - face->y) / face->size_y;
        const double along_x[] = {(1 - xi) * (1 - 2 * xi), 4 * xi * (1 - xi), xi * (2 * xi - 1)};
        const double along_y[] = {(1 - eta) * (1 - 2 * eta), 4 * eta * (1 - eta),
                                  eta * (2 * eta - 1)};
        double root = cosine[i];
        if (deformation_) {
          const SurfaceDeformation::Point point = point_of(*face, a * x, b * y);
          const double radius = deformed_radius(point.position) / deformed_edge[j];
          root = std::sqrt(std::max(0.0, 1 - radius * radius));
          area *= point.area_ratio;
          x = radius * edge[j] * cosine[j];
          y = radius * edge[j] * sine[j];
        }
        const Eigen::Matrix<double, terms, 1> values =
            area * root * polynomial<degree>(x * x, y * y);
        for (int k = 0; k < 9; ++k)
          if (face->node[static_cast<std::size_t>(k)] >= 0)
            result.col(face->node[static_cast<std::size_t>(k)]) +=
                along_x[k % 3] * along_y[k / 3] * values;
      }
    return result.transpose();
  }

  SurfaceDeformation::Point point_of(const SurfaceFace& face, double x, double y) const {
    return deformation_->at(static_cast<std::size_t>(&face - faces_.data()),
                            (x - face.x) / face.size_x, (y - face.y) / face.size_y);
  }

  int degree_;
  const std::vector<SurfaceFace>& faces_;
  const FaceGrid grid_;
  const SurfaceDeformation* deformation_;
  Eigen::VectorXd root_weight_, target_, coefficients_;
  bool left_patch_ = false;
};

PressureEllipse fit_of_degree(int degree, const std::vector<SurfaceNode>& nodes,
                              const std::vector<SurfaceFace>& faces, const Eigen::VectorXd& force,
                              double a, double b, const SurfaceDeformation* deformation) {
  Fit fit(degree, nodes, faces, force, deformation);
  Eigen::Vector3d unknown(std::log(a), std::log(b), 0);
  const auto residual = [&](const Eigen::Vector3d& u) {
    return fit.residual(std::exp(u[0]), std::exp(u[1]), u[2]);
  };
  Eigen::VectorXd current = residual(unknown);
  // Levenberg-Marquardt in ln a, ln b and the diamond; the polynomial is eliminated. The step of
  // the differences is wide against the quadrature's noise where points cross cell edges.
  constexpr double difference = 2e-3, tolerance = 1e-5;
  double damping = 1e-3;
  constexpr int limit = 60;
  for (int iteration = 0; iteration < limit; ++iteration) {
    Eigen::MatrixXd jacobian(current.size(), 3);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = difference * Eigen::Vector3d::Unit(k);
      jacobian.col(k) = (residual(unknown + step) - residual(unknown - step)) / (2 * difference);
    }
    Eigen::Matrix3d normal = jacobian.transpose() * jacobian;
    normal.diagonal() *= 1 + damping;
    const Eigen::Vector3d descent = jacobian.transpose() * current;
    Eigen::Vector3d step = -normal.ldlt().solve(descent);
    step = step.cwiseMax(-0.1).cwiseMin(0.1);
    const Eigen::VectorXd next = residual(unknown + step);
    const bool better = next.squaredNorm() <= current.squaredNorm();
    if (better) {
      unknown += step;
      current = next;
      damping = std::max(1e-9, damping / 10);
    } else {
      damping *= 10;
    }
    if (step.cwiseAbs().maxCoeff() < tolerance) {
      PressureEllipse ellipse;
      ellipse.a = std::exp(unknown[0]);
      ellipse.b = std::exp(unknown[1]);
      residual(unknown);
      if (fit.left_patch())
        throw ConvergenceError("fit of the contact ellipse", iteration, ellipse.a,
                               "the fitted ellipse reaches beyond the refined patch");
      ellipse.diamond = unknown[2];
      ellipse.peak = fit.peak();
      const double ellipse_area = M_PI / 4 * ellipse.a * ellipse.b;
      ellipse.residual =
          std::sqrt(current.squaredNorm() / ellipse_area) / (force.sum() / ellipse_area);
      return ellipse;
    }
  }
  throw ConvergenceError(
      "fit of the contact ellipse", limit, current.norm() / force.norm(),
      "the pressure is not that of one elliptic contact, or the mesh is too coarse");
}

}  // namespace

PressureEllipse fit_pressure_ellipse(const std::vector<SurfaceNode>& nodes,
                                     const std::vector<SurfaceFace>& faces,
                                     const Eigen::VectorXd& force, double a, double b,
                                     const SurfaceDeformation* deformation) {
  // The thinner the layer, the flatter the pressure inside and the steeper at the edge (lengths are
  // in units of the thickness).
  return fit_of_degree(std::min(a, b) < 4 ? 2 : 3, nodes, faces, force, a, b, deformation);
}

}  // namespace softfinger::fem
