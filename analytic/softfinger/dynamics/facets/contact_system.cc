#include "softfinger/dynamics/facets/contact_system.h"

namespace softfinger::internal {

ContactSystem::ContactSystem(int contact_capacity, int vertex_capacity)
    : operator_(contact_capacity),
      vertices_(contact_capacity, vertex_capacity),
      covering_(contact_capacity, vertex_capacity),
      pairs_(contact_capacity, vertex_capacity),
      state_(contact_capacity),
      direction_(contact_capacity),
      shift_(contact_capacity) {}

void ContactSystem::set(const ContactLcp& problem, const Eigen::Matrix3Xd& vertices,
                        double proximal) {
  operator_.set(problem, proximal);
  vertices_.set(vertices, contacts());
  pairs_.number(contacts(), vertices_.count());
}

void ContactSystem::use_no_vertices() {
  vertices_.use_none();
  covering_.forget_vertices();
}

void ContactSystem::use_vertex(int contact, int vertex) {
  if (vertices_.use(contact, vertex))
    covering_.cover_vertex(contact, vertex, pairs_.slot(contact, vertex));
}

double ContactSystem::entry(const ContactPair& to, const ContactPair& of) const {
  using Kind = ContactPair::Kind;
  if (to.kind == Kind::slip) {
    if (to.contact != of.contact || of.kind == Kind::slip) return 0;
    return of.kind == Kind::normal ? 1 : -1;
  }
  if (of.kind == Kind::slip) return to.kind == Kind::vertex && to.contact == of.contact ? 1 : 0;
  const Eigen::MatrixXd& delassus = operator_.delassus();
  const int a = 4 * to.contact, b = 4 * of.contact;
  if (to.kind == Kind::normal)
    return of.kind == Kind::normal
               ? delassus(a, b)
               : delassus.block<1, 3>(a, b + 1).dot(vertices_.vertex(of.vertex).transpose());
  const auto left = vertices_.vertex(to.vertex);
  if (of.kind == Kind::normal) return left.dot(delassus.block<3, 1>(a + 1, b));
  return left.dot(delassus.block<3, 3>(a + 1, b + 1) * vertices_.vertex(of.vertex));
}

void ContactSystem::clear(Motion& motion) const {
  motion.impulse.head(4 * contacts()).setZero();
  motion.slip.head(contacts()).setZero();
  motion.slack.head(contacts()).setZero();
  motion.z0 = 0;
}

/// Adds to the motion the part that belongs to a z of this value.
void ContactSystem::add(int index, double value, Motion& motion) const {
  if (index == pairs()) {
    motion.z0 += value;
    if (is_shifted_) {
      const int n = 4 * contacts();
      motion.impulse.head(n) -= value * shift_.impulse.head(n);
      motion.slip.head(contacts()) -= value * shift_.slip.head(contacts());
      motion.slack.head(contacts()) -= value * shift_.slack.head(contacts());
    }
    return;
  }
  const ContactPair& p = pairs_[index];
  if (p.kind == ContactPair::Kind::normal) {
    motion.impulse[4 * p.contact] += value;
    motion.slack[p.contact] += value;
  } else if (p.kind == ContactPair::Kind::slip) {
    motion.slip[p.contact] += value;
  } else {
    motion.impulse.segment<3>(4 * p.contact + 1) += value * vertices_.vertex(p.vertex);
    motion.slack[p.contact] -= value;
  }
}

void ContactSystem::set_shift(const int* columns, const double* shift, int k) {
  is_shifted_ = false;
  clear(shift_);
  for (int p = 0; p < k; ++p) add(columns[p], shift[p], shift_);
  operator_.find_velocity(shift_.impulse, shift_.velocity);
  is_shifted_ = true;
}

void ContactSystem::set_state(const int* columns, const double* z, int k) {
  clear(state_);
  for (int p = 0; p < k; ++p) add(columns[p], z[p], state_);
  operator_.find_velocity(state_.impulse, state_.velocity);
  state_.velocity.head(4 * contacts()) += operator_.free_velocity().head(4 * contacts());
}

void ContactSystem::set_direction(const int* columns, const double* dz, int k, int entering) {
  clear(direction_);
  for (int p = 0; p < k; ++p) add(columns[p], dz[p], direction_);
  if (entering >= 0) add(entering, 1, direction_);
  operator_.find_velocity(direction_.impulse, direction_.velocity);
}

void ContactSystem::advance(double theta) {
  const int nc = contacts(), n = 4 * nc;
  state_.impulse.head(n) += theta * direction_.impulse.head(n);
  state_.velocity.head(n) += theta * direction_.velocity.head(n);
  state_.slip.head(nc) += theta * direction_.slip.head(nc);
  state_.slack.head(nc) += theta * direction_.slack.head(nc);
  state_.z0 += theta * direction_.z0;
}

template class LemkePath<ContactSystem>;

}  // namespace softfinger::internal
