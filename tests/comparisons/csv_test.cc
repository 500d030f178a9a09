#include "comparisons/text/csv.h"

#include <gtest/gtest.h>

namespace softfinger {

TEST(CsvCell, IsQuotedWhereItWouldShiftTheColumns) {
  EXPECT_EQ(text::csv_cell("finger"), "finger");
  EXPECT_EQ(text::csv_cell(""), "");
  EXPECT_EQ(text::csv_cell("finger, left"), "\"finger, left\"");
  EXPECT_EQ(text::csv_cell("the \"hard\" one"), "\"the \"\"hard\"\" one\"");
  EXPECT_EQ(text::csv_cell("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(text::csv_cell("\r"), "\"\r\"");
}

}  // namespace softfinger
