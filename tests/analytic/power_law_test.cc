#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "quadrature.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/power_law_fit.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

ContactProblem problem_with(const PowerLaw& law, double load_N) {
  ContactProblem problem{{0.01, 0.01}, {0.003, 3e5, 0.45}, {load_N, 0.5}};
  problem.options.power_law = law;
  return problem;
}

Prediction power_law(const ContactProblem& problem) {
  return find_pressure_model("power_law")->predict(problem);
}

std::string refusal(const ContactProblem& problem) {
  const Prediction prediction = power_law(problem);
  EXPECT_FALSE(prediction.has_answer);
  return prediction.validity.begin()->check;
}

TEST(PowerLaw, IsHertzForAThirdAndTwo) {
  ContactProblem problem{{0.01, 0.01}, {1000, 1e6, 0}, {0.3, 0.5}};
  const Prediction hertz = find_pressure_model("hertz")->predict(problem);
  problem.options.power_law = {hertz.a_m / std::cbrt(0.3), 1.0 / 3, 2};
  problem.load.normal_force_N = 0.1;
  const Prediction reference = find_pressure_model("hertz")->predict(problem);
  const Prediction contact = power_law(problem);
  const double tolerance = 4e-15;  // a handful of roundings
  EXPECT_NEAR(contact.a_m / reference.a_m, 1, tolerance);
  EXPECT_NEAR(contact.indentation_m / reference.indentation_m, 1, tolerance);
  EXPECT_NEAR(contact.peak_pressure_Pa / reference.peak_pressure_Pa, 1, tolerance);
  EXPECT_NEAR(contact.torque_arm_exact_m / reference.torque_arm_exact_m, 1, tolerance);
  const PressureModel& model = *find_pressure_model("power_law");
  for (const double r : {0.1, 0.5, 0.9, 0.999})
    EXPECT_NEAR(model.pressure_Pa(problem, contact, 0.6 * r * contact.a_m, 0.8 * r * contact.a_m) /
                    (contact.peak_pressure_Pa * std::sqrt(1 - r * r)),
                1, 1e-13);
}

TEST(PowerLaw, PressureCarriesTheLoadAndTheTorqueForAnyExponent) {
  const PressureModel& model = *find_pressure_model("power_law");
  testing::WorstError worst("power law against quadrature");
  for (const double k : {1.0, 1.5, 2.0, 3.0, 10.0, 50.0}) {
    const ContactProblem problem = problem_with({0.003, 0.25, k}, 4);
    const Prediction contact = model.predict(problem);
    ASSERT_TRUE(contact.has_answer);
    // r = a x, x = 1/(1 + exp(-u)): both ends are resolved.
    const auto moment = [&](int power) {
      return 2 * kPi * double(testing::integrate_line(-45, 45, 0.1L, [&](long double u) {
               const long double x = 1 / (1 + std::exp(-u)), dx = x / (1 + std::exp(u));
               const double r = double(x) * contact.a_m;
               return model.pressure_Pa(problem, contact, r, 0) * std::pow(r, power) * contact.a_m *
                      dx;
             }));
    };
    // The edge is a difference of doubles, its rounding to the power 1/k over a strip of epsilon.
    EXPECT_LT(worst.of(moment(1), 4), 1e-13) << k;
    EXPECT_LT(worst.of(moment(2) / 4, contact.torque_arm_exact_m), 1e-13) << k;
  }
}

TEST(PowerLaw, RefusesInWordsWhatItDoesNotKnow) {
  EXPECT_EQ(refusal(problem_with({}, 1)), "power_law_known");
  EXPECT_EQ(refusal(problem_with({-1, 0.3, 2}, 1)), "radius_coefficient_in_range");
  EXPECT_EQ(refusal(problem_with({std::nan(""), 0.3, 2}, 1)), "radius_coefficient_in_range");
  EXPECT_EQ(refusal(problem_with({0.003, 1, 2}, 1)), "radius_exponent_in_range");
  EXPECT_EQ(refusal(problem_with({0.003, 0, 2}, 1)), "radius_exponent_in_range");
  EXPECT_EQ(refusal(problem_with({0.003, 0.3, 0.5}, 1)), "pressure_exponent_in_range");
  ContactProblem compliant = problem_with({0.003, 0.3, 2}, 1);
  compliant.object_layer = compliant.layer;
  EXPECT_EQ(refusal(compliant), "rigid_object");
}

TEST(PowerLaw, IsValidForRoundContactsOnly) {
  ContactProblem problem = problem_with({0.002, 0.3, 2}, 1);
  EXPECT_TRUE(power_law(problem).valid());
  problem.radii.major_m *= 2.6;
  const Prediction contact = power_law(problem);
  EXPECT_TRUE(contact.has_answer);
  EXPECT_FALSE(contact.valid());
  EXPECT_EQ(contact.a_m, contact.b_m);
  EXPECT_EQ(std::string(contact.validity.begin()->check), "round_contact");
}

TEST(PowerLawFit, FindsAnExactLaw) {
  std::vector<LoadAndRadius> data;
  for (const double P : {0.1, 0.7, 3.0, 20.0}) data.push_back({P, 0.0031 * std::pow(P, 0.27)});
  const PowerLawFit fit = fit_power_law(data, 3);
  EXPECT_NEAR(fit.law.radius_coefficient / 0.0031, 1, 1e-14);
  EXPECT_NEAR(fit.law.radius_exponent / 0.27, 1, 1e-14);
  EXPECT_EQ(fit.law.pressure_exponent, 3);
  EXPECT_LT(fit.residual_rms, 1e-14);
  EXPECT_EQ(fit.least_load_N, 0.1);
  EXPECT_EQ(fit.largest_load_N, 20);
}

// The stated standard deviation is that of the estimate: over many noisy repetitions their ratio
// has the spread of Student's t.
TEST(PowerLawFit, StatesItsUncertainty) {
  std::mt19937_64 random(1999);
  std::normal_distribution<double> noise(0, 0.02);
  constexpr int kTrials = 4000, kPoints = 20;
  int inside = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<LoadAndRadius> data;
    for (int i = 0; i < kPoints; ++i) {
      const double P = 0.1 * std::pow(200, i / (kPoints - 1.0));
      data.push_back({P, 0.0031 * std::pow(P, 0.27) * std::exp(noise(random))});
    }
    const PowerLawFit fit = fit_power_law(data);
    EXPECT_NEAR(fit.residual_rms, 0.02, 0.015);
    inside += std::abs(fit.law.radius_exponent - 0.27) < 2.101 * fit.exponent_std;
  }
  // 95 % of Student's t with 18 degrees of freedom; three binomial standard deviations.
  EXPECT_NEAR(inside / double(kTrials), 0.95, 3 * std::sqrt(0.95 * 0.05 / kTrials));
}

TEST(PowerLawFit, RefusesDataThatDetermineNothing) {
  EXPECT_THROW(fit_power_law({}), InputError);
  EXPECT_THROW(fit_power_law({{1, 0.003}}), InputError);
  EXPECT_THROW(fit_power_law({{1, 0.003}, {1, 0.004}}), InputError);
  EXPECT_THROW(fit_power_law({{1, 0.003}, {2, 0.002}}), InputError) << "shrinks under load";
  EXPECT_THROW(fit_power_law({{1, 0.003}, {2, 0.007}}), InputError) << "gamma above 1";
  EXPECT_THROW(fit_power_law({{1, 0.003}, {-2, 0.004}}), InputError);
  EXPECT_THROW(fit_power_law({{1, 0.003}, {2, std::nan("")}}), InputError);
  EXPECT_THROW(fit_power_law({{1, 0.003}, {2, 0.0035}}, 0.5), InputError);
  EXPECT_EQ(fit_power_law({{1, 0.003}, {8, 0.006}}).exponent_std, 0) << "two points, no scatter";
}

}  // namespace
}  // namespace softfinger
