#include "softfinger/dynamics/lane_search.h"

#include "softfinger/dynamics/impulse_start.h"

namespace softfinger::internal {
namespace {

/// From a point that is close in lanes, of which L L^T has the last digits otherwise than W.
constexpr int kMostIterationsAlone = 60;

}  // namespace

LaneSearch::LaneSearch(const ContactOperator& contacts, int contact_capacity)
    : search_(contacts, contact_capacity) {}

void LaneSearch::begin_problem(const VelocityFactor& factor, int first, int between) {
  search_.begin_problem();
  search_.best().forget();
  lanes_.begin_problem(search_.contacts(), factor);
  solution_.resize(search_.contacts().contacts());
  for (Start& start : starts_) start.is_known = false;
  next_ = first;
  between_ = between;
}

bool LaneSearch::advance(const ContactLcp& problem, ImpulseSearch::Effort effort,
                         bool may_be_rounded) {
  const Task task{problem, solution_, result_};
  for (int lane = 0; lane < ProximalLanes::kLanes; ++lane) {
    if (lanes_.is_running(lane)) continue;
    const bool is_eased = end(lane, task, effort);
    if (search_.best().is_solved(may_be_rounded)) return true;
    if (is_eased)
      lanes_.start(lane, search_.impulse(), ImpulseSearch::kMostIterationsOfEased);
    else
      start_next(lane);
  }
  lanes_.advance();
  return false;
}

/// Whether the search is at least impulses to go on from.
bool LaneSearch::end(int lane, const Task& task, ImpulseSearch::Effort effort) {
  Start& start = starts_[lane];
  if (!start.is_known) return false;
  lanes_.read_best(lane, search_.impulse());
  const bool is_close = lanes_.best(lane) <= ImpulseSearch::kClose;
  const bool may_ease = search_.come_close(task, is_close ? kMostIterationsAlone : 0, effort);
  if (start.eased == 0) {
    if (!may_ease) return false;
    start.wedged = search_.impulse();
  }
  while (start.eased < effort.eased_starts)
    if (search_.go_to_eased(task, start.wedged, start.eased++)) return true;
  return false;
}

void LaneSearch::start_next(int lane) {
  go_to_start(next_, search_);
  lanes_.start(lane, search_.impulse(), most_iterations(next_));
  starts_[lane].is_known = true;
  starts_[lane].eased = 0;
  next_ += between_;
}

}  // namespace softfinger::internal
