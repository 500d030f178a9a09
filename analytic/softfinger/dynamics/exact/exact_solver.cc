#include "softfinger/dynamics/exact/exact_solver.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "softfinger/dynamics/contacts/repeatable_random.h"
#include "softfinger/friction/linearised_friction.h"

namespace softfinger::internal {
namespace {

/// Newton's method tries its two smallest proximal terms from most points, and waits for so many
/// iterations until |F| is halved. Contacts that are the same to nine digits can hold it up for
/// hundreds.
constexpr int kUsualPatience = 20, kLongPatience = 300;
constexpr ImpulseSearch::Effort kUsual{2, kUsualPatience};
/// Effort after the last start, when Newton's method has all its passes.
constexpr ImpulseSearch::Effort kPatient{ExactNewton::kMostPasses, kLongPatience};
/// A warm start takes one pass, and few proximal points: a cold start solves the others.
constexpr ImpulseSearch::Effort kFromNear{1, kUsualPatience, ImpulseSearch::kEasedStarts,
                                          ProximalCourse::Start::near};
constexpr int kMostIterationsOfWarm = 60;

/// Fewer contacts than these need no sweeps of Gauss-Seidel before the first start. Shapes cost
/// more per sweep.
constexpr int kManyContacts = 16, kManyShapes = 40;
/// Sweeps from each start, there and back. Two leave a tenth more problems of 100 contacts to other
/// starts; ten take as long as the iterations that they save.
constexpr int kSweeps = 4;
/// All normal impulses of the first starts before these sweeps. An impulse of 1 gives its contact
/// the largest free velocity. Nine of ten problems of 100 random contacts are solved from the first
/// start, 36 of 37 from the three.
constexpr double kGiven[] = {0, 10, 100};
constexpr int kGivenStarts = int(std::size(kGiven)), kMostIterationsOfGiven = 400;
/// In later starts each contact has an impulse of its own, drawn between these, evenly in its
/// logarithm. Two starts in turn have similar impulses, two have not: a problem that is hard for
/// the one kind is often easy for the other.
constexpr double kLeastDrawn = 1, kMostDrawnSimilar = 100, kMostDrawn = 10000;
constexpr int kMostIterationsOfDrawn = 1000, kMostStarts = kGivenStarts + 200;
/// When the given starts fail, one in 1,200 iterations ends in a solution, whichever start it
/// belongs to, and a path costs as much as thousands. Shapes cost several times as much per
/// iteration, and hardly more per path. An iteration of more than a hundred contacts may cost the
/// square of their number more.
constexpr int kMostIterationsInAll = 20000, kMostIterationsOfShapes = 6000;
constexpr double kMeasuredContacts = 100;
/// Part of the iterations after which a point also counts as a solution if its residual is the
/// rounding of W r. Before, other starts often find one with smaller impulses.
constexpr double kPartForUnrounded = 1;

/// The last start is the solution with linearised friction.
constexpr int kVertices = 32, kAttemptsOfFacets = 8;

bool has_shapes(const ContactLcp& problem) {
  return problem.friction_rule == FrictionRule::limit_surface;
}

bool is_many(const ContactLcp& problem) {
  return problem.contacts() >= (has_shapes(problem) ? kManyShapes : kManyContacts);
}

int most_iterations_in_all(const ContactLcp& problem) {
  const double larger = std::max(1., problem.contacts() / kMeasuredContacts);
  return int((has_shapes(problem) ? kMostIterationsOfShapes : kMostIterationsInAll) /
             (larger * larger));
}

/// The normal impulse of a contact at one of the starts, the same in every run.
double normal_impulse(int start, int contact) {
  if (start < kGivenStarts) return kGiven[start];
  const int number = start - kGivenStarts;
  const double most = number / 2 % 2 == 0 ? kMostDrawnSimilar : kMostDrawn;
  return kLeastDrawn *
         std::pow(most / kLeastDrawn, hash_to_unit(std::uint64_t(number), std::uint64_t(contact)));
}

/// Whether each wrench of these impulses lies within its contact's friction limit. Facets of the
/// ball do not know the shapes.
bool is_within_limits(const ContactLcp& problem, const Eigen::VectorXd& impulse) {
  constexpr double kRoundOff = 1e-9;
  for (int i = 0; i < problem.contacts(); ++i) {
    const double limit = problem.friction_coefficient[i] * impulse[4 * i];
    const double arm_m = problem.eccentricity_m[i];
    Eigen::Vector3d wrench = impulse.segment<3>(4 * i + 1);
    if (arm_m > 0) wrench.z() /= arm_m;
    const FrictionShape* shape =
        has_shapes(problem) && arm_m > 0 ? problem.shapes[std::size_t(i)] : nullptr;
    if (friction_gauge(shape, wrench) > limit + kRoundOff * impulse.lpNorm<Eigen::Infinity>())
      return false;
  }
  return true;
}

}  // namespace

ExactSolver::ExactSolver(int contact_capacity)
    : contact_capacity_(contact_capacity),
      contacts_(contact_capacity),
      search_(contacts_, contact_capacity) {}

LcpResult ExactSolver::solve(const ContactLcp& problem, const ContactStart& start,
                             ContactSolution& solution) {
  LcpResult result;
  const Task cold{problem, solution, result};
  const Task warm{problem, solution, result, kMostRoundingKept};
  contacts_.set(problem, 0);
  search_.begin_problem();
  best().forget();
  has_least_impulse_ = false;
  if (contacts_.separates()) {
    solution.velocity = problem.free_velocity;
    result.status = LcpStatus::solved;
    result.solved_by = SolvedBy::separating;
    result.residual = search_.complete(cold);
    return result;
  }
  const bool is_continued = start.impulse && continue_from(warm, start);
  if (!is_continued) start_cold(cold);
  if (cold.is_solved()) {
    result.status = LcpStatus::solved;
    result.proof = RayProof::none;
    if (!has_least_impulse_) search_.take_least_impulse(is_continued ? warm : cold);
  } else {
    result.solved_by = SolvedBy::none;
    if (result.proof != RayProof::none) {
      result.status = LcpStatus::infeasible_or_ray;
      result.residual = std::numeric_limits<double>::infinity();
    }
  }
  return result;
}

/// Returns whether the given impulses lead to the solution.
bool ExactSolver::continue_from(const Task& task, const ContactStart& start) {
  go_to(task.problem, *start.impulse);
  search_.keep_if_better(task);
  task.result.solved_by = SolvedBy::still;
  has_least_impulse_ = best().is_good;
  bool is_solved = has_least_impulse_;
  if (!is_solved && start.is_next_step) {
    const ImpulseSearch::Corrected corrected = search_.correct(task);
    has_least_impulse_ = corrected.is_still;
    is_solved = corrected.is_good;
  } else if (!is_solved) {
    search_.forget_still();
  }
  if (!is_solved) {
    task.result.solved_by = SolvedBy::warm;
    search_.polish(task, kFromNear);
    search_.restore_best(task);
    is_solved = best().is_good;
  }
  if (!is_solved) {
    search_.approach(task, kMostIterationsOfWarm, kFromNear);
    search_.restore_best(task);
    is_solved = best().residual <= kSolved;
  }
  task.result.residual = best().residual;
  return is_solved;
}

void ExactSolver::start_cold(const Task& task) {
  best().forget();
  LcpResult& result = task.result;
  if (find_from_nothing(task)) {
    result.solved_by = SolvedBy::first_start;
  } else if (proves_infeasible(task)) {
    result.proof = RayProof::infeasible;
    result.residual = best().residual;
    return;
  } else {
    result.solved_by = find_from_drawn(task) ? SolvedBy::drawn_start : SolvedBy::facets;
    if (result.solved_by == SolvedBy::facets) find_from_facets(task);
  }
  result.residual = search_.restore_best(task);
}

bool ExactSolver::find_from_nothing(const Task& task) {
  search_.start_from([](int) { return 0.; }, is_many(task.problem) ? kSweeps : 0);
  // Newton's method alone solves a contact in a step or two.
  if (task.problem.contacts() == 1) search_.polish(task, kUsual);
  if (best().is_good) return true;
  search_.approach(task, kMostIterationsOfGiven, kUsual);
  return best().is_solved(false);
}

/// Without friction infeasible means infeasible with any friction.
bool ExactSolver::proves_infeasible(const Task& task) { return facets().proves_infeasible(task); }

bool ExactSolver::find_from_drawn(const Task& task) {
  const int most = most_iterations_in_all(task.problem);
  const int before = task.result.newton_iterations;
  for (int start = 1, iterations = 0; start < kMostStarts && iterations < most; ++start) {
    const bool is_drawn = start >= kGivenStarts;
    search_.start_from([start](int contact) { return normal_impulse(start, contact); }, kSweeps);
    search_.approach(task, is_drawn ? kMostIterationsOfDrawn : kMostIterationsOfGiven, kUsual);
    iterations = task.result.newton_iterations - before;
    if (best().is_solved(is_drawn && iterations >= kPartForUnrounded * most)) return true;
  }
  return false;
}

/// The solution with linearised friction is close to that with exact friction, if there is one.
bool ExactSolver::find_from_facets(const Task& task) {
  if (vertices_.cols() == 0) vertices_ = LinearisedFriction(kVertices).columns(1);
  of_facets_.resize(task.problem.contacts());
  const LcpResult found = facets().solve(task.problem, vertices_, of_facets_, kAttemptsOfFacets);
  task.result.pivots += found.pivots;
  task.result.attempts += found.attempts;
  if (found.proof != RayProof::none && is_within_limits(task.problem, of_facets_.ray)) {
    task.result.proof = found.proof;
    task.solution.ray = of_facets_.ray;
  }
  if (!std::isfinite(found.residual)) return false;
  go_to(task.problem, of_facets_.impulse);
  search_.polish(task, kPatient);
  if (best().is_solved(false)) return true;
  go_to(task.problem, of_facets_.impulse);
  search_.approach(task, kMostIterationsOfGiven, kPatient);
  return best().is_solved(true);
}

FacetSolver& ExactSolver::facets() {
  if (!facets_) facets_ = std::make_unique<FacetSolver>(contact_capacity_, kVertices);
  return *facets_;
}

/// The search goes to impulses in the problem's units.
void ExactSolver::go_to(const ContactLcp& problem, const Eigen::VectorXd& impulse) {
  Eigen::VectorXd& own = search_.impulse();
  for (int i = 0; i < problem.contacts(); ++i) {
    own.segment<4>(4 * i).setZero();
    for (int row = 0; row < (contacts_.has_friction(i) ? 4 : 1); ++row) {
      const double scale = contacts_.impulse_scale()[4 * i + row];
      if (scale > 0) own[4 * i + row] = impulse[4 * i + row] / (contacts_.velocity_unit() * scale);
    }
  }
}

}  // namespace softfinger::internal
