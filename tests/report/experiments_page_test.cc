#include "comparisons/report/experiments_page.h"

#include <gtest/gtest.h>

#include "compared_cases.h"
#include "comparisons/report/report_page.h"
#include "sample_report.h"

namespace softfinger::report {
namespace {

Json sample(const std::string& verdict) {
  const Json finding = {{"test", "radius at 12 N"}, {"model", "bonded_layer"},
                        {"role", "theory"},         {"unit", "m"},
                        {"measured", 8e-3},         {"measured_uncertainty", nullptr},
                        {"predicted", 7.5e-3},      {"predicted_interval", {7.4e-3, 7.6e-3}},
                        {"verdict", verdict},       {"reason", "a <b>reason</b>"}};
  const Json set = {{"id", "mine"},
                    {"what", "<script>alert(1)</script>"},
                    {"source", "a source"},
                    {"certainty", "abstract"},
                    {"unknown", Json::array({"the load"})},
                    {"verdict", verdict},
                    {"sentence", "what it says"},
                    {"findings", Json::array({finding})},
                    {"inferred", Json::array()}};
  return {{"noise_floor", nullptr}, {"experiments", Json::array({set})}};
}

TEST(ExperimentsPage, ShowsVerdictsAsTheyAre) {
  EXPECT_NE(render_experiments(sample("fails")).find("✕ fails"), std::string::npos);
  EXPECT_EQ(render_experiments(sample("fails")).find("✓ agrees"), std::string::npos);
  EXPECT_NE(render_experiments(sample("agrees")).find("✓ agrees"), std::string::npos);
  const std::string page = render_experiments(sample("cannot tell"));
  EXPECT_EQ(page.find("✕ fails"), std::string::npos);
  EXPECT_NE(page.find("7.5 mm (7.4 mm to 7.6 mm)"), std::string::npos);
  EXPECT_NE(page.find("the load"), std::string::npos);
}

TEST(ExperimentsPage, NeedsNoNetworkAndRunsNothingFromItsData) {
  const std::string page = render_experiments(sample("agrees"));
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.find("<b>reason"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  for (const char* loads : {"<link", "src=\"http", "url(http", "@import"})
    EXPECT_EQ(page.find(loads), std::string::npos) << loads;
}

TEST(ExperimentsPage, ReadsWhatIsMissingAsUnknown) {
  EXPECT_NE(
      render_experiments({{"experiments", Json::array({Json::object()})}}).find("cannot tell"),
      std::string::npos);
  EXPECT_THROW(render_experiments(Json::object()), std::invalid_argument);
}

TEST(ExperimentsPage, IsASectionOfTheReport) {
  Json report = tests::sample_report();
  EXPECT_EQ(tests::page_of(report).find("id=\"experiments\""), std::string::npos);
  report["experiments"] = sample("fails");
  const std::string page = tests::page_of(report);
  EXPECT_NE(page.find("id=\"experiments\""), std::string::npos);
  EXPECT_NE(page.find("✕ fails"), std::string::npos);
}

}  // namespace
}  // namespace softfinger::report
