#include "softfinger/friction/partial_slip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "fem/verification/torsion_reference.h"
#include "fem_partial_slip.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/equivalent_exponent.h"
#include "softfinger/pressure/gradient.h"

namespace softfinger {
namespace {

ContactProblem problem_of(const tests::PressedCase& pressed) {
  ContactProblem problem;
  problem.radii = {pressed.radii_m[0], pressed.radii_m[1], 0};
  problem.layer.thickness_m = pressed.thickness_m;
  problem.layer.youngs_modulus_Pa = pressed.youngs_modulus_Pa;
  problem.layer.poisson_ratio = pressed.poisson_ratio;
  problem.load.normal_force_N = pressed.load_N;
  problem.load.friction_coefficient = pressed.friction_coefficient;
  return problem;
}

// G a² angle/(mu P) and T/(mu P a), as Lubkin has them, to x and y.
TEST(TwistCurve, IsLubkinsOnAHalfSpace) {
  const TwistCurve curve(0.5);
  const double max_torque = 3 * kPi / 16;
  for (int i = 1; i < 200; ++i) {
    const double c = i / 200.;
    const double x = 16. / 3 * fem::verification::Lubkin::angle(c) / max_torque;
    // Their quadrature of a function with a kink in its second derivative: 2e-6.
    EXPECT_NEAR(curve(x), fem::verification::Lubkin::torque(c) / max_torque, 4e-6) << c;
  }
}

// The integral equation of a layer's torsion under the pressure of its own contact, of which only
// T_max is known to the curve.
TEST(TwistCurve, HoldsForCirclesOnLayers) {
  for (const auto& layer : fem::verification::layer_twists()) {
    // n from T_max, by bisection: the arm falls with n.
    double low = 0, high = 3;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (torque_arm_exact_m(1, 1, middle) > layer.full_slip ? low : high) = middle;
    }
    const TwistCurve curve(low, 1, layer.s);
    double worst = 0;
    for (std::size_t i = 0; i < layer.angle.size(); ++i) {
      const double x = 16. / 3 * layer.stiffness_ratio * layer.angle[i] / layer.full_slip;
      worst = std::max(worst, std::abs(curve(x) - layer.torque[i] / layer.full_slip));
    }
    std::printf("nu %.2f, a/h %.1f: twist within %.2f %% of T_max\n", layer.nu, layer.s,
                100 * worst);
    EXPECT_LT(worst, 0.002) << "as stated in partial_slip.h";
  }
}

TEST(TwistCurve, AgreesWithFiniteElements) {
  for (const tests::FemTwist& fem : tests::fem_twists()) {
    // Ellipse, stiffness, T_max and n are those of the prediction, as a user has them.
    const ContactProblem problem = problem_of(fem.pressed);
    const PressureModel& model = *find_pressure_model("bonded_layer");
    const Prediction prediction = model.predict(problem);
    const PredictionGradient gradient = predict_with_gradient(model, problem).gradient;
    ASSERT_TRUE(gradient.known);
    const double max_torque =
        fem.pressed.friction_coefficient * fem.pressed.load_N * prediction.torque_arm_exact_m;
    const TwistCurve curve(equivalent_exponent(prediction), prediction.b_m / prediction.a_m,
                           prediction.a_m / fem.pressed.thickness_m);
    // Scaled by the finite elements' own stiffness and T_max, only the curve's shape is compared.
    const double arm = torque_arm_exact_m(fem.a_m, fem.b_m, 0) / (2. / 3);
    double low = 0, high = 5;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (arm * torque_arm_exact_m(1, 1, middle) > fem.eccentricity_m ? low : high) = middle;
    }
    const TwistCurve shape(low, fem.b_m / fem.a_m, fem.a_m / fem.pressed.thickness_m);
    double worst = 0, worst_shape = 0;
    for (const auto& point : fem.points) {
      const double torque =
          max_torque * curve(gradient.stuck.torsional_Nm_per_rad * point.angle_rad / max_torque);
      worst = std::max(worst, std::abs(torque - point.torque_Nm) / fem.max_torque_Nm);
      worst_shape =
          std::max(worst_shape,
                   std::abs(shape(fem.stiffness_Nm_per_rad * point.angle_rad / fem.max_torque_Nm) -
                            point.torque_Nm / fem.max_torque_Nm));
    }
    std::printf("%-18s %5g N, a/b %.1f: T(angle) within %.2f %% of T_max, its shape %.2f %%\n",
                fem.pressed.name, fem.pressed.load_N, fem.a_m / fem.b_m, 100 * worst,
                100 * worst_shape);
    EXPECT_LT(worst, fem.a_m > 3.1 * fem.b_m ? 0.015 : 0.008) << "as stated in partial_slip.h";
  }
}

TEST(ShiftCurve, IsMindlinsForHertz) {
  const ShiftCurve curve(1. / 3);
  for (double x = 0; x < 2; x += 0.01)
    EXPECT_NEAR(curve(x), x < 1.5 ? 1 - std::pow(1 - 2 * x / 3, 1.5) : 1, 1e-15);
}

TEST(ShiftCurve, AgreesWithFiniteElements) {
  for (const tests::FemShift& fem : tests::fem_shifts()) {
    const PredictionGradient gradient =
        predict_with_gradient(*find_pressure_model("bonded_layer"), problem_of(fem.pressed))
            .gradient;
    ASSERT_TRUE(gradient.known);
    const double limit_N = fem.pressed.friction_coefficient * fem.pressed.load_N;
    double worst = 0;
    for (const auto& point : fem.points) {
      const double kx = gradient.stuck.tangential_x_N_per_m,
                   ky = gradient.stuck.tangential_y_N_per_m;
      const double growth =
          gradient.tangential_stiffness_x_N_per_m.by[kNormalForce] / kx * fem.pressed.load_N;
      const double force = std::hypot(point.force_x_N, point.force_y_N) / limit_N;
      const double x = std::hypot(kx * point.x_m, ky * point.y_m) / limit_N;
      worst = std::max(worst, std::abs(ShiftCurve(growth)(x) - force));
    }
    std::printf("%-18s %5g N: F(displacement) within %.2f %% of mu P\n", fem.pressed.name,
                fem.pressed.load_N, 100 * worst);
    EXPECT_LT(worst, 0.03) << fem.pressed.name;
  }
}

/// @param near_one  how far the slope may be from 1 at x = 1e-9
template <class Curve>
void expect_backbone(const Curve& curve, double near_one) {
  double last = 0, last_slope = 1 + 1e-6;
  for (double x = 1e-3; x < 2e3; x *= 1.02) {
    const double y = curve(x), slope = (y - last) / (x - x / 1.02 * (last > 0));
    EXPECT_GE(y, last - 1e-7) << "the knots are exact to that";
    EXPECT_LE(y, 1 + 1e-7);
    if (last > 0) {
      EXPECT_LE(slope, last_slope + 1e-6) << "concave, at " << x;
      last_slope = slope;
    }
    EXPECT_EQ(curve(-x), -y);
    last = y;
  }
  EXPECT_NEAR(last, 1, 1e-5);
  EXPECT_NEAR(curve(1e-9) / 1e-9, 1, near_one);
}

TEST(TwistCurve, RisesConcavelyFromSlopeOneToOne) {
  for (const double exponent : {0.5, 0.55, 0.66, 1., 2., 6.})
    for (const double aspect : {1., 0.9, 0.5, 0.2, 0.05})
      for (const double size : {0., 0.5, 5., 30.})
        // A rim of the depth x^(1/(n + 1/2)) in 1 - r² slips; the slope is 1 - 3/2 of that depth.
        expect_backbone(TwistCurve(exponent, aspect, size),
                        3 * std::pow(1e-9, 1 / (exponent + 0.5)));
}

TEST(ShiftCurve, RisesConcavelyFromSlopeOneToOne) {
  for (const double growth : {0., 0.3, 1. / 3, 0.5, 0.8}) expect_backbone(ShiftCurve(growth), 1e-6);
}

/// Work on the contact from one place to another, by the trapezoidal rule.
template <class Curve>
double work_to(MasingPath<Curve>& path, double x) {
  constexpr int kSteps = 400;
  const double from = path.x();
  double work = 0, y = path.y();
  for (int i = 1; i <= kSteps; ++i) {
    const double next = path.go_to(from + (x - from) * i / kSteps);
    work += 0.5 * (y + next) * (x - from) / kSteps;
    y = next;
  }
  return work;
}

TEST(MasingPath, GivesNoWorkAwayInAnyHistory) {
  std::mt19937 random(7);
  std::normal_distribution<double> place(0, 1.5);
  for (int history = 0; history < 300; ++history) {
    MasingPath<TwistCurve> path{TwistCurve(0.5)};
    double work = 0;
    for (int i = 0; i < 25; ++i) {
      work += work_to(path, place(random));
      // The trapezoidal rule of 400 steps of length up to 6/400: 1e-5 of a loop.
      EXPECT_GE(work, -1e-4) << "all that was given from the start on";
      // An excursion that stays within the last reversals comes back to the same point.
      MasingPath<TwistCurve> loop = path;
      const double aside = 0.2 * place(random);
      const double lost = work_to(loop, loop.x() + aside) + work_to(loop, path.x());
      EXPECT_GE(lost, -1e-5);
    }
  }
}

TEST(MasingPath, ClosesLoopsAndRemembersWhereTheyBegan) {
  MasingPath<ShiftCurve> path{ShiftCurve(1. / 3)};
  const double top = path.go_to(1);
  path.go_to(0.2);
  path.go_to(0.6);
  path.go_to(0.4);
  EXPECT_EQ(path.memory(), 3u);
  path.go_to(0.7);
  EXPECT_EQ(path.memory(), 2u) << "the inner loop has closed";
  EXPECT_NEAR(path.go_to(1), top, 1e-15);
  EXPECT_NEAR(path.go_to(1.2), ShiftCurve(1. / 3)(1.2), 1e-15) << "as if nothing had been";
  EXPECT_EQ(path.memory(), 0u);
}

// Mindlin and Deresiewicz (1953): energy of a cycle between +-F under a constant load,
// (36/5) (mu P)²/k {1 - (1 - f)^(5/3) - (5 f/6) [1 + (1 - f)^(2/3)]}, f = F/(mu P); k = 8 G
// a/(2-nu).
TEST(MasingPath, LosesInACycleWhatMindlinAndDeresiewiczFound) {
  for (const double f : {0.1, 0.5, 0.9}) {
    const double amplitude = 1.5 * (1 - std::pow(1 - f, 2. / 3));
    MasingPath<ShiftCurve> path{ShiftCurve(1. / 3)};
    path.go_to(amplitude);
    const double lost = work_to(path, -amplitude) + work_to(path, amplitude);
    const double exact =
        7.2 * (1 - std::pow(1 - f, 5. / 3) - 5 * f / 6 * (1 + std::pow(1 - f, 2. / 3)));
    EXPECT_NEAR(lost, exact, 1e-4 * amplitude * f);
  }
}

}  // namespace
}  // namespace softfinger
