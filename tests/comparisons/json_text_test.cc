#include "comparisons/text/json_text.h"

#include <gtest/gtest.h>

#include <limits>

namespace softfinger {

TEST(JsonText, HasNullForWhatIsNoNumber) {
  EXPECT_TRUE(text::finite_or_null(std::numeric_limits<double>::quiet_NaN()).is_null());
  EXPECT_TRUE(text::finite_or_null(-std::numeric_limits<double>::infinity()).is_null());
  EXPECT_EQ(text::finite_or_null(-0.25), -0.25);
}

TEST(JsonText, GivesNullForWhatIsNoJsonOrTooDeep) {
  EXPECT_EQ(text::parse_json("{\"a\": [1]}")["a"][0], 1);
  EXPECT_TRUE(text::parse_json("{\"a\": ").is_null());
  // Recursive readers and destructors would overflow the stack.
  constexpr std::size_t kDepth = 10'000;
  EXPECT_TRUE(text::parse_json(std::string(kDepth, '[') + std::string(kDepth, ']')).is_null());
}

}  // namespace softfinger
