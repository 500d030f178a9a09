#include <gtest/gtest.h>

#include <algorithm>
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

// A column of an incompressible layer cannot be pressed: no numbers come of it, nor any fit.
TEST(Calibration, RefusesAModelWithoutAnAnswer) {
  test::SyntheticCalibration synthetic = test::random_calibration(1);
  synthetic.problem.model = find_pressure_model("winkler");
  synthetic.problem.free = {Parameter::youngs_modulus};
  synthetic.problem.start[index_of(Parameter::poisson_ratio)] = 0.5;
  EXPECT_THROW(calibrate(synthetic.problem), InputError);
}

/// Measurements of this layer under eight loads up to the largest, each value off by its standard
/// deviation with alternating sign.
CalibrationProblem measured(const ElasticLayer& layer, double largest_N,
                            const std::vector<MeasuredQuantity>& quantities, double relative_std,
                            const std::vector<Parameter>& free) {
  CalibrationProblem problem;
  problem.model = find_pressure_model("fingertip_layer");
  problem.free = free;
  problem.start = {
      layer.youngs_modulus_Pa, layer.thickness_m, layer.poisson_ratio, 0.02, 0.8, 2e4, 1e-3, 0.3};
  ContactProblem contact;
  contact.radii = {0.02, 0.02, 0};
  contact.layer = layer;
  for (int i = 0; i < 8; ++i) {
    contact.load = {largest_N * std::pow(2., i - 7), 0.8};
    problem.measurements.contacts.push_back(contact);
    for (const MeasuredQuantity quantity : quantities)
      problem.measurements.values.push_back({quantity, std::size_t(i), 1, 0});
  }
  Eigen::VectorXd log_values;
  PredictedMeasurements{*problem.model, problem.measurements}.evaluate(problem.start, log_values,
                                                                       nullptr);
  for (std::size_t i = 0; i < problem.measurements.values.size(); ++i) {
    Measurement& value = problem.measurements.values[i];
    const bool is_less = (value.contact + std::size_t(value.quantity)) % 2 == 1;
    value.value =
        std::exp(log_values[Eigen::Index(i)]) * (1 + (is_less ? -relative_std : relative_std));
    value.std = relative_std * value.value;
  }
  return problem;
}

bool says(const std::vector<std::string>& sentences, const std::string& part) {
  for (const std::string& sentence : sentences)
    if (sentence.find(part) != std::string::npos) return true;
  return false;
}

std::string all_of(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += sentence + "\n";
  return text;
}

TEST(CalibrationAdvice, SaysThatAThickLayerShowsNoCore) {
  // 50 mm of rubber under contacts of half a millimetre.
  const CalibrationProblem problem = measured({0.05, 3e5, 0.48}, 0.01, {MeasuredQuantity::a}, 0.01,
                                              {Parameter::youngs_modulus, Parameter::thickness});
  const Calibration found = calibrate(problem);
  EXPECT_TRUE(found.parameters[1].is_high_open);
  EXPECT_LT(found.parameters[1].low, 0.05);
  const GrowthExponent growth = growth_exponent(problem, found);
  EXPECT_NEAR(growth.value, 1. / 3, 3 * growth.std);
  const std::vector<std::string> sentences = cannot_tell(problem, found);
  EXPECT_TRUE(says(sentences, "any value of the thickness above")) << all_of(sentences);
  EXPECT_TRUE(says(sentences, "like that of a body without a core (1/3)")) << all_of(sentences);
  EXPECT_FALSE(says(sentences, "E ")) << "E is determined";
}

TEST(CalibrationAdvice, SaysThatAThinIncompressibleLayerShowsOnlyTheStiffnessOfBoth) {
  // Contacts ten to twenty times as wide as the layer is thick, of which only the widths are
  // measured.
  const CalibrationProblem problem =
      measured({0.1e-3, 3e5, 0.499}, 10, {MeasuredQuantity::a}, 0.03,
               {Parameter::youngs_modulus, Parameter::thickness, Parameter::poisson_ratio});
  const Calibration found = calibrate(problem);
  const GrowthExponent growth = growth_exponent(problem, found);
  EXPECT_LT(growth.value, 0.2);
  const std::vector<std::string> sentences = cannot_tell(problem, found);
  ASSERT_FALSE(found.parameters[1].is_determined());
  EXPECT_TRUE(says(sentences, "like that of a thin incompressible layer (1/6)"))
      << all_of(sentences);
  // P ~ E a^6/h^3: only E/h³ shows.
  EXPECT_TRUE(says(sentences, "E and h are seen only together, as E h^-")) << all_of(sentences);
}

TEST(CalibrationAdvice, SaysNothingWhereEverythingIsKnown) {
  const CalibrationProblem problem =
      measured({3e-3, 3e5, 0.48}, 10, {MeasuredQuantity::a, MeasuredQuantity::indentation}, 0.01,
               {Parameter::youngs_modulus, Parameter::thickness});
  const Calibration found = calibrate(problem);
  EXPECT_TRUE(cannot_tell(problem, found).empty());
  EXPECT_EQ(contradiction(problem, found), "");
}

TEST(CalibrationAdvice, ProposesAMeasurementThatHelpsAsMuchAsItSays) {
  CalibrationProblem problem = measured({3e-3, 3e5, 0.48}, 10, {MeasuredQuantity::area}, 0.03,
                                        {Parameter::youngs_modulus, Parameter::poisson_ratio});
  const Calibration before = calibrate(problem);
  const NextMeasurement next = next_measurement(problem, before);
  ASSERT_TRUE(next.exists);
  EXPECT_EQ(next.parameter, Parameter::poisson_ratio) << "known worst";
  ASSERT_FALSE(next.is_thickness) << "which is known";
  const auto std_of = [&](const Calibration& found) {
    for (const ParameterEstimate& estimate : found.parameters)
      if (estimate.parameter == next.parameter) return estimate.std;  // of nu, absolute
    return std::nan("");
  };
  // Both numbers follow from the covariance.
  EXPECT_NEAR(std_of(before), next.std_now, 1e-6 * next.std_now);
  ContactProblem contact = problem.measurements.contacts.back();
  contact.load.normal_force_N = next.load_N;
  problem.measurements.contacts.push_back(contact);
  problem.measurements.values.push_back(
      {next.quantity, problem.measurements.contacts.size() - 1, 1, 0});
  Eigen::VectorXd log_values;
  PredictedMeasurements{*problem.model, problem.measurements}.evaluate(before.values, log_values,
                                                                       nullptr);
  Measurement& added = problem.measurements.values.back();
  added.value = std::exp(log_values[log_values.size() - 1]);
  added.std = next.relative_std * added.value;
  // The new value is just what was expected: the fit stays, and the covariance is as foretold.
  EXPECT_NEAR(std_of(calibrate(problem)), next.std_then, 0.02 * next.std_then);
  EXPECT_LT(next.std_then, 0.9 * next.std_now);
}

TEST(CalibrationAdvice, NamesWhatContradictsEveryModel) {
  CalibrationProblem problem = measured({3e-3, 3e5, 0.48}, 10, {MeasuredQuantity::a}, 0.01,
                                        {Parameter::youngs_modulus, Parameter::thickness});
  // A contact that shrinks as it is pressed.
  for (std::size_t i = 0; i < 8; ++i) {
    problem.measurements.values[i].value = 4e-3 * std::pow(0.8, double(i));
    problem.measurements.values[i].std = 0.01 * problem.measurements.values[i].value;
  }
  const std::string reason = contradiction(problem, calibrate(problem));
  EXPECT_EQ(reason.find("no model explains the data within their errors: a at "), 0u) << reason;
  EXPECT_NE(reason.find("sigma"), std::string::npos) << reason;
  for (Measurement& value : problem.measurements.values) value.std = 0;
  const std::string without = contradiction(problem, calibrate(problem));
  EXPECT_EQ(without.find("no model explains the data to better than "), 0u) << without;
}

TEST(CalibrationAdvice, LooksAtTheErrorsThatSomeValuesHave) {
  CalibrationProblem problem =
      measured({3e-3, 3e5, 0.48}, 10, {MeasuredQuantity::a, MeasuredQuantity::indentation}, 0.01,
               {Parameter::youngs_modulus, Parameter::thickness});
  for (Measurement& value : problem.measurements.values)
    if (value.quantity == MeasuredQuantity::indentation) value.std = 0;
  const Calibration good = calibrate(problem);
  EXPECT_EQ(contradiction(problem, good), "");
  EXPECT_EQ(good.error_factor, 1);
  EXPECT_NEAR(good.scatter[std::size_t(MeasuredQuantity::indentation)], 0.01, 0.004);
  // Widths that are stated a hundred times more exactly than they are.
  for (Measurement& value : problem.measurements.values) value.std *= 0.01;
  const Calibration bad = calibrate(problem);
  EXPECT_NEAR(std::log(bad.error_factor), std::log(100.), std::log(2.));
  const std::string reason = contradiction(problem, bad);
  EXPECT_EQ(reason.find("no model explains the data within their errors: a at "), 0u) << reason;
  EXPECT_EQ(reason.find("indentation"), std::string::npos) << reason;
}

TEST(Calibration, DoesNotCallDeterminedWhatEndsWhereTheSearchDid) {
  ParameterEstimate estimate{Parameter::thickness, 1, 0.1, 0.9, 1, false, true};
  EXPECT_FALSE(estimate.is_determined());
  estimate.is_high_open = false;
  EXPECT_TRUE(estimate.is_determined());
  const ParameterEstimate poisson_ratio{
      Parameter::poisson_ratio, 0.5, 1e-3, 0.49, 0.5, false, true};
  EXPECT_TRUE(poisson_ratio.is_determined()) << "its range ends there by itself";
}

TEST(Calibration, LeavesOutNoQuantityBecauseTheShearLawIsWrong) {
  // Few values of friction among many others: a wrong law's misfit is not theirs.
  CalibrationProblem problem = friction_under(ShearLaw::Kind::coulomb);
  auto& values = problem.measurements.values;
  values.erase(std::remove_if(values.begin(), values.end(),
                              [](const Measurement& value) {
                                return value.quantity == MeasuredQuantity::tangential_force ||
                                       (value.quantity == MeasuredQuantity::max_torque &&
                                        value.contact % 3 != 0);
                              }),
               values.end());
  const std::vector<Measurement> once = values;
  for (const Measurement& value : once)
    if (value.quantity == MeasuredQuantity::a) values.push_back(value);
  problem.shear_law = ShearLaw::Kind::shear_strength;
  problem.free = {Parameter::youngs_modulus, Parameter::thickness, Parameter::shear_strength};
  const Calibration found = calibrate(problem);
  std::size_t torques_left_out = 0;
  for (const std::size_t outlier : found.outliers)
    torques_left_out += values[outlier].quantity == MeasuredQuantity::max_torque;
  EXPECT_LE(torques_left_out, 1u) << "of three";
  EXPECT_EQ(compare_shear_laws(problem, found).front().shear_law, ShearLaw::Kind::coulomb);
}

TEST(CalibrationAdvice, FindsNoContradictionWhereAnotherModelHolds) {
  CalibrationProblem problem =
      measured({3e-3, 3e5, 0.48}, 10, {MeasuredQuantity::a, MeasuredQuantity::indentation}, 0.002,
               {Parameter::youngs_modulus});
  EXPECT_EQ(contradiction(problem, calibrate(problem)), "");
  problem.model = find_pressure_model("hertz");
  const Calibration by_hertz = calibrate(problem);
  EXPECT_LT(by_hertz.goodness, 1e-6);
  EXPECT_EQ(contradiction(problem, by_hertz), "") << "fingertip_layer made the data";
}

TEST(Calibration, KeepsTheRatioOfRadiiFittedToRegionsOfAMesh) {
  CalibrationProblem problem =
      measured({3e-3, 3e5, 0.48}, 10, {MeasuredQuantity::a}, 0.01, {Parameter::youngs_modulus});
  problem.measurements.contacts[3].radii = {0.03, 0.02, 0};
  const PredictedMeasurements predicted{*problem.model, problem.measurements};
  EXPECT_EQ(predicted.problem(3, problem.start).radii.major_m, 0.03) << "as they are";
  problem.start[index_of(Parameter::radius)] *= 2;
  EXPECT_DOUBLE_EQ(predicted.problem(3, problem.start).radii.major_m, 0.06);
  EXPECT_DOUBLE_EQ(predicted.problem(0, problem.start).radii.major_m, 0.04);
}

}  // namespace
}  // namespace softfinger
