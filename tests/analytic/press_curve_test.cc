#include "softfinger/calibration/press_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "softfinger/calibration/forecast.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

// Hertz's contact of a sphere on a half-space, written here: d = (3 P/(4 E* sqrt(R)))^(2/3).
constexpr double kModulus_Pa = 180e3, kPoisson = 0.49, kRadius_m = 12.5e-3;

double hertz_m(double force_N, double modulus_Pa = kModulus_Pa) {
  const double plane_strain_Pa = modulus_Pa / (1 - kPoisson * kPoisson);
  return std::pow(0.75 * force_N / (plane_strain_Pa * std::sqrt(kRadius_m)), 2. / 3);
}

/// Readings at these loads from a zero of 0.3 mm on a mount of 10 N/mm, each with a normal error.
struct Readings {
  double zero_m = 0.3e-3, compliance_m_per_N = 0, std_m = 0;
  unsigned seed = 1;
  double least_N = 0.1, largest_N = 6;
  int count = 20;

  CalibrationProblem problem(const char* model = "hertz") const {
    std::mt19937 generator(seed);
    std::normal_distribution<double> error(0, std_m > 0 ? std_m : 1);
    CalibrationProblem result;
    result.model = find_pressure_model(model);
    result.free = {Parameter::youngs_modulus, Parameter::zero};
    result.start[index_of(Parameter::youngs_modulus)] = 1e6;
    result.start[index_of(Parameter::thickness)] = 0.1;
    result.start[index_of(Parameter::poisson_ratio)] = kPoisson;
    result.start[index_of(Parameter::radius)] = kRadius_m;
    for (int i = 0; i < count; ++i) {
      ContactProblem contact;
      contact.radii = {kRadius_m, kRadius_m, 0};
      contact.finger_curvature = {1 / kRadius_m, 1 / kRadius_m, 0};
      contact.layer = {0.1, 1e6, kPoisson};
      contact.load.normal_force_N = least_N + (largest_N - least_N) * i / (count - 1);
      const double load_N = contact.load.normal_force_N;
      result.measurements.contacts.push_back(contact);
      result.measurements.values.push_back({MeasuredQuantity::indentation, std::size_t(i),
                                            zero_m + hertz_m(load_N) + compliance_m_per_N * load_N +
                                                (std_m > 0 ? error(generator) : 0),
                                            0});
    }
    return result;
  }
};

const ParameterEstimate& of(const Calibration& found, Parameter parameter) {
  for (const ParameterEstimate& estimate : found.parameters)
    if (estimate.parameter == parameter) return estimate;
  throw std::logic_error("not fitted");
}

TEST(PressCurve, HasTheExponentThatItWasMadeWith) {
  for (const double exponent : {1., 1.5, 2., 3.}) {
    PressCurve curve;
    for (int i = 1; i <= 12; ++i) {
      curve.force_N.push_back(0.5 * i);
      curve.travel_m.push_back(0.2e-3 + 1e-3 * std::pow(0.5 * i, 1 / exponent));
    }
    const CurveExponent found = curve_exponent(curve, false);
    ASSERT_TRUE(found.is_known);
    // The scan's step of 1/n is 0.002.
    EXPECT_NEAR(1 / found.value, 1 / exponent, 0.002);
    EXPECT_LE(found.low, found.value);
    EXPECT_GE(found.high, found.value);
    EXPECT_NEAR(found.best.travel_m(3), 0.2e-3 + 1e-3 * std::pow(3, 1 / exponent), 2e-6);
  }
  EXPECT_FALSE(curve_exponent({{1, 2, 3, 4}, {1, 2, 3, 4}}, false).is_known);
  EXPECT_FALSE(curve_exponent({{1, 2, 3, 4, 5}, {1, 1, 1, 1, 1}}, false).is_known);
}

TEST(PressCurve, HasTwoBranchesWhereItsTravelTurnsOnce) {
  EXPECT_EQ(first_unloading_row({1, 2, 3, 3, 2, 1, 0}), 3u);
  EXPECT_EQ(first_unloading_row({1, 2, 3, 4, 5, 6}), 6u);        // loading only
  EXPECT_EQ(first_unloading_row({1, 3, 2, 4, 3, 5, 2, 1}), 8u);  // prints in any order
  EXPECT_EQ(first_unloading_row({6, 5, 4, 3, 2, 1}), 6u);        // written downwards
  EXPECT_EQ(first_unloading_row({1, 2, 3, 2}), 4u);              // too short to tell
}

TEST(PressCurve, NamesBacklashAndHysteresisApart) {
  // A machine with 0.1 mm of play on a perfect spring of 2 N/mm: force stays while the drive turns.
  PressCurve loading, unloading;
  for (int i = 0; i <= 100; ++i) {
    const double travel_m = 1e-4 * i;
    loading.travel_m.push_back(travel_m);
    loading.force_N.push_back(2e3 * travel_m);
  }
  for (int i = 100; i >= 0; --i) {
    const double travel_m = 1e-4 * i;
    unloading.travel_m.push_back(travel_m);
    unloading.force_N.push_back(2e3 * std::min(travel_m + 1e-4, 1e-2));
  }
  const Loop play = loop_between(loading, unloading);
  ASSERT_TRUE(play.is_known);
  EXPECT_NEAR(play.backlash_m, 1e-4, 1e-8);
  // The branch ends at a travel of zero, where the spring still holds 0.1 mm of it: 1e-4 of the
  // work.
  EXPECT_NEAR(play.hysteresis_share, 0, 2e-4);
  // A material that gives back P (1 - 0.4 (1 - P/Pmax)): a triangle of force, whose area is known:
  // the integral of 0.4 P (1 - P/Pmax) is 0.4/3 of that of P.
  unloading = {};
  for (int i = 100; i >= 0; --i) {
    const double share = 0.01 * i;
    unloading.travel_m.push_back(1e-4 * i);
    unloading.force_N.push_back(2e3 * 1e-4 * i * (1 - 0.4 * (1 - share)));
  }
  const Loop lag = loop_between(loading, unloading);
  ASSERT_TRUE(lag.is_known);
  EXPECT_EQ(lag.backlash_m, 0);
  EXPECT_NEAR(lag.hysteresis_share, 0.4 / 3, 1e-4);  // trapezoids of a hundredth
  EXPECT_GT(lag.shift_m[1], 0);
}

TEST(Zero, IsFoundBesideTheModulus) {
  const Calibration found = calibrate(Readings{}.problem());
  EXPECT_NEAR(of(found, Parameter::zero).value, 0.3e-3, 1e-8);
  EXPECT_NEAR(of(found, Parameter::youngs_modulus).value / kModulus_Pa, 1, 1e-4);
  EXPECT_TRUE(of(found, Parameter::zero).is_determined());
}

TEST(Zero, HasAnIntervalThatHoldsTheTruth) {
  constexpr int kSets = 100;
  int zero_held = 0, modulus_held = 0;
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    Readings readings;
    readings.std_m = 0.03e-3;
    readings.seed = seed;
    const Calibration found = calibrate(readings.problem());
    const auto holds = [&](Parameter parameter, double truth) {
      return of(found, parameter).low <= truth && truth <= of(found, parameter).high;
    };
    zero_held += holds(Parameter::zero, 0.3e-3);
    modulus_held += holds(Parameter::youngs_modulus, kModulus_Pa);
    // An absolute error of the readings, relative to the largest of them.
    const double largest_m = 0.3e-3 + hertz_m(6);
    EXPECT_NEAR(found.scatter[std::size_t(MeasuredQuantity::indentation)], 0.03e-3 / largest_m,
                0.7 * 0.03e-3 / largest_m);
  }
  // 95 %, less four standard deviations of a hundred intervals.
  EXPECT_GE(zero_held, 95 - 4 * 2.2);
  EXPECT_GE(modulus_held, 95 - 4 * 2.2);
}

TEST(Compliance, OfTheMountIsFoundOrTakenAsKnown) {
  Readings readings;
  readings.compliance_m_per_N = 1e-4;
  CalibrationProblem problem = readings.problem();
  const double without = of(calibrate(problem), Parameter::youngs_modulus).value;
  EXPECT_LT(without, 0.9 * kModulus_Pa);  // the mount's part is taken for the finger's
  problem.start[index_of(Parameter::compliance)] = 1e-4;
  EXPECT_NEAR(of(calibrate(problem), Parameter::youngs_modulus).value / kModulus_Pa, 1, 1e-4);
  problem.start[index_of(Parameter::compliance)] = 5e-5;
  problem.free.push_back(Parameter::compliance);
  const Calibration found = calibrate(problem);
  EXPECT_NEAR(of(found, Parameter::compliance).value, 1e-4, 1e-7);
  EXPECT_NEAR(of(found, Parameter::zero).value, 0.3e-3, 1e-6);
  EXPECT_NEAR(of(found, Parameter::youngs_modulus).value / kModulus_Pa, 1, 2e-3);
}

TEST(Forecast, HoldsTheUpperHalfWhereTheModelIsRightAndWhereItIsNot) {
  for (const double stiffening : {0., 0.3, -0.3}) {
    Readings lower, upper;
    lower.largest_N = 3;
    lower.std_m = upper.std_m = 0.01e-3;
    upper.least_N = 3.2;
    upper.seed = 2;
    CalibrationProblem problem = lower.problem();
    Measurements asked = upper.problem().measurements;
    // Rubber of another law: its travel departs from Hertz's by this part at 6 N.
    const auto depart = [&](Measurements& measurements) {
      for (Measurement& value : measurements.values) {
        const double load_N = measurements.contacts[value.contact].load.normal_force_N;
        value.value -= stiffening * hertz_m(load_N) * load_N / 6;
      }
    };
    depart(problem.measurements);
    depart(asked);
    const Calibration found = calibrate(problem);
    const std::vector<Forecast> forecasts = forecast(problem, found, asked);
    int inside = 0;
    for (std::size_t i = 0; i < forecasts.size(); ++i) {
      ASSERT_TRUE(forecasts[i].is_known);
      inside += forecasts[i].low() <= asked.values[i].value &&
                asked.values[i].value <= forecasts[i].high();
    }
    // A band of 95 % leaves one of twenty readings outside.
    EXPECT_GE(inside, 18) << stiffening;
    // No band that holds because it holds everything.
    const Forecast& last = forecasts.back();
    EXPECT_LT(last.chance + last.misfit, (stiffening == 0 ? 0.06 : 0.4) * last.value) << stiffening;
  }
}

TEST(Forecast, HoldsTheUpperHalvesOfStiffeningCreepingFingersOnMounts) {
  constexpr int kFingers = 60;
  std::mt19937 generator(3);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
  };
  int values = 0, inside = 0;
  std::vector<double> widths;
  for (unsigned finger = 0; finger < kFingers; ++finger) {
    Readings lower, upper;
    lower.zero_m = upper.zero_m = uniform(0.05e-3, 0.5e-3);
    lower.compliance_m_per_N = upper.compliance_m_per_N = uniform(0, 1e-4);
    lower.std_m = upper.std_m = 0.02e-3;
    lower.largest_N = 3;
    lower.count = int(uniform(6, 15));
    upper.least_N = 3.2;
    upper.count = 8;
    lower.seed = 2 * finger;
    upper.seed = 2 * finger + 1;
    const double stiffening = uniform(0, 0.25), creep = uniform(0, 0.06);
    const auto depart = [&](Measurements measurements) {
      for (Measurement& value : measurements.values) {
        const double load_N = measurements.contacts[value.contact].load.normal_force_N;
        const double approach_m = hertz_m(load_N);
        value.value +=
            approach_m *
            ((1 - stiffening * approach_m / 5e-3) * (1 + creep * std::log1p(load_N)) - 1);
      }
      return measurements;
    };
    CalibrationProblem problem = lower.problem("fingertip_layer");
    problem.measurements = depart(problem.measurements);
    const Measurements asked = depart(upper.problem().measurements);
    EXPECT_FALSE(exponent_doubt(problem, nullptr).exists) << finger;
    const std::vector<Forecast> forecasts = forecast(problem, calibrate(problem), asked);
    for (std::size_t i = 0; i < forecasts.size(); ++i) {
      ASSERT_TRUE(forecasts[i].is_known);
      ++values;
      inside += forecasts[i].low() <= asked.values[i].value &&
                asked.values[i].value <= forecasts[i].high();
    }
    const Forecast& last = forecasts.back();
    widths.push_back((last.chance + last.misfit) / last.value);
  }
  EXPECT_GE(inside, 0.95 * values);
  // Hertz's travel grows by 59 % from half of the load to the whole: a band of a third of that on
  // either side still tells something.
  std::sort(widths.begin(), widths.end());
  EXPECT_LT(widths[widths.size() / 2], 0.2);
  std::printf("%d of %d inside; half width %.3f in the median, %.3f at most\n", inside, values,
              widths[widths.size() / 2], widths.back());
}

TEST(Forecast, IsNotKnownWhereTooFewValuesTellTheMisfit) {
  Readings few;
  few.count = 4;
  few.std_m = 0.01e-3;
  Readings above;
  above.least_N = 7;
  above.largest_N = 9;
  const CalibrationProblem problem = few.problem();
  for (const Forecast& one : forecast(problem, calibrate(problem), above.problem().measurements))
    EXPECT_FALSE(one.is_known);
}

TEST(ExponentDoubt, ExistsForASpringAndNotForASolid) {
  CalibrationProblem problem = Readings{}.problem();
  EXPECT_FALSE(exponent_doubt(problem, nullptr).exists);
  const Calibration found = calibrate(problem);
  EXPECT_FALSE(exponent_doubt(problem, &found).exists);
  for (Measurement& value : problem.measurements.values)
    value.value = 0.3e-3 + 1e-3 * problem.measurements.contacts[value.contact].load.normal_force_N;
  const ExponentDoubt spring = exponent_doubt(problem, nullptr);
  ASSERT_TRUE(spring.exists);
  EXPECT_NEAR(spring.measured.value, 1, 0.01);
  // A finger that begins to bear on something stiff: the force grows as the fourth power.
  for (Measurement& value : problem.measurements.values)
    value.value =
        0.3e-3 +
        2e-3 * std::pow(problem.measurements.contacts[value.contact].load.normal_force_N, 0.25);
  EXPECT_FALSE(exponent_doubt(problem, nullptr).exists);
  const Calibration stiff = calibrate(problem);
  EXPECT_TRUE(exponent_doubt(problem, &stiff).exists);
}

}  // namespace
}  // namespace softfinger
