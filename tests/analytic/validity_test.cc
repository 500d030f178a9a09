// No failing check may get lost, however many checks a model adds.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

constexpr ValidityCheck kHolds{"holds", 0, 1, true, "a check that holds"};
constexpr ValidityCheck kFails{"fails", 2, 1, true, "a check that fails"};

Validity with(std::size_t holding) {
  Validity validity;
  for (std::size_t i = 0; i < holding; ++i) validity.add(kHolds);
  return validity;
}

bool lists(const Validity& validity, const std::string& name) {
  return std::any_of(validity.begin(), validity.end(),
                     [&](const ValidityCheck& check) { return check.check == name; });
}

TEST(Validity, HoldsWhileAllChecksFitAndHold) {
  const Validity validity = with(Validity::kCapacity);
  EXPECT_TRUE(validity.holds());
  EXPECT_EQ(validity.end() - validity.begin(), std::ptrdiff_t(Validity::kCapacity));
}

TEST(Validity, AFailingCheckIsKeptWhereverItIsAdded) {
  for (std::size_t before = 0; before < 3 * Validity::kCapacity; ++before) {
    Validity validity = with(before);
    validity.add(kFails);
    for (std::size_t after = 0; after < Validity::kCapacity; ++after) validity.add(kHolds);
    EXPECT_FALSE(validity.holds()) << before;
    EXPECT_TRUE(lists(validity, "fails")) << before;
    EXPECT_LE(validity.end() - validity.begin(), std::ptrdiff_t(Validity::kCapacity)) << before;
  }
}

TEST(Validity, MoreChecksThanItCanListAreNotValid) {
  const Validity validity = with(Validity::kCapacity + 1);
  EXPECT_FALSE(validity.holds());
  EXPECT_TRUE(lists(validity, "all_checks_stated"));
  Validity all_fail;
  for (std::size_t i = 0; i < 2 * Validity::kCapacity; ++i) all_fail.add(kFails);
  EXPECT_FALSE(all_fail.holds());
  EXPECT_TRUE(lists(all_fail, "all_checks_stated"));
  EXPECT_TRUE(lists(all_fail, "fails"));
}

}  // namespace
}  // namespace softfinger
