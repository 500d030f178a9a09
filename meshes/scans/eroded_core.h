#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace softfinger::meshes {

/// Search directions from a surface to the core that lies at a uniform depth below it, for surfaces
/// whose curvature exceeds 1/depth. Lengths are multiples of the depth. A "way" is the straight
/// segment from a point of the surface down to the core.
struct Erosion {
  double beyond = 1;        ///< ways aim at the nearest point this much deeper than the core
  double smoothing = 0.25;  ///< length over which their directions are smoothed
};

/// Body eroded by a ball: the points at least a depth below the surface. Where the curvature
/// exceeds 1/depth, normals cross before they reach the depth, and the eroded body has a ridge. The
/// surface is given by samples in the cells of a square lattice; a depth is measured from the
/// samples in cells near by, so that the finger's far side does not count.
class ErodedCore {
 public:
  struct Sample {
    Eigen::Vector3d position, normal;  ///< outward
  };

  /// @param half      cells run from -half to half - 1
  /// @param cell      longest diagonal of a cell with samples, in the surface's unit
  /// @param window    cells around a place that its depth is measured from
  ErodedCore(int half, double cell, int window);
  void add(int i, int j, const Sample& sample);

  /// Returns the vector from the nearest point at this depth or deeper up to `top`; none where the
  /// body is too thin for one, or it is longer than `longest`. A convex body is the intersection of
  /// the half-spaces below its tangent planes, and the eroded body that of these half-spaces moved
  /// inwards by the depth: those that matter are found one by one (J. E. Kelley, The Cutting-Plane
  /// Method, 1960). To 0.2 % of the depth.
  /// @param top   a point of the surface
  /// @param i, j  a cell at it
  std::optional<Eigen::Vector3d> way_to(double depth, const Sample& top, int i, int j,
                                        double longest) const;

  /// Returns the distance from `top` along -`down` at which this depth is reached, at most
  /// `longest`.
  /// @param down  unit vector of a way, `way_to` normalised
  double length_to(double depth, const Sample& top, const Eigen::Vector3d& down, int i, int j,
                   double longest) const;

 private:
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>((i + half_) + 2 * half_ * (j + half_));
  }
  const Sample* nearest(const Eigen::Vector3d& point, int i, int j) const;

  int half_;
  double cell_;
  int window_;
  std::vector<std::vector<Sample>> samples_;  ///< by cell
};

}  // namespace softfinger::meshes
