#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace softfinger::meshes {

/// How ways lead from a surface to the core that lies everywhere a depth below it, where the
/// surface bends more sharply than one over that depth. In multiples of the depth.
struct Erosion {
  double beyond = 1;        ///< ways point at the nearest place that lies so much deeper still
  double smoothing = 0.25;  ///< length over which their directions are smoothed
};

/// What lies at least a depth below a surface: the body eroded by a ball of that radius. Where the
/// surface bends more sharply than one over the depth its normals cross before they are so deep,
/// and the eroded body has a ridge. The surface is known by samples, kept by cells of a square
/// lattice, so that depths are those below the part of it that is near along the surface: not below
/// the finger's other side.
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

  /// The way, downwards from the top, to the nearest place at this depth or deeper; none where the
  /// body is too thin for one, or it is farther than `longest`. A convex body is the intersection
  /// of the half-spaces below its tangent planes, and eroded of those moved inwards: of these the
  /// ones that matter are found one by one (J. E. Kelley, The Cutting-Plane Method, 1960). To 0.2 %
  /// of the depth.
  /// @param top   a point of the surface
  /// @param i, j  a cell at it
  std::optional<Eigen::Vector3d> way_to(double depth, const Sample& top, int i, int j,
                                        double longest) const;

  /// How far a depth lies along a way from the top, at most `longest`.
  /// @param down  unit
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
