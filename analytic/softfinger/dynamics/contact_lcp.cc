#include "softfinger/dynamics/contact_lcp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "softfinger/dynamics/contact_system.h"
#include "softfinger/dynamics/covering.h"
#include "softfinger/dynamics/exact_newton.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using internal::ContactSystem;
using internal::Motion;
using internal::PathEnd;

constexpr int kMostAttempts = 32;
/// From this attempt on facets are solved with a little more on the diagonal of W.
constexpr int kFirstProximal = 24;
constexpr double kProximals[] = {1e-14, 1e-13, 1e-12, 1e-11};
/// A solution is one below the first, or what rounding leaves of it; below the second, no other
/// covering vector is tried.
constexpr double kTolerance = 1e-10, kGood = 1e-12;
constexpr int kAttemptsForGood = 4;
/// Of the first path; the later ones are careful.
constexpr int kRefreshAfter = 8;
/// Vertices of its own that a contact may get under exact friction.
constexpr int kOwnVertices = 40;

bool is_exact(const ContactLcp& problem) { return problem.friction_rule != FrictionRule::facets; }

/// (v_t1, v_t2, e_n omega) of a contact.
Eigen::Vector3d scaled_slip(const ContactLcp& problem, const ContactSolution& solution,
                            int contact) {
  const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[contact]);
  return arms.cwiseProduct(solution.velocity.segment<3>(4 * contact + 1));
}

/// Eigen's allFinite, several numbers at a time.
template <class Matrix>
bool all_finite(const Matrix& matrix) {
  return (0 * matrix.array()).sum() == 0;
}

/// The least D_j^T v_t of all vertices; 0 if there are none.
double slip_against(const ContactLcp& problem, const Eigen::Vector3d& slip) {
  if (problem.vertices.cols() == 0) return 0;
  return slip.transpose().lazyProduct(problem.vertices).minCoeff();
}

/// `least_along`: a contact's slip_against.
template <class LeastAlong>
double residual_of(const ContactLcp& problem, const ContactSolution& solution,
                   const LeastAlong& least_along) {
  // Minima and maxima drop what is no number.
  if (!all_finite(solution.impulse) || !all_finite(solution.velocity) || !all_finite(solution.slip))
    return std::numeric_limits<double>::infinity();
  const int nc = problem.contacts();
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
    add(over(std::min(0., solution.slip[i] + least_along(i)), velocity_unit));
  }
  for (const ContactSolution::Weight& weight : solution.weights) {
    const int i = weight.contact;
    const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[i]);
    const Eigen::Vector3d vertex = arms.cwiseProduct(problem.vertices.col(weight.vertex));
    const double diagonal = vertex.dot(problem.delassus.block<3, 3>(4 * i + 1, 4 * i + 1) * vertex);
    const double along = problem.vertices.col(weight.vertex).dot(scaled_slip(problem, solution, i));
    add(over(std::min(diagonal * weight.value, solution.slip[i] + along), velocity_unit));
  }
  return worst;
}

/// How much of the residual rounding of W r alone explains: where bodies are wedged by impulses a
/// million times larger than their motion needs, no other impulses would do better.
double rounding_of(const ContactLcp& problem, const ContactSolution& solution) {
  constexpr double kRoundings = 4, kMost = 1e-9;
  double largest = 0;
  for (int row = 0; row < solution.impulse.size(); ++row) {
    const double unit = row % 4 == 3 ? problem.eccentricity_m[row / 4] : 1;
    const double terms = problem.delassus.row(row).cwiseAbs().dot(solution.impulse.cwiseAbs());
    largest = std::max(largest, unit * terms);
  }
  const double velocity_unit = problem.free_velocity.lpNorm<Eigen::Infinity>();
  if (!(velocity_unit > 0)) return 0;
  return std::min(kMost,
                  kRoundings * std::numeric_limits<double>::epsilon() * largest / velocity_unit);
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
        newton(contacts),
        contact_capacity(contacts),
        vertex_capacity(vertices),
        impulse_scale(4 * contacts),
        velocity_scale(4 * contacts),
        kept_friction(std::size_t(contacts)),
        exact_impulse(4 * contacts),
        best_impulse(4 * contacts),
        least_along(contacts),
        continues_as(std::size_t(contacts)) {
    uncleaned.resize(contacts);
    last.impulse.resize(4 * contacts);
    last.basis.reserve(std::size_t(6 * contacts + 3));
    basis.reserve(std::size_t(6 * contacts + 3));
  }

  void check(const ContactLcp& problem) const;
  void check_continued(const ContactLcp& problem, const std::vector<int>& continued) const;
  void scale(const ContactLcp& problem);
  void add_proximal(const ContactLcp& problem, double part);
  void cover(int attempt);
  internal::PathOptions options() const;
  void use_first_vertices(const ContactLcp& problem, bool all);
  PathEnd go_on_adding_vertices(PathEnd end, const ContactLcp& problem, ContactSolution& solution,
                                const internal::PathOptions& options, LcpResult& result,
                                bool is_warm = false);
  bool continue_last(const ContactLcp& problem, ContactSolution& solution,
                     const std::vector<int>& continued, LcpResult& result);
  bool use_last_basis(const ContactLcp& problem);
  void remember_basis();
  void remember(const ContactLcp& problem, const ContactSolution& solution);
  bool is_solved_by_zero() const;
  void find_unused_slip(const ContactLcp& problem, ContactSolution& solution);
  bool infeasible_without_friction(const ContactLcp& problem, ContactSolution& solution,
                                   LcpResult& result);
  double extract(const ContactLcp& problem, ContactSolution& solution);
  double extract_cleaned(const ContactLcp& problem, ContactSolution& solution, LcpResult& result);
  double polish(const ContactLcp& problem, ContactSolution& solution, LcpResult& result);
  double polish_from_impulse(const ContactLcp& problem, ContactSolution& solution,
                             LcpResult& result);
  double extract_exact(const ContactLcp& problem, ContactSolution& solution) const;
  RayProof check_ray(const ContactLcp& problem, ContactSolution& solution);
  LcpResult follow_paths(const ContactLcp& problem, ContactSolution& solution);

  ContactSystem system;
  internal::LemkePath<ContactSystem> path;
  internal::ExactNewton newton;
  int contact_capacity, vertex_capacity;
  /// Impulse = impulse_scale * scaled impulse * velocity_unit, velocity = scaled velocity *
  /// velocity_unit / velocity_scale.
  Eigen::VectorXd impulse_scale, velocity_scale;
  double velocity_unit = 1;
  double proximal = 0;  ///< what is added to W's diagonal, as a part of it
  std::vector<char> kept_friction;
  Eigen::VectorXd exact_impulse, best_impulse;  ///< scaled
  Eigen::VectorXd least_along;                  ///< of each contact's vertices, its slip_against
  double best_residual = 0;
  int newton_passes = 1;
  /// What the last problem leaves to the next one.
  struct Memory {
    struct Entry {
      ContactSystem::Pair pair;
      Eigen::Vector3d corner;  ///< the vertex itself
    };
    int contacts = -1, count = 0;  ///< -1: nothing yet
    FrictionRule rule = FrictionRule::facets;
    Eigen::VectorXd impulse;  ///< as solved
    std::vector<Entry> basis;
  };
  Memory last;
  std::vector<int> continues_as, basis;
  ContactSolution uncleaned;  ///< kept by extract_cleaned
};

void ContactLcpSolver::Workspace::check(const ContactLcp& problem) const {
  const auto refuse = [](const char* field, const std::string& value, const std::string& allowed) {
    throw InputError("contact problem", field, value, allowed);
  };
  const int nc = problem.contacts(), u = int(problem.vertices.cols());
  if (nc > contact_capacity)
    refuse("contacts", std::to_string(nc), "at most " + std::to_string(contact_capacity));
  const bool exact = is_exact(problem);
  if (!exact && u > vertex_capacity)
    refuse("vertices", std::to_string(u), "at most " + std::to_string(vertex_capacity));
  if (problem.delassus.rows() != 4 * nc || problem.delassus.cols() != 4 * nc ||
      problem.free_velocity.size() != 4 * nc || problem.eccentricity_m.size() != nc)
    refuse("size", "", "4 rows per contact and one friction coefficient, one e_n");
  if (!all_finite(problem.delassus)) refuse("W", "", "finite numbers");
  if (!all_finite(problem.free_velocity)) refuse("free velocity", "", "finite numbers");
  if (!exact && !all_finite(problem.vertices)) refuse("V", "", "finite numbers");
  if (problem.friction_rule == FrictionRule::limit_surface && int(problem.shapes.size()) != nc)
    refuse("shapes", std::to_string(problem.shapes.size()), "one per contact");
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

void ContactLcpSolver::Workspace::check_continued(const ContactLcp& problem,
                                                  const std::vector<int>& continued) const {
  if (int(continued.size()) != problem.contacts())
    throw InputError("contact problem", "continued", std::to_string(continued.size()),
                     "one per contact");
  for (const int contact : continued)
    if (contact < -1 || contact >= last.contacts)
      throw InputError("contact problem", "continued", std::to_string(contact),
                       "a contact of the last problem, or -1");
}

void ContactLcpSolver::Workspace::scale(const ContactLcp& problem) {
  const bool exact = is_exact(problem);
  const int nc = problem.contacts(), u = exact ? kOwnVertices : int(problem.vertices.cols());
  system.contacts = nc;
  system.count = u;
  system.own_vertices = exact;
  if (exact)
    system.vertex_radius = 0;
  else
    system.share_vertices(problem.vertices);
  for (int i = 0; i < nc; ++i) {
    const double mu = problem.friction_coefficient[i], arm_m = problem.eccentricity_m[i];
    const Eigen::Vector3d arms(1, 1, arm_m);
    const double normal = problem.delassus(4 * i, 4 * i);
    const Eigen::Matrix3d tangential =
        arms.asDiagonal() * problem.delassus.block<3, 3>(4 * i + 1, 4 * i + 1) * arms.asDiagonal();
    // A long arm on a light body: the row about the normal would outweigh all others.
    const double largest = std::max(normal, tangential.diagonal().maxCoeff());
    const double scale = 1 / std::sqrt(normal);
    const bool moves = tangential.diagonal().maxCoeff() > 0 ||
                       !problem.free_velocity.segment<3>(4 * i + 1).cwiseProduct(arms).isZero(0);
    system.has_friction[std::size_t(i)] = mu > 0 && u > 0 && moves;
    system.shapes[std::size_t(i)] =
        problem.friction_rule == FrictionRule::limit_surface && arm_m > 0
            ? problem.shapes[std::size_t(i)]
            : nullptr;
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
  system.prepare();
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
  system.covering = attempt;
}

bool ContactLcpSolver::Workspace::is_solved_by_zero() const {
  for (int i = 0; i < system.contacts; ++i)
    if (system.free_velocity[4 * i] < 0) return false;
  return true;
}

/// The lambda of contacts without load or friction: no other row depends on it.
void ContactLcpSolver::Workspace::find_unused_slip(const ContactLcp& problem,
                                                   ContactSolution& solution) {
  for (int i = 0; i < system.contacts; ++i) {
    const Eigen::Vector3d slip = scaled_slip(problem, solution, i);
    if (!is_exact(problem)) least_along[i] = system.slip_against(slip);
    if (system.has_friction[std::size_t(i)] && solution.impulse[4 * i] > 0) continue;
    solution.slip[i] = 0;
    if (is_exact(problem)) {
      if (slip.squaredNorm() > 0) solution.slip[i] = slip.dot(system.boundary_point(i, slip));
    } else {
      solution.slip[i] = std::max(0., -least_along[i]);
    }
  }
}

/// Is the same problem without friction infeasible? Then no friction helps, and the ray found is
/// one of normal impulses.
bool ContactLcpSolver::Workspace::infeasible_without_friction(const ContactLcp& problem,
                                                              ContactSolution& solution,
                                                              LcpResult& result) {
  kept_friction = system.has_friction;
  std::fill(system.has_friction.begin(), system.has_friction.end(), char(false));
  const PathEnd end = path.follow(system, options());
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
  // As `contact_residual`, several times faster where there are many vertices.
  return residual_of(problem, solution, [this](int contact) { return least_along[contact]; });
}

/// The same, where Harris' tolerance has left something negative after a few more pivots without.
double ContactLcpSolver::Workspace::extract_cleaned(const ContactLcp& problem,
                                                    ContactSolution& solution, LcpResult& result) {
  const double reached = extract(problem, solution);
  if (reached <= kGood) return reached;
  basis.clear();
  for (int p = 0; p < path.basis_size(); ++p)
    if (path.basis_column(p) != system.pairs()) basis.push_back(path.basis_column(p));
  internal::PathOptions exact_options = options();
  exact_options.tolerance = 1e-15;
  exact_options.refresh_after = 1;
  exact_options.most_pivots = system.contacts + 10;
  const int nc = system.contacts;
  uncleaned.impulse.head(4 * nc) = solution.impulse;
  uncleaned.velocity.head(4 * nc) = solution.velocity;
  uncleaned.slip.head(nc) = solution.slip;
  uncleaned.weights = solution.weights;
  if (path.follow_from(system, exact_options, basis.data(), int(basis.size())) == PathEnd::solved)
    path.refine();
  result.pivots += path.pivots();
  const double cleaned = extract(problem, solution);
  if (cleaned < reached) return cleaned;
  solution.impulse = uncleaned.impulse.head(4 * nc);
  solution.velocity = uncleaned.velocity.head(4 * nc);
  solution.slip = uncleaned.slip.head(nc);
  solution.weights = uncleaned.weights;
  return reached;
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
  // Impulses r that undo the work w of the ray y would need (W y)^T r >= w: where W y is not quite
  // zero, contacts nearly repeated on bodies of very different mass, large ones still could.
  constexpr double kLargestImpulse = 1e12;  // in units of what stops a contact's body
  const double work = -solution.ray.dot(problem.free_velocity);
  double most_undone = 0;
  for (int row = 0; row < n; ++row)
    most_undone += std::abs(problem.delassus.row(row).dot(solution.ray)) * impulse_scale[row];
  if (!(work > kLargestImpulse * velocity_unit * most_undone)) return RayProof::none;
  // Of the whole ray: with round-off in few rows of it, work would be found where there is none.
  const double natural =
      solution.ray.lpNorm<Eigen::Infinity>() * problem.free_velocity.lpNorm<Eigen::Infinity>();
  if (!(work > kRoundOff * natural)) return RayProof::none;
  return with_friction ? RayProof::ray_only : RayProof::infeasible;
}

internal::PathOptions ContactLcpSolver::Workspace::options() const {
  internal::PathOptions result;
  result.tolerance = 1e-12;
  result.most_pivots = 100 * system.contacts + 200;
  result.refresh_after = kRefreshAfter;
  return result;
}

/// What each contact's friction starts with: vertices far apart and against the free slip, or all;
/// under the exact rules, pure forces and torques.
void ContactLcpSolver::Workspace::use_first_vertices(const ContactLcp& problem, bool all) {
  system.use_no_vertices();
  for (int i = 0; i < system.contacts; ++i) {
    if (!system.has_friction[std::size_t(i)]) continue;
    if (is_exact(problem)) {
      const int axes = problem.eccentricity_m[i] > 0 ? 3 : 2;
      for (int axis = 0; axis < axes; ++axis)
        for (const double sign : {1., -1.})
          system.add_own_vertex(i, system.boundary_point(i, sign * Eigen::Vector3d::Unit(axis)));
    } else if (all) {
      for (int j = 0; j < system.count; ++j) system.use_vertex(i, j);
    }
  }
}

/// Adds vertices that the last solution violates, under the exact rules points that its slip and
/// load ask for, and goes on from its basis, until none is violated or Newton's method arrives from
/// there. Where a path ends elsewhere, it starts again from z = 0 with all vertices found so far,
/// unless it was a warm one.
PathEnd ContactLcpSolver::Workspace::go_on_adding_vertices(PathEnd end, const ContactLcp& problem,
                                                           ContactSolution& solution,
                                                           const internal::PathOptions& options,
                                                           LcpResult& result, bool is_warm) {
  constexpr double kTolerated = 1e-13;
  result.pivots += path.pivots();
  while (end == PathEnd::solved) {
    remember_basis();
    const bool more = is_exact(problem) ? polish(problem, solution, result) > kGood &&
                                              system.add_violated_points(kTolerated)
                                        : system.use_violated_vertices(kTolerated);
    if (!more) break;
    end = path.follow(system, options, true);
    result.pivots += path.pivots();
    if (end == PathEnd::solved) continue;
    if (is_warm) break;
    basis.clear();
    for (const Memory::Entry& entry : last.basis) basis.push_back(system.index(entry.pair));
    system.cover_towards(basis.data(), int(basis.size()));
    end = path.follow(system, options);
    result.pivots += path.pivots();
    cover(system.covering);
  }
  if (end == PathEnd::solved && !is_exact(problem)) path.refine();
  return end;
}

void ContactLcpSolver::Workspace::remember_basis() {
  last.basis.clear();
  for (int p = 0; p < path.basis_size(); ++p) {
    const ContactSystem::Pair pair = system.pair(path.basis_column(p));
    Eigen::Vector3d corner = Eigen::Vector3d::Zero();
    if (pair.kind == ContactSystem::Kind::vertex) corner = system.vertex(pair.contact, pair.vertex);
    last.basis.push_back({pair, corner});
  }
}

void ContactLcpSolver::Workspace::remember(const ContactLcp& problem,
                                           const ContactSolution& solution) {
  last.contacts = system.contacts;
  last.count = system.count;
  last.rule = problem.friction_rule;
  last.impulse.head(4 * system.contacts) = solution.impulse;
}

/// The last problem's basis in terms of this one's contacts, and its vertices in use.
bool ContactLcpSolver::Workspace::use_last_basis(const ContactLcp& problem) {
  use_first_vertices(problem, false);
  basis.clear();
  for (const Memory::Entry& entry : last.basis) {
    ContactSystem::Pair pair = entry.pair;
    const int i = pair.contact;
    if (pair.kind != ContactSystem::Kind::normal && !system.has_friction[std::size_t(i)]) continue;
    if (pair.kind == ContactSystem::Kind::vertex && is_exact(problem)) {
      // On the limit as it is now.
      const double gauge = friction_gauge(system.shapes[std::size_t(i)], entry.corner);
      pair.vertex = system.find_or_add_own_vertex(i, entry.corner / gauge);
      if (pair.vertex < 0) return false;
    } else if (pair.kind == ContactSystem::Kind::vertex) {
      system.use_vertex(i, pair.vertex);
    }
    basis.push_back(system.index(pair));
  }
  return true;
}

/// From the last solution: its impulses, where friction is exact, then its basis.
bool ContactLcpSolver::Workspace::continue_last(const ContactLcp& problem,
                                                ContactSolution& solution,
                                                const std::vector<int>& continued,
                                                LcpResult& result) {
  const int nc = system.contacts;
  best_residual = std::numeric_limits<double>::infinity();
  result.residual = best_residual;
  std::fill(continues_as.begin(), continues_as.end(), -1);
  for (int i = 0; i < nc; ++i)
    if (continued[std::size_t(i)] >= 0) continues_as[std::size_t(continued[std::size_t(i)])] = i;
  std::size_t kept = 0;
  for (Memory::Entry& entry : last.basis) {
    const int contact = continues_as[std::size_t(entry.pair.contact)];
    if (contact < 0) continue;
    entry.pair.contact = contact;
    last.basis[kept++] = entry;
  }
  last.basis.resize(kept);

  if (is_exact(problem)) {
    for (int i = 0; i < nc; ++i) {
      exact_impulse.segment<4>(4 * i).setZero();
      const int before = continued[std::size_t(i)];
      if (before < 0) continue;
      for (int row = 0; row < (system.has_friction[std::size_t(i)] ? 4 : 1); ++row)
        if (impulse_scale[4 * i + row] > 0)
          exact_impulse[4 * i + row] =
              last.impulse[4 * before + row] / (velocity_unit * impulse_scale[4 * i + row]);
    }
    newton_passes = 1;
    result.residual = polish_from_impulse(problem, solution, result);
    if (result.residual <= kGood) return true;
  }
  newton_passes = 2;
  cover(0);
  if (!use_last_basis(problem)) return false;
  // More pivots than contacts have bounds are no gain over a cold start.
  internal::PathOptions warm_options = options();
  warm_options.most_pivots = 4 * nc + 10;
  const PathEnd end = path.follow_from(system, warm_options, basis.data(), int(basis.size()));
  if (go_on_adding_vertices(end, problem, solution, warm_options, result, true) != PathEnd::solved)
    return false;
  result.residual = is_exact(problem) ? best_residual : extract_cleaned(problem, solution, result);
  return result.residual <= kGood;
}

/// From the path's point to exact friction; keeps the best point so far. Returns its residual.
double ContactLcpSolver::Workspace::polish(const ContactLcp& problem, ContactSolution& solution,
                                           LcpResult& result) {
  const int n = 4 * system.contacts;
  exact_impulse.head(n) = system.current().impulse.head(n);
  return polish_from_impulse(problem, solution, result);
}

double ContactLcpSolver::Workspace::polish_from_impulse(const ContactLcp& problem,
                                                        ContactSolution& solution,
                                                        LcpResult& result) {
  const int n = 4 * system.contacts;
  newton.solve(system, exact_impulse, newton_passes);
  result.newton_iterations += newton.iterations();
  const double reached = extract_exact(problem, solution);
  if (reached < best_residual) {
    best_residual = reached;
    best_impulse.head(n) = exact_impulse.head(n);
  }
  return best_residual;
}

/// Writes `exact_impulse` in the problem's units; returns its residual.
double ContactLcpSolver::Workspace::extract_exact(const ContactLcp& problem,
                                                  ContactSolution& solution) const {
  const int nc = system.contacts, n = 4 * nc;
  for (int i = 0; i < nc; ++i) {
    solution.impulse.segment<4>(4 * i) =
        velocity_unit *
        impulse_scale.segment<4>(4 * i).cwiseProduct(exact_impulse.segment<4>(4 * i));
    // Newton's values are within their bounds to round-off only.
    if (!(exact_impulse[4 * i] > 0)) {
      solution.impulse.segment<4>(4 * i).setZero();
      continue;
    }
    const double gauge =
        friction_gauge(system.shapes[std::size_t(i)], exact_impulse.segment<3>(4 * i + 1));
    if (gauge > exact_impulse[4 * i])
      solution.impulse.segment<3>(4 * i + 1) *= exact_impulse[4 * i] / gauge;
  }
  solution.velocity.head(n) = problem.free_velocity;
  solution.velocity.noalias() += problem.delassus * solution.impulse;
  for (int i = 0; i < nc; ++i) {
    const Eigen::Vector3d slip = scaled_slip(problem, solution, i);
    solution.slip[i] = slip.squaredNorm() > 0 ? slip.dot(system.boundary_point(i, slip)) : 0;
  }
  return exact_contact_residual(problem, solution);
}

/// Of nearly redundant contacts no basis may be accurate enough: with a little more on W's diagonal
/// they are not redundant, and what that little makes of the residual is far below its bound unless
/// impulses are very large. The residual is always that of the problem itself.
void ContactLcpSolver::Workspace::add_proximal(const ContactLcp& problem, double part) {
  if (part == proximal) return;
  proximal = part;
  scale(problem);
  system.delassus.diagonal().head(4 * system.contacts) *= 1 + part;
  system.prepare();
}

LcpResult ContactLcpSolver::Workspace::follow_paths(const ContactLcp& problem,
                                                    ContactSolution& solution) {
  LcpResult result;
  result.residual = std::numeric_limits<double>::infinity();
  internal::PathOptions path_options = options();
  int best_attempt = 0;
  const bool exact = is_exact(problem);
  best_residual = std::numeric_limits<double>::infinity();
  const auto follow = [&](int attempt) {
    path_options.tolerance = attempt % 2 == 0 ? 1e-12 : 1e-11;
    // Newton takes the last digits of the exact rules: their paths need no smaller pivots.
    path_options.smallest_pivot = exact || attempt / 2 % 2 == 0 ? 1e-9 : 1e-11;
    path_options.refresh_after = attempt == 0 ? kRefreshAfter : 1;
    if (!exact) add_proximal(problem, attempt < kFirstProximal ? 0 : kProximals[attempt % 4]);
    cover(attempt);
    ++result.attempts;
    newton_passes = attempt == 0 ? 2 : internal::ExactNewton::kMostPasses;
    use_first_vertices(problem, attempt % 2 == 1);
    return go_on_adding_vertices(path.follow(system, path_options), problem, solution, path_options,
                                 result);
  };
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    const PathEnd end = follow(attempt);
    if (exact) result.residual = best_residual;
    if (exact && best_residual <= kGood) break;
    if (end == PathEnd::ray) {
      const RayProof proof = check_ray(problem, solution);
      if (proof == RayProof::none) continue;
      result.proof = proof;
      if (proof == RayProof::infeasible || infeasible_without_friction(problem, solution, result)) {
        result.proof = RayProof::infeasible;
        break;
      }
      continue;
    }
    const double reached = exact ? best_residual : extract_cleaned(problem, solution, result);
    if (reached < result.residual) {
      result.residual = reached;
      best_attempt = attempt;
    }
    if (reached <= kGood || (attempt + 1 >= kAttemptsForGood && result.residual <= kTolerance))
      break;
  }
  if (exact && std::isfinite(result.residual)) {
    exact_impulse = best_impulse;
    extract_exact(problem, solution);
  } else if (std::isfinite(result.residual) && result.proof != RayProof::infeasible &&
             best_attempt != result.attempts - 1) {
    follow(best_attempt);
    result.residual = extract_cleaned(problem, solution, result);
  }
  if (result.residual <= kTolerance || result.residual <= rounding_of(problem, solution)) {
    result.status = LcpStatus::solved;
    result.proof = RayProof::none;
    return result;
  }
  if (result.proof != RayProof::none) {
    result.status = LcpStatus::infeasible_or_ray;
    result.residual = std::numeric_limits<double>::infinity();
  }
  return result;
}

ContactLcpSolver::ContactLcpSolver(int largest_contacts, int largest_vertices)
    : workspace_(std::make_unique<Workspace>(std::max(largest_contacts, 0),
                                             std::max(largest_vertices, kOwnVertices))) {}
ContactLcpSolver::~ContactLcpSolver() = default;
ContactLcpSolver::ContactLcpSolver(ContactLcpSolver&&) noexcept = default;
ContactLcpSolver& ContactLcpSolver::operator=(ContactLcpSolver&&) noexcept = default;

LcpResult ContactLcpSolver::solve(const ContactLcp& problem, ContactSolution& solution,
                                  const std::vector<int>* continued) {
  Workspace& work = *workspace_;
  work.check(problem);
  if (continued) work.check_continued(problem, *continued);
  solution.resize(problem.contacts());
  work.scale(problem);
  work.proximal = 0;
  LcpResult result;
  const bool zero = work.is_solved_by_zero();
  if (zero) {
    result.status = LcpStatus::solved;
    solution.velocity = problem.free_velocity;
    work.find_unused_slip(problem, solution);
    result.residual = is_exact(problem) ? exact_contact_residual(problem, solution)
                                        : contact_residual(problem, solution);
    work.last.basis.clear();
  } else if (continued && work.last.rule == problem.friction_rule &&
             work.last.count == work.system.count &&
             work.continue_last(problem, solution, *continued, result)) {
    result.status = LcpStatus::solved;
    result.warm = true;
  } else {
    const LcpResult cold = work.follow_paths(problem, solution);
    result.status = cold.status;
    result.residual = cold.residual;
    result.proof = cold.proof;
    result.attempts = cold.attempts;
    result.pivots += cold.pivots;
    result.newton_iterations += cold.newton_iterations;
  }
  work.remember(problem, solution);
  return result;
}

double contact_residual(const ContactLcp& problem, const ContactSolution& solution) {
  return residual_of(problem, solution, [&](int contact) {
    return slip_against(problem, scaled_slip(problem, solution, contact));
  });
}

double exact_contact_residual(const ContactLcp& problem, const ContactSolution& solution) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (!all_finite(solution.impulse)) return kInfinity;
  const int nc = problem.contacts();
  const double velocity_unit = problem.free_velocity.lpNorm<Eigen::Infinity>();
  const double impulse_unit = solution.impulse.lpNorm<Eigen::Infinity>();
  double worst = 0;
  const auto add = [&worst](double value, double unit) {
    worst = std::max(worst, std::abs(unit > 0 ? value / unit : value));
    if (std::isnan(value)) worst = kInfinity;
  };
  for (int i = 0; i < nc; ++i) {
    const Eigen::Vector4d velocity = problem.free_velocity.segment<4>(4 * i) +
                                     problem.delassus.middleRows<4>(4 * i) * solution.impulse;
    if (!all_finite(velocity)) return kInfinity;
    const double normal = solution.impulse[4 * i], own = problem.delassus(4 * i, 4 * i);
    const double arm_m = problem.eccentricity_m[i];
    add(std::min(own * normal, velocity[0]), velocity_unit);
    const Eigen::Vector3d arms(1, 1, arm_m);
    const Eigen::Vector3d slip = arms.cwiseProduct(velocity.tail<3>());
    Eigen::Vector3d wrench = solution.impulse.segment<3>(4 * i + 1);
    if (arm_m > 0)
      wrench.z() /= arm_m;
    else
      add(wrench.z(), impulse_unit);
    if (!(arm_m > 0)) wrench.z() = 0;
    const double limit = problem.friction_coefficient[i] * std::max(normal, 0.);
    const FrictionShape* shape = problem.friction_rule == FrictionRule::limit_surface && arm_m > 0
                                     ? problem.shapes[std::size_t(i)]
                                     : nullptr;
    add(std::max(0., friction_gauge(shape, wrench) - limit), impulse_unit);
    if (!(problem.friction_coefficient[i] > 0)) continue;
    const Eigen::Matrix3d tangential =
        arms.asDiagonal() * problem.delassus.block<3, 3>(4 * i + 1, 4 * i + 1) * arms.asDiagonal();
    const double largest = tangential.diagonal().maxCoeff();
    const double step = largest > 0 ? largest : own;
    const FrictionExcess excess =
        friction_excess(shape, step * wrench - slip, limit, Eigen::Vector3d::Constant(step));
    add((slip + excess.excess).lpNorm<Eigen::Infinity>(), velocity_unit);
  }
  return worst;
}

}  // namespace softfinger
