// Derivatives of every fast model against differences, by the bodies' radii, and their cost.
#include "softfinger/pressure/gradient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "softfinger/geometry/relative_curvature.h"
#include "softfinger/input/constants.h"
#include "softfinger/layer/stuck_stiffness.h"
#include "softfinger/pressure/rubbed_prediction.h"
#include "tests/allocation_counter.h"

namespace softfinger {
namespace {

class Draws {
 public:
  explicit Draws(unsigned seed) : generator_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * double(generator_() >> 11) * 0x1p-53;
  }

 private:
  std::mt19937_64 generator_;
};

ContactProblem random_problem(Draws& draws) {
  ContactProblem problem;
  const double minor_m = 0.01;
  problem.radii = {minor_m * std::exp(draws.between(0.05, 3)), minor_m, 0};
  problem.layer = {0.002 * std::exp(draws.between(-1, 1)), 3e5, draws.between(0.01, 0.495)};
  problem.load = {std::exp(draws.between(-4, 2)), 0.7};
  problem.finger_curvature = {draws.between(0, 1.3) / problem.radii.major_m,
                              draws.between(0, 1.3) / minor_m, draws.between(-0.2, 0.2) / minor_m};
  problem.options.power_law = {0.002, 0.3, 2.5};
  return problem;
}

std::array<double*, kContactVariables> variables_of(ContactProblem& problem) {
  return {&problem.load.normal_force_N,
          &problem.layer.poisson_ratio,
          &problem.layer.thickness_m,
          &problem.radii.major_m,
          &problem.radii.minor_m,
          &problem.finger_curvature.xx_per_m,
          &problem.finger_curvature.yy_per_m,
          &problem.finger_curvature.xy_per_m,
          &problem.layer.youngs_modulus_Pa};
}

constexpr int kNumbers = 9;
std::array<double, kNumbers> numbers_of(const PressureModel& model, const ContactProblem& problem) {
  const PredictionWithGradient found = predict_with_gradient(model, problem);
  const Prediction& p = found.prediction;
  return {p.a_m,
          p.b_m,
          p.indentation_m,
          p.area_m2(),
          p.peak_pressure_Pa,
          p.torque_arm_exact_m,
          p.torque_arm_paper_m,
          found.gradient.stuck.torsional_Nm_per_rad,
          found.gradient.stuck.tangential_x_N_per_m};
}

std::array<const Derivatives*, kNumbers> derivatives_of(const PredictionGradient& gradient) {
  return {&gradient.a_m,
          &gradient.b_m,
          &gradient.indentation_m,
          &gradient.area_m2,
          &gradient.peak_pressure_Pa,
          &gradient.torque_arm_exact_m,
          &gradient.torque_arm_paper_m,
          &gradient.torsional_stiffness_Nm_per_rad,
          &gradient.tangential_stiffness_x_N_per_m};
}

/// Sixth-order differences. The tables are splines whose third derivative jumps at knots: of two
/// steps the better one counts, because a knot may lie within the wider. Left is the round-off of
/// a number over the step, 1e-16/2e-4, and more where Hertz's ellipse is iterated (1e-15).
constexpr double kTolerance = 1e-9;

TEST(Gradient, IsThatOfDifferences) {
  for (const PressureModel* model : all_pressure_models()) {
    if (!model->card().hot_path) continue;
    const std::string name(model->card().name);
    Draws draws(11);
    double worst = 0;
    for (int i = 0; i < 200; ++i) {
      ContactProblem problem = random_problem(draws);
      // Two corrections of finite_strain_layer end with a kink, of which differences know nothing.
      if (name == "finite_strain_layer" &&
          (std::abs(problem.layer.poisson_ratio - 0.3) < 0.01 || problem.load.normal_force_N > 0.5))
        continue;
      const PredictionGradient gradient = predict_with_gradient(*model, problem).gradient;
      ASSERT_TRUE(gradient.known) << name;
      const auto here = numbers_of(*model, problem);
      const auto derivatives = derivatives_of(gradient);
      const auto variables = variables_of(problem);
      for (int v = 0; v < kContactVariables; ++v) {
        const double value = *variables[std::size_t(v)];
        const bool is_curvature = v >= kFingerCurvatureX && v <= kFingerCurvatureXY;
        const double scale = v == kPoissonRatio ? std::min(value, 0.5 - value)
                             : is_curvature     ? 100
                                                : value;
        std::array<double, kNumbers> least;
        least.fill(1e300);
        for (const double relative_step : {1e-3, 2e-4}) {
          const double step = relative_step * scale;
          const auto at = [&](int steps) {
            *variables[std::size_t(v)] = value + steps * step;
            const auto found = numbers_of(*model, problem);
            *variables[std::size_t(v)] = value;
            return found;
          };
          const auto p1 = at(1), p2 = at(2), p3 = at(3), m1 = at(-1), m2 = at(-2), m3 = at(-3);
          for (std::size_t n = 0; n < kNumbers; ++n) {
            const double difference =
                (45 * (p1[n] - m1[n]) - 9 * (p2[n] - m2[n]) + p3[n] - m3[n]) / (60 * step);
            least[n] =
                std::min(least[n], std::abs(difference - derivatives[n]->by[std::size_t(v)]) *
                                       scale / here[n]);
          }
        }
        for (std::size_t n = 0; n < kNumbers; ++n) {
          EXPECT_LT(least[n], kTolerance) << name << ", number " << n << " by " << v << " of " << i;
          worst = std::max(worst, least[n]);
        }
      }
      if (::testing::Test::HasFailure()) return;
    }
    std::printf("%s: worst derivative, relative: %.1e\n", name.c_str(), worst);
  }
}

/// Numbers of a contact that is pressed with friction.
constexpr int kRubbedNumbers = 8;
using RubbedNumbers = std::array<double, kRubbedNumbers>;
RubbedNumbers rubbed_numbers_of(const PressureModel& model, const ContactProblem& problem,
                                double mu) {
  const Prediction p = rubbed(model, model.predict(problem), problem, mu);
  const ElasticLayer& layer = problem.layer;
  const StuckStiffness stuck = stuck_stiffness(p.a_m, p.b_m, layer.thickness_m,
                                               layer.youngs_modulus_Pa, layer.poisson_ratio);
  return {p.a_m,
          p.b_m,
          p.indentation_m,
          p.area_m2(),
          p.peak_pressure_Pa,
          p.torque_arm_exact_m,
          stuck.torsional_Nm_per_rad,
          stuck.tangential_x_N_per_m};
}

TEST(Gradient, OfPressingWithFrictionIsThatOfDifferences) {
  for (const char* name : {"bonded_layer", "fingertip_layer"}) {
    const PressureModel& model = *find_pressure_model(name);
    Draws draws(23);
    for (int i = 0; i < 200; ++i) {
      ContactProblem problem = random_problem(draws);
      double mu = std::exp(draws.between(-4, 1));
      const PredictionGradient gradient =
          rubbed(model, predict_with_gradient(model, problem), problem, mu).gradient;
      const auto here = rubbed_numbers_of(model, problem, mu);
      const std::array<const Derivatives*, kRubbedNumbers> derivatives = {
          &gradient.a_m,
          &gradient.b_m,
          &gradient.indentation_m,
          &gradient.area_m2,
          &gradient.peak_pressure_Pa,
          &gradient.torque_arm_exact_m,
          &gradient.torsional_stiffness_Nm_per_rad,
          &gradient.tangential_stiffness_x_N_per_m};
      // 1 - 4 (1 - 2 nu) in the ratios ends with a kink about nu = 3/8, where differences tell
      // nothing.
      if (std::abs(problem.layer.poisson_ratio - 0.376) < 0.008) continue;
      const auto compare = [&](double& variable, double scale, auto derivative_of) {
        const double value = variable;
        RubbedNumbers least;
        least.fill(1e300);
        for (const double step : {1e-3 * scale, 2e-4 * scale}) {
          const auto at = [&](int steps) {
            variable = value + steps * step;
            const auto found = rubbed_numbers_of(model, problem, mu);
            variable = value;
            return found;
          };
          const auto p1 = at(1), p2 = at(2), p3 = at(3), m1 = at(-1), m2 = at(-2), m3 = at(-3);
          for (std::size_t n = 0; n < kRubbedNumbers; ++n) {
            const double difference =
                (45 * (p1[n] - m1[n]) - 9 * (p2[n] - m2[n]) + p3[n] - m3[n]) / (60 * step);
            least[n] = std::min(
                least[n], std::abs(difference - derivative_of(*derivatives[n])) * scale / here[n]);
          }
        }
        for (std::size_t n = 0; n < kRubbedNumbers; ++n)
          EXPECT_LT(least[n], kTolerance) << name << n << " " << i;
      };
      const auto variables = variables_of(problem);
      for (int v = 0; v < kContactVariables; ++v) {
        const double value = *variables[std::size_t(v)];
        const bool is_curvature = v >= kFingerCurvatureX && v <= kFingerCurvatureXY;
        const double scale = v == kPoissonRatio ? std::min(value, 0.5 - value)
                             : is_curvature     ? 100
                                                : value;
        compare(*variables[std::size_t(v)], scale,
                [v](const Derivatives& of) { return of.by[std::size_t(v)]; });
      }
      compare(mu, mu, [](const Derivatives& of) { return of.by_friction_coefficient; });
      if (::testing::Test::HasFailure()) return;
    }
  }
}

TEST(Gradient, OfPressingThatSticksIsFiniteAndWithoutFriction) {
  Draws draws(29);
  const PressureModel& model = *find_pressure_model("fingertip_layer");
  for (const double nu : {0., 0.3, 0.49, 0.5}) {
    ContactProblem problem = random_problem(draws);
    problem.layer.poisson_ratio = nu;
    const PredictionWithGradient found =
        rubbed(model, predict_with_gradient(model, problem), problem, kInfinity);
    const PredictionGradient nearly =
        rubbed(model, predict_with_gradient(model, problem), problem, 1e6).gradient;
    EXPECT_EQ(found.gradient.indentation_m.by_friction_coefficient, 0);
    for (std::size_t v = 0; v < kContactVariables; ++v) {
      EXPECT_TRUE(std::isfinite(found.gradient.indentation_m.by[v])) << nu << " " << v;
      EXPECT_EQ(found.gradient.peak_pressure_Pa.by[v], nearly.peak_pressure_Pa.by[v]);
    }
    EXPECT_GT(found.gradient.normal_stiffness_N_per_m(), 0);
  }
}

TEST(Gradient, ComesWithTheBitsOfThePrediction) {
  Draws draws(17);
  for (int i = 0; i < 1000; ++i) {
    const ContactProblem problem = random_problem(draws);
    for (const char* name : {"bonded_layer", "fingertip_layer"}) {
      const PressureModel& model = *find_pressure_model(name);
      const Prediction alone = model.predict(problem);
      const Prediction with = predict_with_gradient(model, problem).prediction;
      ASSERT_EQ(with.a_m, alone.a_m) << name;
      ASSERT_EQ(with.b_m, alone.b_m) << name;
      ASSERT_EQ(with.indentation_m, alone.indentation_m) << name;
      ASSERT_EQ(with.peak_pressure_Pa, alone.peak_pressure_Pa) << name;
      ASSERT_EQ(with.torque_arm_exact_m, alone.torque_arm_exact_m) << name;
      ASSERT_EQ(with.torque_arm_paper_m, alone.torque_arm_paper_m) << name;
      ASSERT_EQ(with.valid(), alone.valid()) << name;
    }
  }
}

TEST(Gradient, OfTheLargestTorqueKnowsFriction) {
  Draws draws(3);
  const ContactProblem problem = random_problem(draws);
  const auto [prediction, gradient] =
      predict_with_gradient(*find_pressure_model("bonded_layer"), problem);
  const double P = problem.load.normal_force_N, mu = problem.load.friction_coefficient;
  EXPECT_DOUBLE_EQ(gradient.max_torque_Nm.by_friction_coefficient,
                   P * prediction.torque_arm_exact_m);
  EXPECT_NEAR(
      gradient.max_torque_Nm.by[kNormalForce],
      mu * (prediction.torque_arm_exact_m + P * gradient.torque_arm_exact_m.by[kNormalForce]),
      1e-15);
}

TEST(Gradient, TellsHowStiffTheContactIs) {
  // Hertz between a sphere and a plane: P ~ d^(3/2), so dP/dd = 1.5 P/d.
  ContactProblem problem;
  problem.radii = {0.01, 0.01, 0};
  problem.layer = {1, 3e5, 0.3};
  problem.load = {1, 0.5};
  const auto [prediction, gradient] = predict_with_gradient(*find_pressure_model("hertz"), problem);
  EXPECT_NEAR(gradient.normal_stiffness_N_per_m(), 1.5 / prediction.indentation_m,
              1e-10 * gradient.normal_stiffness_N_per_m());
  // On so thick a layer the stuck disc is that of a half-space: 16 G a³/3 and 8 G a/(2 - nu).
  const double G = problem.layer.shear_modulus_Pa(), a = prediction.a_m;
  EXPECT_NEAR(gradient.stuck.torsional_Nm_per_rad / (16 * G * a * a * a / 3), 1, 1e-5);
  EXPECT_NEAR(gradient.stuck.tangential_x_N_per_m / (8 * G * a / 1.7), 1, 0.01);
}

TEST(Gradient, IsUnknownWhereThereIsNone) {
  Draws draws(3);
  ContactProblem problem = random_problem(draws);
  EXPECT_FALSE(
      predict_with_gradient(*find_pressure_model("layer_fredholm"), problem).gradient.known);
  problem.object_layer = problem.layer;
  EXPECT_FALSE(predict_with_gradient(*find_pressure_model("bonded_layer"), problem).gradient.known);
  problem.object_layer = {};
  problem.layer.poisson_ratio = 0.6;
  EXPECT_FALSE(predict_with_gradient(*find_pressure_model("bonded_layer"), problem).gradient.known);
}

/// @return torque arm and indentation for two bodies
std::array<double, 2> of_bodies(const PressureModel& model, ContactProblem problem,
                                const BodyRadii& bodies) {
  EXPECT_TRUE(set_bodies(bodies, problem));
  const Prediction found = model.predict(problem);
  return {found.torque_arm_exact_m, found.indentation_m};
}

TEST(BodyRadii, GiveTheGapOfTheGeneralFunction) {
  Draws draws(8);
  for (int i = 0; i < 200; ++i) {
    const BodyRadii bodies = {0.02 * draws.between(0.5, 2), 0.01 * draws.between(0.5, 2),
                              i % 3 == 0 ? kInfinity : -0.05 * draws.between(1, 3),
                              0.03 * draws.between(0.5, 2), draws.between(-3, 3)};
    ContactProblem problem;
    ASSERT_TRUE(set_bodies(bodies, problem));
    const RelativeCurvature general = relative_curvature(
        quadric_from_radii(bodies.finger_x_m, bodies.finger_y_m), Eigen::Matrix3d::Zero(),
        quadric_from_radii(bodies.object_x_m, bodies.object_y_m), Eigen::Matrix3d::Zero(),
        bodies.angle_rad);
    ASSERT_EQ(general.kind, ContactKind::elliptic);
    EXPECT_NEAR(problem.radii.major_m, general.radii.major_m, 1e-10 * general.radii.major_m);
    EXPECT_NEAR(problem.radii.minor_m, general.radii.minor_m, 1e-10 * general.radii.minor_m);
    const SurfaceCurvature finger =
        curvature_along(bodies.finger_x_m, bodies.finger_y_m, general.radii.axis_rad);
    // Both ends of the long axis are the same one.
    EXPECT_NEAR(std::remainder(problem.radii.axis_rad - general.radii.axis_rad, kPi), 0, 1e-9);
    EXPECT_NEAR(problem.finger_curvature.xx_per_m, finger.xx_per_m, 1e-7);
    EXPECT_NEAR(problem.finger_curvature.yy_per_m, finger.yy_per_m, 1e-7);
    EXPECT_NEAR(problem.finger_curvature.xy_per_m, finger.xy_per_m, 1e-7);
  }
  ContactProblem saddle;
  EXPECT_FALSE(set_bodies({0.01, 0.01, -0.005, kInfinity, 0}, saddle));
}

TEST(BodyRadii, CarryDerivatives) {
  const PressureModel& model = *find_pressure_model("fingertip_layer");
  Draws draws(21);
  for (int i = 0; i < 100; ++i) {
    ContactProblem problem = random_problem(draws);
    BodyRadii bodies = {0.02 * draws.between(0.8, 1.4), 0.01 * draws.between(0.8, 1.4),
                        (i % 2 ? -0.06 : 0.06) * draws.between(0.8, 1.4),
                        0.03 * draws.between(0.8, 1.4), draws.between(0.1, 1.4)};
    ASSERT_TRUE(set_bodies(bodies, problem));
    const PredictionGradient gradient = predict_with_gradient(model, problem).gradient;
    ASSERT_TRUE(gradient.known);
    const BodyDerivatives arm = by_body_radii(gradient.torque_arm_exact_m, bodies);
    const BodyDerivatives depth = by_body_radii(gradient.indentation_m, bodies);
    const auto here = of_bodies(model, problem, bodies);
    const std::array<double BodyRadii::*, 5> fields = {
        &BodyRadii::finger_x_m, &BodyRadii::finger_y_m, &BodyRadii::object_x_m,
        &BodyRadii::object_y_m, &BodyRadii::angle_rad};
    const std::array<double BodyDerivatives::*, 5> told = {
        &BodyDerivatives::finger_radius_x_m, &BodyDerivatives::finger_radius_y_m,
        &BodyDerivatives::object_radius_x_m, &BodyDerivatives::object_radius_y_m,
        &BodyDerivatives::angle_rad};
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const double value = bodies.*fields[f], scale = std::abs(value);
      std::array<double, 2> least = {1e300, 1e300};
      for (const double relative_step : {1e-3, 2e-4}) {
        const double step = relative_step * scale;
        const auto at = [&](int steps) {
          BodyRadii moved = bodies;
          moved.*fields[f] = value + steps * step;
          return of_bodies(model, problem, moved);
        };
        const auto p1 = at(1), p2 = at(2), p3 = at(3), m1 = at(-1), m2 = at(-2), m3 = at(-3);
        for (std::size_t n = 0; n < 2; ++n) {
          const double difference =
              (45 * (p1[n] - m1[n]) - 9 * (p2[n] - m2[n]) + p3[n] - m3[n]) / (60 * step);
          const double derivative = n == 0 ? arm.*told[f] : depth.*told[f];
          least[n] = std::min(least[n], std::abs(difference - derivative) * scale / here[n]);
        }
      }
      EXPECT_LT(std::max(least[0], least[1]), kTolerance) << "radius " << f << " of " << i;
    }
  }
}

TEST(Gradient, NeverAllocates) {
  Draws draws(3);
  const ContactProblem problem = random_problem(draws);
  const PressureModel& model = *find_pressure_model("fingertip_layer");
  predict_with_gradient(model, problem);
  const std::size_t before = testing::allocations();
  EXPECT_TRUE(predict_with_gradient(model, problem).gradient.known);
  EXPECT_EQ(testing::allocations(), before);
}

}  // namespace
}  // namespace softfinger
