#include "comparisons/judgement/verdict.h"

#include <gtest/gtest.h>

#include "comparisons/judgement/scoring.h"

namespace softfinger {
namespace {

constexpr double kTolerance = 0.1;
const char* const kReference = "the finger";

judgement::LoadErrors load(double load_N, std::vector<judgement::ModelError> models) {
  return {load_N, true, true, "", std::move(models)};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST(Verdict, NamesTheModelThatHoldsAtAllLoads) {
  const judgement::Verdict verdict = judgement::compose_verdict(
      {load(1, {{"hertz", true, true, 0.01, -0.02}, {"winkler", true, false, 0.5, 0.4}}),
       load(2, {{"hertz", true, true, 0.04, 0.01}, {"winkler", true, false, 0.7, 0.3}})},
      kTolerance, kReference);
  EXPECT_EQ(verdict.verdict_class, judgement::VerdictClass::good);
  EXPECT_EQ(verdict.sentence,
            "Use Hertz (contact within 4.0 %, torque within 2.0 % of the finger) at 1 and 2 N; "
            "Winkler is "
            "off by +70 % in area, +40 % in torque.");
}

TEST(Verdict, ClaimsNoBetterBoundThanATenthOfAPerCent) {
  EXPECT_EQ(judgement::compose_verdict({load(1, {{"hertz", true, true, 1e-6, -1e-5}})}, kTolerance,
                                       kReference)
                .sentence,
            "Use Hertz (contact within 0.1 %, torque within 0.1 % of the finger) at 1 N.");
}

TEST(Verdict, DoesNotClaimWhatTheMeshLeavesOpen) {
  judgement::LoadErrors open = load(0.2, {{"hertz", true, true, 0.01, 0.02}});
  open.geometry_error = 0.35;
  EXPECT_EQ(judge(open, open.models[0], kTolerance), judgement::Judgement::undetermined);
  const judgement::Verdict alone = judgement::compose_verdict({open}, kTolerance, kReference);
  EXPECT_EQ(alone.verdict_class, judgement::VerdictClass::undetermined);
  EXPECT_EQ(
      alone.sentence,
      "The mesh does not determine the contact at 0.2 N: its radii leave up to 35 % of contact "
      "or torque open; a finer scan, another point or a larger load would.");
  const judgement::Verdict partly = judgement::compose_verdict(
      {open, load(5, {{"hertz", true, true, 0.01, 0.02}})}, kTolerance, kReference);
  EXPECT_EQ(partly.verdict_class, judgement::VerdictClass::mixed);
  EXPECT_TRUE(contains(partly.sentence, "Use Hertz at 5 N")) << partly.sentence;
  EXPECT_TRUE(contains(partly.sentence, "the mesh does not determine the contact at 0.2 N"))
      << partly.sentence;
  open.geometry_error = 0.05;
  EXPECT_EQ(judge(open, open.models[0], kTolerance), judgement::Judgement::usable);
}

TEST(Verdict, SaysAtWhichLoadsAModelHoldsAndWhatIsNearestElsewhere) {
  const judgement::Verdict verdict = judgement::compose_verdict(
      {load(0.5, {{"hertz", true, true, 0.01, 0.02}, {"winkler", true, false, 0.5, 0.4}}),
       load(5, {{"hertz", true, false, 0.3, 0.2}, {"winkler", true, true, -0.2, 0.1}})},
      kTolerance, kReference);
  EXPECT_EQ(verdict.verdict_class, judgement::VerdictClass::mixed);
  EXPECT_EQ(
      verdict.sentence,
      "Use Hertz at 0.5 N (contact within 1.0 %, torque within 2.0 %); no model can be relied "
      "on at 5 N: nearest is Winkler, off by -20 % in area, +10.0 % in torque; ask the "
      "finite elements there.");
}

TEST(Verdict, PutsModelsTogetherThatHoldAtDifferentLoads) {
  const judgement::Verdict verdict = judgement::compose_verdict(
      {load(0.5, {{"hertz", true, true, 0.01, 0.02}, {"winkler", false, false, 0, 0}}),
       load(5, {{"hertz", true, false, 0.3, 0.2}, {"winkler", true, true, 0.05, 0.04}})},
      kTolerance, kReference);
  EXPECT_EQ(verdict.verdict_class, judgement::VerdictClass::mixed);
  EXPECT_EQ(
      verdict.sentence,
      "Use Hertz at 0.5 N (contact within 1.0 %, torque within 2.0 %), Winkler at 5 N (contact "
      "within 5.0 %, torque within 4.0 %).");
}

TEST(Verdict, SaysThatNoneHoldsAndHowNearTheNearestComes) {
  const judgement::Verdict verdict =
      judgement::compose_verdict({load(5, {{"hertz", true, false, 0.48, 0.2},
                                           {"layer", true, true, 0.104, 0.02},
                                           {"winkler", false, false, 0, 0}})},
                                 kTolerance, kReference);
  EXPECT_EQ(verdict.verdict_class, judgement::VerdictClass::bad);
  EXPECT_EQ(verdict.sentence,
            "No model can be relied on at 5 N: nearest is Layer, off by +10.4 % in area, +2.0 % in "
            "torque; ask the finite elements there.");
  EXPECT_EQ(judgement::compose_verdict({load(5, {{"winkler", false, false, 0, 0}})}, kTolerance,
                                       kReference)
                .sentence,
            "No model can be relied on at 5 N: none has an answer; ask the finite elements there.");
}

TEST(Verdict, DoesNotTrustAnErrorThatCrossesZeroOutsideTheAssumptions) {
  const judgement::Verdict verdict = judgement::compose_verdict(
      {load(5, {{"winkler", true, false, 0.02, -0.01}})}, kTolerance, kReference);
  EXPECT_EQ(verdict.verdict_class, judgement::VerdictClass::mixed);
  EXPECT_EQ(verdict.sentence,
            "No model can be relied on at 5 N: nearest is Winkler (contact within 2.0 %, "
            "torque within 1.0 %), outside its range, where its error may just cross zero; ask the "
            "finite elements there.");
}

TEST(Verdict, TellsWhenTheReferenceFailedOrIsDoubtful) {
  judgement::LoadErrors failed{5, false, false, "no convergence", {{"hertz", true, true, 0, 0}}};
  EXPECT_EQ(judgement::compose_verdict({failed}, kTolerance, kReference).verdict_class,
            judgement::VerdictClass::failed);
  judgement::LoadErrors doubtful = load(2, {{"hertz", true, true, 0.01, 0.01}});
  doubtful.fem_trusted = false;
  const judgement::Verdict verdict =
      judgement::compose_verdict({doubtful, failed}, kTolerance, kReference);
  EXPECT_EQ(verdict.verdict_class, judgement::VerdictClass::good);
  EXPECT_TRUE(contains(verdict.sentence, "own error is too large at 2 N")) << verdict.sentence;
  EXPECT_TRUE(contains(verdict.sentence, "FEM failed at 5 N")) << verdict.sentence;
}

TEST(Verdict, TellsWhenTheMeshLeavesTheReferenceOpen) {
  judgement::LoadErrors open = load(2, {{"hertz", true, true, 0.01, 0.01}});
  open.fem_trusted = false;
  open.fem_geometry_error = 0.23;
  const judgement::Verdict verdict = judgement::compose_verdict({open}, kTolerance, kReference);
  EXPECT_TRUE(contains(verdict.sentence, "the mesh leaves the FEM's own answer open at 2 N"))
      << verdict.sentence;
  EXPECT_FALSE(contains(verdict.sentence, "own error is too large")) << verdict.sentence;
}

TEST(Verdict, IsSilentOnAModelThatTheCaseGivesNoDataFor) {
  judgement::ModelError without_data{"power_law", true, true, 0.9, 0.8};
  without_data.applicable = false;
  EXPECT_EQ(judgement::compose_verdict({load(1, {{"hertz", true, true, 0.01, 0.01}, without_data})},
                                       kTolerance, kReference)
                .sentence,
            "Use Hertz (contact within 1.0 %, torque within 1.0 % of the finger) at 1 N.");
}

TEST(Verdict, LeadsWithTheMostAccurateFastModelAndNamesOneMore) {
  std::vector<judgement::ModelError> models = {
      {"bonded_layer", true, true, 0.002, 0.001},
      {"hertz", true, true, 0.05, 0.04},
      {"layer_fft", true, true, 0.0001, 0.0001, false},
      {"layer_fredholm", true, true, 0.0001, 0.0001, false},
      {"power_law", false, false, 0, 0, true, false},
      {"thin_incompressible", true, false, 0.9, 0.8},
      {"winkler", true, false, 0.2, 0.1}};
  std::vector<judgement::LoadErrors> loads;
  for (double load_N : {0.5, 1.0, 2.0, 5.0, 10.0}) loads.push_back(load(load_N, models));
  EXPECT_EQ(judgement::compose_verdict(loads, kTolerance, kReference).sentence,
            "Use Bonded layer (contact within 0.2 %, torque within 0.1 % of the finger) or Hertz "
            "(contact "
            "within 5.0 %, torque within 4.0 %) at 0.5 to 10 N; 2 others are off by 20 % to 90 %.");
}

TEST(Verdict, NamesASlowModelWhenNoOtherWillDo) {
  const judgement::ModelError slow{"layer_fft", true, true, 0.001, 0.001, false};
  const std::string sentence =
      judgement::compose_verdict({load(1, {{"hertz", true, false, 0.5, 0.4}, slow})}, kTolerance,
                                 kReference)
          .sentence;
  EXPECT_TRUE(contains(sentence, "Use Layer fft (contact within 0.1 %")) << sentence;
  EXPECT_TRUE(contains(sentence, "Hertz is off by +50 %")) << sentence;
  // Also where nothing holds everywhere: beside a fast model that does as well it has no place.
  const std::string mixed =
      judgement::compose_verdict(
          {load(1, {{"hertz", true, true, 0.05, 0.04}, slow}),
           load(2, {{"hertz", false, false, 0, 0}, {"layer_fft", false, false, 0, 0}})},
          kTolerance, kReference)
          .sentence;
  EXPECT_FALSE(contains(mixed, "fft")) << mixed;
}

TEST(Verdict, ClassesHaveTheNamesOfTheReport) {
  using judgement::VerdictClass;
  EXPECT_STREQ(judgement::name_of(VerdictClass::good), "good");
  EXPECT_STREQ(judgement::name_of(VerdictClass::mixed), "mixed");
  EXPECT_STREQ(judgement::name_of(VerdictClass::bad), "bad");
  EXPECT_STREQ(judgement::name_of(VerdictClass::undetermined), "undetermined");
  EXPECT_STREQ(judgement::name_of(VerdictClass::failed), "failed");
}

}  // namespace softfinger
