#include "softfinger/dynamics/contact_lcp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "softfinger/dynamics/covering.h"
#include "softfinger/dynamics/lemke_path.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using internal::Blocking;
using internal::PathEnd;

constexpr int kMostAttempts = 24;
/// A solution is one below the first; below the second, no other covering vector is tried.
constexpr double kTolerance = 1e-10, kGood = 1e-12;
constexpr int kAttemptsForGood = 4;

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
        vertices(3, vertex_capacity),
        normal_cover(capacity),
        slip_cover(capacity),
        slack_cover(capacity),
        vertex_cover(vertex_capacity),
        natural_sizes(capacity),
        has_friction(std::size_t(capacity)),
        state_(capacity),
        direction_(capacity),
        neighbours_(std::size_t(capacity) * std::size_t(capacity)),
        neighbour_end_(std::size_t(capacity)),
        in_use_(std::size_t(capacity) * std::size_t(vertex_capacity)),
        in_use_end_(std::size_t(capacity)),
        is_used_(in_use_.size()),
        uncovered_(std::size_t(capacity) * std::size_t(vertex_capacity + 2)) {}

  int contacts = 0, count = 0;  ///< count: vertices per contact
  Eigen::MatrixXd delassus;
  Eigen::VectorXd free_velocity;
  Eigen::Matrix3Xd vertices;
  /// d of rows P and lambda, and of rows beta: slip_cover_i vertex_cover_j, with the smallest
  /// vertex_cover 1.
  Eigen::VectorXd normal_cover, slip_cover, slack_cover, vertex_cover;
  /// Of the velocities and impulses of a contact: where all feel the same velocity, heavy ones have
  /// 1 and light ones less.
  Eigen::VectorXd natural_sizes;
  std::vector<char> has_friction;
  double vertex_radius = 1;  ///< of the longest vertex

  int pairs() const { return contacts * (count + 2); }

  /// Contacts without a common movable body do not feel each other.
  void find_neighbours() {
    for (int j = 0; j < contacts; ++j) {
      int end = j * contacts;
      for (int i = 0; i < contacts; ++i)
        if (delassus.block<4, 4>(4 * i, 4 * j).cwiseAbs().maxCoeff() > 0)
          neighbours_[std::size_t(end++)] = i;
      neighbour_end_[std::size_t(j)] = end;
    }
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
        out[p] = cover(i);
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
    return slip_cover[p.contact] * vertex_cover[p.vertex];
  }
  double natural_size(int i) const { return i == pairs() ? 1 : natural_sizes[pair(i).contact]; }
  void cover_all_but(const int* rows, int k) {
    std::fill(uncovered_.begin(), uncovered_.begin() + pairs(), char(false));
    for (int p = 0; p < k; ++p) uncovered_[std::size_t(rows[p])] = char(true);
    all_covered_ = k == 0;
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

  /// Which vertices take part: none, then those that the caller adds.
  void use_no_vertices() {
    std::fill(is_used_.begin(), is_used_.begin() + contacts * count, char(false));
    for (int i = 0; i < contacts; ++i) in_use_end_[std::size_t(i)] = i * count;
  }
  void use_vertex(int contact, int vertex) {
    char& used = is_used_[std::size_t(contact * count + vertex)];
    if (used) return;
    used = char(true);
    in_use_[std::size_t(in_use_end_[std::size_t(contact)]++)] = vertex;
  }
  /// Of each contact, takes the most violated vertex into use; returns whether there was one.
  bool use_violated_vertices(double tolerance) {
    bool found = false;
    for (int i = 0; i < contacts; ++i) {
      if (!has_friction[std::size_t(i)]) continue;
      const Eigen::Vector3d velocity = state_.velocity.segment<3>(4 * i + 1);
      if (vertex_radius * velocity.norm() <= state_.slip[i]) continue;
      int worst = -1;
      double least = -tolerance * natural_sizes[i] - state_.slip[i];
      for (int j = 0; j < count; ++j) {
        const double along = vertices.col(j).dot(velocity);
        if (along >= least || is_used_[std::size_t(i * count + j)]) continue;
        least = along;
        worst = j;
      }
      if (worst < 0) continue;
      use_vertex(i, worst);
      found = true;
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

 private:
  enum class Kind { normal, slip, vertex };
  struct Pair {
    Kind kind;
    int contact, vertex;
  };

  Pair pair(int index) const {
    if (index < contacts) return {Kind::normal, index, 0};
    if (index < 2 * contacts) return {Kind::slip, index - contacts, 0};
    const int rest = index - 2 * contacts;
    return {Kind::vertex, rest / count, rest % count};
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
                 : delassus.block<1, 3>(a, b + 1).dot(vertices.col(of.vertex).transpose());
    const auto left = vertices.col(to.vertex);
    if (of.kind == Kind::normal) return left.dot(delassus.block<3, 1>(a + 1, b));
    return left.dot(delassus.block<3, 3>(a + 1, b + 1) * vertices.col(of.vertex));
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
      return;
    }
    const Pair p = pair(index);
    if (p.kind == Kind::normal) {
      motion.impulse[4 * p.contact] += value;
      motion.slack[p.contact] += value;
    } else if (p.kind == Kind::slip) {
      motion.slip[p.contact] += value;
    } else {
      motion.impulse.segment<3>(4 * p.contact + 1) += value * vertices.col(p.vertex);
      motion.slack[p.contact] -= value;
    }
  }
  void find_velocity(Motion& motion) const {
    motion.velocity.head(4 * contacts).setZero();
    for (int j = 0; j < contacts; ++j) {
      const Eigen::Vector4d impulse = motion.impulse.segment<4>(4 * j);
      if (impulse.isZero(0)) continue;
      for (int n = j * contacts; n < neighbour_end_[std::size_t(j)]; ++n) {
        const int i = 4 * neighbours_[std::size_t(n)];
        motion.velocity.segment<4>(i).noalias() += delassus.block<4, 4>(i, 4 * j) * impulse;
      }
    }
  }

  double w(const Motion& motion, int row) const {
    const Pair p = pair(row);
    const int i = p.contact;
    const double covered = motion.z0 != 0 ? cover(row) * motion.z0 : 0;
    if (p.kind == Kind::normal) return motion.velocity[4 * i] + covered;
    if (p.kind == Kind::slip) return motion.slack[i] + covered;
    return vertices.col(p.vertex).dot(motion.velocity.segment<3>(4 * i + 1)) + motion.slip[i] +
           covered;
  }

  template <class IsActive, class Take>
  void for_stored_rows(const IsActive& is_active, const Take& take) const {
    for (int i = 0; i < contacts; ++i) {
      if (!is_active(i)) take(i, w(state_, i), w(direction_, i));
      if (has_friction[std::size_t(i)] && !is_active(contacts + i))
        take(contacts + i, state(contacts + i), direction(contacts + i));
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
                           (all_covered_ ? slip_cover[i] * std::max(z0, 0.) : 0);
      const double longest = vertex_radius * (value + theta * slope).norm();
      if (longest < least) return;
    }
    const double value_z0 = slip_cover[i] * state_.z0, slope_z0 = slip_cover[i] * direction_.z0;
    const int first_row = 2 * contacts + i * count;
    for (int n = i * count; n < in_use_end_[std::size_t(i)]; ++n) {
      const int j = in_use_[std::size_t(n)], row = first_row + j;
      const double covered = uncovered_[std::size_t(row)] ? 0 : vertex_cover[j];
      const auto vertex = vertices.col(j);
      const double b = vertex.dot(slope) + direction_.slip[i] + covered * slope_z0;
      if (b >= 0 || is_active(row)) continue;
      take(row, vertex.dot(value) + state_.slip[i] + covered * value_z0, b);
    }
  }

  Motion state_, direction_;
  std::vector<int> neighbours_, neighbour_end_;
  /// Vertices of contact i in use: in_use_[count i] up to in_use_end_[i].
  std::vector<int> in_use_, in_use_end_;
  std::vector<char> is_used_, uncovered_;
  bool all_covered_ = true;
};

}  // namespace

namespace {

/// D_j^T v_t
double slip_along(const ContactLcp& problem, const ContactSolution& solution, int contact,
                  int vertex) {
  const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[contact]);
  return problem.vertices.col(vertex).dot(
      arms.cwiseProduct(solution.velocity.segment<3>(4 * contact + 1)));
}

}  // namespace

void ContactSolution::resize(int contacts) {
  impulse.setZero(4 * contacts);
  velocity.setZero(4 * contacts);
  slip.setZero(contacts);
  ray.setZero(4 * contacts);
  weights.clear();
  weights.reserve(std::size_t(4 * contacts));
}

struct ContactLcpSolver::Workspace {
  Workspace(int contacts, int vertices)
      : system(contacts, vertices),
        path(contacts * (vertices + 2), 6 * contacts + 3),
        contact_capacity(contacts),
        vertex_capacity(vertices),
        impulse_scale(4 * contacts),
        velocity_scale(4 * contacts),
        kept_friction(std::size_t(contacts)) {}

  void check(const ContactLcp& problem) const;
  void scale(const ContactLcp& problem);
  void cover(int attempt);
  void choose_first_vertices();
  PathEnd follow_adding_vertices(int attempt, const internal::PathOptions& options,
                                 LcpResult& result);
  bool is_solved_by_zero() const;
  void find_unused_slip(const ContactLcp& problem, ContactSolution& solution) const;
  bool infeasible_without_friction(const ContactLcp& problem, ContactSolution& solution,
                                   LcpResult& result);
  double extract(const ContactLcp& problem, ContactSolution& solution);
  RayProof check_ray(const ContactLcp& problem, ContactSolution& solution);
  LcpResult follow_paths(const ContactLcp& problem, ContactSolution& solution);

  ContactSystem system;
  internal::LemkePath<ContactSystem> path;
  int contact_capacity, vertex_capacity;
  /// Impulse = impulse_scale * scaled impulse * velocity_unit, velocity = scaled velocity *
  /// velocity_unit / velocity_scale.
  Eigen::VectorXd impulse_scale, velocity_scale;
  double velocity_unit = 1;
  std::vector<char> kept_friction;
  static constexpr std::size_t kFirstVertices = 6;
  std::array<int, kFirstVertices> first_vertices{};  ///< -1: none
};

void ContactLcpSolver::Workspace::check(const ContactLcp& problem) const {
  const auto refuse = [](const char* field, const std::string& value, const std::string& allowed) {
    throw InputError("contact problem", field, value, allowed);
  };
  const int nc = problem.contacts(), u = int(problem.vertices.cols());
  if (nc > contact_capacity)
    refuse("contacts", std::to_string(nc), "at most " + std::to_string(contact_capacity));
  if (u > vertex_capacity)
    refuse("vertices", std::to_string(u), "at most " + std::to_string(vertex_capacity));
  if (problem.delassus.rows() != 4 * nc || problem.delassus.cols() != 4 * nc ||
      problem.free_velocity.size() != 4 * nc || problem.eccentricity_m.size() != nc)
    refuse("size", "", "4 rows per contact and one friction coefficient, one e_n");
  if (!problem.delassus.allFinite()) refuse("W", "", "finite numbers");
  if (!problem.free_velocity.allFinite()) refuse("free velocity", "", "finite numbers");
  if (!problem.vertices.allFinite()) refuse("V", "", "finite numbers");
  for (int i = 0; i < nc; ++i) {
    const double mu = problem.friction_coefficient[i], arm_m = problem.eccentricity_m[i];
    const double inverse_mass = problem.delassus(4 * i, 4 * i);
    if (!(mu >= 0 && std::isfinite(mu)))
      refuse("mu", std::to_string(mu), "finite numbers >= 0, one per contact");
    if (!(arm_m >= 0 && std::isfinite(arm_m)))
      refuse("en", std::to_string(arm_m), "finite numbers >= 0, one per contact");
    if (!(inverse_mass > 0))
      refuse("W_nn", std::to_string(inverse_mass) + " of contact " + std::to_string(i),
             "> 0: one of the two bodies has to be movable");
  }
}

void ContactLcpSolver::Workspace::scale(const ContactLcp& problem) {
  const int nc = problem.contacts(), u = int(problem.vertices.cols());
  system.contacts = nc;
  system.count = u;
  system.vertices.leftCols(u) = problem.vertices;
  system.vertex_radius = u > 0 ? problem.vertices.colwise().norm().maxCoeff() : 0;
  for (int i = 0; i < nc; ++i) {
    const double mu = problem.friction_coefficient[i], arm_m = problem.eccentricity_m[i];
    const Eigen::Vector3d arms(1, 1, arm_m);
    const double normal = problem.delassus(4 * i, 4 * i);
    const Eigen::Matrix3d tangential =
        arms.asDiagonal() * problem.delassus.block<3, 3>(4 * i + 1, 4 * i + 1) * arms.asDiagonal();
    // A long arm on a light body: the row about the normal would outweigh all others.
    const double largest = std::max(normal, tangential.diagonal().maxCoeff());
    const double scale = 1 / std::sqrt(normal);
    system.has_friction[std::size_t(i)] = mu > 0 && u > 0;
    impulse_scale[4 * i] = velocity_scale[4 * i] = scale;
    impulse_scale.segment<3>(4 * i + 1) = (mu > 0 ? mu : 1) * scale * arms;
    velocity_scale.segment<3>(4 * i + 1) = normal / largest * scale * arms;
  }
  const int n = 4 * nc;
  system.delassus.topLeftCorner(n, n) =
      velocity_scale.head(n).asDiagonal() * problem.delassus * impulse_scale.head(n).asDiagonal();
  system.free_velocity.head(n) = velocity_scale.head(n).cwiseProduct(problem.free_velocity);
  velocity_unit = system.free_velocity.head(n).lpNorm<Eigen::Infinity>();
  if (velocity_unit > 0) system.free_velocity.head(n) /= velocity_unit;
  const double largest_velocity = problem.free_velocity.lpNorm<Eigen::Infinity>();
  for (int i = 0; i < nc; ++i)
    system.natural_sizes[i] =
        std::min(1., velocity_scale[4 * i + 1] * largest_velocity / velocity_unit);
  system.find_neighbours();
  choose_first_vertices();
}

void ContactLcpSolver::Workspace::cover(int attempt) {
  const auto random = [attempt](int kind, int index) {
    return internal::hash_to_unit(std::uint64_t(4 * attempt + kind), std::uint64_t(index));
  };
  for (int i = 0; i < system.contacts; ++i) {
    system.normal_cover[i] = 1 + random(0, i);
    system.slip_cover[i] = 1 + random(1, i);
    system.slack_cover[i] = 1 + random(2, i);
  }
  // Nearly equal, so that the path turns with the slip from vertex to vertex.
  constexpr double kSpread = 0.1;
  for (int j = 0; j < system.count; ++j) system.vertex_cover[j] = 1 + kSpread * random(3, j);
}

bool ContactLcpSolver::Workspace::is_solved_by_zero() const {
  for (int i = 0; i < system.contacts; ++i)
    if (system.free_velocity[4 * i] < 0) return false;
  return true;
}

/// The lambda of contacts without load or friction: no other row depends on it.
void ContactLcpSolver::Workspace::find_unused_slip(const ContactLcp& problem,
                                                   ContactSolution& solution) const {
  for (int i = 0; i < system.contacts; ++i) {
    if (system.has_friction[std::size_t(i)] && solution.impulse[4 * i] > 0) continue;
    solution.slip[i] = 0;
    for (int j = 0; j < system.count; ++j)
      solution.slip[i] = std::max(solution.slip[i], -slip_along(problem, solution, i, j));
  }
}

/// Is the same problem without friction infeasible? Then no friction helps, and the ray found is
/// one of normal impulses.
bool ContactLcpSolver::Workspace::infeasible_without_friction(const ContactLcp& problem,
                                                              ContactSolution& solution,
                                                              LcpResult& result) {
  kept_friction = system.has_friction;
  std::fill(system.has_friction.begin(), system.has_friction.end(), char(false));
  internal::PathOptions options;
  options.most_pivots = 100 * system.contacts + 200;
  const PathEnd end = path.follow(system, options);
  result.pivots += path.pivots();
  const bool infeasible =
      end == PathEnd::ray && check_ray(problem, solution) == RayProof::infeasible;
  system.has_friction = kept_friction;
  return infeasible;
}

/// Writes the solution in the problem's units; returns its residual.
double ContactLcpSolver::Workspace::extract(const ContactLcp& problem, ContactSolution& solution) {
  const int nc = system.contacts;
  solution.impulse.setZero(4 * nc);
  solution.slip.setZero(nc);
  solution.weights.clear();
  for (int p = 0; p < path.basis_size(); ++p) {
    const int index = path.basis_column(p);
    const double value = path.basis_value(p);
    if (index == system.pairs() || !(value > 0)) continue;
    if (index < nc) {
      solution.impulse[4 * index] = impulse_scale[4 * index] * velocity_unit * value;
    } else if (index < 2 * nc) {
      const int i = index - nc;
      solution.slip[i] = value * velocity_unit / velocity_scale[4 * i + 1];
    } else {
      const int i = (index - 2 * nc) / system.count, j = (index - 2 * nc) % system.count;
      const double weight = impulse_scale[4 * i + 1] * velocity_unit * value;
      const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[i]);
      solution.impulse.segment<3>(4 * i + 1) += weight * arms.cwiseProduct(problem.vertices.col(j));
      solution.weights.push_back({i, j, weight});
    }
  }
  solution.velocity = problem.free_velocity;
  solution.velocity.noalias() += problem.delassus * solution.impulse;
  find_unused_slip(problem, solution);
  return contact_residual(problem, solution);
}

/// The direction of the last path as impulses that move nothing.
RayProof ContactLcpSolver::Workspace::check_ray(const ContactLcp& problem,
                                                ContactSolution& solution) {
  constexpr double kRoundOff = 1e-9;
  const int nc = system.contacts, n = 4 * nc;
  const Motion& ray = system.current_direction();
  const double size = ray.impulse.head(n).lpNorm<Eigen::Infinity>();
  if (!(size > 0) || std::abs(ray.z0) > kRoundOff * size ||
      ray.velocity.head(n).lpNorm<Eigen::Infinity>() > kRoundOff * size)
    return RayProof::none;
  bool with_friction = false;
  for (int i = 0; i < nc; ++i) {
    if (ray.impulse[4 * i] < -kRoundOff * size || ray.slack[i] < -kRoundOff * size)
      return RayProof::none;
    with_friction |= ray.impulse.segment<3>(4 * i + 1).norm() > kRoundOff * size;
  }
  solution.ray = impulse_scale.head(n).cwiseProduct(ray.impulse.head(n)) / size;
  const double work = solution.ray.dot(problem.free_velocity);
  const double natural = solution.ray.cwiseAbs().dot(problem.free_velocity.cwiseAbs());
  if (!(work < -kRoundOff * natural)) return RayProof::none;
  return with_friction ? RayProof::ray_only : RayProof::infeasible;
}

/// Solves the problem with few vertices, adds those that the solution violates, and goes on from
/// its basis; from z = 0 where that path ends elsewhere. Every other attempt has all vertices from
/// the start.
PathEnd ContactLcpSolver::Workspace::follow_adding_vertices(int attempt,
                                                            const internal::PathOptions& options,
                                                            LcpResult& result) {
  constexpr double kTolerated = 1e-13;
  system.use_no_vertices();
  const bool all = attempt % 2 == 1;
  for (int i = 0; i < system.contacts; ++i)
    if (all)
      for (int j = 0; j < system.count; ++j) system.use_vertex(i, j);
    else
      for (const int j : first_vertices)
        if (j >= 0) system.use_vertex(i, j);
  PathEnd end = path.follow(system, options);
  result.pivots += path.pivots();
  while (end == PathEnd::solved && system.use_violated_vertices(kTolerated)) {
    end = path.follow(system, options, true);
    result.pivots += path.pivots();
    if (end == PathEnd::solved) continue;
    end = path.follow(system, options);
    result.pivots += path.pivots();
  }
  return end;
}

/// Some vertices far apart, the first one among them.
void ContactLcpSolver::Workspace::choose_first_vertices() {
  first_vertices.fill(-1);
  const int most = std::min(system.count, int(first_vertices.size()));
  for (int n = 0; n < most; ++n) {
    int farthest = 0;
    double best = -1;
    for (int j = 0; n > 0 && j < system.count; ++j) {
      double nearest = std::numeric_limits<double>::infinity();
      for (int m = 0; m < n; ++m)
        nearest = std::min(
            nearest, (system.vertices.col(j) - system.vertices.col(first_vertices[std::size_t(m)]))
                         .squaredNorm());
      if (nearest <= best) continue;
      best = nearest;
      farthest = j;
    }
    first_vertices[std::size_t(n)] = farthest;
  }
}

LcpResult ContactLcpSolver::Workspace::follow_paths(const ContactLcp& problem,
                                                    ContactSolution& solution) {
  LcpResult result;
  result.residual = std::numeric_limits<double>::infinity();
  internal::PathOptions options;
  options.most_pivots = 100 * system.contacts + 200;
  int best_attempt = 0;
  const auto follow = [&](int attempt) {
    options.tolerance = attempt % 2 == 0 ? 1e-12 : 1e-11;
    cover(attempt);
    ++result.attempts;
    return follow_adding_vertices(attempt, options, result);
  };
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    if (follow(attempt) == PathEnd::ray) {
      const RayProof proof = check_ray(problem, solution);
      if (proof == RayProof::none) continue;
      result.proof = proof;
      if (proof == RayProof::infeasible || infeasible_without_friction(problem, solution, result)) {
        result.proof = RayProof::infeasible;
        break;
      }
      continue;
    }
    const double reached = extract(problem, solution);
    if (reached < result.residual) {
      result.residual = reached;
      best_attempt = attempt;
    }
    if (reached <= kGood || (attempt + 1 >= kAttemptsForGood && result.residual <= kTolerance))
      break;
  }
  if (std::isfinite(result.residual) && result.proof != RayProof::infeasible) {
    if (best_attempt != result.attempts - 1) {
      follow(best_attempt);
      extract(problem, solution);
    }
    if (result.residual <= kTolerance) {
      result.status = LcpStatus::solved;
      result.proof = RayProof::none;
      return result;
    }
  }
  if (result.proof != RayProof::none) {
    result.status = LcpStatus::infeasible_or_ray;
    result.residual = std::numeric_limits<double>::infinity();
  }
  return result;
}

ContactLcpSolver::ContactLcpSolver(int largest_contacts, int largest_vertices)
    : workspace_(std::make_unique<Workspace>(std::max(largest_contacts, 0),
                                             std::max(largest_vertices, 0))) {}
ContactLcpSolver::~ContactLcpSolver() = default;
ContactLcpSolver::ContactLcpSolver(ContactLcpSolver&&) noexcept = default;
ContactLcpSolver& ContactLcpSolver::operator=(ContactLcpSolver&&) noexcept = default;

LcpResult ContactLcpSolver::solve(const ContactLcp& problem, ContactSolution& solution) {
  workspace_->check(problem);
  solution.resize(problem.contacts());
  workspace_->scale(problem);
  if (workspace_->is_solved_by_zero()) {
    LcpResult result;
    result.status = LcpStatus::solved;
    solution.velocity = problem.free_velocity;
    workspace_->find_unused_slip(problem, solution);
    result.residual = contact_residual(problem, solution);
    return result;
  }
  return workspace_->follow_paths(problem, solution);
}

double contact_residual(const ContactLcp& problem, const ContactSolution& solution) {
  const int nc = problem.contacts(), u = int(problem.vertices.cols());
  const double velocity_unit = problem.free_velocity.lpNorm<Eigen::Infinity>();
  const double impulse_unit = solution.impulse.lpNorm<Eigen::Infinity>();
  double worst = 0;
  const auto add = [&worst](double value) { worst = std::max(worst, std::abs(value)); };
  const auto over = [](double value, double unit) { return unit > 0 ? value / unit : value; };
  for (int i = 0; i < nc; ++i) {
    const double normal = solution.impulse[4 * i];
    add(over(std::min(problem.delassus(4 * i, 4 * i) * normal, solution.velocity[4 * i]),
             velocity_unit));
    double slack = problem.friction_coefficient[i] * normal;
    for (const ContactSolution::Weight& weight : solution.weights)
      if (weight.contact == i) slack -= weight.value;
    add(std::min(over(solution.slip[i], velocity_unit), over(slack, impulse_unit)));
    for (int j = 0; j < u; ++j)
      add(over(std::min(0., solution.slip[i] + slip_along(problem, solution, i, j)),
               velocity_unit));
  }
  for (const ContactSolution::Weight& weight : solution.weights) {
    const int i = weight.contact;
    const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[i]);
    const Eigen::Vector3d vertex = arms.cwiseProduct(problem.vertices.col(weight.vertex));
    const double diagonal = vertex.dot(problem.delassus.block<3, 3>(4 * i + 1, 4 * i + 1) * vertex);
    add(over(std::min(diagonal * weight.value,
                      solution.slip[i] + slip_along(problem, solution, i, weight.vertex)),
             velocity_unit));
  }
  return worst;
}

}  // namespace softfinger
