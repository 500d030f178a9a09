#include "fem/levels/trial_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "fem/base/formatted.h"
#include "fem/levels/mesh_size.h"

namespace softfinger::fem {
namespace {

/// First guesses are kept to these semi-axes over h: to what a contact may have (check in
/// linear_contact.cc), with room for b to overshoot.
constexpr double smallest_guess = 1e-4, largest_guess_b = 60, largest_guess_a = 300;
/// Trial meshes at most. Most contacts take two or three.
constexpr int most_trials = 15;
/// Mesh and contact agree when they differ by less than this share.
constexpr double trial_agreement = 0.08;
/// The room of a trial mesh's patch around the contact that it is made for, as that share.
const double room_of_trial_patch = std::log(1.25);
/// After so many trials a mesh serves whose patch has room for the contact: the outline of a scan's
/// contact may jump by a node from one mesh to the next for ever. Twice as many as most need.
constexpr int most_strict_trials = 7;
/// Largest factor on the usual number of cells of a trial mesh that does not reach the load.
constexpr int finest_trial = 3;
/// After this trial the next mesh lies half-way to what was found: coarse cells may tell one size
/// on another's mesh in turn.
constexpr int whole_way = 3;
/// Least relative change of its size for which a mesh that did not reach the load gets no finer
/// cells yet.
constexpr double worth_another = 0.25;

void keep_guess_sensible(LayerDiscretisation& mesh) {
  // A straight finger's radius may be anything.
  const double largest_a = mesh.is_scan ? farthest_facet : largest_guess_a;
  const double b = std::clamp(mesh.b, smallest_guess, std::min(largest_guess_b, largest_a));
  fit_to(std::clamp(mesh.a, smallest_guess, largest_a), b, mesh);
}

class TrialMeshes {
 public:
  TrialMeshes(ContactPhysics& physics, const ContactTask& task)
      : physics_(physics), task_(task), mesh_(first_guess(task.pressing)) {
    mesh_.a = std::max(mesh_.a, mesh_.b);
    keep_guess_sensible(mesh_);
    if (task.problem.size_hint_m) take_hint(*task.problem.size_hint_m);
  }

  /// Presses until mesh and contact agree. @returns what stands in the way
  std::optional<Unsolved> press() {
    for (int trial = 1;; ++trial) {
      const std::optional<Obstacle> obstacle = press_mesh(trial);
      if (obstacle && std::holds_alternative<FoldedLayer>(*obstacle)) return unsolved_by(*obstacle);
      if (!obstacle && fits(trial)) return std::nullopt;
      if (obstacle) plan_beyond(std::get<NotReached>(*obstacle), trial);
      if (task_.stop()) throw Interrupted();
    }
  }

  const LayerDiscretisation& mesh() const { return mesh_; }
  int refinement() const { return refinement_; }

 private:
  /// A hint for which the layer has no room is not taken: it would refuse what may fit.
  void take_hint(const std::array<double, 2>& size_m) {
    LayerDiscretisation hinted = mesh_;
    hinted.a = size_m[0] / task_.pressing.thickness_m;
    hinted.b = size_m[1] / task_.pressing.thickness_m;
    keep_guess_sensible(hinted);
    choose_elements(hinted, 0);
    if (hinted.is_within_reach()) mesh_ = hinted;
  }

  std::optional<Obstacle> press_mesh(int trial) {
    choose_elements(mesh_, 0);
    mesh_.elements_per_semi_axis *= refinement_;
    check_reach(mesh_, task_.problem);
    tell_unknowns(formatted("mesh %d", trial), mesh_, physics_, task_);
    return physics_.press(mesh_, 0);
  }

  /// Plans the next mesh where the load was not reached. On a mesh that is made for the contact so
  /// far, and then on a finer one, Newton's method may get farther: coarse cells beside the contact
  /// collapse under large strain.
  /// @throws ConvergenceError where another mesh promises nothing
  void plan_beyond(const NotReached& last, int trial) {
    if (trial == most_trials || !(last.b > 0)) throw last.error;
    const double a = rounded(growth_at_rim * last.a), b = rounded(growth_at_rim * last.b);
    if (misfit(mesh_, a, b) < worth_another) {
      if (refinement_ == finest_trial) throw last.error;
      ++refinement_;
    }
    task_.progress(formatted("mesh %d: %s; once more on a mesh for a/h %.3g, b/h %.3g", trial,
                             last.error.what(), a, b));
    mesh_.a = a;
    mesh_.b = b;
  }

  /// Whether the mesh that is pressed suits the contact. If not, the next one is planned.
  bool fits(int trial) {
    const RoughSize found = physics_.size();
    const double difference = misfit(mesh_, found.a, found.b);
    task_.progress(formatted("mesh %d: a/h %.4g, b/h %.4g, d/h %.4g, unknowns %ld%s%s", trial,
                             found.a, found.b, found.approach, found.unknowns, found.effort.c_str(),
                             found.reaches_rim ? ", contact at the rim" : ""));
    const double close_enough = trial <= most_strict_trials ? trial_agreement : room_of_trial_patch;
    if (!found.reaches_rim && difference < close_enough) return true;
    if (trial == most_trials)
      throw ConvergenceError("size of the refined patch", most_trials, difference,
                             "the contact's size depends on the mesh; is the contact elliptic?");
    if (found.reaches_rim)
      fit_to(growth_at_rim * found.a, growth_at_rim * found.b, mesh_);
    else if (trial <= whole_way)
      fit_to(found.a, found.b, mesh_);
    else
      fit_to(std::sqrt(found.a * mesh_.a), std::sqrt(found.b * mesh_.b), mesh_);
    return false;
  }

  ContactPhysics& physics_;
  const ContactTask& task_;
  LayerDiscretisation mesh_;  ///< of the present trial, or the next one
  int refinement_ = 1;
};

/// The object turns about where coordinates begin. A hundredth of the contact beside its centre is
/// worth 1e-4 of the torque of a symmetric pressure, up to 3e-3 of one that ends at an edge.
std::optional<OffCentre> off_centre(const Trial& trial, const ContactTask& task) {
  constexpr double tolerated = 0.01;
  const FingertipShape& bent = task.pressing.bent;
  if (!task.problem.friction.any() || !bent.shape || !bent.centre.isZero(0) ||
      trial.contact.centre.norm() <= tolerated * trial.contact.block_b)
    return std::nullopt;
  const double h = task.pressing.thickness_m;
  return OffCentre{trial.contact.centre, {h * trial.mesh.a, h * trial.mesh.b}};
}

}  // namespace

Outcome<Trial, Unsolved> find_trial(ContactPhysics& physics, const ContactTask& task) {
  Trial trial;
  if (physics.shares_meshes()) {
    if (const auto obstacle = physics.press({}, task.problem.level - 1))
      return unsolved_by(*obstacle);
  } else {
    TrialMeshes meshes(physics, task);
    if (const auto unsolved = meshes.press()) return *unsolved;
    trial.mesh = meshes.mesh();
    trial.refinement = meshes.refinement();
  }
  Outcome<Measurement, Unmeasured> contact = physics.measure();
  if (!contact) throw contact.reason().error;
  trial.contact = *std::move(contact);
  trial.contact.result.level = 0;
  fit_to(trial.contact.block_a, trial.contact.block_b, trial.mesh);
  if (const auto beside = off_centre(trial, task)) return Unsolved(*beside);
  if (physics.shares_meshes())
    task.progress(formatted("meshes of an earlier contact, %.3g times as large",
                            trial.contact.result.oversize));
  return trial;
}

}  // namespace softfinger::fem
