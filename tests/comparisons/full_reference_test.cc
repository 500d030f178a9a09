// The reference that a case gets where its [fem] leaves it open.
#include "comparisons/reference/full_reference.h"

#include <gtest/gtest.h>

#include <string>

#include "comparisons/judgement/comparison.h"

namespace softfinger {
namespace {

const char* const kBodies = "finger.radii_mm = [20, 9]\nobject.radii_mm = [inf, inf]";

input::Case case_with(const std::string& geometry, double load_N, const std::string& fem = "") {
  return input::parse_case("id = \"x\"\n[geometry]\n" + geometry +
                               "\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
                               "poisson_ratio = 0.45\n[contact]\nload_N = [0.00001, " +
                               std::to_string(load_N) + "]\nfriction_coefficient = 0.5\n" +
                               (fem.empty() ? "" : "[fem]\n" + fem + "\n"),
                           "x.toml");
}

input::Case full(const input::Case& typed, reference::Idealisations idealisations = {}) {
  return reference::with_full_reference(typed, prediction::GeometryResolver(typed), idealisations);
}

TEST(FullReference, IsTheFingerAtFiniteStrain) {
  const input::Case found = full(case_with(kBodies, 2));
  EXPECT_TRUE(found.fem_curved);
  ASSERT_TRUE(found.fem_finite);
  EXPECT_EQ(judgement::reference_in_words(found),
            "the finger at finite strain, pressed with friction");
  const auto& finger =
      std::get<input::QuadricBody>(std::get<input::BodyPair>(found.geometry).finger);
  EXPECT_EQ(finger.shape, input::FingerShape::ellipsoid);
}

TEST(FullReference, IsLinearWhereNothingMoves) {
  const input::Case found = full(case_with("relative_radii_mm = [200, 100]", 1e-4));
  EXPECT_FALSE(found.fem_curved) << "radii alone";
  EXPECT_FALSE(found.fem_finite);
  EXPECT_TRUE(full(case_with("relative_radii_mm = [20, 10]", 1)).fem_finite);
}

TEST(FullReference, LeavesOutWhatItIsAskedTo) {
  const input::Case typed = case_with(kBodies, 2);
  const input::Case flat = full(typed, {false, true});
  EXPECT_FALSE(flat.fem_curved);
  EXPECT_TRUE(flat.fem_finite);
  const input::Case linear = full(typed, {true, false});
  EXPECT_TRUE(linear.fem_curved);
  EXPECT_FALSE(linear.fem_finite);
}

TEST(FullReference, IsWhatTheCaseChose) {
  const input::Case linear = full(case_with(kBodies, 2, "kinematics = \"linear\""));
  EXPECT_TRUE(linear.fem_curved);
  EXPECT_FALSE(linear.fem_finite);
  const input::Case flat = full(case_with(kBodies, 2, "geometry = \"flat\""));
  EXPECT_FALSE(flat.fem_curved);
  EXPECT_TRUE(flat.fem_finite);
  const input::Case curved = full(case_with(kBodies, 2, "geometry = \"curved\""), {true, true});
  EXPECT_TRUE(curved.fem_curved) << "before the command";
  EXPECT_FALSE(full(case_with(kBodies, 2, "mesh = \"layer.msh\"")).fem_curved);
}

TEST(FullReference, KnowsWhatACaseLeavesOutOfIt) {
  const auto leaves_nothing_out = [](const input::Case& solved) {
    return reference::is_full_reference(solved, prediction::GeometryResolver(solved));
  };
  const input::Case typed = case_with(kBodies, 2);
  EXPECT_TRUE(leaves_nothing_out(full(typed)));
  EXPECT_FALSE(leaves_nothing_out(full(typed, {true, false}))) << "linear";
  EXPECT_FALSE(leaves_nothing_out(full(typed, {false, true}))) << "flat";
  EXPECT_FALSE(leaves_nothing_out(full(case_with(kBodies, 2, "geometry = \"flat\""))));
  EXPECT_FALSE(leaves_nothing_out(full(case_with(kBodies, 2, "mesh = \"layer.msh\""))))
      << "in linear theory";
  EXPECT_TRUE(leaves_nothing_out(full(case_with("relative_radii_mm = [20, 10]", 1))));
  EXPECT_TRUE(
      leaves_nothing_out(full(case_with("relative_radii_mm = [200, 100]", 1e-4), {true, true})))
      << "where neither changes a number";
}

TEST(FullReference, JudgesByTheApproachWhereThatIsGiven) {
  const input::Case typed = case_with("relative_radii_mm = [200, 100]", 1e-4);
  const prediction::GeometryResolver geometry(typed);
  const auto pressed_by = [&](double approach_m) {
    return reference::with_full_reference(typed, geometry, {}, approach_m);
  };
  EXPECT_FALSE(full(typed).fem_finite) << "by its load";
  EXPECT_TRUE(pressed_by(0.5e-3).fem_finite) << "a quarter of the layer";
  EXPECT_FALSE(pressed_by(1e-6).fem_finite);
}

TEST(FullReference, TakesNoFlatFingerForAnEllipsoid) {
  const input::Case found =
      full(case_with("finger.radii_mm = [inf, inf]\nobject.sphere_radius_mm = 8", 2));
  EXPECT_TRUE(found.fem_curved);
  const auto& finger =
      std::get<input::QuadricBody>(std::get<input::BodyPair>(found.geometry).finger);
  EXPECT_EQ(finger.shape, input::FingerShape::paraboloid);
}

TEST(SoundModel, IsNotBlamedForWhatTheReferenceMeasures) {
  const input::Case finite = full(case_with(kBodies, 2)),
                    linear = full(case_with(kBodies, 2), {true, false});
  Prediction prediction;
  prediction.has_answer = true;
  prediction.validity.add({"small_strain", 0.4, 0.3, true, ""});
  EXPECT_TRUE(judgement::is_sound(prediction, finite));
  EXPECT_FALSE(judgement::is_sound(prediction, linear));
  prediction.validity.add({"thick_layer", 2, 0.7, true, ""});
  EXPECT_FALSE(judgement::is_sound(prediction, finite));
  prediction.has_answer = false;
  EXPECT_FALSE(judgement::is_sound(prediction, finite));
}

}  // namespace
}  // namespace softfinger
