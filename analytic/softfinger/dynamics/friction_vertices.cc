#include "softfinger/dynamics/friction_vertices.h"

#include <algorithm>

namespace softfinger::internal {

FrictionVertices::FrictionVertices(int contact_capacity, int vertex_capacity)
    : vertices_(3, contact_capacity * vertex_capacity),
      in_use_(std::size_t(contact_capacity) * std::size_t(vertex_capacity)),
      in_use_end_(std::size_t(contact_capacity)),
      is_in_use_(in_use_.size()),
      polytope_(vertex_capacity) {
  used_.reserve(in_use_.size());
}

void FrictionVertices::share(const Eigen::Matrix3Xd& vertices, int contacts) {
  contacts_ = contacts;
  per_contact_ = int(vertices.cols());
  own_ = false;
  vertices_.leftCols(per_contact_) = vertices;
  polytope_.set(vertices);
  radius_ = polytope_.radius();
}

void FrictionVertices::give_own(int contacts, int room) {
  contacts_ = contacts;
  per_contact_ = room;
  own_ = true;
  radius_ = 0;
}

void FrictionVertices::use_none() {
  for (const int slot : used_) is_in_use_[std::size_t(slot)] = char(false);
  used_.clear();
  for (int i = 0; i < contacts_; ++i) in_use_end_[std::size_t(i)] = i * per_contact_;
}

bool FrictionVertices::use(int contact, int index) {
  const int slot = contact * per_contact_ + index;
  if (is_in_use_[std::size_t(slot)]) return false;
  is_in_use_[std::size_t(slot)] = char(true);
  used_.push_back(slot);
  in_use_[std::size_t(in_use_end_[std::size_t(contact)]++)] = index;
  return true;
}

int FrictionVertices::find_own(int contact, const Eigen::Vector3d& corner) const {
  constexpr double kSame = 1e-7;  // apart on the unit sphere: cuts off less than 1e-14
  for (const int j : in_use(contact))
    if ((vertex(contact, j) - corner).squaredNorm() < kSame * kSame) return j;
  return -1;
}

int FrictionVertices::add_own(int contact, const Eigen::Vector3d& corner) {
  const int slot = in_use_end_[std::size_t(contact)], index = slot - contact * per_contact_;
  if (index == per_contact_) return -1;
  vertices_.col(slot) = corner;
  radius_ = std::max(radius_, corner.norm());
  return index;
}

}  // namespace softfinger::internal
