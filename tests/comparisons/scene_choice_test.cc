#include "comparisons/judgement/selection/scene_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "softfinger/dynamics/step/eccentricity_law.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

const auto silent = [](const std::string&) {};

/// The pinch on a layer thinner than any in the atlas: no model's error is known.
input::Scene outside_the_atlas() {
  input::Scene scene = input::read_scene(SOFTFINGER_SCENES "/pinch.toml");
  for (auto& body : scene.bodies)
    if (body.layer) body.layer->thickness_m = 5e-5;
  return scene;
}

/// Finite elements that answer with a multiple of the bonded layer's e_n.
struct PretendedFem {
  double factor, error;
  int& calls;

  judgement::FemEccentricity operator()(const judgement::FingerContact& contact, double least_N,
                                        double largest_N) const {
    ++calls;
    EXPECT_GT(contact.problem.finger_curvature.xx_per_m, 0) << "the finger's own";
    judgement::FemEccentricity found;
    found.error = error;
    const SampledEccentricity law = SampledEccentricity::of_model(
        *find_pressure_model("bonded_layer"), contact.problem, least_N, largest_N);
    constexpr int loads = 6;
    for (int i = 0; i < loads; ++i)
      found.eccentricity_m.push_back(
          factor * law.eccentricity_m(least_N * std::pow(largest_N / least_N, i / (loads - 1.))));
    return found;
  }
};

}  // namespace

TEST(InterpolationError, VanishesForPowersAndIsExactForParabolas) {
  std::vector<double> power, parabola;
  constexpr double curvature = 0.01;
  for (int i = 0; i < 6; ++i) {
    power.push_back(0.003 * std::exp(0.3 * i));
    parabola.push_back(0.003 * std::exp(0.3 * i + curvature * i * i));
  }
  EXPECT_NEAR(judgement::interpolation_error(power), 0, 1e-14) << "round-off of a logarithm";
  // Between two samples a parabola c x² lies c/4 below its chord.
  EXPECT_NEAR(judgement::interpolation_error(parabola), curvature / 4, 1e-14);
  EXPECT_EQ(judgement::interpolation_error({1, 2}), 0);
}

TEST(SceneChoice, AsksFiniteElementsOnceWhereNoModelIsKnown) {
  int calls = 0;
  constexpr double factor = 1.1;
  const input::Scene scene = outside_the_atlas();
  const judgement::SceneChoice choice =
      judgement::choose_for_scene(scene, 0.01, PretendedFem{factor, 1e-3, calls}, silent);
  EXPECT_EQ(calls, 1) << "both fingertips are alike";
  ASSERT_EQ(choice.pairs.size(), 2u);
  for (const judgement::PairChoice& pair : choice.pairs) {
    EXPECT_EQ(pair.detail, judgement::ContactDetail::fem_table) << pair.reason;
    EXPECT_NE(pair.reason.find("finite elements of the finger itself is"), std::string::npos)
        << pair.reason;
    EXPECT_EQ(pair.reason.find("no better is known"), std::string::npos) << pair.reason;
    // The motion is that of the table's e_n: its torque at the limit is the factor's.
    const auto largest_torque = [&](const input::Scene& of) {
      double largest_Nm = 0;
      for (const auto& frame : simulation::simulate(of).recording.frames)
        for (const auto& contact : frame.contacts)
          largest_Nm = std::max(largest_Nm, std::abs(contact.torque_Nm));
      return largest_Nm;
    };
    input::Scene layer = scene;
    for (auto& rule : layer.rules) rule.model = find_pressure_model("bonded_layer");
    // The load hardly changes, and ends of a table are samples.
    EXPECT_NEAR(largest_torque(choice.scene) / largest_torque(layer), factor, 1e-6);
  }
  EXPECT_TRUE(choice.motion_holds) << "the reference has the tables too";
  EXPECT_NE(judgement::reference_in_words(choice).find("finite elements"), std::string::npos)
      << "what it is compared with";
  EXPECT_EQ(judgement::table(choice, 0.01).find("recommended model and exact limit surfaces every"),
            std::string::npos);
}

TEST(SceneChoice, GivesFiniteElementsTheFingersOwnCurvature) {
  // Fingertips of radius 10 mm meet the pole of an ellipsoid of semi-axes 12, 30, 12 mm, of radius
  // 12² / 30 mm. What they use of their limit is that of the run with the table.
  ContactProblem asked;
  const auto fem = [&](const judgement::FingerContact& contact, double, double) {
    asked = contact.problem;
    EXPECT_TRUE(contact.is_finger_spherical);
    return judgement::FemEccentricity{std::vector<double>(6, 0.1), 1e-3};
  };
  const input::Scene scene = input::read_scene(SOFTFINGER_SCENES "/lift_curved.toml");
  const judgement::SceneChoice choice = judgement::choose_for_scene(scene, 0.05, fem, silent);
  EXPECT_NEAR(asked.finger_curvature.xx_per_m, 1 / 0.01, 1e-6);
  EXPECT_NEAR(asked.finger_curvature.yy_per_m, 1 / 0.01, 1e-6);
  EXPECT_NEAR(1 / asked.radii.major_m, 1 / 0.01 + 1 / 0.0048, 1e-6);
  EXPECT_FALSE(asked.is_object_spherical);
  for (const judgement::PairChoice& pair : choice.pairs)
    EXPECT_LT(pair.utilisation, 0.9) << "an arm of 100 mm holds the object with ease";
}

TEST(SceneChoice, AllowsHalfOfTheMarginOfAContactThatSticks) {
  int calls = 0;
  const input::Scene scene = input::read_scene(SOFTFINGER_SCENES "/lift_box.toml");
  const judgement::PairChoice first =
      judgement::choose_for_scene(scene, 1e-3, PretendedFem{1, 1e-3, calls}, silent).pairs.front();
  ASSERT_LT(first.utilisation, 1);
  // The margin is that of the first run, which differs by the rounding of impulses at most.
  EXPECT_NEAR(first.allowed_error, (1 - first.utilisation) / 2, 1e-6);
}

TEST(SceneChoice, GivesNoNumbersBelowWhatASimulationTells) {
  judgement::MotionChange change;
  change.position_m = 1e-15;
  change.travel_m = 0.04;
  change.rotation_rad = 2e-14;
  change.turn_rad = 2.5e-14;
  change.body = "object";
  const std::string words = judgement::in_words(change);
  EXPECT_NE(words.find("less than 1e-06 mm of 40 mm"), std::string::npos) << words;
  EXPECT_NE(words.find("nothing turns"), std::string::npos) << words;
}

TEST(SceneChoice, TreatsContactsThatAreAlikeAlike) {
  // One fingertip is 1 % larger and pulled at with less torque than the other, as by chance.
  int calls = 0;
  for (const double tolerance : {0.2, 0.05, 0.01}) {
    input::Scene scene = input::read_scene(SOFTFINGER_SCENES "/lift_box.toml");
    bool is_first = true;
    for (auto& body : scene.bodies)
      for (auto& shape : body.shapes)
        if (auto* sphere = std::get_if<input::Sphere>(&shape.kind); sphere && is_first) {
          sphere->radius_m *= 0.99;
          is_first = false;
        }
    ASSERT_FALSE(is_first);
    const judgement::SceneChoice choice =
        judgement::choose_for_scene(scene, tolerance, PretendedFem{1, 1e-3, calls}, silent);
    ASSERT_EQ(choice.pairs.size(), 2u);
    const judgement::PairChoice &left = choice.pairs[0], &right = choice.pairs[1];
    EXPECT_EQ(left.detail, right.detail) << tolerance;
    EXPECT_EQ(left.friction, right.friction);
    EXPECT_EQ(left.model, right.model);
    EXPECT_EQ(left.reason, right.reason);
  }
  EXPECT_LE(calls, 3) << "one table for both";
}

TEST(SceneChoice, SaysWhatIsSavedAndWhatIsNot) {
  judgement::SceneChoice choice;
  choice.accurate_step_ms = 0.259;
  choice.chosen_step_ms = 0.248;
  choice.models_step_ms = 2e-3;
  EXPECT_NE(saving_in_words(choice).find("no time to save"), std::string::npos);
  EXPECT_NE(saving_in_words(choice).find("2 µs of a step's 248 µs"), std::string::npos)
      << saving_in_words(choice);
  choice.chosen_step_ms = 0.1;
  EXPECT_NE(saving_in_words(choice).find("saves 61 % of its 259 µs"), std::string::npos)
      << saving_in_words(choice);
}

TEST(SceneChoice, SaysWhereFiniteElementsAreNotEnoughEither) {
  int calls = 0;
  const judgement::SceneChoice choice =
      judgement::choose_for_scene(outside_the_atlas(), 0.01, PretendedFem{1, 0.03, calls}, silent);
  for (const judgement::PairChoice& pair : choice.pairs) {
    EXPECT_EQ(pair.detail, judgement::ContactDetail::fem_table);
    EXPECT_NE(pair.reason.find("no better is known"), std::string::npos) << pair.reason;
  }
}

TEST(SceneChoice, KeepsAModelThatIsKnownBetterThanFiniteElements) {
  int calls = 0;
  const input::Scene scene = input::read_scene(SOFTFINGER_SCENES "/pinch.toml");
  // Finer than any model's bound.
  const judgement::SceneChoice choice =
      judgement::choose_for_scene(scene, 1e-5, PretendedFem{1, 0.3, calls}, silent);
  EXPECT_EQ(calls, 1);
  for (const judgement::PairChoice& pair : choice.pairs) {
    EXPECT_EQ(pair.detail, judgement::ContactDetail::limit_surface) << pair.reason;
    EXPECT_EQ(pair.model, "fingertip_layer");
    EXPECT_NE(pair.reason.find("no better is known"), std::string::npos) << pair.reason;
  }
}

}  // namespace softfinger
