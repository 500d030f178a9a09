#pragma once

#include <Eigen/Core>

#include "fem/contact/normal_contact.h"
#include "fem/problem/pressed_in_time.h"

/// Contacts of rubber that relaxes, step by step, with internal variables.
namespace softfinger::fem {

/// A contact at the time of the answer.
struct ContactInTime {
  NormalContact contact;
  NormalContact largest;  ///< of the way there: with the most nodes
};

/// Follows a contact over the whole history, which may rise and fall as often as it likes.
///
/// A generalised Maxwell solid whose displacements are w carries f = K (w - sum_i g_i w_i), with
/// internal variables w_i' = (w - w_i)/tau_i on each node. w is taken for linear within a step, for
/// which w_i is exact (R. L. Taylor, K. S. Pister, G. L. Goudreau, Int. J. Numer. Methods Eng. 2,
/// 1970): second order. What is left is an elastic contact with a softer compliance and a gap that
/// the internal variables widen.
/// @param compliance  of the instantaneous modulus; see solve_normal_contact
/// @param gap         the smallest one is 0
/// @param by_approach what the history's values are: approaches, else loads on these nodes
/// @param fineness    steps per relaxation time and per segment of the history, about
/// @throws ConvergenceError
ContactInTime follow_contact(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                             const PressedInTime& pressed, bool by_approach, int fineness);

}  // namespace softfinger::fem
