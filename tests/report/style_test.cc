#include "comparisons/report/style.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "comparisons/report/embedded.h"
#include "page_text.h"

namespace softfinger::report {
namespace {

TEST(Style, GivesTwentyModelsTwentyColours) {
  Json report = {{"models", Json::array()}};
  for (int place = 0; place < 20; ++place)
    report["models"].push_back({{"name", "model_" + std::to_string(place)}});
  std::set<std::string> colours;
  for (const std::string& name : model_names(report)) colours.insert(style(report, name).colour);
  EXPECT_EQ(colours.size(), 20u);
  EXPECT_EQ(colours.count(style(report, "fem").colour), 0u);
  EXPECT_EQ(colours.count(style(report, "fem_coarse").colour), 0u);
}

TEST(Style, UsesOnlyColoursThatTheStyleSheetHasInLightAndInDark) {
  const std::string css(embedded::report_css);
  const std::size_t dark = css.find("prefers-color-scheme: dark");
  ASSERT_NE(dark, std::string::npos);
  const std::string in_light = css.substr(0, dark), in_dark = css.substr(dark);
  for (int place = 0; place < 20; ++place) {
    const std::string colour = style_of_place(place).colour;
    const std::size_t from = colour.find("--");
    ASSERT_NE(from, std::string::npos) << colour;
    const std::string variable = colour.substr(from, colour.find(')', from) - from) + ":";
    EXPECT_TRUE(tests::contains(in_light, variable)) << variable;
    EXPECT_TRUE(tests::contains(in_dark, variable)) << variable;
  }
}

}  // namespace
}  // namespace softfinger::report
