#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

/// Internal: the convex hull of the vertices of linearised friction.
namespace softfinger::internal {

/// The hull of points of the unit sphere, (f_x, f_y, tau/e_n)/(mu P), that all contacts share.
/// No allocation after construction.
class FrictionPolytope {
 public:
  explicit FrictionPolytope(int most_vertices);

  /// Costs only a comparison where the vertices are those of the last problem, as they mostly are.
  void set(const Eigen::Matrix3Xd& vertices);

  int count() const { return count_; }
  double radius() const { return radius_; }  ///< length of the longest vertex
  Eigen::Vector3d vertex(int index) const { return vertices_.row(index); }

  /// Largest extent of the vertices along `direction`; -infinity without vertices.
  double farthest(const Eigen::Vector3d& direction) const;
  /// Whether any vertex lies farther along `direction` than `most`: the farthest one, else -1.
  int beyond(const Eigen::Vector3d& direction, double most) {
    return beyond(vertices_, direction, most);
  }

  using Facet = std::array<int, 3>;
  /// The facet that a ray from the origin meets. False where there is none: with too few vertices,
  /// or where these do not surround the origin. Facets that were found are kept; to find one of
  /// them again costs a tenth.
  ///
  /// Ray and vertices are moved by up to kMoved of their length, so that the ray meets no edge and
  /// no four vertices lie in a plane. The answer is then unique and does not depend on what was
  /// asked before.
  bool find_facet(const Eigen::Vector3d& direction, Facet& facet);
  static constexpr double kMoved = 1e-8;

 private:
  using Vertices = Eigen::MatrixX3d;  ///< one per row, so that products run along columns
  struct Cone {
    Facet corners;
    Eigen::Matrix3d inverse;  ///< of the matrix whose columns are the corners
    /// `ray` is a sum of the corners with three weights: the least of them, >= 0 inside the cone.
    double least_weight(const Eigen::Vector3d& ray) const { return (inverse * ray).minCoeff(); }
  };
  /// A facet of the hull of a few vertices. A search starts from the one whose cone contains the
  /// ray; the facets of the full hull that it has found are kept here.
  struct CoarseFacet {
    Cone cone;
    std::vector<Cone> found;
  };

  int beyond(const Vertices& vertices, const Eigen::Vector3d& direction, double most);
  void choose_coarse_facets();
  bool search(Cone& cone, const Eigen::Vector3d& ray);
  Eigen::Vector3d moved(int index) const { return moved_.row(index); }

  int count_ = -1;
  double radius_ = 0;
  Vertices vertices_, moved_;
  Eigen::VectorXd along_;
  int coarse_count_ = 0;
  std::vector<CoarseFacet> coarse_;
};

}  // namespace softfinger::internal
