#include "fem/contact_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/input/errors.h"

namespace softfinger::fem {

using Eigen::Index;
using Eigen::Vector2d;

namespace {

/// An ellipse along x and y with the second moments of the nodes that touch, in the block.
ContactEdge touching_ellipse(const std::vector<SurfaceNode>& nodes, const Eigen::VectorXd& force,
                             bool whole) {
  double area = 0;
  Vector2d first = Vector2d::Zero(), second = Vector2d::Zero();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!(force[static_cast<Index>(i)] > 0)) continue;
    const Vector2d at(nodes[i].x, nodes[i].y);
    area += nodes[i].weight;
    first += nodes[i].weight * at;
    second += nodes[i].weight * at.cwiseAbs2();
  }
  ContactEdge edge;
  if (whole) edge.centre = first / area;
  const Vector2d axes = 2 * (second / area - edge.centre.cwiseAbs2()).cwiseSqrt();
  edge.a = axes.x();
  edge.b = axes.y();
  return edge;
}

/// Points that stand for a smooth curve in results.
constexpr Index reported_points = 128;

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
  const Vector2d there = contact.place(at.cwiseAbs());
  return {std::copysign(there.x(), at.x()), std::copysign(there.y(), at.y())};
}

/// @param shape  by the nodes
ContactShape from_fit(const NodalContact& contact, PressureFit fit, ContactShape shape) {
  Eigen::Matrix2Xd outline = fit.edge.outline(fine_points);
  for (Index i = 0; i < outline.cols(); ++i)
    outline.col(i) = seen_along_load(contact, outline.col(i));
  describe(shape_of({outline}), shape);
  // Along x and y by symmetry.
  shape.block_a = fit.edge.a;
  shape.block_b = fit.edge.b;
  shape.a = contact.place({fit.edge.a, 0}).x();
  shape.b = contact.place({0, fit.edge.b}).y();
  shape.turn_rad = 0;
  Eigen::Matrix2Xd points(2, reported_points);
  for (Index i = 0; i < reported_points; ++i)
    points.col(i) = outline.col(i * fine_points / reported_points);
  shape.outlines = {std::move(points)};
  if (!contact.pressure.layered) {
    shape.peak = fit.peak;
    shape.centre_pressure = fit.centre_pressure;
  }
  shape.fit = std::move(fit);
  return shape;
}

/// A single outline becomes a smooth curve, if one follows it as closely as it is known.
void smooth(std::vector<Eigen::Matrix2Xd>& outlines) {
  if (outlines.size() != 1) return;
  constexpr int harmonics = 8;
  constexpr double known = 0.02;  // a fifth of a cell or less
  if (const std::optional<ContactEdge> edge = smooth_edge(outlines.front(), harmonics, known))
    outlines.front() = edge->outline(reported_points);
}

ContactShape from_nodes(const NodalContact& contact) {
  const NodalPressure& pressure = contact.pressure;
  const Eigen::VectorXd clearance = contact.clearance();
  ContactShape shape;
  shape.outlines =
      touching_outlines({pressure.nodes, pressure.faces, contact.position, contact.nodal_pressure,
                         clearance, contact.modulus, contact.whole});
  OutlineShape outline = shape_of(shape.outlines);
  if (!(outline.area > 0))
    throw ConvergenceError("outline of the contact", 0, outline.area,
                           "the contact is smaller than a cell: use a higher level");
  if (contact.regular) {
    // Nodes just beyond the edge touch now and then: against fits of round contacts (nu 0.3 to
    // 0.4999, a/h 0.1 to 2) the outline lay 0.03 cells outside, +-0.015.
    constexpr double outside = 0.03;
    const SurfaceFace& face = pressure.faces.front();
    const double cells = std::sqrt(outline.area / (face.size_x * face.size_y) / M_PI);
    for (Eigen::Matrix2Xd& points : shape.outlines)
      points =
          ((points.colwise() - outline.centre) * (1 - outside / cells)).colwise() + outline.centre;
  }
  smooth(shape.outlines);
  outline = shape_of(shape.outlines);
  describe(outline, shape);
  std::sort(shape.outlines.begin(), shape.outlines.end(),
            [](const auto& left, const auto& right) { return left.cols() > right.cols(); });
  shape.block_a = contact.rough_a;
  shape.block_b = contact.rough_b;
  if (contact.whole && contact.regular) {
    const Vector2d axes = holding_axes(pressure.nodes, pressure.force);
    shape.block_a = axes.x();
    shape.block_b = axes.y();
  }
  if (!contact.whole) {
    // The long axis may be any where the contact is round.
    if (std::abs(shape.turn_rad) > M_PI / 4) std::swap(shape.a, shape.b);
    shape.turn_rad = 0;
  }
  shape.peak = contact.nodal_pressure.maxCoeff();
  const Vector2d centre = contact.whole ? outline.centre : Vector2d::Zero();
  Index nearest = 0;
  (contact.position.colwise() - centre).colwise().squaredNorm().minCoeff(&nearest);
  shape.centre_pressure = contact.nodal_pressure[nearest];
  return shape;
}

}  // namespace

Vector2d holding_axes(const std::vector<SurfaceNode>& nodes, const Eigen::VectorXd& force) {
  const ContactEdge ellipse = touching_ellipse(nodes, force, true);
  double reach = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (force[static_cast<Index>(i)] > 0)
      reach = std::max(reach, std::hypot(nodes[i].x / ellipse.a, nodes[i].y / ellipse.b));
  return {reach * ellipse.a, reach * ellipse.b};
}

ContactShape measure_shape(const NodalContact& contact) {
  ContactShape by_nodes = from_nodes(contact);
  // Without symmetry the pressure may have any shape, and fits of it scatter more than the nodes.
  if (contact.whole || !contact.regular) return by_nodes;
  if (std::optional<PressureFit> fit =
          fit_pressure(contact.pressure,
                       touching_ellipse(contact.pressure.nodes, contact.pressure.force, false)))
    return from_fit(contact, std::move(*fit), std::move(by_nodes));
  return by_nodes;
}

}  // namespace softfinger::fem
