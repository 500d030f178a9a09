// Bounds against the finger: where they are known, what they grow with, and that they cost nothing.
#include "softfinger/accuracy/error_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "softfinger/layer/fingertip_layer_core.h"
#include "tests/allocation_counter.h"

namespace softfinger {
namespace {

ContactProblem contact(double load_N, double nu = 0.45, double radius_m = 0.01) {
  return {{radius_m, radius_m, 0}, {0.002, 3e5, nu}, {load_N, 0.5}, {}, {}};
}

/// The finger has these parts of the gap's curvature along both axes.
ContactProblem shared(ContactProblem problem, double x, double y) {
  problem.finger_curvature = {x / problem.radii.major_m, y / problem.radii.minor_m, 0};
  return problem;
}

constexpr std::size_t kTorque = 5;

TEST(ErrorBound, IsSmallForALayerAndLargeForAHalfSpaceOnAThinOne) {
  const ErrorBound layer = error_bound(*find_pressure_model("bonded_layer"), contact(2));
  const ErrorBound hertz = error_bound(*find_pressure_model("hertz"), contact(2));
  ASSERT_TRUE(layer.known && hertz.known);
  EXPECT_LT(layer.bound[kTorque], 0.05);
  EXPECT_GT(hertz.bound[kTorque], 0.1);
  EXPECT_GT(hertz.expected[kTorque], 0.1) << "a half-space is softer";
}

TEST(ErrorBound, VanishesWithTheLoadUpToTheScatterOfTheElements) {
  const PressureModel& layer = *find_pressure_model("bonded_layer");
  const ErrorBound light = error_bound(layer, shared(contact(1e-6, 0.45, 0.5), 1, 1));
  ASSERT_TRUE(light.known);
  for (std::size_t q = 0; q < kBoundedQuantities; ++q) {
    EXPECT_LT(std::abs(light.expected[q]), 1e-3) << q;
    EXPECT_LT(light.bound[q], kFingertipLayerTable.widths[q].least + 2e-3) << q;
  }
  // On a flat layer the torque's is the spectral solution's there, finer than the elements.
  EXPECT_LT(error_bound(layer, contact(1e-6, 0.45, 0.5)).bound[kTorque], 1e-4);
  // A firmer press may move one quantity through zero, but widens every bound's own width.
  const ErrorBound firm = error_bound(layer, shared(contact(3), 1, 1));
  for (std::size_t q = 0; q < kBoundedQuantities; ++q)
    EXPECT_GE(firm.bound[q] - std::abs(firm.expected[q]),
              light.bound[q] - std::abs(light.expected[q]));
}

TEST(ErrorBound, SaysWhatEachCauseCosts) {
  const auto cause = [](const ErrorBound& bound, ErrorCause which) {
    return bound.causes[std::size_t(which)];
  };
  for (const char* name : {"bonded_layer", "hertz"})
    for (const auto& [x, y] : {std::pair(0., 0.), {1., 1.}, {0.3, 0.9}}) {
      const ErrorBound bound = error_bound(*find_pressure_model(name), shared(contact(2), x, y));
      ASSERT_TRUE(bound.known);
      for (std::size_t q = 0; q < kBoundedQuantities; ++q) {
        double sum = 0;
        for (const BoundedErrors& one : bound.causes) sum += one[q];
        EXPECT_NEAR(sum, bound.expected[q], 1e-14) << "round-off of four terms of order one";
        if (std::string(name) == "bonded_layer") {
          EXPECT_EQ(cause(bound, ErrorCause::model)[q], 0);
        }
        if (x == 0) {
          EXPECT_EQ(cause(bound, ErrorCause::curvature)[q], 0) << "flat";
        } else {
          EXPECT_NE(cause(bound, ErrorCause::curvature)[q], 0);
        }
        EXPECT_NE(cause(bound, ErrorCause::strain)[q], 0);
        EXPECT_NE(cause(bound, ErrorCause::slope)[q], 0);
      }
    }
  // Terms of strain alone vanish with d/h, those of slope with a/R.
  const ErrorBound thick = error_bound(*find_pressure_model("bonded_layer"),
                                       {{0.002, 0.002}, {0.01, 3e5, 0.3}, {0.02, 0.5}});
  ASSERT_TRUE(thick.known) << thick.outside;
  EXPECT_LT(std::abs(cause(thick, ErrorCause::strain)[0]), 0.02);
}

TEST(ErrorBound, SaysWhereNothingIsKnown) {
  const PressureModel& layer = *find_pressure_model("bonded_layer");
  const auto reason = [&](const ContactProblem& problem) {
    const ErrorBound bound = error_bound(layer, problem);
    EXPECT_FALSE(bound.known);
    return std::string(bound.outside);
  };
  EXPECT_NE(reason(shared(contact(2), -0.5, 1)).find("hollow"), std::string::npos);
  EXPECT_NE(reason(shared(contact(2), NAN, 1)).find("no answer"), std::string::npos);
  // A hollow object is no reason, a finger without a core is.
  EXPECT_TRUE(error_bound(layer, shared(contact(2), 1.5, 1)).known);
  EXPECT_NE(reason(shared(contact(0.1, 0.45, 0.003), 1, 1)).find("smallest radius"),
            std::string::npos);
  ContactProblem slender = contact(0.1);
  slender.radii = {0.3, 0.01, 0};
  EXPECT_NE(reason(slender).find("R'/R''"), std::string::npos);
  EXPECT_NE(reason(contact(1000)).find("not known"), std::string::npos);
  ContactProblem two = contact(1);
  two.object_layer = two.layer;
  EXPECT_NE(reason(two).find("two layers"), std::string::npos);
  EXPECT_FALSE(error_bound(layer, contact(std::numeric_limits<double>::infinity())).known);
}

TEST(ErrorBound, NeverAllocates) {
  const PressureModel& hertz = *find_pressure_model("hertz");
  error_bound(hertz, contact(1));
  const std::size_t before = testing::allocations();
  const ErrorBound bound = error_bound(hertz, shared(contact(1.5), 1, 1));
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_TRUE(bound.known);
}

}  // namespace
}  // namespace softfinger
