#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "softfinger/dynamics/contacts/contact_operator.h"
#include "softfinger/dynamics/facets/contact_pairs.h"
#include "softfinger/dynamics/facets/covering_vector.h"
#include "softfinger/dynamics/facets/friction_vertices.h"
#include "softfinger/dynamics/facets/lemke_path.h"

/// Internal: the contact problem as LemkePath asks for it.
namespace softfinger::internal {

/// Impulses and what follows from them, per contact: the values of w and z along the path, or their
/// changes in one direction. Scaled as in ContactOperator.
struct Motion {
  explicit Motion(int contacts)
      : impulse(4 * contacts), velocity(4 * contacts), slip(contacts), slack(contacts) {}
  Eigen::VectorXd impulse, velocity;
  Eigen::VectorXd slip;   ///< lambda
  Eigen::VectorXd slack;  ///< P - e^T beta
  double z0 = 0;
};

/// w = M z + q of the contact problem, without ever forming M. Its parts have a type each: the
/// operator W, the vertices of friction, the covering vector. Here they meet in the rows and
/// columns that the path asks for.
class ContactSystem {
 public:
  ContactSystem(int contact_capacity, int vertex_capacity);

  /// The problem to solve next, with `proximal` as in ContactOperator::set.
  void set(const ContactLcp& problem, const Eigen::Matrix3Xd& vertices, double proximal);

  int contacts() const { return operator_.contacts(); }
  const ContactOperator& contact_operator() const { return operator_; }
  void drop_friction() { operator_.drop_friction(); }
  void restore_friction() { operator_.restore_friction(); }

  const ContactPair& pair(int index) const { return pairs_[index]; }

  const FrictionVertices& vertices() const { return vertices_; }
  /// See FrictionPolytope. Not const: facets that were found are kept.
  int vertex_beyond(const Eigen::Vector3d& direction, double most) {
    return vertices_.beyond(direction, most);
  }
  bool find_facet(const Eigen::Vector3d& direction, FrictionPolytope::Facet& facet) {
    return vertices_.find_facet(direction, facet);
  }
  void use_no_vertices();
  void use_vertex(int contact, int vertex);

  void choose_covering(int number) { covering_.choose(number, contacts()); }
  int covering() const { return covering_.number(); }
  /// See CoveringVector::lead_towards.
  void cover_towards(const int* basic, int k) {
    covering_.lead_towards(basic, k, operator_, vertices_, pairs_);
  }

  const Motion& current() const { return state_; }
  const Motion& current_direction() const { return direction_; }

  // LemkePath asks for the following, see there.

  int pairs() const { return pairs_.size(); }
  void column(int j, const int* rows, int k, double* out) const {
    for (int p = 0; p < k; ++p) out[p] = entry(pairs_[rows[p]], pairs_[j]);
  }
  void row(int i, const int* columns, int k, double* out) const {
    for (int p = 0; p < k; ++p)
      out[p] = columns[p] == pairs() ? cover_entry(i) : entry(pairs_[i], pairs_[columns[p]]);
  }
  double cover(int i) const {
    if (!covering_.covers(i)) return 0;
    const ContactPair& p = pairs_[i];
    if (p.kind == ContactPair::Kind::normal) return covering_.normal(p.contact);
    if (p.kind == ContactPair::Kind::slip) return covering_.slack(p.contact);
    return covering_.vertex(pairs_.slot(p.contact, p.vertex));
  }
  double cover_entry(int i) const { return cover(i) - (is_shifted_ ? w(shift_, i) : 0); }
  void cover_all_but(const int* rows, int k) {
    covering_.cover_all_but(rows, k);
    is_shifted_ = false;
  }
  void set_shift(const int* columns, const double* shift, int k);
  double natural_size(int i) const {
    return i == pairs() ? 1 : operator_.natural_size(pairs_[i].contact);
  }
  void set_state(const int* columns, const double* z, int k);
  void set_direction(const int* columns, const double* dz, int k, int entering);
  void advance(double theta);
  double state(int i) const { return w(state_, i); }
  double direction(int i) const { return w(direction_, i); }

  template <class IsActive>
  int first_row(const IsActive& is_active) const {
    int best = -1;
    double least = 0;
    const auto take = [&](int row) {
      if (is_active(row)) return;
      const double value = state(row);
      if (value >= least * cover(row)) return;
      least = value / cover(row);
      best = row;
    };
    for (int i = 0; i < contacts(); ++i) {
      take(pairs_.normal(i));
      if (!operator_.has_friction(i)) continue;
      take(pairs_.slip(i));
      for (const int j : vertices_.in_use(i)) take(pairs_.vertex(i, j));
    }
    return best;
  }
  template <class IsActive>
  void bound(const IsActive& is_active, double least, double tolerance, Blocking& blocking) const {
    for_stored_rows(is_active, [&](int row, double value, double slope) {
      blocking.bound(value, slope, least, tolerance * natural_size(row));
    });
    for (int i = 0; i < contacts(); ++i)
      for_blocking_vertices(i, blocking.theta, is_active, [&](int, double value, double slope) {
        blocking.bound(value, slope, least, tolerance * operator_.natural_size(i));
      });
  }
  template <class IsActive>
  void choose(const IsActive& is_active, double least, Blocking& blocking) const {
    const auto take = [&](int row, double value, double slope) {
      if (!blocking.prefers(value, slope, least)) return;
      blocking.pivot = -slope;
      blocking.row = row;
    };
    for_stored_rows(is_active, take);
    for (int i = 0; i < contacts(); ++i) for_blocking_vertices(i, blocking.theta, is_active, take);
  }

 private:
  double entry(const ContactPair& to, const ContactPair& of) const;
  void clear(Motion& motion) const;
  void add(int index, double value, Motion& motion) const;

  double w(const Motion& motion, int row) const {
    const ContactPair& p = pairs_[row];
    const int i = p.contact;
    const double covered = motion.z0 != 0 ? cover(row) * motion.z0 : 0;
    if (p.kind == ContactPair::Kind::normal) return motion.velocity[4 * i] + covered;
    if (p.kind == ContactPair::Kind::slip) return motion.slack[i] + covered;
    return vertices_.vertex(p.vertex).dot(motion.velocity.segment<3>(4 * i + 1)) + motion.slip[i] +
           covered;
  }

  /// Calls take(row, value, slope) for all rows v_n and slack that are not active.
  template <class IsActive, class Take>
  void for_stored_rows(const IsActive& is_active, const Take& take) const {
    const auto unless_uncovered = [this](int row, double value) {
      return covering_.covers(row) ? value : 0;
    };
    for (int i = 0; i < contacts(); ++i) {
      if (!is_active(i)) {
        const double covered = unless_uncovered(i, covering_.normal(i));
        take(i, state_.velocity[4 * i] + covered * state_.z0,
             direction_.velocity[4 * i] + covered * direction_.z0);
      }
      const int row = pairs_.slip(i);
      if (!operator_.has_friction(i) || is_active(row)) continue;
      const double covered = unless_uncovered(row, covering_.slack(i));
      take(row, state_.slack[i] + covered * state_.z0,
           direction_.slack[i] + covered * direction_.z0);
    }
  }

  /// Calls take(row, value, slope) for the rows of contact i's vertices that fall. None of them can
  /// have blocked the path before `theta` where v_t is then still shorter than (lambda + d
  /// z0)/(longest vertex).
  template <class IsActive, class Take>
  void for_blocking_vertices(int i, double theta, const IsActive& is_active,
                             const Take& take) const {
    if (!operator_.has_friction(i)) return;
    const Eigen::Vector3d value = state_.velocity.segment<3>(4 * i + 1),
                          slope = direction_.velocity.segment<3>(4 * i + 1);
    if (std::isfinite(theta)) {
      const double z0 = state_.z0 + theta * direction_.z0;
      const double least =
          state_.slip[i] + theta * direction_.slip[i] +
          (covering_.covers_all() ? covering_.least_of_vertices(i) * std::max(z0, 0.) : 0);
      const double longest = vertices_.radius() * (value + theta * slope).norm();
      if (longest < least) return;
    }
    for (const int j : vertices_.in_use(i)) {
      const int row = pairs_.vertex(i, j);
      const double covered = covering_.covers(row) ? covering_.vertex(pairs_.slot(i, j)) : 0;
      const auto corner = vertices_.vertex(j);
      const double b = corner.dot(slope) + direction_.slip[i] + covered * direction_.z0;
      if (b >= 0 || is_active(row)) continue;
      take(row, corner.dot(value) + state_.slip[i] + covered * state_.z0, b);
    }
  }

  ContactOperator operator_;
  FrictionVertices vertices_;
  CoveringVector covering_;
  ContactPairs pairs_;
  Motion state_, direction_;
  Motion shift_;  ///< by which z0 takes the basic z along, see LemkePath::follow_from
  bool is_shifted_ = false;
};

/// Compiled once, in contact_system.cc.
extern template class LemkePath<ContactSystem>;
using ContactPath = LemkePath<ContactSystem>;

}  // namespace softfinger::internal
