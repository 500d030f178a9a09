#include "fem/layer/fingertip_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "fem/base/formatted.h"
#include "meshes/generation/fingertip_layer.h"
#include "meshes/generation/object_surface.h"
#include "meshes/scans/doubted.h"
#include "meshes/scans/hidden_facets.h"
#include "meshes/scans/scanned_layer.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using Eigen::Vector3d;

class BentLayer : public LayerShape {
 public:
  explicit BentLayer(meshes::FingertipLayer layer) : layer_(std::move(layer)) {}

  Vector3d position(double x, double y, double z) const override {
    return layer_.position(h() * x, h() * y, z) / h();
  }
  Vector3d normal(double x, double y) const override { return layer_.normal(h() * x, h() * y); }
  double area_ratio(double x, double y) const override {
    const Eigen::Matrix3d gradient = layer_.gradient(h() * x, h() * y, 0);
    return gradient.col(0).cross(gradient.col(1)).norm();
  }
  MirrorPlanes planes() const override { return {layer_.symmetric_x(), layer_.symmetric_y()}; }

 private:
  double h() const { return layer_.thickness(); }
  meshes::FingertipLayer layer_;
};

/// Sharp edges farther from the first touch, in thicknesses, do not matter.
constexpr double farthest_edge = 15;

std::optional<meshes::Erosion> erosion_of(CoreWays ways) {
  const meshes::Erosion usual;
  switch (ways) {
    case CoreWays::eroded:
      return usual;
    case CoreWays::eroded_nearer:
      return meshes::Erosion{usual.beyond / 2, usual.smoothing};
    case CoreWays::eroded_smoother:
      return meshes::Erosion{usual.beyond / 2, 2 * usual.smoothing};
    default:
      return std::nullopt;
  }
}

/// A shape in coordinates in space that begin elsewhere. Those of the block stay.
class MovedShape : public LayerShape {
 public:
  MovedShape(std::shared_ptr<const LayerShape> shape, const Eigen::Vector2d& origin)
      : shape_(std::move(shape)), origin_(origin.x(), origin.y(), 0) {}

  std::shared_ptr<const LayerShape> copy() const override {
    const std::shared_ptr<const LayerShape> own = shape_->copy();
    return own ? std::make_shared<MovedShape>(own, origin_.head<2>()) : nullptr;
  }
  Vector3d position(double x, double y, double z) const override {
    return shape_->position(x, y, z) - origin_;
  }
  Vector3d normal(double x, double y) const override { return shape_->normal(x, y); }
  double area_ratio(double x, double y) const override { return shape_->area_ratio(x, y); }
  MirrorPlanes planes() const override {
    MirrorPlanes planes = shape_->planes();
    planes.x = planes.x && origin_.x() == 0;
    planes.y = planes.y && origin_.y() == 0;
    return planes;
  }
  void cover(double radius) const override { shape_->cover(radius); }
  Cover covers(double low_x, double high_x, double low_y, double high_y) const override {
    return shape_->covers(low_x, high_x, low_y, high_y);
  }
  bool has_edges() const override { return shape_->has_edges(); }
  double beyond_edge(double x, double y) const override { return shape_->beyond_edge(x, y); }

 private:
  std::shared_ptr<const LayerShape> shape_;
  Vector3d origin_;
};

/// A scan's layer, with the first touch as its origin. It is laid as far as it is asked for.
class ScanShape : public LayerShape {
 public:
  ScanShape(std::shared_ptr<const meshes::SmoothSurface> surface,
            std::shared_ptr<const meshes::SmoothSurface> core,
            const meshes::SmoothSurface::Point& first_touch, double thickness_m, CoreWays ways)
      : surface_(std::move(surface)),
        core_(std::move(core)),
        first_touch_(first_touch),
        h_(thickness_m),
        erosion_(erosion_of(ways)),
        has_edges_(surface_->edge_near(first_touch, farthest_edge * thickness_m).has_value()) {}

  std::shared_ptr<const LayerShape> copy() const override {
    return std::make_shared<ScanShape>(*this);
  }

  Vector3d position(double x, double y, double z) const override {
    return (layer_->position(h_ * x, h_ * y, z) - first_touch_.position) / h_;
  }
  Vector3d normal(double x, double y) const override { return layer_->normal(h_ * x, h_ * y); }
  double area_ratio(double x, double y) const override {
    return layer_->area_ratio(h_ * x, h_ * y);
  }
  MirrorPlanes planes() const override { return no_plane; }

  void cover(double radius) const override {
    if (radius <= radius_) return;
    // Levels that differ a little in size share a layer.
    constexpr double spare = 1.2;
    radius_ = spare * radius;
    layer_ = std::make_shared<const meshes::ScannedLayer>(*surface_, first_touch_, x_axis(), h_,
                                                          radius_ * h_, core_.get(), erosion_);
  }
  Cover covers(double low_x, double high_x, double low_y, double high_y) const override {
    switch (layer_->end_in(h_ * low_x, h_ * high_x, h_ * low_y, h_ * high_y)) {
      case meshes::ClothEnd::none:
        return Cover::whole;
      case meshes::ClothEnd::edge:
        return Cover::edge;
      case meshes::ClothEnd::rim:
        return Cover::rim;
      default:
        return Cover::cut;
    }
  }

  bool has_edges() const override { return has_edges_; }
  double beyond_edge(double x, double y) const override {
    const auto beyond = surface_->beyond_edge(
        {layer_->position(h_ * x, h_ * y, 0), layer_->normal(h_ * x, h_ * y)});
    return beyond ? *beyond / h_ : -std::numeric_limits<double>::infinity();
  }

 private:
  /// The block's x lies along the nearest sharp edge, so that rows of cells can end at it. Of the
  /// four directions it takes the one nearest to the frame's own x.
  Vector3d x_axis() const {
    const std::optional<Vector3d> edge = surface_->edge_near(first_touch_, farthest_edge * h_);
    if (!edge) return Vector3d::UnitX();
    const Vector3d across = first_touch_.normal.cross(*edge);
    const Vector3d& nearer = std::abs(edge->x()) > std::abs(across.x()) ? *edge : across;
    return std::copysign(1.0, nearer.x()) * nearer;
  }

  std::shared_ptr<const meshes::SmoothSurface> surface_, core_;
  meshes::SmoothSurface::Point first_touch_;
  double h_;
  std::optional<meshes::Erosion> erosion_;
  bool has_edges_ = false;
  mutable double radius_ = 0;
  mutable std::shared_ptr<const meshes::ScannedLayer> layer_;
};

/// The surface's point where the gap to the object is smallest, found from around the aimed point
/// by going down in steps that become smaller.
meshes::SmoothSurface::Point find_first_touch(const meshes::SmoothSurface& surface,
                                              const meshes::ObjectSurface& object,
                                              double thickness_m) {
  const auto gap = [&](const meshes::SmoothSurface::Point& point) {
    const auto height = object.height(point.position.x(), point.position.y());
    return height ? *height - point.position.z() : std::numeric_limits<double>::infinity();
  };
  const auto is_beyond_edge = [&](const meshes::SmoothSurface::Point& point) {
    return surface.beyond_edge(point).value_or(-1) > 0;
  };
  const auto start = surface.project(Vector3d::Zero(), Vector3d::UnitZ());
  if (!start)
    throw InputError("finger", "surface", "none at the aimed point",
                     "a point on the finger's skin");
  meshes::SmoothSurface::Point at = *start;
  double lowest = gap(at);
  constexpr int directions = 16, most_steps = 2000;
  // Bumps and facets make many lowest points: the search begins at the lowest one nearby.
  for (const double radius : {0.5, 1.0, 1.5, 2.0})
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * M_PI * k / directions;
      const auto next = surface.project(
          start->position + radius * thickness_m * Vector3d(std::cos(angle), std::sin(angle), 0),
          start->normal);
      if (!next || next->to_sample > surface.spacing() || is_beyond_edge(*next)) continue;
      if (const double found = gap(*next); found < lowest) {
        at = *next;
        lowest = found;
      }
    }
  double step = thickness_m / 2;
  for (int i = 0; i < most_steps && step > 1e-4 * thickness_m; ++i) {
    meshes::SmoothSurface::Point best = at;
    double best_gap = lowest;
    const Vector3d x = at.normal.unitOrthogonal(), y = at.normal.cross(x);
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * M_PI * k / directions;
      const auto next = surface.project(
          at.position + step * (std::cos(angle) * x + std::sin(angle) * y), at.normal);
      if (!next || next->to_sample > surface.spacing() || is_beyond_edge(*next)) continue;
      if (const double found = gap(*next); found < best_gap) {
        best = *next;
        best_gap = found;
      }
    }
    if (best_gap < lowest) {
      at = best;
      lowest = best_gap;
    } else {
      step /= 2;
    }
  }
  // Along a line, or on a flat, the lowest of the facets' bumps may lie anywhere. So far from the
  // aimed point a curved finger has left the object by more.
  const double bump = 1e-3 * thickness_m;
  if ((at.position - start->position).norm() > thickness_m && gap(*start) <= lowest + bump &&
      !is_beyond_edge(*start))
    at = *start;
  if (!std::isfinite(lowest))
    throw InputError("object", "surface", "none over the aimed point", "an object over the finger");
  constexpr double steepest = 0.5;
  if (!(at.normal.z() > steepest))
    throw InputError(
        "contact", "first touch",
        formatted(
            "x %.4g mm, y %.4g mm from the aimed point, where the finger's surface is inclined "
            "by %.0f degrees",
            1e3 * at.position.x(), 1e3 * at.position.y(), std::acos(at.normal.z()) * 180 / M_PI),
        "an aimed point whose normal points at the object: the finger ends or has an edge here");
  return at;
}

FingertipShape shape_scan(const Fingertip& fingertip, double thickness_m, const Reading& reading,
                          CoreWays ways) {
  // Features below half the thickness are noise, or a layer levels them.
  constexpr double width = 0.5;
  meshes::Smoothing smoothing{width * thickness_m, 60 * M_PI / 180, farthest_facet * thickness_m};
  smoothing.widening = reading.smoothing;
  auto surface = std::make_shared<const meshes::SmoothSurface>(
      reading.doubt > 0
          ? meshes::doubted(*fingertip.scan, smoothing.crease_rad, reading.doubt, reading.pattern)
          : *fingertip.scan,
      smoothing);
  const auto aimed = surface->project(Vector3d::Zero(), Vector3d::UnitZ());
  const Vector3d own_normal = aimed ? aimed->normal : Vector3d::UnitZ();
  const auto turn = Eigen::Quaterniond::FromTwoVectors(
      own_normal, reading.normal && aimed ? *reading.normal : own_normal);
  if (reading.normal)
    surface = std::make_shared<const meshes::SmoothSurface>(surface->turned(turn));
  const meshes::SmoothSurface::Point first =
      find_first_touch(*surface, *fingertip.object, thickness_m);
  FingertipShape result;
  result.reach_x = result.reach_y = std::numeric_limits<double>::infinity();
  result.is_scan = true;
  result.ways = ways;
  result.own_normal = own_normal;
  result.first_touch = first.position / thickness_m;
  std::shared_ptr<const meshes::SmoothSurface> core;
  if (fingertip.core) {
    smoothing.widening = 1;
    meshes::SmoothSurface read(*fingertip.core, smoothing);
    core = std::make_shared<const meshes::SmoothSurface>(reading.normal ? read.turned(turn)
                                                                        : std::move(read));
  }
  result.shape =
      std::make_shared<ScanShape>(std::move(surface), std::move(core), first, thickness_m, ways);
  return result;
}

}  // namespace

Fingertip seen_of(Fingertip fingertip, double thickness_m) {
  const auto see = [&](std::shared_ptr<const TriangleSurface>& surface) {
    if (surface)
      surface = std::make_shared<const TriangleSurface>(
          meshes::seen_surface(*surface, farthest_facet * thickness_m));
  };
  see(fingertip.scan);
  see(fingertip.core);
  return fingertip;
}

FingertipShape shape_fingertip(const Fingertip& fingertip, double thickness_m,
                               const Reading& reading, CoreWays ways) {
  if (fingertip.scan) return shape_scan(fingertip, thickness_m, reading, ways);
  meshes::FingertipLayer layer(fingertip.pad, thickness_m);
  FingertipShape result;
  result.reach_x = layer.reach_x() / thickness_m;
  result.reach_y = layer.reach_y() / thickness_m;
  result.shape = std::make_shared<BentLayer>(std::move(layer));
  return result;
}

FingertipShape FingertipShape::seen_from(const Eigen::Vector2d& place) const {
  FingertipShape result = *this;
  result.centre += place;
  result.shape = std::make_shared<MovedShape>(shape, place);
  return result;
}

}  // namespace softfinger::fem
