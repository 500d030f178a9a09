#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "comparisons/input/scene.h"
#include "softfinger/time/relaxation.h"

/// Contacts of rubber that relaxes grow while they are pressed.
namespace softfinger::simulation {

/// The load under which an elastic contact is as large as a relaxing one at the end of a step, for
/// each load that the step may end with: straight between points, of both ascending.
struct EffectiveLoad {
  std::vector<double> carried_N, size_N;  ///< load and effective load; none: elastic rubber
  double growth = 1;  ///< effective over true load beyond the last point, or without one

  double of(double load_N) const;
};

/// The memory of one contact. A contact of size P_eff was built up of shells, each as old as the
/// contact's last growth through its size, and carries
///   P(t) = int_0^P_eff E(t - t1(p))/E0 dp
/// (Lee and Radok, J. Appl. Mech. 27, 1960; Ting, J. Appl. Mech. 33, 1966): exact in linear
/// elasticity for growing contacts, and for one that shrinks for the first time. A shrinking
/// contact loses its outer shells; if it grows again the new ones are young. What the surface
/// remembers where it was left is neglected then.
class ContactCreep {
 public:
  explicit ContactCreep(const Relaxation& relaxation) : relaxation_(relaxation) {}

  /// For a step of this length.
  EffectiveLoad over(double step_s) const;
  /// A step that is done.
  void hold(double load_N, double step_s);

 private:
  struct Shell {
    double width_N = 0;     ///< of the effective load
    Eigen::ArrayXd unlost;  ///< of each term: exp(-age/tau), the mean of what the shell holds
  };
  double modulus(const Eigen::ArrayXd& unlost) const;
  Eigen::ArrayXd kept_over(double step_s) const;
  Eigen::ArrayXd of_new_shell(double step_s) const;

  Relaxation relaxation_;
  std::vector<Shell> shells_;  ///< from the inmost, which is the oldest
};

/// The relaxation of a contact of two bodies: that of their layer, or of both where they relax
/// alike. Two layers that relax differently have no common modulus: nothing.
std::optional<Relaxation> common_relaxation(const input::SceneBody& a, const input::SceneBody& b);

}  // namespace softfinger::simulation
