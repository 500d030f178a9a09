#include "fem/finite/tangent_contact.h"

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "fem/active_set.h"

namespace softfinger::fem::finite {

using Eigen::Index;

TangentContact solve_tangent_contact(const SurfaceResponse& response, const Eigen::VectorXd& gap,
                                     double load, double approach, const Eigen::VectorXd& start) {
  const Index count = gap.size();
  const Eigen::MatrixXd& stiffness = response.stiffness;
  TangentContact contact;
  ActiveSet set(gap, &start);
  for (int step = 0; step < ActiveSet::most_steps; ++step) {
    const std::vector<Index> touching = set.touching(), free = set.free();
    const auto touching_count = static_cast<Index>(touching.size());
    // Displacements and forces per approach (first column) and at approach 0 (second).
    Eigen::MatrixXd prescribed(touching_count, 2);
    prescribed << Eigen::VectorXd::Ones(touching_count), -gap(touching);
    Eigen::MatrixXd released(static_cast<Index>(free.size()), 2);
    Eigen::MatrixXd forces = stiffness(touching, touching) * prescribed;
    if (!free.empty()) {
      Eigen::MatrixXd right = -(stiffness(free, touching) * prescribed);
      right.col(1) += response.force(free);
      const Eigen::MatrixXd of_free = stiffness(free, free);
      released = of_free.partialPivLu().solve(right);
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
