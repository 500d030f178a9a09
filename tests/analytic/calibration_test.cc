#include <gtest/gtest.h>

#include <cmath>

#include "softfinger/calibration/advice.h"
#include "softfinger/calibration/statistics.h"
#include "softfinger/input/errors.h"
#include "tests/analytic/synthetic_measurements.h"

namespace softfinger {
namespace {

// Tables of Abramowitz and Stegun, 26.10 and 26.8, to their digits.
TEST(Statistics, HasTheTabulatedQuantiles) {
  EXPECT_NEAR(statistics::student_quantile(0.05, 1), 12.706, 5e-4);
  EXPECT_NEAR(statistics::student_quantile(0.05, 2), 4.303, 5e-4);
  EXPECT_NEAR(statistics::student_quantile(0.05, 5), 2.571, 5e-4);
  EXPECT_NEAR(statistics::student_quantile(0.05, 10), 2.228, 5e-4);
  EXPECT_NEAR(statistics::student_quantile(0.01, 30), 2.750, 5e-4);
  EXPECT_NEAR(statistics::student_quantile(0.05, std::numeric_limits<double>::infinity()), 1.95996,
              1e-5);
  EXPECT_NEAR(statistics::chi_squared_exceeds(3.84146, 1), 0.05, 1e-6);
  EXPECT_NEAR(statistics::chi_squared_exceeds(5.99146, 2), 0.05, 1e-6);
  EXPECT_NEAR(statistics::chi_squared_exceeds(11.0705, 5), 0.05, 1e-6);
  EXPECT_NEAR(statistics::chi_squared_exceeds(18.3070, 10), 0.05, 1e-6);
}

// `calibration_bench` does the same with ten thousand sets.
TEST(Calibration, SaysWhatItKnowsWithTheConfidenceItStates) {
  constexpr int kSets = 200;
  int determined = 0, covered = 0, undetermined = 0, undetermined_covered = 0;
  for (unsigned set = 0; set < kSets; ++set) {
    const test::SyntheticCalibration synthetic = test::random_calibration(set);
    const Calibration found = calibrate(synthetic.problem);
    for (const ParameterEstimate& estimate : found.parameters) {
      const double truth = synthetic.truth[index_of(estimate.parameter)];
      const bool is_covered = estimate.low <= truth && truth <= estimate.high;
      ++(estimate.is_determined() ? determined : undetermined);
      (estimate.is_determined() ? covered : undetermined_covered) += is_covered;
      EXPECT_GE(estimate.value, estimate.low);
      EXPECT_LE(estimate.value, estimate.high);
    }
  }
  // 95 %, less four standard deviations of that many intervals.
  const auto least = [](int count) { return 0.95 - 4 * std::sqrt(0.95 * 0.05 / count); };
  ASSERT_GT(determined, 300);
  ASSERT_GT(undetermined, 60);
  EXPECT_GT(double(covered) / determined, least(determined));
  EXPECT_GT(double(undetermined_covered) / undetermined, least(undetermined));
}

TEST(Calibration, FindsAnOutlierAndSaysWhich) {
  unsigned seed = 0;
  test::SyntheticCalibration synthetic = test::random_calibration(seed);
  while (synthetic.outliers > 0 || synthetic.noise > 0.02 ||
         synthetic.problem.measurements.values.size() < 20)
    synthetic = test::random_calibration(++seed);
  synthetic.problem.measurements.values[7].value *= 2;
  const Calibration found = calibrate(synthetic.problem);
  EXPECT_TRUE(found.is_outlier(7));
}

/// A round finger's contacts with friction, as the law has it, without noise but for a tenth of a
/// per cent, alternating.
CalibrationProblem friction_under(ShearLaw::Kind law) {
  CalibrationProblem problem = test::random_calibration(0).problem;
  problem.measurements = {};
  problem.shear_law = law;
  ContactProblem contact;
  contact.radii = {0.02, 0.02, 0};
  contact.layer = {3e-3, 3e5, 0.48};
  problem.start = {3e5, 3e-3, 0.48, 0.02, 0.8, 2e4, 1e-3, 0.3};
  for (int i = 0; i < 8; ++i) {
    contact.load.normal_force_N = 0.3 * std::pow(1.5, i);
    problem.measurements.contacts.push_back(contact);
    for (const MeasuredQuantity quantity :
         {MeasuredQuantity::a, MeasuredQuantity::max_torque, MeasuredQuantity::tangential_force})
      problem.measurements.values.push_back({quantity, std::size_t(i), 1, 0});
  }
  Eigen::VectorXd log_values;
  PredictedMeasurements{*problem.model, problem.measurements, law}.evaluate(problem.start,
                                                                            log_values, nullptr);
  for (std::size_t i = 0; i < problem.measurements.values.size(); ++i)
    problem.measurements.values[i].value =
        std::exp(log_values[Eigen::Index(i)]) * (i % 2 == 0 ? 1.001 : 0.999);
  problem.free = {Parameter::youngs_modulus, Parameter::thickness};
  if (ShearLaw{law}.has_friction_coefficient())
    problem.free.push_back(Parameter::friction_coefficient);
  if (ShearLaw{law}.has_shear_strength()) problem.free.push_back(Parameter::shear_strength);
  return problem;
}

TEST(Calibration, TellsCoulombFrictionFromAConstantStrength) {
  for (const ShearLaw::Kind law : {ShearLaw::Kind::coulomb, ShearLaw::Kind::shear_strength}) {
    const CalibrationProblem problem = friction_under(law);
    const std::vector<Comparison> laws = compare_shear_laws(problem, calibrate(problem));
    ASSERT_FALSE(laws.empty());
    // A law with both parameters contains it and may only tie, at the price of a parameter.
    EXPECT_EQ(laws.front().shear_law, law);
  }
}

TEST(Calibration, FindsThatOnlyALayerExplainsALayer) {
  const CalibrationProblem problem = friction_under(ShearLaw::Kind::coulomb);
  const std::vector<Comparison> models = compare_models(problem, calibrate(problem));
  ASSERT_FALSE(models.empty());
  EXPECT_EQ(models.front().model->card().name, "fingertip_layer");
}

TEST(Calibration, RefusesFewerMeasurementsThanItNeeds) {
  test::SyntheticCalibration synthetic = test::random_calibration(1);
  synthetic.problem.measurements.values.resize(synthetic.problem.free.size());
  EXPECT_THROW(calibrate(synthetic.problem), InputError);
}

}  // namespace
}  // namespace softfinger
