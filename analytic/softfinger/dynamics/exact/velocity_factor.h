#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "softfinger/dynamics/contacts/contact_operator.h"
#include "softfinger/dynamics/exact/contact_rows.h"
#include "softfinger/dynamics/exact/elimination_pattern.h"

/// Internal: the velocities that contacts have in common.
namespace softfinger::internal {

/// W = C L L^T. C is diagonal, because the scaled problem has other units for the velocities of
/// friction than for its impulses. L is the root that the problem gives, if it does: six columns
/// per body, however many contacts they have.
///
/// Else it is found by Cholesky's method, with as few columns as W's rank, and more per contact.
/// The next pivots are always those of a contact with the fewest neighbours left: once the
/// contacts of a body with the world have taken its velocities, those with another body have only
/// this one's left. So L stays as sparse as the bodies are coupled. What W has beyond L is at most
/// 1e-12 of its diagonal.
///
/// Rows of friction that do nothing are left out of it.
class VelocityFactor {
 public:
  explicit VelocityFactor(int contact_capacity);

  /// Cost: rank times the square of the rows that feel each other. No allocation.
  void factorise(const ContactOperator& contacts);
  /// The decomposition of the last problem is no longer valid.
  void forget() { is_known_ = false; }
  bool is_known() const { return is_known_; }

  int rank() const { return rank_; }
  /// C of the contact's rows.
  Eigen::Map<const Eigen::Vector4d> unit(int contact) const {
    return Eigen::Map<const Eigen::Vector4d>(units_.data() + 4 * contact);
  }
  /// L, four rows of each contact.
  const ContactRows& rows() const { return rows_; }
  /// The pattern of sums of L_i^T A_i L_i.
  const EliminationPattern& pattern() const { return elimination_; }

 private:
  void take_root(const ContactOperator& contacts);
  void decompose(const ContactOperator& contacts);
  int largest_pivot(int contact, double least) const;
  int next_contact(int contacts, double least);
  int count_left(int pivot) const;
  void eliminate(int pivot);
  void order_columns(int contacts);

  bool is_known_ = false;
  int rank_ = 0, size_ = 0;
  Eigen::VectorXd units_;
  Eigen::VectorXd original_;  ///< W's diagonal
  Eigen::VectorXd left_;      ///< the same; infinite where a row is eliminated
  ContactRows rows_;
  EliminationPattern elimination_;
  std::vector<int> pattern_;
  std::vector<int> neighbours_;  ///< rows that the next pivot of each contact meets
  Eigen::MatrixXd rest_;         ///< L; before, in columns left, the Schur complement
  std::vector<int> pivots_;
  std::vector<char> eliminated_;
  std::vector<std::uint64_t> meet_;  ///< a bit for two columns with a contact in common
  std::vector<int> met_;             ///< how many columns left each column meets
  std::vector<int> order_;           ///< pivots in the order of their columns
};

}  // namespace softfinger::internal
