#include "softfinger/accuracy/default_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "softfinger/accuracy/error_bound.h"
#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

/// A silicone finger of 9 and 7 mm on a plane.
ContactProblem finger_on_plane() {
  ContactProblem problem;
  problem.radii = {9e-3, 7e-3, 0};
  problem.layer = {2e-3, 3e5, 0.49};
  problem.load = {2, 0.8};
  problem.finger_curvature = {1 / 9e-3, 1 / 7e-3, 0};
  return problem;
}

TEST(DefaultModel, IsTheFingertipLayerOnAConvexFinger) {
  EXPECT_EQ(default_model(finger_on_plane()).card().name, "fingertip_layer");
  ContactProblem flat = finger_on_plane();
  flat.finger_curvature = {};
  EXPECT_EQ(default_model(flat).card().name, "fingertip_layer");
}

TEST(DefaultModel, IsTheBondedLayerWhereTheFingertipLayerWasNotFitted) {
  ContactProblem hollow = finger_on_plane(), two_layers = hollow, thick = hollow, slender = hollow;
  hollow.finger_curvature = {-1 / 9e-3, 1 / 7e-3, 0};
  EXPECT_EQ(default_model(hollow).card().name, "bonded_layer");
  two_layers.object_layer = two_layers.layer;
  EXPECT_EQ(default_model(two_layers).card().name, "bonded_layer");
  thick.layer.thickness_m = 5e-3;
  EXPECT_EQ(default_model(thick).card().name, "bonded_layer");
  slender.radii.major_m = 21 * slender.radii.minor_m;
  slender.finger_curvature = {1 / slender.radii.major_m, 1 / slender.radii.minor_m, 0};
  EXPECT_EQ(default_model(slender).card().name, "bonded_layer");
}

TEST(DefaultModel, StaysTheSameAsTheContactIsPressed) {
  ContactProblem problem = finger_on_plane();
  const PressureModel* const model = &default_model(problem);
  for (double load_N = 1e-6; load_N < 1e6; load_N *= 3) {
    problem.load.normal_force_N = load_N;
    EXPECT_EQ(&default_model(problem), model) << load_N;
    EXPECT_TRUE(model->predict(problem).has_answer) << load_N;
  }
}

TEST(DefaultModel, HasTheSmallestKnownBound) {
  std::mt19937_64 generator{7};
  std::uniform_real_distribution<double> uniform(0, 1);
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    ContactProblem problem = finger_on_plane();
    problem.layer.poisson_ratio = 0.5 * uniform(generator);
    problem.radii.minor_m = problem.radii.major_m * std::pow(20, -uniform(generator));
    const double part = uniform(generator);
    problem.finger_curvature = {part / problem.radii.major_m, part / problem.radii.minor_m, 0};
    problem.load.normal_force_N = std::pow(10, 3 * uniform(generator) - 2);
    const ErrorBound own = error_bound(default_model(problem), problem);
    if (!own.known) continue;
    for (const PressureModel* model : all_pressure_models()) {
      if (!model->card().hot_path) continue;
      const ErrorBound other = error_bound(*model, problem);
      if (other.known) {
        EXPECT_LE(worst_of(own.bound), 1.05 * worst_of(other.bound))
            << model->card().name << ": a bound is |error| + ratio x width, with ratios near 1";
      }
    }
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST(WorstError, IsInfiniteWhereADemandedOneIsNotKnown) {
  BoundedErrors errors = {0.01, 0.02, 9, 0.03, 9, 0.04};
  EXPECT_EQ(worst_of(errors), 0.04) << "indentation and peak pressure are not demanded";
  errors[2] = std::nan("");
  EXPECT_EQ(worst_of(errors), 0.04);
  errors[0] = std::nan("");
  EXPECT_EQ(worst_of(errors), kInfinity);
  EXPECT_EQ(worst_of(errors, {false, false, false, false, false, true}), 0.04);
}

}  // namespace
}  // namespace softfinger
