#include "fem/finite/deformed_contact.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

#include "fem/pressing.h"
#include "fem/pressure_ellipse.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {
namespace {

/// The present surface over the block's plane, biquadratic on each face.
class DeformedSurface : public SurfaceDeformation {
 public:
  explicit DeformedSurface(const FiniteLayer& layer) : faces_(layer.faces()) {
    for (std::size_t i = 0; i < faces_.size(); ++i) positions_.push_back(layer.face_positions(i));
  }

  Point at(double x, double y) const {
    const std::size_t face = index_at(x, y);
    return at(face, (x - faces_[face].x) / faces_[face].size_x,
              (y - faces_[face].y) / faces_[face].size_y);
  }

  Point at(std::size_t index, double xi, double eta) const override {
    const SurfaceFace& face = faces_[index];
    const auto values = [](double t) {
      return Eigen::Vector3d((1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1));
    };
    const auto slopes = [](double t) { return Eigen::Vector3d(4 * t - 3, 4 - 8 * t, 4 * t - 1); };
    const Eigen::Vector3d along_x = values(xi), along_y = values(eta);
    const Eigen::Vector3d slope_x = slopes(xi) / face.size_x, slope_y = slopes(eta) / face.size_y;
    Point result{Eigen::Vector3d::Zero(), 0};
    Eigen::Vector3d by_x = Eigen::Vector3d::Zero(), by_y = Eigen::Vector3d::Zero();
    for (int k = 0; k < 9; ++k) {
      const Eigen::Vector3d& node = positions_[index][static_cast<std::size_t>(k)];
      result.position += along_x[k % 3] * along_y[k / 3] * node;
      by_x += slope_x[k % 3] * along_y[k / 3] * node;
      by_y += along_x[k % 3] * slope_y[k / 3] * node;
    }
    result.area_ratio = by_x.cross(by_y).norm();
    return result;
  }

 private:
  std::size_t index_at(double x, double y) const {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const SurfaceFace& face = faces_[i];
      const double xi = (x - face.x) / face.size_x, eta = (y - face.y) / face.size_y;
      if (xi > -1e-9 && xi < 1 + 1e-9 && eta > -1e-9 && eta < 1 + 1e-9) return i;
    }
    throw ConvergenceError("measurement of the deformed contact", 0, std::hypot(x, y),
                           "its edge lies beyond the refined patch");
  }

  const std::vector<SurfaceFace>& faces_;
  std::vector<std::array<Eigen::Vector3d, 9>> positions_;
};

/// Fits the edge.
DeformedContact measure_quarter(const FinitePressing& pressing) {
  const FiniteLayer& layer = pressing.layer();
  const Equilibrium& equilibrium = pressing.equilibrium();
  const DeformedSurface surface(layer);
  const PressureEllipse ellipse =
      fit_pressure_ellipse(layer.nodes(), layer.faces(), equilibrium.normal_force,
                           equilibrium.moment_a, equilibrium.moment_b, &surface);
  DeformedContact contact;
  contact.block_a = ellipse.a;
  contact.block_b = ellipse.b;
  contact.fit_residual = ellipse.residual;
  // The edge is at 1 + e4 cos 4t; the axes' ends are those of the best ellipse, as in linear
  // theory.
  contact.a = surface.at(ellipse.a, 0).position.x();
  contact.b = surface.at(0, ellipse.b).position.y();
  contact.peak = ellipse.peak;

  // Midpoints in scaled polar coordinates.
  constexpr int steps = 64;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      const double angle = M_PI / 2 * (j + 0.5) / steps;
      const double edge = 1 + ellipse.diamond * std::cos(4 * angle);
      const double radius = edge * (i + 0.5) / steps;
      const double block_area =
          ellipse.a * ellipse.b * radius * (edge / steps) * (M_PI / 2 / steps);
      contact.area +=
          4 * block_area *
          surface.at(ellipse.a * radius * std::cos(angle), ellipse.b * radius * std::sin(angle))
              .area_ratio;
    }
  return contact;
}

/// By the area on which nodes touch and by second moments.
DeformedContact measure_whole(const FinitePressing& pressing) {
  const TouchingNodes nodes = pressing.touching_nodes();
  const LayerDiscretisation& mesh = pressing.layer().discretisation();
  const Eigen::VectorXd area = nodal_area(pressing)(nodes.node);
  DeformedContact contact;
  contact.block_a = pressing.equilibrium().moment_a;
  contact.block_b = pressing.equilibrium().moment_b;
  contact.peak = nodes.normal_force.cwiseQuotient(area).maxCoeff();
  // A node beyond the edge touches if enough of its shape function lies inside: on average nodes do
  // up to an eighth of a cell beyond it, in every contact, for all edges look the same from nearby.
  constexpr double beyond = 1.0 / 8;
  const double inside = (1 - beyond * mesh.a / (mesh.elements_along_a() * contact.block_a)) *
                        (1 - beyond * mesh.b / (mesh.elements_per_semi_axis * contact.block_b));
  contact.area = inside * area.sum();
  double projected = 0;
  for (Eigen::Index i = 0; i < nodes.size(); ++i)
    projected += inside * area[i] * nodes.axes[static_cast<std::size_t>(i)](2, 2);
  const PressureMoments moments = moments_of(nodes.position.topRows<2>(), nodes.force);
  const double stretch = std::sqrt(moments.major / moments.minor);
  contact.a = std::sqrt(projected / M_PI * stretch);
  contact.b = std::sqrt(projected / M_PI / stretch);
  contact.turn_rad = moments.turn_rad;
  return contact;
}

}  // namespace

DeformedContact measure(const FinitePressing& pressing) {
  DeformedContact contact =
      pressing.layer().whole() ? measure_whole(pressing) : measure_quarter(pressing);
  const Equilibrium& equilibrium = pressing.equilibrium();
  double moment = 0, projected = 0;
  for (std::size_t i = 0; i < pressing.layer().nodes().size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double radius = pressing.layer().position(i).head<2>().norm();
    moment += equilibrium.normal_force[row] * radius;
    projected += equilibrium.force[row] * radius;
  }
  contact.torque_arm = moment / equilibrium.force.sum();
  contact.projected_arm = projected / equilibrium.force.sum();
  return contact;
}

Eigen::VectorXd nodal_area(const FinitePressing& pressing) {
  const FiniteLayer& layer = pressing.layer();
  const DeformedSurface surface(layer);
  Eigen::VectorXd area = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layer.nodes().size()));
  // As the shares of the undeformed block: Simpson's weights are the integrals of the biquadratic
  // shape functions.
  constexpr double simpson[] = {1.0 / 6, 4.0 / 6, 1.0 / 6};
  for (std::size_t i = 0; i < layer.faces().size(); ++i) {
    const SurfaceFace& face = layer.faces()[i];
    for (std::size_t k = 0; k < 9; ++k)
      if (face.node[k] >= 0)
        area[face.node[k]] +=
            simpson[k % 3] * simpson[k / 3] * face.size_x * face.size_y *
            surface.at(i, 0.5 * static_cast<double>(k % 3), 0.5 * static_cast<double>(k / 3))
                .area_ratio;
  }
  return area;
}

Eigen::VectorXd nodal_pressure(const FinitePressing& pressing) {
  return pressing.equilibrium().normal_force.cwiseQuotient(nodal_area(pressing));
}

}  // namespace softfinger::fem::finite
