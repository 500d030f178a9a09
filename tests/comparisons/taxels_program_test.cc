// Tactile arrays, as users of `softfinger predict` see them.

#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
using nlohmann::json;

class TaxelsProgram : public testing::Test {
 protected:
  TemporaryFolder folder;
  Start start{folder.path(), {}, -1, ""};
  const std::vector<std::string> pad{
      "predict", "--radii-mm",      "20,12", "--thickness-mm", "2", "--youngs-modulus-kPa",
      "300",     "--poisson-ratio", "0.49",  "--load",         "2", "--friction",
      "0.8"};

  ProgramRun run(std::vector<std::string> more) {
    more.insert(more.begin(), pad.begin(), pad.end());
    return run_softfinger(start, more);
  }
  void expect_refusal(const std::vector<std::string>& more, const std::string& part) {
    const ProgramRun result = run(more);
    EXPECT_EQ(result.status, 2) << result.out << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  }
  std::string read(const std::string& name) {
    std::ifstream file(folder.path() / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

double sum_of(const json& table) {
  double sum = 0;
  for (const json& row : table)
    for (const json& value : row) sum += value.get<double>();
  return sum;
}

TEST_F(TaxelsProgram, EveryModelFillsTheArrayWithTheLoad) {
  const ProgramRun result = run({"--taxels", "8,6", "--model", "everything", "--json", "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  int answered = 0;
  const json printed = json::parse(result.out);
  for (const json& one : printed["results"]) {
    if (one["a_m"].is_null()) {
      EXPECT_FALSE(one.contains("taxels"));
      continue;
    }
    ++answered;
    const json& taxels = one["taxels"];
    EXPECT_EQ(taxels["force_N"].size(), 6u);
    EXPECT_EQ(taxels["force_N"][0].size(), 8u);
    EXPECT_NEAR(sum_of(taxels["force_N"]), 2, 2e-12) << one["model"];
    EXPECT_NEAR(taxels["outside_N"].get<double>(), 0, 2e-12);
    EXPECT_EQ(sum_of(taxels["shear_x_Pa"]), 0);
    // The array covers the contact and a taxel on each side.
    const double pitch_m = taxels["pitch_m"];
    const double covering_m =
        std::max(taxels["own"]["a_m"].get<double>() / 3, taxels["own"]["b_m"].get<double>() / 2);
    EXPECT_GE(pitch_m, covering_m * (1 - 1e-12)) << one["model"];
    // The outermost cells of layer_fft reach a 55th of a beyond the edge.
    EXPECT_LE(pitch_m, covering_m * (1 + 1 / 50.)) << one["model"];
    EXPECT_EQ(taxels["force_N"][0][0], 0);
    // A coarse array overstates the size: the forces of the outer taxels act too far out.
    EXPECT_GT(taxels["shown"]["relative_error"]["a"], 0) << one["model"];
  }
  EXPECT_GE(answered, 6);
}

TEST_F(TaxelsProgram, TheTableHoldsTheNumbersOfTheJson) {
  const ProgramRun result = run({"--taxels", "5,4,1.5", "--taxels-depth", "2", "--taxels-output",
                                 "taxels.csv", "--taxels-picture", "taxels.png", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  json recommended;
  const json printed = json::parse(result.out);
  for (const json& one : printed["results"])
    if (one["recommended"]) recommended = one;
  const json& taxels = recommended["taxels"];
  const std::vector<std::string> rows = lines(read("taxels.csv"));
  ASSERT_EQ(rows.size(), 21u);
  EXPECT_EQ(rows[0],
            "load_N,model,column,row,x_m,y_m,depth_m,force_N,pressure_Pa,shear_x_Pa,shear_y_Pa,"
            "displacement_m");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    std::vector<std::string> cells;
    std::stringstream line(rows[i]);
    for (std::string cell; std::getline(line, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), 12u);
    const auto number = [&](std::size_t cell) { return std::strtod(cells[cell].c_str(), nullptr); };
    EXPECT_EQ(cells[1], recommended["model"]);
    const std::size_t column = std::stoul(cells[2]), row = std::stoul(cells[3]);
    // All digits are there: the numbers are the same ones.
    EXPECT_EQ(number(4), taxels["x_m"][column]);
    EXPECT_EQ(number(5), taxels["y_m"][row]);
    EXPECT_EQ(number(6), 2e-3);
    EXPECT_EQ(number(7), taxels["force_N"][row][column]);
    EXPECT_EQ(number(8), taxels["pressure_Pa"][row][column]);
    EXPECT_EQ(number(9), taxels["shear_x_Pa"][row][column]);
    EXPECT_EQ(number(10), taxels["shear_y_Pa"][row][column]);
    EXPECT_EQ(number(11), taxels["displacement_m"][row][column]);
  }
  const std::string picture = read("taxels.png");
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, picture.data(), picture.size()));
  image.format = PNG_FORMAT_RGB;
  std::vector<png_byte> pixels(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  EXPECT_EQ(image.width, 801u);
  EXPECT_EQ(image.height, 641u);
  // The taxel with the largest force is the darkest, a corner is nearly white.
  const auto at = [&](unsigned x, unsigned y) {
    return int(pixels[3 * (y * image.width + x) + 1]);
  };
  EXPECT_LT(at(400, 250), 60);
  EXPECT_GT(at(20, 20), 200);
}

TEST_F(TaxelsProgram, ALoadThatIsOutsideOfTheArrayIsSaid) {
  const ProgramRun result = run({"--taxels", "2,2,1"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("taxels, 2 x 2 of 1 mm, on the surface: "), std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("% of the load is outside of the array"), std::string::npos)
      << result.out;
  const ProgramRun whole = run({"--taxels", "4,4"});
  EXPECT_EQ(whole.out.find("outside of the array"), std::string::npos) << whole.out;
  EXPECT_NE(whole.out.find("2 N of 2 N by fingertip_layer"), std::string::npos) << whole.out;
}

TEST_F(TaxelsProgram, WhatIsNoArrayIsRefused) {
  for (const char* array : {"8", "8,8,1,1", "0,8", "8,65", "2.5,8", "8,8,0", "8,8,-1", "a,b", "8,",
                            "8,8,nan", "8,8,1e-6", "8,8,1e300"})
    expect_refusal({"--taxels", array}, "--taxels");
  expect_refusal({"--taxels", "8,8", "--taxels-depth", "2.1"}, "--taxels-depth");
  expect_refusal({"--taxels", "8,8", "--taxels-depth=-0.1"}, "--taxels-depth");
  expect_refusal({"--taxels", "8,8", "--taxels-depth", "nan"}, "--taxels-depth");
  expect_refusal({"--taxels-depth", "1"}, "--taxels NX,NY");
  expect_refusal({"--taxels-output", "a.csv"}, "--taxels NX,NY");
  expect_refusal({"--taxels-picture", "a.png"}, "--taxels NX,NY");
  expect_refusal({"--taxels", "8,8", "--taxels-output", ""}, "--taxels-output");
  expect_refusal({"--taxels", "8,8", "--gap", "sampled"}, "--gap");
}

TEST_F(TaxelsProgram, ASceneIsReadAtItsSteps) {
  // VTU files of the first and the last step only.
  const std::vector<std::string> scene{"simulate", "pinch",       "--output",
                                       "out",      "--vtu-every", "1000000"};
  const auto simulated = [&](std::vector<std::string> more) {
    more.insert(more.begin(), scene.begin(), scene.end());
    return run_softfinger(start, more);
  };
  const ProgramRun result = simulated({"--taxels", "9,9,1", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::vector<std::string> rows = lines(read("out/taxels.csv"));
  EXPECT_EQ(rows[0].rfind("time_s,body_a,body_b,load_N,model,", 0), 0u) << rows[0];
  double sum_N = 0;
  for (std::size_t i = rows.size() - 81; i < rows.size(); ++i) {
    std::stringstream line(rows[i]);
    std::string cell;
    for (int k = 0; k <= 10; ++k) std::getline(line, cell, ',');
    sum_N += std::strtod(cell.c_str(), nullptr);
  }
  const json contacts = json::parse(result.out)["contacts"];
  EXPECT_NEAR(sum_N, contacts[contacts.size() - 1]["normal_force_N"].get<double>(), 1e-11);
  for (const auto& [more, part] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--taxels", "9,9"}, "PITCH_mm"},
           {{"--taxels", "9,9,1", "--taxels-depth", "50"}, "--taxels-depth"}}) {
    const ProgramRun refused = simulated(more);
    EXPECT_EQ(refused.status, 2) << refused.out;
    EXPECT_NE(refused.err.find(part), std::string::npos) << refused.err;
  }
  const ProgramRun nowhere = run_softfinger(start, {"simulate", "pinch", "--taxels", "9,9,1"});
  EXPECT_EQ(nowhere.status, 2) << nowhere.out;
  EXPECT_NE(nowhere.err.find("--output"), std::string::npos) << nowhere.err;
}

TEST_F(TaxelsProgram, APictureIsOfOneLoad) {
  const ProgramRun result =
      run_softfinger(start, {"predict", "silicone_pad_2mm", "--load", "1,2", "--taxels", "8,8",
                             "--taxels-picture", "a.png", "--quiet"});
  EXPECT_EQ(result.status, 2) << result.out;
  EXPECT_NE(result.err.find("one load"), std::string::npos) << result.err;
}

TEST_F(TaxelsProgram, FlatPadsAndLayersOfSeveralKindsHaveNoneAtDepth) {
  const ProgramRun flat = run_softfinger(
      start, {"predict", "--pad-mm", "22,37.5", "--thickness-mm", "3", "--youngs-modulus-kPa",
              "600", "--poisson-ratio", "0.49", "--load", "20", "--taxels", "8,8"});
  EXPECT_EQ(flat.status, 2);
  EXPECT_NE(flat.err.find("--taxels"), std::string::npos) << flat.err;
  const ProgramRun stack = run_softfinger(
      start, {"predict", "skin_over_pulp", "--taxels", "8,8", "--taxels-depth", "0.5", "--quiet"});
  EXPECT_EQ(stack.status, 2);
  EXPECT_NE(stack.err.find("--taxels-depth"), std::string::npos) << stack.err;
}

}  // namespace softfinger::tests
