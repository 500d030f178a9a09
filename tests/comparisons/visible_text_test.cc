#include "softfinger/input/visible_text.h"

#include <gtest/gtest.h>

namespace softfinger {

TEST(VisibleText, LeavesWhatPeopleWriteAsItIs) {
  const std::string text = "R' 20 mm, µ 0.5, 30°, 中文, 👍\n\ttable\n";
  EXPECT_EQ(visible_text(text), text);
  EXPECT_EQ(visible_text(""), "");
}

TEST(VisibleText, ShowsWhatWouldCommandATerminal) {
  EXPECT_EQ(visible_text("\x1b[31mred"), "\\x1b[31mred");
  EXPECT_EQ(visible_text("a\rb\bc\x7f"), "a\\x0db\\x08c\\x7f");
  EXPECT_EQ(visible_text(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(visible_text("\u009b\u0080\u009f\u00a0"), "\\u009b\\u0080\\u009f\u00a0") << "C1";
  EXPECT_EQ(visible_text("\x9b[2J"), "\\x9b[2J") << "C1 as a byte";
}

TEST(VisibleText, ShowsWhatWouldTurnTheReadingDirection) {
  EXPECT_EQ(visible_text("a\u202eb\u2066c\u2069"), "a\\u202eb\\u2066c\\u2069");
  EXPECT_EQ(visible_text("\u2029\u202f\u2065\u206a"), "\u2029\u202f\u2065\u206a");
}

TEST(VisibleText, ShowsBytesThatAreNoUtf8) {
  EXPECT_EQ(visible_text("\xc3"), "\\xc3") << "cut off";
  EXPECT_EQ(visible_text("\xc3("), "\\xc3(");
  EXPECT_EQ(visible_text("\xc0\x9b"), "\\xc0\\x9b") << "longer than need be";
  EXPECT_EQ(visible_text("\xe0\x82\x9b"), "\\xe0\\x82\\x9b") << "longer than need be";
  EXPECT_EQ(visible_text("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half of a surrogate pair";
  EXPECT_EQ(visible_text("\xf5\x80\x80\x80"), "\\xf5\\x80\\x80\\x80") << "beyond Unicode";
}

}  // namespace softfinger
