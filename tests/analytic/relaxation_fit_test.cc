#include "softfinger/time/relaxation_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

const std::vector<RelaxationTerm> kTrue = {{0.06, 20}, {0.12, 0.5}};

/// Forces at 60 times from 0.05 to 200 s with a relative scatter.
std::vector<HeldForce> measured(double scatter, unsigned seed) {
  const Relaxation truth(kTrue);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<HeldForce> forces;
  for (int i = 0; i < 60; ++i) {
    const double time_s = 0.05 * std::pow(4000, i / 59.);
    forces.push_back({time_s, 3 * truth.modulus(time_s) * (1 + scatter * normal(random))});
  }
  return forces;
}

TEST(RelaxationFit, FindsTheTermsOfExactForces) {
  const RelaxationFit fit = fit_relaxation(measured(0, 1));
  ASSERT_EQ(fit.terms.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(fit.terms[i].term.share, kTrue[i].share, 1e-8);
    EXPECT_NEAR(fit.terms[i].term.time_s / kTrue[i].time_s, 1, 1e-7);
  }
  EXPECT_NEAR(fit.force_at_once_N, 3, 1e-8);
  EXPECT_NEAR(fit.long_time_modulus, 0.82, 1e-8);
}

TEST(RelaxationFit, StatesTheScatterOfItsOwnAnswers) {
  // Two standard deviations hold 95 %; of 60 x 2 shares and times at most 15 % may lie outside.
  int outside = 0, all = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const RelaxationFit fit = fit_relaxation(measured(2e-3, seed));
    if (fit.terms.size() != 2) continue;
    for (std::size_t i = 0; i < 2; ++i) {
      const FittedTerm& term = fit.terms[i];
      outside += std::abs(term.term.share - kTrue[i].share) > 2 * term.share_std;
      outside += std::abs(std::log(term.term.time_s / kTrue[i].time_s)) > 2 * term.log_time_std;
      all += 2;
    }
    EXPECT_NEAR(fit.scatter_N / 3, 1.8e-3, 0.6e-3);  // the force is 0.9 of 3 N in the mean
  }
  EXPECT_GT(all, 160);
  EXPECT_LT(outside, 0.15 * all);
}

TEST(RelaxationFit, FindsNoTermInAForceThatDoesNotFall) {
  int found = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<HeldForce> forces;
    for (int i = 0; i < 40; ++i) forces.push_back({0.5 * i, 2 + 0.01 * normal(random)});
    found += !fit_relaxation(forces).terms.empty();
  }
  // Akaike's criterion takes a term by chance in some per cent to a sixth of all cases.
  EXPECT_LE(found, 6);
}

TEST(RelaxationFit, RefusesForcesThatAreNone) {
  std::vector<HeldForce> forces = measured(0, 1);
  EXPECT_THROW(fit_relaxation({forces.begin(), forces.begin() + 5}), InputError);
  forces[3].force_N = 0;
  EXPECT_THROW(fit_relaxation(forces), InputError);
  forces[3] = forces[4];
  EXPECT_THROW(fit_relaxation(forces), InputError);
  forces[3] = {-1, 2};
  EXPECT_THROW(fit_relaxation(forces), InputError);
}

}  // namespace
}  // namespace softfinger
