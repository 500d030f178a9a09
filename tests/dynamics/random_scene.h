#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "softfinger/dynamics/step/contact_lcp_solver.h"

namespace softfinger::tests {

/// Vertices of the friction ellipsoid, built once per count: that takes milliseconds.
const Eigen::Matrix3Xd& friction_vertices(int count);

/// Rigid bodies that touch each other and a fixed world, at random: masses over six decades, e_n
/// from 1e-6 to 1 m, friction from none to 1.5, one in three contacts repeated nearby with the same
/// normal (redundant) or exactly. Where the world is fixed, a solution exists by Anitescu and
/// Potra's theorem.
class RandomScenes {
 public:
  explicit RandomScenes(unsigned seed) : random_(seed) {}

  ContactLcp next(int contacts, int vertices);

  /// Whether problems come with their root, ContactLcp::root.
  bool gives_roots = false;

  /// The next time step of the scene of `problem`, the last one made, after `solution`: gravity for
  /// 0.01 s, and contacts that have moved as in `disturb`. Bodies that have just been hit fly
  /// apart: contacts change what they do.
  void step(ContactLcp& problem, const ContactSolution& solution, double amount);

  /// Perturbs the scene of `problem` at random, as a step of steady motion does: each contact is
  /// moved by `amount` of its arm and turned by `amount` rad, velocities change by up to `amount`
  /// of themselves.
  void disturb(ContactLcp& problem, double amount);

  double uniform(double lowest, double highest) {
    return lowest + (highest - lowest) * std::generate_canonical<double, 53>(random_);
  }

 private:
  Eigen::Vector3d direction();
  Eigen::Matrix3d rotation();

  struct Touch {
    int first, second;      ///< bodies; second < 0: the world
    Eigen::Matrix3d frame;  ///< columns: normal, tangents
    Eigen::Vector3d first_arm_m, second_arm_m;
  };

  void assemble(ContactLcp& problem);
  void add_body(int contact, int body, const Eigen::Matrix3d& frame, const Eigen::Vector3d& arm_m,
                double sign);

  std::mt19937_64 random_;
  std::vector<Touch> touches_;
  Eigen::MatrixXd jacobian_, inverse_mass_;
  Eigen::VectorXd velocity_;
};

/// Contacts of which each can be moved by itself, with little friction: W is well-conditioned, so
/// that velocities are unique.
ContactLcp separate_contacts(RandomScenes& scenes, int contacts);

}  // namespace softfinger::tests
