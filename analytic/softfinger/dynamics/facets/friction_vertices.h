#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/dynamics/facets/friction_polytope.h"

/// Internal: the vertices of all contacts' friction.
namespace softfinger::internal {

/// The vertices that all contacts share, and which of them take part in the path at each contact.
/// No allocation after construction.
class FrictionVertices {
 public:
  FrictionVertices(int contact_capacity, int vertex_capacity);

  /// The vertices of the next problem, 3 x u. None takes part yet.
  void set(const Eigen::Matrix3Xd& vertices, int contacts);

  int count() const { return count_; }  ///< u
  auto vertex(int index) const { return vertices_.col(index); }
  double radius() const { return radius_; }  ///< of the longest vertex

  struct Range {
    const int *first, *last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
  };
  /// Indices of the contact's vertices that take part, in the order in which they came.
  Range in_use(int contact) const {
    return {in_use_.data() + contact * count_, in_use_.data() + in_use_end_[std::size_t(contact)]};
  }
  bool is_in_use(int contact, int index) const {
    return is_in_use_[std::size_t(contact * count_ + index)];
  }
  void use_none();
  /// False if it took part already.
  bool use(int contact, int index);

  // These ask FrictionPolytope about all vertices, in use or not.

  /// The least D_j^T u of all; 0 without vertices.
  double slip_against(const Eigen::Vector3d& slip) const {
    return polytope_.count() > 0 ? -polytope_.farthest(-slip) : 0;
  }
  int beyond(const Eigen::Vector3d& direction, double most) {
    return polytope_.beyond(direction, most);
  }
  bool find_facet(const Eigen::Vector3d& direction, FrictionPolytope::Facet& facet) {
    return polytope_.find_facet(direction, facet);
  }

 private:
  int contacts_ = 0, count_ = 0;
  Eigen::Matrix3Xd vertices_;
  double radius_ = 1;
  /// The vertices in use of contact i are in_use_[u i] up to in_use_end_[i].
  std::vector<int> in_use_, in_use_end_;
  std::vector<char> is_in_use_;  ///< u i + j
  std::vector<int> used_;        ///< where is_in_use_ is true
  FrictionPolytope polytope_;
};

}  // namespace softfinger::internal
