#include "comparisons/judgement/atlas/error_causes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "comparisons/judgement/atlas/atlas_overview.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

// Arms of circles of radius one: 3 pi/16 for Hertz, 8/15 for Winkler.
TEST(ErrorCauses, TellEllipseFromPressureOnCircles) {
  const judgement::TorqueContact truth{1, 1, 8. / 15}, model{1.1, 1.1, 1.1 * 3 * kPi / 16};
  const judgement::TorqueCauses causes = judgement::torque_causes(model, truth);
  EXPECT_NEAR(causes.ellipse, 0.1, 1e-12);
  EXPECT_NEAR(causes.pressure, 45 * kPi / 128 - 1, 1e-12);
  EXPECT_NEAR(causes.circle_rule, 0, 1e-15);
}

// At a/b = 2 the complete elliptic integral E(3/4) is 1.2110560275684595, whatever the pressure.
TEST(ErrorCauses, GiveTheCircleRuleByTheEllipticIntegral) {
  const double expected = std::sqrt(2.) / (2 * 2 / kPi * 1.2110560275684595) - 1;
  EXPECT_NEAR(expected, -0.0829, 1e-4);
  for (const double exponent : {0.5, 1., 1.7}) {
    const judgement::TorqueContact contact{2, 1, torque_arm_exact_m(2, 1, exponent)};
    EXPECT_NEAR(judgement::torque_causes(contact, contact).circle_rule, expected, 1e-12);
    EXPECT_NEAR(judgement::exponent_of(contact), exponent, 1e-9);
  }
}

TEST(ErrorCauses, MultiplyToTheWholeError) {
  judgement::AtlasRun run;
  run.answer = {1.3, 0.6, 0.1, 2.4, 0.5, 0.48};
  const judgement::QuantityErrors errors = {0.2, -0.3, 0, 0, 0, 0.07};
  const judgement::TorqueCauses causes =
      judgement::torque_causes(judgement::contact_of(run, errors), judgement::contact_of(run));
  EXPECT_NEAR((1 + causes.ellipse) * (1 + causes.pressure), 1.07, 1e-12);
  // Semi-axes in either order, as finite elements of round contacts find them.
  const judgement::TorqueCauses swapped =
      judgement::torque_causes({1, 1.001, 0.55}, {1.001, 1, 0.55});
  EXPECT_NEAR(swapped.ellipse, 0, 1e-12);
}

// limit_surface.h and linearised_friction.h state these.
TEST(ErrorCauses, KnowEllipsoidAndFacets) {
  EXPECT_NEAR(judgement::ellipsoid_error(1, 0.5), 0.06, 1e-4);
  EXPECT_NEAR(judgement::ellipsoid_error(5, 0.5), 0.1085, 1e-4);
  EXPECT_NEAR(judgement::facet_error(32), 1 - 0.922, 1e-3);
}

TEST(AtlasOverview, KeepsTheOrderOfTheGridAndTheQuantiles) {
  judgement::AtlasFile atlas;
  for (const double nu : {0.3, 0.5})
    for (const double ratio : {1., 4.})
      for (const double s : {0.2, 2.}) {
        judgement::AtlasRun run;
        run.kind = judgement::AtlasKind::flat;
        run.poisson_ratio = nu;
        run.radii_ratio = ratio;
        run.s = s;
        run.answer = {s * 1.1, s, s * s, kPi * s * s * 1.1, 1, 0.55 * s};
        run.stated_error.fill(0.001);
        run.coarse_error.fill(-0.004);
        run.cost_s = 2;
        run.coarse_cost_s = 0.5;
        judgement::QuantityErrors errors;
        errors.fill(0.01 * double(atlas.runs.size()) - 0.05);
        atlas.runs.push_back(run);
        atlas.errors["hertz"].push_back(errors);
      }
  atlas.errors["hertz"].back().fill(NAN);  // no answer there
  const nlohmann::json overview = judgement::atlas_overview(atlas);
  const nlohmann::json& hertz = overview["models"][0];
  EXPECT_EQ(hertz["model"], "hertz");
  EXPECT_GT(hertz["cost_ns"].get<double>(), 0);
  EXPECT_EQ(hertz["grid"]["a"],
            (nlohmann::json{-0.05, -0.04, -0.03, -0.02, -0.01, 0.0, 0.01, nullptr}));
  const nlohmann::json& torque = hertz["quantiles"]["max_torque"];
  EXPECT_EQ(torque["count"], 7);
  EXPECT_EQ(torque["median"], 0.02);
  EXPECT_EQ(torque["worst"], 0.05);
  EXPECT_EQ(overview["models"][1]["model"], "fem_coarse");
  EXPECT_EQ(overview["models"][1]["cost_ns"], 5e8);
  EXPECT_EQ(overview["models"][1]["quantiles"]["b"]["p95"], 0.004);
  EXPECT_EQ(overview["models"][2]["quantiles"]["a"]["worst"], 0.001);
  EXPECT_EQ(overview["grid"]["radii_ratio"], (nlohmann::json{1, 4}));
  EXPECT_TRUE(judgement::atlas_overview({}).is_null());
}

}  // namespace
}  // namespace softfinger
