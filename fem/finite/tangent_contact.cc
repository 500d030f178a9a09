#include "fem/finite/tangent_contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {

using Eigen::Index;

TangentContact solve_tangent_contact(const SurfaceResponse& response, const Eigen::VectorXd& gap,
                                     double load, double approach, const Eigen::VectorXd& start) {
  const Index count = gap.size();
  const Eigen::MatrixXd& stiffness = response.stiffness;
  std::vector<char> active(static_cast<std::size_t>(count), 0);
  // Without a start, from a generous contact: the set then shrinks, mostly monotonically.
  std::vector<Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return gap[i] < gap[j]; });
  if (start.maxCoeff() > 0)
    for (Index i = 0; i < count; ++i) active[static_cast<std::size_t>(i)] = start[i] > 0;
  else
    for (std::size_t i = 0; i < (order.size() + 1) / 2; ++i)
      active[static_cast<std::size_t>(order[i])] = 1;

  TangentContact contact;
  std::size_t fewest_changes = order.size() + 1;
  int since_improvement = 0;
  constexpr int limit = 200;
  for (int iteration = 1; iteration <= limit; ++iteration) {
    std::vector<Index> touching, free;
    for (Index i = 0; i < count; ++i)
      (active[static_cast<std::size_t>(i)] ? touching : free).push_back(i);
    const auto touching_count = static_cast<Index>(touching.size());
    // Displacements and forces per approach (first column) and at approach 0 (second).
    Eigen::MatrixXd prescribed(touching_count, 2);
    prescribed << Eigen::VectorXd::Ones(touching_count), -gap(touching);
    Eigen::MatrixXd released(static_cast<Index>(free.size()), 2);
    Eigen::MatrixXd forces = stiffness(touching, touching) * prescribed;
    if (!free.empty()) {
      Eigen::MatrixXd right = -(stiffness(free, touching) * prescribed);
      right.col(1) += response.force(free);
      released = stiffness(free, free).partialPivLu().solve(right);
      forces += stiffness(touching, free) * released;
    }
    forces.col(1) -= response.force(touching);
    if (load > 0) approach = (load - forces.col(1).sum()) / forces.col(0).sum();
    const Eigen::Vector2d scale(approach, 1);
    contact.approach = approach;
    contact.force = contact.displacement = Eigen::VectorXd::Zero(count);
    contact.force(touching) = forces * scale;
    contact.displacement(touching) = prescribed * scale;
    if (!free.empty()) contact.displacement(free) = released * scale;
    contact.active = static_cast<int>(touching.size());
    const Eigen::VectorXd clearance = (contact.displacement + gap).array() - approach;

    // Round-off decides neither way: such nodes stay where they are.
    const double force_floor = 1e-12 * contact.force.cwiseAbs().maxCoeff();
    const double clearance_floor = 1e-12 * (std::abs(approach) + gap.cwiseAbs().minCoeff());
    std::size_t changes = 0;
    Index worst = -1;
    double worst_violation = 0;
    std::vector<char> is_wrong(static_cast<std::size_t>(count), 0);
    for (Index i = 0; i < count; ++i) {
      const bool is_active = active[static_cast<std::size_t>(i)] != 0;
      const double violation =
          is_active ? -contact.force[i] / force_floor : -clearance[i] / clearance_floor;
      if (!(violation > 1)) continue;
      is_wrong[static_cast<std::size_t>(i)] = 1;
      ++changes;
      if (violation > worst_violation) {
        worst_violation = violation;
        worst = i;
      }
    }
    if (changes == 0) {
      contact.force = contact.force.cwiseMax(0.0);
      return contact;
    }
    // All at once while that makes progress; when it stalls, one at a time.
    if (changes < fewest_changes) {
      fewest_changes = changes;
      since_improvement = 0;
    } else {
      ++since_improvement;
    }
    for (Index i = 0; i < count; ++i)
      if (is_wrong[static_cast<std::size_t>(i)] && (since_improvement <= 8 || i == worst))
        active[static_cast<std::size_t>(i)] = !active[static_cast<std::size_t>(i)];
    if (std::none_of(active.begin(), active.end(), [](char value) { return value; }))
      active[static_cast<std::size_t>(order.front())] = 1;
  }
  throw ConvergenceError("active set of the contact", limit, static_cast<double>(fewest_changes),
                         "the contact keeps changing by this many nodes");
}

}  // namespace softfinger::fem::finite
