#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/dynamics/contacts/contact_operator.h"
#include "softfinger/dynamics/exact/contact_rows.h"

/// Internal: which of all impulses with the same effect a redundant problem gets.
namespace softfinger::internal {

/// The impulses of least norm, in the scaled problem, among those that make the same velocities:
///   min |r|²/2,   S W S (r - r*) = 0,   r in C,   S = diag(impulse scale).
/// C holds what each contact does at the solution r*: one that opens has no impulse, one that
/// slides only its normal impulse with the friction that belongs to it, one that sticks all
/// impulses within its cone. C is convex, so that the answer is unique: it depends neither on the
/// order of the contacts nor on r*, but on the velocities alone.
///
/// Solved by its dual: with S W S = L L^T (Cholesky's method with pivoting, rank k) r = proj_C(L
/// y), where L^T proj_C(L y) = L^T r*. These are k equations, the gradient of a convex function:
/// semi-smooth Newton's method with halved steps. Without bounds that are met one step is enough.
/// Cost: contacts k² at most, less where L has zeros. No allocation.
class LeastImpulse {
 public:
  explicit LeastImpulse(int contact_capacity);

  /// @param velocity  of the solution, scaled, 4 per contact
  /// @param impulse   scaled; replaced where the answer is found
  /// @param none      velocities below this part of their natural size are none
  /// @param accuracy  of L^T r, over the largest one; the last digits cost steps
  /// @returns whether it is
  bool find(const ContactLcp& problem, const ContactOperator& contacts,
            const Eigen::VectorXd& velocity, Eigen::VectorXd& impulse, double none = 1e-9,
            double accuracy = 1e-14);

  /// Follows bodies at rest: for a problem that differs little from the last one of `find`, contact
  /// by contact the same, in which nothing slides or opens and no bound is met. Changes the least
  /// impulse so that it makes the touching contacts' velocities zero again; it stays the least one.
  /// @param impulse  scaled; of any use only where this returns true
  bool follow(const ContactOperator& contacts, Eigen::VectorXd& impulse);
  void forget() { followed_ = -1; }

 private:
  enum class Mode { open, normal, slides, sticks };

  struct Touching {
    int contact;
    Mode mode;
    Eigen::Vector3d friction;    ///< of one that slides, per normal impulse
    Eigen::Vector4d along;       ///< S times the direction, or each of the four
    int row, rows;               ///< of L
    Eigen::Matrix4d derivative;  ///< of the projection
    bool is_free = true;         ///< the projection changes nothing
  };

  void read_velocity(const ContactOperator& contacts, const Eigen::VectorXd& impulse);
  bool is_within_bounds(const ContactOperator& contacts, const Eigen::VectorXd& impulse) const;
  bool classify(const ContactOperator& contacts, const Eigen::VectorXd& velocity, double none);
  Eigen::Vector4d shared_elements(const ContactLcp& problem, const Touching& one,
                                  const Touching& other, int row) const;
  void factorise(const ContactLcp& problem, const ContactOperator& contacts);
  void eliminate(const ContactLcp& problem, const ContactOperator& contacts, int pivot);
  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
  void multiply_transposed(const Eigen::VectorXd& y, Eigen::VectorXd& x) const;
  void project(bool as_if_free);
  double gradient();
  bool step();

  std::vector<Touching> touching_;
  std::vector<int> number_;  ///< of each contact among those that touch; -1: it does not
  std::vector<int> owner_;   ///< of each row
  std::vector<int> order_;   ///< in which they give their pivots
  int rows_ = 0, rank_ = 0;
  int followed_ = -1;       ///< contacts of the problem that `follow` knows; -1: none
  ContactRows factor_;      ///< L, of the contacts that touch
  Eigen::MatrixXd matrix_;  ///< L whole while it is found, then of Newton's last step of y
  Eigen::VectorXd original_, diagonal_, dual_, wanted_, gradient_, step_, target_, projected_,
      right_, velocity_;
};

}  // namespace softfinger::internal
