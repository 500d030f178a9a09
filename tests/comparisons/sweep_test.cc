#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <cstring>
#include <tuple>

#include "comparisons/sweep/rows_file.h"
#include "comparisons/sweep/sweep_file.h"
#include "comparisons/system/files.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace fs = std::filesystem;
namespace {

std::string text_with(const std::string& sweep) {
  return "id = \"swept\"\n[geometry]\nrelative_radii_mm = [20.0, 10.0]\n[layer]\n"
         "thickness_mm = 2.0\nyoungs_modulus_kPa = 300.0\npoisson_ratio = 0.45\n[contact]\n"
         "load_N = [1.0, 5.0]\nfriction_coefficient = 0.8\n[fem]\nlevel = 1\n[sweep]\n" +
         sweep;
}

std::string refusal(const std::string& sweep) {
  try {
    sweep::Sweep(text_with(sweep), "swept.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::vector<double> values(const sweep::Sweep& sweep, std::size_t point) {
  std::vector<double> found;
  sweep.values_at(point, found);
  return found;
}

}  // namespace

TEST(Sweep, MakesTheProductOfItsKeysInTheOrderOfTheFile) {
  const sweep::Sweep sweep(text_with("\"layer.thickness_mm\" = [1, 2.5, 4]\n"
                                     "\"contact.friction_coefficient\" = [0.5, 0.6]\n"),
                           "swept.toml");
  ASSERT_EQ(sweep.points(), 6u);
  EXPECT_EQ(sweep.rows(), 12u) << "two loads";
  EXPECT_EQ(values(sweep, 0), (std::vector<double>{1, 0.5}));
  EXPECT_EQ(values(sweep, 1), (std::vector<double>{1, 0.6}));
  EXPECT_EQ(values(sweep, 5), (std::vector<double>{4, 0.6}));
  sweep::Sweep::Cases cases(sweep);
  const input::Case last = cases.at(5), first = cases.at(0);
  EXPECT_EQ(last.layer.thickness_m, 4e-3);
  EXPECT_EQ(last.shear_law.friction_coefficient, 0.6);
  EXPECT_EQ(first.layer.thickness_m, 1e-3);
  EXPECT_EQ(first.layer.youngs_modulus_Pa, 300e3);
}

TEST(Sweep, PairsWhatIsZipped) {
  const sweep::Sweep sweep(
      text_with("\"layer.thickness_mm\" = [1, 2]\n"
                "\"layer.poisson_ratio\" = [0.1, 0.2, 0.3]\n"
                "\"layer.youngs_modulus_kPa\" = [100, 200]\n"
                "zip = [[\"layer.thickness_mm\", \"layer.youngs_modulus_kPa\"]]\n"),
      "swept.toml");
  ASSERT_EQ(sweep.points(), 6u);
  EXPECT_EQ(values(sweep, 0), (std::vector<double>{1, 0.1, 100}));
  EXPECT_EQ(values(sweep, 3), (std::vector<double>{2, 0.1, 200}));
}

TEST(Sweep, SpacesRangesWithExactEnds) {
  const sweep::Sweep sweep(
      text_with("\"layer.thickness_mm\" = { from = 0.5, to = 8, steps = 5, spacing = \"log\" }\n"
                "\"layer.poisson_ratio\" = { from = 0.1, to = 0.4, steps = 4 }\n"),
      "swept.toml");
  const auto& thickness_mm = sweep.keys()[0].values;
  ASSERT_EQ(thickness_mm.size(), 5u);
  EXPECT_EQ(thickness_mm.front(), 0.5);
  EXPECT_EQ(thickness_mm.back(), 8);
  for (int i = 1; i < 5; ++i) EXPECT_NEAR(thickness_mm[i] / thickness_mm[i - 1], 2, 1e-15 * 8);
  EXPECT_EQ(sweep.keys()[1].values.back(), 0.4);
  EXPECT_NEAR(sweep.keys()[1].values[1], 0.2, 1e-16);
}

TEST(Sweep, DrawsTheSameRandomValuesAgain) {
  const std::string text = text_with(
      "\"layer.thickness_mm\" = { from = 0.5, to = 8, random = 1000, seed = 3, spacing = \"log\" "
      "}\n"
      "\"layer.youngs_modulus_kPa\" = { from = 0.5, to = 8, random = 1000, seed = 3 }\n"
      "zip = [[\"layer.thickness_mm\", \"layer.youngs_modulus_kPa\"]]\n");
  const sweep::Sweep one(text, "swept.toml"), other(text, "swept.toml");
  EXPECT_EQ(one.keys()[0].values, other.keys()[0].values);
  double mean_log = 0, correlation = 0;
  for (std::size_t i = 0; i < 1000; ++i) {
    const double value = one.keys()[0].values[i];
    EXPECT_TRUE(value >= 0.5 && value < 8);
    mean_log += std::log(value) / 1000;
    correlation += (std::log(value) - std::log(2)) * (one.keys()[1].values[i] - 4.25) / 1000;
  }
  // Five standard deviations of a mean of 1000 uniform numbers, and of their products.
  const double log_std = std::log(16.) / std::sqrt(12.), std_kPa = 7.5 / std::sqrt(12.);
  EXPECT_NEAR(mean_log, std::log(2), 5 * log_std / std::sqrt(1000.));
  EXPECT_NEAR(correlation, 0, 5 * log_std * std_kPa / std::sqrt(1000.))
      << "two keys of one seed have numbers of their own";
}

TEST(Sweep, TakesPlacesInListsAndOneLoadOfMany) {
  const sweep::Sweep sweep(text_with("\"geometry.relative_radii_mm[1]\" = [5, 30]\n"
                                     "\"contact.load_N\" = [2, 3, 4]\n"
                                     "\"fem.level\" = [1, 2]\n"),
                           "swept.toml");
  EXPECT_EQ(sweep.rows(), 12u);
  sweep::Sweep::Cases cases(sweep);
  const input::Case last = cases.at(11);
  EXPECT_EQ(std::get<RelativeRadii>(last.geometry).major_m, 30e-3);
  const sweep::Sweep dotted(text_with("\"geometry.relative_radii_mm.1\" = [5, 30]\n"),
                            "swept.toml");
  EXPECT_EQ(std::get<RelativeRadii>(sweep::Sweep::Cases(dotted).at(1).geometry).major_m, 30e-3);
  EXPECT_EQ(last.loads_N, std::vector<double>{4});
  EXPECT_EQ(last.fem_level, 2);
}

TEST(Sweep, RefusesInOneLineWithTheLine) {
  EXPECT_NE(refusal("\"layer.thicknes_mm\" = [1]\n").find("did you mean \"layer.thickness_mm\""),
            std::string::npos);
  EXPECT_NE(refusal("\"layer.poisson_ratio\" = [0.3, 0.6, 0.4]\n").find("poisson_ratio = 0.6"),
            std::string::npos);
  EXPECT_NE(refusal("\"layer.poisson_ratio\" = [0.3, 0.6, 0.4]\n").find("swept.toml:14"),
            std::string::npos);
  for (const char* sweep :
       {"",
        "\"layer.thickness_mm\" = []\n",
        "\"layer.thickness_mm\" = 3\n",
        "\"layer.thickness_mm\" = [\"a\"]\n",
        "\"layer.thickness_mm\" = { from = 1, to = 2 }\n",
        "\"layer.thickness_mm\" = { from = 1, to = 2, steps = 1 }\n",
        "\"layer.thickness_mm\" = { from = 1, to = 2, steps = 2.5 }\n",
        "\"layer.thickness_mm\" = { from = 1, to = 2, steps = 3, random = 3 }\n",
        "\"layer.thickness_mm\" = { from = 1, to = 2, steps = 3, seed = 3 }\n",
        "\"layer.thickness_mm\" = { from = 1, to = 2, random = 3, seed = -1 }\n",
        "\"layer.thickness_mm\" = { from = 0, to = 2, steps = 3, spacing = \"log\" }\n",
        "\"layer.thickness_mm\" = { from = 1, to = 2, steps = 10000000 }\n",
        "\"layer\" = [1]\n",
        "\"layer[0].thickness_mm\" = [1]\n",
        "\"id\" = [1]\n",
        "fem = 1\n",
        "\"geometry.relative_radii_mm[2]\" = [1]\n",
        "\"geometry.relative_radii_mm[\" = [1]\n",
        "\"layer.thickness_mm\" = [1]\nzip = [[\"layer.thickness_mm\"]]\n",
        "\"layer.thickness_mm\" = [1]\nzip = [[\"layer.thickness_mm\", \"layer.thickness_mm\"]]\n",
        "\"layer.thickness_mm\" = [1]\n\"layer.poisson_ratio\" = [0.1, 0.2]\n"
        "zip = [[\"layer.thickness_mm\", \"layer.poisson_ratio\"]]\n"}) {
    const std::string message = refusal(sweep);
    EXPECT_FALSE(message.empty()) << sweep;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  EXPECT_NE(refusal("\"layer.thickness_mm\" = { from = 1, to = 2, steps = 100000 }\n"
                    "\"layer.poisson_ratio\" = { from = 0, to = 0.4, steps = 100000 }\n")
                .find("at most 100000000 rows"),
            std::string::npos);
  EXPECT_NE(refusal("fem = true\n\"layer.thickness_mm\" = { from = 1, to = 2, steps = 200000 }\n")
                .find("at most 100000 rows with fem = true"),
            std::string::npos);
}

class GrowingRows : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "softfinger-rows-XXXXXX").string();
    folder = mkdtemp(name.data());
    // Three points of two rows each, as an interrupted sweep leaves them.
    sweep::RowsFile file(folder, header, "sweep 1", true);
    for (const char* rows : {"1,1\n1,2\n", "2,1\n2,2\n", "3,1\n3,2\n"}) file.append(rows, 1);
  }
  void TearDown() override { fs::remove_all(folder); }
  std::string partial() const {
    return system::read_file_to_rewrite(folder / "results.partial.csv");
  }
  void damage(const std::string& text) const {
    system::write_file_atomically(folder / "results.partial.csv", text);
  }
  const std::string header = "point,load\n";
  fs::path folder;
};

TEST_F(GrowingRows, GoOnAfterTheLastWholePoint) {
  const std::string whole = partial();
  for (const char* rest : {"", "4,1", "4,1\n", "4,1\n4,2"}) {
    damage(whole + rest);
    sweep::RowsFile file(folder, header, "sweep 1", true);
    EXPECT_EQ(file.points(), 3u) << rest;
    EXPECT_FALSE(file.had_changed_rows()) << "a run was killed while it wrote";
    EXPECT_EQ(partial(), whole);
  }
  sweep::RowsFile file(folder, header, "sweep 1", true);
  file.append("4,1\n4,2\n", 1);
  const std::string check = file.check();
  file.finish();
  const std::string finished = whole + "4,1\n4,2\n";
  EXPECT_EQ(system::read_file_to_rewrite(folder / "results.csv"), finished);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
  EXPECT_TRUE(sweep::RowsFile::is_whole(folder / "results.csv", check));
  for (const std::string& changed :
       {finished + "5,1\n", finished.substr(0, finished.size() - 4), header, std::string()}) {
    system::write_file_atomically(folder / "results.csv", changed);
    EXPECT_FALSE(sweep::RowsFile::is_whole(folder / "results.csv", check)) << changed;
  }
}

TEST_F(GrowingRows, AreMadeAgainFromTheFirstThatWasChanged) {
  const std::string whole = partial();
  for (const auto& [row, changed] : {std::pair("2,2\n", "2,3\n"), std::pair("2,1\n", ""),
                                     std::pair("2,1\n", "garbage\n2,1\n")}) {
    std::string text = whole;
    damage(text.replace(text.find(row), std::strlen(row), changed));
    sweep::RowsFile file(folder, header, "sweep 1", true);
    EXPECT_TRUE(file.had_changed_rows()) << changed;
    EXPECT_EQ(file.points(), 1u) << changed;
    EXPECT_EQ(partial(), "point,load\n1,1\n1,2\n");
    file.append("2,1\n2,2\n", 1);
    file.append("3,1\n3,2\n", 1);
    EXPECT_EQ(partial(), whole);
  }
}

TEST_F(GrowingRows, StartAnewForAnotherSweep) {
  for (const auto& [columns, identity, go_on] :
       {std::tuple("point,load\n", "sweep 2", true), std::tuple("point,mu\n", "sweep 2", true),
        std::tuple("point,mu\n", "sweep 2", false)}) {
    sweep::RowsFile file(folder, columns, identity, go_on);
    EXPECT_EQ(file.points(), 0u);
    EXPECT_EQ(partial(), columns);
    file.append("1,1\n", 1);
  }
}

}  // namespace softfinger
