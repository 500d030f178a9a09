#include "fem/finite/tangent_contact.h"

#include <cmath>
#include <utility>

#include "fem/contact/active_set.h"

namespace softfinger::fem::finite {

using Eigen::Index;

namespace {

void factorise(const Eigen::MatrixXd& stiffness, const ActiveSet& set, ReleasedFactor& kept) {
  std::vector<Index> touching = set.touching();
  if (touching == kept.touching) return;
  kept.touching = std::move(touching);
  kept.free = set.free();
  kept.of_touching = stiffness(kept.touching, kept.touching);
  kept.free_by_touching = stiffness(kept.free, kept.touching);
  const Eigen::MatrixXd of_free = stiffness(kept.free, kept.free);
  if (of_free.size() > 0) kept.factor.compute(of_free);
}

}  // namespace

TangentContact solve_tangent_contact(const SurfaceResponse& response, const Eigen::VectorXd& cosine,
                                     const Eigen::VectorXd& gap, double load, double approach,
                                     const Eigen::VectorXd& start, ReleasedFactor* kept) {
  const Index count = gap.size();
  ReleasedFactor own;
  ReleasedFactor& factor = kept ? *kept : own;
  TangentContact contact;
  ActiveSet set(gap, &start);
  for (int step = 0; step < ActiveSet::most_steps; ++step) {
    factorise(response.stiffness, set, factor);
    const std::vector<Index>&touching = factor.touching, &free = factor.free;
    const auto touching_count = static_cast<Index>(touching.size());
    // Displacements and forces per approach (first column) and at approach 0 (second).
    Eigen::MatrixXd prescribed(touching_count, 2);
    prescribed << cosine(touching), -gap(touching).cwiseProduct(cosine(touching));
    Eigen::MatrixXd released(static_cast<Index>(free.size()), 2);
    Eigen::MatrixXd forces = factor.of_touching * prescribed;
    if (!free.empty()) {
      Eigen::MatrixXd right = -(factor.free_by_touching * prescribed);
      right.col(1) += response.force(free);
      released = factor.factor.solve(right);
      forces += factor.free_by_touching.transpose() * released;
    }
    forces.col(1) -= response.force(touching);
    if (load > 0) {
      const Eigen::Vector2d along_load = forces.transpose() * cosine(touching);
      approach = (load - along_load[1]) / along_load[0];
    }
    const Eigen::Vector2d scale(approach, 1);
    contact.approach = approach;
    contact.force = contact.displacement = Eigen::VectorXd::Zero(count);
    contact.force(touching) = forces * scale;
    contact.displacement(touching) = prescribed * scale;
    if (!free.empty()) contact.displacement(free) = released * scale;
    contact.active = static_cast<int>(touching.size());
    const Eigen::VectorXd clearance =
        (contact.displacement.cwiseQuotient(cosine) + gap).array() - approach;
    // The scale of the clearances contains the smallest gap, not the largest. A node beside the
    // object has a gap of 1e3, whose round-off is far larger than that of the other nodes.
    if (!set.improve(contact.force, clearance, contact.force.cwiseAbs().maxCoeff(),
                     std::abs(approach) + gap.cwiseAbs().minCoeff()))
      continue;
    contact.force = contact.force.cwiseMax(0.0);
    return contact;
  }
  set.give_up();
}

}  // namespace softfinger::fem::finite
