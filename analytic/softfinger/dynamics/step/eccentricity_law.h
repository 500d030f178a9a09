#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "softfinger/dynamics/step/contact_lcp_solver.h"
#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// e_n of a contact as its load P changes: the contact ellipse grows with it (Ciocarlie et al.
/// 2007, eq. 6). Under a shear law other than Coulomb's the largest force is not proportional to
/// the load either.
class EccentricityLaw {
 public:
  virtual ~EccentricityLaw() = default;
  /// Finite and >= 0 for every load_N >= 0, 0 included.
  virtual double eccentricity_m(double load_N) const noexcept = 0;
  /// The largest force of friction over the load, finite and >= 0 for every load_N > 0; none: the
  /// contact's own coefficient, whatever the load.
  virtual std::optional<double> friction_coefficient(double /*load_N*/) const noexcept {
    return std::nullopt;
  }
};

/// The largest friction coefficient that a contact without one of its own is given.
constexpr double kMostEffectiveFriction = 10;

/// mu of a contact problem for a contact with this limit. A constant shear strength has a largest
/// force like P^(2/3) for light loads, so that F/P grows without limit. There mu is
/// kMostEffectiveFriction: a contact carries less than its strength where that is more than ten
/// times its load.
inline double effective_friction(const FrictionEllipsoid& limit, double load_N) {
  return load_N > 0 ? std::min(limit.max_force_N / load_N, kMostEffectiveFriction) : 0;
}

/// coefficient P^exponent, P in newtons: Hertz has exponent 1/3, Winkler 1/4, an empirical finger
/// its gamma.
class PowerEccentricity final : public EccentricityLaw {
 public:
  /// @param eccentricity_at_1N_m, exponent  >= 0, finite. @throws InputError
  PowerEccentricity(double eccentricity_at_1N_m, double exponent);
  double eccentricity_m(double load_N) const noexcept override;

 private:
  double coefficient_m_, exponent_;
};

/// Samples, interpolated linearly in ln e_n over ln P; beyond the first and last, the power law of
/// the two nearest. A lookup costs a logarithm and an exponential.
class SampledEccentricity final : public EccentricityLaw {
 public:
  /// Loads evenly spaced in ln P. @param eccentricity_m  at least two, > 0, at lowest_load_N,
  /// ..., highest_load_N. @throws InputError
  SampledEccentricity(double lowest_load_N, double highest_load_N,
                      const std::vector<double>& eccentricity_m);

  /// Samples the e_n of a pressure model, which is its exact torque arm.
  /// @param problem  its load is replaced by those of the samples
  /// @throws InputError where the model has no answer
  static SampledEccentricity of_model(const PressureModel& model, ContactProblem problem,
                                      double lowest_load_N, double highest_load_N, int count = 33);

  double eccentricity_m(double load_N) const noexcept override;

 private:
  double log_lowest_, log_step_;
  std::vector<double> log_eccentricity_;
};

struct ConsistentResult {
  LcpResult lcp;       ///< of the last solve; pivots and Newton iterations of all
  int iterations = 0;  ///< contact problems solved
  /// Largest |law(P_i) - e_i|/max(law(P_i), e_i) of the loaded contacts, where e_i is the e_n that
  /// the problem was solved with, and the same of mu_i where a law has it. Contacts without load
  /// have no e_n.
  double inconsistency = 0;
};

/// Contacts whose e_n, and mu where a law has it, belong to the load of the same time step:
/// e_n = law(P), P = impulse over time step. The contact problem is solved again with the values of
/// its loads until they agree.
///
/// Each iteration is a fixed-point step or, where that is between a quarter and four times as long,
/// a step of the contact's own secant through the last two. Steps are halved when the inconsistency
/// grows, and become longer again when it shrinks. The laws are weak (e_n ~ P^(1/3)), so that two
/// or three solves are usual, all but the first one warm. Allocates where ContactLcpSolver does.
class ConsistentContactSolver {
 public:
  struct Options {
    double tolerance = 1e-9;  ///< of the inconsistency
    int most_iterations = 20;
  };

  ConsistentContactSolver(int largest_contacts, int largest_vertices);

  /// Solves the contact problem as ContactLcpSolver::solve does, with e_n by the laws.
  /// @param problem  its eccentricity_m, and its friction_coefficient where a law has one, are the
  ///   first guess, and afterwards those of the solution
  /// @param laws  per contact; null: e_n stays
  /// @param time_step_s  > 0
  /// @throws InputError
  ConsistentResult solve(ContactLcp& problem, const std::vector<const EccentricityLaw*>& laws,
                         double time_step_s, ContactSolution& solution, const Options& options,
                         const std::vector<int>* continued = nullptr);

 private:
  /// A number per contact that is led to what the laws want.
  struct Followed {
    explicit Followed(int contacts) : last(contacts), mismatch(contacts), last_mismatch(contacts) {}
    double compare(int contact, double used, double wanted);
    double next(int contact, double used, double fraction, bool is_first);
    Eigen::VectorXd last, mismatch, last_mismatch;
  };
  ContactLcpSolver solver_;
  std::vector<int> itself_;
  Followed eccentricity_m_, friction_;
};

}  // namespace softfinger
