#include "softfinger/dynamics/facet_friction.h"

#include <algorithm>

#include "softfinger/dynamics/contact_residual.h"

namespace softfinger::internal {
namespace {

// The attempts after the quick one, each for a reason of its own. The numbers were found by trial
// on random scenes (tests/dynamics/random_scene.h: masses over six decades, contacts repeated
// nearby), of which no single choice solves all.

/// A path that goes on with new vertices may end in a ray that means nothing; one that has all of
/// them from the start does not. Ties are more frequent: a larger tolerance.
constexpr Attempt kAllVertices{1e-11, 1e-9, 1, true};
/// Nearly redundant contacts of stiff joints have true pivots below the usual limit. Elsewhere such
/// pivots are round-off.
constexpr Attempt kSmallPivots{1e-12, 1e-11, 1};
constexpr Attempt kAllVerticesSmallPivots{1e-11, 1e-11, 1, true};
constexpr Attempt kRound[] = {kCareful, kAllVertices, kSmallPivots, kAllVerticesSmallPivots};

/// After six rounds. Of nearly redundant contacts no basis may be accurate enough: with a little
/// more on W's diagonal they are not redundant. What that little makes of the residual, which is
/// always that of the problem itself, is far below its bound unless impulses are very large.
constexpr Attempt proximal(Attempt attempt, double part) {
  attempt.proximal = part;
  return attempt;
}
constexpr int kFirstProximal = 24;
constexpr Attempt kProximalRound[] = {proximal(kCareful, 1e-14), proximal(kAllVertices, 1e-13),
                                      proximal(kSmallPivots, 1e-12),
                                      proximal(kAllVerticesSmallPivots, 1e-11)};

}  // namespace

FacetFriction::FacetFriction(ContactSystem& system, ContactPath& path, int contact_capacity)
    : system_(system), path_(path), least_along_(contact_capacity) {
  basis_.reserve(std::size_t(largest_basis(contact_capacity)));
  uncleaned_.resize(contact_capacity);
}

void FacetFriction::begin(const ContactLcp& problem) {
  best_.forget();
  proximal_ = 0;
  system_.set_with_shared_vertices(problem, 0);
}

const Attempt& FacetFriction::attempt(int number) const {
  if (number == 0) return kQuick;
  return number < kFirstProximal ? kRound[number % 4] : kProximalRound[number % 4];
}

void FacetFriction::start(const ContactLcp& problem, int number) {
  attempt_ = number;
  if (attempt(number).proximal != proximal_) {
    proximal_ = attempt(number).proximal;
    system_.set_with_shared_vertices(problem, proximal_);
  }
  system_.use_no_vertices();
  if (!attempt(number).has_all_vertices) return;
  for (int i = 0; i < system_.contacts(); ++i) {
    if (!system_.contact_operator().has_friction(i)) continue;
    for (int j = 0; j < system_.vertices().per_contact(); ++j) system_.use_vertex(i, j);
  }
}

int FacetFriction::continue_vertex(const ContactPair& pair, const Eigen::Vector3d&) {
  system_.use_vertex(pair.contact, pair.vertex);
  return pair.vertex;
}

/// Adds vertices to each loaded contact whose lambda the vertices in use underestimate: the vertex
/// most opposite to the slip, and the corners of the facet on which its friction would lie if the
/// other contacts kept their impulses. A contact without load needs none, because its lambda
/// appears in no other row.
bool FacetFriction::add_vertices(const Task&) {
  const ContactOperator& contacts = system_.contact_operator();
  const FrictionVertices& vertices = system_.vertices();
  const Motion& state = system_.current();
  bool found = false;
  for (int i = 0; i < contacts.contacts(); ++i) {
    if (!contacts.has_friction(i) || !(state.impulse[4 * i] > 0)) continue;
    const Eigen::Vector3d slip = state.velocity.segment<3>(4 * i + 1);
    const double known = state.slip[i] + kToleratedViolation * contacts.natural_size(i);
    if (vertices.radius() * slip.norm() <= known) continue;
    const int worst = system_.vertex_beyond(-slip, known);
    if (worst < 0 || vertices.is_in_use(i, worst)) continue;
    system_.use_vertex(i, worst);
    found = true;
    FrictionPolytope::Facet facet;
    if (!system_.find_facet(friction_alone(i), facet)) continue;
    for (const int vertex : facet) system_.use_vertex(i, vertex);
  }
  return found;
}

/// The friction of a contact on the unit ball if the other contacts, and its own load, kept their
/// impulses: a few fixed-point steps from the last solution. Only a direction is wanted, so that
/// four are enough.
Eigen::Vector3d FacetFriction::friction_alone(int i) const {
  constexpr int kSteps = 4;
  const ContactOperator& contacts = system_.contact_operator();
  const Motion& state = system_.current();
  const auto own = contacts.delassus().block<3, 3>(4 * i + 1, 4 * i + 1);
  const Eigen::Vector3d metric = contacts.friction_metric(i);
  Eigen::Vector3d friction = state.impulse.segment<3>(4 * i + 1);
  Eigen::Vector3d slip = state.velocity.segment<3>(4 * i + 1);
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Vector3d target = metric.cwiseProduct(friction) - slip;
    const Eigen::Vector3d excess =
        friction_excess(contacts.shape(i), target, state.impulse[4 * i], metric).excess;
    const Eigen::Vector3d next = (target - excess).cwiseQuotient(metric);
    slip += own * (next - friction);
    friction = next;
  }
  return friction;
}

/// Harris' tolerance can leave something negative: a few more pivots without it then follow.
double FacetFriction::read_path(const Task& task) {
  const double reached = extract(task);
  double best = reached;
  if (reached > kGood) {
    const int nc = system_.contacts();
    const ContactSolution& found = task.solution;
    uncleaned_.impulse.head(4 * nc) = found.impulse;
    uncleaned_.velocity.head(4 * nc) = found.velocity;
    uncleaned_.slip.head(nc) = found.slip;
    uncleaned_.weights = found.weights;
    clean_path(task);
    best = extract(task);
    if (!(best < reached)) {
      best = reached;
      task.solution.impulse = uncleaned_.impulse.head(4 * nc);
      task.solution.velocity = uncleaned_.velocity.head(4 * nc);
      task.solution.slip = uncleaned_.slip.head(nc);
      task.solution.weights = uncleaned_.weights;
    }
  }
  if (best < best_.residual) {
    best_.residual = best;
    best_.is_good = task.is_good(best);
    best_attempt_ = attempt_;
  }
  return best;
}

void FacetFriction::clean_path(const Task& task) {
  basis_.clear();
  for (int p = 0; p < path_.basis_size(); ++p)
    if (path_.basis_column(p) != system_.pairs()) basis_.push_back(path_.basis_column(p));
  PathOptions options = usual_path(system_.contacts());
  options.tolerance = 1e-15;
  options.refresh_after = 1;
  options.most_pivots = system_.contacts() + 10;
  if (path_.follow_from(system_, options, basis_.data(), int(basis_.size())) == PathEnd::solved)
    path_.refine();
  task.result.pivots += path_.pivots();
}

/// Writes the basic z in the problem's units; returns the residual.
double FacetFriction::extract(const Task& task) {
  const ContactLcp& problem = task.problem;
  ContactSolution& solution = task.solution;
  const ContactOperator& contacts = system_.contact_operator();
  const int nc = contacts.contacts();
  solution.impulse.setZero(4 * nc);
  solution.slip.setZero(nc);
  solution.weights.clear();
  for (int p = 0; p < path_.basis_size(); ++p) {
    const double value = path_.basis_value(p);
    if (path_.basis_column(p) == system_.pairs() || !(value > 0)) continue;
    const ContactPair& pair = system_.pair(path_.basis_column(p));
    const int i = pair.contact;
    if (pair.kind == ContactPair::Kind::normal) {
      solution.impulse[4 * i] = contacts.impulse_scale()[4 * i] * contacts.velocity_unit() * value;
    } else if (pair.kind == ContactPair::Kind::slip) {
      solution.slip[i] = value * contacts.velocity_unit() / contacts.velocity_scale()[4 * i + 1];
    } else {
      const double weight = contacts.impulse_scale()[4 * i + 1] * contacts.velocity_unit() * value;
      const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[i]);
      solution.impulse.segment<3>(4 * i + 1) +=
          weight * arms.cwiseProduct(problem.vertices.col(pair.vertex));
      solution.weights.push_back({i, pair.vertex, weight});
    }
  }
  solution.velocity = problem.free_velocity;
  solution.velocity.noalias() += problem.delassus * solution.impulse;
  return complete(task);
}

/// Writes lambda of contacts without load or friction, which the path does not know because no
/// other row depends on it. Returns the residual.
double FacetFriction::complete(const Task& task) {
  ContactSolution& solution = task.solution;
  for (int i = 0; i < system_.contacts(); ++i) {
    least_along_[i] = system_.vertices().slip_against(scaled_slip(task.problem, solution, i));
    if (system_.contact_operator().has_friction(i) && solution.impulse[4 * i] > 0) continue;
    solution.slip[i] = std::max(0., -least_along_[i]);
  }
  // As `contact_residual`, several times faster where there are many vertices.
  return residual_of(task.problem, solution, least_along_);
}

}  // namespace softfinger::internal
