#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

/// Internal: the vertices of linearised friction as a convex hull that can be asked for directions.
namespace softfinger::internal {

/// The hull of points of the unit sphere, (f_x, f_y, tau/e_n)/(mu P), that all contacts share.
/// No allocation after construction.
class FrictionPolytope {
 public:
  explicit FrictionPolytope(int most_vertices);

  /// Mostly the same vertices as in the last problem: then this costs a comparison.
  void set(const Eigen::Matrix3Xd& vertices);

  int count() const { return count_; }
  double radius() const { return radius_; }  ///< length of the longest vertex
  Eigen::Vector3d vertex(int index) const { return vertices_.row(index); }

  /// Whether any vertex lies farther along `direction` than `most`: the farthest one, else -1.
  int beyond(const Eigen::Vector3d& direction, double most);

  using Facet = std::array<int, 3>;
  /// The facet that a ray from the origin meets. False where there is none: too few vertices, or
  /// not around the origin.
  bool find_facet(const Eigen::Vector3d& direction, Facet& facet);

 private:
  void choose_coarse_facets();

  /// A facet of few vertices, from which the search starts.
  struct CoarseFacet {
    Facet corners;
    Eigen::Matrix3d inverse;  ///< of the matrix of the corners
  };

  int count_ = -1;
  double radius_ = 0;
  Eigen::MatrixX3d vertices_;  ///< one per row: products with a direction are sums of columns
  Eigen::VectorXd along_;
  std::vector<CoarseFacet> coarse_;
};

}  // namespace softfinger::internal
