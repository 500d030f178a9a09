#include "comparisons/prediction/ask_model.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

/// Returns the check on homogeneity for a stack of these layers; nothing if there is none.
std::optional<ValidityCheck> homogeneity(const std::vector<ElasticLayer>& sublayers) {
  input::Case contact_case;
  for (const ElasticLayer& layer : sublayers) contact_case.sublayers.push_back({"", layer, {}});
  Validity validity;
  prediction::check_homogeneity(contact_case, validity);
  for (const ValidityCheck& check : validity)
    if (std::string(check.check) == "homogeneous") return check;
  return std::nullopt;
}

}  // namespace

TEST(ModelsByName, TakesEachOnceInTheOrderThatWasTyped) {
  const auto models = prediction::models_by_name("winkler,hertz,winkler");
  ASSERT_EQ(models.size(), 2u);
  EXPECT_EQ(models[0]->card().name, "winkler");
  EXPECT_EQ(models[1]->card().name, "hertz");
  EXPECT_THROW(prediction::models_by_name("hertz,winkle"), InputError);
}

TEST(Homogeneity, IsTheLargestContrastOfStiffnessInShearOrVolume) {
  EXPECT_EQ(homogeneity({{1e-3, 2e5, 0.3}, {1e-3, 8e5, 0.3}})->value, 4);
  EXPECT_EQ(homogeneity({{1e-3, 8e5, 0.3}, {1e-3, 2e5, 0.3}})->value, 4);
  // K = E / (3 (1 - 2 nu)): 1 - 2 nu is 0.4 and 0.02.
  EXPECT_NEAR(homogeneity({{1e-3, 2e5, 0.3}, {1e-3, 2e5, 0.49}})->value, 20, 1e-12);
  EXPECT_FALSE(homogeneity({})) << "a homogeneous layer is not asked";
}

}  // namespace softfinger
