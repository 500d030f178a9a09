// e_n that depends on the load of the same time step.
#include "softfinger/dynamics/step/eccentricity_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

constexpr double kStep_s = 1e-3;

/// A contact whose load falls with the torque it carries: v_n couples to the spin.
ContactLcp coupled_contact() {
  ContactLcp problem;
  problem.delassus = Eigen::Vector4d(0.5, 0.5, 0.5, 2e3).asDiagonal();
  problem.delassus(0, 3) = problem.delassus(3, 0) = 15;
  problem.free_velocity = Eigen::Vector4d(-0.01, 0, 0, 200);
  problem.friction_coefficient.setConstant(1, 0.8);
  problem.eccentricity_m.setConstant(1, 0.002);
  problem.friction_rule = FrictionRule::ellipsoid;
  return problem;
}

double load_N(ContactLcp problem, double eccentricity_m) {
  problem.eccentricity_m[0] = eccentricity_m;
  ContactSolution solution;
  ContactLcpSolver(1, 0).solve(problem, solution);
  return solution.impulse[0] / kStep_s;
}

TEST(EccentricityLaw, PowerLawAndItsSamplesAgree) {
  const PowerEccentricity power(0.003, 1.0 / 3);
  std::vector<double> samples;
  for (int i = 0; i <= 4; ++i) samples.push_back(power.eccentricity_m(0.1 * std::pow(10, i)));
  const SampledEccentricity sampled(0.1, 1000, samples);
  // A power law is a straight line there, also beyond the samples.
  for (const double load : {1e-9, 0.05, 0.1, 0.7, 33., 1e3, 5e4})
    EXPECT_NEAR(sampled.eccentricity_m(load) / power.eccentricity_m(load), 1, 1e-12) << load;
  EXPECT_EQ(power.eccentricity_m(0), 0);
  EXPECT_EQ(sampled.eccentricity_m(0), 0);
}

TEST(EccentricityLaw, OfHertzIsACubeRoot) {
  ContactProblem problem;
  problem.radii = {0.02, 0.01, 0};
  problem.layer = {0.01, 1e6, 0.45};
  problem.load.friction_coefficient = 0.5;
  const SampledEccentricity law =
      SampledEccentricity::of_model(*find_pressure_model("hertz"), problem, 0.1, 100);
  EXPECT_NEAR(law.eccentricity_m(8) / law.eccentricity_m(1), 2, 1e-12);
  problem.load.normal_force_N = 3;
  EXPECT_NEAR(law.eccentricity_m(3),
              find_pressure_model("hertz")->predict(problem).torque_arm_exact_m, 1e-15);
}

TEST(EccentricityLaw, AgreesWithABisection) {
  const PowerEccentricity law(0.001, 1.0 / 3);
  ContactLcp problem = coupled_contact();
  // g(e) = law(P(e)) - e changes its sign once.
  double low = 1e-6, high = 0.1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (law.eccentricity_m(load_N(problem, middle)) > middle ? low : high) = middle;
  }
  EXPECT_GT(std::abs(load_N(problem, low) / load_N(problem, 1e-9) - 1), 0.01);  // it matters
  ConsistentContactSolver solver(1, 0);
  ContactSolution solution;
  const ConsistentResult result = solver.solve(problem, {&law}, kStep_s, solution, {});
  ASSERT_EQ(result.lcp.status, LcpStatus::solved);
  EXPECT_LE(result.inconsistency, 1e-9);
  EXPECT_LE(result.iterations, 8);
  EXPECT_NEAR(problem.eccentricity_m[0] / low, 1, 1e-8);
  EXPECT_LE(exact_contact_residual(problem, solution), 1e-12);
}

TEST(EccentricityLaw, NeedsTwoSolvesWhereTheLoadIsGiven) {
  ContactLcp problem = coupled_contact();
  problem.delassus(0, 3) = problem.delassus(3, 0) = 0;
  const PowerEccentricity law(0.001, 0.25);
  ConsistentContactSolver solver(1, 0);
  ContactSolution solution;
  const ConsistentResult result = solver.solve(problem, {&law}, kStep_s, solution, {});
  EXPECT_EQ(result.iterations, 2);
  EXPECT_TRUE(result.lcp.is_warm());
  EXPECT_NEAR(problem.eccentricity_m[0], 0.001 * std::pow(0.02 / kStep_s, 0.25), 1e-15);
}

/// A law that answers as if the contact problem had several solutions: at first almost with the
/// value in use, then for good with that of another solution.
class LawOfAnotherSolution final : public EccentricityLaw {
 public:
  double eccentricity_m(double) const noexcept override {
    constexpr double kAnswers[] = {0.0021, 0.002102, 0.003};
    return kAnswers[std::min(asked_++, 2)];
  }

 private:
  mutable int asked_ = 0;
};

TEST(EccentricityLaw, IsFollowedToTheSolutionThatTheSolverCameTo) {
  ContactLcp problem = coupled_contact();
  const LawOfAnotherSolution law;
  ConsistentContactSolver solver(1, 0);
  ContactSolution solution;
  const ConsistentResult result = solver.solve(problem, {&law}, kStep_s, solution, {});
  EXPECT_LE(result.inconsistency, 1e-9);
  EXPECT_LE(result.iterations, 8);
  EXPECT_NEAR(problem.eccentricity_m[0], 0.003, 1e-11);
}

TEST(EccentricityLaw, RandomScenesBecomeConsistent) {
  const PowerEccentricity hertz(0.002, 1.0 / 3), stiffening(0.003, 0.1);
  tests::RandomScenes scenes(41);
  ContactSolution solution;
  for (const FrictionRule rule : {FrictionRule::facets, FrictionRule::ellipsoid})
    for (int trial = 0; trial < 50; ++trial) {
      ContactLcp problem = tests::separate_contacts(scenes, 1 + trial % 8);
      problem.friction_rule = rule;
      problem.vertices = tests::friction_vertices(16);
      std::vector<const EccentricityLaw*> laws(std::size_t(problem.contacts()), &hertz);
      laws[0] = nullptr;
      laws.back() = &stiffening;
      ConsistentContactSolver solver(8, 16);
      const ConsistentResult result = solver.solve(problem, laws, kStep_s, solution, {});
      ASSERT_EQ(result.lcp.status, LcpStatus::solved) << trial;
      EXPECT_LE(result.inconsistency, 1e-9) << trial;
      for (int i = 0; i < problem.contacts(); ++i) {
        const double load = solution.impulse[4 * i] / kStep_s;
        if (!laws[std::size_t(i)] || load == 0) continue;
        const double wanted = laws[std::size_t(i)]->eccentricity_m(load);
        EXPECT_NEAR(problem.eccentricity_m[i] / wanted, 1, 2e-9) << trial;
      }
    }
}

/// A constant shear stress on a Hertz circle a = c P^(1/3): F = pi a² tau_0, T = 2/3 pi a³ tau_0.
class StrengthOnHertzCircle final : public EccentricityLaw {
 public:
  static constexpr double kStrength_Pa = 4e4;
  double radius_m(double load_N) const noexcept { return 1.5e-3 * std::cbrt(load_N); }
  FrictionEllipsoid limit(double load_N) const noexcept {
    const double a = radius_m(load_N);
    return {kPi * a * a * kStrength_Pa, 2 * a / 3};
  }
  double eccentricity_m(double load_N) const noexcept override {
    return limit(load_N).eccentricity_m;
  }
  std::optional<double> friction_coefficient(double load_N) const noexcept override {
    return effective_friction(limit(load_N), load_N);
  }
};

TEST(EccentricityLaw, GivesAContactOfConstantShearStressItsLargestTorqueAtAnyLoad) {
  const StrengthOnHertzCircle law;
  ConsistentContactSolver solver(1, 0);
  ContactSolution solution;
  for (const double load : {0.02, 0.3, 2.0, 40.0}) {
    ContactLcp problem = coupled_contact();
    problem.delassus(0, 3) = problem.delassus(3, 0) = 0;
    problem.free_velocity[0] = -problem.delassus(0, 0) * load * kStep_s;
    problem.free_velocity[3] = 1;  // faster than any of the loads could stop
    const ConsistentResult result = solver.solve(problem, {&law}, kStep_s, solution, {});
    ASSERT_EQ(result.lcp.status, LcpStatus::solved);
    EXPECT_LE(result.iterations, 3);
    const double torque = solution.impulse[3] / kStep_s;
    EXPECT_NEAR(torque / (-2 * kPi / 3 * std::pow(law.radius_m(load), 3) *
                          StrengthOnHertzCircle::kStrength_Pa),
                1, 1e-8)
        << load;
  }
}

TEST(EccentricityLaw, OfFrictionAgreesWithABisection) {
  const StrengthOnHertzCircle law;
  const auto load_of = [&](double load) {
    ContactLcp problem = coupled_contact();
    problem.friction_coefficient[0] = *law.friction_coefficient(load);
    return load_N(problem, law.eccentricity_m(load));
  };
  double low = 1, high = 100;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (load_of(middle) > middle ? low : high) = middle;
  }
  ContactLcp problem = coupled_contact();
  ConsistentContactSolver solver(1, 0);
  ContactSolution solution;
  const ConsistentResult result = solver.solve(problem, {&law}, kStep_s, solution, {});
  ASSERT_EQ(result.lcp.status, LcpStatus::solved);
  EXPECT_LE(result.inconsistency, 1e-9);
  EXPECT_NEAR(solution.impulse[0] / kStep_s / low, 1, 1e-7);
  EXPECT_NEAR(problem.friction_coefficient[0] / *law.friction_coefficient(low), 1, 1e-7);
  EXPECT_LE(exact_contact_residual(problem, solution), 1e-12);
}

TEST(EccentricityLaw, BoundsTheFrictionOfLightContacts) {
  const StrengthOnHertzCircle law;
  EXPECT_EQ(*law.friction_coefficient(1e-9), kMostEffectiveFriction);
  EXPECT_LT(*law.friction_coefficient(1), kMostEffectiveFriction);
  EXPECT_EQ(effective_friction({1, 1}, 0), 0);
}

TEST(EccentricityLaw, OfConstantShearStressBecomesConsistentInRandomScenes) {
  const StrengthOnHertzCircle strength;
  const PowerEccentricity hertz(0.002, 1.0 / 3);
  tests::RandomScenes scenes(43);
  ContactSolution solution;
  for (int trial = 0; trial < 100; ++trial) {
    ContactLcp problem = tests::separate_contacts(scenes, 1 + trial % 8);
    problem.friction_rule = FrictionRule::ellipsoid;
    std::vector<const EccentricityLaw*> laws(std::size_t(problem.contacts()), &strength);
    laws[0] = &hertz;
    const double coulomb = problem.friction_coefficient[0];
    ConsistentContactSolver solver(8, 16);
    const ConsistentResult result = solver.solve(problem, laws, kStep_s, solution, {});
    ASSERT_EQ(result.lcp.status, LcpStatus::solved) << trial;
    EXPECT_LE(result.inconsistency, 1e-9) << trial;
    EXPECT_EQ(problem.friction_coefficient[0], coulomb) << "a law of e_n alone";
    for (int i = 1; i < problem.contacts(); ++i) {
      const double load = solution.impulse[4 * i] / kStep_s;
      if (!(load > 0)) continue;
      EXPECT_NEAR(problem.friction_coefficient[i] / *strength.friction_coefficient(load), 1, 2e-9)
          << trial;
    }
  }
}

TEST(EccentricityLaw, IsNeverNotANumberWithoutLoad) {
  ContactLcp problem = coupled_contact();
  problem.free_velocity[0] = 0.01;
  const PowerEccentricity law(0.001, 1.0 / 3);
  ConsistentContactSolver solver(1, 0);
  ContactSolution solution;
  const ConsistentResult result = solver.solve(problem, {&law}, kStep_s, solution, {});
  EXPECT_EQ(result.lcp.status, LcpStatus::solved);
  EXPECT_EQ(result.inconsistency, 0);
  EXPECT_EQ(problem.eccentricity_m[0], 0.002);
  EXPECT_TRUE(solution.velocity.allFinite());
}

TEST(EccentricityLaw, RefusesWhatIsNoLaw) {
  EXPECT_THROW(PowerEccentricity(-1, 0.3), InputError);
  EXPECT_THROW(PowerEccentricity(0.001, NAN), InputError);
  EXPECT_THROW(SampledEccentricity(1, 1, {1, 2}), InputError);
  EXPECT_THROW(SampledEccentricity(1, 2, {1}), InputError);
  EXPECT_THROW(SampledEccentricity(1, 2, {1, 0}), InputError);
}

}  // namespace
}  // namespace softfinger
