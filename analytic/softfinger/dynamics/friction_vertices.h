#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/dynamics/friction_polytope.h"

/// Internal: the vertices of all contacts' friction.
namespace softfinger::internal {

/// The vertices, and which of them take part in the path. The contacts either share the same
/// vertices, or each has vertices of its own, made one by one. No allocation after construction.
class FrictionVertices {
 public:
  FrictionVertices(int contact_capacity, int vertex_capacity);

  /// Facets: all contacts share these vertices, 3 x u. None takes part yet.
  void share(const Eigen::Matrix3Xd& vertices, int contacts);
  /// Exact friction: each contact has none, and room for `room`.
  void give_own(int contacts, int room);

  int per_contact() const { return per_contact_; }  ///< u, or the room
  auto vertex(int contact, int index) const {
    return vertices_.col(own_ ? contact * per_contact_ + index : index);
  }
  double radius() const { return radius_; }  ///< of the longest vertex

  struct Range {
    const int *first, *last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
  };
  /// Indices of the contact's vertices that take part, in the order in which they came.
  Range in_use(int contact) const {
    return {in_use_.data() + contact * per_contact_,
            in_use_.data() + in_use_end_[std::size_t(contact)]};
  }
  bool is_in_use(int contact, int index) const {
    return is_in_use_[std::size_t(contact * per_contact_ + index)];
  }
  void use_none();
  /// False if it took part already.
  bool use(int contact, int index);

  /// Own vertices: one like `corner`; -1 where there is none.
  int find_own(int contact, const Eigen::Vector3d& corner) const;
  /// Own vertices: the index of a new one, which `use` is still to be called for; -1: no room.
  int add_own(int contact, const Eigen::Vector3d& corner);

  /// Shared vertices: as FrictionPolytope, for all of them, in use or not.
  /// The least D_j^T u of all; 0 where there are none.
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
  int contacts_ = 0, per_contact_ = 0;
  bool own_ = false;
  Eigen::Matrix3Xd vertices_;
  double radius_ = 1;
  /// The vertices in use of contact i are in_use_[u i] up to in_use_end_[i].
  std::vector<int> in_use_, in_use_end_;
  std::vector<char> is_in_use_;  ///< u i + j
  std::vector<int> used_;        ///< where is_in_use_ is true
  FrictionPolytope polytope_;    ///< of the shared vertices
};

}  // namespace softfinger::internal
