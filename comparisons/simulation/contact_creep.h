#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "comparisons/input/scene.h"
#include "softfinger/time/relaxation.h"

/// Contacts of rubber that relaxes grow while they are pressed.
namespace softfinger::simulation {

/// The load under which an elastic contact is as large as a relaxing one at the end of a step, for
/// each load that the step may end with.
struct EffectiveLoad {
  double growth = 1;         ///< per load of this step
  double crept_N = 0;        ///< by the loads before
  double largest_at_N = 0;   ///< the load under which the contact was largest
  double largest_ratio = 1;  ///< of effective to true load then; now, if that is more

  double of(double load_N) const {
    const double growing_N = growth * load_N + crept_N;
    return load_N >= largest_at_N ? growing_N : std::min(growing_N, largest_ratio * load_N);
  }
};

/// The memory of one contact. While it grows P_eff(t) = E0 int J(t - s) dP(s) (Lee and Radok, J.
/// Appl. Mech. 27, 1960), exact in linear elasticity: a term c (1 - exp(-x t)) of E0 J is c q with
/// q' = x (P - q). A step's load is constant. Below its largest load the contact follows Ting's
/// rule (J. Appl. Mech. 33, 1966) within a few thousandths: the load's share of the largest is the
/// effective load's share, because what has relaxed does so for all sizes alike.
class ContactCreep {
 public:
  explicit ContactCreep(const Relaxation& relaxation);

  /// For a step of this length.
  EffectiveLoad over(double step_s) const;
  /// A step that is done.
  void hold(double load_N, double step_s);

 private:
  Eigen::ArrayXd rates_per_s_, amounts_;
  Eigen::ArrayXd lagging_N_;  ///< q
  double largest_N_ = 0, largest_at_N_ = 0;
};

/// The relaxation of a contact of two bodies: that of their layer, or of both where they relax
/// alike. Two layers that relax differently have no common modulus: nothing.
std::optional<Relaxation> common_relaxation(const input::SceneBody& a, const input::SceneBody& b);

}  // namespace softfinger::simulation
