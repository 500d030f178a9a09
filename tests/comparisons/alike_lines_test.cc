#include "comparisons/text/alike_lines.h"

#include <gtest/gtest.h>

namespace softfinger::text {
namespace {

using Lines = std::vector<std::string>;

TEST(AlikeLines, DifferInNamesAndNumbersAlone) {
  EXPECT_EQ(alike_as_one({"joint \"a\" starts at 0.5", "2 sensors are left out",
                          "joint \"b \\\" c\" starts at -1.5e-3", "joint \"c\" ends at 2"},
                         "--verbose lists them"),
            (Lines{"joint \"a\" starts at 0.5 (and 1 more alike; --verbose lists them)",
                   "2 sensors are left out", "joint \"c\" ends at 2"}));
}

TEST(AlikeLines, AreLeftAsTheyAreWhereNoneIsAlike) {
  const Lines lines = {"one", "two", "a \"name", ""};
  EXPECT_EQ(alike_as_one(lines, "x"), lines);
  EXPECT_EQ(alike_as_one({}, "x"), Lines{});
}

}  // namespace
}  // namespace softfinger::text
