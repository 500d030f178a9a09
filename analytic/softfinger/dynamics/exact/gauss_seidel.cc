#include "softfinger/dynamics/exact/gauss_seidel.h"

#include <algorithm>

#include "softfinger/friction/friction_shape.h"

namespace softfinger::internal {
namespace {

/// The impulse of a contact alone, from `own`, with which it has `velocity`.
Eigen::Vector4d solved_alone(const ContactOperator& contacts, int i, Eigen::Vector4d own,
                             Eigen::Vector4d velocity) {
  constexpr int kTurns = 2;  // of the normal impulse and friction: the neighbours change as well
  const auto matrix = contacts.delassus().block<4, 4>(4 * i, 4 * i);
  if (!contacts.has_friction(i))
    return Eigen::Vector4d(std::max(0., own[0] - velocity[0] / matrix(0, 0)), 0, 0, 0);
  const Eigen::Vector3d metric = contacts.friction_metric(i);
  for (int turn = 0; turn < kTurns; ++turn) {
    const double normal = std::max(0., own[0] - velocity[0] / matrix(0, 0));
    velocity += matrix.col(0) * (normal - own[0]);
    own[0] = normal;
    const Eigen::Vector3d target = metric.cwiseProduct(own.tail<3>()) - velocity.tail<3>();
    const FrictionExcess beyond = friction_excess(contacts.shape(i), target, normal, metric);
    const Eigen::Vector3d friction = (target - beyond.excess).cwiseQuotient(metric);
    velocity += matrix.rightCols<3>() * (friction - own.tail<3>());
    own.tail<3>() = friction;
  }
  return own;
}

}  // namespace

void sweep(const ContactOperator& contacts, int sweeps, Eigen::VectorXd& impulse,
           Eigen::VectorXd& velocity) {
  const int nc = contacts.contacts();
  contacts.find_velocity(impulse, velocity);
  velocity.head(4 * nc) += contacts.free_velocity().head(4 * nc);
  for (int number = 0; number < sweeps; ++number)
    for (int k = 0; k < nc; ++k) {
      const int i = number % 2 == 0 ? k : nc - 1 - k;
      const Eigen::Vector4d own = impulse.segment<4>(4 * i);
      const Eigen::Vector4d change =
          solved_alone(contacts, i, own, velocity.segment<4>(4 * i)) - own;
      if (change.isZero(0)) continue;
      impulse.segment<4>(4 * i) += change;
      for (const int j : contacts.neighbours(i))
        velocity.segment<4>(4 * j).noalias() +=
            contacts.delassus().block<4, 4>(4 * j, 4 * i) * change;
    }
}

}  // namespace softfinger::internal
