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

TEST(CsvCell, RunsAsNoFormulaInASpreadsheet) {
  EXPECT_EQ(text::csv_cell("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
  EXPECT_EQ(text::csv_cell("=SUM(1,2)"), "\"'=SUM(1,2)\"");
  for (const char* begin : {"+", "-", "@"})
    EXPECT_EQ(text::csv_cell(std::string(begin) + "1"), "'" + std::string(begin) + "1");
  EXPECT_EQ(text::csv_cell("a=b"), "a=b");
}

}  // namespace softfinger
