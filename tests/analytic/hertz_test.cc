#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "quadrature.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

/// A half-space with the given E* (nu = 0), so thick that nothing is out of range.
ContactProblem half_space(double R1_m, double R2_m, double modulus_Pa, double load_N) {
  return {{R1_m, R2_m}, {1000, modulus_Pa, 0}, {load_N, 0.5}};
}

Prediction hertz(const ContactProblem& problem) {
  return find_pressure_model("hertz")->predict(problem);
}

TEST(Hertz, EqualsTheClosedFormForSpheres) {
  const double R = 0.01, E = 1e6, P = 5;
  const Prediction contact = hertz(half_space(R, R, E, P));
  const double a = std::cbrt(3 * P * R / (4 * E));
  const double tolerance = 2e-15;  // a handful of roundings
  EXPECT_NEAR(contact.a_m / a, 1, tolerance);
  EXPECT_NEAR(contact.b_m / a, 1, tolerance);
  EXPECT_NEAR(contact.indentation_m / (a * a / R), 1, tolerance);
  EXPECT_NEAR(contact.peak_pressure_Pa / (1.5 * P / (kPi * a * a)), 1, tolerance);
  EXPECT_NEAR(contact.torque_arm_exact_m / (3 * kPi / 16 * a), 1, tolerance);
  EXPECT_NEAR(contact.torque_arm_paper_m / (3 * kPi / 16 * a), 1, tolerance);
}

// Independent of elliptic integrals: the displacement under the ellipse's pressure by the integrals
// of Boussinesq's potential (Johnson, eq. 3.63 and 4.22), evaluated by brute force, must equal the
// gap that the predicted indentation leaves.
TEST(Hertz, ClosesTheGapForAllRatiosOfRadii) {
  const double R2 = 0.01, E = 1e6, P = 5;
  testing::WorstError worst("gap under elliptic Hertz, R'/R'' to 1e8");
  for (const double ratio :
       {1.0, 1 + 1e-14, 1 + 1e-9, 1 + 1e-5, 1.01, 2.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8}) {
    const double R1 = R2 * ratio;
    const Prediction contact = hertz(half_space(R1, R2, E, P));
    ASSERT_TRUE(contact.has_answer);
    using Real = long double;
    const Real a2 = Real(contact.a_m) * contact.a_m, b2 = Real(contact.b_m) * contact.b_m;
    // int_0^inf f(w) / sqrt((a² + w)(b² + w) w) dw with w = exp(t)
    const auto potential = [&](auto f) {
      return 3 * P / (4 * Real(kPi) * E) *
             testing::integrate_line(std::log(b2) - 95, std::log(a2) + 95, 0.25L, [&](Real t) {
               const Real w = std::exp(t);
               return f(w) * std::sqrt(w / ((a2 + w) * (b2 + w)));
             });
    };
    const double curvature_x = double(2 * potential([&](Real w) { return 1 / (a2 + w); }));
    const double curvature_y = double(2 * potential([&](Real w) { return 1 / (b2 + w); }));
    const double indentation = double(potential([](Real) { return Real(1); }));
    // Rounding of a and b enters the curvatures threefold; the ratio of radii determines q to a few
    // epsilon.
    const double tolerance = 2e-14;
    EXPECT_LT(worst.of(curvature_x, 1 / R1), tolerance) << ratio;
    EXPECT_LT(worst.of(curvature_y, 1 / R2), tolerance) << ratio;
    EXPECT_LT(worst.of(contact.indentation_m, indentation), tolerance) << ratio;
  }
}

// Published to 25 digits, from ring integrals in 60-digit arithmetic.
TEST(Hertz, EqualsPublishedNumbers) {
  struct Row {
    double R1, R2, E, P, a, b, d, p0;
  };
  testing::WorstError worst("Hertz against published numbers");
  for (const Row& row : {
           Row{0.020002, 0.02, 2.5e5, 0.1, 0.001817211446338126041984349,
               0.00181709030900309761458444, 0.0001650936109762619741187282,
               14459.70425710537394648994},
           Row{0.02, 0.01, 1e6, 5, 0.004700164007183389510488937, 0.002963903218936917367459617,
               0.0009915246569217864563341687, 171369.8276069103247844499},
           Row{1, 0.01, 1e6, 5, 0.02505394730908149458007561, 0.001377566691244638956183036,
               0.000408734637324451053444555, 69170.76801033509652635578},
           Row{200, 0.02, 2.5e5, 0.1, 0.0765728028411820500875968, 0.0003158518892516612222906047,
               0.00001715254573598243625453642, 1974.164614775133886277081},
       }) {
    const Prediction contact = hertz(half_space(row.R1, row.R2, row.E, row.P));
    const double tolerance = 1e-14;
    EXPECT_LT(worst.of(contact.a_m, row.a), tolerance);
    EXPECT_LT(worst.of(contact.b_m, row.b), tolerance);
    EXPECT_LT(worst.of(contact.indentation_m, row.d), tolerance);
    EXPECT_LT(worst.of(contact.peak_pressure_Pa, row.p0), tolerance);
  }
}

TEST(Hertz, UsesThePlaneStrainModulus) {
  ContactProblem problem = half_space(0.02, 0.01, 1e6, 5);
  const Prediction reference = hertz(problem);
  problem.layer.poisson_ratio = 0.5;
  problem.layer.youngs_modulus_Pa = 0.75e6;
  EXPECT_NEAR(hertz(problem).a_m / reference.a_m, 1, 1e-15);
}

TEST(Hertz, IsValidOnThickLayersOnly) {
  ContactProblem problem = half_space(0.01, 0.01, 1e6, 1e-3);
  const double a = hertz(problem).a_m;
  struct Row {
    double poisson_ratio, limit;
  };
  for (const Row& row : {Row{0, 0.88}, Row{0.15, 0.83}, Row{0.3, 0.78}, Row{0.45, 0.69},
                         Row{0.47, 0.675}, Row{0.49, 0.66}, Row{0.5, 0.65}}) {
    problem.layer.poisson_ratio = row.poisson_ratio;
    problem.layer.youngs_modulus_Pa = 1e6 * (1 - row.poisson_ratio * row.poisson_ratio);
    problem.layer.thickness_m = a / (row.limit * 0.999);
    EXPECT_TRUE(hertz(problem).valid()) << row.poisson_ratio;
    problem.layer.thickness_m = a / (row.limit * 1.001);
    const Prediction contact = hertz(problem);
    EXPECT_TRUE(contact.has_answer);
    EXPECT_FALSE(contact.valid()) << row.poisson_ratio;
    EXPECT_EQ(std::string(contact.validity.begin()->check), "thick_layer");
  }
}

TEST(Hertz, AddsTheCompliancesOfTwoElasticBodies) {
  // Code_Aster SSNV104: two like spheres R = 50, E = 20000, nu = 0.3, total approach 4: a = 10,
  // p0 = 2798.3 (given to its digits). Relative radius 25.
  ContactProblem problem{{25, 25}, {1e6, 20000, 0.3}, {1, 0.5}};
  problem.object_layer = problem.layer;
  const double modulus = 20000 / (1 - 0.09) / 2;
  problem.load.normal_force_N = 4.0 / 3 * modulus * std::sqrt(25.0) * std::pow(4, 1.5);
  const Prediction contact = hertz(problem);
  EXPECT_NEAR(contact.a_m, 10, 1e-14 * 10);
  EXPECT_NEAR(contact.indentation_m, 4, 1e-14 * 4);
  EXPECT_NEAR(contact.peak_pressure_Pa, 2798.3, 0.1);
}

TEST(Hertz, ChecksTheObjectsLayerToo) {
  ContactProblem problem = half_space(0.01, 0.01, 1e6, 1e-3);
  problem.object_layer = {1000, 1e6, 0.3};
  EXPECT_TRUE(hertz(problem).valid());
  problem.object_layer.thickness_m = hertz(problem).a_m;
  const Prediction contact = hertz(problem);
  bool thin = false;
  for (const ValidityCheck& check : contact.validity)
    thin = thin || (std::string(check.check) == "thick_object_layer" && !check.holds());
  EXPECT_TRUE(thin);
  EXPECT_FALSE(contact.valid());
}

TEST(Hertz, FindsSteepAndDeepContacts) {
  ContactProblem problem = half_space(0.01, 0.01, 1e6, 50);
  bool steep = false;
  for (const ValidityCheck& check : hertz(problem).validity)
    steep = steep || (std::string(check.check) == "small_slope" && !check.holds());
  EXPECT_TRUE(steep);

  problem.layer.thickness_m = 1e-3;
  bool deep = false;
  for (const ValidityCheck& check : hertz(problem).validity)
    deep = deep || (std::string(check.check) == "small_strain" && !check.holds());
  EXPECT_TRUE(deep);
}

}  // namespace
}  // namespace softfinger
