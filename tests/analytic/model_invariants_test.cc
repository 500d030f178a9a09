// Invariants of every pressure model of the registry, whatever its equations. A new model is tested
// here as soon as its file exists.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "finite_prediction.h"
#include "quadrature.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

using testing::is_sound;

/// `value` between `lowest` and `highest`, uniform in its logarithm, as a RapidCheck generator.
rc::Gen<double> log_uniform(double lowest, double highest) {
  constexpr int kSteps = 1 << 30;
  return rc::gen::map(rc::gen::inRange(0, kSteps + 1), [=](int step) {
    return lowest * std::pow(highest / lowest, double(step) / kSteps);
  });
}

/// Problems of fingertip size: micrometres to decimetres, gels to rubber, all Poisson's ratios.
rc::Gen<ContactProblem> fingertip_problem() {
  return rc::gen::apply(
      [](double R2, double ratio, double h, double E, double nu, double P) {
        ContactProblem problem{{R2 * ratio, R2}, {h, E, nu}, {P, 0.8}};
        problem.options.power_law = {0.003, 0.3, 2.5};
        return problem;
      },
      log_uniform(1e-3, 0.1), log_uniform(1, 1e4), log_uniform(1e-4, 0.05), log_uniform(1e4, 1e7),
      rc::gen::map(rc::gen::inRange(0, 1001), [](int step) { return step * 0.0005; }),
      log_uniform(1e-3, 1e2));
}

void assert_close(double value, double reference, double tolerance) {
  RC_ASSERT(std::abs(value - reference) <= tolerance * std::abs(reference));
}

/// The models of the registry; those that are not made for inner loops only every `period`-th time.
std::vector<const PressureModel*> models_in_turn(int period) {
  static int turn = 0;
  std::vector<const PressureModel*> models;
  const bool all = ++turn % period == 0;
  for (const PressureModel* model : all_pressure_models())
    if (all || model->card().hot_path) models.push_back(model);
  return models;
}

/// Models that take milliseconds are asked at every `period`-th point only.
bool is_asked(const PressureModel& model, int point, int period) {
  return model.card().hot_path || point % period == 0;
}

/// A contact of 3 mm on a layer of 2 mm, unless a test says otherwise.
ContactProblem soft_pad(double load_N, double friction_coefficient) {
  ContactProblem problem{{0.02, 0.02}, {2e-3, 3e5, 0.45}, {load_N, friction_coefficient}};
  problem.options.power_law = {0.003, 0.3, 2.5};
  return problem;
}

TEST(PressureModels, HaveNoAnswerWhoseTorqueIsNoNormalNumber) {
  for (const PressureModel* model : all_pressure_models()) {
    for (const auto& [load_N, friction] :
         {std::pair{1e-300, 0.5}, std::pair{1e-10, 1e-300}, std::pair{1., 1e-307},
          std::pair{1., 5e-324}, std::pair{1e10, 1e308}}) {
      const Prediction prediction = model->predict(soft_pad(load_N, friction));
      const double torque_Nm = friction * load_N * prediction.torque_arm_exact_m;
      EXPECT_TRUE(!prediction.has_answer || std::isnormal(torque_Nm))
          << model->card().name << " at " << load_N << " N, mu " << friction << ": " << torque_Nm;
      EXPECT_TRUE(is_sound(prediction)) << model->card().name;
    }
    for (const double nonsense : {-0.5, double(NAN), double(INFINITY)}) {
      const Prediction prediction = model->predict(soft_pad(1, nonsense));
      EXPECT_FALSE(prediction.has_answer) << model->card().name << ", mu " << nonsense;
      EXPECT_TRUE(is_sound(prediction)) << model->card().name;
    }
  }
}

TEST(PressureModels, AnswerWithoutFriction) {
  for (const PressureModel* model : all_pressure_models())
    EXPECT_TRUE(model->predict(soft_pad(1, 0)).has_answer) << model->card().name;
}

TEST(ModelRegistry, ListsTheModelsOfTheFolderByName) {
  ASSERT_GE(all_pressure_models().size(), 2u);
  std::string previous;
  for (const PressureModel* model : all_pressure_models()) {
    const ModelCard& card = model->card();
    EXPECT_LT(previous, card.name);
    previous = card.name;
    EXPECT_EQ(find_pressure_model(card.name), model);
    for (const std::string_view text : {card.name, card.title, card.assumptions, card.equations,
                                        card.source, card.validity, card.cost})
      EXPECT_FALSE(text.empty()) << card.name;
  }
  EXPECT_NE(find_pressure_model("hertz"), nullptr);
  EXPECT_NE(find_pressure_model("winkler"), nullptr);
  EXPECT_EQ(find_pressure_model("herz"), nullptr);
}

TEST(ModelCards, StateAnAccuracyAndItsReason) {
  for (const PressureModel* model : all_pressure_models()) {
    const NumericalAccuracy& accuracy = model->card().accuracy;
    for (const double error : {accuracy.pressure, accuracy.edge, accuracy.monotone})
      EXPECT_TRUE(error > 0 && error <= 5e-2) << model->card().name;
    EXPECT_FALSE(accuracy.reason.empty()) << model->card().name;
  }
}

TEST(ModelInvariants, PressureBalancesTheLoadAndGivesTheTorqueArm) {
  for (const PressureModel* model : all_pressure_models()) {
    const double tolerance = model->card().accuracy.pressure;
    int point = 0, answers = 0;
    double worst = 0;
    for (const double ratio : {1.0, 1.001, 3.0, 50.0})
      for (const double nu : {0.0, 0.3, 0.49, 0.5}) {
        if (!is_asked(*model, point++, 3)) continue;
        ContactProblem problem{{0.008 * ratio, 0.008}, {0.003, 2e5, nu}, {2, 0.8}};
        problem.options.power_law = {0.003, 0.3, 2.5};
        const Prediction prediction = model->predict(problem);
        if (!prediction.has_answer) continue;
        ++answers;
        const auto pressure = [&](long double x, long double y) {
          return model->pressure_Pa(problem, prediction, double(x), double(y));
        };
        const double load_N = double(testing::integrate_ellipse(
            prediction.a_m, prediction.b_m,
            [&](long double x, long double y) -> long double { return pressure(x, y); }));
        const double moment_Nm = double(testing::integrate_ellipse(
            prediction.a_m, prediction.b_m, [&](long double x, long double y) {
              return pressure(x, y) * std::sqrt(x * x + y * y);
            }));
        const double P = problem.load.normal_force_N;
        const auto expect_one = [&](const char* what, double value) {
          worst = std::max(worst, std::abs(value - 1));
          EXPECT_NEAR(value, 1, tolerance)
              << what << " of " << model->card().name << " " << ratio << " " << nu;
        };
        expect_one("load", load_N / P);
        expect_one("torque arm", moment_Nm / P / prediction.torque_arm_exact_m);
        expect_one("peak", pressure(0, 0) / prediction.peak_pressure_Pa);
        const double outside = 1 + model->card().accuracy.edge;
        EXPECT_EQ(pressure(outside * prediction.a_m, 0), 0) << model->card().name;
        EXPECT_EQ(pressure(0, -outside * prediction.b_m), 0) << model->card().name;
      }
    EXPECT_GT(answers, 0) << model->card().name;
    std::printf("%-20s load and torque balance to %.1e\n", std::string(model->card().name).c_str(),
                worst);
  }
}

// Dimensional analysis: lengths times `length`, forces times `force`.
RC_GTEST_PROP(ModelInvariants, NumbersChangeWithTheUnitsAsTheirDimensionsDemand, ()) {
  const ContactProblem problem = *fingertip_problem();
  const double length = *log_uniform(1e-3, 1e3), force = *log_uniform(1e-3, 1e3);
  ContactProblem scaled = problem;
  scaled.radii.major_m *= length;
  scaled.radii.minor_m *= length;
  scaled.layer.thickness_m *= length;
  scaled.layer.youngs_modulus_Pa *= force / (length * length);
  scaled.load.normal_force_N *= force;
  PowerLaw& law = scaled.options.power_law;
  law.radius_coefficient *= length / std::pow(force, law.radius_exponent);
  RC_PRE(scaled.radii.major_m >= scaled.radii.minor_m);
  // The rounding of the scaled input, a few epsilon, as amplified by any of the models.
  const double tolerance = 1e-12;
  for (const PressureModel* model : models_in_turn(50)) {
    const Prediction one = model->predict(problem), other = model->predict(scaled);
    RC_ASSERT(one.has_answer == other.has_answer);
    assert_close(other.a_m, length * one.a_m, tolerance);
    assert_close(other.b_m, length * one.b_m, tolerance);
    assert_close(other.indentation_m, length * one.indentation_m, tolerance);
    assert_close(other.peak_pressure_Pa, force / (length * length) * one.peak_pressure_Pa,
                 tolerance);
    assert_close(other.torque_arm_exact_m, length * one.torque_arm_exact_m, tolerance);
    assert_close(other.torque_arm_paper_m, length * one.torque_arm_paper_m, tolerance);
    auto check = other.validity.begin();
    for (const ValidityCheck& reference : one.validity) {
      RC_ASSERT(std::string(reference.check) == check->check);
      assert_close(check->value, reference.value, tolerance);
      assert_close(check->limit, reference.limit, tolerance);
      ++check;
    }
  }
}

RC_GTEST_PROP(ModelInvariants, LargerLoadsMakeLargerContactsAndTorqueArms, ()) {
  ContactProblem problem = *fingertip_problem();
  const double factor = *log_uniform(1.0001, 100);
  for (const PressureModel* model : models_in_turn(50)) {
    const Prediction one = model->predict(problem);
    ContactProblem heavier = problem;
    heavier.load.normal_force_N *= factor;
    const Prediction other = model->predict(heavier);
    if (!one.has_answer) continue;
    // A model that solves may refuse the heavier contact, in words. A closed form has no reason to.
    if (!other.has_answer && !model->card().hot_path) {
      RC_ASSERT(!other.validity.holds());  // what stood in the way
      continue;
    }
    RC_ASSERT(other.a_m > one.a_m);
    RC_ASSERT(other.b_m > one.b_m);
    RC_ASSERT(other.indentation_m > one.indentation_m);
    RC_ASSERT(other.peak_pressure_Pa > one.peak_pressure_Pa);
    RC_ASSERT(other.torque_arm_exact_m > one.torque_arm_exact_m);
  }
}

RC_GTEST_PROP(ModelInvariants, LongAxisLiesAlongTheLargerRadius, ()) {
  const ContactProblem problem = *fingertip_problem();
  for (const PressureModel* model : models_in_turn(50)) {
    const Prediction prediction = model->predict(problem);
    if (!prediction.has_answer) continue;
    RC_ASSERT(prediction.a_m >= prediction.b_m);
    // The paper's rule takes the circle of the same area, which has the least moment.
    RC_ASSERT(prediction.torque_arm_exact_m >= prediction.torque_arm_paper_m * (1 - 1e-15));
    RC_ASSERT(prediction.torque_arm_exact_m < prediction.a_m);
  }
}

TEST(ModelInvariants, SwappedRadiiAreRefusedInsteadOfTurningTheEllipse) {
  for (const PressureModel* model : all_pressure_models()) {
    const Prediction prediction = model->predict({{0.01, 0.02}, {0.002, 3e5, 0.3}, {1, 0.8}});
    EXPECT_FALSE(prediction.has_answer);
    EXPECT_EQ(std::string(prediction.validity.begin()->check), "radii_ordered");
  }
}

TEST(ModelInvariants, ApproachTheCircleContinuously) {
  for (const PressureModel* model : models_in_turn(1)) {
    ContactProblem circle{{0.01, 0.01}, {0.002, 3e5, 0.3}, {1, 0.8}};
    circle.options.power_law = {0.003, 0.3, 2.5};
    const Prediction limit = model->predict(circle);
    // Two axes that are computed apart differ by a few roundings, which depend on the processor:
    // the C library has several versions of sin and cos.
    EXPECT_NEAR(limit.a_m / limit.b_m, 1, 4 * kEpsilon);
    EXPECT_NEAR(limit.torque_arm_exact_m / limit.torque_arm_paper_m, 1, 1e-15);
    for (double excess = 1e-15; excess < 1e-2; excess *= 2) {
      ContactProblem problem = circle;
      problem.radii.major_m *= 1 + excess;
      const Prediction near = model->predict(problem);
      if (!near.has_answer) continue;  // made for circles alone
      // All exponents of the ratio are below one; a few roundings remain.
      const double tolerance = excess + 3e-15;
      EXPECT_NEAR(near.a_m / limit.a_m, 1, tolerance) << model->card().name << excess;
      EXPECT_NEAR(near.b_m / limit.b_m, 1, tolerance) << model->card().name << excess;
      EXPECT_NEAR(near.indentation_m / limit.indentation_m, 1, tolerance);
      EXPECT_NEAR(near.peak_pressure_Pa / limit.peak_pressure_Pa, 1, tolerance);
      EXPECT_NEAR(near.torque_arm_exact_m / limit.torque_arm_exact_m, 1, tolerance);
    }
  }
}

std::string in_words(const ContactProblem& problem) {
  std::ostringstream text;
  text << ": R' = " << problem.radii.major_m << " R'' = " << problem.radii.minor_m
       << " h = " << problem.layer.thickness_m << " E = " << problem.layer.youngs_modulus_Pa
       << " nu = " << problem.layer.poisson_ratio << " P = " << problem.load.normal_force_N;
  return text.str();
}

// Far outside any range that makes sense: each field takes every value that a broken caller passes.
TEST(ModelExtremes, NonsenseIsRefusedInWords) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double values[] = {std::nan(""), -infinity, -1e308, -1,    -5e-324, 0,       5e-324,
                           1e-308,       1e-154,    0.25,   1e154, 1e308,   infinity};
  constexpr int kSlowPeriod = 1009;  // prime: walks through all combinations of neighbouring fields
  for (const PressureModel* model : all_pressure_models()) {
    int point = 0;
    for (const double R1 : values)
      for (const double R2 : values)
        for (const double h : values)
          for (const double E : values)
            for (const double P : values) {
              // Poisson's ratio walks through its own nonsense beside them.
              for (const double nu : {0.3, 0.5, -0.1, 0.6, std::nan(""), infinity}) {
                const ContactProblem problem{{R1, R2}, {h, E, nu}, {P, 0.8}};
                if (is_asked(*model, point++, kSlowPeriod)) {
                  ASSERT_TRUE(testing::is_finite_and_consistent(model->predict(problem)))
                      << model->card().name << in_words(problem);
                }
                if (nu != 0.3 && R1 != 0.25) break;
              }
            }
    // One broken field in a problem that makes sense.
    for (const double value : values)
      for (int field = 0; field < 6; ++field) {
        ContactProblem problem = soft_pad(1, 0.8);
        double* const fields[] = {&problem.radii.major_m,       &problem.radii.minor_m,
                                  &problem.layer.thickness_m,   &problem.layer.youngs_modulus_Pa,
                                  &problem.layer.poisson_ratio, &problem.load.normal_force_N};
        *fields[field] = value;
        ASSERT_TRUE(testing::is_finite_and_consistent(model->predict(problem)))
            << model->card().name << in_words(problem);
      }
  }
}

// Theories that know one layer say so; the others become more compliant by a second one.
TEST(ModelInvariants, ACompliantObjectIsAddedOrRefusedInWords) {
  for (const PressureModel* model : all_pressure_models()) {
    ContactProblem problem{{0.01, 0.01}, {0.002, 3e5, 0.3}, {1, 0.8}};
    problem.options.power_law = {0.003, 0.3, 2.5};
    const Prediction one = model->predict(problem);
    problem.object_layer = {0.001, 5e5, 0.4};
    const Prediction two = model->predict(problem);
    EXPECT_TRUE(testing::is_finite_and_consistent(two)) << model->card().name;
    if (!two.has_answer) {
      EXPECT_FALSE(two.valid());
      continue;
    }
    EXPECT_GT(two.a_m, one.a_m) << model->card().name;
    EXPECT_GT(two.indentation_m, one.indentation_m) << model->card().name;
    EXPECT_LT(two.peak_pressure_Pa, one.peak_pressure_Pa) << model->card().name;
    for (const ElasticLayer& broken :
         {ElasticLayer{std::nan(""), 5e5, 0.4}, ElasticLayer{-1, 5e5, 0.4},
          ElasticLayer{0.001, 0, 0.4}, ElasticLayer{0.001, 5e5, 0.6}}) {
      problem.object_layer = broken;
      EXPECT_FALSE(model->predict(problem).has_answer) << model->card().name;
    }
  }
}

}  // namespace
}  // namespace softfinger
