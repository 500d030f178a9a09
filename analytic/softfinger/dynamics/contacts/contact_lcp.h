#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "softfinger/friction/friction_shape.h"

namespace softfinger {

/// The bound of the friction wrench (f_x, f_y, tau/e_n) of a contact, in units of mu P.
enum class FrictionRule {
  facets,        ///< the convex hull of the given vertices, eq. 2
  ellipsoid,     ///< the friction ellipsoid, eq. 1: f² + tau²/e_n² <= (mu P)²
  limit_surface  ///< the shape given for each contact, e.g. its exact limit surface
};

/// All contacts of one time step as a linear complementarity problem in impulses (Ciocarlie,
/// Lackner, Allen, World Haptics 2007, eq. 2-5; Anitescu, Potra, Nonlinear Dynamics 14, 1997):
///
///   v = W r + v_free,   r_i = (P_i, D_i beta_i),   D_i = diag(1, 1, e_i) V
///   0 <= P_i      complementary to  v_n,i >= 0
///   0 <= beta_i   complementary to  D_i^T v_t,i + lambda_i e >= 0
///   0 <= lambda_i complementary to  mu_i P_i - e^T beta_i >= 0
///
/// Rows and impulses come in fours per contact: along the normal, along the two tangents, about the
/// normal. Impulses in N s and N m s, velocities in m/s and rad/s.
///
/// Under the exact rules the last two lines become the principle of maximum dissipation over a
/// convex set K_i, the unit ball or the contact's shape, with support function h_i, scaled wrench
/// s_i = (f, tau/e_i) and scaled slip u_i = (v_t1, v_t2, e_i omega):
///   s_i in mu_i P_i K_i,   and  s_i = -mu_i P_i grad h_i(u_i)  where u_i is not zero.
///
/// mu_i = 0 is a frictionless unilateral row, such as a joint's limit: its tangential rows of W may
/// be zero.
struct ContactLcp {
  Eigen::MatrixXd delassus;  ///< W = J M^-1 J^T, 4 nc x 4 nc, symmetric, positive semi-definite
  /// G with W = G G^T, 4 nc rows; without columns: not known. Of bodies G = J L^-T, where M = L
  /// L^T: a contact has the columns of the bodies that touch there. Steps of exact friction are
  /// then solved in these, and a cold start of many contacts takes a fifth less time. Residuals are
  /// those of W, so that with a G that does not belong to it at worst no solution is found.
  Eigen::SparseMatrix<double> root;
  Eigen::VectorXd free_velocity;         ///< 4 nc: without contact impulses
  Eigen::VectorXd friction_coefficient;  ///< nc, >= 0
  Eigen::VectorXd eccentricity_m;        ///< nc, >= 0: e_n of the friction ellipsoid, eq. 6
  /// V, 3 x u: points of the unit sphere (f_x, f_y, tau/e_n)/(mu P), eq. 2. See LinearisedFriction.
  /// Only used with FrictionRule::facets.
  Eigen::Matrix3Xd vertices;
  FrictionRule friction_rule = FrictionRule::facets;
  /// Only used with FrictionRule::limit_surface: nc shapes, not owned; null: the unit ball. The
  /// first tangent of the contact is the shape's x axis.
  std::vector<const FrictionShape*> shapes;

  int contacts() const { return int(friction_coefficient.size()); }
};

struct ContactSolution {
  Eigen::VectorXd impulse;   ///< r, 4 nc
  Eigen::VectorXd velocity;  ///< v = W r + v_free, 4 nc
  /// lambda, nc: how fast a sliding contact slides. Under the exact rules lambda = h(u); for the
  /// ellipsoid that is the speed sqrt(v_t1² + v_t2² + e_n² omega²).
  Eigen::VectorXd slip;
  struct Weight {
    int contact, vertex;
    double value;
  };
  std::vector<Weight> weights;  ///< of facets: the beta that are not zero, at most four per contact
  /// y, 4 nc, of a problem with a RayProof: impulses within the friction cones that move nothing,
  /// W y = 0, while the prescribed motion works against them, y^T v_free < 0. Any multiple of them
  /// could be added.
  Eigen::VectorXd ray;

  void resize(int contacts);
};

/// Residual of a solution with FrictionRule::facets: max |min(z, w)|, made dimensionless as
/// follows.
/// - rows of P and beta: z times its own diagonal element of W, and w, both over max |v_free|;
/// - rows of lambda: lambda over max |v_free|, and the rest of the cone over the largest impulse,
/// - four roundings of W r over max |v_free|, where that is more than 1e-3: then nothing is known.
/// Impulses and velocities are computed again from P and beta. Their difference to those in the
/// solution counts as an error, over the same units. Allocates.
double contact_residual(const ContactLcp& problem, const ContactSolution& solution);

/// Residual of a solution with one of the exact rules, without unit. It is the largest of
/// - |min(W_nn P, v_n)| over max |v_free|,
/// - |a s - proj(a s - u)| over max |v_free|: the projection is onto a mu P K, and a is the largest
///   diagonal element of W for s and u,
/// - how far s lies outside of mu P K, over the largest impulse,
/// - four roundings of W r over max |v_free|, where that is more than 1e-3: then nothing is known.
/// Computed from the impulses alone, velocities included. No allocation.
double exact_contact_residual(const ContactLcp& problem, const ContactSolution& solution);

}  // namespace softfinger
