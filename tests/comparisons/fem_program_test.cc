// `softfinger fem` with the real finite elements, as its users see it. Coarse levels throughout.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace fs = std::filesystem;
using nlohmann::json;

class FemProgram : public testing::Test {
 protected:
  TemporaryFolder folder;
  Start start{folder.path(), {"SOFTFINGER_FEM_PROGRAM=" SOFTFINGER_FEM}, -1, ""};

  /// A valid case with some words replaced.
  std::string write_case(const std::vector<std::pair<std::string, std::string>>& changes = {}) {
    std::string text = case_text("finger", "1.0");
    for (const auto& [from, to] : changes) {
      const auto place = text.find(from);
      EXPECT_NE(place, std::string::npos) << from;
      text.replace(place, from.size(), to);
    }
    return folder.write("finger.toml", text).string();
  }

  json solve(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "fem");
    arguments.insert(arguments.end(), {"--level", "1", "--json"});
    const ProgramRun run = run_softfinger(start, arguments);
    EXPECT_EQ(run.status, 0) << run.err;
    return run.status == 0 ? json::parse(run.out)["results"][0] : json();
  }

  void expect_refusal(std::vector<std::string> arguments, const std::string& word) {
    arguments.insert(arguments.begin(), "fem");
    const ProgramRun run = run_softfinger(start, arguments);
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_EQ(run.out, "");
    ASSERT_FALSE(lines(run.err).empty());
    const std::string said = lines(run.err).back();
    EXPECT_EQ(said.rfind("softfinger: error: ", 0), 0u) << said;
    EXPECT_NE(said.find(word), std::string::npos) << said;
  }
};

/// Rubber that relaxes, loaded, unloaded and loaded again, which no model answers for.
TEST_F(FemProgram, FollowsALoadOverTime) {
  const std::string file = write_case();
  const std::vector<std::string> twice = {
      file,
      "--flat",
      "--set",
      "layer.relaxation=[{ share = 0.2, time_s = 1 }]",
      "--set",
      "contact={ history = [{ time_s = 0, load_N = 1 }, { time_s = 2, load_N = 1 }, { time_s = 2, "
      "load_N = 0.3 }, { time_s = 6, load_N = 0.3 }], friction_coefficient = 0.5 }"};
  const auto at = [&](const std::string& time_s) {
    std::vector<std::string> arguments = twice;
    arguments.insert(arguments.end(), {"--at-time", time_s});
    return solve(arguments);
  };
  const json first = at("0"), held = at("1.9"), relieved = at("2"), later = at("6");
  EXPECT_EQ(held["load_N"], 1.0);
  EXPECT_EQ(relieved["load_N"], 0.3);
  EXPECT_EQ(held["time_s"], 1.9);
  EXPECT_EQ(held["kinematics"], "linear");
  EXPECT_EQ(held["pressing"], "frictionless");
  EXPECT_EQ(held["history"].size(), 4u);
  EXPECT_TRUE(held["error_bound"].is_null() || held["error_bound"]["max_torque"].is_null());
  EXPECT_GT(held["a_m"], first["a_m"]);
  EXPECT_GT(held["indentation_m"].get<double>(), 1.05 * first["indentation_m"].get<double>());
  EXPECT_LT(relieved["a_m"], held["a_m"]);
  EXPECT_LT(later["indentation_m"], relieved["indentation_m"]) << "it recovers";
  for (const char* option : {"--torsion", "--taxels=4,4", "--output=there", "--limit-surface=4"}) {
    std::vector<std::string> arguments = twice;
    arguments.push_back(option);
    expect_refusal(arguments, std::string(option).substr(0, std::string(option).find('=')));
  }
  expect_refusal({file, "--at-time", "3"}, "--at-time");
  std::vector<std::string> early = twice;
  early.insert(early.end(), {"--at-time=-1"});
  expect_refusal(early, "--at-time");
}

/// Finite elements of the flat layer in linear elasticity, which `layer_fft` solves, too.
TEST_F(FemProgram, ReadsTheTaxelsThatTheModelReads) {
  const std::string file = write_case();
  for (const char* depth : {"0", "1"}) {
    const std::vector<std::string> array{"--taxels", "6,6,1.5", "--taxels-depth", depth};
    std::vector<std::string> arguments{file, "--flat", "--linear", "--set",
                                       "contact.pressing=\"frictionless\""};
    arguments.insert(arguments.end(), array.begin(), array.end());
    const json elements = solve(arguments);
    std::vector<std::string> asked{"predict", file, "--model", "layer_fft", "--json"};
    asked.insert(asked.end(), array.begin(), array.end());
    const ProgramRun run = run_softfinger(start, asked);
    ASSERT_EQ(run.status, 0) << run.err;
    const json model = json::parse(run.out)["results"][0]["taxels"];
    double sum = 0, peak = 0, worst = 0;
    for (std::size_t row = 0; row < 6; ++row)
      for (std::size_t column = 0; column < 6; ++column) {
        const double force = elements["taxels"]["force_N"][row][column];
        sum += force;
        peak = std::max(peak, force);
        worst = std::max(worst, std::abs(force - model["force_N"][row][column].get<double>()));
      }
    EXPECT_NEAR(sum + elements["taxels"]["outside_N"].get<double>(), elements["load_N"], 1e-12);
    // Coarse elements, whose nodes lie half a millimetre apart and spread their forces so far: a
    // third of a taxel. Measured 0.4 %.
    EXPECT_LT(worst, 0.01 * peak) << depth;
  }
  double listed = 0;
  const json forces = solve({file, "--taxels", "6,6"})["nodal_forces"]["force_N"];
  for (const json& force : forces) listed += force.get<double>();
  EXPECT_NEAR(listed, 1, 1e-9);
}

/// Friction pulls the surface inwards and lifts it: where the finger touches, pressure and friction
/// together displace it by the approach less the gap, which neither does alone.
TEST_F(FemProgram, ReadsFrictionOnATactileArray) {
  const std::string file =
      folder
          .write("round.toml",
                 "id = \"round\"\n[geometry]\nfinger = { radii_mm = [20, 20] }\n"
                 "object = { radii_mm = [inf, inf] }\n[layer]\nthickness_mm = 2\n"
                 "youngs_modulus_kPa = 300\npoisson_ratio = 0.49\n[contact]\nload_N = [2]\n"
                 "friction_coefficient = 0.5\n")
          .string();
  constexpr double kRadius_m = 20e-3, kFriction = 0.5;
  const json result = solve({file, "--flat", "--linear", "--taxels", "12,12"});
  const json &forces = result["nodal_forces"], &array = result["taxels"];
  double sum_x_N = 0, inwards_N = 0;
  for (std::size_t i = 0; i < forces["x_m"].size(); ++i) {
    const double x = forces["x_m"][i], y = forces["y_m"][i], x_N = forces["friction_x_N"][i],
                 y_N = forces["friction_y_N"][i], normal_N = forces["force_N"][i];
    EXPECT_LE(std::hypot(x_N, y_N), kFriction * normal_N * (1 + 1e-5));  // to the solver's residual
    sum_x_N += x_N;
    inwards_N -= (x * x_N + y * y_N) / std::max(1e-12, std::hypot(x, y));
  }
  EXPECT_NEAR(sum_x_N, 0, 1e-9);
  EXPECT_GT(inwards_N, 0.2);
  const double pitch_m = array["pitch_m"], approach_m = result["indentation_m"],
               a_m = result["a_m"];
  int inside = 0;
  double sum_m = 0;
  for (std::size_t row = 0; row < 12; ++row)
    for (std::size_t column = 0; column < 12; ++column) {
      const double x = array["x_m"][column], y = array["y_m"][row];
      if (std::hypot(x, y) > a_m - pitch_m) continue;
      ++inside;
      // The gap's mean over a taxel. Nodal forces are spread over half a millimetre on these coarse
      // elements: a single taxel is off by up to 2 %, their mean by 0.1 %. Friction lifts by 6 %.
      const double gap_m = (x * x + y * y + pitch_m * pitch_m / 6) / (2 * kRadius_m);
      const double off = array["displacement_m"][row][column].get<double>() - approach_m + gap_m;
      EXPECT_NEAR(off, 0, 0.03 * approach_m);
      sum_m += off;
    }
  EXPECT_NEAR(sum_m / inside, 0, 0.005 * approach_m);
  EXPECT_GT(inside, 20);
  EXPECT_GT(array["shear_x_Pa"][6][2].get<double>(), 1e3) << "inwards, left of the middle";
}

/// A disc of radius 2 h, nu 0.49, against an independent mixed method (axisymmetric, three meshes,
/// 1e-4): P h/(d E A), and int p r dA/P over that of uniform pressure, 2/3 R.
TEST_F(FemProgram, SolvesAFlatPad) {
  constexpr double kThickness_m = 2e-3, kModulus_Pa = 3e5, kRadius_m = 4e-3, kLoad_N = 2;
  const auto text = [&](const std::string& pressing, const std::string& more = "") {
    return "id = \"disc\"\n[geometry]\nfinger = { pad_diameter_mm = 8" + more +
           " }\nobject = { flat = true }\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
           "poisson_ratio = 0.49\n[contact]\nload_N = [0.002, 2]\nfriction_coefficient = 0.5\n"
           "pressing = \"" +
           pressing + "\"\n";
  };
  const double area_m2 = 3.14159265358979 * kRadius_m * kRadius_m;
  struct Row {
    const char* pressing;
    double stiffness, arm;
  };
  double eccentricity_m = 0;
  for (const Row& row :
       {Row{"stuck", 2.6337282, 0.93170712}, Row{"frictionless", 1.5025557, 0.90694741}}) {
    const std::string file = folder.write("disc.toml", text(row.pressing)).string();
    const ProgramRun run = run_softfinger(start, {"fem", file, "--level", "1", "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    const json results = json::parse(run.out)["results"];
    ASSERT_EQ(results.size(), 2u);
    const json& pad = results[1];
    EXPECT_EQ(pad["contact"], "patch");
    EXPECT_EQ(pad["pressing"], row.pressing);
    EXPECT_TRUE(pad["a_m"].is_null());
    const double stiffness =
        kLoad_N * kThickness_m / (pad["indentation_m"].get<double>() * kModulus_Pa * area_m2);
    const double arm = pad["pressure_arm_m"].get<double>() / (2. / 3 * kRadius_m);
    // Within the stated errors, which are of the order of a tenth of a per cent.
    EXPECT_NEAR(stiffness, row.stiffness,
                pad["error"]["indentation"].get<double>() * row.stiffness);
    EXPECT_NEAR(arm, row.arm, pad["error"]["pressure_arm"].get<double>() * row.arm);
    EXPECT_LT(pad["error"]["indentation"].get<double>(), 0.02);
    // Full slip forgets how the pad was pressed.
    if (eccentricity_m > 0) {
      EXPECT_NEAR(pad["eccentricity_m"].get<double>(), eccentricity_m, 1e-9 * eccentricity_m);
    }
    eccentricity_m = pad["eccentricity_m"];
    EXPECT_NEAR(pad["max_torque_Nm"].get<double>(), 0.5 * kLoad_N * eccentricity_m,
                1e-9 * eccentricity_m);
    // The load off the middle that lifts the rim does not depend on how large it is.
    for (int axis = 0; axis < 2; ++axis) {
      const double large = pad["tilt_limit_Nm"][axis], small = results[0]["tilt_limit_Nm"][axis];
      EXPECT_NEAR(small / 2e-3, large / kLoad_N, 1e-6 * large / kLoad_N) << row.pressing;
    }
  }
  const std::string file = folder.write("disc.toml", text("stuck")).string();
  const ProgramRun words = run_softfinger(start, {"fem", file, "--level", "1"});
  EXPECT_EQ(lines(words.out)[1].rfind("2 N: torque ", 0), 0u) << words.out;
  EXPECT_NE(words.out.find("pad_layer is off by: torque "), std::string::npos) << words.out;
  expect_refusal({file, "--torsion"}, "of a flat pad");
  expect_refusal({file, "--set", "contact.load_at_mm=[3.9,0]"}, "");
}

/// The built-in pads, on coarse meshes: pad_layer holds what it states of itself.
TEST_F(FemProgram, ComparesFlatPadsWithinTheirBounds) {
  const std::string output = (folder.path() / "pads").string();
  const ProgramRun run = run_softfinger(start, {"compare", "panda_like_pad", "thin_disc_pad",
                                                "--set", "fem.level=1", "--output", output});
  ASSERT_EQ(run.status, 0) << run.err;
  const json report = json::parse(file_text(folder.path() / "pads/report.json"));
  ASSERT_EQ(report["cases"].size(), 2u);
  for (const json& pad : report["cases"]) {
    EXPECT_EQ(pad["verdict"].get<std::string>().rfind("Use the default, Pad layer (", 0), 0u);
    const json &load = pad["loads"][0], &model = load["models"][0];
    for (const char* key : {"max_torque", "pressure_arm", "indentation", "normal_stiffness",
                            "tilt_stiffness", "peak_pressure"})
      EXPECT_LT(std::abs(model["relative_error"][key].get<double>()),
                model["error_bound"][key].get<double>())
          << pad["id"] << " " << key;
    // The nodes of both lines, and their pressure in the middle.
    const json& profile = load["fem"]["profile_x"];
    ASSERT_GT(profile["position_m"].size(), 8u);
    // A disc is a polygon to the models, some 0.2 % smaller at its corners' middle.
    const double edge_m = profile["position_m"][0];
    EXPECT_NEAR(model["profile_x"]["position_m"][0].get<double>() / edge_m, 1, 0.01);
  }
}

TEST_F(FemProgram, EndsInWordsWhereMemoryIsShort) {
  const std::string file = write_case();
  // Memory from hardly enough to load the program to plenty: OpenBLAS used to ask for memory in an
  // endless loop.
  bool refused = false, answered = false;
  for (int limit_kB = 500000; limit_kB <= 1500000; limit_kB += 250000) {
    const std::string command =
        "cd " + folder.path().string() + " && ulimit -v " + std::to_string(limit_kB) +
        " && SOFTFINGER_FEM_PROGRAM=" SOFTFINGER_FEM " timeout 120 " SOFTFINGER_PROGRAM " fem " +
        file + " --level 1 --linear > out 2> err";
    const int status = std::system(command.c_str());
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_NE(WEXITSTATUS(status), 124) << "it hangs with " << limit_kB << " kB";
    const std::string said = file_text(folder.path() / "err");
    if (WEXITSTATUS(status) == 0) {
      answered = true;
      continue;
    }
    refused = true;
    EXPECT_NE(said.find("error: "), std::string::npos) << said;
  }
  EXPECT_TRUE(refused && answered);
}

TEST_F(FemProgram, AnswersWithTheContractsKeysAndItsErrors) {
  const json answer = solve({write_case()});
  for (const char* key :
       {"load_N", "model", "a_m", "b_m", "axis_rad", "indentation_m", "peak_pressure_Pa", "area_m2",
        "max_torque_Nm", "eccentricity_m", "error", "unknowns", "active_nodes", "iterations"})
    EXPECT_TRUE(answer.contains(key)) << key;
  for (const char* key : {"a", "b", "area", "indentation", "peak_pressure", "max_torque"}) {
    EXPECT_GT(answer["error"][key], 0) << key;
    EXPECT_LT(answer["error"][key], 0.1) << key;
    EXPECT_EQ(answer["error_bound"][key], answer["error"][key]) << key;
  }
  EXPECT_EQ(answer["coarse"], false);
  EXPECT_EQ(answer["geometry"], "flat") << "of relative radii no one knows more";
  EXPECT_EQ(answer["kinematics"], "finite");
  EXPECT_EQ(answer["pressing"], "coulomb");
  EXPECT_GT(answer["frictionless"]["indentation_m"], answer["indentation_m"]);
  EXPECT_EQ(answer["valid"], true);
  EXPECT_FALSE(answer.contains("error_estimate"));
}

constexpr const char* kRadii = "relative_radii_mm = [20.0, 10.0]";
constexpr const char* kBodies =
    "finger = { radii_mm = [20.0, 10.0] }\nobject = { radii_mm = [inf, inf] }";

TEST_F(FemProgram, SolvesTheFingerItselfAtFiniteStrainUnlessLessIsAskedFor) {
  const std::string file = write_case({{kRadii, kBodies}});
  const json finger = solve({file}), less = solve({file, "--flat", "--linear"});
  EXPECT_EQ(finger["geometry"], "curved");
  EXPECT_EQ(finger["kinematics"], "finite");
  EXPECT_EQ(less["geometry"], "flat");
  EXPECT_EQ(less["kinematics"], "linear");
  EXPECT_EQ(solve({file, "--flat"})["kinematics"], "finite");
  EXPECT_EQ(solve({file, "--linear"})["geometry"], "curved");
  for (const auto& [key, quantity] : {std::pair("a_m", "a"),
                                      {"b_m", "b"},
                                      {"indentation_m", "indentation"},
                                      {"max_torque_Nm", "max_torque"}}) {
    EXPECT_EQ(finger["error_bound"][quantity], finger["error"][quantity]) << quantity;
    const double off = std::abs(less[key].get<double>() / finger[key].get<double>() - 1);
    EXPECT_LT(off, less["error_bound"][quantity].get<double>() +
                       finger["error_bound"][quantity].get<double>())
        << quantity;
    EXPECT_GT(less["error_bound"][quantity], less["error"][quantity])
        << "a flat layer is not the finger: " << quantity;
  }
  EXPECT_TRUE(solve({file, "--flat"})["error_bound"].is_null()) << "which nobody knows";
  const std::string typed = write_case(
      {{kRadii, kBodies},
       {"friction_coefficient = 0.8",
        "friction_coefficient = 0.8\n[fem]\ngeometry = \"flat\"\nkinematics = \"linear\"\n"}});
  EXPECT_EQ(solve({typed})["max_torque_Nm"], less["max_torque_Nm"]) << "the case's own choice";
}

TEST_F(FemProgram, BeginsWithItsAnswerAndSaysWhatItSolved) {
  const std::string file = write_case({{kRadii, kBodies}, {"= 1.0", "= [1.0, 2.0]"}});
  const ProgramRun run = run_softfinger(start, {"fem", file, "--level", "1"});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto said = lines(run.out);
  for (const std::size_t load : {0, 1}) {
    EXPECT_EQ(said[load].rfind("max torque ", 0), 0u) << said[load];
    EXPECT_NE(said[load].find(load == 0 ? "at 1 N: finite elements of the finger itself at finite "
                                          "strain"
                                        : "at 2 N: "),
              std::string::npos)
        << said[load];
    EXPECT_NE(said[load].find(" %, contact "), std::string::npos) << said[load];
  }
  EXPECT_NE(run.out.find("finite elements: the finger itself (curved, R 20 and 10 mm), finite "
                         "strain, neo-Hookean, Q2/P1 elements of level 1"),
            std::string::npos)
      << run.out;
  const ProgramRun less =
      run_softfinger(start, {"fem", file, "--level", "1", "--flat", "--linear"});
  EXPECT_NE(lines(less.out)[0].find("finite elements of a flat layer in linear theory"),
            std::string::npos)
      << less.out;
  EXPECT_NE(less.out.find("finite elements: a flat layer under the relative radii, linear "
                          "elasticity, Q2/P1"),
            std::string::npos)
      << less.out;
}

TEST_F(FemProgram, SaysWhereLinearTheoryEnds) {
  const std::string file = write_case();
  const json strained = solve({file, "--linear", "--approach-mm", "1.9"});
  EXPECT_EQ(strained["valid"], false);
  EXPECT_TRUE(strained["error_bound"].is_null());
  bool is_named = false;
  for (const json& check : strained["validity"]) {
    if (check["check"] != "small_strain") continue;
    is_named = true;
    EXPECT_NEAR(check["value"], 0.95, 1e-6);
    EXPECT_LE(check["limit"], 0.3);
    EXPECT_EQ(check["holds"], false);
    EXPECT_NE(check["message"], "");
  }
  EXPECT_TRUE(is_named) << strained["validity"];
  const ProgramRun run =
      run_softfinger(start, {"fem", file, "--level", "1", "--linear", "--approach-mm", "1.9"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string said = lines(run.out)[0];
  EXPECT_NE(said.find("(± not known)"), std::string::npos) << said;
  EXPECT_NE(said.find("pressed by 1.9 mm"), std::string::npos) << said;
  EXPECT_NE(said.find("NOT VALID: beyond linear theory: small_strain 0.95, holds below 0.3"),
            std::string::npos)
      << said;
}

TEST_F(FemProgram, BoundsOfTheAtlasHoldForContactsThatItHasNotSeen) {
  const auto command = [](const char* count) {
    return std::vector<std::string>{"atlas",    "--random", count,    "--seed", "417",
                                    "--folder", "unseen",   "--jobs", "2"};
  };
  // If run as ranks, each of two processes would do all the work.
  Start rank = start;
  rank.environment.insert(rank.environment.end(),
                          {"OMPI_COMM_WORLD_RANK=1", "OMPI_COMM_WORLD_SIZE=2"});
  const ProgramRun refused = run_softfinger(rank, command("4"));
  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_NE(refused.err.find("softfinger-sweep --atlas"), std::string::npos) << refused.err;
  // Finished runs are not repeated.
  const ProgramRun half = run_softfinger(start, command("2"));
  EXPECT_EQ(half.status, 0) << half.err;
  const auto written = [&] {
    std::vector<fs::file_time_type> times;
    for (const auto& entry : fs::directory_iterator(folder.path() / "unseen"))
      times.push_back(fs::last_write_time(entry));
    std::sort(times.begin(), times.end());
    return times;
  };
  const auto before = written();
  ASSERT_EQ(before.size(), 2u);
  const ProgramRun whole = run_softfinger(start, command("4"));
  ASSERT_EQ(whole.status, 0) << whole.err;
  const auto after = written();
  ASSERT_EQ(after.size(), 4u);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin())) << "made again";

  std::istringstream last(lines(whole.out).back());
  std::string all, unit;
  double inside = 0, ratio = 0;
  int judged = 0;
  last >> all >> inside >> unit >> judged >> ratio;
  ASSERT_EQ(all, "all") << whole.out;
  EXPECT_GE(judged, 4 * 6 * 4) << "contacts, quantities, models that always answer";
  EXPECT_GE(inside, 95) << whole.out;
  EXPECT_LE(ratio, 5) << whole.out;
}

TEST_F(FemProgram, ExpectsTheClosedFormsSizeWhichSavesATrialMeshAndDecidesNothing) {
  const std::string deaf = folder.write("deaf",
                                        "#!/bin/sh\n"
                                        "sed 's/\"size_hint_m\":\\[[^]]*\\],\\{0,1\\}//' |\n"
                                        "exec " SOFTFINGER_FEM " -\n");
  fs::permissions(deaf, fs::perms::owner_all);
  const std::vector<std::string> arguments{"fem", "elongated_3", "--linear", "--json"};
  const ProgramRun hinted = run_softfinger(start, arguments);
  start.environment = {"SOFTFINGER_FEM_PROGRAM=" + deaf};
  const ProgramRun guessed = run_softfinger(start, arguments);
  ASSERT_EQ(hinted.status + guessed.status, 0) << hinted.err << guessed.err;
  const auto trial_meshes = [](const ProgramRun& run) {
    const auto said = lines(run.err);
    return std::count_if(said.begin(), said.end(), [](const std::string& line) {
      return line.find(": mesh ") != std::string::npos;
    });
  };
  EXPECT_EQ(trial_meshes(hinted), 1) << hinted.err;
  EXPECT_EQ(trial_meshes(guessed), 2) << guessed.err;
  const json with = json::parse(hinted.out)["results"][0],
             without = json::parse(guessed.out)["results"][0];
  const std::vector<std::pair<const char*, const char*>> quantities{
      {"a_m", "a"},
      {"b_m", "b"},
      {"indentation_m", "indentation"},
      {"max_torque_Nm", "max_torque"}};
  // The last trial mesh differs, and with it the two levels' by what it is off.
  for (const auto& [key, error] : quantities)
    EXPECT_NEAR(with[key], without[key],
                without["error"][error].get<double>() * without[key].get<double>())
        << key;
}

TEST_F(FemProgram, PressesByApproach) {
  const std::string file = write_case();
  const double approach_m = solve({file, "--linear"})["indentation_m"];
  const json answer = solve({file, "--linear", "--approach-mm", std::to_string(1e3 * approach_m)});
  // Six digits after the point of a tenth of a millimetre, and the stated errors.
  EXPECT_NEAR(answer["load_N"], 1, 1e-5 + 4 * answer["error"]["load"].get<double>());
  EXPECT_EQ(answer["error"]["indentation"], 0);
}

TEST_F(FemProgram, AnswersEveryLoadInOrderOnSharedMeshes) {
  const std::string file = write_case({{"= 1.0", "= [0.8, 1.0, 0.1]"}});
  const ProgramRun run = run_softfinger(start, {"fem", file, "--linear", "--level", "2", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json results = json::parse(run.out)["results"];
  ASSERT_EQ(results.size(), 3u);
  const double loads_N[] = {0.8, 1.0, 0.1};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(results[i]["load_N"], loads_N[i]);
  const auto oversize = [&](std::size_t i) {
    return results[i]["levels"].back()["oversize"].get<double>();
  };
  // The mesh of 1 N serves 0.8 N; 0.1 N is too small for its cells.
  EXPECT_EQ(oversize(1), 1);
  EXPECT_GT(oversize(0), 1.03);
  EXPECT_EQ(results[0]["unknowns"], results[1]["unknowns"]);
  EXPECT_EQ(oversize(2), 1);
  EXPECT_GT(results[0]["error"]["a"], 1.5e-3);
}

TEST_F(FemProgram, TwistsToFullSlipAndWritesEachState) {
  // A surface's compliance is that of a flat layer in linear theory, without being asked to.
  const json answer =
      solve({write_case(), "--torsion", "--increments", "6", "--output",
             (folder.path() / "vtu").string(), "--export-compliance", "surface.bin"});
  EXPECT_EQ(answer["kinematics"], "linear");
  ASSERT_EQ(answer["torsion"].size(), 6u);
  double last = 0;
  for (const json& state : answer["torsion"]) {
    EXPECT_GT(state["torque_Nm"].get<double>(), last);
    last = state["torque_Nm"];
  }
  EXPECT_EQ(answer["torsion"].back()["slip_fraction"], 1);
  const double full = answer["torque_full_slip_Nm"], integral = answer["max_torque_Nm"];
  // Pressing had directed forces outwards, and each increment turns them further into the direction
  // of slip. The torque misses half of the square of the angle that is left: 5e-4 after these six.
  EXPECT_NEAR(last / full, 1, 1e-3);
  EXPECT_LT(last, full);
  EXPECT_EQ(answer["torsion_pressing"], "coulomb");
  // Friction moves the pressure a little: measured below 0.5 %
  // (docs/measurements/finite_elements.md).
  EXPECT_NEAR(full / integral, 1, 0.005);
  EXPECT_TRUE(fs::exists(answer["vtu"].get<std::string>()));
  const std::string series = file_text(answer["pvd"].get<std::string>());
  EXPECT_NE(series.find("twist_005.vtu"), std::string::npos) << series;

  const std::string compliance = file_text(folder.path() / "surface.bin");
  const json header = json::parse(compliance.substr(0, compliance.find('\n')));
  std::size_t values = 0;
  for (const json& array : header["arrays"])
    values += array["rows"].get<std::size_t>() * array["columns"].get<std::size_t>();
  EXPECT_EQ(compliance.size(), compliance.find('\n') + 1 + 8 * values);
}

TEST_F(FemProgram, DrawsALimitSurface) {
  const json answer = solve({write_case(), "--linear", "--limit-surface", "5"});
  ASSERT_EQ(answer["limit_surface"].size(), 5u);
  const double torque_Nm = answer["max_torque_Nm"], force_N = 0.8;
  const double error = answer["error"]["limit_surface"];
  for (const json& point : answer["limit_surface"]) {
    const double force = std::hypot(point["fx_N"].get<double>(), point["fy_N"].get<double>());
    EXPECT_LT(force / force_N, 1 + error);
    EXPECT_LT(std::abs(point["torque_Nm"].get<double>()) / torque_Nm, 1 + 0.005 + error);
  }
}

TEST_F(FemProgram, BendsTheLayerOntoTheFinger) {
  const std::string geometry = "relative_radii_mm = [20.0, 10.0]";
  const std::string bodies =
      "[geometry.finger]\nshape = \"ellipsoid\"\nradii_mm = [20.0, 10.0]\n"
      "[geometry.object]\nradii_mm = [inf, inf]\n";
  const std::string file = write_case({{geometry, bodies}});
  const json flat = solve({file, "--flat", "--linear"}), curved = solve({file, "--linear"});
  // A convex layer is softer, and its contact larger by less
  // (docs/measurements/finite_elements.md).
  EXPECT_GT(curved["indentation_m"], flat["indentation_m"]);
  EXPECT_GT(curved["a_m"], flat["a_m"]);
  EXPECT_NEAR(curved["a_m"].get<double>() / flat["a_m"].get<double>(), 1, 0.1);
}

/// A flat layer of 16 x 16 x 2 mm in cubes, as gmsh would write it.
std::string layer_mesh(const std::string& core) {
  constexpr int count = 8, row = count + 1, plane = row * row;
  std::ostringstream nodes, elements;
  for (int i = 0; i < 2 * plane; ++i)
    nodes << i + 1 << ' ' << 2 * (i % row) - count << ' ' << 2 * (i / row % row) - count << ' '
          << (i < plane ? -2 : 0) << '\n';
  int number = 0;
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i) {
      const int first = 1 + i + row * j;
      const int corners[] = {first, first + 1, first + row + 1, first + row};
      std::ostringstream bottom, top;
      for (const int corner : corners) {
        bottom << ' ' << corner;
        top << ' ' << corner + plane;
      }
      const auto add = [&](const char* kind, const std::string& corners_of) {
        elements << ++number << kind << corners_of << '\n';
      };
      add(" 5 2 1 1", bottom.str() + top.str());
      add(" 3 2 2 2", top.str());
      add(" 3 2 3 3", bottom.str());
    }
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n3 1 \"layer\"\n2 2 \"contact\"\n"
         "2 3 \"" +
         core + "\"\n$EndPhysicalNames\n$Nodes\n" + std::to_string(2 * plane) + "\n" + nodes.str() +
         "$EndNodes\n$Elements\n" + std::to_string(number) + "\n" + elements.str() +
         "$EndElements\n";
}

TEST_F(FemProgram, TakesAUsersMeshOfTheLayer) {
  const std::string mu = "friction_coefficient = 0.8";
  folder.write("layer.msh", layer_mesh("core"));
  const json meshed =
      solve({write_case({{mu, mu + "\n[fem]\nmesh = \"layer.msh\"\nmesh_unit = \"mm\""}})});
  EXPECT_EQ(meshed["geometry"], "mesh");
  EXPECT_EQ(meshed["kinematics"], "linear");
  const json flat = solve({write_case(), "--linear"});
  for (const auto& [key, error] : {std::pair{"a_m", "a"}, {"max_torque_Nm", "max_torque"}})
    EXPECT_NEAR(meshed[key].get<double>() / flat[key].get<double>(), 1,
                meshed["error"][error].get<double>() + flat["error"][error].get<double>() +
                    2e-3)  // its side wall is only 2.5 thicknesses away
        << key;
  folder.write("layer.msh", layer_mesh("base"));
  expect_refusal({write_case({{mu, mu + "\n[fem]\nmesh = \"layer.msh\""}})}, "\"core\" is missing");
  expect_refusal({write_case({{mu, mu + "\n[fem]\nmesh = \"no.msh\""}})}, "no.msh");
  expect_refusal({write_case({{mu, mu + "\n[fem]\nmesh_unit = \"inch\""}})}, "mesh_unit");
}

TEST_F(FemProgram, RefusesAMeshOfAnotherThicknessThanTheCases) {
  const std::string mu = "friction_coefficient = 0.8";
  folder.write("layer.msh", layer_mesh("core"));
  const auto of_thickness = [&](const char* thickness_mm) {
    return write_case({{"thickness_mm = 2.0", std::string("thickness_mm = ") + thickness_mm},
                       {mu, mu + "\n[fem]\nmesh = \"layer.msh\""}});
  };
  expect_refusal({of_thickness("3.0")},
                 "layer.msh: thickness under the contact = 2 mm: allowed: thickness_mm of the "
                 "case, 3 mm");
  expect_refusal({of_thickness("1.9")}, "thickness under the contact");
  EXPECT_EQ(solve({of_thickness("2.03")})["geometry"], "mesh") << "as a drawing may say it";
}

TEST_F(FemProgram, RunsNothingThatAMeshFileOrItsNeighbourSays) {
  const std::string mu = "friction_coefficient = 0.8";
  const std::string command =
      "\n\nSystemCall \"touch " + (folder.path() / "ran").string() + "\";\n";
  for (const char* name : {"layer.geo", "layer.msh", "layer"}) {
    folder.write(name, command);
    expect_refusal({write_case({{mu, mu + "\n[fem]\nmesh = \"" + name + "\""}})},
                   std::string(name) + ": file = no gmsh mesh");
    EXPECT_FALSE(fs::exists(folder.path() / "ran")) << name;
  }
  folder.write("layer.msh", layer_mesh("base"));
  folder.write("layer.msh.opt", command);
  expect_refusal({write_case({{mu, mu + "\n[fem]\nmesh = \"layer.msh\""}})}, "\"core\" is missing");
  EXPECT_FALSE(fs::exists(folder.path() / "ran"));
}

TEST_F(FemProgram, TouchesNoFileOfTheUsersHome) {
  const TemporaryFolder home;
  fs::create_directories(home.path() / ".fltk/fltk.org");
  std::vector<fs::path> files;
  for (const char* name : {".fltk/fltk.org/fltk.prefs", ".fltk/fltk.org/printers.prefs",
                           ".gmsh-tmp", ".gmsh-errors", ".gmshrc", ".gmsh-options"})
    files.push_back(home.write(name, "; mine\n[.]\n\nkey:1\n[./group]\n\nkey:2\n"));
  const std::string content = file_text(files[0]);
  const auto last_year = fs::last_write_time(files[0]) - std::chrono::hours(24 * 365);
  for (const auto& file : files) fs::last_write_time(file, last_year);

  start.environment.push_back("HOME=" + home.path().string());
  solve({write_case(), "--output", (folder.path() / "vtu").string()});
  std::size_t found = 0;
  for (const auto& entry : fs::recursive_directory_iterator(home.path()))
    found += entry.is_regular_file();
  EXPECT_EQ(found, files.size());
  for (const auto& file : files) {
    EXPECT_EQ(file_text(file), content) << file;
    EXPECT_EQ(fs::last_write_time(file), last_year) << file;
  }
}

TEST_F(FemProgram, NeverWaitsForAMeshThatIsAPipe) {
  const std::string mu = "friction_coefficient = 0.8";
  ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  expect_refusal({write_case({{mu, mu + "\n[fem]\nmesh = \"pipe\""}})}, "a pipe");
}

TEST_F(FemProgram, RefusesBadInputInOneLine) {
  const std::string file = write_case();
  expect_refusal({file, "--level", "1", "--torsion", "--twist-axis-mm", "50,0"}, "twist_axis_m");
  expect_refusal({file, "--approach-mm", "-1"}, "approach-mm");
  expect_refusal({file, "--approach-mm", "5"}, "approach");
  expect_refusal({file, "--approach-mm", "nan"}, "approach");
  expect_refusal({file, "--approach-mm", "inf"}, "approach");
  expect_refusal({file, "--increments", "0"}, "increments");
  expect_refusal({write_case({{"= 1.0", "= 1e7"}}), "--linear"}, "load_N");
  for (const char* limit : {"--fem-time-s", "--fem-memory-MB"})
    expect_refusal({file, limit, "nan"}, limit);
  expect_refusal({write_case({{"= 1.0", "= -1"}})}, "load_N");
  expect_refusal({write_case({{"= 0.45", "= 0.51"}})}, "poisson_ratio");
  const std::string beneath_a_file = file + "/surface.bin";
  expect_refusal({write_case(), "--level", "1", "--export-compliance", beneath_a_file},
                 beneath_a_file);
}

TEST_F(FemProgram, StopsWithTheLevelThatIsFinished) {
  const pid_t process =
      start_softfinger(start, {"fem", write_case(), "--linear", "--level", "2", "--json"});
  // Level 1 is done when level 2 is announced.
  const auto announced = [&] {
    return file_text(folder.path() / ".stderr").find("level 2: 8") != std::string::npos;
  };
  for (int wait = 0; wait < 2400 && !announced(); ++wait)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ASSERT_TRUE(announced());
  kill(process, SIGINT);
  const ProgramRun run = wait_for(start, process);
  EXPECT_EQ(run.status, 128 + SIGINT) << run.err;
  // The signal may come after the last stage that looks for it; then the answer is complete.
  const json answer = json::parse(run.out)["results"][0];
  EXPECT_GT(answer["error"]["a"], 0);
}

TEST_F(FemProgram, TakesAnArrayOfProblems) {
  const json good = {
      {"name", "good"},
      {"radii_m", {0.02, 0.01}},
      {"layer", {{"thickness_m", 2e-3}, {"youngs_modulus_Pa", 3e5}, {"poisson_ratio", 0.45}}},
      {"load_N", 1},
      {"friction_coefficient", 0.8},
      {"level", 1}};
  json bad = good;
  bad["name"] = "bad";
  bad["load_N"] = -1;
  json nameless = good;
  nameless["name"] = 5;
  const auto problems =
      folder.write("problems.json", json::array({good, bad, good, nameless}).dump());
  const fs::path out = folder.path() / "answers";
  const std::string command = std::string(SOFTFINGER_FEM) + " " + problems.string() + " > " +
                              out.string() + " 2> " + (folder.path() / "log").string();
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 2);
  const auto answers = lines(file_text(out));
  ASSERT_EQ(answers.size(), 4u);
  EXPECT_EQ(json::parse(answers[3])["exit_status"], 2) << "a name that is no text";
  const json first = json::parse(answers[0]), failed = json::parse(answers[1]),
             last = json::parse(answers[2]);
  EXPECT_EQ(failed["name"], "bad");
  EXPECT_EQ(failed["exit_status"], 2);
  EXPECT_NE(failed["failure"].get<std::string>().find("load_N"), std::string::npos);
  EXPECT_EQ(first["a_m"], last["a_m"]);
}

TEST_F(FemProgram, TakesSublayersAtSmallAndAtFiniteStrain) {
  const std::pair<std::string, std::string> sublayers = {
      "[layer]\nthickness_mm = 2.0\nyoungs_modulus_kPa = 300.0\npoisson_ratio = 0.45\n",
      "[[layer]]\nthickness_mm = 0.5\nyoungs_modulus_kPa = 900\npoisson_ratio = 0.45\n"
      "[[layer]]\nthickness_mm = 1.5\nyoungs_modulus_kPa = 300\npoisson_ratio = 0.45\n"};
  const double homogeneous_m = solve({write_case(), "--linear"})["indentation_m"];
  const double small_m = solve({write_case({sublayers}), "--linear"})["indentation_m"];
  EXPECT_LT(small_m, 0.95 * homogeneous_m) << "under a skin three times as hard";
  const json finite =
      solve({write_case({sublayers,
                         {"friction_coefficient = 0.8\n",
                          "friction_coefficient = 0.8\n[fem]\nkinematics = \"finite\"\n"}})});
  EXPECT_EQ(finite["kinematics"], "finite");
  // As far from linear theory as homogeneous layers are at this d/h (finite_strain.csv).
  EXPECT_NEAR(finite["indentation_m"].get<double>() / small_m, 1, 0.1);
}

TEST_F(FemProgram, GivesASceneItsTable) {
  // Below what the atlas knows of the models: finite elements decide.
  const ProgramRun run =
      run_softfinger(start, {"select", "pinch", "--tolerance", "0.0005", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json selected = json::parse(run.out);
  ASSERT_EQ(selected["choices"].size(), 2u);
  for (const json& choice : selected["choices"])
    EXPECT_NE(choice["reason"].get<std::string>().find(
                  "the table of finite elements of the finger itself is within"),
              std::string::npos)
        << choice;
  EXPECT_TRUE(selected["motion_holds"].get<bool>());
}

TEST_F(FemProgram, GivesASceneTheTableOfItsOwnFinger) {
  // Fingertips of 10 mm meet a radius of 12² / 30 mm with 5 N: the arm that finite elements of that
  // finger find is 5 % below that of a flat layer under the same gap.
  const std::string same_contact = folder
                                       .write("finger.toml", R"(id = "finger"
[geometry]
finger = { radii_mm = [10, 10] }
object = { radii_mm = [4.8, 4.8] }
[layer]
thickness_mm = 2
youngs_modulus_kPa = 300
poisson_ratio = 0.49
[contact]
load_N = 5
friction_coefficient = 0.8
[fem]
geometry = "curved"
kinematics = "finite"
)")
                                       .string();
  const ProgramRun solved = run_softfinger(start, {"fem", same_contact, "--json"});
  ASSERT_EQ(solved.status, 0) << solved.err;
  const json finger = json::parse(solved.out)["results"][0];
  const ProgramRun run =
      run_softfinger(start, {"select", "lift_curved", "--tolerance", "0.05", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json selected = json::parse(run.out);
  for (const json& choice : selected["choices"]) {
    // The table is of loads about 5 N, a per cent apart.
    const json& table = choice["eccentricity_table"];
    ASSERT_LE(table["loads_N"][0], 5.0);
    ASSERT_GE(table["loads_N"][1], 5.0);
    EXPECT_LE(table["eccentricity_m"].front(), finger["eccentricity_m"]);
    EXPECT_GE(table["eccentricity_m"].back(), finger["eccentricity_m"]);
  }
  EXPECT_EQ(selected["outcome"].get<std::string>().rfind("The outcome ", 0), 0u)
      << selected["outcome"];
  EXPECT_NE(selected["reference"].get<std::string>().find("finite elements"), std::string::npos);
}

}  // namespace softfinger::tests
