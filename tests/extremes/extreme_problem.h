#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "softfinger/pressure/pressure_model.h"

/// Random contacts far beyond any fingertip, and comparisons of their predictions.
namespace softfinger::testing {

class ExtremeProblems {
 public:
  /// @param thinnest  smallest thickness of a layer, divided by the radius that the contact would
  /// have on a half-space
  explicit ExtremeProblems(unsigned seed, double thinnest = 1e-9)
      : random_(seed), thinnest_(thinnest) {}

  double uniform(double lowest, double highest) {
    return std::uniform_real_distribution<double>(lowest, highest)(random_);
  }

  double log_uniform(double lowest, double highest) {
    return lowest * std::exp(uniform(0, 1) * std::log(highest / lowest));
  }

  bool one_in(int n) { return random_() % static_cast<unsigned>(n) == 0; }

  /// A random problem: radii of 1 micrometre to 1 km, R'/R'' exactly 1 or up to 1e8, loads of 1e-12
  /// to 1e9 N, friction coefficients of 1e-12 to 1e3, Poisson's ratios of 0 to 1/2 with 0, 1/2 and
  /// their neighbours in one of three, layers of 1e-9 to 1e6 times the contact's radius on a
  /// half-space. One problem of five has a compliant object.
  ContactProblem draw() {
    ContactProblem problem;
    problem.radii.minor_m = log_uniform(1e-6, 1e3);
    problem.radii.major_m = problem.radii.minor_m * (one_in(6) ? 1 : log_uniform(1, 1e8));
    problem.load = {log_uniform(1e-12, 1e9), log_uniform(1e-12, 1e3)};
    problem.layer = draw_layer(problem);
    if (one_in(5)) problem.object_layer = draw_layer(problem);
    if (one_in(4)) problem.options.winkler_modulus = WinklerModulus::youngs;
    problem.options.power_law = {log_uniform(1e-9, 1e3), uniform(0.02, 0.6), log_uniform(1, 50)};
    return problem;
  }

  /// A problem in which one or two numbers are replaced by extreme or invalid ones: subnormal,
  /// huge, infinite, 0, -1, NaN. A model may answer or not, but each number that it returns is
  /// finite.
  ContactProblem draw_broken() {
    static const double values[] = {5e-324,
                                    1e-310,
                                    std::numeric_limits<double>::min(),
                                    1e-200,
                                    1e200,
                                    std::numeric_limits<double>::max(),
                                    std::numeric_limits<double>::infinity(),
                                    -1,
                                    0,
                                    std::nan("")};
    ContactProblem problem = draw();
    double* const fields[] = {&problem.radii.major_m,
                              &problem.radii.minor_m,
                              &problem.layer.thickness_m,
                              &problem.layer.youngs_modulus_Pa,
                              &problem.layer.poisson_ratio,
                              &problem.object_layer.thickness_m,
                              &problem.object_layer.youngs_modulus_Pa,
                              &problem.object_layer.poisson_ratio,
                              &problem.load.normal_force_N,
                              &problem.load.friction_coefficient,
                              &problem.options.power_law.radius_coefficient,
                              &problem.options.power_law.radius_exponent,
                              &problem.options.power_law.pressure_exponent};
    *fields[random_() % std::size(fields)] = values[random_() % std::size(values)];
    if (one_in(2)) *fields[random_() % std::size(fields)] = values[random_() % std::size(values)];
    return problem;
  }

 private:
  ElasticLayer draw_layer(const ContactProblem& problem) {
    static const double special_ratios[] = {0, 1e-16, 0.3, 0.4999999, std::nextafter(0.5, 0), 0.5};
    ElasticLayer layer;
    layer.youngs_modulus_Pa = log_uniform(1e-1, 1e13);
    layer.poisson_ratio = one_in(3) ? special_ratios[random_() % 6] : uniform(0, 0.5);
    const double R = std::sqrt(problem.radii.major_m) * std::sqrt(problem.radii.minor_m);
    const double contact_m = std::cbrt(problem.load.normal_force_N / layer.youngs_modulus_Pa * R);
    layer.thickness_m = contact_m * log_uniform(thinnest_, 1e6);
    return layer;
  }

  std::mt19937_64 random_;
  double thinnest_;
};

/// The problem in other units: lengths times `length`, forces times `force`.
inline ContactProblem in_units(const ContactProblem& problem, double length, double force) {
  ContactProblem scaled = problem;
  scaled.radii.major_m *= length;
  scaled.radii.minor_m *= length;
  for (ElasticLayer* layer : {&scaled.layer, &scaled.object_layer}) {
    layer->thickness_m *= length;
    layer->youngs_modulus_Pa *= force / (length * length);
  }
  scaled.load.normal_force_N *= force;
  PowerLaw& law = scaled.options.power_law;
  law.radius_coefficient *= length / std::pow(force, law.radius_exponent);
  return scaled;
}

/// The largest relative difference between the numbers of two predictions; `other` is in other
/// units.
inline double difference(const Prediction& one, const Prediction& other, double length = 1,
                         double force = 1) {
  double worst = 0;
  const auto compare = [&](double a, double b) { worst = std::max(worst, std::abs(b / a - 1)); };
  compare(one.a_m * length, other.a_m);
  compare(one.b_m * length, other.b_m);
  compare(one.indentation_m * length, other.indentation_m);
  compare(one.peak_pressure_Pa * (force / (length * length)), other.peak_pressure_Pa);
  compare(one.torque_arm_exact_m * length, other.torque_arm_exact_m);
  compare(one.torque_arm_paper_m * length, other.torque_arm_paper_m);
  return worst;
}

/// The problem as text that can be pasted into a program.
inline std::string in_words(const ContactProblem& problem) {
  char text[400];
  std::snprintf(
      text, sizeof text,
      "{{%.17g, %.17g}, {%.17g, %.17g, %.17g}, {%.17g, %.3g}, {%.17g, %.17g, %.17g}, "
      "{youngs %d, {%.17g, %.17g, %.17g}}}",
      problem.radii.major_m, problem.radii.minor_m, problem.layer.thickness_m,
      problem.layer.youngs_modulus_Pa, problem.layer.poisson_ratio, problem.load.normal_force_N,
      problem.load.friction_coefficient, problem.object_layer.thickness_m,
      problem.object_layer.youngs_modulus_Pa, problem.object_layer.poisson_ratio,
      problem.options.winkler_modulus == WinklerModulus::youngs,
      problem.options.power_law.radius_coefficient, problem.options.power_law.radius_exponent,
      problem.options.power_law.pressure_exponent);
  return text;
}

/// A model's name as a test's.
inline std::string model_test_name(
    const ::testing::TestParamInfo<const PressureModel*>& information) {
  return std::string(information.param->card().name);
}

}  // namespace softfinger::testing
