#include "fem/contact/contact_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "fem/base/threads.h"
#include "meshes/generation/planar_triangulation.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

using Eigen::Index;
using Eigen::Vector2d;

namespace {

/// An ellipse along x and y with the second moments of the nodes that touch, in the block.
ContactEdge touching_ellipse(const std::vector<SurfaceNode>& nodes, const Eigen::VectorXd& force,
                             MirrorPlanes planes) {
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
  edge.centre = planes.middle(first / area);
  const Vector2d axes = 2 * (second / area - edge.centre.cwiseAbs2()).cwiseSqrt();
  edge.a = axes.x();
  edge.b = axes.y();
  return edge;
}

/// Points that stand for a smooth curve in results.
constexpr Index reported_points = 128;

/// Polygons that stand for a smooth curve: their area is 2e-5 too small.
constexpr Index fine_points = 512;

/// A smooth curve has more points than a reader needs: some of them are reported.
Eigen::Matrix2Xd reported(const Eigen::Matrix2Xd& outline) {
  Eigen::Matrix2Xd points(2, reported_points);
  for (Index i = 0; i < reported_points; ++i)
    points.col(i) = outline.col(i * fine_points / reported_points);
  return points;
}

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
  shape.outlines = {reported(outline)};
  if (!contact.pressure.layered) {
    shape.peak = fit.peak;
    shape.centre_pressure = fit.centre_pressure;
  }
  shape.fit = std::move(fit);
  return shape;
}

/// A single outline becomes a smooth curve of fine points, if one follows it as closely as it is
/// known.
/// @returns whether it has become one
bool smooth(std::vector<Eigen::Matrix2Xd>& outlines) {
  if (outlines.size() != 1) return false;
  constexpr int harmonics = 8;
  constexpr double known = 0.02;  // a fifth of a cell or less
  const std::optional<ContactEdge> edge = smooth_edge(outlines.front(), harmonics, known);
  if (edge) outlines.front() = edge->outline(fine_points);
  return edge.has_value();
}

/// Side of the cells that touch, which have four nodes each; their mean where they differ.
double mean_cell(const NodalPressure& pressure) {
  double area = 0;
  Index touching = 0;
  for (Index i = 0; i < pressure.force.size(); ++i) {
    if (!(pressure.force[i] > 0)) continue;
    area += pressure.nodes[static_cast<std::size_t>(i)].weight;
    ++touching;
  }
  return 2 * std::sqrt(area / static_cast<double>(touching));
}

/// Whether a contact reaches the finger's edge.
bool is_cut_off(const NodalPressure& pressure) {
  for (std::size_t i = 0; i < pressure.nodes.size(); ++i)
    if (pressure.nodes[i].on_edge && pressure.force[static_cast<Index>(i)] > 0) return true;
  return false;
}

/// @param moved  of these points, those on the finger's edge go back
void keep_on_edge(const NodalContact& contact, const Eigen::Matrix2Xd& points,
                  Eigen::Matrix2Xd& moved) {
  const auto& nodes = contact.pressure.nodes;
  for (Index i = 0; i < points.cols(); ++i)
    for (std::size_t node = 0; node < nodes.size(); ++node)
      if (nodes[node].on_edge && contact.position.col(static_cast<Index>(node)) == points.col(i))
        moved.col(i) = points.col(i);
}

Outcome<ContactShape, Unmeasured> from_nodes(const NodalContact& contact) {
  const NodalPressure& pressure = contact.pressure;
  const Eigen::VectorXd clearance = contact.clearance();
  ContactShape shape;
  TouchingState touching{pressure.nodes, pressure.faces,  contact.position, contact.nodal_pressure,
                         clearance,      contact.modulus, contact.planes};
  if (!contact.regular) {
    const auto lock = lock_global_state();
    touching.triangles = meshes::triangulate(contact.position);
  }
  Outcome<std::vector<Eigen::Matrix2Xd>, OutgrownPatch> outlines = touching_outlines(touching);
  if (!outlines) return Unmeasured{true, outlines.reason().error};
  shape.outlines = *std::move(outlines);
  if (!(shape_of(shape.outlines).area > 0))
    return Unmeasured{
        false,
        {"outline of the contact", 0, 0, "the contact is smaller than a cell: use a higher level"}};
  // At the finger's edge a contact is cut off: its outline has corners, and lies where it does.
  const bool is_cut = is_cut_off(pressure);
  const bool is_smooth = !is_cut && smooth(shape.outlines);
  if (contact.regular) {
    const SurfaceFace& face = pressure.faces.front();
    shape.cell = std::sqrt(face.size_x * face.size_y);
  }
  const double cell = contact.regular ? shape.cell : mean_cell(pressure);
  // The shift is the same all around: a share of the radius would make ellipses too round.
  for (Eigen::Matrix2Xd& points : shape.outlines) {
    Eigen::Matrix2Xd moved = moved_left(points, contact.outline_outside * cell);
    if (is_cut) keep_on_edge(contact, points, moved);
    points = std::move(moved);
  }
  const OutlineShape outline = shape_of(shape.outlines);
  describe(outline, shape);
  if (is_smooth) shape.outlines.front() = reported(shape.outlines.front());
  std::sort(shape.outlines.begin(), shape.outlines.end(),
            [](const auto& left, const auto& right) { return left.cols() > right.cols(); });
  shape.block_a = contact.rough_a;
  shape.block_b = contact.rough_b;
  if (!contact.planes.both() && contact.regular) {
    const Vector2d axes = holding_axes(pressure.nodes, pressure.force, contact.planes);
    shape.block_a = axes.x();
    shape.block_b = axes.y();
  }
  if (contact.planes.any()) {
    // The long axis lies along x or y, though where the contact is round it may be any.
    const bool along_y = std::abs(shape.turn_rad) > M_PI / 4;
    shape.turn_rad = along_y ? M_PI / 2 : 0;
  }
  if (contact.planes.both() && shape.turn_rad > 0) {
    std::swap(shape.a, shape.b);
    shape.turn_rad = 0;
  }
  shape.peak = contact.nodal_pressure.maxCoeff();
  const Vector2d centre = contact.planes.middle(outline.centre);
  Index nearest = 0;
  (contact.position.colwise() - centre).colwise().squaredNorm().minCoeff(&nearest);
  shape.centre_pressure = contact.nodal_pressure[nearest];
  return shape;
}

}  // namespace

Vector2d axes_of_moments(const std::vector<SurfaceNode>& nodes, const Eigen::VectorXd& force) {
  const double total = force.sum();
  Vector2d second = Vector2d::Zero();
  for (std::size_t i = 0; i < nodes.size(); ++i)
    second += force[static_cast<Index>(i)] / total * Vector2d(nodes[i].x, nodes[i].y).cwiseAbs2();
  double fourth = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    fourth +=
        force[static_cast<Index>(i)] / total *
        std::pow(nodes[i].x * nodes[i].x / second.x() + nodes[i].y * nodes[i].y / second.y(), 2);
  // <r²> = 1 / (n + 2) and <r⁴> = 2 / ((n + 2) (n + 3)); <x²> is half of <r²>. With the second
  // moments scaled to 1, <r⁴> / <r²>² is a quarter of the fourth. It gives a² / <x²> = 2 (n + 2): 5
  // for a half-space, 6 for a thin compressible layer, 8 for a thin incompressible one. Up to 6 one
  // number is used, for an error of 5 % does not matter and coarse cells blur the fourth moments.
  constexpr double usual = 5.4, compressible_film = 6, incompressible_film = 8;
  const double ratio = std::min(fourth / 4, 1.9);
  const double told = std::clamp(2 * ratio / (2 - ratio), compressible_film, incompressible_film);
  const double square_per_moment = usual + (incompressible_film - usual) *
                                               (told - compressible_film) /
                                               (incompressible_film - compressible_film);
  return (square_per_moment * second).cwiseSqrt();
}

Vector2d holding_axes(const std::vector<SurfaceNode>& nodes, const Eigen::VectorXd& force,
                      MirrorPlanes planes) {
  const ContactEdge ellipse = touching_ellipse(nodes, force, planes);
  double reach = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (force[static_cast<Index>(i)] > 0)
      reach = std::max(reach, std::hypot(nodes[i].x / ellipse.a, nodes[i].y / ellipse.b));
  return {reach * ellipse.a, reach * ellipse.b};
}

double mean_secant(const std::vector<Eigen::Matrix2Xd>& outlines, const RigidObject& object) {
  // Triangles from a common point to each piece of an outline, negative ones included. Along them
  // Gauss's points for the weight 2 s, exact up to s³.
  constexpr double root = 0.24494897427831781;  // sqrt(6) / 10
  constexpr std::array<double, 2> fraction{0.6 - root, 0.6 + root};
  constexpr double uneven = 0.13608276348795434;  // sqrt(6) / 18
  constexpr std::array<double, 2> weight{0.5 - uneven, 0.5 + uneven};
  double area = 0, surface = 0;
  for (const Eigen::Matrix2Xd& outline : outlines) {
    const Vector2d centre = outlines.front().rowwise().mean();
    for (Index i = 0; i < outline.cols(); ++i) {
      const Vector2d p = outline.col(i) - centre,
                     q = outline.col((i + 1) % outline.cols()) - centre;
      const double triangle = (p.x() * q.y() - q.x() * p.y()) / 2;
      area += triangle;
      for (std::size_t k = 0; k < 2; ++k) {
        const Vector2d at = centre + fraction[k] * (p + q) / 2;
        const std::optional<ObjectHeight> there = object.over(at.x(), at.y());
        const double slope = there ? there->slope.norm() : 0;
        surface += weight[k] * triangle * std::hypot(1, slope);
      }
    }
  }
  return surface / area;
}

Outcome<ContactShape, Unmeasured> measure_shape(const NodalContact& contact) {
  Outcome<ContactShape, Unmeasured> by_nodes = from_nodes(contact);
  if (!by_nodes) return by_nodes;
  // Without both planes the pressure may have any shape, and fits of it scatter more than the
  // nodes.
  if (!contact.planes.both() || !contact.regular) return by_nodes;
  if (std::optional<PressureFit> fit = fit_pressure(
          contact.pressure,
          touching_ellipse(contact.pressure.nodes, contact.pressure.force, contact.planes)))
    return from_fit(contact, std::move(*fit), *std::move(by_nodes));
  return by_nodes;
}

}  // namespace softfinger::fem
