// Flat pads as a user sees them: softfinger predict and export, and what refuses them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
using nlohmann::json;

/// Rows of a sweep by the names of their columns; no cell but the last one of a row holds a comma.
class Table {
 public:
  explicit Table(const std::string& text) {
    for (const std::string& line : lines(text)) {
      std::istringstream cells(line + ",");
      rows_.emplace_back();
      for (std::string cell; std::getline(cells, cell, ',');) rows_.back().push_back(cell);
    }
  }
  std::size_t count() const { return rows_.size() - 1; }
  std::string cell(std::size_t row, const std::string& column) const {
    const auto place = std::find(rows_[0].begin(), rows_[0].end(), column) - rows_[0].begin();
    return rows_[row + 1].at(std::size_t(place));
  }
  double number(std::size_t row, const std::string& column) const {
    return std::stod(cell(row, column));
  }

 private:
  std::vector<std::vector<std::string>> rows_;
};

class FlatPad : public testing::Test {
 protected:
  TemporaryFolder folder;
  Start start{folder.path(), {}, -1, "", ""};

  static std::string pad_text(const std::string& finger = "{ pad_mm = [22, 37.5] }",
                              const std::string& object = "{ flat = true }",
                              const std::string& contact = "", const std::string& thickness = "3") {
    return "id = \"my_pad\"\n[geometry]\nfinger = " + finger + "\nobject = " + object +
           "\n[layer]\nthickness_mm = " + thickness +
           "\nyoungs_modulus_kPa = 800\npoisson_ratio = 0.49\n[contact]\nload_N = 20\n"
           "friction_coefficient = 0.9\n" +
           contact;
  }
  ProgramRun predict(const std::string& text, const std::vector<std::string>& more = {}) {
    folder.write("pad.toml", text);
    std::vector<std::string> arguments = {"predict", "pad.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_softfinger(start, arguments);
  }
  json answers(const std::string& text, std::vector<std::string> more = {}) {
    more.emplace_back("--json");
    const ProgramRun run = predict(text, more);
    EXPECT_EQ(run.status, 0) << run.err;
    return json::parse(run.out)["results"];
  }
  Table rows_of(const std::string& file) const { return Table(file_text(folder.path() / file)); }
  json exported(const std::string& simulator) {
    const ProgramRun run =
        run_softfinger(start, {"export", "pad.toml", "--to", simulator, "--json"});
    EXPECT_EQ(run.status, 0) << run.err;
    return json::parse(run.out);
  }
  void expect_refusal(const ProgramRun& run, const std::string& words) {
    EXPECT_EQ(run.status, 2) << run.out;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
  }
};

TEST_F(FlatPad, AnswersFirstAndWithEveryKey) {
  const ProgramRun run = predict(pad_text());
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out.rfind("20 N: torque ", 0), 0u) << run.out;
  for (const char* words : {"by pad_layer", "pad contact 22 x 37.5 mm", "e_n ", "MuJoCo friction="})
    EXPECT_NE(lines(run.out)[0].find(words), std::string::npos) << run.out;
  const json results = answers(pad_text());
  ASSERT_EQ(results.size(), 2u);
  for (const json& result : results) {
    EXPECT_EQ(result["contact"], "patch");
    EXPECT_TRUE(result["a_m"].is_null());
    EXPECT_TRUE(result["b_m"].is_null());
    EXPECT_NEAR(result["area_m2"].get<double>(), 22e-3 * 37.5e-3, 1e-12);
    EXPECT_EQ(result["outline_m"].size(), 4u);
    for (const char* key :
         {"indentation_m", "normal_stiffness_N_per_m", "peak_pressure_Pa", "pressure_arm_m",
          "eccentricity_m", "max_torque_Nm", "torsional_stiffness_Nm_per_rad", "cost_ns"})
      EXPECT_GT(result[key].get<double>(), 0) << key;
    for (const char* key :
         {"tilt_limit_Nm", "tilt_stiffness_Nm_per_rad", "tangential_stiffness_N_per_m"})
      for (int axis = 0; axis < 2; ++axis) EXPECT_GT(result[key][axis].get<double>(), 0) << key;
    for (const char* key : {"model", "valid", "validity", "usable", "error_bound", "error_evidence",
                            "recommended", "input_doubt"})
      EXPECT_TRUE(result.contains(key)) << key;
    // The largest torque is mu P e_n.
    EXPECT_NEAR(result["max_torque_Nm"].get<double>(),
                0.9 * 20 * result["eccentricity_m"].get<double>(), 1e-15);
  }
  EXPECT_EQ(results[0]["model"], "pad_layer");
  EXPECT_TRUE(results[0]["recommended"]);
  EXPECT_TRUE(results[0]["usable"]);
  // The arm of uniform pressure on the rectangle, int r dA/A.
  EXPECT_EQ(results[1]["model"], "pad_uniform");
  EXPECT_NEAR(results[1]["eccentricity_m"].get<double>(), 11.62e-3, 0.005e-3);
  EXPECT_FALSE(results[1]["usable"]) << "it is 17 % too large";
  EXPECT_NE(predict(pad_text(), {"--explain"}).out.find("shape factor S"), std::string::npos);
}

TEST_F(FlatPad, TakesNumbersInPlaceOfACase) {
  const std::vector<std::string> rest = {
      "--thickness-mm", "3",  "--youngs-modulus-kPa", "800", "--poisson-ratio", "0.49",
      "--load",         "20", "--friction",           "0.9", "--json"};
  std::vector<std::string> arguments = {"predict", "--pad-mm", "22,37.5"};
  arguments.insert(arguments.end(), rest.begin(), rest.end());
  const ProgramRun run = run_softfinger(start, arguments);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(json::parse(run.out)["results"][0]["eccentricity_m"],
            answers(pad_text())[0]["eccentricity_m"]);
  arguments[1] = "--pad-diameter-mm";
  arguments[2] = "20";
  const ProgramRun round = run_softfinger(start, arguments);
  ASSERT_EQ(round.status, 0) << round.err;
  EXPECT_NEAR(json::parse(round.out)["results"][0]["area_m2"].get<double>(), M_PI * 1e-4, 1e-12);
  arguments.insert(arguments.end(), {"--radii-mm", "5"});
  expect_refusal(run_softfinger(start, arguments), "one of them");
}

TEST_F(FlatPad, TouchesWherePadAndFaceOverlap) {
  // A face of 10 mm across the pad, turned by a right angle: 22 x 10 mm.
  const json crossed =
      answers(pad_text("{ pad_mm = [22, 37.5] }", "{ face_mm = [10, 50], angle_deg = 90 }"))[0];
  EXPECT_NEAR(crossed["area_m2"].get<double>(), 220e-6, 1e-10);
  EXPECT_FALSE(crossed["usable"]) << "the face's edge presses into the pad";
  EXPECT_TRUE(crossed["error_bound"].is_null());
  // The fillet of the pad's edge does not touch.
  const json filleted = answers(pad_text("{ pad_mm = [22, 37.5], edge_radius_mm = 0.5 }"))[0];
  EXPECT_NEAR(filleted["area_m2"].get<double>(), 21e-3 * 36.5e-3, 1e-12);
  // Rubber beside the face helps to carry: between a pad of the flat face alone and one of the
  // whole.
  const json flat = answers(pad_text("{ pad_mm = [21, 36.5] }"))[0],
             whole = answers(pad_text("{ pad_mm = [22, 37.5] }"))[0];
  EXPECT_GT(filleted["eccentricity_m"], flat["eccentricity_m"]);
  EXPECT_LT(filleted["eccentricity_m"], whole["eccentricity_m"]);
  EXPECT_GT(filleted["error_bound"]["max_torque"], flat["error_bound"]["max_torque"]);
  // A face that covers the pad counts as a plane.
  const json covered = answers(pad_text("{ pad_diameter_mm = 20 }", "{ face_mm = [30, 30] }"))[0];
  EXPECT_TRUE(covered["usable"]);
  EXPECT_NEAR(covered["eccentricity_m"].get<double>(),
              answers(pad_text("{ pad_diameter_mm = 20 }"))[0]["eccentricity_m"].get<double>(),
              1e-12);
}

TEST_F(FlatPad, HasTheSameTorqueStuckAndFrictionless) {
  const json stuck = answers(pad_text())[0];
  const json slippery = answers(
      pad_text("{ pad_mm = [22, 37.5] }", "{ flat = true }", "pressing = \"frictionless\""))[0];
  EXPECT_EQ(stuck["max_torque_Nm"], slippery["max_torque_Nm"]);
  EXPECT_GT(stuck["normal_stiffness_N_per_m"].get<double>(),
            1.5 * slippery["normal_stiffness_N_per_m"].get<double>());
  EXPECT_EQ(slippery["pressure_arm_m"], slippery["eccentricity_m"]);
}

TEST_F(FlatPad, CarriesDoubtsAndSettings) {
  std::string text = pad_text();
  const std::string thickness = "thickness_mm = 3";
  text.replace(text.find(thickness), thickness.size(),
               "thickness_mm = { value = 3, factor = 1.5 }");
  const json doubted = answers(text)[0]["input_doubt"];
  EXPECT_GT(doubted["max_torque"].get<double>(), 0.005);
  EXPECT_LT(doubted["max_torque"].get<double>(), 0.1);
  EXPECT_GT(doubted["indentation"].get<double>(), 0.3);
  EXPECT_NE(predict(text).out.find("(by the inputs"), std::string::npos);
  EXPECT_TRUE(answers(pad_text())[0]["input_doubt"].is_null());
  const json thicker = answers(pad_text(), {"--set", "layer.thickness_mm=6"})[0];
  const json typed = answers(pad_text("{ pad_mm = [22, 37.5] }", "{ flat = true }", "", "6"))[0];
  EXPECT_EQ(thicker["indentation_m"], typed["indentation_m"]);
}

TEST_F(FlatPad, SamplesItsLimitSurface) {
  const json result = answers(pad_text(), {"--limit-surface", "50"})[0];
  ASSERT_EQ(result["limit_surface"].size(), 50u);
  EXPECT_EQ(result["limit_surface_model"], "exact");
  const double lowest = result["ellipsoid_deviation"][0],
               highest = result["ellipsoid_deviation"][1];
  // For uniform pressure on an ellipse of 1.7 : 1 it is -8.7 and 0 %.
  EXPECT_LT(lowest, -0.05);
  EXPECT_GT(lowest, -0.12);
  EXPECT_LT(highest, 0.05);
  const double force_N = 0.9 * 20, torque_Nm = result["max_torque_Nm"];
  for (const json& point : result["limit_surface"]) {
    const double used = std::sqrt(std::pow(point["fx_N"].get<double>() / force_N, 2) +
                                  std::pow(point["fy_N"].get<double>() / force_N, 2) +
                                  std::pow(point["torque_Nm"].get<double>() / torque_Nm, 2));
    EXPECT_GT(used, 1 + lowest - 0.01);
    EXPECT_LT(used, 1 + highest + 0.01);
  }
}

TEST_F(FlatPad, BearsALoadBesideItsMiddleUntilItTips) {
  const std::string finger = "{ pad_mm = [22, 37.5] }", plane = "{ flat = true }";
  const json middle = answers(pad_text(finger, plane, "load_at_mm = [0, 0]"))[0];
  const json plain = answers(pad_text())[0];
  EXPECT_NEAR(middle["eccentricity_m"].get<double>() / plain["eccentricity_m"].get<double>(), 1,
              1e-3);
  const double limit_mm = 1e3 * plain["tilt_limit_Nm"][1].get<double>() / 20;
  const json off = answers(
      pad_text(finger, plane, "load_at_mm = [" + std::to_string(0.9 * limit_mm) + ", 0]"))[0];
  EXPECT_NEAR(off["tilt_utilisation"].get<double>(), 0.9, 1e-6);
  EXPECT_NEAR(off["centre_of_pressure_m"][0].get<double>(), 0.9e-3 * limit_mm, 1e-9);
  EXPECT_GT(off["peak_pressure_Pa"].get<double>(), plain["peak_pressure_Pa"].get<double>());
  EXPECT_EQ(off["lifted_share"], 0);
  // Further out a part of the face carries nothing.
  const json lifted = answers(pad_text(finger, plane, "load_at_mm = [5, 0]"))[0];
  EXPECT_GT(lifted["tilt_utilisation"], 1);
  const double share = lifted["lifted_share"];
  EXPECT_GT(share, 0.05);
  EXPECT_LT(share, 0.4);
  EXPECT_NEAR(lifted["area_m2"].get<double>() / plain["area_m2"].get<double>(), 1 - share, 1e-12);
  EXPECT_LT(lifted["eccentricity_m"], off["eccentricity_m"]);
  EXPECT_GT(lifted["error_bound"]["max_torque"], plain["error_bound"]["max_torque"]);
  EXPECT_TRUE(lifted["error_bound"]["indentation"].is_null());
  expect_refusal(predict(pad_text(finger, plane, "load_at_mm = [10.9, 0]")), "about to tip");
  expect_refusal(predict(pad_text(finger, plane, "load_at_mm = [12, 0]")), "tips");
}

TEST_F(FlatPad, RefusesBadInputWithOneLine) {
  const std::string plane = "{ flat = true }", pad = "{ pad_mm = [22, 37.5] }";
  const struct {
    std::string finger, object, contact, words;
  } wrong[] = {
      {"{ pad_outline_mm = [[0,0],[10,0],[0,10],[10,10]] }", plane, "",
       "pad.toml:3: finger.pad_outline_mm = an outline that crosses itself"},
      {"{ pad_outline_mm = [[0,0],[10,0],[2,2],[0,10]] }", plane, "", "hollow corner"},
      {"{ pad_outline_mm = [[0,0],[10,0]] }", plane, "", "three points"},
      {"{ pad_outline_mm = [[0,0],[5,0],[10,0]] }", plane, "", "without an area"},
      {"{ pad_outline_mm = [[0,0],[10,0],[nan,3]] }", plane, "", "finite"},
      {"{ pad_outline_mm = \"round\" }", plane, "", "three points"},
      {"{ pad_mm = [22, -3] }", plane, "", "0.001 to 1000000"},
      {"{ pad_mm = [22, inf] }", plane, "", "[length, width]"},
      {"{ pad_mm = [22, 1e99] }", plane, "", "0.001 to 1000000"},
      {"{ pad_mm = [22] }", plane, "", "[length, width]"},
      {"{ pad_mm = [22, 20], corner_radius_mm = 11 }", plane, "", "half of the shorter side, 10"},
      {"{ pad_mm = [22, 20], corner_radius_mm = -1 }", plane, "", "half of the shorter side, 10"},
      {"{ pad_diameter_mm = 20, corner_radius_mm = 1 }", plane, "", "belongs to finger.pad_mm"},
      {"{ pad_mm = [22, 20], edge_radius_mm = 10 }", plane, "", "edge_radius_mm = 10"},
      {"{ pad_mm = [22, 20], edge_radius_m = 1 }", plane, "", "did you mean \"edge_radius_mm\""},
      {"{ pad_mm = [22, 20], pad_diameter_mm = 3 }", plane, "", "exactly one of"},
      {"{ pad_diameter_mm = 0 }", plane, "", "0.001 to 1000000"},
      {pad, "{ radii_mm = [inf, inf] }", "", "is a plane: give flat = true"},
      {pad, "{ sphere_radius_mm = 20 }", "", "Type softfinger fem"},
      {pad, "{ mesh = \"x.stl\", along = \"+z\" }", "", "a pad takes object = { flat = true }"},
      {"{ radii_mm = [9, 7] }", plane, "", "geometry.finger is curved"},
      {"{ mesh = \"x.stl\", along = \"+z\" }", plane, "", "geometry.finger is curved"},
      {pad, "{ flat = false }", "", "object.flat = false"},
      {pad, "{ flat = true, offset_mm = [1, 2] }", "", "belongs to a face with an end"},
      {pad, "{ face_mm = [10, 50], offset_mm = [40, 2] }", "", "does not touch the pad"},
      {pad, "{ face_mm = [10, 50], offset_mm = [15.9, 2] }", "", "sliver of 37.5 x 0.1 mm"},
      {pad, plane, "pressing = \"sticky\"", "\"stuck\" or \"frictionless\""},
      {pad, plane, "load_at_mm = [1]", "two finite numbers"},
      {pad, plane, "shear_law = \"limited\"\nshear_strength_kPa = 3", "\"coulomb\" for a flat pad"},
      {pad, plane, "[fem]\ngeometry = \"flat\"", "no [fem] geometry yet"},
      {pad, plane, "[object_layer]\nthickness_mm = 1\nyoungs_modulus_kPa = 1\npoisson_ratio = 0.3",
       "no [object_layer] yet"}};
  for (const auto& one : wrong)
    expect_refusal(predict(pad_text(one.finger, one.object, one.contact)), one.words);
  expect_refusal(predict(case_text() + "load_at_mm = [1, 0]\n"), "load_at_mm");
  expect_refusal(predict(pad_text(), {"--model", "hertz"}), "no model of flat pads");
  expect_refusal(predict(pad_text(), {"--torque-rule", "paper"}), "--torque-rule");
  expect_refusal(predict(pad_text(), {"--gap", "sampled"}), "--gap");
  expect_refusal(predict(pad_text(), {"--page", "a.html"}), "--page");
}

TEST_F(FlatPad, SaysThatAPadThickerThanWideHasNoBound) {
  const json thick = answers(pad_text("{ pad_mm = [22, 37.5] }", "{ flat = true }", "", "80"))[0];
  EXPECT_FALSE(thick["usable"]);
  EXPECT_TRUE(thick["error_bound"].is_null());
  const std::string evidence = thick["error_evidence"];
  EXPECT_NE(evidence.find("thicker"), std::string::npos) << evidence;
}

TEST_F(FlatPad, IsRefusedByNameWhereACommandCannotTakeIt) {
  folder.write("pad.toml", pad_text());
  folder.write("data.csv", "load_N,indentation_mm\n1,0.1\n2,0.2\n");
  expect_refusal(run_softfinger(start, {"calibrate", "data.csv", "pad.toml"}),
                 "softfinger calibrate does not take flat pads yet");
}

TEST_F(FlatPad, IsSweptWithTheNumbersOfPredict) {
  folder.write("sweep.toml", pad_text() +
                                 "[sweep]\n\"layer.thickness_mm\" = [1, 3, 6]\n"
                                 "\"geometry.finger.pad_mm[0]\" = [15, 22]\n"
                                 "\"contact.load_N\" = [5, 20]\n");
  const std::vector<std::string> command = {"sweep", "sweep.toml", "--output", "there"};
  const ProgramRun run = run_softfinger(start, command);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out.rfind("my_pad: torque ", 0), 0u) << run.out;
  EXPECT_NE(lines(run.out)[0].find("by pad_layer, usable (within 10 %) in 12 of 12 rows"),
            std::string::npos)
      << run.out;
  const Table rows = rows_of("there/results.csv");
  ASSERT_EQ(rows.count(), 12u);
  // The eighth point: 3 mm, 22 mm, 20 N, as the case has it.
  const json known = answers(pad_text());
  for (const json& model : known)
    for (const char* key : {"indentation_m", "normal_stiffness_N_per_m", "peak_pressure_Pa",
                            "pressure_arm_m", "eccentricity_m", "max_torque_Nm"})
      EXPECT_NEAR(
          rows.number(7, model["model"].get<std::string>() + "_" + key) / model[key].get<double>(),
          1, 1e-9)
          << key;
  for (const auto& [axis, column] : {std::pair(0, "x"), std::pair(1, "y")}) {
    EXPECT_NEAR(rows.number(7, std::string("pad_layer_tilt_limit_") + column + "_Nm") /
                    known[0]["tilt_limit_Nm"][axis].get<double>(),
                1, 1e-9);
    EXPECT_NEAR(rows.number(7, std::string("pad_layer_tilt_stiffness_") + column + "_Nm_per_rad") /
                    known[0]["tilt_stiffness_Nm_per_rad"][axis].get<double>(),
                1, 1e-9);
  }
  EXPECT_NEAR(rows.number(7, "area_m2"), 22e-3 * 37.5e-3, 1e-12);
  EXPECT_EQ(rows.cell(7, "pad_uniform_usable"), "no");
  const std::string page = file_text(folder.path() / "there/sweep.html");
  EXPECT_NE(page.find("By Pad layer, usable (within 10"), std::string::npos);
  EXPECT_NE(page.find("’s torque is up to "), std::string::npos);
  const ProgramRun again = run_softfinger(start, command);
  EXPECT_NE(again.err.find("is finished: reused"), std::string::npos) << again.err;
  EXPECT_EQ(again.out, run.out);
}

TEST_F(FlatPad, SaysInTheRowOfASweepWhereItTips) {
  folder.write("sweep.toml",
               pad_text("{ pad_mm = [22, 37.5] }", "{ flat = true }", "load_at_mm = [0, 0]\n") +
                   "[sweep]\n\"contact.load_at_mm[0]\" = [0, 5, 10.9]\n");
  const ProgramRun run = run_softfinger(start, {"sweep", "sweep.toml", "--output", "there"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Table rows = rows_of("there/results.csv");
  ASSERT_EQ(rows.count(), 3u);
  EXPECT_EQ(rows.cell(1, "failure"), "");
  EXPECT_LT(rows.number(1, "pad_layer_max_torque_Nm"), rows.number(0, "pad_layer_max_torque_Nm"));
  EXPECT_EQ(rows.cell(2, "pad_layer_max_torque_Nm"), "");
  EXPECT_NE(file_text(folder.path() / "there/results.csv").find("about to tip"), std::string::npos);
}

TEST_F(FlatPad, IsSweptBesideItsElements) {
  folder.write("sweep.toml", pad_text("{ pad_diameter_mm = 20 }") +
                                 "[sweep]\n\"layer.thickness_mm\" = [2, 3]\nfem = true\n");
  const std::vector<std::string> command = {"sweep", "sweep.toml", "--output", "there"};
  const ProgramRun run = run_softfinger(start, command);
  ASSERT_EQ(run.status, 0) << run.err;
  const Table rows = rows_of("there/results.csv");
  ASSERT_EQ(rows.count(), 2u);
  for (std::size_t row = 0; row < 2; ++row) {
    EXPECT_EQ(rows.cell(row, "failure"), "");
    // The fake elements are those of uniform pressure.
    EXPECT_NEAR(
        rows.number(row, "fem_max_torque_Nm") / rows.number(row, "pad_uniform_max_torque_Nm"), 1,
        2e-3);
  }
  EXPECT_NE(file_text(folder.path() / "there/sweep.html").find("Closest to the finite elements is"),
            std::string::npos);
  EXPECT_NE(run_softfinger(start, command).err.find("[2/2] my_pad point 1: reused"),
            std::string::npos);
  start.environment.emplace_back("FAKE_FEM_CRASH_N=20");
  const ProgramRun failed = run_softfinger(start, {"sweep", "sweep.toml", "--output", "failing"});
  EXPECT_EQ(failed.status, 1) << failed.err;
  EXPECT_NE(failed.err.find("2 of 2 finite-element results are missing"), std::string::npos);
  EXPECT_NE(rows_of("failing/results.csv").cell(0, "failure").find("killed by signal"),
            std::string::npos);
}

/// The fake elements of a disc are those of uniform pressure.
TEST_F(FlatPad, IsComparedWithTheElements) {
  folder.write("pad.toml", pad_text("{ pad_diameter_mm = 20 }"));
  folder.write("case.toml", case_text("curved", "[1.0, 5.0]"));
  const std::vector<std::string> command = {"compare", "pad.toml", "case.toml", "--output",
                                            "there",   "--linear", "--jobs",    "1"};
  const ProgramRun run = run_softfinger(start, command);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(lines(run.out)[0].rfind("curved: ", 0), 0u) << run.out;
  EXPECT_EQ(lines(run.out)[1].rfind("my_pad: Use Pad uniform (torque within 0.1 %", 0), 0u)
      << run.out;
  const json report = json::parse(file_text(folder.path() / "there/report.json"));
  ASSERT_EQ(report["cases"].size(), 2u);
  const json& pad = report["cases"][1];
  EXPECT_EQ(pad["contact"], "patch");
  EXPECT_EQ(pad["verdict_class"], "good");
  const json& load = pad["loads"][0];
  EXPECT_TRUE(load["fem"]["trusted"]);
  EXPECT_TRUE(load["fem"]["a_m"].is_null());
  ASSERT_EQ(load["models"].size(), 2u);
  for (const json& model : load["models"]) {
    for (const auto& [key, error] :
         {std::pair("max_torque_Nm", "max_torque"), std::pair("indentation_m", "indentation"),
          std::pair("pressure_arm_m", "pressure_arm"),
          std::pair("normal_stiffness_N_per_m", "normal_stiffness"),
          std::pair("peak_pressure_Pa", "peak_pressure")})
      EXPECT_NEAR(model["relative_error"][error].get<double>(),
                  model[key].get<double>() / load["fem"][key].get<double>() - 1, 1e-12)
          << model["model"] << " " << key;
    EXPECT_EQ(model["profile_x"]["position_m"].size(), model["profile_x"]["pressure_Pa"].size());
  }
  EXPECT_FALSE(load["models"][0]["usable"]);
  EXPECT_TRUE(load["models"][1]["usable"]);
  const auto rows = lines(file_text(folder.path() / "there/results.csv"));
  int patches = 0;
  for (const std::string& row : rows) {
    EXPECT_EQ(std::count(row.begin(), row.end(), ','),
              std::count(rows[0].begin(), rows[0].end(), ','))
        << row;
    patches += row.find(",patch,") != std::string::npos;
  }
  EXPECT_EQ(patches, 3) << "elements and two models";
  EXPECT_NE(file_text(folder.path() / "there/report.html").find("data-case=\"my_pad\""),
            std::string::npos);

  const ProgramRun again = run_softfinger(start, command);
  EXPECT_EQ(again.status, 0);
  EXPECT_NE(again.err.find("my_pad 20 N: reused"), std::string::npos) << again.err;
  folder.write("there/fem/my_pad_20N/result.json", "{ half");
  EXPECT_NE(run_softfinger(start, command).err.find("made again"), std::string::npos);

  std::vector<std::string> as_json = command;
  as_json.emplace_back("--json");
  const json answer = json::parse(run_softfinger(start, as_json).out);
  EXPECT_EQ(answer["cases"][1]["id"], "my_pad");
  EXPECT_EQ(answer["results"].back()["model"], "pad_uniform");
  EXPECT_EQ(answer["results"].back()["case"], "my_pad");
  EXPECT_TRUE(answer["trusted"]);
}

TEST_F(FlatPad, SaysWhenItsReferenceFailsOrNoModelHolds) {
  folder.write("pad.toml", pad_text("{ pad_diameter_mm = 20 }", "{ face_diameter_mm = 12 }"));
  const ProgramRun open = run_softfinger(start, {"compare", "pad.toml"});
  EXPECT_EQ(open.status, 0) << open.err;
  EXPECT_EQ(open.out.rfind("my_pad: No model can be relied on at 20 N: nearest is ", 0), 0u)
      << open.out;
  EXPECT_NE(open.out.find("which states no bound there"), std::string::npos) << open.out;
  start.environment.emplace_back("FAKE_FEM_CRASH_N=20");
  const ProgramRun failed = run_softfinger(start, {"compare", "pad.toml", "--output", "there"});
  EXPECT_EQ(failed.status, 1) << failed.err;
  EXPECT_EQ(failed.out.rfind("my_pad: No verdict: FEM failed at 20 N (", 0), 0u) << failed.out;
}

TEST_F(FlatPad, GetsTheCheapestModelThatIsAccurateEnough) {
  folder.write("pad.toml", pad_text());
  const auto select = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"select", "pad.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_softfinger(start, arguments);
  };
  const auto chosen = [&](std::vector<std::string> more) {
    more.emplace_back("--json");
    return json::parse(select(more).out)["choices"][0];
  };
  const json usual = chosen({"--tolerance", "0.1"});
  EXPECT_EQ(usual["model"], "pad_layer");
  EXPECT_EQ(usual["next_better"], "fem");
  EXPECT_TRUE(usual["error_bound"]["a"].is_null());
  EXPECT_EQ(usual["candidates"].size(), 3u);
  EXPECT_EQ(chosen({"--tolerance", "0.005"})["model"], "fem");
  EXPECT_TRUE(chosen({"--tolerance", "0.005", "--budget-us", "100"})["model"].is_null());
  EXPECT_EQ(chosen({"--tolerance", "0.3", "--models", "pad_uniform"})["model"], "pad_uniform");
  // The pressure on foam is uniform.
  EXPECT_EQ(chosen({"--tolerance", "0.01", "--set", "layer.poisson_ratio=0"})["model"],
            "pad_layer");
  // The elements refuse a face that crosses the pad's outline at an angle, and the models know no
  // bound.
  const json crossed = chosen({"--set", "geometry.object={ face_mm = [10, 50], angle_deg = 10 }"});
  EXPECT_TRUE(crossed["model"].is_null());
  EXPECT_EQ(chosen({"--set", "geometry.object={ face_mm = [10, 50] }"})["model"], "fem");
  EXPECT_EQ(chosen({"--set", "geometry.object={ face_mm = [10, 20] }"})["model"], "fem");
  const ProgramRun words = select({"--tolerance", "0.1", "--output", "page"});
  EXPECT_EQ(words.status, 0) << words.err;
  EXPECT_EQ(words.out.rfind("20 N: pad_layer within 2.5 % (max_torque)", 0), 0u) << words.out;
  EXPECT_NE(words.out.find("torque by the inputs: h + 10 %"), std::string::npos);
  EXPECT_NE(file_text(folder.path() / "page/select.html").find("whole pad"), std::string::npos);
  expect_refusal(select({"--quantities", "a,b"}), "no semi-axes");
  expect_refusal(select({"--models", "hertz"}), "pad_layer");
}

constexpr const char* kSimulators[] = {"bullet", "drake",  "gazebo", "genesis", "gz-sim", "isaac",
                                       "mujoco", "newton", "ode",    "physx",   "sapien", "usd"};

TEST_F(FlatPad, IsExportedAsOneContactPoint) {
  folder.write("pad.toml", pad_text());
  const ProgramRun run = run_softfinger(start, {"export", "pad.toml", "--to", "mujoco"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("condim=\"4\""), std::string::npos);
  EXPECT_NE(run.out.find("- take the box"), std::string::npos);
  const double e_m = answers(pad_text())[0]["eccentricity_m"];
  const json mujoco = exported("mujoco")["values"], bullet = exported("bullet")["values"],
             gazebo = exported("gazebo")["values"], physx = exported("physx")["values"],
             newton = exported("newton")["values"], usd = exported("usd")["values"],
             gz_sim = exported("gz-sim")["values"], genesis = exported("genesis")["values"],
             sapien = exported("sapien")["values"], isaac = exported("isaac")["values"];
  // Each engine's law, from its documentation: the largest torque over the load is mu e_n.
  EXPECT_NEAR(mujoco["spinning_friction_m"].get<double>(), 0.9 * e_m, 1e-12);
  EXPECT_NEAR(bullet["spinning_friction_m"].get<double>(), 0.9 * e_m, 1e-12);
  EXPECT_NEAR(3 * M_PI / 16 * gazebo["patch_radius_m"].get<double>(), e_m, 1e-12);
  EXPECT_NEAR(physx["min_torsional_patch_radius_m"].get<double>(), e_m, 1e-12);
  EXPECT_NEAR(newton["torsional_friction_m"].get<double>(), 0.9 * e_m, 1e-12);
  EXPECT_NEAR(usd["torsional_friction_m"].get<double>(), 0.9 * e_m, 1e-12);
  // Three points in DART's friction pyramids hold 1.077 to 1.115 mu P times their distance.
  EXPECT_NEAR(gz_sim["three_points_radius_m"].get<double>() / e_m, 0.9121, 1e-4);
  EXPECT_NEAR(exported("ode")["values"]["spinning_friction_m"].get<double>(), 0.9 * e_m, 1e-12);
  EXPECT_NEAR(genesis["torsional_friction_m"].get<double>(), 0.9 * e_m, 1e-12);
  EXPECT_NEAR(sapien["min_torsional_patch_radius_m"].get<double>(), e_m, 1e-12);
  EXPECT_NEAR(isaac["min_torsional_patch_radius_m"].get<double>(), e_m, 1e-12);
}

TEST_F(FlatPad, IsExportedAsABoxWhoseCornersHaveItsTorque) {
  folder.write("pad.toml", pad_text());
  for (const char* simulator : kSimulators) {
    SCOPED_TRACE(simulator);
    const json made = exported(simulator), box = made["box_values"];
    const double x_m = box["box_half_length_x_m"], y_m = box["box_half_length_y_m"];
    // In friction pyramids corners of this rectangle hold 1.1804 to 1.3685 mu P times their
    // distance: 1.2745 within 7.4 %.
    const bool pyramid = std::string(simulator) == "ode" || std::string(simulator) == "gazebo" ||
                         std::string(simulator) == "gz-sim";
    EXPECT_NEAR(
        std::hypot(x_m, y_m) * (pyramid ? 1.2745 : 1) / made["eccentricity_m"].get<double>(), 1,
        pyramid ? 1e-4 : 1e-9);
    EXPECT_NEAR(x_m / y_m, 22 / 37.5, 1e-12);
    EXPECT_NE(made["box_lines"].get<std::string>().find("0.9"), std::string::npos);
    EXPECT_FALSE(made["law"].get<std::string>().empty());
    const ProgramRun run = run_softfinger(start, {"export", "pad.toml", "--to", simulator});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_NE(run.out.find(made["box_lines"].get<std::string>()), std::string::npos);
    EXPECT_NE(run.out.find(made["lines"].get<std::string>()), std::string::npos);
  }
  // A load beside the middle takes torque from one point; from the box it does so by itself.
  const json middle = exported("mujoco");
  folder.write("pad.toml",
               pad_text("{ pad_mm = [22, 37.5] }", "{ flat = true }", "load_at_mm = [0, 3.4]"));
  const json beside = exported("mujoco");
  EXPECT_LT(beside["eccentricity_m"].get<double>(), 0.98 * middle["eccentricity_m"].get<double>());
  EXPECT_EQ(beside["box_values"], middle["box_values"]);
}

/// int r dA/A over a rectangle around its middle, by the midpoint rule.
double mean_distance_m(double half_x_m, double half_y_m) {
  constexpr int kCells = 400;
  double sum_m = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j)
      sum_m += std::hypot((i + 0.5) / kCells * half_x_m, (j + 0.5) / kCells * half_y_m);
  return sum_m / (kCells * kCells);
}

TEST_F(FlatPad, IsExportedAsAFoundationWithItsTorqueAndStiffness) {
  folder.write("pad.toml", pad_text());
  const json drake = exported("drake"), values = drake["values"];
  const double x_m = values["pressed_box_half_length_x_m"],
               y_m = values["pressed_box_half_length_y_m"], e_m = drake["eccentricity_m"],
               area_m2 = 4 * x_m * y_m;
  EXPECT_NEAR(mean_distance_m(x_m, y_m) / e_m, 1, 1e-5);
  // Pressure is modulus times depth over the depth of the innermost point, half the thickness.
  EXPECT_NEAR(values["hydroelastic_modulus_Pa"].get<double>() * area_m2 / 1.5e-3 /
                  drake["normal_stiffness_N_per_m"].get<double>(),
              1, 1e-9);
  EXPECT_NEAR(values["own_face_torque_error"].get<double>(),
              mean_distance_m(11e-3, 18.75e-3) / e_m - 1, 1e-5);
  const json newton = exported("newton");
  EXPECT_NEAR(newton["values"]["kh_N_per_m3"].get<double>() * area_m2 /
                  newton["normal_stiffness_N_per_m"].get<double>(),
              1, 1e-9);
}

TEST_F(FlatPad, TellsAControllerHowFarThePressureMayMove) {
  folder.write("pad.toml", pad_text());
  const json plain = exported("mujoco"), controller = plain["controller"];
  EXPECT_EQ(controller["torsional_length_m"], plain["eccentricity_m"]);
  EXPECT_NEAR(controller["tipping_half_lengths_m"][0].get<double>(), 11e-3, 1e-12);
  EXPECT_NEAR(controller["tipping_half_lengths_m"][1].get<double>(), 18.75e-3, 1e-12);
  for (int axis = 0; axis < 2; ++axis)
    EXPECT_NEAR(controller["lift_off_half_lengths_m"][axis].get<double>(),
                plain["results"][0]["tilt_limit_Nm"][1 - axis].get<double>() / 20, 1e-12);
  folder.write("pad.toml", pad_text("{ pad_diameter_mm = 20 }"));
  // A square in the circle, which is a polygon of 40 corners.
  const json disc = exported("mujoco");
  for (const double half_m : disc["controller"]["tipping_half_lengths_m"])
    EXPECT_NEAR(half_m, 10e-3 / std::sqrt(2.), 0.05e-3);
}

TEST_F(FlatPad, HasItsOwnInitAndCards) {
  ASSERT_EQ(run_softfinger(start, {"init", "new.toml", "--pad"}).status, 0);
  EXPECT_EQ(run_softfinger(start, {"predict", "new.toml"}).status, 0);
  for (const char* model : {"pad_layer", "pad_uniform"})
    EXPECT_EQ(run_softfinger(start, {"explain", model}).status, 0);
}

TEST_F(FlatPad, IsDistinguishedFromAnEllipse) {
  folder.write("case.toml", case_text());
  const json ellipse =
      json::parse(run_softfinger(start, {"predict", "case.toml", "--json"}).out)["results"][0];
  EXPECT_EQ(ellipse["contact"], "ellipse");
}

constexpr const char* kRollerFinger = "{ roller_radius_mm = 14, length_mm = 28 }";

TEST_F(FlatPad, ARollerIsALineWithEnds) {
  const ProgramRun run = predict(pad_text(kRollerFinger));
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(lines(run.out)[0].find("by line_layer; line contact 28 x "), std::string::npos)
      << run.out;
  const json result = answers(pad_text(kRollerFinger))[0];
  EXPECT_EQ(result["contact"], "line");
  EXPECT_EQ(result["pressing"], "frictionless");
  EXPECT_DOUBLE_EQ(result["a_m"], 14e-3);
  EXPECT_GT(result["b_m"], 1e-3);
  EXPECT_TRUE(result["usable"]);
  // The ends are pressed less than the middle: a quarter of the length at most.
  EXPECT_LT(result["eccentricity_m"], 7e-3);
  EXPECT_GT(result["eccentricity_m"], 5.5e-3);
  EXPECT_TRUE(result["tilt_stiffness_Nm_per_rad"][0].is_null());
  EXPECT_GT(result["tilt_stiffness_Nm_per_rad"][1], 0);
  EXPECT_TRUE(result["torsional_stiffness_Nm_per_rad"].is_null());
  // A roller on an equal one has half of the relative radius, and so has a cylinder on a wide pad.
  const json two = answers(pad_text(kRollerFinger, "{ cylinder_radius_mm = 14 }"))[0];
  const json pad = answers(pad_text("{ pad_mm = [28, 40] }", "{ cylinder_radius_mm = 7 }"))[0];
  for (const char* key : {"b_m", "indentation_m", "eccentricity_m", "normal_stiffness_N_per_m"})
    EXPECT_NEAR(two[key].get<double>() / pad[key].get<double>(), 1, 1e-9) << key;
  EXPECT_LT(two["b_m"], result["b_m"]);
}

TEST_F(FlatPad, ALinesLimitSurfaceEndsAtItsTorque) {
  for (const json& result : answers(pad_text(kRollerFinger), {"--limit-surface", "200"})) {
    double largest = 0;
    for (const json& point : result["limit_surface"])
      largest = std::max(largest, std::abs(point["torque_Nm"].get<double>()));
    // Turning about the middle is among the twists only nearly.
    EXPECT_NEAR(largest / result["max_torque_Nm"].get<double>(), 1, 0.01);
  }
}

TEST_F(FlatPad, ASphereFarFromTheWallsIsAnOrdinaryContact) {
  const std::string sphere = "{ sphere_radius_mm = 10 }";
  const json on_pad = answers(pad_text("{ pad_mm = [30, 30] }", sphere))[0];
  const json ordinary = answers(pad_text("{ radii_mm = [inf, inf] }", "{ radii_mm = [10, 10] }",
                                         "pressing = \"frictionless\"\n"))[0];
  for (const char* key : {"a_m", "b_m", "indentation_m", "max_torque_Nm"})
    EXPECT_DOUBLE_EQ(on_pad[key], ordinary[key]) << key;
  expect_refusal(predict(pad_text("{ pad_mm = [12, 12] }", sphere)), "Type softfinger fem");
}

TEST_F(FlatPad, RefusesWhatALineIsNotAnsweredFor) {
  const std::string pad = "{ pad_mm = [28, 40] }", cylinder = "{ cylinder_radius_mm = 7 }";
  const auto refused = [&](const std::string& finger, const std::string& object,
                           const std::string& words, const std::string& contact = "") {
    expect_refusal(predict(pad_text(finger, object, contact)), words);
  };
  refused(pad, "{ cylinder_radius_mm = -7 }", "hollow");
  refused(pad, "{ radii_mm = [7, inf] }", "exchange both sides");
  refused(pad, "{ radii_mm = [inf, inf] }", "flat = true");
  refused(pad, "{ cylinder_radius_mm = 7, offset_mm = [0, 30] }", "outside of the pad");
  refused(pad, cylinder, "without turning", "pressing = \"frictionless\"\nload_at_mm = [1, 0]\n");
  refused(pad, cylinder, "frictionless", "pressing = \"stuck\"\n");
  refused("{ pad_diameter_mm = 20 }", cylinder, "rectangle");
  refused("{ roller_radius_mm = 14 }", "{ flat = true }", "length_mm");
  refused(kRollerFinger, "{ face_mm = [3, 4] }", "parallel axis");
  expect_refusal(run_softfinger(start, {"predict", "--radii-mm", "inf,15", "--thickness-mm", "3",
                                        "--youngs-modulus-kPa", "800", "--poisson-ratio", "0.49",
                                        "--load", "20"}),
                 "roller_radius_mm");
  folder.write("roller.toml", pad_text(kRollerFinger));
  expect_refusal(run_softfinger(start, {"select", "roller.toml"}), "does not take a roller yet");
  folder.write("sweep.toml", pad_text(kRollerFinger) + "[sweep]\n\"contact.load_N\" = [1, 2]\n");
  expect_refusal(run_softfinger(start, {"sweep", "sweep.toml"}), "does not take a roller yet");
  folder.write("sphere.toml", pad_text(pad, "{ sphere_radius_mm = 20 }"));
  expect_refusal(run_softfinger(start, {"compare", "sphere.toml"}),
                 "does not take a curved object on a flat pad yet");
  expect_refusal(run_softfinger(start, {"export", "roller.toml", "--to", "mujoco"}),
                 "does not take a roller yet");
}

}  // namespace softfinger::tests
