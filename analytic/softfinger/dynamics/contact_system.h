#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "softfinger/dynamics/friction_polytope.h"
#include "softfinger/dynamics/lemke_path.h"
#include "softfinger/friction/friction_shape.h"

/// Internal: the contact problem as LemkePath asks for it.
namespace softfinger::internal {

/// What w is made of, per contact, along the path or along a direction.
struct Motion {
  explicit Motion(int contacts)
      : impulse(4 * contacts), velocity(4 * contacts), slip(contacts), slack(contacts) {}
  Eigen::VectorXd impulse, velocity, slip, slack;
  double z0 = 0;
};

/// The matrix of the contact problem, never formed. Pairs: P_i is i, lambda_i is nc + i, beta_ij is
/// 2 nc + u i + j. Everything scaled.
class ContactSystem {
 public:
  ContactSystem(int capacity, int vertex_capacity)
      : delassus(4 * capacity, 4 * capacity),
        free_velocity(4 * capacity),
        vertices(3, capacity * vertex_capacity),
        normal_cover(capacity),
        slip_cover(capacity),
        slack_cover(capacity),
        natural_sizes(capacity),
        has_friction(std::size_t(capacity)),
        shapes(std::size_t(capacity)),
        state_(capacity),
        direction_(capacity),
        neighbours_(std::size_t(capacity) * std::size_t(capacity)),
        neighbour_end_(std::size_t(capacity)),
        blocks_(16 * std::ptrdiff_t(capacity) * capacity),
        in_use_(std::size_t(capacity) * std::size_t(vertex_capacity)),
        in_use_end_(std::size_t(capacity)),
        is_used_(in_use_.size()),
        beta_cover_(in_use_.size()),
        least_beta_cover_(capacity),
        uncovered_(std::size_t(capacity) * std::size_t(vertex_capacity + 2)),
        is_basic_(uncovered_.size()),
        pairs_(uncovered_.size()),
        shift_(capacity),
        polytope_(vertex_capacity) {
    used_.reserve(in_use_.size());
    uncovered_rows_.reserve(uncovered_.size());
  }

  int contacts = 0, count = 0;  ///< count: vertices per contact, or room for them
  /// Whether contact i has the vertices count i, count i + 1, ... of its own, made by
  /// `add_own_vertex`; else all contacts share the first `count` ones.
  bool own_vertices = false;
  Eigen::MatrixXd delassus;
  Eigen::VectorXd free_velocity;
  Eigen::Matrix3Xd vertices;
  /// d of rows P and lambda, and of rows beta, unless the path is led otherwise: slip_cover_i
  /// times 1 to 1.1 for the vertices: nearly equal, so that the path turns with the slip from
  /// vertex to vertex.
  Eigen::VectorXd normal_cover, slip_cover, slack_cover;
  int covering = 0;  ///< which vector of random numbers
  /// Of the velocities and impulses of a contact: where all feel the same velocity, heavy ones have
  /// 1 and light ones less.
  Eigen::VectorXd natural_sizes;
  std::vector<char> has_friction;
  /// Of exact friction: what the vertices lie on; null: the unit sphere.
  std::vector<const FrictionShape*> shapes;
  double vertex_radius = 1;  ///< of the longest vertex

  enum class Kind { normal, slip, vertex };
  struct Pair {
    Kind kind;
    int contact, vertex;
  };
  const Pair& pair(int index) const { return pairs_[std::size_t(index)]; }
  int index(const Pair& of) const {
    if (of.kind == Kind::normal) return of.contact;
    if (of.kind == Kind::slip) return contacts + of.contact;
    return 2 * contacts + of.contact * count + of.vertex;
  }

  auto vertex(int contact, int index) const {
    return vertices.col(own_vertices ? contact * count + index : index);
  }

  int pairs() const { return contacts * (count + 2); }

  /// To be called after `contacts`, `count` and `delassus` have been set.
  void prepare() {
    number_pairs();
    find_neighbours();
  }

  void column(int j, const int* rows, int k, double* out) const {
    const Pair of = pair(j);
    for (int p = 0; p < k; ++p) {
      const Pair to = pair(rows[p]);
      out[p] = entry(to, of);
    }
  }
  void row(int i, const int* columns, int k, double* out) const {
    const Pair to = pair(i);
    for (int p = 0; p < k; ++p) {
      if (columns[p] == pairs()) {
        out[p] = cover_entry(i);
        continue;
      }
      const Pair of = pair(columns[p]);
      out[p] = entry(to, of);
    }
  }
  double cover(int i) const {
    if (uncovered_[std::size_t(i)]) return 0;
    const Pair p = pair(i);
    if (p.kind == Kind::normal) return normal_cover[p.contact];
    if (p.kind == Kind::slip) return slack_cover[p.contact];
    return beta_cover_[std::size_t(p.contact * count + p.vertex)];
  }
  /// Column z0 of row i: its cover less what the shift of the basic z does to it.
  double cover_entry(int i) const { return cover(i) - (is_shifted_ ? w(shift_, i) : 0); }
  /// From now on z0 also takes the basic z along: by `shift` each, so that none is negative.
  void set_shift(const int* columns, const double* shift, int k) {
    is_shifted_ = false;
    clear(shift_);
    for (int p = 0; p < k; ++p) add(columns[p], shift[p], shift_);
    find_velocity(shift_);
    is_shifted_ = true;
  }
  double natural_size(int i) const { return i == pairs() ? 1 : natural_sizes[pair(i).contact]; }
  void cover_all_but(const int* rows, int k) {
    for (const int row : uncovered_rows_) uncovered_[std::size_t(row)] = char(false);
    uncovered_rows_.assign(rows, rows + k);
    for (const int row : uncovered_rows_) uncovered_[std::size_t(row)] = char(true);
    all_covered_ = k == 0;
    is_shifted_ = false;
  }
  /// A covering vector that leads straight to the solution with these basic z, if there is one:
  /// with d = w0 - q, where w0 is zero in their rows, z = (1 - z0) z* has
  /// w = (1 - z0) w* + z0 w0 for all z0 of [0, 1]. Small random w0 there avoid ties, and d > 0
  /// holds everywhere, so that the path ends as that of any other covering vector.
  void cover_towards(const int* basic, int k) {
    constexpr double kSmall = 0.1;
    for (int p = 0; p < k; ++p) is_basic_[std::size_t(basic[p])] = char(true);
    const auto lead = [this](int row, double constant) {
      const double size =
          natural_sizes[pair(row).contact] * (is_basic_[std::size_t(row)] ? kSmall : 1);
      return std::max(-constant, 0.) + size * (1 + hash_to_unit(4, std::uint64_t(row)));
    };
    least_beta_cover_.setConstant(std::numeric_limits<double>::infinity());
    for (int i = 0; i < contacts; ++i) {
      normal_cover[i] = lead(i, free_velocity[4 * i]);
      slack_cover[i] = lead(contacts + i, 0);
      const Eigen::Vector3d free_slip = free_velocity.segment<3>(4 * i + 1);
      for (int n = i * count; n < in_use_end_[std::size_t(i)]; ++n) {
        const int j = in_use_[std::size_t(n)];
        set_beta_cover(i, j, lead(2 * contacts + i * count + j, vertex(i, j).dot(free_slip)));
      }
    }
    for (int p = 0; p < k; ++p) is_basic_[std::size_t(basic[p])] = char(false);
  }
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
    for (int i = 0; i < contacts; ++i) {
      take(i);
      if (!has_friction[std::size_t(i)]) continue;
      take(contacts + i);
      for (int n = i * count; n < in_use_end_[std::size_t(i)]; ++n)
        take(2 * contacts + i * count + in_use_[std::size_t(n)]);
    }
    return best;
  }

  /// The vertices of all contacts, 3 x count.
  void share_vertices(const Eigen::Matrix3Xd& shared) {
    vertices.leftCols(count) = shared;
    polytope_.set(shared);
    vertex_radius = polytope_.radius();
  }

  /// The least D_j^T v_t of all of them; 0 if there are none.
  double slip_against(const Eigen::Vector3d& slip) const {
    return polytope_.count() > 0 ? -polytope_.farthest(-slip) : 0;
  }

  /// Which vertices take part: none, then those that the caller adds.
  void use_no_vertices() {
    for (const int slot : used_) is_used_[std::size_t(slot)] = char(false);
    used_.clear();
    for (int i = 0; i < contacts; ++i) in_use_end_[std::size_t(i)] = i * count;
    least_beta_cover_.setConstant(std::numeric_limits<double>::infinity());
  }
  void use_vertex(int contact, int vertex) {
    const int slot = contact * count + vertex;
    if (is_used_[std::size_t(slot)]) return;
    is_used_[std::size_t(slot)] = char(true);
    used_.push_back(slot);
    in_use_[std::size_t(in_use_end_[std::size_t(contact)]++)] = vertex;
    constexpr double kSpread = 0.1;
    set_beta_cover(
        contact, vertex,
        slip_cover[contact] *
            (1 + kSpread * hash_to_unit(std::uint64_t(4 * covering + 3), std::uint64_t(vertex))));
  }
  /// A vertex for this contact alone; false if there is no room, or one like it.
  bool add_own_vertex(int contact, const Eigen::Vector3d& corner) {
    const int before = in_use_end_[std::size_t(contact)];
    find_or_add_own_vertex(contact, corner);
    return in_use_end_[std::size_t(contact)] != before;
  }
  /// The index of such a vertex; -1 if there is no room.
  int find_or_add_own_vertex(int contact, const Eigen::Vector3d& corner) {
    constexpr double kSame = 1e-7;  // cuts off less than 1e-14
    const int end = in_use_end_[std::size_t(contact)], used = end - contact * count;
    for (int j = 0; j < used; ++j)
      if ((vertex(contact, j) - corner).squaredNorm() < kSame * kSame) return j;
    if (used == count) return -1;
    vertices.col(end) = corner;
    vertex_radius = std::max(vertex_radius, corner.norm());
    use_vertex(contact, used);
    return used;
  }
  /// Exact friction: of each contact that the last solution lets slip more than its vertices know,
  /// the boundary's point against the slip and the one that the load reaches for; whether there
  /// was any new one.
  bool add_violated_points(double tolerance) {
    bool found = false;
    for (int i = 0; i < contacts; ++i) {
      if (!has_friction[std::size_t(i)]) continue;
      const Eigen::Vector3d velocity = state_.velocity.segment<3>(4 * i + 1);
      if (!(velocity.squaredNorm() > 0)) continue;
      const Eigen::Vector3d against = boundary_point(i, -velocity);
      if (-against.dot(velocity) <= state_.slip[i] + tolerance * natural_sizes[i]) continue;
      found |= add_own_vertex(i, against);
      const Eigen::Vector3d metric = friction_metric(i);
      const FrictionExcess excess =
          friction_excess(shapes[std::size_t(i)],
                          metric.cwiseProduct(state_.impulse.segment<3>(4 * i + 1)) - velocity,
                          state_.impulse[4 * i], metric);
      if (excess.excess.squaredNorm() > 0) found |= add_own_vertex(i, excess.boundary);
    }
    return found;
  }
  /// How much slip an impulse along each axis makes; 1 along an axis that cannot move.
  Eigen::Vector3d friction_metric(int contact) const {
    const Eigen::Vector3d own = delassus.block<3, 3>(4 * contact + 1, 4 * contact + 1).diagonal();
    return (own.array() > 0).select(own, 1);
  }
  Eigen::Vector3d boundary_point(int contact, const Eigen::Vector3d& direction) const {
    const FrictionShape* shape = shapes[std::size_t(contact)];
    return shape ? shape->boundary(direction, nullptr) : direction.stableNormalized();
  }
  /// Of the shared vertices, takes those into use that the last solution asks for: of each contact
  /// with load that slips more than its vertices know, the one most against the slip and those of
  /// the facet that its friction would be on if the other contacts kept their impulses. Returns
  /// whether there was any new one. (A contact without load needs none: its lambda, whatever it is,
  /// touches no other row.)
  bool use_violated_vertices(double tolerance) {
    bool found = false;
    for (int i = 0; i < contacts; ++i) {
      if (!has_friction[std::size_t(i)] || !(state_.impulse[4 * i] > 0)) continue;
      const Eigen::Vector3d slip = state_.velocity.segment<3>(4 * i + 1);
      const double known = state_.slip[i] + tolerance * natural_sizes[i];
      if (vertex_radius * slip.norm() <= known) continue;
      const int worst = polytope_.beyond(-slip, known);
      if (worst < 0 || is_used_[std::size_t(i * count + worst)]) continue;
      use_vertex(i, worst);
      found = true;
      FrictionPolytope::Facet facet;
      if (!polytope_.find_facet(friction_alone(i), facet)) continue;
      for (const int vertex : facet) use_vertex(i, vertex);
    }
    return found;
  }

  void set_state(const int* columns, const double* z, int k) {
    clear(state_);
    for (int p = 0; p < k; ++p) add(columns[p], z[p], state_);
    find_velocity(state_);
    state_.velocity.head(4 * contacts) += free_velocity.head(4 * contacts);
  }
  void set_direction(const int* columns, const double* dz, int k, int entering) {
    clear(direction_);
    for (int p = 0; p < k; ++p) add(columns[p], dz[p], direction_);
    if (entering >= 0) add(entering, 1, direction_);
    find_velocity(direction_);
  }
  /// The state after a step along the direction, but for rounding.
  void advance(double theta) {
    const int n = 4 * contacts;
    state_.impulse.head(n) += theta * direction_.impulse.head(n);
    state_.velocity.head(n) += theta * direction_.velocity.head(n);
    state_.slip.head(contacts) += theta * direction_.slip.head(contacts);
    state_.slack.head(contacts) += theta * direction_.slack.head(contacts);
    state_.z0 += theta * direction_.z0;
  }
  double state(int i) const { return w(state_, i); }
  double direction(int i) const { return w(direction_, i); }
  const Motion& current() const { return state_; }
  const Motion& current_direction() const { return direction_; }

  template <class IsActive>
  void bound(const IsActive& is_active, double least, double tolerance, Blocking& blocking) const {
    for_stored_rows(is_active, [&](int row, double value, double slope) {
      blocking.bound(value, slope, least, tolerance * natural_size(row));
    });
    for (int i = 0; i < contacts; ++i)
      for_blocking_vertices(i, blocking.theta, is_active, [&](int, double value, double slope) {
        blocking.bound(value, slope, least, tolerance * natural_sizes[i]);
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
    for (int i = 0; i < contacts; ++i) for_blocking_vertices(i, blocking.theta, is_active, take);
  }

  /// The friction of contact i under the exact rules if the other contacts, and its own load, kept
  /// their impulses: a few fixed-point steps from the last solution.
  Eigen::Vector3d friction_alone(int i) const {
    constexpr int kSteps = 4;
    const auto own = delassus.block<3, 3>(4 * i + 1, 4 * i + 1);
    const Eigen::Vector3d metric = friction_metric(i);
    Eigen::Vector3d friction = state_.impulse.segment<3>(4 * i + 1);
    Eigen::Vector3d slip = state_.velocity.segment<3>(4 * i + 1);
    for (int step = 0; step < kSteps; ++step) {
      const Eigen::Vector3d target = metric.cwiseProduct(friction) - slip;
      const Eigen::Vector3d excess =
          friction_excess(shapes[std::size_t(i)], target, state_.impulse[4 * i], metric).excess;
      const Eigen::Vector3d next = (target - excess).cwiseQuotient(metric);
      slip += own * (next - friction);
      friction = next;
    }
    return friction;
  }

  /// W r
  void find_velocity(const Eigen::VectorXd& impulses, Eigen::VectorXd& velocity) const {
    velocity.head(4 * contacts).setZero();
    for (int j = 0; j < contacts; ++j) {
      const Eigen::Vector4d impulse = impulses.segment<4>(4 * j);
      if (impulse.isZero(0)) continue;
      for (int n = j * contacts; n < neighbour_end_[std::size_t(j)]; ++n) {
        const Eigen::Map<const Eigen::Matrix4d> block(blocks_.data() + 16 * n);
        velocity.segment<4>(4 * neighbours_[std::size_t(n)]).noalias() += block * impulse;
      }
    }
  }

 private:
  void set_beta_cover(int contact, int vertex, double value) {
    beta_cover_[std::size_t(contact * count + vertex)] = value;
    least_beta_cover_[contact] = std::min(least_beta_cover_[contact], value);
  }

  void number_pairs() {
    if (numbered_contacts_ == contacts && numbered_count_ == count) return;
    int index = 0;
    for (int i = 0; i < contacts; ++i) pairs_[std::size_t(index++)] = {Kind::normal, i, 0};
    for (int i = 0; i < contacts; ++i) pairs_[std::size_t(index++)] = {Kind::slip, i, 0};
    for (int i = 0; i < contacts; ++i)
      for (int j = 0; j < count; ++j) pairs_[std::size_t(index++)] = {Kind::vertex, i, j};
    numbered_contacts_ = contacts;
    numbered_count_ = count;
  }

  /// Contacts without a common movable body do not feel each other.
  void find_neighbours() {
    for (int j = 0; j < contacts; ++j) {
      int end = j * contacts;
      for (int i = 0; i < contacts; ++i) {
        const auto block = delassus.block<4, 4>(4 * i, 4 * j);
        if (block.isZero(0)) continue;
        Eigen::Map<Eigen::Matrix4d>(blocks_.data() + 16 * end) = block;
        neighbours_[std::size_t(end++)] = i;
      }
      neighbour_end_[std::size_t(j)] = end;
    }
  }

  double entry(const Pair& to, const Pair& of) const {
    if (to.kind == Kind::slip) {
      if (to.contact != of.contact || of.kind == Kind::slip) return 0;
      return of.kind == Kind::normal ? 1 : -1;
    }
    if (of.kind == Kind::slip) return to.kind == Kind::vertex && to.contact == of.contact ? 1 : 0;
    const int a = 4 * to.contact, b = 4 * of.contact;
    if (to.kind == Kind::normal)
      return of.kind == Kind::normal
                 ? delassus(a, b)
                 : delassus.block<1, 3>(a, b + 1).dot(vertex(of.contact, of.vertex).transpose());
    const auto left = vertex(to.contact, to.vertex);
    if (of.kind == Kind::normal) return left.dot(delassus.block<3, 1>(a + 1, b));
    return left.dot(delassus.block<3, 3>(a + 1, b + 1) * vertex(of.contact, of.vertex));
  }

  void clear(Motion& motion) const {
    motion.impulse.head(4 * contacts).setZero();
    motion.slip.head(contacts).setZero();
    motion.slack.head(contacts).setZero();
    motion.z0 = 0;
  }
  void add(int index, double value, Motion& motion) const {
    if (index == pairs()) {
      motion.z0 += value;
      if (is_shifted_) {
        const int n = 4 * contacts;
        motion.impulse.head(n) -= value * shift_.impulse.head(n);
        motion.slip.head(contacts) -= value * shift_.slip.head(contacts);
        motion.slack.head(contacts) -= value * shift_.slack.head(contacts);
      }
      return;
    }
    const Pair p = pair(index);
    if (p.kind == Kind::normal) {
      motion.impulse[4 * p.contact] += value;
      motion.slack[p.contact] += value;
    } else if (p.kind == Kind::slip) {
      motion.slip[p.contact] += value;
    } else {
      motion.impulse.segment<3>(4 * p.contact + 1) += value * vertex(p.contact, p.vertex);
      motion.slack[p.contact] -= value;
    }
  }
  void find_velocity(Motion& motion) const { find_velocity(motion.impulse, motion.velocity); }

  double w(const Motion& motion, int row) const {
    const Pair p = pair(row);
    const int i = p.contact;
    const double covered = motion.z0 != 0 ? cover(row) * motion.z0 : 0;
    if (p.kind == Kind::normal) return motion.velocity[4 * i] + covered;
    if (p.kind == Kind::slip) return motion.slack[i] + covered;
    return vertex(i, p.vertex).dot(motion.velocity.segment<3>(4 * i + 1)) + motion.slip[i] +
           covered;
  }

  template <class IsActive, class Take>
  void for_stored_rows(const IsActive& is_active, const Take& take) const {
    const auto unless_uncovered = [this](int row, double value) {
      return uncovered_[std::size_t(row)] ? 0 : value;
    };
    for (int i = 0; i < contacts; ++i) {
      if (!is_active(i)) {
        const double covered = unless_uncovered(i, normal_cover[i]);
        take(i, state_.velocity[4 * i] + covered * state_.z0,
             direction_.velocity[4 * i] + covered * direction_.z0);
      }
      const int row = contacts + i;
      if (!has_friction[std::size_t(i)] || is_active(row)) continue;
      const double covered = unless_uncovered(row, slack_cover[i]);
      take(row, state_.slack[i] + covered * state_.z0,
           direction_.slack[i] + covered * direction_.z0);
    }
  }

  /// Vertices lie on the unit sphere: where v_t is shorter than lambda + d z0 at the end of the
  /// step, none of them can have blocked before.
  template <class IsActive, class Take>
  void for_blocking_vertices(int i, double theta, const IsActive& is_active,
                             const Take& take) const {
    if (!has_friction[std::size_t(i)]) return;
    const Eigen::Vector3d value = state_.velocity.segment<3>(4 * i + 1),
                          slope = direction_.velocity.segment<3>(4 * i + 1);
    if (std::isfinite(theta)) {
      const double z0 = state_.z0 + theta * direction_.z0;
      const double least = state_.slip[i] + theta * direction_.slip[i] +
                           (all_covered_ ? least_beta_cover_[i] * std::max(z0, 0.) : 0);
      const double longest = vertex_radius * (value + theta * slope).norm();
      if (longest < least) return;
    }
    const int first_row = 2 * contacts + i * count;
    for (int n = i * count; n < in_use_end_[std::size_t(i)]; ++n) {
      const int j = in_use_[std::size_t(n)], row = first_row + j;
      const double covered =
          uncovered_[std::size_t(row)] ? 0 : beta_cover_[std::size_t(i * count + j)];
      const auto corner = vertex(i, j);
      const double b = corner.dot(slope) + direction_.slip[i] + covered * direction_.z0;
      if (b >= 0 || is_active(row)) continue;
      take(row, corner.dot(value) + state_.slip[i] + covered * state_.z0, b);
    }
  }

  Motion state_, direction_;
  std::vector<int> neighbours_, neighbour_end_;
  Eigen::VectorXd blocks_;  ///< of W, those of neighbours_
  /// Vertices of contact i in use: in_use_[count i] up to in_use_end_[i].
  std::vector<int> in_use_, in_use_end_;
  std::vector<char> is_used_;
  std::vector<int> used_;             ///< where it is true
  std::vector<double> beta_cover_;    ///< d of rows beta, of vertices in use
  Eigen::VectorXd least_beta_cover_;  ///< of each contact; infinity where none is in use
  std::vector<char> uncovered_, is_basic_;
  std::vector<int> uncovered_rows_;  ///< where uncovered_ is true
  std::vector<Pair> pairs_;
  int numbered_contacts_ = -1, numbered_count_ = -1;
  bool all_covered_ = true, is_shifted_ = false;
  Motion shift_;
  FrictionPolytope polytope_;  ///< of the shared vertices
};

}  // namespace softfinger::internal
