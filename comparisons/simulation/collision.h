#pragma once

#include <memory>
#include <stdexcept>
#include <vector>

#include "comparisons/input/scene.h"
#include "comparisons/simulation/touching_point.h"
#include "softfinger/dynamics/bodies/multibody.h"

namespace softfinger::simulation {

/// Failure to find where two bodies touch; in words, with their names.
class CollisionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Finds the points where the bodies of a scene touch.
///
/// Two round surfaces touch in one point with a contact ellipse (elliptic_contact.h). Flat and line
/// contacts get the points that hold them: corners, points of a rim, ends of a line
/// (flat_contact.h). FCL finds the pairs of shapes and, of shapes that are no meshes, the nearest
/// points from which both start; those of meshes come from their own triangles (triangle_tree.h).
/// The curvature of a mesh is that of a quadric (Ciocarlie et al. 2007, eq. 7) where one fits it,
/// and its distance that of the mesh itself.
class CollisionDetector {
 public:
  explicit CollisionDetector(const input::Scene& scene);
  ~CollisionDetector();

  /// Appends all points whose gap may close within `time_step_s` at twice the current velocities,
  /// or is smaller than a hundredth of the smaller body's size.
  /// @throws CollisionError
  void find(const Multibody& bodies, double time_step_s, std::vector<TouchingPoint>& points);

  /// Bodies that overlap by more than 1e-4 of the smaller one's size, each pair once.
  struct Overlap {
    int a = -1, b = -1;
    double depth_m = 0;  ///< of the deepest point
  };
  std::vector<Overlap> overlaps(const Multibody& bodies);

  /// @throws InputError(file) when bodies overlap, see `overlaps`.
  void require_no_overlap(const Multibody& bodies);

  /// Number of quadrics that were fitted to meshes so far.
  int fits() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger::simulation
