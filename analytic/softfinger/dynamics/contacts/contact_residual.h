#pragma once

#include "softfinger/dynamics/contacts/contact_lcp.h"

/// Internal: parts of the residuals that the solver shares with the public ones.
namespace softfinger::internal {

/// Residual below which a point counts as a solution.
constexpr double kSolved = 1e-10;
/// Residual below which nothing better is looked for: a few thousand roundings.
constexpr double kGood = 1e-12;
/// The largest residual that rounding may explain in a solution, and in a point that a warm start
/// keeps because a cold one would find none better.
constexpr double kMostRounding = 1e-9, kMostRoundingKept = 1e-8;

inline bool is_exact(const ContactLcp& problem) {
  return problem.friction_rule != FrictionRule::facets;
}

/// Number of roundings of W r that a residual may have.
constexpr double kRoundings = 4;

/// Eigen's allFinite, several numbers at a time.
template <class Matrix>
bool all_finite(const Matrix& matrix) {
  return (0 * matrix.array()).sum() == 0;
}

/// (v_t1, v_t2, e_n omega) of a contact.
inline Eigen::Vector3d scaled_slip(const ContactLcp& problem, const ContactSolution& solution,
                                   int contact) {
  const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[contact]);
  return arms.cwiseProduct(solution.velocity.segment<3>(4 * contact + 1));
}

/// velocity += W impulse, of all rows.
void add_response(const ContactLcp& problem, const Eigen::VectorXd& impulse,
                  Eigen::VectorXd& velocity);

/// `contact_residual` of a solution whose impulses and velocities are known to belong to its
/// weights.
/// @param vertices     that the weights refer to
/// @param least_along  the least D_j^T v_t of all vertices, per contact; 0 where there are none
double residual_of(const ContactLcp& problem, const Eigen::Matrix3Xd& vertices,
                   const ContactSolution& solution, const Eigen::VectorXd& least_along);

/// `exact_contact_residual` of a solution whose velocities are known to be those of `add_response`.
double exact_residual_of(const ContactLcp& problem, const ContactSolution& solution);

/// Part of the residual that rounding of W r alone explains, at most `most`. Where bodies are
/// wedged by impulses a million times larger than their motion needs, no other impulses would do
/// better.
double rounding_of(const ContactLcp& problem, const ContactSolution& solution,
                   double most = kMostRounding);

}  // namespace softfinger::internal
