#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/dynamics/contact_operator.h"
#include "softfinger/friction/friction_shape.h"

/// Internal: contact impulses with exact friction, from a point close to them.
namespace softfinger::internal {

/// Semi-smooth Newton's method (Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991) on the
/// natural map F of the scaled problem, all quantities without unit. The friction s lies in P K: a
/// convex set K with the support function h, times the normal impulse P.
///   F_n = min(P, v_n),   F_t = u + nu,   nu + A P grad h(nu) = A s - u,   u = v_t,
/// where nu = 0 if A s - u lies in A P K: then the contact sticks. For A = 1, F_t is
/// s - proj_{P K}(s - u). A = diag(W_tt), so that a contact alone is solved in one step however
/// small its e_n. Impulses of redundant contacts are not unique. Each step is therefore a proximal
/// one: it does not change those parts of the impulses that have no effect on velocities.
class ExactNewton {
 public:
  explicit ExactNewton(int contact_capacity);

  static constexpr int kMostPasses = 8;

  /// Improves `impulse`; returns the largest |F| without unit (velocities over the largest of the
  /// free ones). Up to `passes` attempts from the same point. No allocation.
  /// @param patience  iterations within which |F| has to be halved
  double solve(const ContactOperator& contacts, Eigen::VectorXd& impulse, int passes, int patience);

  int iterations() const { return iterations_; }  ///< of the last solve

  /// Improves `impulse` by the matrix of the last step of `solve`, for a problem that differs
  /// little from that one: contact by contact the same, of which the same ones touch. Costs the
  /// square of the unknowns instead of their cube. True when the result is as good as that of
  /// `solve`: to round-off, or below kGood where nothing slides, because such a problem is linear.
  bool correct(const ContactOperator& contacts, Eigen::VectorXd& impulse);
  void forget_matrix() { factored_ = 0; }

 private:
  struct Contact {
    bool touches = false;                              ///< P may be positive
    Eigen::Vector3d metric = Eigen::Vector3d::Ones();  ///< A
    FrictionExcess excess;
  };

  struct Pass {
    double proximal;  ///< this part of W's diagonal is added to W, which may be singular
    bool full_steps;  ///< else they are halved until |F| decreases
  };

  double descend(const ContactOperator& contacts, const Pass& pass, double best,
                 Eigen::VectorXd& impulse);
  double evaluate(const ContactOperator& contacts, const Eigen::VectorXd& impulse);
  bool find_step(const ContactOperator& contacts, const Eigen::VectorXd& impulse, double proximal);
  int number_unknowns(const ContactOperator& contacts, const Eigen::VectorXd& impulse);
  void assemble_rows(const ContactOperator& contacts, int i, const Eigen::VectorXd& impulse,
                     double proximal, int size);
  bool eliminate(int size);
  void substitute(int size);

  std::vector<Contact> contacts_;
  std::vector<int> first_;  ///< of each contact's unknowns; -1: it has none
  Eigen::VectorXd velocity_, map_, trial_, step_, right_, start_, point_;
  Eigen::MatrixXd matrix_;
  std::vector<int> pivots_;  ///< rows that were exchanged
  int factored_ = 0;         ///< size of the decomposition in matrix_; 0: none
  int factored_contacts_ = 0;
  int iterations_ = 0, patience_ = 0;
};

}  // namespace softfinger::internal
