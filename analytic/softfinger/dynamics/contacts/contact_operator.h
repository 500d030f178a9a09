#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/dynamics/contacts/contact_lcp.h"

/// Internal: the matrix of the contact problem.
namespace softfinger::internal {

/// W and v_free of a ContactLcp without units, and what friction needs to know of each contact.
///
/// Each contact is scaled by 1/sqrt(W_nn), and all velocities by the largest free one. Forces and
/// velocities of friction are those of the unit ball or shape: (f, tau/e_n)/mu, (v_t, e_n omega).
class ContactOperator {
 public:
  explicit ContactOperator(int contact_capacity);

  /// @param proximal  W's diagonal is multiplied by 1 + proximal
  void set(const ContactLcp& problem, double proximal);

  int contacts() const { return contacts_; }
  const Eigen::MatrixXd& delassus() const { return delassus_; }            ///< W
  const Eigen::VectorXd& free_velocity() const { return free_velocity_; }  ///< v_free
  /// ContactLcp::root as it was given, if it has fewer columns than W; null: none. There as long as
  /// the problem is.
  const Eigen::SparseMatrix<double>* given_root() const { return given_root_; }
  /// The contacts that this one feels, itself among them.
  struct Neighbours {
    const int *first, *last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
    std::ptrdiff_t size() const { return last - first; }
  };
  Neighbours neighbours(int contact) const {
    return {neighbours_.data() + contact * contacts_,
            neighbours_.data() + neighbour_end_[std::size_t(contact)]};
  }
  /// velocity = W impulse, by blocks of contacts that feel each other.
  void find_velocity(const Eigen::VectorXd& impulse, Eigen::VectorXd& velocity) const;

  /// Size that velocities and impulses of a contact have by nature. Where all contacts feel the
  /// same velocity, those of the heaviest bodies have 1 and those of lighter ones less.
  double natural_size(int contact) const { return natural_sizes_[contact]; }

  /// Whether friction can do anything: mu > 0, and the contact can slip.
  bool has_friction(int contact) const { return has_friction_[std::size_t(contact)]; }
  /// Whether all contacts open without impulses.
  bool separates() const;
  /// Takes friction out of the problem until `restore_friction`.
  void drop_friction();
  void restore_friction() { has_friction_ = kept_friction_; }

  /// K of the exact rules; null: the unit ball.
  const FrictionShape* shape(int contact) const { return shapes_[std::size_t(contact)]; }
  /// The point of K farthest along `direction`.
  Eigen::Vector3d boundary_point(int contact, const Eigen::Vector3d& direction) const;
  /// Slip that a unit impulse along each axis causes at the contact itself (diagonal of W); 1 along
  /// an axis that cannot move.
  Eigen::Map<const Eigen::Vector3d> friction_metric(int contact) const {
    return Eigen::Map<const Eigen::Vector3d>(metrics_.data() + 3 * contact);
  }

  /// Factors from scaled to the problem's units, row by row:
  ///   impulse = impulse_scale * velocity_unit * scaled impulse,
  ///   velocity = velocity_unit / velocity_scale * scaled velocity.
  const Eigen::VectorXd& impulse_scale() const { return impulse_scale_; }
  const Eigen::VectorXd& velocity_scale() const { return velocity_scale_; }
  double velocity_unit() const { return velocity_unit_; }

 private:
  void scale_contact(const ContactLcp& problem, int contact);
  void set_blocks(const Eigen::MatrixXd& delassus, double proximal);

  int contacts_ = 0;
  Eigen::MatrixXd delassus_;
  const Eigen::SparseMatrix<double>* given_root_ = nullptr;
  Eigen::VectorXd free_velocity_, natural_sizes_, impulse_scale_, velocity_scale_, metrics_;
  double velocity_unit_ = 1;
  std::vector<char> has_friction_, kept_friction_;
  std::vector<const FrictionShape*> shapes_;
  /// The neighbours of contact j are neighbours_[contacts j] up to neighbour_end_[j], with their
  /// blocks of W.
  std::vector<int> neighbours_, neighbour_end_;
  Eigen::VectorXd blocks_;
};

}  // namespace softfinger::internal
