// `softfinger calibrate` and `softfinger area` as their users see them.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "png_of.h"
#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace fs = std::filesystem;
using nlohmann::json;

class CalibrateProgram : public testing::Test {
 protected:
  TemporaryFolder folder;
  Start start{folder.path(), {}, -1, ""};

  ProgramRun run(const std::vector<std::string>& arguments) {
    return run_softfinger(start, arguments);
  }
  json result_of(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.status == 0 ? json::parse(result.out) : json();
  }
  void expect_refusal(const std::vector<std::string>& arguments,
                      const std::vector<std::string>& parts) {
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 2) << result.out << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
    for (const std::string& part : parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << result.err << "\nhas no " << part;
  }

  /// A case of this truth, and a file of what `predict` says of it with an error of 1 %, to
  /// alternating sides.
  /// @param factor  of one value, which makes it an outlier
  void write_truth(const std::string& geometry, double factor = 1, bool with_errors = false) {
    folder.write("truth.toml", "id = \"truth\"\n[geometry]\n" + geometry +
                                   "\n[layer]\nthickness_mm = 2.5\nyoungs_modulus_kPa = 400\n"
                                   "poisson_ratio = 0.47\n[contact]\nload_N = [0.2, 0.4, 0.8, 1.5, "
                                   "3, 6, 10]\nfriction_coefficient = 0.7\n");
    // First guess of the finger's owner.
    folder.write("case.toml", "id = \"mine\"\n# of the drawing\n[geometry]\n" + geometry +
                                  "\n[layer]\nthickness_mm = 5.0\nyoungs_modulus_kPa = 100\n"
                                  "poisson_ratio = 0.47\n[contact]\nload_N = 2.0\n"
                                  "friction_coefficient = 0.3\n");
    const json truth =
        result_of({"predict", "truth.toml", "--model", "fingertip_layer"})["results"];
    std::string text = "load_N,a_mm,b_mm,indentation_mm,max_torque_mNm";
    text += with_errors ? ",a_mm_std\n" : "\n";
    int i = 0;
    for (const json& answer : truth) {
      const auto noisy = [&](const char* key) {
        return 1e3 * answer[key].get<double>() * (i++ % 2 == 0 ? 1.01 : 0.99);
      };
      const double a_mm = noisy("a_m") * (answer["load_N"] == 3 ? factor : 1);
      text += fmt::format("{},{:.6g},{:.6g},{:.6g},{:.6g}", answer["load_N"].get<double>(), a_mm,
                          noisy("b_m"), noisy("indentation_m"), noisy("max_torque_Nm"));
      text += with_errors ? fmt::format(",{:.3g}\n", 0.01 * a_mm) : "\n";
      ++i;  // four in a row: each quantity is to be off to both sides
    }
    folder.write("data.csv", text);
  }
};

const char* const kRadii =
    "finger = { radii_mm = [12.0, 9.0] }\nobject = { radii_mm = [inf, inf] }";

TEST_F(CalibrateProgram, FindsWhatPredictionsWereMadeWith) {
  write_truth(kRadii);
  const json found = result_of({"calibrate", "data.csv", "case.toml"});
  for (const char* key : {"case", "data", "model", "shear_law", "parameters", "fixed", "covariance",
                          "cannot_tell", "next_measurement", "models", "shear_laws", "outliers",
                          "residuals", "goodness", "growth_exponent"})
    EXPECT_TRUE(found.contains(key)) << key;
  const json& parameters = found["parameters"];
  ASSERT_EQ(parameters.size(), 3u) << parameters;
  const std::vector<std::pair<const char*, double>> truth = {
      {"youngs_modulus", 400e3}, {"thickness", 2.5e-3}, {"friction_coefficient", 0.7}};
  for (const auto& [name, value] : truth) {
    const json& estimate = parameters[name];
    EXPECT_TRUE(estimate["determined"].get<bool>()) << name;
    EXPECT_LE(estimate["interval95"][0].get<double>(), value) << name;
    EXPECT_GE(estimate["interval95"][1].get<double>(), value) << name;
    // The errors are 1 % and alternate: 28 of them leave a per cent or two of the parameters.
    EXPECT_NEAR(estimate["value"].get<double>() / value, 1, 0.04) << name;
    EXPECT_GT(estimate["std"].get<double>(), 0) << name;
    // A covariance is a square of standard deviations, in SI.
    EXPECT_NEAR(
        std::sqrt(found["covariance"][name][name].get<double>()) / estimate["std"].get<double>(), 1,
        1e-9);
  }
  EXPECT_EQ(found["fixed"]["poisson_ratio"], 0.47);
  EXPECT_EQ(found["cannot_tell"], json::array());
  EXPECT_EQ(found["outliers"], json::array());
  EXPECT_EQ(found["residuals"].size(), 28u);
  EXPECT_EQ(found["models"][0]["model"], "fingertip_layer");
  for (const json& model : found["models"]) {
    EXPECT_TRUE(model["aic"].is_number());
    EXPECT_TRUE(model.contains("held_out_error"));
  }
  EXPECT_EQ(found["shear_laws"][0]["shear_law"], "coulomb");
  // Measured values are off by 1 % to both sides, and the scatter says so.
  EXPECT_NEAR(found["goodness"]["scatter"]["a"].get<double>(), 0.01, 0.003);
}

TEST_F(CalibrateProgram, FindsThemOnAMeshWhoseRadiiDependOnTheContact) {
  if (!fs::exists(fs::path(SOFTFINGER_SHARE) / "meshes" / "shadow_like_pad.stl"))
    GTEST_SKIP() << "the built-in meshes need gmsh";
  write_truth(
      "finger = { mesh = \"shadow_like_pad.stl\", unit = \"mm\", point_mm = [0, -7, 0], normal = "
      "[0, -1, 0] }\nobject = { radii_mm = [inf, inf] }");
  const json found =
      result_of({"calibrate", "data.csv", "case.toml", "--output", "elsewhere.toml"});
  EXPECT_GT(found["geometry_rounds"].get<int>(), 1);
  EXPECT_TRUE(found["geometry_settled"].get<bool>());
  EXPECT_NEAR(found["parameters"]["youngs_modulus"]["value"].get<double>() / 400e3, 1, 0.06);
  EXPECT_NEAR(found["parameters"]["thickness"]["value"].get<double>() / 2.5e-3, 1, 0.06);
  const ProgramRun text = run({"calibrate", "data.csv", "case.toml"});
  EXPECT_NE(text.out.find("fit and geometry were repeated"), std::string::npos) << text.out;
  EXPECT_EQ(run({"predict", "elsewhere.toml"}).status, 0);
}

/// The table with one column multiplied, as by somebody who takes another unit.
std::string with_column_times(const std::string& table, const std::string& column, double factor) {
  std::vector<std::string> rows = lines(table);
  const auto cells = [](const std::string& row) {
    std::vector<std::string> result;
    std::istringstream text(row);
    for (std::string cell; std::getline(text, cell, ',');) result.push_back(cell);
    return result;
  };
  const std::vector<std::string> names = cells(rows[0]);
  const auto place = std::size_t(std::find(names.begin(), names.end(), column) - names.begin());
  std::string changed = rows[0] + "\n";
  for (std::size_t row = 1; row < rows.size(); ++row) {
    std::vector<std::string> values = cells(rows[row]);
    values.at(place) = fmt::format("{:.8g}", factor * std::stod(values[place]));
    changed += fmt::format("{}\n", fmt::join(values, ","));
  }
  return changed;
}

TEST_F(CalibrateProgram, AsksForTheUnitsWhereNoRubberIsLikeThat) {
  write_truth(kRadii);
  EXPECT_TRUE(result_of({"calibrate", "data.csv", "case.toml"})["unit_doubt"].is_null());
  const std::string data = file_text(folder.path() / "data.csv");
  struct Mistake {
    const char* column;
    double factor;
    const char* words;
  };
  // In kg the modulus would be possible, the friction is not.
  for (const Mistake& mistake : {Mistake{"load_N", 1 / 9.80665e-3, "with the loads in g the data "},
                                 Mistake{"load_N", 1 / 9.80665, "with the loads in kg the data "},
                                 Mistake{"load_N", 1e3, "with the loads in mN the data "},
                                 Mistake{"max_torque_mNm", 1e-3, "with the torques in N·m the "}}) {
    folder.write("units.csv", with_column_times(data, mistake.column, mistake.factor));
    const json found = result_of({"calibrate", "units.csv", "case.toml"});
    ASSERT_TRUE(found["unit_doubt"].is_string()) << mistake.words;
    const std::string doubt = found["unit_doubt"];
    EXPECT_NE(doubt.find("far outside of rubber (E 10 kPa to 30 MPa, mu 0.1 to 5)"),
              std::string::npos)
        << doubt;
    const std::size_t at = doubt.find(mistake.words);
    ASSERT_NE(at, std::string::npos) << doubt;
    // The truth is 400 kPa and 0.7, the values are off by 1 %.
    const std::size_t modulus = doubt.find("E = ", at), friction = doubt.find("mu = ", at);
    ASSERT_NE(friction, std::string::npos) << doubt;
    EXPECT_NEAR(std::stod(doubt.substr(modulus + 4)), 400, 20) << doubt;
    EXPECT_NEAR(std::stod(doubt.substr(friction + 5)), 0.7, 0.02) << doubt;
    const ProgramRun text = run({"calibrate", "units.csv", "case.toml"});
    EXPECT_NE(text.out.find(doubt), std::string::npos) << text.out;
  }
}

TEST_F(CalibrateProgram, NamesTheUnitOfLengthsThatFitNoModel) {
  write_truth(kRadii);
  std::string data = file_text(folder.path() / "data.csv");
  for (const char* column : {"a_mm", "b_mm", "indentation_mm"})
    data = with_column_times(data, column, 1e-3);
  folder.write("units.csv", data);
  const ProgramRun result = run({"calibrate", "units.csv", "case.toml"});
  EXPECT_NE((result.out + result.err).find("with all lengths in m the data give E = "),
            std::string::npos)
      << result.out << result.err;
}

TEST_F(CalibrateProgram, NamesAnOutlierWithItsLine) {
  write_truth(kRadii, 1.6);
  const json found = result_of({"calibrate", "data.csv", "case.toml"});
  ASSERT_EQ(found["outliers"].size(), 1u) << found["outliers"];
  EXPECT_EQ(found["outliers"][0]["quantity"], "a");
  EXPECT_EQ(found["outliers"][0]["load_N"], 3.0);
  EXPECT_EQ(found["outliers"][0]["line"], 6);
  EXPECT_NEAR(found["parameters"]["youngs_modulus"]["value"].get<double>() / 400e3, 1, 0.04);
  const ProgramRun text = run({"calibrate", "data.csv", "case.toml"});
  EXPECT_NE(text.out.find("Left out as an outlier: a at 3 N (line 6)"), std::string::npos)
      << text.out;
}

TEST_F(CalibrateProgram, WritesACaseForTheOtherCommands) {
  write_truth(kRadii);
  fs::create_directory(folder.path() / "sub");
  const json found =
      result_of({"calibrate", "data.csv", "case.toml", "--output", "sub/fitted.toml"});
  const json predicted = result_of({"predict", "sub/fitted.toml", "--model", "fingertip_layer"});
  EXPECT_EQ(predicted["case"], "mine_fitted");
  // Six digits are written.
  EXPECT_NEAR(predicted["layer"]["youngs_modulus_Pa"].get<double>() /
                  found["parameters"]["youngs_modulus"]["value"].get<double>(),
              1, 1e-5);
  EXPECT_NEAR(predicted["layer"]["thickness_m"].get<double>() /
                  found["parameters"]["thickness"]["value"].get<double>(),
              1, 1e-5);
  EXPECT_NEAR(predicted["friction_coefficient"].get<double>() /
                  found["parameters"]["friction_coefficient"]["value"].get<double>(),
              1, 1e-5);
  EXPECT_EQ(predicted["layer"]["poisson_ratio"], 0.47);
  const std::string text = file_text(folder.path() / "sub" / "fitted.toml");
  EXPECT_EQ(text.rfind("# Fitted by softfinger calibrate", 0), 0u) << text;
  EXPECT_EQ(run({"calibrate", "data.csv", "case.toml", "--output", "missing/fitted.toml"}).status,
            2);
}

TEST_F(CalibrateProgram, FindsTheRadiusAndScalesTheBodiesWithIt) {
  write_truth(kRadii);
  std::string text = file_text(folder.path() / "case.toml");
  text.replace(text.find("[12.0, 9.0]"), 11, "[18.0, 13.5]");  // 1.5 times too large
  folder.write("case.toml", text);
  const json found = result_of({"calibrate", "data.csv", "case.toml", "--fit",
                                "youngs_modulus,radius", "--fix", "thickness_mm=2.5", "--fix",
                                "friction_coefficient=0.7", "--output", "fitted.toml"});
  // The relative radii of a finger on a plane are its own.
  EXPECT_NEAR(found["parameters"]["radius"]["value"].get<double>() / std::sqrt(12e-3 * 9e-3), 1,
              0.03);
  EXPECT_EQ(found["fixed"]["thickness"], 2.5e-3);
  const json predicted = result_of({"predict", "fitted.toml", "--model", "fingertip_layer"});
  const json& radii = predicted["geometry"][0]["radii_m"];
  EXPECT_NEAR(radii[0].get<double>() / radii[1].get<double>(), 12. / 9, 1e-5);
  EXPECT_NEAR(std::sqrt(radii[0].get<double>() * radii[1].get<double>()) /
                  found["parameters"]["radius"]["value"].get<double>(),
              1, 1e-5);
}

TEST_F(CalibrateProgram, ReadsStandardInputAndAcceptsErrors) {
  write_truth(kRadii, 1, true);
  const json found = result_of({"calibrate", "data.csv", "case.toml"});
  EXPECT_TRUE(found["residuals"][0]["std_given"].get<bool>());
  EXPECT_FALSE(found["residuals"][1]["std_given"].get<bool>());
  const std::string command = std::string(SOFTFINGER_PROGRAM) + " calibrate - " +
                              (folder.path() / "case.toml").string() + " --json < " +
                              (folder.path() / "data.csv").string() + " > " +
                              (folder.path() / "piped.json").string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  json piped = json::parse(file_text(folder.path() / "piped.json"));
  EXPECT_EQ(piped["data"], "standard input");
  EXPECT_EQ(piped["parameters"], found["parameters"]);
}

TEST_F(CalibrateProgram, WritesAPageThatNeedsNoNetwork) {
  write_truth(kRadii, 1.6);
  ASSERT_EQ(run({"calibrate", "data.csv", "case.toml", "--page", "fit.html"}).status, 0);
  const std::string page = file_text(folder.path() / "fit.html");
  for (const char* part : {"What the data cannot tell", "Residuals", "Models on the same data",
                           "left out", "data-chart=\"confidence\"", "data-quantity=\"max_torque\""})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  for (const char* part : {"src=", "<link", "@import"})
    EXPECT_EQ(page.substr(0, page.find("<script type=\"application/json\"")).find(part),
              std::string::npos)
        << part;
}

TEST_F(CalibrateProgram, RefusesInOneLine) {
  write_truth(kRadii);
  const auto calibrate = [](std::vector<std::string> more) {
    more.insert(more.begin(), {"calibrate", "data.csv", "case.toml"});
    return more;
  };
  expect_refusal({"calibrate", "missing.csv", "case.toml"}, {"missing.csv"});
  expect_refusal({"calibrate", "data.csv", "missing.toml"}, {"missing.toml"});
  expect_refusal(calibrate({"--fit", "thicknes"}), {"\"thickness\""});
  expect_refusal(calibrate({"--fit", "thickness,thickness"}), {"each parameter once"});
  expect_refusal(calibrate({"--fit", "shear_strength"}), {"shear law", "coulomb"});
  expect_refusal(calibrate({"--fix", "thickness=3"}), {"unit", "thickness_mm or thickness_m"});
  expect_refusal(calibrate({"--fix", "thickness_mm=0"}), {"0.01 to 1e+03"});
  expect_refusal(calibrate({"--fix", "poisson_ratio=0.6"}), {"0 to 0.5"});
  expect_refusal(calibrate({"--fix", "poisson_ratio=nan"}), {"0 to 0.5"});
  expect_refusal(calibrate({"--fix", "poisson_ratio"}), {"key=value"});
  expect_refusal(calibrate({"--fix", "colour=3"}), {"unknown key"});
  expect_refusal(calibrate({"--fix", "thickness_mm=2", "--fit", "thickness"}), {"either"});
  expect_refusal(calibrate({"--model", "layer_fft"}), {"fingertip_layer"});
  folder.write("few.csv", "load_N,a_mm\n1,2\n2,2.5\n");
  expect_refusal({"calibrate", "few.csv", "case.toml"},
                 {"few.csv", "= 2", "more than the 2 parameters", "--fit"});
  folder.write("nofriction.csv", "load_N,a_mm\n1,2\n2,2.5\n3,2.9\n4,3.1\n");
  expect_refusal({"calibrate", "nofriction.csv", "case.toml", "--fit", "friction_coefficient"},
                 {"tangential_force among the measurements"});
  folder.write("two.toml", file_text(folder.path() / "case.toml") +
                               "[object_layer]\nthickness_mm = 1\nyoungs_modulus_kPa = 100\n"
                               "poisson_ratio = 0.4\n");
  expect_refusal({"calibrate", "data.csv", "two.toml"}, {"[object_layer]", "one compliant body"});
  expect_refusal({"calibrate", "data.csv", "skin_over_pulp"}, {"one homogeneous layer"});
  folder.write("zero.csv", "load_N,a_mm,a_mm_std\n1,2,0\n");
  expect_refusal({"calibrate", "zero.csv", "case.toml"}, {"zero.csv:2", "a_mm_std"});
}

TEST_F(CalibrateProgram, RefusesDataThatContradictEveryModelAndSaysWhere) {
  write_truth(kRadii);
  std::string text = "load_N,a_mm,a_mm_std\n";
  for (int i = 0; i < 8; ++i)  // it shrinks as it is pressed
    text += fmt::format("{},{:.4g},0.02\n", 1 << i, 4 * std::pow(0.8, i));
  folder.write("shrinking.csv", text);
  expect_refusal(
      {"calibrate", "shrinking.csv", "case.toml"},
      {"shrinking.csv", "no model explains the data within their errors", "a at", "sigma"});
}

/// A machine's curve of Hertz's sphere, written here: E 180 kPa, nu 0.49, R 12.5 mm on a thick
/// finger; steps of 0.2 mm from 0.3 mm before the touch, a mount of `mount_N_per_mm`, then back
/// with 0.1 mm of play. Forces are those of a load cell that reads 0.001 N.
std::string machine_curve(double exponent = 1.5, double mount_N_per_mm = 1e9,
                          const std::string& column = "position_mm", int rows = 18) {
  const double stiffness = 4. / 3 * 0.18 / (1 - 0.49 * 0.49) * std::sqrt(12.5);
  const auto force_N = [&](double travel_mm) {
    double low = 0, high = 100;
    for (int i = 0; i < 60; ++i) {
      const double force = 0.5 * (low + high);
      const double travel = std::pow(force / stiffness, 1 / exponent) + force / mount_N_per_mm;
      (travel < travel_mm ? low : high) = force;
    }
    return low;
  };
  std::string text = "load_N," + column + "\n";
  const auto row = [&](double position_mm, double seen_mm) {
    text += fmt::format("{:.3f},{:.1f}\n", seen_mm > 0 ? force_N(seen_mm) : 0., position_mm);
  };
  for (int i = 0; i < rows; ++i) row(0.2 * i, 0.2 * i - 0.3);
  for (int i = rows - 1; i >= 0; --i) row(0.2 * i, std::min(0.2 * i + 0.1, 0.2 * (rows - 1)) - 0.3);
  return text;
}

const char* const kThickTip =
    "id = \"tip\"\n[geometry]\nfinger = { radii_mm = [12.5, 12.5] }\nobject = { radii_mm = [inf, "
    "inf] }\n[layer]\nthickness_mm = 1000\nyoungs_modulus_kPa = 500\npoisson_ratio = 0.49\n"
    "[contact]\nload_N = 1\nfriction_coefficient = 0.8\n";

TEST_F(CalibrateProgram, FitsTheLoadingOfAMachinesCurveAndItsZero) {
  folder.write("tip.toml", kThickTip);
  folder.write("curve.csv", machine_curve());
  const json found = result_of({"calibrate", "curve.csv", "tip.toml", "--model", "hertz"});
  ASSERT_EQ(found["parameters"].size(), 2u) << found["parameters"];
  EXPECT_NEAR(found["parameters"]["youngs_modulus"]["value"].get<double>() / 180e3, 1, 0.01);
  // Forces are written to 0.001 N, which is 0.01 mm near the touch.
  EXPECT_NEAR(found["parameters"]["zero"]["value"].get<double>(), 0.3e-3, 0.01e-3);
  const json& branches = found["branches"];
  EXPECT_EQ(branches["loading"], 16);  // two of eighteen are before the touch
  EXPECT_GT(branches["unloading"], 14);
  EXPECT_NEAR(branches["backlash_m"].get<double>(), 0.1e-3, 0.01e-3);
  EXPECT_LT(branches["hysteresis_share"].get<double>(), 0.02);
  EXPECT_EQ(found["exponent_doubt"], nullptr);
  // The column of a known zero, with the zero asked for.
  std::string bare;
  for (const std::string& line : lines(machine_curve(1.5, 1e9, "indentation_mm")))
    if (line.rfind("0.000,", 0) != 0) bare += line + "\n";
  folder.write("bare.csv", bare);
  const json other = result_of(
      {"calibrate", "bare.csv", "tip.toml", "--model", "hertz", "--fit", "youngs_modulus,zero_mm"});
  EXPECT_NEAR(other["parameters"]["zero"]["value"].get<double>(),
              found["parameters"]["zero"]["value"].get<double>(), 1e-6);
  const std::string text = run({"calibrate", "curve.csv", "tip.toml", "--model", "hertz"}).out;
  for (const char* part : {"Backlash 0.1 mm", "values of loading are used", "Dragon Skin 10"})
    EXPECT_NE(text.find(part), std::string::npos) << text << "\nhas no " << part;
}

TEST_F(CalibrateProgram, TakesOffWhatTheMountGives) {
  folder.write("tip.toml", kThickTip);
  folder.write("curve.csv", machine_curve(1.5, 10));
  const auto modulus = [&](const std::vector<std::string>& options) {
    std::vector<std::string> all = {"calibrate", "curve.csv", "tip.toml", "--model", "hertz"};
    all.insert(all.end(), options.begin(), options.end());
    return result_of(all)["parameters"]["youngs_modulus"]["value"].get<double>();
  };
  EXPECT_LT(modulus({}), 0.9 * 180e3);
  EXPECT_NEAR(modulus({"--fix", "mount_N_per_mm=10"}) / 180e3, 1, 0.01);
  EXPECT_NEAR(modulus({"--fix", "compliance_mm_per_N=0.1"}) / 180e3, 1, 0.01);
  EXPECT_NEAR(modulus({"--fit", "youngs_modulus,zero,compliance"}) / 180e3, 1, 0.05);
  expect_refusal({"calibrate", "curve.csv", "tip.toml", "--fix", "mount_N_per_mm=0"},
                 {"mount_N_per_mm", "0.1 N/mm or more"});
}

TEST_F(CalibrateProgram, PredictsTheLoadsThatWereKeptBack) {
  folder.write("tip.toml", kThickTip);
  folder.write("curve.csv", machine_curve());
  const json found = result_of(
      {"calibrate", "curve.csv", "tip.toml", "--hold-out-above", "0.5", "--at-load", "8,10"});
  const json& held = found["held_out"];
  ASSERT_GT(held.size(), 3u);
  for (const json& row : held) {
    EXPECT_TRUE(row["inside"].get<bool>()) << row;
    EXPECT_LE(row["band95"][0], row["predicted"]);
    EXPECT_GE(row["band95"][1], row["predicted"]);
  }
  // The band is one of a few per cent, where the model is the truth's neighbour.
  const json& last = held.back();
  EXPECT_LT(last["chance"].get<double>() + last["misfit"].get<double>(),
            0.15 * last["predicted"].get<double>());
  ASSERT_EQ(found["forecasts"].size(), 2u);
  EXPECT_EQ(found["forecasts"][1]["load_N"], 10);
  EXPECT_GT(found["forecasts"][1]["misfit"], found["forecasts"][0]["misfit"]);
  EXPECT_EQ(result_of({"calibrate", "curve.csv", "tip.toml"})["held_out"], json::array());
  const auto refuse = [&](const char* option, const char* value, const char* part) {
    expect_refusal({"calibrate", "curve.csv", "tip.toml", option, value}, {option, part});
  };
  refuse("--hold-out-above", "0", "part of the largest load");
  refuse("--hold-out-above", "2", "part of the largest load");
  refuse("--at-load", "-1", "loads in N");
}

TEST_F(CalibrateProgram, RefusesACurveThatNoSolidFingerHas) {
  folder.write("tip.toml", kThickTip);
  folder.write("shell.csv", machine_curve(1.05));
  expect_refusal({"calibrate", "shell.csv", "tip.toml"},
                 {"shell.csv", "to the power 1.05", "1.5 or more", "hollow", "--force"});
  const json forced =
      result_of({"calibrate", "shell.csv", "tip.toml", "--model", "hertz", "--force"});
  EXPECT_TRUE(forced["exponent_doubt"].is_string());
}

TEST_F(CalibrateProgram, MeasuresPicturesForItself) {
  // Contacts as predicted, drawn at 0.02 mm per pixel.
  write_truth("relative_radii_mm = [12.0, 9.0]");
  const json truth = result_of({"predict", "truth.toml", "--model", "fingertip_layer"})["results"];
  std::vector<std::string> area = {"area"};
  std::string loads;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    constexpr unsigned kSide = 600;
    std::vector<png_byte> grey(kSide * kSide, 255);
    for (unsigned row = 0; row < kSide; ++row)
      for (unsigned column = 0; column < kSide; ++column) {
        const double x = 0.02e-3 * (column + 0.5 - kSide / 2.), y = 0.02e-3 * (row + 0.5 - 305.);
        if (std::hypot(x / truth[i]["a_m"].get<double>(), y / truth[i]["b_m"].get<double>()) < 1)
          grey[row * kSide + column] = 40;
      }
    area.push_back("print" + std::to_string(i) + ".png");
    folder.write(area.back(), png_of(grey, kSide, kSide));
    loads += (i == 0 ? "" : ",") + fmt::format("{}", truth[i]["load_N"].get<double>());
  }
  for (const char* word : {"--mm-per-pixel", "0.02", "--dark", "--load"}) area.push_back(word);
  area.push_back(loads);
  for (const bool ellipse : {false, true}) {
    if (ellipse) area.push_back("--ellipse");
    const ProgramRun rows = run(area);
    ASSERT_EQ(rows.status, 0) << rows.err;
    folder.write("ink.csv", rows.out);
    const json found = result_of({"calibrate", "ink.csv", "case.toml"});
    for (const auto& [name, value] :
         {std::pair{"youngs_modulus", 400e3}, std::pair{"thickness", 2.5e-3}}) {
      const json& interval = found["parameters"][name]["interval95"];
      EXPECT_LE(interval[0].get<double>(), value) << name;
      EXPECT_GE(interval[1].get<double>(), value) << name;
    }
  }
  area.pop_back();
  area.push_back("--json");
  const json measured = json::parse(run(area).out)["results"];
  ASSERT_EQ(measured.size(), truth.size());
  EXPECT_NEAR(measured[3]["area_m2"].get<double>(), truth[3]["area_projected_m2"].get<double>(),
              measured[3]["area_std_m2"].get<double>());
  expect_refusal({"area", "print0.png", "--mm-per-pixel", "0.02"}, {"edge", "--dark"});
  expect_refusal({"area", "print0.png", "--mm-per-pixel", "0"}, {"--mm-per-pixel"});
  expect_refusal({"area", "print0.png", "--mm-per-pixel", "0.02", "--dark", "--load", "1,2"},
                 {"one for each of the 1 pictures"});
  expect_refusal({"area", "print0.png", "--mm-per-pixel", "0.02", "--dark", "--load", "-1"},
                 {"--load"});
  expect_refusal({"area", "data.csv", "--mm-per-pixel", "0.02"}, {"data.csv", "PNG"});
}

}  // namespace softfinger::tests
