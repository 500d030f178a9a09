#include "softfinger/dynamics/facets/contact_ray.h"

#include <cmath>

namespace softfinger::internal {
namespace {

constexpr double kRoundOff = 1e-9;

/// Whether impulses within the cones move nothing, without z0.
bool is_ray(const Motion& ray, int contacts, double size) {
  if (std::abs(ray.z0) > kRoundOff * size ||
      ray.velocity.head(4 * contacts).lpNorm<Eigen::Infinity>() > kRoundOff * size)
    return false;
  for (int i = 0; i < contacts; ++i)
    if (ray.impulse[4 * i] < -kRoundOff * size || ray.slack[i] < -kRoundOff * size) return false;
  return true;
}

/// Whether the ray's work -y^T v_free is more than rounding.
///
/// A ray proves infeasibility only if W y = 0. Rounding leaves a rest, of contacts nearly repeated
/// on bodies of very different mass or in a narrow wedge, that huge impulses r could exploit:
/// (W y)^T r can make up for the work. The ray is accepted only if they would have to exceed 1e12
/// natural ones, those that stop a contact's body.
bool work_is_certain(const ContactOperator& contacts, const ContactLcp& problem,
                     const Eigen::VectorXd& ray) {
  constexpr double kLargestImpulse = 1e12;
  const double work = -ray.dot(problem.free_velocity);
  double work_of_natural_impulses = 0;
  for (int row = 0; row < int(ray.size()); ++row)
    work_of_natural_impulses +=
        std::abs(problem.delassus.row(row).dot(ray)) * contacts.impulse_scale()[row];
  if (!(work > kLargestImpulse * contacts.velocity_unit() * work_of_natural_impulses)) return false;
  // Over the whole ray: round-off in a few of its rows could look like work.
  const double natural_work =
      ray.lpNorm<Eigen::Infinity>() * problem.free_velocity.lpNorm<Eigen::Infinity>();
  return work > kRoundOff * natural_work;
}

}  // namespace

RayProof check_ray(const ContactSystem& system, const ContactLcp& problem, Eigen::VectorXd& ray) {
  const ContactOperator& contacts = system.contact_operator();
  const int nc = contacts.contacts(), n = 4 * nc;
  const Motion& direction = system.current_direction();
  const double size = direction.impulse.head(n).lpNorm<Eigen::Infinity>();
  if (!(size > 0) || !is_ray(direction, nc, size)) return RayProof::none;
  ray = contacts.impulse_scale().head(n).cwiseProduct(direction.impulse.head(n)) / size;
  if (!work_is_certain(contacts, problem, ray)) return RayProof::none;
  for (int i = 0; i < nc; ++i)
    if (direction.impulse.segment<3>(4 * i + 1).norm() > kRoundOff * size)
      return RayProof::ray_only;
  return RayProof::infeasible;
}

}  // namespace softfinger::internal
