#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "softfinger/input/constants.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

Prediction winkler(const ContactProblem& problem) {
  return find_pressure_model("winkler")->predict(problem);
}

// K = 1.5 MPa, h = 3 mm, P = 5 N are the defaults of the simulator of Ciocarlie et al. 2007.
TEST(Winkler, EqualsTheEquationsOfCiocarlieEtAl) {
  const double K = 1.5e6, h = 0.003, P = 5, R1 = 0.02, R2 = 0.005;
  const Prediction contact = winkler({{R1, R2}, {h, K, 0}, {P, 0.8}});  // nu = 0: M = E
  const double d = std::sqrt(P * h / (K * kPi * 0.01));
  const double tolerance = 2e-15;  // a handful of roundings
  EXPECT_NEAR(contact.indentation_m / d, 1, tolerance);
  EXPECT_NEAR(contact.a_m / std::sqrt(2 * d * R1), 1, tolerance);
  EXPECT_NEAR(contact.b_m / std::sqrt(2 * d * R2), 1, tolerance);
  EXPECT_NEAR(contact.peak_pressure_Pa / (K * d / h), 1, tolerance);
  EXPECT_NEAR(contact.torque_arm_paper_m / (8.0 / 15 * std::sqrt(2 * d * 0.01)), 1, tolerance);
}

TEST(Winkler, UsesTheConfinedModulus) {
  const Prediction at_zero = winkler({{0.01, 0.01}, {0.001, 1e6, 0}, {1, 0.5}});
  // M = E (1 - nu)/((1 + nu)(1 - 2 nu)) = E 0.7/(1.3 * 0.4) at nu = 0.3
  const Prediction at_03 = winkler({{0.01, 0.01}, {0.001, 1e6 * 1.3 * 0.4 / 0.7, 0.3}, {1, 0.5}});
  EXPECT_NEAR(at_03.a_m / at_zero.a_m, 1, 1e-15);
  EXPECT_NEAR(at_03.peak_pressure_Pa / at_zero.peak_pressure_Pa, 1, 2e-15);
}

TEST(Winkler, HasNoAnswerForIncompressibleLayersAndSaysWhy) {
  const Prediction contact = winkler({{0.01, 0.01}, {0.001, 1e6, 0.5}, {1, 0.5}});
  EXPECT_FALSE(contact.has_answer);
  EXPECT_FALSE(contact.valid());
  EXPECT_EQ(contact.a_m, 0);
  ASSERT_NE(contact.validity.begin(), contact.validity.end());
  EXPECT_EQ(std::string(contact.validity.begin()->check), "compressible");
  EXPECT_FALSE(contact.validity.begin()->holds());
}

TEST(Winkler, IsValidOnThinLayersOnlyAndNeverNearHalf) {
  struct Row {
    double poisson_ratio, limit;
  };
  // At 0.495 the limit follows 1/(1 - 2 nu) from 52 at 0.49.
  for (const Row& row :
       {Row{0, 3.8}, Row{0.3, 2.7}, Row{0.45, 10}, Row{0.49, 52}, Row{0.495, 104}}) {
    const ContactProblem problem{{0.01, 0.01}, {0.001, 1e6, row.poisson_ratio}, {1, 0.5}};
    const ValidityCheck check = *winkler(problem).validity.begin();
    EXPECT_EQ(std::string(check.check), "thin_layer");
    EXPECT_FALSE(check.holds_below);
    EXPECT_NEAR(check.limit, row.limit, 1e-10 * row.limit);  // 1 - 2 nu loses two digits
  }
  const double last = std::nextafter(0.5, 0);
  const Prediction contact = winkler({{0.01, 0.01}, {1e-5, 1e6, last}, {1, 0.5}});
  EXPECT_TRUE(contact.has_answer);
  EXPECT_FALSE(contact.valid());
}

TEST(Winkler, LimitOfThinLayersIsContinuousInPoissonRatio) {
  double previous = 0;
  for (double nu = 0; nu < 0.4999; nu += 1e-4) {
    const ContactProblem problem{{0.01, 0.01}, {0.001, 1e6, nu}, {1, 0.5}};
    const double limit = winkler(problem).validity.begin()->limit;
    // d ln(limit)/d nu is at most 2/(1 - 2 nu), with a margin for the step's own curvature.
    if (nu > 0) {
      EXPECT_NEAR(limit / previous, 1, 3e-4 / (1 - 2 * nu)) << nu;
    }
    previous = limit;
  }
}

const ValidityCheck* find_check(const Prediction& prediction, const std::string& name) {
  for (const ValidityCheck& check : prediction.validity)
    if (check.check == name) return &check;
  return nullptr;
}

TEST(Winkler, TakesYoungsModulusOnRequestAndSaysWhereItIsWrong) {
  ContactProblem problem{{0.01, 0.01}, {1e-4, 1e6, 0.3}, {0.05, 0.5}};
  const Prediction confined = winkler(problem);
  EXPECT_EQ(find_check(confined, "confined_modulus"), nullptr);
  problem.options.winkler_modulus = WinklerModulus::youngs;
  const Prediction free = winkler(problem);
  const double M_over_E = 0.7 / (1.3 * 0.4);
  EXPECT_NEAR(free.area_m2() / confined.area_m2(), std::sqrt(M_over_E), 1e-14);
  EXPECT_NEAR(find_check(free, "confined_modulus")->value, 1 / M_over_E, 1e-14);
  EXPECT_FALSE(find_check(free, "confined_modulus")->holds());
  EXPECT_NE(std::string(find_check(free, "confined_modulus")->message).find("nu = 0"),
            std::string::npos);
  problem.layer.poisson_ratio = 0;
  EXPECT_TRUE(find_check(winkler(problem), "confined_modulus")->holds());
  EXPECT_TRUE(winkler(problem).valid());
  problem.layer.poisson_ratio = 0.5;  // free columns of rubber can be compressed
  EXPECT_TRUE(winkler(problem).has_answer);
  EXPECT_FALSE(winkler(problem).valid());
}

TEST(Winkler, PutsTheObjectsLayerInSeries) {
  ContactProblem problem{{0.02, 0.01}, {0.001, 1e6, 0}, {1, 0.5}};
  problem.object_layer = {0.002, 4e6, 0};  // h/K is half of the finger's
  const Prediction both = winkler(problem);
  const Prediction one = winkler({{0.02, 0.01}, {0.0015, 1e6, 0}, {1, 0.5}});
  EXPECT_NEAR(both.a_m / one.a_m, 1, 1e-15);
  EXPECT_NEAR(both.indentation_m / one.indentation_m, 1, 1e-15);
  EXPECT_NEAR(both.peak_pressure_Pa / one.peak_pressure_Pa, 1, 1e-15);
  EXPECT_EQ(find_check(both, "thin_object_layer")->value,
            find_check(both, "thin_layer")->value / 2);
  // Two thirds of the indentation in the finger's millimetre, one third in the object's two.
  EXPECT_NEAR(find_check(both, "small_strain")->value, both.indentation_m * 2 / 3 / 0.001, 1e-14);
  // An incompressible finger adds nothing to the object's compliance, and that is not valid.
  problem.layer.poisson_ratio = 0.5;
  EXPECT_TRUE(winkler(problem).has_answer);
  EXPECT_FALSE(find_check(winkler(problem), "thin_layer")->holds());
}

}  // namespace
}  // namespace softfinger
