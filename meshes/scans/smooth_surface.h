#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "softfinger/input/triangle_surface.h"

namespace softfinger::meshes {

/// Parameters of the smooth surface through triangles. Lengths in the surface's unit.
struct Smoothing {
  double width = 1;  ///< H: what is smaller than that is smoothed
  double crease_rad =
      60 * 3.14159265358979323846 / 180;  ///< facets that meet more sharply make an edge
  /// Facets farther than this from the origin are ignored.
  double within = 1e300;
  double widening = 1;  ///< factor on H, once it is chosen
};

/// The smooth surface that a triangle mesh stands for, near the origin.
///
/// Each facet becomes a curved PN triangle (A. Vlachos, J. Peters, C. Boyd, J. Mitchell, Curved PN
/// Triangles, I3D 2001), with corner normals averaged over the facets around a vertex that do not
/// meet at a crease, and sampled every 0.6 H: points x_i with normals n_i. Around each sample a
/// quadric f_i is fitted to the 160 nearest of a set of up to six times closer samples, to be zero
/// at them and to have their normals as gradients, with the weights exp(-r²/H²) max(0, n . n_i)².
/// The surface is the zero set of f = sum w_i f_i / sum w_i over the samples nearest to a point in
/// six dimensions, position and normal, so that the two sides of a thin wall do not mix.
///
/// It reproduces quadrics. On meshes of smooth bodies it converges with the square of the facets'
/// edges or faster. Safe to share between threads.
class SmoothSurface {
 public:
  struct Point {
    Eigen::Vector3d position, normal;  ///< on the surface; unit, outward
    double to_sample = 0;  ///< distance to the nearest sample: the mesh ends where that is large
  };

  /// @throws InputError for a surface without facets of any area within reach.
  SmoothSurface(const TriangleSurface& surface, const Smoothing& smoothing);
  SmoothSurface(SmoothSurface&&) noexcept;
  ~SmoothSurface();

  /// Returns the surface turned about the origin.
  SmoothSurface turned(const Eigen::Quaterniond& turn) const;

  /// The surface's point near `from` on the side that faces `normal`, by Newton's method along the
  /// gradient. None where it does not converge.
  std::optional<Point> project(const Eigen::Vector3d& from, const Eigen::Vector3d& normal) const;

  /// Returns how far a point of the surface lies beyond a sharp edge where the surface ends: an
  /// edge of the mesh itself or a crease between facets. Negative on this side of the edge; none
  /// where no such edge is nearby.
  std::optional<double> beyond_edge(const Point& point) const;
  /// Direction of the sharp edge nearest to a point of the surface, within a distance.
  std::optional<Eigen::Vector3d> edge_near(const Point& point, double distance) const;

  /// Width H in use: the median edge near the origin, limited to 1 to 3 times the wanted width,
  /// times `Smoothing::widening`.
  double width() const;
  double spacing() const;  ///< of the samples

  /// Distances of the facets' vertices and centres from the smooth surface, root mean square and
  /// largest, over the facets within a distance from a point of the surface.
  struct Departure {
    double rms = 0, largest = 0;
    int facets = 0;
  };
  Departure departure(const Point& from, double distance) const;

 private:
  struct Implementation;
  explicit SmoothSurface(std::unique_ptr<const Implementation> implementation);
  std::unique_ptr<const Implementation> implementation_;
};

}  // namespace softfinger::meshes
