#include "comparisons/judgement/scoring.h"

#include <gtest/gtest.h>

namespace softfinger {
namespace {

judgement::LoadErrors load(double load_N, std::vector<judgement::ModelError> models) {
  return {load_N, true, true, "", std::move(models)};
}

judgement::CaseErrors two_loads() {
  return {"pad",
          0.45,
          {load(1, {{"hertz", true, true, 0.01, -0.02}, {"winkler", true, true, 0.3, 0.1}}),
           load(5, {{"hertz", false, false, 0, 0}, {"winkler", true, true, 0.2, -0.4}})}};
}

}  // namespace

TEST(WorstScore, IsTheLargestErrorOverLoadsAndQuantities) {
  const auto worst = judgement::worst_score(two_loads(), "winkler");
  ASSERT_TRUE(worst);
  EXPECT_EQ(worst->error, 0.4);
  EXPECT_EQ(worst->quantity, prediction::Quantity::max_torque);
  EXPECT_EQ(worst->load_N, 5);
}

TEST(WorstScore, IsNothingWhereTheModelMissesALoad) {
  EXPECT_FALSE(judgement::worst_score(two_loads(), "hertz"));
  judgement::CaseErrors with_failure = two_loads();
  with_failure.loads[1].fem_finished = false;
  const auto worst = judgement::worst_score(with_failure, "hertz");
  ASSERT_TRUE(worst) << "a load without a reference is no load that the model misses";
  EXPECT_EQ(worst->error, 0.02);
}

TEST(BestModel, IsUsableBeforeItIsAccurate) {
  judgement::CaseErrors errors = {
      "pad",
      0.45,
      {load(1, {{"accurate", true, false, 0.01, 0.01}, {"honest", true, true, 0.05, 0.05}})}};
  ASSERT_TRUE(judgement::best_model(errors, 0.1));
  EXPECT_EQ(judgement::best_model(errors, 0.1)->model, "honest");
  EXPECT_EQ(judgement::best_model(errors, 0.02)->model, "accurate") << "none is usable";
}

}  // namespace softfinger
