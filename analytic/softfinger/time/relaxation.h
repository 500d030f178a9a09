#pragma once

#include <Eigen/Core>
#include <vector>

/// Linear viscoelastic rubber: its modulus falls with time while it is held, and it creeps under
/// load.
namespace softfinger {

/// One spring and dashpot of the generalised Maxwell solid (a term of its Prony series).
struct RelaxationTerm {
  double share = 0;   ///< of the instantaneous modulus that this term loses, > 0
  double time_s = 0;  ///< after which it has lost all but 1/e, > 0
};

/// The modulus of rubber t seconds after it was deformed and held,
///   E(t) = E0 (1 - sum_i g_i (1 - exp(-t/tau_i))),
/// with the instantaneous modulus E0, shares g_i and times tau_i (Ferry, Viscoelastic Properties of
/// Polymers, 1980, ch. 3). The sum of shares is below 1: the rubber is a solid. Poisson's ratio is
/// constant, which makes every modulus of the layer fall by the same factor.
///
/// The creep compliance J follows exactly from int E(t - s) dJ(s) = 1:
///   E0 J(t) = 1 + sum_j c_j (1 - exp(-x_j t)),
/// where -x_j are the zeros of Q(s) = 1 - sum_i g_i/(1 + s tau_i). One lies between 0 and 1/tau_max
/// and one between each two neighbouring 1/tau_i. c_j = 1/(x_j Q'(-x_j)).
class Relaxation {
 public:
  /// Elastic: E(t) = E0.
  Relaxation() = default;

  /// @param terms  in any order; of equal times the shares are added
  /// @throws InputError for a share or a time that is not a finite number > 0, and for shares whose
  /// sum is not below 1
  explicit Relaxation(std::vector<RelaxationTerm> terms);

  bool is_elastic() const { return terms_.empty(); }
  /// The terms by falling time.
  const std::vector<RelaxationTerm>& terms() const { return terms_; }
  /// E(infinity)/E0
  double long_time_modulus() const { return long_time_; }
  /// E(t)/E0 for t >= 0; t may be infinite.
  double modulus(double time_s) const;
  /// E0 J(t) for t >= 0; t may be infinite.
  double compliance(double time_s) const;

  /// The numbers x_j in 1/s by which creep proceeds, ascending, and x_j c_j.
  const Eigen::ArrayXd& creep_rates_per_s() const { return rates_per_s_; }
  const Eigen::ArrayXd& creep_amounts_per_s() const { return amounts_per_s_; }
  /// int_0^t exp(-(t - s)/tau_i) d(J*P)(s) is `memory()` row i times int_0^t exp(-x_j (t - s))
  /// dP(s) for any P: with both kernels in Laplace's space, x_j c_j/(1/tau_i - x_j).
  const Eigen::ArrayXXd& memory() const { return memory_; }

 private:
  std::vector<RelaxationTerm> terms_;
  double long_time_ = 1;
  Eigen::ArrayXd rates_per_s_, amounts_per_s_;
  Eigen::ArrayXXd memory_;
};

/// Terms of the power law E(t) = E0 (1 + t/t0)^-n. By (1 + t/t0)^-n = int u^(n-1) exp(-u (1 +
/// t/t0)) du/Gamma(n), two terms for each factor of ten in time. They follow the law within 0.5 %
/// up to `until_s`, and the modulus stays from a hundred times that on.
///
/// @param exponent  0 < n <= 0.3
/// @param time_s    t0 > 0, from which the modulus falls
/// @param until_s   at least t0, and at most 1e12 t0
/// @throws InputError for numbers out of range
std::vector<RelaxationTerm> power_law_relaxation(double exponent, double time_s, double until_s);

}  // namespace softfinger
