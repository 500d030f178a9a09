#include "comparisons/verdict.h"

#include <gtest/gtest.h>

namespace softfinger {
namespace {

constexpr double kTolerance = 0.1;

LoadErrors load(double load_N, std::vector<ModelError> models) {
  return {load_N, true, true, "", std::move(models)};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST(Verdict, NamesTheModelThatHoldsAtAllLoads) {
  const Verdict verdict = compose_verdict(
      {load(1, {{"hertz", true, true, 0.01, -0.02}, {"winkler", true, false, 0.5, 0.4}}),
       load(2, {{"hertz", true, true, 0.04, 0.01}, {"winkler", true, false, 0.7, 0.3}})},
      kTolerance);
  EXPECT_EQ(verdict.verdict_class, "good");
  EXPECT_EQ(verdict.sentence,
            "Use Hertz (area within 4.0 % and torque within 2.0 % of FEM) at 1 and 2 N; Winkler is "
            "off by +70 % in "
            "area and +40 % in torque.");
}

TEST(Verdict, SaysAtWhichLoadsAModelHolds) {
  const Verdict verdict = compose_verdict(
      {load(0.5, {{"hertz", true, true, 0.01, 0.02}}), load(5, {{"hertz", true, false, 0.3, 0.2}})},
      kTolerance);
  EXPECT_EQ(verdict.verdict_class, "mixed");
  EXPECT_TRUE(contains(verdict.sentence, "Use Hertz at 0.5 N only")) << verdict.sentence;
  EXPECT_TRUE(contains(verdict.sentence, "at 5 N it is off by +30 % in area")) << verdict.sentence;
}

TEST(Verdict, SaysThatNoneHoldsAndByHowMuch) {
  const Verdict verdict = compose_verdict(
      {load(5, {{"hertz", true, false, 0.48, 0.2}, {"winkler", false, false, 0, 0}})}, kTolerance);
  EXPECT_EQ(verdict.verdict_class, "bad");
  EXPECT_EQ(verdict.sentence,
            "No model can be relied on at 5 N: Hertz is off by +48 % in area and +20 % in torque; "
            "Winkler has no "
            "answer.");
}

TEST(Verdict, DoesNotTrustAnErrorThatCrossesZeroOutsideTheAssumptions) {
  const Verdict verdict =
      compose_verdict({load(5, {{"winkler", true, false, 0.02, -0.01}})}, kTolerance);
  EXPECT_EQ(verdict.verdict_class, "mixed");
  EXPECT_TRUE(contains(verdict.sentence, "accident")) << verdict.sentence;
}

TEST(Verdict, TellsWhenTheReferenceFailedOrIsDoubtful) {
  LoadErrors failed{5, false, false, "no convergence", {{"hertz", true, true, 0, 0}}};
  EXPECT_EQ(compose_verdict({failed}, kTolerance).verdict_class, "failed");
  LoadErrors doubtful = load(2, {{"hertz", true, true, 0.01, 0.01}});
  doubtful.fem_trusted = false;
  const Verdict verdict = compose_verdict({doubtful, failed}, kTolerance);
  EXPECT_EQ(verdict.verdict_class, "good");
  EXPECT_TRUE(contains(verdict.sentence, "own error is too large at 2 N")) << verdict.sentence;
  EXPECT_TRUE(contains(verdict.sentence, "FEM failed at 5 N")) << verdict.sentence;
}

TEST(Verdict, StaysReadableWithManyModelsAndLoads) {
  std::vector<ModelError> models = {{"bonded_layer", true, true, 0.01, 0.01}};
  for (int i = 1; i <= 5; ++i) models.push_back({"wrong", true, false, 0.2 * i, 0.1});
  std::vector<LoadErrors> loads;
  for (double load_N : {0.5, 1.0, 2.0, 5.0, 10.0}) loads.push_back(load(load_N, models));
  const std::string sentence = compose_verdict(loads, kTolerance).sentence;
  EXPECT_TRUE(contains(sentence, "at 0.5 to 10 N")) << sentence;
  EXPECT_TRUE(contains(sentence, "the other 5 models are off by 20 % to 100 %")) << sentence;
}

TEST(Verdict, LeadsWithTheMostAccurateCheapModel) {
  const std::string sentence =
      compose_verdict({load(1, {{"bonded_layer", true, true, 0.002, 0.001},
                                {"hertz", true, true, 0.05, 0.04},
                                {"layer_fft", true, true, 0.0001, 0.0001, false},
                                {"power_law", false, false, 0, 0, true, false},
                                {"thin_incompressible", true, false, 0.9, 0.8},
                                {"winkler", false, false, 0, 0}})},
                      kTolerance)
          .sentence;
  EXPECT_EQ(sentence,
            "Use Bonded layer (area within 0.2 % and torque within 0.1 % of FEM) or Hertz (area "
            "within 5.0 % and torque within 4.0 % of FEM) at 1 N; Thin incompressible is off by "
            "+90 % in area and +80 % in torque.");
}

TEST(Verdict, NamesASlowModelWhenNoOtherWillDo) {
  const std::string sentence =
      compose_verdict({load(1, {{"hertz", true, false, 0.5, 0.4},
                                {"layer_fft", true, true, 0.001, 0.001, false}})},
                      kTolerance)
          .sentence;
  EXPECT_TRUE(contains(sentence, "Use Layer fft (area within 0.1 %")) << sentence;
  EXPECT_TRUE(contains(sentence, "Hertz is off by +50 %")) << sentence;
}

}  // namespace softfinger
