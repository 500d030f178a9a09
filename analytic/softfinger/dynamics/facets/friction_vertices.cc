#include "softfinger/dynamics/facets/friction_vertices.h"

namespace softfinger::internal {

FrictionVertices::FrictionVertices(int contact_capacity, int vertex_capacity)
    : vertices_(3, vertex_capacity),
      in_use_(std::size_t(contact_capacity) * std::size_t(vertex_capacity)),
      in_use_end_(std::size_t(contact_capacity)),
      is_in_use_(in_use_.size()),
      polytope_(vertex_capacity) {
  used_.reserve(in_use_.size());
}

void FrictionVertices::set(const Eigen::Matrix3Xd& vertices, int contacts) {
  contacts_ = contacts;
  count_ = int(vertices.cols());
  vertices_.leftCols(count_) = vertices;
  polytope_.set(vertices);
  radius_ = polytope_.radius();
}

void FrictionVertices::use_none() {
  for (const int slot : used_) is_in_use_[std::size_t(slot)] = char(false);
  used_.clear();
  for (int i = 0; i < contacts_; ++i) in_use_end_[std::size_t(i)] = i * count_;
}

bool FrictionVertices::use(int contact, int index) {
  const int slot = contact * count_ + index;
  if (is_in_use_[std::size_t(slot)]) return false;
  is_in_use_[std::size_t(slot)] = char(true);
  used_.push_back(slot);
  in_use_[std::size_t(in_use_end_[std::size_t(contact)]++)] = index;
  return true;
}

}  // namespace softfinger::internal
