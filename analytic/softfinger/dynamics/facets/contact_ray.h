#pragma once

#include <Eigen/Core>

#include "softfinger/dynamics/contacts/lcp_result.h"
#include "softfinger/dynamics/facets/contact_system.h"

/// Internal: proofs that a contact problem has no solution.
namespace softfinger::internal {

/// The statement proved by the direction of the last path, which ended in a ray. The direction is
/// checked as a vector, independently of the path: impulses y within the friction cones, W y = 0,
/// y^T v_free < 0.
/// @param ray  4 nc: y, where there is a proof
RayProof check_ray(const ContactSystem& system, const ContactLcp& problem, Eigen::VectorXd& ray);

}  // namespace softfinger::internal
