#include "fem/finite/deformed_contact.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

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

/// The outline of the nodes lies outside the edge by this many cells. How nodes beside the edge
/// give way depends on what the elements project on linear functions. The logarithmic neo-Hookean
/// law has lambda there, as linear elasticity (pressing.cc); all others have the whole bulk
/// modulus: 0.05 cells, +-0.01, on 12 turned ellipses (nu 0.3 to 0.46, d/h 0.03 to 0.31, level 2)
/// against fits of the same contact's quarter on level 3; 0.037, +-0.007, on three round ones (nu
/// 0.3 and 0.49, d/h 0.2 and 0.4) against an axisymmetric solution.
double outline_outside(const MaterialChoice& material) {
  const bool as_in_linear_elasticity = material.name == MaterialName::neo_hookean &&
                                       material.volumetric == VolumetricLaw::logarithmic;
  return as_in_linear_elasticity ? 0.03 : 0.045;
}

}  // namespace

Outcome<DeformedContact, Unmeasured> measure(const FinitePressing& pressing, double surface_modulus,
                                             const MaterialChoice& material) {
  const FiniteLayer& layer = pressing.layer();
  const Equilibrium& equilibrium = pressing.equilibrium();
  const auto& nodes = layer.nodes();
  const DeformedSurface surface(layer);
  NodalContact nodal(
      {nodes, layer.faces(), equilibrium.normal_force, layer.sublayers() > 1, &surface});
  nodal.planes = layer.planes();
  nodal.rough_a = equilibrium.moment_a;
  nodal.rough_b = equilibrium.moment_b;
  nodal.nodal_pressure = nodal_pressure(pressing);
  nodal.position.resize(2, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    nodal.position.col(static_cast<Eigen::Index>(i)) = layer.position(i).head<2>();
  nodal.place = [&](const Eigen::Vector2d& at) -> Eigen::Vector2d {
    return surface.at(at.x(), at.y()).position.head<2>();
  };
  nodal.clearance = [&] { return pressing.clearance(); };
  nodal.modulus = surface_modulus;
  nodal.regular = layer.has_grid();
  nodal.outline_outside = outline_outside(material);
  DeformedContact contact;
  Outcome<ContactShape, Unmeasured> shape = measure_shape(nodal);
  if (!shape) return shape.reason();
  contact.shape = *std::move(shape);
  contact.area =
      contact.shape.projected_area * mean_secant(contact.shape.outlines, *pressing.object());
  const Eigen::Vector2d centre =
      layer.planes().middle(nodal.position * equilibrium.force / equilibrium.force.sum());
  double moment = 0, projected = 0;
  for (Eigen::Index row = 0; row < equilibrium.force.size(); ++row) {
    const double radius = (nodal.position.col(row) - centre).norm();
    moment += equilibrium.normal_force[row] * radius;
    projected += equilibrium.force[row] * radius;
  }
  contact.centre = centre;
  contact.torque_arm = moment / equilibrium.force.sum();
  contact.projected_arm = projected / equilibrium.force.sum();
  return contact;
}

Eigen::VectorXd nodal_area(const FiniteLayer& layer) {
  const DeformedSurface surface(layer);
  Eigen::VectorXd area = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layer.nodes().size()));
  // As the shares of the undeformed block: Simpson's weights are the integrals of the biquadratic
  // shape functions.
  constexpr double simpson[] = {1.0 / 6, 4.0 / 6, 1.0 / 6};
  for (std::size_t i = 0; i < layer.faces().size(); ++i) {
    const SurfaceFace& face = layer.faces()[i];
    for (std::size_t k = 0; k < 9; ++k)
      for (const auto& [node, share] : layer.node_shares(i, k))
        area[node] +=
            share * simpson[k % 3] * simpson[k / 3] * face.size_x * face.size_y *
            surface.at(i, 0.5 * static_cast<double>(k % 3), 0.5 * static_cast<double>(k / 3))
                .area_ratio;
  }
  return area;
}

Eigen::VectorXd nodal_pressure(const FinitePressing& pressing) {
  return pressing.equilibrium().normal_force.cwiseQuotient(nodal_area(pressing.layer()));
}

}  // namespace softfinger::fem::finite
