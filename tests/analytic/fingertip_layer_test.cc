// The closed form of a finger: exact limits, symmetry, monotony, published large-strain solutions.
#include "softfinger/layer/fingertip_layer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "softfinger/layer/bonded_layer.h"
#include "softfinger/layer/fingertip_layer_core.h"
#include "softfinger/pressure/pressure_model.h"
#include "tests/allocation_counter.h"

namespace softfinger {
namespace {

const PressureModel& model() { return *find_pressure_model("fingertip_layer"); }

ContactProblem finger_on_plane(double load_N, double nu = 0.45, double radius_x_m = 0.012,
                               double radius_y_m = 0.008) {
  ContactProblem problem;
  problem.radii = {radius_x_m, radius_y_m, 0};
  problem.layer = {0.002, 3e5, nu};
  problem.load = {load_N, 0.5};
  problem.finger_curvature = {1 / radius_x_m, 1 / radius_y_m, 0};
  return problem;
}

TEST(FingertipLayer, IsTheBondedLayerWhereNothingIsCurvedOrStrained) {
  // Curvature and strain of 1e-17 and less are lost in the last digit.
  ContactProblem problem = finger_on_plane(1, 0.45, 3e17, 1e17);
  problem.layer.thickness_m = 1;
  problem.load.normal_force_N = 1e-30;
  const ContactNumbers found = fingertip_layer_contact(problem);
  const BondedLayerContact flat =
      bonded_layer_contact(problem.radii, problem.layer, problem.load.normal_force_N);
  EXPECT_EQ(found.a_m, flat.a_m);
  EXPECT_EQ(found.b_m, flat.b_m);
  EXPECT_EQ(found.indentation_m, flat.indentation_m);
  EXPECT_EQ(found.peak_pressure_Pa, flat.peak_pressure_Pa);
  EXPECT_EQ(found.torque_arm_exact_m, flat.torque_arm_exact_m);
  EXPECT_EQ(found.torque_arm_paper_m, flat.torque_arm_paper_m);
}

TEST(FingertipLayer, OfARoundFingerIsRound) {
  for (const double nu : {0., 0.3, 0.49})
    for (const double load_N : {0.01, 1., 5.}) {
      const ContactNumbers found = fingertip_layer_contact(finger_on_plane(load_N, nu, 0.01, 0.01));
      EXPECT_EQ(found.a_m, found.b_m);
      EXPECT_NEAR(found.torque_arm_exact_m, found.torque_arm_paper_m,
                  1e-12 * found.torque_arm_paper_m);
    }
}

/// The numbers of a layer do not depend on which axis is called x. Shown for the effects: when the
/// axes are exchanged, the symmetric ones stay and the others change their sign.
TEST(FingertipLayer, DoesNotKnowWhichAxisIsCalledX) {
  ContactInputOf<double> input =
      contact_input({0.014, 0.014, 0}, {0.002, 3e5, 0.4}, 2, {30, 50, 5});
  ContactNumbers flat = bonded_layer_numbers(contact_input({0.02, 0.01, 0}, {0.002, 3e5, 0.4}, 2));
  const auto one = fingertip_arguments(input, flat, 1);
  std::swap(input.radius_major_m, input.radius_minor_m);
  std::swap(input.finger_xx_per_m, input.finger_yy_per_m);
  std::swap(flat.a_m, flat.b_m);
  const auto other = fingertip_arguments(input, flat, 1);
  for (std::size_t effect = 0; effect < kFingertipEffects; ++effect) {
    const double sign = effect < kSymmetricEffects ? 1 : -1;
    EXPECT_NEAR(other.effects[effect], sign * one.effects[effect],
                1e-14 * (1 + std::abs(one.effects[effect])))
        << effect;
    EXPECT_NE(one.effects[effect], 0) << effect;
  }
}

/// Everything grows with the load, from a touch to far beyond the fitted runs.
TEST(FingertipLayer, GrowsWithTheLoad) {
  std::mt19937_64 generator(5);
  const auto between = [&](double low, double high) {
    return low + (high - low) * double(generator() >> 11) * 0x1p-53;
  };
  int contacts = 0;
  for (int i = 0; i < 3000; ++i) {
    ContactProblem problem;
    const double minor_m = 0.008, h = minor_m * std::exp(between(std::log(0.01), std::log(0.5)));
    problem.radii = {minor_m * std::exp(between(0, std::log(10))), minor_m, 0};
    problem.layer = {h, 3e5, i % 2 ? between(0, 0.5) : 0.5 - std::exp(between(-9, -1))};
    const double share_x = between(0, 1.5), share_y = between(0, 1.5);
    problem.finger_curvature = {share_x / problem.radii.major_m, share_y / minor_m, 0};
    Prediction before;
    for (double load_N = 1e-4; load_N < 1e4; load_N *= 1.2) {
      problem.load.normal_force_N = load_N;
      const Prediction found = model().predict(problem);
      ASSERT_TRUE(found.has_answer);
      if (before.has_answer) {
        EXPECT_GT(found.a_m, before.a_m) << i << ' ' << load_N;
        EXPECT_GT(found.b_m, before.b_m) << i << ' ' << load_N;
        EXPECT_GT(found.indentation_m, before.indentation_m) << i << ' ' << load_N;
        EXPECT_GT(found.torque_arm_exact_m, before.torque_arm_exact_m) << i << ' ' << load_N;
        EXPECT_GT(found.peak_pressure_Pa, before.peak_pressure_Pa) << i << ' ' << load_N;
        if (::testing::Test::HasFailure()) return;
      }
      before = found;
      ++contacts;
    }
  }
  EXPECT_GT(contacts, 100000);
}

/// Independent solutions of axisymmetric contacts at finite strain (neo-Hookean, quadratic volume
/// energy; mixed elements, load to 1e-4): nu, h/R, load over E* h², radius and approach over h,
/// torque arm over h.
struct LargeStrain {
  const char* shape;
  double nu, thickness_over_radius, load, radius, approach, arm;
};

class LargeStrains : public ::testing::TestWithParam<LargeStrain> {};

TEST_P(LargeStrains, AreFollowed) {
  const LargeStrain& truth = GetParam();
  const double h = 2e-3, radius_m = h / truth.thickness_over_radius;
  ContactProblem problem;
  problem.radii = {radius_m, radius_m, 0};
  problem.layer = {h, 3e5, truth.nu};
  problem.load = {truth.load * problem.layer.plane_strain_modulus_Pa() * h * h, 0.5};
  const std::string shape = truth.shape;
  if (shape == "curved") problem.finger_curvature = {1 / radius_m, 1 / radius_m, 0};
  problem.is_object_spherical = shape == "sphere";
  const Prediction found = model().predict(problem);
  ASSERT_TRUE(found.has_answer);
  std::printf("%s nu %g h/R %g d/h %.2f: a %+.2f %%, d %+.2f %%, torque %+.2f %%\n", truth.shape,
              truth.nu, truth.thickness_over_radius, truth.approach,
              100 * (found.a_m / h / truth.radius - 1),
              100 * (found.indentation_m / h / truth.approach - 1),
              100 * (found.torque_arm_exact_m / h / truth.arm - 1));
  // Accuracy required of the model: 2 % in the semi-axes and the torque, 3 % in the indentation.
  EXPECT_NEAR(found.a_m / h / truth.radius, 1, 0.02);
  EXPECT_NEAR(found.indentation_m / h / truth.approach, 1, 0.03);
  EXPECT_NEAR(found.torque_arm_exact_m / h / truth.arm, 1, 0.02);
}

INSTANTIATE_TEST_SUITE_P(
    Published, LargeStrains,
    ::testing::Values(LargeStrain{"sphere", 0.3, 0.2, 0.058463438, 0.581871, 0.05, 0.3428205},
                      LargeStrain{"sphere", 0.3, 0.2, 0.84271859, 1.25693, 0.2, 0.7313859},
                      LargeStrain{"sphere", 0.3, 0.2, 3.6269091, 1.815325, 0.4, 1.037918},
                      LargeStrain{"sphere", 0.49, 0.2, 0.070051476, 0.6152186, 0.05, 0.3629744},
                      LargeStrain{"sphere", 0.49, 0.2, 1.2649318, 1.384202, 0.2, 0.8041896},
                      LargeStrain{"sphere", 0.49, 0.2, 6.2392276, 2.051439, 0.4, 1.181194},
                      LargeStrain{"parab", 0.3, 0.2, 0.058587957, 0.5832654, 0.05, 0.3434357},
                      LargeStrain{"parab", 0.3, 0.2, 0.85241755, 1.270242, 0.2, 0.7369258},
                      LargeStrain{"parab", 0.3, 0.2, 3.7146723, 1.854477, 0.4, 1.053017},
                      LargeStrain{"parab", 0.49, 0.2, 0.070249098, 0.6168765, 0.05, 0.3637161},
                      LargeStrain{"parab", 0.49, 0.2, 1.288059, 1.401529, 0.2, 0.8114844},
                      LargeStrain{"parab", 0.49, 0.2, 6.5163385, 2.105334, 0.4, 1.202287},
                      LargeStrain{"curved", 0.3, 0.2, 0.055000152, 0.5749643, 0.05, 0.3378439},
                      LargeStrain{"curved", 0.3, 0.2, 0.77466787, 1.247778, 0.2, 0.7161488},
                      LargeStrain{"curved", 0.3, 0.2, 3.3215215, 1.806159, 0.4, 0.9972237},
                      LargeStrain{"curved", 0.49, 0.2, 0.063688335, 0.603037, 0.05, 0.354725},
                      LargeStrain{"curved", 0.49, 0.2, 1.0809245, 1.361601, 0.2, 0.7784857},
                      LargeStrain{"curved", 0.49, 0.2, 5.1947196, 2.035054, 0.4, 1.121964},
                      LargeStrain{"curved", 0.3, 0.4, 0.10280286, 0.5598651, 0.09999997, 0.3285393},
                      LargeStrain{"curved", 0.3, 0.4, 0.36559133, 0.8197817, 0.2, 0.4769888},
                      LargeStrain{"curved", 0.3, 0.4, 0.80726665, 1.020585, 0.3, 0.5859378},
                      LargeStrain{"curved", 0.3, 0.4, 1.4584725, 1.187039, 0.4, 0.6697363}));

TEST(FingertipLayer, NeverAllocates) {
  model().predict(finger_on_plane(1));
  const std::size_t before = testing::allocations();
  const Prediction found = model().predict(finger_on_plane(2));
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_TRUE(found.valid());
}

TEST(FingertipLayer, SaysWhereItWasNotFitted) {
  const auto failing = [](const ContactProblem& problem) {
    std::string names;
    for (const ValidityCheck& check : model().predict(problem).validity)
      if (!check.holds()) names += std::string(check.check) + " ";
    return names;
  };
  EXPECT_EQ(failing(finger_on_plane(1)), "");
  EXPECT_NE(failing(finger_on_plane(200)).find("table_indentation"), std::string::npos);
  EXPECT_NE(failing(finger_on_plane(0.1, 0.45, 0.003, 0.003)).find("table_curvature"),
            std::string::npos);
  ContactProblem hollow = finger_on_plane(1);
  hollow.finger_curvature.yy_per_m = -20;
  EXPECT_NE(failing(hollow).find("convex_finger"), std::string::npos);
  ContactProblem two = finger_on_plane(1);
  two.object_layer = two.layer;
  EXPECT_NE(failing(two).find("single_layer"), std::string::npos);
  ContactProblem broken = finger_on_plane(1);
  broken.finger_curvature.xx_per_m = NAN;
  EXPECT_NE(failing(broken).find("finger_curvature_in_range"), std::string::npos);
}

}  // namespace
}  // namespace softfinger
