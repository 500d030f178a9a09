#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/dynamics/contacts/contact_operator.h"
#include "softfinger/dynamics/exact/dense_elimination.h"
#include "softfinger/dynamics/exact/pattern_elimination.h"
#include "softfinger/dynamics/exact/proximal_course.h"
#include "softfinger/dynamics/exact/velocity_factor.h"

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
///
/// If the contacts that touch have more unknowns than the bodies velocities, or at least half as
/// many for a proximal point, the step is solved for these: with
/// W = C L L^T and dF_i = B_i (W dr)_i + A_i dr_i = -F_i, y = L^T dr follows from
///   (1 + sum L_i^T A_i^-1 B_i C_i L_i) y = -sum L_i^T A_i^-1 F_i.
class ExactNewton {
 public:
  explicit ExactNewton(int contact_capacity);

  static constexpr int kMostPasses = 8;

  /// Improves `impulse`; returns the largest |F| without unit (velocities over the largest of the
  /// free ones). Up to `passes` attempts from the same point. No allocation.
  /// @param patience  iterations within which |F| has to be halved
  double solve(const ContactOperator& contacts, Eigen::VectorXd& impulse, int passes, int patience);

  /// Improves `impulse` from far away, by proximal points (Rockafellar, SIAM J. Control Optim. 14,
  /// 1976). The contacts give way, u = W r + v_free + c A (r - r0), around the last point r0: no
  /// other impulse is as good as one close to it, however redundant the contacts are. Full steps of
  /// Newton's method find the next r0. Where they succeed, c is halved, else it grows tenfold.
  /// Points that follow each other on a line make the next r0 lie ahead.
  /// Not monotone, so that |F| may rise: the best point is kept. Returns its |F|. No allocation.
  /// @param start  near: c begins smaller
  double approach(const ContactOperator& contacts, Eigen::VectorXd& impulse, int most_iterations,
                  ProximalCourse::Start start = ProximalCourse::Start::far);

  int iterations() const { return iterations_; }  ///< of the last solve or approach

  /// Improves `impulse` by the matrix of the last step of `solve`, for a problem that differs
  /// little from that one: contact by contact the same, of which the same ones touch. Costs the
  /// square of the unknowns instead of their cube. True when the result is as good as that of
  /// `solve`: to round-off, or below kGood where nothing slides, because such a problem is linear.
  bool correct(const ContactOperator& contacts, Eigen::VectorXd& impulse);

  /// To be called before the first `solve` of a problem.
  void begin_problem() { factor_.forget(); }

 private:
  struct Contact {
    bool touches = false;  ///< P may be positive
    bool slides = false;   ///< nu is not zero
    /// Known for a contact that slides; else those of before.
    Eigen::Matrix<double, 3, 4> boundary_and_hessian = Eigen::Matrix<double, 3, 4>::Zero();
    Eigen::Matrix3d sticking;       ///< B_i of friction
    Eigen::Matrix4d own_inverse;    ///< A_i^-1 of the step in few unknowns
    Eigen::Matrix4d from_velocity;  ///< B_i C_i
    Eigen::Matrix4d stiffness;      ///< A_i^-1 B_i C_i

    auto boundary() const { return boundary_and_hessian.col(0); }         ///< grad h(nu)
    auto hessian() const { return boundary_and_hessian.rightCols<3>(); }  ///< of h at nu
  };

  /// Form in which the matrix of the last Newton step was factorised.
  enum class Decomposition { none, of_impulses, of_velocities, of_velocities_exchanged };

  struct Pass {
    double proximal;  ///< this part of W's diagonal is added to W, which may be singular
    bool full_steps;  ///< else they are halved until |F| decreases
  };

  /// L of this problem.
  const VelocityFactor& factor(const ContactOperator& contacts);
  double descend(const ContactOperator& contacts, const Pass& pass, double best,
                 Eigen::VectorXd& impulse);
  double evaluate(const ContactOperator& contacts, const Eigen::VectorXd& impulse);
  double find_map(const ContactOperator& contacts, const Eigen::VectorXd& impulse);
  double find_own_map(const ContactOperator& contacts, const Eigen::VectorXd& impulse, int i);
  bool find_step(const ContactOperator& contacts, const Eigen::VectorXd& impulse, double proximal);
  int number_unknowns(const ContactOperator& contacts, const Eigen::VectorXd& impulse);
  void assemble_rows(const ContactOperator& contacts, int i, const Eigen::VectorXd& impulse,
                     double proximal, DenseElimination::Matrix& matrix);
  Decomposition factorise(const ContactOperator& contacts, const Eigen::VectorXd& impulse,
                          double proximal, int size);
  Decomposition factorise_reduced(const ContactOperator& contacts, const Eigen::VectorXd& impulse,
                                  double proximal, int size);
  void find_inverse(const ContactOperator& contacts, int i, double pressure, double proximal);
  void assemble_reduced(Eigen::Ref<Eigen::MatrixXd> matrix) const;
  bool take_steps(const ContactOperator& contacts, ProximalCourse& course);
  double move_on(int size);
  Eigen::Matrix3d sliding_part(const Contact& contact, const Eigen::Vector3d& metric,
                               double pressure) const;
  void substitute_all(const ContactOperator& contacts);

  std::vector<Contact> contacts_;
  std::vector<int> first_;  ///< of each contact's unknowns; -1: it has none
  VelocityFactor factor_;
  Eigen::VectorXd velocity_, map_, trial_, step_, right_, start_, point_, common_;
  Eigen::VectorXd centre_;          ///< r0
  Eigen::VectorXd reached_, move_;  ///< the last proximal point, and how it differs from before
  double compliance_ = 0;           ///< c
  DenseElimination elimination_;
  PatternElimination pattern_elimination_;
  Decomposition decomposition_ = Decomposition::none;
  int factored_contacts_ = 0;
  int iterations_ = 0, patience_ = 0;
};

}  // namespace softfinger::internal
