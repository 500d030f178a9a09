#include "comparisons/report/sweep_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include "from_base64.h"
#include "page_text.h"
#include "sample_sweep.h"

namespace softfinger::report {
namespace {

using Json = nlohmann::json;
using tests::contains;
using tests::without_scripts;

std::string text_of(const Json& sweep) {
  return tests::in_one_line(tests::visible_text(without_scripts(render_sweep(sweep))));
}

Json chart_data(const Json& sweep) { return tests::chart_data_of(render_sweep(sweep)); }

std::size_t rows_of_table(const std::string& page, const std::string& id) {
  const std::size_t from = page.find("<tbody>", page.find("id=\"" + id + "\""));
  return tests::occurrences(page.substr(from, page.find("</tbody>", from) - from), "<tr");
}

TEST(SweepPage, AnswersInItsFirstLineWithTheLargestTorque) {
  // 2 mN·m (h/mm)^(1/2) P/N: at each load the thickest of 0.5 to 5 mm, by the root of ten.
  const std::string text = text_of(tests::sweep_of_one_key());
  const std::string answer =
      "The largest torque is held with thickness 5 mm at every load: 22.4 mN·m at 5 N, 3.2 times "
      "that with thickness 0.5 mm.";
  EXPECT_LT(text.find(answer), text.find("By Bonded layer"));
  EXPECT_LT(text.find("By Bonded layer"), text.find("Swept were"));
}

TEST(SweepPage, SaysAtWhichValuesTheModelIsUsableAtEveryLoad) {
  Json sweep = tests::sweep_of_one_key();
  const Json& columns = sweep["columns"];
  const auto usable = std::size_t(std::find(columns.begin(), columns.end(), "bonded_layer_usable") -
                                  columns.begin());
  for (Json& row : sweep["rows"])
    if (row[0] == 0 || row[0] == 9) row[usable] = "no";
  const std::string text = text_of(sweep);
  EXPECT_TRUE(contains(text, "Usable at every load: thickness 0.6458 to 3.871 mm."));
  EXPECT_TRUE(contains(text, "held with thickness 3.871 mm at every load"))
      << "an answer that is not usable does not count";
}

TEST(SweepPage, SaysNextWhatWasSweptAndHowFarTheAnswersVary) {
  const std::string text = text_of(tests::sweep_of_one_key());
  for (const char* part :
       {"Swept were thickness 0.5 to 5 mm (10 values, log) at 1, 2 and 5 N: 10 points, 30 rows; "
        "30 rows have an answer, 0 failed.",
        // 2 mN·m (h/mm)^(1/2) P/N from 0.5 mm and 1 N to 5 mm and 5 N.
        "By Bonded layer, usable (within 10 %) in 30 of 30 rows: largest torque 1.41 to 22.4 mN·m",
        "a 2.26 to 7.16 mm"})
    EXPECT_TRUE(contains(text, part)) << part;
}

TEST(SweepPage, SaysHowFarTheClosestModelIsFromTheFiniteElements) {
  // Bonded layer is off by 0.02 ln(h / 2 mm) in torque, by about twice that in area. Of six
  // thicknesses over a decade the median is the mean of the third and fourth smallest deviation.
  std::vector<double> errors;
  for (int i = 0; i < 6; ++i) {
    const double factor = 1 + 0.02 * std::log(0.25 * std::pow(10, i / 5.));
    errors.push_back(std::abs(factor * factor - 1));
  }
  std::sort(errors.begin(), errors.end());
  const std::string text = text_of(tests::sweep_of_one_key_with_fem());
  std::smatch found;
  ASSERT_TRUE(std::regex_search(
      text, found,
      std::regex("Closest to the finite elements is Bonded layer: area and torque are off by "
                 "([\\d.]+) % in the median and ([\\d.]+) % at worst "
                 "\\(over 6 of the 6 rows")))
      << text.substr(0, 600);
  EXPECT_NEAR(std::stod(found[1]), 50 * (errors[2] + errors[3]), 0.005);
  EXPECT_NEAR(std::stod(found[2]), 100 * errors[5], 0.005);
}

TEST(SweepPage, DoesNotPreferAModelThatAnswersOnlyTheEasyRows) {
  // The second model agrees to the last digit, in one row of six.
  Json sweep = tests::sweep_of_one_key_with_fem();
  const Json columns = sweep["columns"];
  for (std::size_t row = 0; row < sweep["rows"].size(); ++row)
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const std::string name = columns[column];
      if (name.rfind("hertz_", 0) != 0 || name == "hertz_usable") continue;
      const std::size_t fem =
          std::find(columns.begin(), columns.end(), "fem_" + name.substr(6)) - columns.begin();
      sweep["rows"][row][column] = row == 0 ? sweep["rows"][row][fem] : Json();
    }
  EXPECT_TRUE(contains(text_of(sweep), "Closest to the finite elements is Bonded layer"));
}

TEST(SweepPage, SaysHowManyRowsFailedAndWhy) {
  const std::string text = text_of(tests::sweep_with_fem());
  for (const char* part : {"12 rows failed", "276 rows have an answer, 12 failed",
                           "12 rows: the active set did not settle: <level 3>"})
    EXPECT_TRUE(contains(text, part)) << part;
  EXPECT_FALSE(contains(text_of(tests::sweep_of_one_key()), "Why rows failed"));
}

TEST(SweepPage, ShowsFirstRowsSweepFileCommandAndVersionWithoutScripts) {
  const Json sweep = tests::sweep_with_fem();
  const std::string page = without_scripts(render_sweep(sweep));
  EXPECT_EQ(rows_of_table(page, "rows"), 50u);
  EXPECT_EQ(rows_of_table(without_scripts(render_sweep(tests::sweep_of_one_key())), "rows"), 30u);
  for (const char* part : {"[1, 2]  # &lt;&amp;&gt;", "softfinger sweep &lt;x&gt;.toml", "1.2.3"})
    EXPECT_TRUE(contains(page, part)) << part;
  // 2 mN·m 0.5^(1/2) (1.3 - 0.2)/0.85 at 1 N, in the page's units and four digits.
  EXPECT_TRUE(contains(page, "<td>1.830</td>"));
  EXPECT_TRUE(contains(text_of(sweep), "largest torque mN·m Bonded layer"));
}

TEST(SweepPage, SaysWhenNotAllRowsAreDrawn) {
  const Json sweep = tests::sweep_at_random();
  const std::string text = text_of(sweep);
  EXPECT_TRUE(contains(text,
                       "20,000 of 1,000,000 rows, evenly spaced, are drawn; all are in "
                       "results.csv"));
  EXPECT_FALSE(contains(text_of(tests::sweep_of_one_key()), "evenly spaced"));
  // 60 columns of 20,000 rows; without the chart libraries.
  EXPECT_LT(render_sweep(sweep).size(), 7'000'000u);
}

TEST(SweepPage, HandsThePictureEveryRowInItsUnits) {
  Json sweep = tests::sweep_with_fem();
  const Json data = chart_data(sweep);
  ASSERT_EQ(data["rows"], sweep["rows"].size());
  EXPECT_EQ(data["variables"].size(), 3u);
  EXPECT_EQ(data["variables"][0]["label"], "thickness");
  EXPECT_EQ(data["variables"][0]["unit"], "mm");
  const Json& columns = sweep["columns"];
  const auto column = [&](const char* name) {
    return std::find(columns.begin(), columns.end(), name) - columns.begin();
  };
  const Json& bonded = data["sources"][0];
  ASSERT_EQ(bonded["name"], "bonded_layer");
  const auto torques = tests::from_base64<float>(bonded["values"]["max_torque"]);
  const auto arms = tests::from_base64<float>(bonded["values"]["eccentricity"]);
  ASSERT_EQ(torques.size(), sweep["rows"].size());
  int missing = 0;
  for (std::size_t row = 0; row < torques.size(); ++row) {
    const Json& torque_Nm = sweep["rows"][row][column("bonded_layer_max_torque_Nm")];
    if (torque_Nm.is_null()) {
      EXPECT_TRUE(std::isnan(torques[row]));
      ++missing;
      continue;
    }
    const double expected = 1e3 * torque_Nm.get<double>();
    const double load_N = sweep["rows"][row][column("load_N")];
    constexpr double kFloat = 1.2e-7;  // spacing of float32
    EXPECT_NEAR(torques[row], expected, kFloat * expected);
    EXPECT_NEAR(arms[row], expected / (0.8 * load_N), kFloat * expected);
  }
  EXPECT_EQ(missing, 12);
}

TEST(SweepPage, OffersTheEccentricityOnlyWhereFrictionIsKnown) {
  Json sweep = tests::sweep_with_fem();
  EXPECT_EQ(chart_data(sweep)["quantities"].size(), 7u);
  sweep.erase("friction_coefficient");
  EXPECT_EQ(chart_data(sweep)["quantities"].size(), 6u);
}

TEST(SweepPage, TellsKeysOfTheSameNameApart) {
  Json sweep = tests::sweep_of_zipped_keys();
  for (std::size_t i = 0; i < 2; ++i) {
    const char* key = i == 0 ? "geometry.finger.radii_mm[0]" : "geometry.object.radii_mm[0]";
    sweep["keys"][i]["key"] = sweep["columns"][1 + i] = key;
  }
  const Json data = chart_data(sweep);
  EXPECT_EQ(data["variables"][0]["label"], "geometry.finger.radii_mm[0]");
  EXPECT_EQ(data["variables"][1]["label"], "geometry.object.radii_mm[0]");
}

TEST(SweepPage, HasOneLoadWhereTheLoadIsSwept) {
  Json sweep = tests::sweep_of_one_key();
  sweep["keys"][0]["key"] = sweep["columns"][1] = "contact.load_N";
  const Json data = chart_data(sweep);
  ASSERT_EQ(data["variables"].size(), 1u);
  EXPECT_EQ(data["variables"][0]["key"], "contact.load_N");
}

TEST(SweepPage, SurvivesRowsWithoutAnswersAndNoRows) {
  const std::string text = text_of(tests::sweep_without_answers());
  EXPECT_TRUE(contains(text, "No model has an answer."));
  EXPECT_FALSE(std::regex_search(text, std::regex("\\b(nan|inf|null)\\b")));
  Json sweep = tests::sweep_of_one_key();
  sweep["rows"] = Json::array();
  EXPECT_NO_THROW(render_sweep(sweep));
  for (const Json& row : {Json(), Json(1), Json("x"), Json::array(), Json{1, "x", nullptr}}) {
    sweep["rows"] = Json::array({row});
    EXPECT_NO_THROW(render_sweep(sweep)) << row;
  }
}

}  // namespace
}  // namespace softfinger::report
