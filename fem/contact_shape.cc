#include "fem/contact_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/input/errors.h"

namespace softfinger::fem {

using Eigen::Index;
using Eigen::Vector2d;

namespace {

/// Centre of the nodal forces in the block.
Vector2d centre_of(const NodalPressure& pressure) {
  if (!pressure.whole) return Vector2d::Zero();
  Vector2d moment = Vector2d::Zero();
  for (std::size_t i = 0; i < pressure.nodes.size(); ++i)
    moment += pressure.force[static_cast<Index>(i)] *
              Vector2d(pressure.nodes[i].x, pressure.nodes[i].y);
  return moment / pressure.force.sum();
}

/// Polygons that stand for a smooth curve: their area is 2e-5 too small.
constexpr Index fine_points = 512;

void describe(const OutlineShape& shape, ContactShape& contact) {
  contact.a = shape.a;
  contact.b = shape.b;
  contact.turn_rad = shape.turn_rad;
  contact.projected_area = shape.area;
  contact.departure = shape.departure;
}

/// A quarter has the places of its own quadrant only.
Vector2d seen_along_load(const NodalContact& contact, const Vector2d& at) {
  if (contact.pressure.whole) return contact.place(at);
  const Vector2d there = contact.place(at.cwiseAbs());
  return {std::copysign(there.x(), at.x()), std::copysign(there.y(), at.y())};
}

/// @param shape  by the nodes
ContactShape from_fit(const NodalContact& contact, PressureFit fit, ContactShape shape) {
  Eigen::Matrix2Xd outline = fit.edge.outline(fine_points);
  for (Index i = 0; i < outline.cols(); ++i)
    outline.col(i) = seen_along_load(contact, outline.col(i));
  describe(shape_of({outline}), shape);
  if (contact.pressure.whole) {
    shape.block_a = contact.rough_a;
    shape.block_b = contact.rough_b;
  } else {
    // Along x and y by symmetry.
    shape.block_a = fit.edge.a;
    shape.block_b = fit.edge.b;
    shape.a = contact.place({fit.edge.a, 0}).x();
    shape.b = contact.place({0, fit.edge.b}).y();
    shape.turn_rad = 0;
  }
  constexpr Index reported = 128;
  Eigen::Matrix2Xd points(2, reported);
  for (Index i = 0; i < reported; ++i) points.col(i) = outline.col(i * fine_points / reported);
  shape.outlines = {std::move(points)};
  if (!contact.pressure.layered) {
    shape.peak = fit.peak;
    shape.centre_pressure = fit.centre_pressure;
  }
  shape.fit = std::move(fit);
  return shape;
}

ContactShape from_nodes(const NodalContact& contact) {
  const NodalPressure& pressure = contact.pressure;
  const Eigen::VectorXd clearance = contact.clearance();
  ContactShape shape;
  shape.outlines =
      touching_outlines({pressure.nodes, pressure.faces, contact.position, contact.nodal_pressure,
                         clearance, contact.modulus, pressure.whole});
  const OutlineShape outline = shape_of(shape.outlines);
  if (!(outline.area > 0))
    throw ConvergenceError("outline of the contact", 0, outline.area,
                           "the contact is smaller than a cell: use a higher level");
  describe(outline, shape);
  std::sort(shape.outlines.begin(), shape.outlines.end(),
            [](const auto& left, const auto& right) { return left.cols() > right.cols(); });
  shape.block_a = contact.rough_a;
  shape.block_b = contact.rough_b;
  if (!pressure.whole) {
    // The long axis may be any where the contact is round.
    if (std::abs(shape.turn_rad) > M_PI / 4) std::swap(shape.a, shape.b);
    shape.turn_rad = 0;
  }
  shape.peak = contact.nodal_pressure.maxCoeff();
  const Vector2d centre = pressure.whole ? outline.centre : Vector2d::Zero();
  Index nearest = 0;
  (contact.position.colwise() - centre).colwise().squaredNorm().minCoeff(&nearest);
  shape.centre_pressure = contact.nodal_pressure[nearest];
  return shape;
}

}  // namespace

ContactShape measure_shape(const NodalContact& contact) {
  const ContactShape by_nodes = from_nodes(contact);
  if (contact.regular)
    if (std::optional<PressureFit> fit = fit_pressure(contact.pressure, by_nodes.a, by_nodes.b,
                                                      centre_of(contact.pressure)))
      return from_fit(contact, std::move(*fit), by_nodes);
  return by_nodes;
}

}  // namespace softfinger::fem
