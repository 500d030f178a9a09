#include "fem/problem/check_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "fem/base/formatted.h"

namespace softfinger::fem {
namespace {

Problem good_problem() {
  Problem problem;
  problem.contact = {{0.02, 0.01, 0}, {2e-3, 3e5, 0.4}, {1, 0.8}};
  return problem;
}

Sublayer half(double poisson_ratio) { return {{1e-3, 3e5, poisson_ratio}, {}}; }

struct Refused {
  const char* field;
  std::function<void(Problem&)> change;
};

const Refused refused[] = {
    {"R'", [](Problem& p) { p.contact.radii.major_m = INFINITY; }},
    {"R'", [](Problem& p) { p.contact.radii.major_m = 0.009; }},
    {"R''", [](Problem& p) { p.contact.radii.minor_m = 0; }},
    {"R'/R''", [](Problem& p) { p.contact.radii.major_m = 1.01; }},
    {"thickness_m", [](Problem& p) { p.contact.layer.thickness_m = -1; }},
    {"youngs_modulus_Pa", [](Problem& p) { p.contact.layer.youngs_modulus_Pa = NAN; }},
    {"poisson_ratio", [](Problem& p) { p.contact.layer.poisson_ratio = 0.501; }},
    {"poisson_ratio", [](Problem& p) { p.contact.layer.poisson_ratio = -0.01; }},
    {"load_N", [](Problem& p) { p.contact.load.normal_force_N = 0; }},
    {"approach_m", [](Problem& p) { p.approach_m = -1e-4; }},
    {"friction_coefficient", [](Problem& p) { p.contact.load.friction_coefficient = 0; }},
    {"shear_strength_Pa",
     [](Problem& p) {
       p.shear_law = ShearLaw::Kind::limited;
       p.shear_strength_Pa = NAN;
     }},
    {"sphere_radius_m", [](Problem& p) { p.sphere_radius_m = 0.02; }},
    {"sphere_radius_m", [](Problem& p) { p.sphere_radius_m = 0.01; }},
    {"object layer's youngs_modulus_Pa",
     [](Problem& p) { p.contact.object_layer.thickness_m = 1e-3; }},
    {"sublayer's poisson_ratio",
     [](Problem& p) {
       p.sublayers = {half(0.3), half(0.6)};
     }},
    {"sublayers' thickness_m", [](Problem& p) { p.sublayers = {half(0.3)}; }},
    {"sublayer's thickness_m",
     [](Problem& p) {
       p.sublayers = {half(0.3), half(0.3)};
       p.sublayers[0].layer.thickness_m = 0.039e-3;
       p.sublayers[1].layer.thickness_m = 1.961e-3;
     }},
    {"compliance_file",
     [](Problem& p) {
       p.sublayers = {half(0.3), half(0.3)};
       p.compliance_file = "f";
     }},
    {"compliance_file",
     [](Problem& p) {
       p.finite_strain.emplace();
       p.compliance_file = "f";
     }},
    {"torsion_increments",
     [](Problem& p) {
       p.friction.torsion = true;
       p.friction.increments = 0;
     }},
    {"limit_surface", [](Problem& p) { p.friction.limit_surface = 10001; }},
    {"limit_surface", [](Problem& p) { p.friction.limit_surface = -1; }},
    {"increments_to_slip", [](Problem& p) { p.friction.increments_to_slip = 1001; }},
    {"level", [](Problem& p) { p.level = 0; }},
    {"level", [](Problem& p) { p.level = 5; }},
    {"approach_m",
     [](Problem& p) {
       p.finite_strain.emplace();
       p.approach_m = 2e-3;
     }},
};

TEST(CheckProblem, RefusesEachBadValueByItsName) {
  EXPECT_NO_THROW(check_problem(good_problem()));
  for (const Refused& each : refused) {
    Problem problem = good_problem();
    each.change(problem);
    try {
      check_problem(problem);
      ADD_FAILURE() << each.field;
    } catch (const InputError& error) {
      EXPECT_EQ(error.field(), each.field) << error.what();
    }
  }
}

TEST(CheckProblem, TakesTheEndsOfItsRanges) {
  const auto takes = [](const std::function<void(Problem&)>& change) {
    Problem problem = good_problem();
    change(problem);
    EXPECT_NO_THROW(check_problem(problem));
  };
  takes([](Problem& p) { p.contact.radii.major_m = 1; });
  takes([](Problem& p) { p.contact.layer.poisson_ratio = 0.5; });
  takes([](Problem& p) { p.contact.layer.poisson_ratio = 0; });
  takes([](Problem& p) {
    p.approach_m = 1e-4;
    p.contact.load.normal_force_N = 0;
  });
  takes([](Problem& p) { p.sublayers = {half(0), half(0.5)}; });
  takes([](Problem& p) {
    p.sublayers = {half(0.3), half(0.3)};
    p.sublayers[0].layer.thickness_m = 0.041e-3;
    p.sublayers[1].layer.thickness_m = 1.959e-3;
  });
  takes([](Problem& p) { p.level = 4; });
}

TEST(CheckProblem, NamesWhatTheContactIsPressedBy) {
  Problem problem = good_problem();
  EXPECT_EQ(too_much(problem, "less").field(), "load_N");
  EXPECT_EQ(too_much(problem, "less").value(), "1");
  problem.approach_m = 1e-4;
  EXPECT_EQ(too_much(problem, "less").field(), "approach_m");
  EXPECT_EQ(too_much(problem, "less").value(), "0.0001");
}

TEST(CheckProblem, TwistTurnsAboutAPointOfTheContact) {
  Problem problem = good_problem();
  LevelResult contact;
  contact.a_m = 2e-3;
  contact.b_m = 1e-3;
  problem.friction.twist_axis_x_m = 1.9e-3;
  EXPECT_NO_THROW(check_twist_axis(problem, contact));
  problem.friction.twist_axis_y_m = 0.9e-3;
  EXPECT_THROW(check_twist_axis(problem, contact), InputError);
}

TEST(Formatted, IsAsLongAsItNeedsToBe) {
  EXPECT_EQ(formatted("%d of %s", 3, "four"), "3 of four");
  EXPECT_EQ(formatted("%s", ""), "");
  EXPECT_EQ(formatted("%1000d", 1).size(), 1000u);
}

}  // namespace
}  // namespace softfinger::fem
